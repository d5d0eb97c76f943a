"""Progress of a diagnosis, for the result of an interrupted one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jbf.estimation.fit import Fit, finish

if TYPE_CHECKING:
    from jbf.diagnosis.candidates import Candidates


@dataclass
class Reached:
    """The model from which the last round began.

    Attributes
    ----------
    candidates, present
        The candidates that include its fit, and its effects; None before the law alone was fitted.
    """

    candidates: Candidates | None = None
    present: tuple[str, ...] = ()

    def fit(self) -> Fit | None:
        """That model with its standard errors; None where no model has been fitted yet."""
        if self.candidates is None:
            return None
        # The remaining work is small and final: lift the limit on computing steps.
        self.candidates.campaign.work.renew(math.inf)
        problem = self.candidates.fitted(self.present).problem
        return finish(problem, self.candidates.converge(self.present))
