"""Verdict of a diagnosis: rules, named effects and limitations of the conclusions.

`verdict` is a pure function of numbers. Each effect is judged by its own evidence. Other residual
structure, such as bursts or tones, does not prevent an effect from being named, unless the evidence
is weak and the structure is larger. A confounder describes another mechanism, so that its
parameters differ between runs, or the error of another effect's formula, which is an approximation.
It is not named, but it is kept in the model if it improves the predictions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from jbf.arrays import Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.residual_structure.constancy import disagreement
from jbf.diagnosis.review import machine_of
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.starting_values import scales
from jbf.models.catalogue import Parameter, find_effect
from jbf.models.parameter_value import ParameterValue

Verdict = Literal["adequate", "missing", "ambiguous", "unexplained"]

OF_SPEED = frozenset({"quadratic_drag", "shear_thinning", "stribeck_excess", "viscous_thinning"})
"""Effects that change the dependence of the friction on the magnitude of the speed only."""
WITH_SPEED = OF_SPEED | {
    "viscous_asymmetry",
    "viscous_load_dependence",
    "viscous_temperature_dependence",
}
"""Effects whose force depends on the speed, at least as one of its factors."""
LEVEL, STIFFNESS = "F_c", "sigma_0"
"""Parameters of a bristle law; their ratio is the presliding displacement."""


def verdict(*, effects: int, alternatives: int, remains: bool) -> Verdict:
    """Return the verdict on a campaign (`adequate`, `missing`, `ambiguous` or `unexplained`).

    `effects` is the number of added effects, `alternatives` the number of those that are confounded
    with another effect. `remains` states whether there is residual structure that no effect
    explains.
    """
    if remains:
        return "unexplained"
    if alternatives:
        return "ambiguous"
    return "missing" if effects else "adequate"


def confounders(candidates: Candidates, present: Names, remains: Sequence[Remainder] = ()) -> Names:
    """Find the effects that are not named because they may imitate another mechanism.

    These are effects whose parameters differ between runs, and effects that may imitate a part of
    the largest residual structure of the model (`remains`): those that explain much less, or, with
    weak evidence, less than this structure.
    """
    full, problem = candidates.converge(present), candidates.fitted(present).problem
    share, policy = candidates.independent_share(full), candidates.policy
    largest, count = max((r.share for r in remains), default=0.0), full.samples.count
    doubted = []
    machine = machine_of(candidates.campaign.rig, present)
    for name in present:
        if name in machine:
            continue
        rest = candidates.converge(tuple(e for e in present if e != name))
        gain = likelihood_gain(full, rest) * share
        # Convert n log(S0 / S1) to (S0 - S1) / sigma^2, the unit of the disagreement.
        decrease = share * count * math.expm1(min(gain / (share * count), 100.0))
        test = disagreement(problem, full, name, policy)
        least = policy.selection.confounder_ratio * (test.gain - test.degrees)
        disagrees = test.beyond_chance(policy) and decrease <= least
        explained = 1.0 - (full.rms / rest.rms) ** 2
        weak = gain - candidates.price(full.free - rest.free) <= policy.selection.weak_evidence
        size_ratio = 1.0 if weak else policy.selection.min_size_ratio
        if explained < size_ratio**2 * largest or disagrees:
            doubted.append(name)
    return tuple(doubted)


def formula_corrections(candidates: Candidates, present: Names) -> Names:
    """Find effects of the speed that may only correct the formula of a larger effect.

    The formulas of the catalogue are approximations, and their errors cannot be distinguished from
    small effects. An effect of the speed is taken for a correction if it decreases the mean square
    by less than the square of `min_size_ratio` times the decrease by the largest effect
    `WITH_SPEED`.
    """
    members = [name for name in present if name in WITH_SPEED]
    others = tuple(name for name in present if name not in members)
    if len(members) < 2:
        return ()

    def mean_square(*added: str) -> float:
        """Mean square residual with some of these effects."""
        return candidates.converge((*others, *added)).rms ** 2

    largest = min(members, key=mean_square)
    least = candidates.policy.selection.min_size_ratio**2 * (mean_square() - mean_square(largest))
    return tuple(
        name
        for name in members
        if name in OF_SPEED and name != largest
        if mean_square(largest) - mean_square(largest, name) < least
    )


def effects_without_estimate(
    parameters: Mapping[str, ParameterValue], effects: Names, policy: Policy
) -> Names:
    """Find effects of which no parameter is estimated and significantly different from its null.

    One such parameter is sufficient, since all but one of several that cannot be distinguished in
    these runs are held fixed. A parameter with an infinite null, or without a null (a time
    constant), is compared with zero. Only the amplitude of an effect with a phase is considered,
    since its period always differs from zero.
    """

    def estimated(name: str, page: Parameter) -> bool:
        """Whether a parameter is estimated and significantly different from its null."""
        value = parameters.get(name)
        if value is None or value.stderr is None:
            return False  # a held parameter has no standard error
        null = 0.0 if page.null is None or not math.isfinite(page.null) else page.null
        return abs(value.value - null) > policy.selection.min_estimate_sigma * value.stderr

    without = []
    for name in effects:
        pages = find_effect(name).parameters
        if any(page.period is not None for page in pages):
            pages = tuple(page for page in pages if page.null is not None)
        if not any(estimated(f"{name}.{page.name}", page) for page in pages):
            without.append(name)
    return tuple(without)


def best_predicting(candidates: Candidates, present: Names, named: Names) -> Names:
    """Select the present or the named effects, whichever have the smaller held-out error."""
    if named == present:
        return present
    error, error_named = (candidates.held_out_rms(names) for names in (present, named))
    return present if error < error_named else named


def limitations(
    campaign: Campaign, parameters: Mapping[str, float], policy: Policy
) -> tuple[str, ...]:
    """Describe each conclusion that the recorded motions do not support, for any model.

    The fitted parameters of a bristle law give the presliding displacement.
    """
    quantities = campaign.rig.quantities
    speed = campaign.samples.flat([p.motion.velocity for p in campaign.prepared])
    if not len(speed):
        return ()
    sentences = []
    forward = float(np.mean(speed > 0.0))
    if min(forward, 1.0 - forward) < policy.limitations.min_reverse_share:
        sentences.append(
            "the motion has one direction: Coulomb friction and a constant load or offset have "
            "the same effect"
        )
    slow, fast = (float(q) for q in np.quantile(np.abs(speed), [0.05, 0.95]))
    span = f"{slow:.2g} to {fast:.2g} {quantities.speed}"
    if fast < policy.limitations.min_speed_ratio * slow:
        sentences.append(
            f"the speed hardly changes ({span}): Coulomb and viscous friction have the same effect"
        )
    elif fast < policy.limitations.wide_speed_ratio * slow:
        sentences.append(
            f"the speeds cover less than a decade ({span}): friction at other speeds is an "
            "extrapolation"
        )
    level, stiffness = (parameters.get(name) for name in (LEVEL, STIFFNESS))
    if level is not None and stiffness:
        bristle, stroke = level / stiffness, scales(campaign).stroke_m
        unit = quantities.length
        if stroke < policy.limitations.min_sliding * bristle:
            sentences.append(
                f"the strokes ({stroke:.2g} {unit}) are hardly longer than the presliding "
                f"displacement ({bristle:.2g} {unit}): the Coulomb level is an extrapolation"
            )
    return tuple(sentences)
