"""Time alignment: estimation of the time shifts of the force, with refits of the model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from jbf.arrays import Array, Names
from jbf.diagnosis.policy import Policy
from jbf.estimation.campaign import Campaign
from jbf.estimation.delay_scan import scan_delays
from jbf.estimation.delays import drift_step, run_delay_step
from jbf.estimation.likelihood import noise_at
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import search
from jbf.estimation.solution import Solution
from jbf.models.delayed_reading import DELAY, TAU

EVALUATIONS = 12
"""Number of steps of a fit to shifted runs. It limits the effort only."""
STEPS = 10
"""Largest number of joint Gauss-Newton steps in the delays and the model parameters."""
SETTLED = 0.1
"""Size of a step, in standard errors, below which the iteration has converged."""


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
    old = problem.campaign
    prepared = tuple(
        p.shifted(late, drift) for p, late in zip(old.prepared, delays_s.tolist(), strict=True)
    )
    return replace(
        old,
        prepared=prepared,
        samples=Samples.of(prepared, old.settings),
        more_findings=tuple(f for f in old.more_findings if f.done in ("left out", "excluded")),
    )


def without_delay(effects: Names) -> Names:
    """Effects of a model without `time_delay`."""
    return tuple(name for name in effects if name != DELAY)


def fitted_to_shifted(
    problem: Problem,
    delays_s: Array,
    drift: float,
    effects: Names,
    start_values: dict[str, float],
    near: Solution,
) -> Shifted:
    """Shift the runs of a model and fit its law with effects to them by a few steps.

    The shifts of the result are relative to the runs of `problem`. `start_values` are by name;
    `near` has the noise.
    """
    again = Problem(moved(problem, delays_s, drift), problem.law, problem.clock, effects)
    start = np.array([start_values[name] for name in again.names])
    samples = again.samples_at(start)
    end = search(again, samples, start, near.noise, EVALUATIONS)
    solution = again.solution(end.values, samples, near.noise, end.converged, end.message)
    return Shifted(again, solution, delays_s, drift)


def fit_delays_by_run(start: Shifted) -> Shifted:
    """Estimate the delay of each run jointly with the model; its runs may already be shifted.

    Returns `start` if the fit does not improve, or if a delay is not plausible.
    """
    settings = start.campaign.settings.delays
    linear_s = settings.linear_s

    def advance(now: Shifted) -> Shifted | None:
        """Fit after one step; the same fit if it converged, None if a delay is not plausible."""
        step = run_delay_step(now.problem, now.solution)
        if step.square <= SETTLED**2 * np.sum(step.identifiable):
            return now
        # Where delays differ between runs, a common delay is also attributed to the recording.
        values = now.problem.values_by_name(now.solution.values)
        later_s = np.clip(step.delays_s, -linear_s, linear_s) + values.get(TAU, 0.0)
        delays_s = now.delays_s + later_s
        delays_s[~step.identifiable] = step.mean_s(delays_s)
        apart_s = float(np.max(np.abs(delays_s - np.median(delays_s))))
        if apart_s > settings.search_ranges_s[0][0] or not possible_clocks(
            start.problem, delays_s, start.drift
        ):
            # Another deviation of one run, such as a mass, may appear as a delay of any size.
            return None
        effects = without_delay(now.problem.effects)
        change_s = delays_s - start.delays_s
        after = fitted_to_shifted(start.problem, change_s, 0.0, effects, values, now.solution)
        return replace(after, delays_s=delays_s, drift=start.drift)

    return _iterate(start, advance)


def fit_clock_drift(start: Shifted) -> Shifted:
    """Estimate the drift of a clock that is reset at the start of each run, jointly with the model.

    Returns `start`, the model of the unshifted runs, if the fit does not improve, or if the drift
    is not plausible.
    """
    lasts_s = np.array([p.run.duration_s for p in start.campaign.prepared])
    most = start.campaign.settings.delays.linear_s / float(np.max(lasts_s))

    def advance(now: Shifted) -> Shifted | None:
        """Fit after one step; the same fit if it converged, None if the drift is not plausible."""
        step = drift_step(now.problem, now.solution)
        if step.square <= SETTLED**2:
            return now
        drift = now.drift + float(np.clip(step.drift, -most, most))
        delays_s = 0.5 * drift * lasts_s
        if not possible_clocks(start.problem, delays_s, drift):
            return None
        values, effects = now.problem.values_by_name(now.solution.values), now.problem.effects
        return fitted_to_shifted(start.problem, delays_s, drift, effects, values, now.solution)

    return _iterate(start, advance)


def _iterate(start: Shifted, advance: Callable[[Shifted], Shifted | None]) -> Shifted:
    """Repeat a joint Gauss-Newton step until it converges in white, then in coloured noise.

    Returns `start` if the residual does not decrease, or if a step returns None.
    """
    # The error due to a delay is autocorrelated and would be attributed to coloured noise.
    now, white = replace(start, solution=replace(start.solution, noise=WHITE)), True
    for _ in range(STEPS):
        after = advance(now)
        if after is None:
            return start
        if after is not now:
            now = after
        elif white:
            now, white = _with_coloured_noise(now), False
        else:
            break
    if white:
        now = _with_coloured_noise(now)
    return now if now.solution.rms < start.solution.rms else start


def _with_coloured_noise(shifted: Shifted) -> Shifted:
    """Re-estimate the noise of shifted runs from the present residuals."""
    problem, values, samples = shifted.problem, shifted.solution.values, shifted.solution.samples
    noise = noise_at(problem, samples, values)
    return replace(shifted, solution=problem.solution(values, samples, noise))


def with_mean_delay(shifted: Shifted) -> Shifted:
    """Replace the delays of the runs by their mean, and refit the model."""
    problem, solution = shifted.problem, shifted.solution
    mean_s = run_delay_step(problem, solution).mean_s(shifted.delays_s)
    change_s = mean_s - shifted.delays_s
    values = problem.values_by_name(solution.values)
    again = fitted_to_shifted(problem, change_s, 0.0, problem.effects, values, solution)
    return replace(again, delays_s=np.full(len(change_s), mean_s), drift=shifted.drift)


def fit_delays_by_search(problem: Problem, solution: Solution, policy: Policy) -> Shifted | None:
    """Shift each run repeatedly to the delay with the smallest sum of squares (`scan_delays`).

    Returns None if no delay is corrected.
    """
    now = Shifted(problem, solution, np.zeros(len(problem.campaign.prepared)), 0.0)
    for look in range(policy.delays.max_searches):
        scan = scan_delays(now.problem, now.solution, look, policy.terms.chance)
        if scan is None:
            break
        # Where delays differ between runs, a common delay is also attributed to the recording.
        values = now.problem.values_by_name(now.solution.values)
        shared_s = values.get(TAU, 0.0) if scan.spread_s > 0.0 else 0.0
        delays_s, drift = now.delays_s + np.array(scan.delays_s) + shared_s, now.drift + scan.drift
        if look > 0 and scan.drift != 0.0 and scan.spread_s == 0.0:
            # The drift was already corrected at the middle of the runs.
            delays_s = now.delays_s
        if not possible_clocks(problem, delays_s, drift):
            break
        effects = without_delay(now.problem.effects)
        now = fitted_to_shifted(problem, delays_s, drift, effects, values, now.solution)
    return None if now.problem is problem else now


def fit_common_delay(problem: Problem, shifted: Shifted) -> Shifted:
    """Estimate the delay common to all runs that remains after run-specific shifts.

    A law with memory can compensate for a common delay. The differences between the delays of the
    runs are therefore well determined, but not their mean. The mean is fitted jointly with the law
    to runs shifted by less than the estimate, so that the remaining delay is positive.
    """
    steps = [p.step_s for p in problem.campaign.prepared]
    ahead_s = max(problem.campaign.settings.delays.reserve_s, float(np.median(steps)))
    effects, near = without_delay(problem.effects), shifted.solution
    values = {**shifted.problem.values_by_name(near.values), TAU: ahead_s}
    earlier_s = shifted.delays_s - ahead_s
    late = fitted_to_shifted(problem, earlier_s, 0.0, (*effects, DELAY), values, near)
    values = late.problem.values_by_name(late.solution.values)
    delays_s = shifted.delays_s + (values[TAU] - ahead_s)
    if not possible_clocks(problem, delays_s, 0.0):
        return shifted
    again = fitted_to_shifted(problem, delays_s, 0.0, effects, values, near)
    return again if again.solution.rms < near.rms else shifted
