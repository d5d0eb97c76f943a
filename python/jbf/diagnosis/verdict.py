"""Rules of the verdict as pure functions of numbers, which can be tested as a table."""

from __future__ import annotations

from typing import Literal

from jbf.diagnosis.policy import Policy

Verdict = Literal["adequate", "missing", "ambiguous", "unexplained"]


def verdict(*, effects: int, alternatives: int, remains: bool) -> Verdict:
    """Return the verdict on a campaign.

    Parameters
    ----------
    effects
        Number of effects that were added.
    alternatives
        Number of those that are confounded with another effect.
    remains
        Whether residual structure remains that no effect explains.
    """
    if remains:
        return "unexplained"
    if alternatives:
        return "ambiguous"
    return "missing" if effects else "adequate"


def name_is_supported(gain: float, disagreement: float | None, policy: Policy) -> bool:
    """Whether an effect is named although structure remains.

    An effect is judged by its own evidence, independently of other structure. A confounder,
    however, requires different parameters in each run.

    Parameters
    ----------
    gain
        Gain of the effect in addition to the others, in twice the log likelihood of independent
        samples.
    disagreement
        Gain of run-specific parameters of the effect beyond chance, in the same unit; None where
        the runs agree.
    """
    return disagreement is None or gain > policy.selection.confounder_ratio * disagreement
