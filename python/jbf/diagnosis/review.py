"""Review of a model: the effects that it needs, and other effects that would fit as well.

An effect is removed if it has no evidence and held-out runs do not confirm it. It is replaced by
another effect that has more evidence and predicts held-out runs no worse. The same comparison gives
the posterior weights of the alternatives to an effect.

A motor accelerates its load and carries its weight, independently of friction. Inertia or mass,
weight and offset (the machine terms) are part of the initial model of the diagnosis of a drive;
they are not missing effects. The errors of the recorded motion are part of the likelihood.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from scipy import special

from jbf.arrays import Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import evidence, evidence_on_common_samples, full_gain
from jbf.estimation.approach import many_peaks
from jbf.estimation.generalised_least_squares import likeliest_with_motion_errors
from jbf.estimation.likelihood import likelihood_gain, next_step_gain
from jbf.estimation.solution import Solution
from jbf.models.catalogue import can_be_removed
from jbf.records.rig import Rig

OFFSET = "sensor_offset"
MACHINE_TERMS = (OFFSET, "inertia", "gravity")
"""Machine terms: effects that are not friction and that no law can represent."""


def machine_of(rig: Rig, present: Iterable[str]) -> Names:
    """Machine terms among the effects `present` in a model; empty for a rig without a drive."""
    return () if rig.drive is None else tuple(name for name in present if name in MACHINE_TERMS)


def start_model(candidates: Candidates) -> Names:
    """Select the machine terms of a drive that the runs require, estimated jointly with the law.

    Without a drive, the selection starts with the law alone.
    """
    if candidates.campaign.rig.drive is None:
        return ()
    return still_needed(candidates, machine_terms(candidates))


def machine_terms(candidates: Candidates) -> Names:
    """Fit the law together with all machine terms that these runs can test; none for a bearing.

    A load cell also reads the weight and the inertia of the parts between it and the friction. The
    fit with each term starts from the fit without it, since a search from the starting values of
    all terms may end at a weight of zero.
    """
    present: Names = ()
    if candidates.campaign.rig.bearing is not None:
        return present
    for name in (term for term in MACHINE_TERMS if term in candidates.names):
        near = candidates.converge(present)
        present = (*present, name)
        candidates.look(present, near)
        candidates.converge(present)
    return present


def with_errors_of_motion(candidates: Candidates) -> Candidates:
    """Add the covariance of the motion's errors to the likelihood of the candidates.

    The errors are estimated with all machine terms, since a fit that neglects them may reject an
    inertia. The force is corrected by a time delay common to all runs. Returns the same candidates
    for a bearing, or if these errors are negligible.
    """
    if candidates.campaign.rig.bearing is not None:
        return candidates
    terms = machine_terms(candidates)
    problem, solution = candidates.fitted(terms).problem, candidates.converge(terms)
    problem, solution = likeliest_with_motion_errors(problem, solution)
    if solution.samples.motion is None:
        return candidates
    samples = replace(problem.campaign.samples, motion=solution.samples.motion)
    return candidates.with_campaign(replace(problem.campaign, samples=samples))


def still_needed(candidates: Candidates, effects: Sequence[str]) -> Names:
    """Remove the effects without evidence, one after the other."""
    current = tuple(effects)
    for name in effects:
        if not can_be_removed(name, current):
            continue
        rest = tuple(e for e in current if e != name)
        simpler = candidates.refit_from(rest, current)
        if not needed(candidates, current, name, simpler):
            current = rest
    return current


def needed(candidates: Candidates, current: Names, name: str, simpler: Solution) -> bool:
    """Whether an effect of the current model has evidence or is confirmed by held-out runs.

    If another effect is missing, the residual may be so correlated that no effect has evidence. An
    effect is needed even then if independent units confirm it, or if the held-out error is larger
    without it. For an effect that does not increase the likelihood, the ratio must exceed
    `max_rms_ratio`, since large estimated errors of the motion can make a worse fit likelier.
    """
    full, policy = candidates.converge(current), candidates.policy
    if evidence(candidates, full, simpler) >= 0.0:
        return True
    rest = tuple(e for e in current if e != name)
    least_ratio = candidates.campaign.settings.motion.max_rms_ratio
    if full_gain(candidates, full, simpler) > 0.0:
        if candidates.confirmation(rest, name).units_confirm(candidates.level):
            return True
        least_ratio = policy.held_out.no_worse_ratio
    return candidates.held_out_rms(rest) > least_ratio * candidates.held_out_rms(current)


def reconsider(
    candidates: Candidates, present: Names, refused: frozenset[str] = frozenset()
) -> Names:
    """Remove unnecessary effects, and replace an effect by a better one.

    A replacement has more evidence, or as much and makes a further effect unnecessary. The review
    is repeated until the model no longer changes, or an earlier one recurs, since a replacement may
    make further effects unnecessary. Effects that were refused in this round (`Round.refused`) are
    not used as replacements.
    """
    seen = [present]
    while (current := _reviewed_once(candidates, seen[-1], refused)) not in seen:
        seen.append(current)
    return current


def _reviewed_once(candidates: Candidates, present: Names, refused: frozenset[str]) -> Names:
    """Review each effect once: keep, remove or replace it, and return the resulting effects."""
    current = present
    for name in present:
        if len(current) < 2 or name not in current or not can_be_removed(name, current):
            continue
        rest = tuple(e for e in current if e != name)
        candidates.search_peaks(rest)
        simpler = candidates.refit_from(rest, current)
        full = candidates.converge(current)
        if not needed(candidates, current, name, simpler):
            current = rest
            continue
        if name in machine_of(candidates.campaign.rig, current) and name != OFFSET:
            continue  # not exchanged: if a spring is added, a superfluous weight is removed
        others = [o for o in candidates.addable(rest) if o != name and o not in refused]
        tie = candidates.policy.selection.tie
        costs = swap_costs(candidates, rest, others, full, simpler, max_loss=tie)
        close = sorted((o for o in costs if costs[o] < tie), key=costs.__getitem__)
        for other in close[: candidates.policy.search.leaders]:
            exchanged = tuple(other if e == name else e for e in current)
            if costs[other] >= -tie:
                exchanged = still_needed(candidates, exchanged)
                if other not in exchanged or len(exchanged) == len(current):
                    continue
            if _predicts_no_worse(candidates, exchanged, current):
                current = exchanged
                break
    return current


def _predicts_no_worse(candidates: Candidates, changed: Names, current: Names) -> bool:
    """Whether a changed model predicts held-out runs equally well (`no_worse_ratio`), or better."""
    max_rms = candidates.policy.held_out.no_worse_ratio * candidates.held_out_rms(current)
    return candidates.held_out_rms(changed) <= max_rms


def swap_costs(
    candidates: Candidates,
    rest: tuple[str, ...],
    others: Sequence[str],
    current: Solution,
    near: Solution,
    *,
    max_loss: float,
) -> dict[str, float]:
    """Loss of evidence if one effect of the current model is replaced, by name of the replacement.

    `rest` has the other effects of the current model, and `others` the names of the replacements.
    `current` and `near` are the solutions of the current model and of that with the effects `rest`.

    It is infinite for a replacement without evidence, and an upper limit for one that was not
    fitted to the end, because its loss could not fall below `max_loss`.
    """
    # Fewer samples are independent where the residual of `current` is correlated.
    share = candidates.independent_share(current)
    sets = {name: (*rest, name) for name in others}

    def cost(solution: Solution) -> float:
        """Loss of evidence if a solution replaces the current one."""
        lost = share * likelihood_gain(current, solution)
        return lost + candidates.price(solution.free) - candidates.price(current.free)

    policy = candidates.policy
    costs = dict.fromkeys(others, float("inf"))
    scores = candidates.score_all(rest, others, near)
    min_score = policy.search.min_score_share * candidates.price(1)
    # The score includes the gain of the next step of `near` itself.
    min_swap_score = policy.search.min_swap_share * likelihood_gain(current, near)
    min_swap_score += next_step_gain(near)
    open_names = [name for name in others if scores[name] > max(min_score, min_swap_score)]
    # With many peaks, a step from one peak does not predict the height of another.
    one_peak = [name for name in open_names if not many_peaks(sets[name])]
    candidates.look_all([sets[name] for name in one_peak], near)
    for name in one_peak:
        looked = candidates.look(sets[name], near)
        solution = looked.current_solution()
        gain_to_come = policy.search.linear_gain_factor * looked.promised
        could_gain = gain_to_come - likelihood_gain(solution, near)
        if cost(solution) - share * could_gain >= max_loss:
            costs[name] = cost(solution)
            open_names.remove(name)
    candidates.rank_all([sets[name] for name in open_names], near)
    ranked = {name: candidates.rank(sets[name], near) for name in open_names}
    costs |= {name: cost(solution) for name, solution in ranked.items()}
    for name in sorted(open_names, key=lambda name: costs[name]):
        could_gain = policy.search.step_gain_factor * next_step_gain(ranked[name])
        if not many_peaks(sets[name]) and costs[name] - share * could_gain >= max_loss:
            continue
        solution = candidates.converge(sets[name], near)
        if solution.rms > policy.selection.max_rms_ratio * current.rms:
            # For a wrong model, the residual with the highest likelihood may have a larger RMS.
            costs[name] = float("inf")
            continue
        # Its fit may be better only because it uses fewer samples. The evidence for the current
        # effect is negative if independent units confirmed it.
        least = min(cost(near), 0.0)
        gains = evidence_on_common_samples(candidates, solution, near) > least
        costs[name] = cost(solution) if gains else float("inf")
    return costs


def weights(candidates: Candidates, present: Names) -> dict[str, dict[str, float]]:
    """Posterior weights of each effect and its alternatives, at equal prior odds, by name.

    The alternatives of an effect are the candidates that have at least the minimum weight if
    compared with this effect only (Kass & Raftery 1995). The effect is first, the others follow by
    weight. An effect without alternatives has weight one.
    """
    full = candidates.converge(present)
    posterior: dict[str, dict[str, float]] = {}
    for name in present:
        rest = tuple(e for e in present if e != name)
        simpler = candidates.converge(rest)
        others = [other for other in candidates.addable(rest) if other != name]
        tie = candidates.policy.selection.tie
        costs = swap_costs(candidates, rest, others, full, simpler, max_loss=tie)
        close = {other: cost for other, cost in costs.items() if cost < tie}
        order = [name, *sorted(close, key=lambda other: close[other])]
        share = special.softmax([-0.5 * close.get(other, 0.0) for other in order])
        posterior[name] = dict(zip(order, share.tolist(), strict=True))
    return posterior
