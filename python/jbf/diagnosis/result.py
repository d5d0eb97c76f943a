"""What a diagnosis says: verdict, ledger of steps, what remains."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from jbf.comparison.comparison import Comparison
from jbf.comparison.patterns import Failure
from jbf.diagnosis.experiment import Experiment
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
from jbf.results import Result


@dataclass(frozen=True, repr=False)
class Diagnosis(Result):
    """The answer to "which effect is missing?".

    Attributes
    ----------
    verdict
        `adequate`, `missing`, `ambiguous` or `unexplained`.
    limitations
        Conclusions that the motions of these runs do not allow, in words.
    machine
        Terms of a drive's own machine that the runs need: inertia or mass, weight, offset. They are
        part of the model from the start, and no missing effects.
    effects
        What was added and rests on its own evidence, in the order found.
    alternatives
        For each added effect, those that would fit as well in its place, the likeliest first.
    weights
        For each added effect its posterior weight and theirs, at equal odds before.
    steps
        The ledger, from the bare law on.
    failures
        Where the bare law failed, strongest first.
    unexplained
        Structure that remains.
    next_experiment
        A sentence, where another run would decide.
    fit
        The final fit; `model` is its model.
    before, after
        Comparison of the bare law and of the final model with the runs.
    not_tried
        Effects that go with the law but that these runs cannot show, and why.
    unseen
        Effects that could be there at a usual strength, and that these runs would still not show.
    level
        What an effect had to gain to be named, and how seldom noise makes one gain that.
    power
        How strong each effect that is not in the model would have had to be for these runs to show
        it; empty where something remains that is no noise.
    experiment
        The motion of the next run, where a run would part rivals or show what could hide.
    policy
        The numbers that decided the verdict.
    findings
        What the recording did, run by run, and what was done about it.
    confounders
        Effects that the model has because it predicts runs left out better with them, and that are
        not named: the runs disagree on their parameters.
    laws
        Where the data chose the law: those that the rig allows, the one taken first.
    simpler_law
        Another law that predicts runs left out no worse than the final model, with no more
        parameters and only those effects that are no friction (a zero, a mass, a weight); None
        where there is none, or nothing made it worth a search.
    """

    verdict: Verdict
    effects: tuple[str, ...]
    alternatives: dict[str, tuple[str, ...]]
    steps: tuple[Step, ...]
    failures: tuple[Failure, ...]
    unexplained: tuple[Remainder, ...]
    next_experiment: str | None
    fit: Fit
    before: Comparison
    after: Comparison
    elapsed_s: float
    level: Level
    not_tried: dict[str, str] = field(default_factory=dict)
    unseen: tuple[str, ...] = ()
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

    @property
    def negligible(self) -> tuple[str, ...]:
        """Effects that are significant beside the final model and too small to be worth reporting
        (`indifference` of the policy)."""
        trials = next((s.trials for s in reversed(self.steps) if s.trials), ())
        return tuple(t.effect for t in trials if t.outcome == "negligible")

    @property
    def model(self) -> Model:
        """The final model."""
        return self.fit.model

    def to_dict(self) -> dict[str, Any]:
        """For JSON, as the file contract has it."""
        return {
            **self.model.told_units(),
            "verdict": self.verdict,
            "machine": list(self.machine),
            "effects": list(self.effects),
            "alternatives": {k: list(v) for k, v in self.alternatives.items()},
            "weights": {k: dict(v) for k, v in self.weights.items()},
            "steps": [s.to_dict() for s in self.steps],
            "failures": [f.to_dict() for f in self.failures],
            "unexplained": [r.to_dict() for r in self.unexplained],
            "findings": [f.to_dict() for f in self.findings],
            "confounders": list(self.confounders),
            "law": self.model.law,
            "laws": [t.to_dict() for t in self.laws],
            "simpler_law": None if self.simpler_law is None else self.simpler_law.to_dict(),
            "next_experiment": self.next_experiment,
            "parameters": self.model.told_parameters(self.fit.parameters),
            "not_tried": dict(self.not_tried),
            "unseen": list(self.unseen),
            "negligible": list(self.negligible),
            "limitations": list(self.limitations),
            "level": self.level.to_dict(),
            "power": [p.to_dict() for p in self.power],
            "policy": self.policy.to_dict(),
            "elapsed_s": self.elapsed_s,
        }

    def report(self, path: PathLike) -> None:
        """As `save_html`."""
        self.save_html(path)
