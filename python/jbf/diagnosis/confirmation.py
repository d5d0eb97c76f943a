"""Whether runs that had no part in a fit confirm what a candidate gains in it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.policy import Policy

Names = tuple[str, ...]


@dataclass(frozen=True)
class LeftOut:
    """What a candidate does for runs that were left out, beside the effects present.

    Attributes
    ----------
    before_n, after_n
        RMS without and with it, N.
    better
        Share of the runs that are predicted better.
    halved
        Runs that alone tell of it: their halves took turns in being left out, in both fits.
    """

    before_n: float
    after_n: float
    better: float
    halved: Names = ()

    @classmethod
    def of(cls, candidates: Candidates, present: Names, name: str) -> LeftOut:
        """By fits with the candidate and without it."""
        richer = (*present, name)
        halved = candidates.only_witnesses(richer)
        before, after = (
            candidates.left_out_rms(effects, apart=True, halved=halved)
            for effects in (present, richer)
        )
        runs = [
            candidates.left_out_by_run(effects, apart=True, halved=halved)
            for effects in (present, richer)
        ]
        names = tuple(candidates.campaign.samples.runs[i] for i in sorted(halved))
        return cls(before, after, float(np.mean(runs[1] < runs[0])), names)

    def confirms(self, evidence: float, gained: float, policy: Policy) -> bool:
        """Whether they confirm it, who gains so much in mean square (N^2) where it is fitted."""
        share = (self.before_n**2 - self.after_n**2) / max(gained, 1e-300)
        times = self.after_n / max(self.before_n, 1e-300)
        return left_out_confirms(evidence, share, self.better, policy, times)

    def said(self, unit: str) -> str:
        """The error on what was left out."""
        what = "runs" if not self.halved else f"runs and halves of {_listed(self.halved)}"
        return f"left-out {what} {self.after_n:.4g} {unit}"


def _listed(names: Collection[str]) -> str:
    first, *more = names
    return first if not more else f"{first} and {len(more)} more"


def left_out_confirms(
    evidence: float, gained_share: float, better: float, policy: Policy, times: float = 1.0
) -> bool:
    """Do runs left out confirm what a candidate gains where it is fitted?

    Any gain will do where the evidence is strong, or one in most of the runs: a few runs may hold
    most of the rests, or the reversals, that an effect needs, and without them no fit knows well
    how large the effect is.

    Parameters
    ----------
    gained_share
        Gain in mean square on left-out runs, as a share of that in the fit.
    better
        Share of the runs that are predicted better.
    times
        RMS on left-out runs, over that without the candidate.
    """
    if times > policy.left_out_worse:
        return False
    if evidence <= policy.weak:
        return gained_share > policy.least_left_out_gain
    return gained_share > 0.0 or better >= policy.least_better_runs
