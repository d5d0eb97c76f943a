"""Progress on stderr where that is a terminal; silence elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Report = Callable[[str, int, int], None]


@contextmanager
def shown(message: str) -> Iterator[Report | None]:
    """A line that lives as long as the work; yields `report(message, done, total)`, or None."""
    if sys.stderr is None or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    with Progress(
        SpinnerColumn(),
        # Names of runs may hold brackets, which are no markup.
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
        # rich would send what is printed meanwhile to stderr too, also past a pipe or a file.
        redirect_stdout=sys.stdout.isatty(),
    ) as progress:
        task = progress.add_task(message, total=None)

        def report(message: str, done: int, total: int) -> None:
            progress.update(task, description=message, completed=done, total=total or None)

        yield report
