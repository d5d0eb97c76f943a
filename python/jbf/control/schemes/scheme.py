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
        """Name of the scheme in options, tables and plots."""
        ...

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """Return the arguments from which the core builds the compensator.

        The argument `kind` selects its type.
        """
        ...

    def guard(self, bench: Bench) -> Settings | None:
        """Return the settings of the loop guard, or None if the scheme has no guard.

        The guard uses `moving_v` and `patience_s`, and stops the compensator if the encoder is
        frozen or the output is saturated.
        """
        ...


class Unguarded:
    """Scheme without a loop guard: only a jump of the counter stops it, as in Cohn (1998)."""

    def guard(self, bench: Bench) -> Settings | None:
        """Return None, since the scheme has no guard; see `Scheme`."""
        return None
