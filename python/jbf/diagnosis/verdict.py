"""The verdict: pure functions from numbers to words, so that each rule can be read, and tested, as
a table."""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Explained:
    """What the added effects explain, where structure remains.

    Attributes
    ----------
    bare_n, now_n
        RMS of the bare law's and of the final model's residual, N.
    remaining
        Share of the final residual's mean square that is structure, 0 to 1.
    gain
        Of the effects over the bare law, in twice the log likelihood of independent samples.
    disagreement
        What parameters of their own would gain the runs beyond chance, in the same unit; None
        where the runs agree.
    """

    bare_n: float
    now_n: float
    remaining: float
    gain: float
    disagreement: float | None


def names_stand(explained: Explained, policy: Policy) -> bool:
    """Do effects keep their names though structure remains?

    They do where they took most of the structure that there was, and gained far more than the runs
    still disagree by: else they may be confounders of what is really there.
    """
    bare, now = explained.bare_n**2, explained.now_n**2
    taken = bare - now
    if taken / max(taken + explained.remaining * now, 1e-300) < policy.least_explained:
        return False
    if explained.disagreement is None:
        return True
    return explained.gain > policy.clear * explained.disagreement
