"""Budget of computing steps for a fit or a diagnosis.

The budget limits the duration of every computation. It is counted in steps and not in seconds, so
that a computation ends at the same point on every machine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from jbf.errors import Unfinished

STEPS_A_SAMPLE = 1e5
"""Number of integration steps per sample that a diagnosis may take.

This is ten times the number of the most expensive diagnoses that end in a verdict. It bounds the
computing time only.
"""
ANY_STEPS = 4e8
"""Number of integration steps that are permitted for any number of samples.

It limits the effort only.
"""


@dataclass
class Work:
    """Budget of integration steps (`most`), and the number of steps taken so far (`taken`)."""

    most: float = math.inf
    taken: float = 0.0

    @classmethod
    def of(cls, samples: int) -> Work:
        """Create the budget for a campaign with this number of samples."""
        return cls(max(STEPS_A_SAMPLE * samples, ANY_STEPS))

    def take(self, steps: float) -> None:
        """Add steps to the count before they are computed.

        Raises
        ------
        Unfinished
            The steps exceed the remaining budget.
        """
        self.taken += steps
        if self.taken > self.most:
            raise Unfinished(steps=self.taken)

    def part(self, share: float) -> Work:
        """Create a separate budget of a fraction `share` of this one."""
        return Work(share * self.most)

    def renew(self, most: float | None = None) -> None:
        """Reset the number of steps taken, and optionally set a new budget."""
        self.taken = 0.0
        self.most = self.most if most is None else most
