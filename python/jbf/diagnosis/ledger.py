"""Parts of a diagnosis: the candidates tried, the gain of each step, and the residual structure."""

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
        Twice the gain in log likelihood, less the acceptance threshold for the candidate's
        parameters; above zero the model with the candidate is better.
    outcome
        `added`, `ties`, `rejected`, `negligible`, `no gain`, `confounder` or `replaced`.
        `negligible`: significant, but below the minimum effect size. `no gain`: no more than
        expected by chance. `confounder`: added, but the runs disagree on its parameters.
        `replaced`: added, and removed when a later effect was better in its place.
    reason
        Reason for the outcome.
    """

    effect: str
    rms_n: float
    evidence: float
    outcome: Outcome
    reason: str

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return dict(vars(self))


@dataclass(frozen=True)
class Extrapolation:
    """A run that exceeds the range of all others, predicted by a fit to those alone.

    Attributes
    ----------
    run
        Its name.
    rms_n
        RMS of the error of that prediction, N; not included in the held-out error.
    where
        Description of the range that it exceeds.
    """

    run: str
    rms_n: float
    where: str

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return dict(vars(self))


@dataclass(frozen=True)
class Step:
    """The model after one addition; the first step is the bare law.

    Attributes
    ----------
    effects
        Effects of the model.
    rms_n
        RMS over the runs that it was fitted to, N.
    holdout_rms_n
        RMS over runs, or parts of runs, each held out of the fit that predicts it, N.
    noise_n
        Noise floor, N; zero where it is not known.
    trials
        The candidates that competed for the next place.
    extrapolations
        Errors of runs that exceed the range of all others; parts of them count in `holdout_rms_n`.
    """

    effects: tuple[str, ...]
    rms_n: float
    holdout_rms_n: float
    noise_n: float
    trials: tuple[Trial, ...] = ()
    extrapolations: tuple[Extrapolation, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
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
    """Residual structure that no effect of the catalogue explains."""

    axis: str
    where: str
    share: float

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {"axis": self.axis, "where": self.where, "share": round(self.share, 4)}
