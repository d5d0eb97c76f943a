"""Budget of a diagnosis: omitted parts, the time that would suffice, and stages of a round."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

from jbf.diagnosis.candidates import Candidates, Progress
from jbf.diagnosis.fit_state import Reached
from jbf.diagnosis.which_law import followed
from jbf.errors import Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.estimation.work import TimeLimit
from jbf.models.vocabulary import AUTO, Clock

T = TypeVar("T")

ALTERNATIVES, POWER = "alternatives", "detection limits"
SIMPLER_LAWS, NEXT_EXPERIMENT = "simpler laws", "next experiment"

EVALUATIONS = 120
"""Evaluations of the law per candidate in a typical diagnosis. It affects a message only."""
USUAL_CANDIDATES, USUAL_STEPS = 25, 5.0
"""Candidates, and inner steps per sample, before the runs are prepared.

They affect a message only.
"""
CANDIDATES_A_LAW = 5
"""Candidates whose tests take as long as the comparison of one law. It affects a message only."""
STEPS_A_SECOND = 5e6
"""Inner steps of the model per second in a diagnosis, on a slow core. It affects a message only."""

STAGES = {
    "trying the law": (0.0, 1.0),
    "testing": (0.0, 0.1),
    "looking at": (0.1, 0.25),
    "trying": (0.35, 0.4),
    "reviewing": (0.8, 0.0),
}
"""First words of the progress messages of a round: when the stage begins, and how long it takes.

Both are typical shares of the duration of a round; they affect the display of the progress only.
"""


class OptionalParts:
    """Parts of a diagnosis that are omitted if they exceed the budget or the time limit.

    Attributes
    ----------
    omitted
        Name and reason of each omitted part.
    """

    def __init__(self, progress: Progress) -> None:
        self.progress = progress
        self.omitted: dict[str, str] = {}

    def of(self, name: str, compute: Callable[[], T], otherwise: T) -> T:
        """Return the result of a part, or `otherwise` if it is omitted."""
        self.progress(f"computing {name}", 0, 0)
        try:
            return compute()
        except Unfinished as stop:
            self.omitted[name] = stop.reason
            return otherwise


def sufficient_time_s(reached: Reached, law: str, clock: Clock, limit: TimeLimit) -> float:
    """Estimate the time limit within which a diagnosis would probably end, s.

    At least twice the limit that did not suffice. The estimate is rounded up to 1, 2 or 5 times a
    power of ten.
    """
    steps = _steps(reached.campaign, law, clock)
    if steps is None:
        samples = sum(map(len, reached.runs))
        steps = EVALUATIONS * USUAL_CANDIDATES * USUAL_STEPS * samples
    return _rounded_up(max(steps / STEPS_A_SECOND, 2.0 * limit.seconds, 1.0))


def _steps(campaign: Campaign | None, law: str, clock: Clock) -> float | None:
    """Inner steps of a typical diagnosis; None before the runs are prepared."""
    if campaign is None:
        return None
    laws = followed(campaign, clock)[0] if law == AUTO else [law]
    costs = []
    for name in laws:
        problem = Problem(campaign, name, clock, ()).thinned
        motions = problem.campaign.motions
        costs.append(problem.chain.inner_steps(problem.starts({})[0], motions))
    comparison = CANDIDATES_A_LAW * sum(costs) if law == AUTO else 0.0
    tests = max(len(Candidates(campaign, name, clock).names) for name in laws) * max(costs)
    return EVALUATIONS * (tests + comparison)


def _rounded_up(value: float) -> float:
    """Round up to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= value)
