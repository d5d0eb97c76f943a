"""Progress of the reading of files, which can be cancelled."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from jbf.errors import InputError
from jbf.workbench.jobs import Job

SHOWN_AFTER_S = 0.3
"""Duration after which the page shows the progress of a reading, s."""
INTERVAL_S = 0.25
"""Shortest interval between two updates of the page, s."""


class Cancelled(InputError):
    """Error: the reading was cancelled, or replaced by a later one."""

    def __init__(self) -> None:
        super().__init__(problem="the reading was cancelled")

    def __reduce__(self) -> tuple[object, ...]:
        return Cancelled, ()


class Reading:
    """One reading of files.

    Parameters
    ----------
    words
        Description of what is read.
    changed
        Callback for changes of the progress.
    """

    def __init__(self, words: str, changed: Callable[[], None]) -> None:
        self.job = Job(words, message="reading")
        self.cancelled = False
        self._changed, self._told = changed, 0.0

    @property
    def shown(self) -> bool:
        """Whether the reading takes long enough to be shown."""
        return time.monotonic() - self.job.begun > SHOWN_AFTER_S

    def progress(self, message: str, done: int, total: int) -> None:
        """Report progress.

        Raises
        ------
        Cancelled
            The reading was cancelled.
        """
        if self.cancelled:
            raise Cancelled
        self.job.message, self.job.done, self.job.total = message, done, total
        now = time.monotonic()
        if self.shown and now - self._told > INTERVAL_S:
            self._told = now
            self._changed()

    def tick(self, done: int, total: int) -> None:
        """Report the number of bytes that were read."""
        self.progress("reading", done, total)


class Readings:
    """The readings of a session; a new one cancels the one before it."""

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._latest: Reading | None = None
        self._lock = threading.Lock()

    @contextmanager
    def begin(self, words: str) -> Iterator[Reading]:
        """Start a reading, and cancel the one that is running."""
        reading = Reading(words, self._changed)
        with self._lock:
            if self._latest is not None:
                self._latest.cancelled = True
            self._latest = reading
        # Also a reading without any report is shown.
        timer = threading.Timer(SHOWN_AFTER_S, self._changed)
        timer.daemon = True
        timer.start()
        try:
            yield reading
        finally:
            timer.cancel()
            with self._lock:
                if self._latest is reading:
                    self._latest = None
            if reading.shown:
                self._changed()

    @property
    def job(self) -> Job | None:
        """Progress of the running reading, if it takes long enough to be shown."""
        latest = self._latest
        return latest.job if latest is not None and latest.shown else None

    def cancel(self) -> bool:
        """Cancel the running reading; return False if there is none."""
        with self._lock:
            if self._latest is None:
                return False
            self._latest.cancelled = True
        return True
