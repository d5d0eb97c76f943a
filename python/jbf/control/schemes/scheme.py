"""What every scheme gives to the bench."""

from __future__ import annotations

from typing import Any, Protocol

from jbf.control.bench import Bench
from jbf.control.settings import Settings
from jbf.control.task import Task


class Scheme(Protocol):
    """Anything that the bench can put into its loop."""

    @property
    def name(self) -> str:
        """Its name in options, tables and pictures."""
        ...

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """What the core's compensator is built from; `kind` says which it is."""
        ...

    def guard(self, bench: Bench) -> Settings | None:
        """Settings whose `moving_v` and `patience_s` guard the loop; None for no guard."""
        ...


class Unguarded:
    """Nothing but a jump of the counter stops it, as in the thesis."""

    def guard(self, bench: Bench) -> Settings | None:
        """See `Scheme`."""
        return None
