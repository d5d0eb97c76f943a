"""State of a diagnosis: the fit of each candidate model, and the model of the last round."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from jbf.arrays import Array
from jbf.diagnosis.directions import Directions
from jbf.estimation.approach import Approach, default_starts
from jbf.estimation.campaign import Campaign
from jbf.estimation.fit import Fit, finish
from jbf.estimation.held_out import HeldOutPart
from jbf.estimation.problem import Problem, bounded
from jbf.estimation.solution import Solution
from jbf.models.driven import Driven
from jbf.records.run import Run

if TYPE_CHECKING:
    from jbf.diagnosis.candidates import Candidates
    from jbf.diagnosis.terms.proposal import Proposal

MOTION, INSTEAD_OF_ERRORS = "motion", "instead of errors"
State = Literal["posed", "looked", "ranked", "converged"]


@dataclass
class Fitted:
    """A set of effects added to the law, and the state of its fit.

    Attributes
    ----------
    state
        `posed` (not yet computed), `looked` (a few steps), `ranked` (enough steps for ranking) or
        `converged` (to within `NEAR_MINIMUM`).
    score
        Gain predicted by the score test of the added effects in the first smaller model, in twice
        the log likelihood; infinite if the null cannot be reached by a step.
    directions
        Score directions of that test, kept until the level of the tests has been calibrated.
    stepped
        Parameter values after one step from the null, the starting values for a weak effect.
    approach, max_square
        An unfinished search, and the sum of squares after its first steps below which it is
        continued, N^2.
    started_from
        Effects of the model whose solution was among the starting points; None without one.
    promised
        Gain predicted by the linear model, in twice the log likelihood; infinite after ranking.
    peaks_searched
        Whether the other maxima of the likelihood have been searched.
    held_out
        Held-out predictions of the runs; empty until they are required.
    halves
        Held-out predictions of two halves of a run, by (run, alternate).
    proposals
        Terms estimated for this model, None where they do not change: errors of the motion
        (`MOTION`), and these errors with a further effect (`INSTEAD_OF_ERRORS`).
    """

    problem: Problem
    state: State = "posed"
    solution: Solution | None = None
    score: float | None = None
    directions: Directions | None = None
    stepped: Array | None = None
    approach: Approach | None = None
    max_square: float = np.inf
    started_from: frozenset[str] | None = None
    promised: float = np.inf
    peaks_searched: bool = False
    held_out: list[HeldOutPart] = field(default_factory=list)
    halves: dict[tuple[int, bool], list[HeldOutPart]] = field(default_factory=dict)
    proposals: dict[str, Proposal | None] = field(default_factory=dict)

    @cached_property
    def default_starts(self) -> list[dict[str, float]]:
        """Starting points from default starting values only, as parameter values by name."""
        return default_starts(self.problem)

    def current_solution(self) -> Solution:
        """Return the present solution of the fit, converged or not."""
        assert self.solution is not None
        return self.solution

    def improve(self, better: Solution) -> None:
        """Replace the solution by a better one, and discard its outdated held-out predictions."""
        if better is not self.solution:
            self.solution = better
            self.held_out, self.halves = [], {}

    def named_values(self) -> dict[str, float]:
        """Parameter values of the present solution, by name."""
        return self.problem.values_by_name(self.current_solution().values)

    def predict(self, motion: Driven) -> tuple[Array, Array]:
        """Friction of the fitted model under a motion, and its Jacobian in the search variables."""
        problem, values = self.problem, self.current_solution().values
        ((friction, slopes),) = problem.chain.jacobian(values, [motion], problem.open)
        return friction, bounded(slopes, np.where(problem.log, values, 1.0)[problem.open])


@dataclass
class Reached:
    """Model at the start of the last round, the result of a diagnosis that is interrupted.

    Attributes
    ----------
    candidates, present
        Candidates that include the fit, and effects of the model; None before the first fit.
    runs, campaign
        The recorded and the prepared runs; empty and None before.
    """

    candidates: Candidates | None = None
    present: tuple[str, ...] = ()
    runs: list[Run] = field(default_factory=list)
    campaign: Campaign | None = None

    def fit(self) -> Fit | None:
        """Return the fit of the model with standard errors; None if no model has been fitted."""
        if self.candidates is None:
            return None
        # The remaining work is small and final: lift its limits.
        self.candidates.campaign.work.lift()
        problem = self.candidates.fitted(self.present).problem
        return finish(problem, self.candidates.polish(self.present))
