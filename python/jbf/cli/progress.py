"""Progress on stderr: a bar on a terminal, otherwise one line per minute."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from threading import Event, Thread
from typing import TYPE_CHECKING

from jbf.errors import printable

if TYPE_CHECKING:
    from jbf.estimation.work import TimeLimit

Report = Callable[[str, int, int], None]
Stages = Mapping[str, tuple[float, float]]
"""Start and duration of each stage of a round, as shares of the round, by first words."""

LOG_INTERVAL_S = 60.0
LEAST_SHARE = 0.02
"""Share of a round from which its remaining time is estimated."""


class Estimate:
    """Remaining time of the work, from its progress reports, and of a time limit.

    Parameters
    ----------
    stages
        Stages of a round; without them, `done` and `total` cover the whole work.
    time_limit
        The time limit, if any.
    clock
        Function that returns a time that never decreases, s.
    """

    def __init__(
        self,
        stages: Stages | None = None,
        time_limit: TimeLimit | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.stages, self.time_limit, self.clock = stages, time_limit, clock
        self._begun, self._share = clock(), 0.0
        self._end: float | None = None

    def report(self, message: str, done: int, total: int) -> None:
        """Update the estimate; a smaller share than in the last report begins a new round."""
        share, now = self._share_of(message, done, total), self.clock()
        if not share or share < self._share:
            self._begun = now
        self._share = share or 0.0
        known = self._share >= LEAST_SHARE
        self._end = self._begun + (now - self._begun) / self._share if known else None

    def _share_of(self, message: str, done: int, total: int) -> float | None:
        """Completed share of a round; None for work of unknown duration."""
        within = done / total if total else 0.0
        if self.stages is None:
            return within if total else None
        for words, (start, duration) in self.stages.items():
            if message.startswith(words):
                return start + duration * within
        return None

    def words(self) -> str:
        """Describe the remaining time; empty if it is unknown."""
        parts = []
        if self._end is not None and self._end > self.clock():
            of = "this round: " if self.stages else ""
            parts.append(f"{of}about {_duration(self._end - self.clock())} left")
        if self.time_limit is not None:
            parts.append(f"{_duration(self.time_limit.remaining_s)} to the time limit")
        return ", ".join(parts)


def _duration(seconds: float) -> str:
    """Format a duration in one unit."""
    for size, unit in ((3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{max(seconds, 0.0):.0f} s"


@contextmanager
def shown(
    message: str,
    log_interval_s: float = LOG_INTERVAL_S,
    *,
    stages: Stages | None = None,
    time_limit: TimeLimit | None = None,
) -> Iterator[Report]:
    """Show the progress of the work.

    The context yields the function `report(message, done, total)`.

    Parameters
    ----------
    message
        Description of the work until the first report.
    log_interval_s
        Time between the lines of the log where stderr is not a terminal.
    stages
        Stages of a round of the work, for the estimate of the remaining time on a terminal.
    time_limit
        Time limit of the work; the remaining time is shown on a terminal.
    """
    if sys.stderr is None:
        yield lambda message, done, total: None
    elif sys.stderr.isatty():
        with _bar(message, Estimate(stages, time_limit)) as report:
            yield report
    else:
        with _log(message, log_interval_s) as report:
            yield report


@contextmanager
def _bar(message: str, estimate: Estimate) -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        ProgressColumn,
        SpinnerColumn,
        Task,
        TextColumn,
        TimeElapsedColumn,
    )
    from rich.text import Text

    class EstimateColumn(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(estimate.words())

    with Progress(
        SpinnerColumn(),
        # Run names may contain brackets, which are not markup.
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TimeElapsedColumn(),
        EstimateColumn(),
        console=Console(stderr=True),
        transient=True,
        # Otherwise rich would redirect printed output to stderr, even from a pipe or a file.
        redirect_stdout=sys.stdout is not None and sys.stdout.isatty(),
    ) as progress:
        task = progress.add_task(message, total=None)

        def report(message: str, done: int, total: int) -> None:
            estimate.report(message, done, total)
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
