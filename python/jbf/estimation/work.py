"""How much a fit or a diagnosis may cost, in inner steps of the model: whatever the records and the
values that a search strays to, there is an end.

Time would do as well, and would be another on each machine: steps end the same work at the same
place everywhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from jbf.errors import Unfinished

STEPS_A_SAMPLE = 1e5
"""Inner steps that a diagnosis may take for each sample: ten times what the dearest take that
end in a verdict,"""
ANY_STEPS = 4e8
"""and so many in all, whatever the samples: a minute or two."""


@dataclass
class Work:
    """Inner steps that may be taken, and that were."""

    most: float = math.inf
    taken: float = 0.0

    @classmethod
    def of(cls, samples: int) -> Work:
        """What so many samples are worth."""
        return cls(max(STEPS_A_SAMPLE * samples, ANY_STEPS))

    def take(self, steps: float) -> None:
        """Count steps that are about to be taken.

        Raises
        ------
        Unfinished
            They are more than are left.
        """
        self.taken += steps
        if self.taken > self.most:
            raise Unfinished(steps=self.taken)

    def part(self, share: float) -> Work:
        """A share of the whole, for a part of the work that is not to take the rest."""
        return Work(share * self.most)

    def renew(self, most: float | None = None) -> None:
        """Begin to count anew."""
        self.taken = 0.0
        self.most = self.most if most is None else most
