"""Time alignment: estimation of the time shifts of the force, with refits of the model."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.policy import Policy
from jbf.estimation.campaign import Campaign
from jbf.estimation.delay_scan import scan_delays
from jbf.estimation.delays import drift_step, run_delay_step
from jbf.estimation.likelihood import noise_at
from jbf.estimation.noise import WHITE
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import search
from jbf.estimation.solution import Solution
from jbf.estimation.transients import without_transients
from jbf.models.delayed_reading import DELAY, TAU

Array = npt.NDArray[np.float64]
Names = tuple[str, ...]
EVALUATIONS = 12
"""Number of steps of a fit to shifted runs. It limits the effort only."""
STEPS = 10
"""Largest number of joint Gauss-Newton steps in the delays and the model parameters.

It limits the effort only.
"""
SETTLED = 0.1
"""Size of a step, in standard errors, below which the iteration has converged.

It is a numerical tolerance.
"""


@dataclass(frozen=True, eq=False)
class Shifted:
    """Runs with forces shifted in time, and the model fitted to them.

    Attributes
    ----------
    problem, solution
        The fit.
    delays_s
        Corrected delay of each run, at mid-run, s.
    drift
        Corrected relative drift of the force clock.
    """

    problem: Problem
    solution: Solution
    delays_s: Array
    drift: float

    @property
    def campaign(self) -> Campaign:
        """Campaign of the runs after the correction of their delays and clock drifts."""
        return self.problem.campaign


def possible_clocks(problem: Problem, delays_s: Array, drift: float) -> bool:
    """Whether estimated delays and a clock drift are physically plausible for a data logger.

    Larger estimates are artefacts of noise, if the force hardly depends on the motion, or of the
    lack of fit of a wrong model.
    """
    settings = problem.campaign.settings.delays
    return abs(drift) <= settings.max_drift and all(
        abs(late) + 0.5 * abs(drift) * p.run.duration_s <= settings.max_run_share * p.run.duration_s
        for p, late in zip(problem.campaign.prepared, delays_s.tolist(), strict=True)
    )


def moved(problem: Problem, delays_s: Array, drift: float) -> Campaign:
    """Shift the force of each run to earlier times, by its delay and the clock drift."""
    prepared = problem.campaign.prepared
    return _settled(
        problem,
        [p.shifted(late, drift) for p, late in zip(prepared, delays_s.tolist(), strict=True)],
    )


def _settled(problem: Problem, prepared: list[Prepared]) -> Campaign:
    """Campaign of shifted runs, with the initial-state transients excluded again."""
    old = problem.campaign
    shifted = replace(
        old,
        prepared=tuple(prepared),
        samples=Samples.of(prepared, old.settings),
        more_findings=tuple(f for f in old.more_findings if f.done == "left out"),
    )
    return without_transients(shifted, problem.law, problem.clock)


def without_delay(effects: Names) -> Names:
    """Effects of a model without `time_delay`."""
    return tuple(name for name in effects if name != DELAY)


def fitted_to_shifted(
    problem: Problem,
    campaign: Campaign,
    effects: Names,
    start_values: dict[str, float],
    near: Solution,
) -> tuple[Problem, Solution]:
    """Fit a law with effects to the shifted runs of `campaign` by a few steps."""
    again = Problem(campaign, problem.law, problem.clock, effects)
    start = np.array([start_values[name] for name in again.names])
    samples = again.samples_at(start)
    end = search(again, samples, start, near.noise, EVALUATIONS)
    solution = again.solution(end.values, samples, near.noise, end.converged, end.message)
    return again, solution


def fit_delays_by_run(first: Problem, start: Shifted) -> Shifted:
    """Estimate the delay of each run jointly with the model.

    Returns `start` if the fit does not improve, or if a delay is not plausible.

    Parameters
    ----------
    first
        Model of the unshifted runs.
    start
        Model of the runs shifted by the known delays.
    """
    settings = first.campaign.settings.delays
    linear_s = settings.linear_s
    # The error due to a delay is autocorrelated and would be attributed to coloured noise.
    now = replace(start, solution=replace(start.solution, noise=WHITE))
    white = True
    for _ in range(STEPS):
        step = run_delay_step(now.problem, now.solution)
        if step.square <= SETTLED**2 * np.sum(step.identifiable):
            if not white:
                break
            white = False
            now = _with_coloured_noise(now)
            continue
        # Where delays differ between runs, a common delay is also attributed to the recording.
        values = now.problem.values_by_name(now.solution.values)
        later_s = np.clip(step.delays_s, -linear_s, linear_s) + values.get(TAU, 0.0)
        delays_s = now.delays_s + later_s
        delays_s[~step.identifiable] = step.mean_s(delays_s)
        apart_s = float(np.max(np.abs(delays_s - np.median(delays_s))))
        if apart_s > settings.search_ranges_s[0][0] or not possible_clocks(
            first, delays_s, start.drift
        ):
            # Another deviation of one run, such as a mass, may appear as a delay of any size.
            return start
        campaign = moved(first, delays_s, start.drift)
        effects = without_delay(now.problem.effects)
        problem, solution = fitted_to_shifted(now.problem, campaign, effects, values, now.solution)
        now = Shifted(problem, solution, delays_s, start.drift)
    if white:
        now = _with_coloured_noise(now)
    return now if now.solution.rms < start.solution.rms else start


def fit_clock_drift(first: Problem, start: Shifted) -> Shifted:
    """Estimate the drift of a clock that is reset at the start of each run, jointly with the model.

    Returns `start` if the fit does not improve, or if the drift is not plausible.
    """
    lasts_s = np.array([p.run.duration_s for p in first.campaign.prepared])
    most = first.campaign.settings.delays.linear_s / float(np.max(lasts_s))
    now = replace(start, solution=replace(start.solution, noise=WHITE))
    white = True
    for _ in range(STEPS):
        step = drift_step(now.problem, now.solution)
        if step.square <= SETTLED**2:
            if not white:
                break
            white = False
            now = _with_coloured_noise(now)
            continue
        drift = now.drift + float(np.clip(step.drift, -most, most))
        delays_s = 0.5 * drift * lasts_s
        if not possible_clocks(first, delays_s, drift):
            return start
        values = now.problem.values_by_name(now.solution.values)
        campaign = moved(first, delays_s, drift)
        problem, solution = fitted_to_shifted(
            now.problem, campaign, now.problem.effects, values, now.solution
        )
        now = Shifted(problem, solution, delays_s, drift)
    if white:
        now = _with_coloured_noise(now)
    return now if now.solution.rms < start.solution.rms else start


def with_mean_delay(shifted: Shifted) -> Shifted:
    """Replace the delays of the runs by their mean, and refit the model."""
    problem, solution = shifted.problem, shifted.solution
    mean_s = run_delay_step(problem, solution).mean_s(shifted.delays_s)
    change_s = mean_s - shifted.delays_s
    values = problem.values_by_name(solution.values)
    campaign = moved(problem, change_s, 0.0)
    again, fit = fitted_to_shifted(problem, campaign, problem.effects, values, solution)
    return Shifted(again, fit, np.full(len(change_s), mean_s), shifted.drift)


def _with_coloured_noise(shifted: Shifted) -> Shifted:
    """Re-estimate the noise of shifted runs from the present residuals."""
    problem, values, samples = shifted.problem, shifted.solution.values, shifted.solution.samples
    noise = noise_at(problem, samples, values)
    return replace(shifted, solution=problem.solution(values, samples, noise))


def fit_delays_by_search(problem: Problem, solution: Solution, policy: Policy) -> Shifted | None:
    """Shift each run repeatedly to the delay with the smallest sum of squares (`scan_delays`).

    Returns None if no delay is corrected.
    """
    campaign = problem.campaign
    old, first = campaign, problem
    delays_s, drift = np.zeros(len(campaign.prepared)), 0.0
    for look in range(policy.delays.max_searches):
        scan = scan_delays(problem, solution, look, policy.terms.chance)
        if scan is None:
            break
        # Where delays differ between runs, a common delay is also attributed to the recording.
        values = problem.values_by_name(solution.values)
        shared = values.get(TAU, 0.0) if scan.spread_s > 0.0 else 0.0
        later_s, drifted = delays_s + np.array(scan.delays_s) + shared, drift + scan.drift
        if look > 0 and scan.drift != 0.0 and scan.spread_s == 0.0:
            # The drift was already corrected at the middle of the runs.
            later_s = delays_s
        if not possible_clocks(first, later_s, drifted):
            break
        delays_s, drift = later_s, drifted
        campaign = moved(first, delays_s, drift)
        effects = without_delay(problem.effects)
        problem, solution = fitted_to_shifted(problem, campaign, effects, values, solution)
    return None if campaign is old else Shifted(problem, solution, delays_s, drift)


def fit_common_delay(problem: Problem, shifted: Shifted) -> Shifted:
    """Estimate the delay common to all runs that remains after run-specific shifts.

    A law with memory can compensate for a common delay. The differences between the delays of the
    runs are therefore well determined, but not their mean. The mean is fitted jointly with the law
    to runs shifted by less than the estimate, so that the remaining delay is positive.
    """
    steps = [p.step_s for p in problem.campaign.prepared]
    ahead_s = max(problem.campaign.settings.delays.reserve_s, float(np.median(steps)))
    delays_s = shifted.delays_s - ahead_s
    campaign = moved(problem, delays_s, 0.0)
    effects = without_delay(problem.effects)
    late = Problem(campaign, problem.law, problem.clock, [*effects, DELAY])
    last = Problem(shifted.campaign, problem.law, problem.clock, effects)
    start_values = {**last.values_by_name(shifted.solution.values), TAU: ahead_s}
    start = np.array([start_values[name] for name in late.names])
    samples = late.samples_at(start)
    values = search(late, samples, start, shifted.solution.noise, EVALUATIONS).values
    shared_s = float(values[late.names.index(TAU)]) - ahead_s
    delays_s = shifted.delays_s + shared_s
    if not possible_clocks(problem, delays_s, 0.0):
        return shifted
    campaign = moved(problem, delays_s, 0.0)
    near = late.values_by_name(values)
    again, solution = fitted_to_shifted(problem, campaign, effects, near, shifted.solution)
    if solution.rms >= shifted.solution.rms:
        return shifted
    return Shifted(again, solution, delays_s, 0.0)
