"""The parts of a diagnosis: what was tried, what each step brought, what remains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

Outcome = Literal["added", "ties", "rejected", "negligible", "no gain", "confounder", "replaced"]


@dataclass(frozen=True)
class Trial:
    """One candidate at one step of the ledger.

    Attributes
    ----------
    effect
        Name of the candidate.
    rms_n
        Fit RMS with it, N.
    evidence
        Twice the gain in log likelihood, less what chance and the candidate's parameters would
        gain; above zero it is better than nothing.
    outcome
        `added`, `ties`, `rejected`, `negligible` (significant, but smaller than the smallest effect
        that is worth reporting), `no gain` (no more than chance gives), `confounder` (added, but
        the runs disagree on its parameters), or `replaced` (added, and removed when a later one did
        better in its place).
    reason
        Why, in words.
    """

    effect: str
    rms_n: float
    evidence: float
    outcome: Outcome
    reason: str

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return dict(vars(self))


@dataclass(frozen=True)
class Extrapolation:
    """A run beyond the range of all others, predicted by a fit to those alone.

    Attributes
    ----------
    run
        Its name.
    rms_n
        RMS of the error of that prediction, N; no part of the held-out error.
    where
        What it goes beyond, in words.
    """

    run: str
    rms_n: float
    where: str

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return dict(vars(self))


@dataclass(frozen=True)
class Step:
    """The model after one addition (the first: the bare law).

    `rms_n` is over the runs it was fitted to; `holdout_rms_n` over runs, or parts of runs, that
    each had no part in the fit that predicts them; `noise_n` the noise floor, zero where it is not
    known; all N. `trials` are the candidates that competed for the next place. `extrapolations`
    are the errors of runs that go beyond all others: parts of them count in `holdout_rms_n`.
    """

    effects: tuple[str, ...]
    rms_n: float
    holdout_rms_n: float
    noise_n: float
    trials: tuple[Trial, ...] = ()
    extrapolations: tuple[Extrapolation, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "effects": list(self.effects),
            "rms_n": self.rms_n,
            "holdout_rms_n": self.holdout_rms_n,
            "noise_n": self.noise_n or None,
            "tried": [t.to_dict() for t in self.trials],
            "extrapolated": [e.to_dict() for e in self.extrapolations],
        }


@dataclass(frozen=True)
class Remainder:
    """Structure that nothing in the catalogue explains."""

    axis: str
    where: str
    share: float

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"axis": self.axis, "where": self.where, "share": round(self.share, 4)}
