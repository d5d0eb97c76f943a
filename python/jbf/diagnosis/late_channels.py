"""Runs whose force is late, each by its own time or by a clock of its own: compared with the motion
at the instants at which it was read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.diagnosis.policy import Policy
from jbf.diagnosis.shifted import (
    DELAY,
    EVALUATIONS,
    Names,
    Shifted,
    by_one_clock,
    jointly,
    moved,
    possible_clocks,
    refitted,
    without_delay,
)
from jbf.diagnosis.uneven_noise import noise_sizes
from jbf.estimation.campaign import Campaign
from jbf.estimation.joint_lateness import drift_step, lateness_step
from jbf.estimation.jumps import samples_beside_jumps
from jbf.estimation.lateness import Lateness, lateness
from jbf.estimation.likelihood import independent_share
from jbf.estimation.problem import Problem
from jbf.estimation.robust import CLIPPED, robust_size
from jbf.estimation.search import search
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect
from jbf.records.findings.finding import Finding

Array = npt.NDArray[np.float64]
TAU = "time_delay.tau_s"
AHEAD_S = 20e-3
"""So much too little runs are shifted where it is asked what all are late besides, or a step."""
HINT = 0.05
"""Probability of a drift by chance below which it is estimated to its end."""


def on_time(
    problem: Problem,
    solution: Solution,
    policy: Policy,
    richer: Solution | None = None,
    more: float = 1.0,
) -> Campaign | None:
    """The campaign with each run's force where it belongs; None where it is there already.

    What other looks found is left to be found again: it was seen through the lateness.

    Parameters
    ----------
    richer
        A model that shifted runs may do without: of what it leaves, they may leave `more` times as
        much. Where not given, they must leave less than this one does, by more than chance.
    """
    if not problem.campaign.force_has_clock or problem.campaign.samples.motion is not None:
        return None
    told = {f.run: f for f in problem.campaign.more_findings if f.kind == "late_channel"}
    if any(f.kind == "drifting_clock" for f in problem.campaign.more_findings):
        return None
    found = _sharper(problem, solution, policy) if told else _found(problem, solution, policy)
    if found is None or _says_no_more(found, solution):
        return None
    if richer is None:
        worth_it = (
            bool(told)
            or _differ(found, policy)
            or _gains(*_errors_n(found, solution, np.inf), found)
        )
    else:
        # Another model may fit worse all along, and its few errors far out be the same.
        before_n, left_n = _errors_n(found, richer, CLIPPED)
        # One clock is one number, as an effect is at the least.
        worth_it = left_n <= (more if found.drift == 0.0 else 1.0) * before_n
    if not worth_it:
        return None
    before_s = [
        told[p.run.name].size if p.run.name in told else 0.0 for p in problem.campaign.prepared
    ]
    late_s = found.late_s + np.array(before_s)
    apart = np.abs(late_s - np.median(late_s))
    doubted = richer is not None or problem.campaign.samples.between is not None
    least_s = policy.late_apart * problem.campaign.prepared[0].step_s
    if found.drift == 0.0 and doubted and float(np.median(apart)) < least_s:
        # On their way they seemed to differ; where they end, most do not: a delay of all, or what
        # is left of runs that deviate otherwise.
        return None
    findings = [
        _finding(p.run.name, late, found.drift)
        for p, late in zip(found.campaign.prepared, late_s.tolist(), strict=True)
    ]
    return found.campaign.with_findings(findings)


def _says_no_more(found: Shifted, solution: Solution) -> bool:
    """Whether shifted runs leave no less than deviations do that are known of them: a film that
    carries later in one run than in another makes its force late, nearly."""
    if solution.samples.between is None:
        return False
    apart = solution.samples.without_deviations(solution.residuals, solution.noise)
    return found.solution.rms_n >= solution.samples.rms(apart)


def _found(problem: Problem, solution: Solution, policy: Policy) -> Shifted | None:
    """The runs shifted by their own lateness or as one clock has it; None where none is late."""
    found = _shifted(problem, solution, policy) or _differing(problem, solution, policy)
    simpler = _drifting(problem, solution, policy)
    if found is None:
        return simpler or _shifted(problem, solution, policy, at_jumps=True)
    # One clock says more simply what a lateness of each run does.
    if simpler is not None and not _gains(*_errors_n(found, simpler.solution, np.inf), found):
        return simpler
    return found


def _drifting(problem: Problem, solution: Solution, policy: Policy) -> Shifted | None:
    """The runs shifted as one clock has it; None where it drifts by no more than chance."""
    step = drift_step(problem, solution)
    # A law gives way to a drift, and lets go of it step by step: a hint of one is worth the way.
    if special.chdtrc(1, step.square) >= HINT:
        return None
    on_time = np.zeros(len(problem.campaign.prepared))
    before = Shifted(problem, solution, on_time, 0.0)
    found = by_one_clock(problem, before)
    return found if found is not before and _differ(found, policy) else None


def _differing(problem: Problem, solution: Solution, policy: Policy) -> Shifted | None:
    """The runs shifted by what differs in the lateness of each beside a model that has taken of it
    what it could; None where that is no more than chance."""
    on_time = np.zeros(len(problem.campaign.prepared))
    step = lateness_step(problem, solution)
    # Residuals are never quite as white as their innovations: ask for twice the chi-square.
    if step.differ_chance(on_time, 0.5) >= policy.deviation_chance:
        return None
    before = Shifted(problem, solution, on_time, 0.0)
    found = jointly(problem, before)
    return None if found is before or not _differ(found, policy) else found


def _differ(found: Shifted, policy: Policy) -> bool:
    """Whether the lateness of runs that were shifted differs by more than chance, or grows."""
    if found.drift != 0.0:
        alone = drift_step(found.problem, found.solution)
        beside = drift_step(found.problem, found.solution, beside_delay=True)
        # Asked of every model, and residuals are never quite white.
        square = 0.5 * found.drift**2 / alone.variance
        # A delay of all runs looks like a drift of half as much in their length.
        left = (found.drift + beside.drift) ** 2 / beside.variance
        return bool(
            special.chdtrc(1, square) < policy.deviation_chance and special.chdtrc(1, left) < HINT
        )
    step = lateness_step(found.problem, found.solution)
    return step.differ_chance(found.late_s, 1.0) < policy.deviation_chance


def _sharper(problem: Problem, solution: Solution, policy: Policy) -> Shifted | None:
    """Runs that were shifted beside another model shifted once more, beside this one; None where it
    asks for nothing more."""
    if lateness_step(problem, solution).chance >= policy.deviation_chance:
        return None
    before = Shifted(problem, solution, np.zeros(len(problem.campaign.prepared)), 0.0)
    found = jointly(problem, before)
    return None if found is before else found


def _shifted(
    problem: Problem,
    solution: Solution,
    policy: Policy,
    at_jumps: bool = False,
) -> Shifted | None:
    """The runs shifted by their lateness until there is none; None where there was none."""
    campaign = problem.campaign
    old, first = campaign, problem
    late_s, drift = np.zeros(len(campaign.prepared)), 0.0
    for look in range(policy.most_shifts):
        found = lateness(problem, solution, look, policy.deviation_chance, at_jumps)
        if look == 0 and found is not None:
            found = _by_any_weights(problem, solution, policy, found, at_jumps)
        if found is None:
            break
        # Where runs differ in it, a delay that they share is the recording's as well.
        known = dict(zip(problem.names, solution.values.tolist(), strict=True))
        shared = known.get(f"{DELAY}.tau_s", 0.0) if found.spread_s > 0.0 else 0.0
        later_s, drifted = late_s + np.array(found.late_s) + shared, drift + found.drift
        if look > 0 and found.drift != 0.0 and found.spread_s == 0.0:
            # In the middle they are on time by now.
            later_s = late_s
        if not possible_clocks(first, later_s, drifted):
            break
        late_s, drift = later_s, drifted
        campaign = moved(first, late_s, drift)
        effects = without_delay(problem.effects)
        problem, solution = refitted(problem, campaign, effects, known, solution)
    if campaign is old:
        return None
    shifted = Shifted(problem, solution, late_s, drift)
    if drift != 0.0:
        # A clock of its own was right when it was started.
        return shifted
    if at_jumps or np.ptp(late_s) == 0.0:
        return _all_alike(first, shifted)
    # On their way they seemed to differ: a law gives way to what all share, and not alike in all.
    found_jointly = jointly(first, shifted)
    return found_jointly if _differ(found_jointly, policy) else None


def _all_alike(problem: Problem, found: Shifted) -> Shifted:
    """The runs shifted by what all of them are late besides.

    A law takes a delay of all runs for its own memory, nearly: how late each is tells how they
    differ, and little of what they share. That is fitted together with the law, on runs shifted
    too little, so that none is early.
    """
    steps = [p.step_s for p in problem.campaign.prepared]
    ahead_s = max(AHEAD_S, float(np.median(steps)))
    late_s = found.late_s - ahead_s
    campaign = moved(problem, late_s, 0.0)
    effects = without_delay(problem.effects)
    late = Problem(campaign, problem.law, problem.clock, [*effects, DELAY])
    last = Problem(found.campaign, problem.law, problem.clock, effects)
    known = dict(zip(last.names, found.solution.values.tolist(), strict=True)) | {TAU: ahead_s}
    start = np.array([known[name] for name in late.names])
    samples = late.samples_at(start)
    values = search(late, samples, start, found.solution.noise, EVALUATIONS).values
    shared_s = float(values[late.names.index(TAU)]) - ahead_s
    late_s = found.late_s + shared_s
    if not possible_clocks(problem, late_s, 0.0):
        return found
    campaign = moved(problem, late_s, 0.0)
    near = dict(zip(late.names, values.tolist(), strict=True))
    again, solution = refitted(problem, campaign, effects, near, found.solution)
    if solution.rms_n >= found.solution.rms_n:
        return found
    return Shifted(again, solution, late_s, 0.0)


def _gains(before_n: float, after_n: float, shifted: Shifted) -> bool:
    """Whether a lateness of each run gains more than so many parameters, by Schwarz's criterion."""
    samples = shifted.solution.samples
    share = min(independent_share(shifted.solution.residuals, samples.steps_s), 1.0)
    count = samples.count * share
    gain = 2.0 * count * np.log(before_n / after_n)
    return bool(gain > len(samples.runs) * np.log(count))


def _errors_n(shifted: Shifted, other: Solution, clipped: float) -> tuple[float, float]:
    """What another model leaves of runs as they were, and what the shifted ones leave, N RMS.

    Where the other sets aside the samples beside jumps, so they are here: those alone could decide.
    Errors count no more than at `clipped` standard deviations.
    """
    here = shifted.solution
    forces = [
        p.friction_n - r for p, r in zip(shifted.campaign.prepared, here.residuals, strict=True)
    ]
    aside = samples_beside_jumps(here.samples, shifted.campaign.prepared, forces, other.effects)
    before, left = other.samples.flat(other.residuals), aside.flat(here.residuals)
    return _clipped_rms(before, clipped), _clipped_rms(left, clipped)


def _clipped_rms(errors: Array, clipped: float) -> float:
    most = clipped * robust_size(errors) if np.isfinite(clipped) else np.inf
    return float(np.sqrt(np.mean(np.clip(errors, -most, most) ** 2))) if len(errors) else 0.0


def _by_any_weights(
    problem: Problem,
    solution: Solution,
    policy: Policy,
    plain: Lateness,
    at_jumps: bool,
) -> Lateness | None:
    """The lateness where noise that is larger in places counts less; None where the runs do not
    differ in it then: it was the noise that chose where each run's squares are least."""
    sizes, uneven = noise_sizes(problem, solution, policy)
    if not uneven:
        return plain
    ones = [np.ones(len(s)) for s in sizes]
    even = replace(solution, samples=solution.samples.weighed(sizes, ones, None))
    return lateness(problem, even, 0, policy.deviation_chance, at_jumps)


def _finding(run: str, late_s: float, drift: float) -> Finding:
    if drift == 0.0:
        way = "late" if late_s > 0.0 else "early"
        words = f"the force is {1e3 * abs(late_s):.2g} ms {way} against the motion"
        return Finding("late_channel", "friction_n", run, late_s, "s", "shifted", words)
    way = "slower" if drift > 0.0 else "faster"
    words = (
        f"the force's clock runs {way} than the motion's by {1e6 * abs(drift):.0f} parts in a "
        f"million: {1e3 * late_s:+.2g} ms in the middle of the run"
    )
    return Finding("drifting_clock", "friction_n", run, drift, "1", "shifted", words)


def bought_by_lateness(effects: Names) -> Names:
    """The effects that lateness by run may have bought: the instrument's, and those that move the
    instants of jumps."""
    pages = {name: find_effect(name) for name in effects}
    return tuple(n for n, e in pages.items() if e.stage == "instrument" or e.moves_jumps)
