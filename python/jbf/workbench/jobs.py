"""Execution of one job at a time in a separate process that can be stopped."""

from __future__ import annotations

import contextlib
import multiprocessing
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.process import BaseProcess
from typing import Any, Literal

from jbf.errors import InputError
from jbf.workbench.answers import Answer
from jbf.workbench.work import STOP, Kind, Order, main

Ending = Literal["done", "error", "stopped"]
Ended = Callable[[Ending, Any], None]
Part = Callable[[Any], None]
STOP_TIMEOUT_S = 20.0
"""Time between the request to stop a process and its termination without a result, s."""


@dataclass
class Job:
    """Progress of the running job.

    Attributes
    ----------
    words
        Description of the job.
    kind
        Kind of the order, or `read` for the reading of files.
    begun
        Start on the monotonic clock, s.
    message, done, total
        Last message, amount done and total amount.
    """

    words: str
    kind: Kind | Literal["read"] = "read"
    begun: float = field(default_factory=time.monotonic)
    message: str = "starting"
    done: int = 0
    total: int = 0

    def to_dict(self) -> dict[str, Any]:
        """Data of the job for the page."""
        return {
            "words": self.words,
            "kind": self.kind,
            "message": self.message,
            "done": self.done,
            "total": self.total,
            "elapsed_s": time.monotonic() - self.begun,
        }


def _process_context() -> Any:
    """Return the multiprocessing context for jobs.

    They are not forked from the server, which is multithreaded. On Linux they are forked from a
    process that has loaded the library already, which takes less time than loading it again.
    """
    if sys.platform != "linux":
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["jbf.workbench.work"])
    return context


class Jobs:
    """Manager of the job, of which at most one runs at a time.

    Parameters
    ----------
    changed
        Callback for changes; called from another thread.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self.changed = changed
        self.job: Job | None = None
        self._process: BaseProcess | None = None
        self._connection: Any = None
        self._cancelled = False
        self._lock = threading.Lock()

    def start(self, words: str, order: Order, on_end: Ended, part: Part | None = None) -> None:
        """Start a job in a separate process.

        `on_end` is called once, with the kind of ending and the result or the reason. `part` is
        called earlier with a partial result.

        Raises
        ------
        InputError
            A job is already running.
        """
        with self._lock:
            if self.job is not None:
                raise InputError(problem="a fit is running", remedy="wait for it, or cancel it")
            context = _process_context()
            mine, theirs = context.Pipe()
            process = context.Process(target=main, args=(theirs, order), daemon=True)
            process.start()
            self.job, self._process, self._cancelled = Job(words, order.kind), process, False
            self._connection = mine
        theirs.close()
        threading.Thread(
            target=self._follow, args=(mine, process, on_end, part), daemon=True
        ).start()

    def cancel(self, at_once: bool = False) -> bool:
        """Stop the running job; return False if there is none.

        The job ends with its best result so far. On a second call, after `STOP_TIMEOUT_S`, or with
        `at_once`, it is killed without a result.
        """
        with self._lock:
            process = self._process
            if process is None or self.job is None:
                return False
            if at_once or self._cancelled:
                self._cancelled = True
                process.kill()
                return True
            self._cancelled, self.job.message = True, "stopping; cancel again to abort"
            with contextlib.suppress(OSError):  # the process has just ended
                self._connection.send(STOP)
        patience = threading.Timer(STOP_TIMEOUT_S, process.kill)
        patience.daemon = True
        patience.start()
        return True

    def _follow(
        self, connection: Any, process: BaseProcess, on_end: Ended, part: Part | None
    ) -> None:
        """Forward the messages of the process until it ends, and report how it ended."""
        ending: Ending = "error"
        answer: Answer | str = "the fit process ended without a result (out of memory?)"
        job = self.job
        assert job is not None
        try:
            while True:
                message = connection.recv()
                if message[0] == "progress":
                    if not self._cancelled:
                        job.message, job.done, job.total = message[1:]
                    self.changed()
                elif message[0] == "part":
                    if part is not None:
                        part(message[1])
                    self.changed()
                else:
                    ending, answer = message
                    break
        except (EOFError, OSError):
            if self._cancelled:
                ending, answer = "stopped", {}
        process.join()
        # Clear the job last, so that the result is available to callers that wait for the end.
        try:
            on_end(ending, answer)
        finally:
            with self._lock:
                self.job = self._process = self._connection = None
            self.changed()
