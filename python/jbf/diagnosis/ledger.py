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
    rms
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
    rms: float
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
    rms
        RMS of the error of that prediction, N; not included in the held-out error.
    where
        Description of the range that it exceeds.
    """

    run: str
    rms: float
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
    rms
        RMS over the runs that it was fitted to, N.
    held_out_rms
        RMS over runs, or parts of runs, each held out of the fit that predicts it, N.
    noise_rms
        Noise floor, N; zero where it is not known.
    trials
        The candidates that competed for the next place.
    extrapolations
        Errors of runs that exceed the range of all others; parts of them count in `held_out_rms`.
    """

    effects: tuple[str, ...]
    rms: float
    held_out_rms: float
    noise_rms: float
    trials: tuple[Trial, ...] = ()
    extrapolations: tuple[Extrapolation, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {
            "effects": list(self.effects),
            "rms": self.rms,
            "held_out_rms": self.held_out_rms,
            "noise_rms": self.noise_rms or None,
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
