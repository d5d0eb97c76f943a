"""A model that a diagnosis compares with others, and how far it has been fitted."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.level import Directions
from jbf.estimation.approach import Approach
from jbf.estimation.left_out import LeftOut
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]
State = Literal["posed", "looked", "ranked", "converged"]


@dataclass
class Fitted:
    """A set of effects beside the law, as far as it has been fitted.

    Attributes
    ----------
    state
        `posed`, `looked` (at first sight), `ranked` (a few steps) or `converged`.
    score
        What its score test promised beside the first model that asked, in twice the log
        likelihood; infinite where the null is out of a step's reach.
    directions
        Where its score was tested; until the level of the tests has been calibrated by them.
    stepped
        Where one step from its null leads: near a weak effect.
    approach, least
        A fit that was looked at only, and the sum of squares that it must come below to be
        followed.
    promised
        What it may gain by the linear model, in twice the log likelihood; infinite once it was
        followed.
    peaks_searched
        True once its other peaks were looked for.
    left_out
        Runs that were left out of the fit; empty until somebody asks.
    halves
        Held-out predictions of two halves of a run, by (run, alternate).
    """

    problem: Problem
    state: State = "posed"
    solution: Solution | None = None
    score: float | None = None
    directions: Directions | None = None
    stepped: Array | None = None
    approach: Approach | None = None
    least: float = np.inf
    promised: float = np.inf
    peaks_searched: bool = False
    left_out: list[LeftOut] = field(default_factory=list)
    halves: dict[tuple[int, bool], list[LeftOut]] = field(default_factory=dict)

    def found(self) -> Solution:
        """The solution so far."""
        assert self.solution is not None
        return self.solution

    def improve(self, better: Solution) -> None:
        """Take a better solution of the same problem; what followed from the other is void."""
        if better is not self.solution:
            self.solution = better
            self.left_out, self.halves = [], {}

    def named_values(self) -> dict[str, float]:
        """Parameter name to value."""
        return dict(zip(self.problem.names, self.found().values.tolist(), strict=True))
