"""The verdict: pure functions from numbers to words, so that each rule can be read, and tested, as
a table."""

from __future__ import annotations

from typing import Literal

from jbf.diagnosis.policy import Policy

Verdict = Literal["adequate", "missing", "ambiguous", "unexplained"]


def verdict(*, effects: int, alternatives: int, remains: bool) -> Verdict:
    """What is said of a campaign.

    Parameters
    ----------
    effects
        How many effects were added.
    alternatives
        How many of them another effect would replace as well.
    remains
        True where structure remains that no effect explains.
    """
    if remains:
        return "unexplained"
    if alternatives:
        return "ambiguous"
    return "missing" if effects else "adequate"


def name_stands(gain: float, disagreement: float | None, policy: Policy) -> bool:
    """Does an effect keep its name though structure remains?

    It rests on its own evidence: whatever else is there takes nothing from it. But of a confounder
    each run asks for its own parameters.

    Parameters
    ----------
    gain
        Of the effect beside the others, in twice the log likelihood of independent samples.
    disagreement
        What parameters of the effect of their own would gain the runs beyond chance, in the same
        unit; None where the runs agree.
    """
    return disagreement is None or gain > policy.clear * disagreement
