"""Decide which added effects are named where structure remains, and which model predicts best.

An effect is judged by its own evidence. Bursts, tones or a nonlinear force sensor do not affect
its name, unless its evidence is weak and they are larger. The parameters of a confounder differ
between runs, because the mechanism that it replaces differs. A confounder is not named, but it
stays in the model where it improves the predictions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.ledger import Remainder, Step, Trial
from jbf.diagnosis.machine import machine_of
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.residual_structure.constancy import disagreement
from jbf.diagnosis.verdict import name_is_supported
from jbf.estimation.likelihood import effective_share, likelihood_gain
from jbf.models.catalogue import Parameter, find_effect
from jbf.models.parameter_value import ParameterValue

Names = tuple[str, ...]


def confounders(candidates: Candidates, present: Names, remains: Sequence[Remainder] = ()) -> Names:
    """Find the effects that are not named because they may imitate something else.

    The first kind are effects on whose parameters the runs disagree. The second kind are effects of
    weak evidence that explain less than the largest residual structure; they may imitate a part of
    it.

    Parameters
    ----------
    remains
        Residual structure of the model with the present effects.
    """
    whole, problem = candidates.converge(present), candidates.fitted(present).problem
    share, policy = effective_share(whole), candidates.policy
    largest = max((r.share for r in remains), default=0.0)
    found = []
    machine = machine_of(candidates, present)
    for name in present:
        if name in machine:
            continue
        rest = candidates.converge(tuple(e for e in present if e != name))
        gain = likelihood_gain(whole, rest) * share
        own = disagreement(problem, whole, name, policy)
        beyond = own.gain - own.degrees if own.beyond_chance(policy) else None
        explained = 1.0 - (whole.rms / rest.rms) ** 2
        weak = gain - price_of(candidates, whole.free - rest.free) <= policy.selection.weak_evidence
        if (weak and explained < largest) or not name_is_supported(gain, beyond, policy):
            found.append(name)
    return tuple(found)


def effects_without_estimate(
    parameters: Mapping[str, ParameterValue], effects: Names, policy: Policy
) -> Names:
    """Find the effects none of whose parameters is estimated: held, or not different from its null.

    A parameter whose null is infinite, or that has none, must be larger than its standard error by
    the same factor.
    """

    def estimated(name: str, page: Parameter) -> bool:
        value = parameters.get(name)
        if value is None or value.held or value.stderr is None:
            return False
        null = 0.0 if page.null is None or not math.isfinite(page.null) else page.null
        return abs(value.value - null) > policy.selection.min_estimate_sigma * value.stderr

    pages = {name: find_effect(name).parameters for name in effects}
    return tuple(
        name
        for name, parts in pages.items()
        if not any(estimated(f"{name}.{page.name}", page) for page in parts)
    )


def best_predicting(candidates: Candidates, present: Names, named: Names) -> Names:
    """The model with or without the confounders, whichever has the smaller held-out error."""
    if named == present:
        return present
    whole, less = (candidates.held_out_rms(names) for names in (present, named))
    return present if whole < less else named


CONFOUNDER = (
    "not named: the runs disagree on it, more remains than it explains, or no parameter of it is "
    "identifiable"
)
REPLACED = "added first, but not needed with the effects added later"


def with_final_outcomes(steps: Sequence[Step], present: Names, doubted: Names) -> list[Step]:
    """Update the outcome of each addition in all steps of the ledger."""

    def final_outcome(trial: Trial) -> Trial:
        if trial.outcome == "added" and trial.effect in doubted:
            return replace(trial, outcome="confounder", reason=CONFOUNDER)
        if trial.outcome == "added" and trial.effect not in present:
            return replace(trial, outcome="replaced", reason=REPLACED)
        return trial

    return [replace(step, trials=tuple(final_outcome(t) for t in step.trials)) for step in steps]
