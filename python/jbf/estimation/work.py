"""Budget of a fit or a diagnosis: inner steps of the model, and optionally a time limit.

The number of inner steps always limits the duration of a computation. It does not depend on the
machine, so that a computation ends at the same point everywhere. A time limit is chosen by the
user; a result that it cuts short depends on the speed of the machine.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from numbers import Real

from jbf.errors import InputError, Unfinished
from jbf.records.arguments import described

STEPS_A_SAMPLE = 1e5
"""Number of integration steps per sample that a diagnosis may take. This is ten times the number of
the most expensive diagnoses that end in a verdict."""
ANY_STEPS = 4e8
"""Number of integration steps that are permitted for any number of samples."""


@dataclass(frozen=True)
class TimeLimit:
    """Duration after which a computation ends with its best result so far; begins when created.

    Functions with an argument `time_limit_s` accept it in place of a number, so that several calls
    can share one limit.

    Parameters
    ----------
    seconds
        The duration, s.
    clock
        Function that returns a time that never decreases, s.

    Raises
    ------
    InputError
        The duration is not a positive number.

    Examples
    --------
    >>> limit = jbf.TimeLimit(60.0)
    >>> limit.reached, limit.remaining_s > 59.0
    (False, True)
    """

    seconds: float
    clock: Callable[[], float] = time.monotonic
    share: float = field(default=1.0, init=False)
    end: float = field(default=math.inf, init=False)

    def __post_init__(self) -> None:
        check_seconds(self.seconds, "the time limit")
        object.__setattr__(self, "end", self.clock() + float(self.seconds))

    @classmethod
    def of(cls, value: float | TimeLimit | None) -> TimeLimit | None:
        """Return the limit of an argument `time_limit_s`; a number begins now."""
        if value is None or isinstance(value, TimeLimit):
            return value
        check_seconds(value, "time_limit_s")
        return cls(float(value))

    @property
    def remaining_s(self) -> float:
        """Remaining time, s; zero if the limit is reached."""
        return max(self.end - self.clock(), 0.0)

    @property
    def reached(self) -> bool:
        """Whether no time remains."""
        return self.remaining_s <= 0.0

    def part(self, share: float) -> TimeLimit:
        """Return a limit that begins now and ends after a fraction of the remaining time."""
        part = replace(self)
        object.__setattr__(part, "share", share * self.share)
        object.__setattr__(part, "end", self.end - (1.0 - share) * self.remaining_s)
        return part

    def check(self, steps: float = 0.0) -> None:
        """Raise `Unfinished` if the limit is reached; `steps` is the number of steps taken."""
        if self.reached:
            raise Unfinished(steps=steps, time_limit_s=self.seconds, share=self.share)


def check_seconds(value: object, what: str) -> None:
    """Raise an InputError about `what` if the value is not a positive number of seconds."""
    number = isinstance(value, Real) and not isinstance(value, bool)
    if number and math.isfinite(float(value)) and float(value) > 0.0:  # type: ignore[arg-type]
        return
    shown = f"{value:g} s" if number else described(value)
    raise InputError(problem=f"{what} is {shown}", remedy="give a positive number of seconds")


@dataclass
class Work:
    """Budget of inner steps, the number of steps taken, and the time limit.

    Attributes
    ----------
    most, taken
        The budget and the count of inner steps.
    time_limit
        Second limit of the same work; None without one.
    """

    most: float = math.inf
    taken: float = 0.0
    time_limit: TimeLimit | None = None

    @classmethod
    def of(cls, samples: int, time_limit: TimeLimit | None = None) -> Work:
        """Return the budget for a number of samples."""
        return cls(max(STEPS_A_SAMPLE * samples, ANY_STEPS), time_limit=time_limit)

    def take(self, steps: float) -> None:
        """Add steps to the count before they are computed.

        Raises
        ------
        Unfinished
            The steps exceed the remaining budget, or the time limit is reached.
        """
        self.check()
        self.taken += steps
        if self.taken > self.most:
            raise Unfinished(steps=self.taken)

    def check(self) -> None:
        """Raise `Unfinished` if the time limit is reached."""
        if self.time_limit is not None:
            self.time_limit.check(self.taken)

    def part(self, share: float) -> Work:
        """Return a separate budget of a fraction of this one, for a part of the computation."""
        limit = self.time_limit
        return Work(share * self.most, time_limit=None if limit is None else limit.part(share))

    def renew(self, most: float | None = None) -> None:
        """Reset the number of steps taken, and optionally set a new budget."""
        self.taken = 0.0
        self.most = self.most if most is None else most

    def lift(self) -> None:
        """Remove both limits, for small work that completes a partial result."""
        self.renew(math.inf)
        self.time_limit = None

    @contextmanager
    def untimed(self) -> Iterator[None]:
        """Suspend the time limit, for small work without which there is no result."""
        limit, self.time_limit = self.time_limit, None
        try:
            yield
        finally:
            self.time_limit = limit
