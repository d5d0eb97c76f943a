"""Ledger of a diagnosis: the model after each step, and the candidates tried in each step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from jbf.arrays import Names

Outcome = Literal["added", "ties", "rejected", "negligible", "no gain", "confounder", "replaced"]

CONFOUNDER = (
    "not named: the runs disagree on it, more structure remains than it explains, it may correct "
    "the formula of a larger effect, or none of its parameters is identifiable"
)
SEARCH = "search"
"""Axis of a remainder that reports a search ended by the budget or a time limit."""
REPLACED = "added first, but not needed with the effects added later"


@dataclass(frozen=True)
class Trial:
    """Result of one candidate effect in one step of the ledger.

    Attributes
    ----------
    effect
        Name of the candidate.
    rms
        RMS of the residual of the fit with the candidate, N.
    evidence
        Twice the gain in log likelihood, less the acceptance threshold for the candidate's
        parameters; above zero the model with the candidate is better.
    outcome
        `added`, `ties`, `rejected`, `negligible`, `no gain`, `confounder` or `replaced`.
        `negligible`: significant, but below the minimum effect size. `no gain`: not larger than
        expected by chance. `confounder`: added, but it may describe another mechanism.
        `replaced`: added, and later replaced by another effect.
    reason
        Reason for the outcome.
    unconfirmed
        Whether it was rejected because the held-out runs do not confirm its gain; not in `to_dict`.
    """

    effect: str
    rms: float
    evidence: float
    outcome: Outcome
    reason: str
    unconfirmed: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {key: value for key, value in vars(self).items() if key != "unconfirmed"}


@dataclass(frozen=True)
class Extrapolation:
    """Prediction error of a run whose speed or load is beyond the range of all others.

    Attributes
    ----------
    run
        Name of the run.
    rms
        RMS of the prediction error, N; not included in the held-out error.
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
    """Model after the addition of an effect or term; the first step is the base law.

    Attributes
    ----------
    effects
        Effects of the model.
    rms
        RMS of the residual, N.
    held_out_rms
        RMS of the held-out prediction errors, over runs or parts of runs, N.
    noise_rms
        Noise floor, N, at most the RMS of the final model; zero if unknown.
    trials
        Results of the candidates for the next addition.
    extrapolations
        Errors of runs whose speed or load is beyond the range of all others; `held_out_rms`
        includes parts of these runs.
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
    """Residual structure that no effect of the catalogue explains.

    Attributes
    ----------
    axis
        Kind of structure, for example the quantity over which the residual has a pattern.
    where
        Description of the structure.
    share
        Share of the mean square of the residual, 0 to 1.
    """

    axis: str
    where: str
    share: float

    @property
    def unfinished(self) -> bool:
        """Whether it reports an incomplete search in place of structure."""
        return self.axis == SEARCH

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {"axis": self.axis, "where": self.where, "share": round(self.share, 4)}


def with_final_outcomes(steps: Sequence[Step], present: Names, doubted: Names) -> list[Step]:
    """Return the ledger with the final outcome of each added effect.

    The final model has the effects `present`. Those in `doubted` are not named, because they may be
    confounders.
    """

    def final_outcome(trial: Trial) -> Trial:
        """Trial of an added effect with the outcome `confounder` or `replaced` where it applies."""
        if trial.outcome == "added" and trial.effect in doubted:
            return replace(trial, outcome="confounder", reason=CONFOUNDER)
        if trial.outcome == "added" and trial.effect not in present:
            return replace(trial, outcome="replaced", reason=REPLACED)
        return trial

    return [replace(step, trials=tuple(final_outcome(t) for t in step.trials)) for step in steps]
