"""How far a diagnosis has come, for one that is stopped before its end."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jbf.estimation.fit import Fit, finish

if TYPE_CHECKING:
    from jbf.diagnosis.candidates import Candidates


@dataclass
class Reached:
    """The model that the last round began from.

    Attributes
    ----------
    candidates, present
        Its fit is among these candidates; None before the law alone was fitted.
    """

    candidates: Candidates | None = None
    present: tuple[str, ...] = ()

    def fit(self) -> Fit | None:
        """That model with its errors; None where there is none yet."""
        if self.candidates is None:
            return None
        # What is left to do is little, and there is nothing after it.
        self.candidates.campaign.work.renew(math.inf)
        problem = self.candidates.fitted(self.present).problem
        return finish(problem, self.candidates.converge(self.present))
