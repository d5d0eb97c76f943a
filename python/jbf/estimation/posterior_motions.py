"""Replacement of the estimated (posterior) motions of all runs of a problem by other ones.

`estimate_motion_errors` finds the noise of the force, and the scale of the errors of the motion,
that maximise the likelihood.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import optimize, special

from jbf.arrays import Array
from jbf.estimation.campaign import Campaign
from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.prepared import Prepared, coasting
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.records.findings.finding import Finding
from jbf.records.motion.acceleration_jumps import NO_JUMPS, Jumps
from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.motion.readings import ForceReadings
from jbf.records.motion.smoothing import Smoothed

LATE = "late_channel"
"""Kind of the finding that states a corrected delay of the force."""
STEP = 0.5
"""Step of numerical derivatives with respect to the motion, in standard errors of the motion."""
RATIOS = 9
"""Number of grid points of scale / noise that bracket the minimum."""
RATIO_STEP = 0.01
"""Tolerance of the logarithm of the ratio of error scale and noise."""
MOST_SCALE = 3.0
"""Largest logarithm of the error scale, and minus the smallest."""
MOST_NOISE = 0.5
"""Logarithm of the largest noise, relative to the residual."""
EXACT_RECORD = 1e-12
"""Smallest residual relative to the largest force."""
LEAST_NOISE = -7.0
"""Logarithm of the smallest noise, relative to the residual."""


def posteriors(problem: Problem) -> list[Smoothed | None]:
    """Posterior of the motion of each run; None where it is not known."""
    errors = [p.motion.errors for p in problem.campaign.prepared]
    return [None if e is None else e.smoothed for e in errors]


def with_posteriors(problem: Problem, motions: Sequence[Smoothed | None]) -> Problem:
    """Return the problem with other posterior motions; None keeps that of the run."""
    prepared = []
    for p, smoothed in zip(problem.campaign.prepared, motions, strict=True):
        if smoothed is not None:
            motion = p.motion.with_posterior(p.run.time_s, smoothed)
            mass, recorded = coasting(p.rig), p.recorded
            if mass is not None:
                p = replace(p, friction=-mass * motion.acceleration)
            if recorded is not None:
                recorded = (recorded[0], recorded[1].with_posterior(recorded[0], smoothed))
            p = replace(p, motion=motion, recorded=recorded)
        prepared.append(p)
    return problem.with_campaign(replace(problem.campaign, prepared=tuple(prepared)))


def with_scaled_intensity(
    problem: Problem, factor: float, *, same_corners: bool = False
) -> Problem:
    """Return the problem with the noise intensity of the motion's process times a factor.

    See `Smoothed.with_scaled_intensity`.
    """
    motions = [
        m and m.with_scaled_intensity(factor, same_corners=same_corners)
        for m in posteriors(problem)
    ]
    return with_posteriors(problem, motions)


def with_corners_located_by_forces(
    problem: Problem, solution: Solution, errors: ErrorsInMotion, *, with_jumps: bool = False
) -> Problem:
    """Return the problem with abrupt changes of the acceleration (corners) located by the forces.

    See `Smoothed.with_corners_located_by`. With `with_jumps`, the acceleration jumps at
    reversals and stops.
    """
    if not problem.campaign.force_has_clock:
        return problem
    plain = problem.samples_at(solution.values)
    motions: list[Smoothed | None] = []
    for smoothed, p, residual, rows, weight in zip(
        posteriors(problem),
        problem.campaign.prepared,
        solution.residuals,
        errors.sensitivity,
        plain.weight,
        strict=True,
    ):
        if smoothed is None:
            motions.append(None)
            continue
        mean, covariance, _ = smoothed.at(p.run.time_s)
        with np.errstate(divide="ignore"):
            variances = np.where(weight > 0.0, (errors.noise / weight) ** 2, np.inf)
        values = np.einsum("ni,ni->n", rows, mean[:, :3]) + residual
        forces = ForceReadings(p.run.time_s, rows, values, variances)
        speed_sd = np.sqrt(np.maximum(covariance[:, 1, 1], 0.0))
        at_reversals = (
            _jumps_at_reversals(p, mean, speed_sd, residual, rows) if with_jumps else NO_JUMPS
        )
        motions.append(smoothed.with_corners_located_by(forces, at_reversals))
    return with_posteriors(problem, motions)


def _jumps_at_reversals(
    p: Prepared, mean: Array, speed_sd: Array, residual: Array, rows: Array
) -> Jumps:
    """Jumps of the acceleration of a run at reversals and stops, for a continuous drive force.

    The jump at a reversal is the change of the friction divided by the mass. The change of the
    friction is the difference of the predicted forces minus sensitivity times change of the motion.
    At a stop, or if the drive sticks at a reversal, the acceleration jumps to zero.

    `mean` has the position and its derivatives at the samples, shape (n, N), and `speed_sd` the
    standard error of the speed, shape (n,). `residual` is the force minus the predicted force, N,
    shape (n,). `rows` are the derivatives of the predicted force with respect to position, velocity
    and acceleration, shape (n, 3).
    """
    sliding = np.flatnonzero(p.motion.slides)
    v, time_s = p.motion.velocity[sliding], p.run.time_s[sliding]
    rest_between = np.diff(np.cumsum(p.motion.resting)[sliding]) > 0
    sensitivity = 0.5 * (rows[sliding][1:] + rows[sliding][:-1])
    reverses = (v[1:] * v[:-1] < 0.0) | rest_between
    events = np.flatnonzero(reverses & (sensitivity[:, 2] > 0.0))
    mass = sensitivity[events, 2]
    forces, states = (p.friction - residual)[sliding], mean[sliding, :3]
    of_friction = np.diff(forces) - np.sum(sensitivity * np.diff(states, axis=0), axis=1)
    at_reversal = -of_friction[events] / mass
    before = states[events, 2] + residual[sliding][events] / mass
    sticks = rest_between[events] | (at_reversal * before < -(before**2))
    sizes = np.where(sticks, -before, at_reversal)
    step_s = np.diff(time_s)[events]
    deceleration = np.where(sticks, before, np.diff(v)[events] / step_s)
    with np.errstate(divide="ignore"):
        to_zero_s = np.clip(-v[events] / deceleration, 0.0, step_s)
        sd_s = np.minimum(speed_sd[sliding][events] / np.abs(deceleration), step_s)
    # A jump beyond the range of the accelerations is due to too small an estimate of the mass.
    kept = np.abs(sizes) < np.ptp(mean[:, 2])
    return Jumps((time_s[events] + to_zero_s)[kept], sizes[kept], sd_s[kept])


def _corrected(campaign: Campaign) -> list[Finding]:
    """Return the finding that states a corrected delay common to all runs, or an empty list."""
    names = _all_runs(campaign)
    return [f for f in campaign.more_findings if (f.kind, f.run) == (LATE, names)]


def _all_runs(campaign: Campaign) -> str:
    """Return the names of all runs, as in a finding."""
    return ", ".join(p.run.name for p in campaign.prepared)


def corrected_delay_s(campaign: Campaign) -> float:
    """Return the corrected delay of the force that is common to all runs, s; zero without one."""
    return sum(f.size for f in _corrected(campaign))


def delays_by_run_s(runs: Sequence[str], findings: Sequence[Finding]) -> Array:
    """Return the corrected delay of the force of each run, s, from the findings of a fit."""
    late_s = {f.run: f.size for f in findings if f.kind == LATE}
    common_s = late_s.pop(", ".join(runs), 0.0)
    return np.array([common_s + late_s.get(run, 0.0) for run in runs])


def delay_of_further_runs_s(campaign: Campaign) -> float:
    """Return the corrected delay of the force that a further run is expected to have, s.

    It is the delay common to all runs, plus the delay corrected run by run if that is the same in
    every run. Delays that differ are attributed to the recordings and not predicted.
    """
    delays_s = delays_by_run_s([p.run.name for p in campaign.prepared], campaign.more_findings)
    # Delays that do not differ significantly have been replaced by their mean.
    return float(delays_s[0]) if np.ptp(delays_s) == 0.0 else corrected_delay_s(campaign)


def shifted(first: Problem, delay_s: float) -> Problem:
    """Return the problem with the force of each run shifted to earlier times by `delay_s`."""
    return first.with_campaign(corrected_for_delay(first.campaign, delay_s))


def aligned(before: Campaign, delays_s: Array, margin_s: float = 0.0) -> Campaign:
    """Shift the force of each run to earlier times by its delay.

    Readings within `margin_s` of the start or the end of a motion are dropped before the shift. All
    delays up to this size then have the same readings.
    """
    prepared = before.prepared
    if margin_s > 0.0:
        prepared = tuple(p.shifted(0.0, 0.0, margin_s) for p in prepared)
    shifts = zip(prepared, delays_s.tolist(), strict=True)
    prepared = tuple(p if delay_s == 0.0 else p.shifted(delay_s, 0.0) for p, delay_s in shifts)
    samples, between = Samples.of(prepared, before.settings), before.samples.between
    if between is not None:
        kept = [kept_readings(p, q) for p, q in zip(before.prepared, prepared, strict=True)]
        samples = replace(samples, between=between.sliced(kept))
    return replace(before, prepared=prepared, samples=samples)


def kept_readings(before: Prepared, after: Prepared) -> slice:
    """Slice of the readings of a run that a shift keeps; it drops some at the start or the end.

    The readings are compared, and may contain NaN.
    """
    readings, kept = before.readings_n, len(after.readings_n)
    starts = (
        k
        for k in range(len(readings) - kept + 1)
        if np.array_equal(readings[k : k + kept], after.readings_n, equal_nan=True)
    )
    start = next(starts, 0)
    return slice(start, start + kept)


def corrected_for_delay(before: Campaign, delay_s: float, margin_s: float = 0.0) -> Campaign:
    """Correct a delay of the force: shift the force of each run to earlier times by `delay_s`.

    The finding states the total delay, including one that has already been corrected. `margin_s` is
    as in `aligned`.
    """
    corrected = _corrected(before)
    total_s = delay_s + sum(f.size for f in corrected)
    others = tuple(f for f in before.more_findings if f not in corrected)
    delays_s = np.full(len(before.prepared), delay_s)
    campaign = replace(aligned(before, delays_s, margin_s), more_findings=others)
    if total_s == 0.0:
        return campaign
    side = "late" if total_s > 0.0 else "early"
    words = f"the force is {1e3 * abs(total_s):.2g} ms {side} relative to the motion in all runs"
    finding = Finding(LATE, "friction_n", _all_runs(before), total_s, "s", "shifted", words)
    return campaign.with_findings([finding])


def estimate_motion_errors(problem: Problem, solution: Solution) -> ErrorsInMotion:
    """Estimate sensitivities at a solution, the noise, and the scale of the motion's errors.

    Noise and scale maximise the likelihood. The scale corrects the standard errors of the smoother,
    which are too large if the motion is smoother than the assumed noise process. The logarithm of
    the scale has a normal prior, so that the scale is 1 if the motion's errors are negligible.
    """
    prepared = problem.campaign.prepared
    predicted = [p.friction - r for p, r in zip(prepared, solution.residuals, strict=True)]
    sensitivity = [np.zeros((len(f), 3)) for f in predicted]
    for axis in range(3):
        changed, steps = zip(*(_moved(p, axis) for p in prepared), strict=True)
        other = problem.chain.predict(solution.values, [p.core for p in changed])
        for derivatives, before, after, step in zip(
            sensitivity, predicted, other, steps, strict=True
        ):
            derivatives[:, axis] = np.divide(
                after - before, step, where=step > 0.0, out=derivatives[:, axis]
            )
    mass = coasting(problem.campaign.rig)
    if mass is not None:
        # The force is derived from the deceleration and contains the errors of the acceleration.
        for derivatives in sensitivity:
            derivatives[:, 2] += mass
    weights = solution.samples.weight
    residuals = solution.samples.without_deviations(solution.residuals, solution.noise)
    errors = tuple(p.motion.errors for p in prepared)
    motion = ErrorsInMotion(errors, tuple(sensitivity), 1.0)
    largest = max(float(np.max(np.abs(f), initial=0.0)) for f in predicted)
    most = max(solution.samples.rms(residuals), EXACT_RECORD * largest, 1e-150)
    settings = problem.campaign.settings.motion
    smallest = settings.min_noise_share * solution.samples.rms(predicted)
    lowest = float(np.clip(np.log(max(smallest, 1e-150) / most), LEAST_NOISE, 0.0))
    count = sum(int(np.count_nonzero(w)) for w in weights)

    def at(log_ratio: float, log_noise: float) -> ErrorsInMotion:
        """Errors of the motion with the logarithms of scale / noise and of noise / RMS."""
        scale = float(np.exp(log_ratio + log_noise))
        return replace(motion, noise=most * float(np.exp(log_noise)), scale=scale)

    def profiled(log_ratio: float) -> tuple[float, float]:
        """Smallest penalised deviance for a logarithm of scale / noise, and where it occurs.

        The second result is the logarithm of noise / RMS.

        The filter depends on the ratio only, and the deviance is convex in the logarithm of the
        noise.
        """
        unit = at(log_ratio, 0.0).whitening(weights)
        squares = unit.deviance(residuals) - unit.log_determinant

        # The derivative is zero where y exp(2 y) = (squares / precision) exp(2 offset), with
        # y = offset + log_noise. With w = 2 y, this is w + log(w) = z, whose solution is the
        # Wright omega function.
        precision = settings.scale_prior**-2
        offset = count / precision + log_ratio
        z = 2.0 * offset + np.log(max(2.0 * squares / precision, 1e-300))
        log_noise = 0.5 * float(special.wrightomega(z)) - offset
        bounds = max(lowest, -MOST_SCALE - log_ratio), min(MOST_NOISE, MOST_SCALE - log_ratio)
        log_noise = float(np.clip(log_noise, *bounds))
        deviance = squares * float(np.exp(-2.0 * log_noise)) + 2.0 * count * log_noise
        prior = precision * (log_ratio + log_noise) ** 2
        return deviance + unit.log_determinant + prior, log_noise

    # A second minimum exists at low noise, where the motion's errors explain the whole residual.
    log_ratios = np.linspace(-MOST_SCALE - MOST_NOISE, MOST_SCALE - lowest, RATIOS + 2)
    least = 1 + int(np.argmin([profiled(log_ratio)[0] for log_ratio in log_ratios[1:-1]]))
    found = optimize.minimize_scalar(
        lambda log_ratio: profiled(log_ratio)[0],
        bounds=(log_ratios[least - 1], log_ratios[least + 1]),
        method="bounded",
        options={"xatol": RATIO_STEP},
    )
    return at(float(found.x), profiled(float(found.x))[1])


def _moved(prepared: Prepared, axis: int) -> tuple[Prepared, Array]:
    """Change one component of a run's motion; return the run and the change, shape (n,).

    `axis` is 0 for position, 1 for speed and 2 for acceleration. The change is a fraction of a
    standard error of this component.
    """

    def off(motion: EstimatedMotion) -> tuple[EstimatedMotion, Array]:
        """Return the motion with a step added to its component `axis`, and the step, shape (n,)."""
        errors = motion.errors
        assert errors is not None
        step = STEP * np.sqrt(np.maximum(errors.covariance[:, axis, axis], 0.0))
        step = np.where(motion.resting, 0.0, step)
        name = ("angle_rad", "velocity", "acceleration")[axis]
        change = step / errors.arm_m if axis == 0 else step
        return replace(motion, **{name: getattr(motion, name) + change}), step

    recorded = prepared.recorded
    if recorded is not None:
        recorded = (recorded[0], off(recorded[1])[0])
    motion, step = off(prepared.motion)
    return replace(prepared, motion=motion, recorded=recorded), step
