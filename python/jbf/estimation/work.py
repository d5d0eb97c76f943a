"""Budget of a fit or a diagnosis in inner steps of the model.

The budget limits the duration of every computation. It is counted in steps and not in seconds, so
that a computation ends at the same point on every machine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from jbf.errors import Unfinished

STEPS_A_SAMPLE = 1e5
"""Inner steps per sample that a diagnosis may take.

This is ten times the number of the most expensive diagnoses that end in a verdict. It bounds the
computing time only.
"""
ANY_STEPS = 4e8
"""Inner steps that are permitted for any number of samples: one or two minutes.

It limits the effort only.
"""


@dataclass
class Work:
    """Budget of inner steps, and the number of steps taken."""

    most: float = math.inf
    taken: float = 0.0

    @classmethod
    def of(cls, samples: int) -> Work:
        """Return the budget for a number of samples."""
        return cls(max(STEPS_A_SAMPLE * samples, ANY_STEPS))

    def take(self, steps: float) -> None:
        """Add steps to the count before they are taken.

        Raises
        ------
        Unfinished
            The steps exceed the remaining budget.
        """
        self.taken += steps
        if self.taken > self.most:
            raise Unfinished(steps=self.taken)

    def part(self, share: float) -> Work:
        """Return a separate budget of a fraction of this one, for a part of the computation."""
        return Work(share * self.most)

    def renew(self, most: float | None = None) -> None:
        """Reset the count, and optionally set a new budget."""
        self.taken = 0.0
        self.most = self.most if most is None else most
