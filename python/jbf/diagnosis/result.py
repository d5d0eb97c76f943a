"""Result of a diagnosis: verdict, ledger of steps, and residual structure."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from jbf.comparison.comparison import Comparison
from jbf.comparison.patterns import Failure
from jbf.diagnosis.experiment_design.next_run import Experiment
from jbf.diagnosis.ledger import Remainder, Step
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.power import Power
from jbf.diagnosis.verdict import Verdict
from jbf.diagnosis.which_law import LawTried
from jbf.estimation.fit import Fit
from jbf.models.model import Model
from jbf.records.findings.finding import Finding
from jbf.records.run import PathLike
from jbf.results import Result, present


@dataclass(frozen=True, repr=False)
class Diagnosis(Result):
    """Result of a diagnosis: which effects are missing from the model.

    Attributes
    ----------
    verdict
        `adequate`, `missing`, `ambiguous` or `unexplained`.
    limitations
        Conclusions that the motions of these runs do not support, one sentence each.
    machine
        Machine terms of a drive: inertia or mass, weight, offset. They are part of the initial
        model and are not missing effects.
    effects
        Added effects with sufficient evidence, in the order of acceptance.
    alternatives
        For each added effect, those with which it is confounded, the most likely first; also for
        each machine term that is confounded with an effect.
    weights
        For each effect in `alternatives`, its posterior weight and those of its alternatives, at
        equal prior odds.
    steps
        The ledger, beginning with the base law.
    failures
        Lack of fit of the base law, by decreasing size.
    residual_structure
        Residual structure that no effect explains.
    next_experiment
        Description of a further run that would reduce the ambiguity; None if none is proposed.
    fit
        The final fit; the property `model` is its model.
    elapsed_s
        Computing time, s.
    before, after
        Comparison of the base law and of the final model with the runs.
    not_tried
        Effects that are compatible with the law but not testable in these runs, with reasons. Also
        laws, effects and parts of the diagnosis that exceeded the computing budget or a time limit.
    unfinished
        Names in `not_tried` of the laws, effects and parts of the diagnosis that exceeded the
        budget or the time limit; empty for a complete diagnosis.
    not_detectable
        Effects that are not detectable in these runs at their typical strength.
    level
        Acceptance threshold for the gain of an effect, and its false-alarm rate.
    power
        Detection limits of each effect that is not in the model; empty if there is residual
        structure.
    experiment
        Motion of the next run, if a run can discriminate between alternatives or reveal
        undetectable effects.
    policy
        Thresholds and settings that determined the verdict.
    findings
        Recording artefacts by run, and their corrections.
    confounders
        Effects in the model that improve its held-out predictions but are not named, because they
        may describe another mechanism, or the error of another effect's formula.
    laws
        Laws that the rig allows, the selected one first, if the law was selected from the data.
    simpler_law
        Another law whose held-out error and number of parameters do not exceed those of the final
        model, with no effects other than offset, mass and weight. None if no such law was found or
        no search was necessary.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> diagnosis = jbf.diagnose(jbf.Rig(), [run], law="coulomb")
    >>> diagnosis.model.effects, len(diagnosis.steps)
    ((), 1)
    """

    verdict: Verdict
    effects: tuple[str, ...]
    alternatives: dict[str, tuple[str, ...]]
    steps: tuple[Step, ...]
    failures: tuple[Failure, ...]
    residual_structure: tuple[Remainder, ...]
    next_experiment: str | None
    fit: Fit
    before: Comparison
    after: Comparison
    elapsed_s: float
    level: Level
    not_tried: dict[str, str] = field(default_factory=dict)
    not_detectable: tuple[str, ...] = ()
    experiment: Experiment | None = None
    policy: Policy = DEFAULT
    findings: tuple[Finding, ...] = ()
    confounders: tuple[str, ...] = ()
    laws: tuple[LawTried, ...] = ()
    simpler_law: LawTried | None = None
    power: tuple[Power, ...] = ()
    weights: dict[str, dict[str, float]] = field(default_factory=dict)
    machine: tuple[str, ...] = ()
    limitations: tuple[str, ...] = ()
    unfinished: tuple[str, ...] = ()

    @property
    def negligible(self) -> tuple[str, ...]:
        """Effects that are significant but below the minimum effect size.

        They are tested in addition to the final model, against the minimum effect size of the
        policy.
        """
        trials = next((s.trials for s in reversed(self.steps) if s.trials), ())
        return tuple(t.effect for t in trials if t.outcome == "negligible")

    @property
    def model(self) -> Model:
        """Final model: the law with its effects and fitted parameters."""
        return self.fit.model

    def summary(self, full: bool = False) -> str:
        """Return the result as text for a terminal.

        Parameters
        ----------
        full
            Return the complete report, with all candidates and detection limits, in place of the
            summary of at most 30 lines.
        """
        text: str = present("summary", self, full)
        return text

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict as specified by the file contract."""
        return {
            **self.model.units_for_json(),
            "verdict": self.verdict,
            "machine": list(self.machine),
            "effects": list(self.effects),
            "alternatives": {k: list(v) for k, v in self.alternatives.items()},
            "weights": {k: dict(v) for k, v in self.weights.items()},
            "steps": [s.to_dict() for s in self.steps],
            "failures": [f.to_dict() for f in self.failures],
            "residual_structure": [r.to_dict() for r in self.residual_structure],
            "findings": [f.to_dict() for f in self.findings],
            "confounders": list(self.confounders),
            "law": self.model.law,
            "laws": [t.to_dict() for t in self.laws],
            "simpler_law": None if self.simpler_law is None else self.simpler_law.to_dict(),
            "next_experiment": self.next_experiment,
            "parameters": self.model.parameters_for_json(self.fit.parameters),
            "not_tried": dict(self.not_tried),
            "not_detectable": list(self.not_detectable),
            "negligible": list(self.negligible),
            "limitations": list(self.limitations),
            "level": self.level.to_dict(),
            "power": [p.to_dict() for p in self.power],
            "policy": self.policy.to_dict(),
            "elapsed_s": self.elapsed_s,
        }

    def report(self, path: PathLike) -> None:
        """Write the result as an HTML report; equivalent to `save_html`."""
        self.save_html(path)
