"""Interface between compensation schemes and the bench."""

from __future__ import annotations

from typing import Any, Protocol

from jbf.control.bench import Bench
from jbf.control.settings import Settings
from jbf.control.task import Task


class Scheme(Protocol):
    """Compensation scheme that the bench can run in its loop."""

    @property
    def name(self) -> str:
        """Name in options, tables and plots."""
        ...

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """Return the arguments from which the core builds its compensator.

        `kind` selects its type.
        """
        ...

    def guard(self, bench: Bench) -> Settings | None:
        """Return the settings whose `moving_v` and `patience_s` guard the loop.

        None for no guard.
        """
        ...


class Unguarded:
    """Scheme without a guard: only a jump of the counter stops it, as in the thesis."""

    def guard(self, bench: Bench) -> Settings | None:
        """Return no guard; see `Scheme`."""
        return None
