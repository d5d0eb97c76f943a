"""Progress on stderr: a bar on a terminal, otherwise one line per minute."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread

from jbf.errors import printable

Report = Callable[[str, int, int], None]

LOG_INTERVAL_S = 60.0


@contextmanager
def shown(message: str, log_interval_s: float = LOG_INTERVAL_S) -> Iterator[Report]:
    """Context in which the progress of a computation is shown on stderr.

    The context yields the function `report(message, done, total)`.

    Parameters
    ----------
    message
        Description of the work until the first report.
    log_interval_s
        Time between the lines of the log where stderr is not a terminal.
    """
    if sys.stderr is None:
        yield lambda message, done, total: None
    elif sys.stderr.isatty():
        with _bar(message) as report:
            yield report
    else:
        with _log(message, log_interval_s) as report:
            yield report


@contextmanager
def _bar(message: str) -> Iterator[Report]:
    """Context with a progress bar."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    with Progress(
        SpinnerColumn(),
        # Run names may contain brackets, which are not markup.
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
        # Otherwise rich would redirect printed output to stderr, even from a pipe or a file.
        redirect_stdout=sys.stdout is not None and sys.stdout.isatty(),
    ) as progress:
        task = progress.add_task(message, total=None)

        def report(message: str, done: int, total: int) -> None:
            progress.update(task, description=message, completed=done, total=total or None)

        yield report


@contextmanager
def _log(message: str, interval_s: float) -> Iterator[Report]:
    """Context with a log of one line per interval."""
    start_s, finished, state = time.monotonic(), Event(), [message]

    def report(message: str, done: int, total: int) -> None:
        state[0] = f"{message}, {done} of {total}" if total else message

    def write() -> None:
        while not finished.wait(interval_s):
            elapsed_min = (time.monotonic() - start_s) / 60.0
            line = f"jbf: {printable(state[0])} ({elapsed_min:.0f} min)\n"
            sys.stderr.write(line)
            sys.stderr.flush()

    thread = Thread(target=write, daemon=True)
    thread.start()
    try:
        yield report
    finally:
        finished.set()
        thread.join()
