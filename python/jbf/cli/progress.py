"""Progress display on stderr if it is a terminal, otherwise none."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[str, int, int], None]


@contextmanager
def shown(message: str) -> Iterator[Report | None]:
    """Show a progress line during the work.

    Yields `report(message, done, total)`, or None if stderr is not a terminal.
    """
    if sys.stderr is None or not sys.stderr.isatty():
        yield None
        return
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
        redirect_stdout=sys.stdout.isatty(),
    ) as progress:
        task = progress.add_task(message, total=None)

        def report(message: str, done: int, total: int) -> None:
            progress.update(task, description=message, completed=done, total=total or None)

        yield report
