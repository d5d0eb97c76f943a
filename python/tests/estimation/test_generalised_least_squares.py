"""Fits that account for the errors of the motion and a delay of the force."""

import dataclasses
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Drive, Model, Rig, Run, compare, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.errors_in_motion import ErrorsInMotion
from jbf.estimation.noise import WHITE
from jbf.estimation.posterior_motions import estimate_motion_errors
from jbf.estimation.problem import Problem
from jbf.estimation.random_effects import RandomEffects
from jbf.estimation.samples import Samples
from jbf.records.motion.estimated_motion import estimate_motion

Array = npt.NDArray[np.float64]
STEP_S = 0.004
EXTENDED = pytest.mark.extended
INERTIA, COULOMB, VISCOUS = 0.05, 0.4, 0.1
NOISE = 0.02


def drive(seed: int, delay_s: float = 0.0, count: float = 2.0 * np.pi / 4096.0) -> Run:
    """A drive that follows trapezoids of random heights, recorded by an encoder only."""
    random = np.random.default_rng(seed)
    fine = 1e-4 * np.arange(120_000)
    corners = np.cumsum(random.uniform(0.15, 0.5, 60))
    heights = np.repeat(random.uniform(1.0, 5.0, 30) * (-1.0) ** np.arange(30), 2)
    velocity = np.interp(fine, corners, heights, left=0.0)
    velocity[fine < corners[0]] = heights[0]
    position = 1e-4 * np.cumsum(velocity)
    acceleration = np.gradient(velocity, 1e-4)
    torque = COULOMB * np.sign(velocity) + VISCOUS * velocity + INERTIA * acceleration
    time_s = 0.01 + STEP_S * np.arange(2900)
    force = np.interp(time_s - delay_s, fine, torque) + random.normal(0.0, NOISE, len(time_s))
    counted = np.round(np.interp(time_s, fine, position) / count) * count
    return Run.from_arrays(time_s, None, force, position_m=counted, name=f"seed_{seed}")


TRUE = {"F_c": COULOMB, "F_v": VISCOUS, "inertia.m_e": INERTIA}


def errors_of(runs: list[Run]) -> dict[str, float]:
    """Errors of the fitted parameters, in standard errors."""
    fitted = fit(Rig(), runs, ["inertia"], law="coulomb")
    parameters = {name: fitted.parameters[name] for name in TRUE}
    return {n: (p.value - TRUE[n]) / (p.stderr or np.nan) for n, p in parameters.items()}


@EXTENDED
def test_parameters_of_a_drive_with_a_coarse_encoder_are_within_their_errors() -> None:
    errors = np.array([list(errors_of([drive(seed)]).values()) for seed in range(8)])
    assert np.max(np.abs(errors)) < 4.0
    assert np.sqrt(np.mean(errors**2)) < 1.6


@pytest.mark.parametrize(
    "delay", [*(pytest.param(d, marks=EXTENDED) for d in (-0.7, 0.4, 1.2, -5.2)), 12.3]
)
def test_delay_of_the_force_in_all_runs_is_corrected_and_reported(delay: float) -> None:
    """Unit: samples."""
    runs = [drive(seed, delay * STEP_S) for seed in (21, 22)]
    found = fit(Rig(), runs, ["inertia"], law="coulomb")
    late = [finding for finding in found.findings if finding.kind == "late_channel"]
    assert [f.size for f in late] == [pytest.approx(delay * STEP_S, abs=0.05 * STEP_S)]
    assert late[0].run == "seed_21, seed_22"
    for name, true in TRUE.items():
        assert found.parameters[name].value == pytest.approx(true, rel=0.02)


def test_delay_beyond_the_searched_range_of_16_samples_is_not_corrected() -> None:
    runs = [drive(seed, -16.2 * STEP_S) for seed in (21, 22)]
    found = fit(Rig(), runs, ["inertia"], law="coulomb")
    assert "late_channel" not in [finding.kind for finding in found.findings]


def moves_from_rest(delay_s: float, step_s: float) -> Run:
    """Point-to-point moves with abrupt accelerations; the force is a command without noise."""
    fine = 1e-4 * np.arange(80_000)
    starts = 0.31 + 0.803 * np.arange(9)
    velocity = np.zeros(len(fine))
    for k, start in enumerate(starts):
        speed = 1.0 + 0.3 * (k % 3)
        corners = start + np.array([0.0, 0.12, 0.25, 0.37])
        velocity += np.interp(fine, corners, [0.0, speed, speed, 0.0]) * (-1.0) ** k
    position = 1e-4 * np.cumsum(velocity)
    torque = COULOMB * np.sign(velocity) + VISCOUS * velocity
    torque += INERTIA * np.gradient(velocity, 1e-4)
    time_s = 0.05 + step_s * np.arange(int(7.9 / step_s))
    count = 2.0 * np.pi / 20_000.0
    counted = np.round(np.interp(time_s, fine, position) / count) * count
    force = np.interp(time_s - delay_s, fine, torque)
    return Run.from_arrays(time_s, None, force, position_m=counted, name="moves")


@pytest.mark.parametrize(
    "delay", [*(pytest.param(d, marks=EXTENDED) for d in (-0.6, 0.3, 0.7)), -5.3]
)
def test_delay_of_the_force_is_found_from_abrupt_moves(delay: float) -> None:
    """Unit: samples of 10 ms. Friction is not linear in a delay where a move begins abruptly."""
    found = fit(Rig(), [moves_from_rest(delay * 0.01, 0.01)], ["inertia"], law="coulomb")
    late = [finding.size for finding in found.findings if finding.kind == "late_channel"]
    assert late == [pytest.approx(delay * 0.01, abs=0.001)]


def test_delay_of_the_fitted_runs_belongs_to_the_predictions_of_other_runs(tmp_path: Path) -> None:
    delay_s = 1.2 * STEP_S
    fitted = fit(Rig(), [drive(seed, delay_s) for seed in (21, 22)], ["inertia"], law="coulomb")
    fitted.model.save(tmp_path / "model.toml")
    model = Model.load(tmp_path / "model.toml")
    assert model.force_delay_s == pytest.approx(delay_s, abs=0.05 * STEP_S)
    undelayed = Model(model.rig, model.law, model.effects, model.parameters)
    other = drive(23, delay_s)
    compared = compare({"with": model, "without": undelayed}, [other])
    assert [error.name for error in compared.models] == ["with", "without"]
    assert compare(model, [other]).rms < 0.8 * compare(undelayed, [other]).rms
    # Predictions of a run have the same delay.
    assert other.friction is not None
    errors = [np.std(other.friction - m.predict(other)) for m in (model, undelayed)]
    assert errors[0] < 0.8 * errors[1]


def test_force_without_a_delay_has_no_finding_of_a_delay() -> None:
    found = fit(Rig(), [drive(31), drive(32)], ["inertia"], law="coulomb")
    assert "late_channel" not in {finding.kind for finding in found.findings}


def hoist(seed: int, delay_s: float) -> Run:
    """A mass with friction on trapezoids of speed that begin between samples, at 100 Hz."""
    random, step_s, count_m = np.random.default_rng(seed), 0.01, 1e-4
    durations, accelerations = [], []
    while sum(durations) < 21.0:
        top, slope = random.uniform([0.3, 0.5], [1.2, 1.0])
        slope *= (-1.0) ** (len(durations) // 4)
        durations += [top / abs(slope), random.uniform(0.5, 1.5)] * 2
        accelerations += [slope, 0.0, -slope, 0.0]
    starts_s = np.concatenate(([0.0], np.cumsum(durations)[:-1]))
    accelerated = np.array(accelerations) * durations
    speeds = np.concatenate(([0.0], np.cumsum(accelerated)[:-1]))
    ways = (speeds + 0.5 * accelerated) * durations
    places = np.concatenate(([0.0], np.cumsum(ways)[:-1]))

    def motion(time_s: Array) -> tuple[Array, Array, Array]:
        """Position, speed and acceleration; the speed of a pause is exactly zero."""
        part = np.searchsorted(starts_s, time_s, "right") - 1
        gone, slope = time_s - starts_s[part], np.array(accelerations)[part]
        speed = np.where(part % 4 == 3, 0.0, speeds[part] + slope * gone)
        return places[part] + speeds[part] * gone + 0.5 * slope * gone**2, speed, slope

    time_s = step_s * (1.137 + np.arange(1990))
    position, _, _ = motion(time_s)
    _, speed, acceleration = motion(time_s - delay_s)
    force = 500.0 * acceleration + 150.0 * np.sign(speed) + 200.0 * speed
    force += 15.0 * random.standard_normal(len(time_s))
    counted = np.round(position / count_m) * count_m
    return Run.from_arrays(time_s, None, force, position_m=counted, name=f"seed_{seed}")


@pytest.mark.parametrize("delay", [pytest.param(-0.4, marks=EXTENDED), 0.0, 0.3])
def test_delay_of_a_fraction_of_a_sample_is_found_and_none_is_invented(delay: float) -> None:
    """Unit: samples. Between samples, the estimated motion is smoother than at them."""
    found = fit(Rig(), [hoist(seed, delay * 0.01) for seed in range(3)], ["inertia"], law="coulomb")
    late = [f.size / 0.01 for f in found.findings if f.kind == "late_channel"]
    assert late == ([pytest.approx(delay, abs=0.1)] if delay else [])
    for name, true in (("F_c", 150.0), ("F_v", 200.0), ("inertia.m_e", 500.0)):
        assert found.parameters[name].value == pytest.approx(true, rel=0.01)


def stage(seed: int, delay_s: float) -> Run:
    """A stage on moves of minimum jerk with pauses, at 1 kHz, with an encoder of 1 um."""
    random, step_s, count_m = np.random.default_rng(seed), 0.001, 1e-6
    time_s = step_s * np.arange(4000)
    x, v, a = (np.zeros(len(time_s)) for _ in range(3))
    start_s, place = 0.1, 0.0
    while start_s < 5.0:
        low, high = [0.1, -0.05, 0.1], [0.3, 0.05, 0.3]
        duration_s, target, pause_s = random.uniform(low, high)
        way, shares = (
            target - place,
            [(t - start_s) / duration_s for t in (time_s, time_s - delay_s)],
        )
        u, w = np.clip(shares, 0.0, 1.0)
        x += way * (10.0 * u**3 - 15.0 * u**4 + 6.0 * u**5)
        v += way / duration_s * (30.0 * w**2 - 60.0 * w**3 + 30.0 * w**4)
        a += way / duration_s**2 * (60.0 * w - 180.0 * w**2 + 120.0 * w**3)
        start_s, place = start_s + duration_s + pause_s, target
    v[np.abs(v) < 1e-9] = 0.0
    noise = np.random.default_rng(seed).standard_normal(len(time_s))
    force = 2.5 * a + 7.0 * np.sign(v) + 25.0 * v + 0.6 * noise
    return Run.from_arrays(
        time_s, None, force, position_m=np.round(x / count_m) * count_m, name=f"seed_{seed}"
    )


@pytest.mark.parametrize("delay", [0.0, pytest.param(0.6, marks=EXTENDED)])
def test_moves_of_minimum_jerk_have_only_the_simulated_delay(delay: float) -> None:
    """Unit: samples. Of these runs without a delay, one of -0.2 samples is likelier than none."""
    runs = [stage(seed, delay * 0.001) for seed in (8, 9)]
    found = fit(Rig(), runs, ["inertia"], law="coulomb")
    late = [f.size / 0.001 for f in found.findings if f.kind == "late_channel"]
    assert late == ([pytest.approx(delay, abs=0.2)] if delay else [])


def drawn_residual(
    errors: Any, sensitivity: Any, scale: float, random: np.random.Generator, noise: float = NOISE
) -> npt.NDArray[np.float64]:
    """Noise and motion errors, which are drawn backward along the Markov chain of the posterior."""
    n = len(errors.covariance)
    residual = np.empty(n)
    state = random.multivariate_normal(np.zeros(3), errors.covariance[-1], method="svd")
    for k in range(n - 1, -1, -1):
        if k < n - 1:
            gain = errors.gain[k]
            covariance = errors.covariance[k] - gain @ errors.covariance[k + 1] @ gain.T
            state = gain @ state + random.multivariate_normal(np.zeros(3), covariance, method="svd")
        residual[k] = scale * (sensitivity[k] @ state) + random.normal(0.0, noise)
    return residual


def test_whitened_residuals_have_unit_variance_for_errors_drawn_from_the_posterior() -> None:
    errors: Any = estimate_motion(drive(3), None).errors
    n = len(errors.covariance)
    sensitivity = np.tile([0.0, VISCOUS, INERTIA], (n, 1))
    residual = drawn_residual(errors, sensitivity, 1.0, np.random.default_rng(1))
    model = ErrorsInMotion((errors,), (sensitivity,), NOISE)
    weight = np.where(np.arange(n) % 7 == 0, 0.0, 1.0)
    white, _ = model.whitening([weight]).stacked([residual], [np.ones((n, 1))])
    assert len(white) == np.count_nonzero(weight)
    assert np.std(white) == pytest.approx(NOISE, rel=0.05)
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.06
    assert np.std(residual) > 1.1 * NOISE
    # Starting values are compared by the squares that the fit minimises.
    samples = Samples(("a",), (0.01,), (weight > 0.0,), (weight,), motion=model)
    assert samples.square([residual]) == pytest.approx(float(white @ white))


def test_likelihood_with_motion_errors_and_a_run_offset_is_that_of_their_sum() -> None:
    """The dense covariance of the errors follows from the filter applied to unit vectors."""
    errors: Any = estimate_motion(drive(3), None).errors
    n, offset_sd = len(errors.covariance), 0.7
    sensitivity = np.tile([0.0, VISCOUS, INERTIA], (n, 1))
    motion = ErrorsInMotion((errors,), (sensitivity,), NOISE)
    weight, random = np.ones(n), np.random.default_rng(4)
    residual = drawn_residual(errors, sensitivity, 1.0, random) + 0.9
    samples = Samples(("a",), (0.01,), (weight > 0.0,), (weight,), motion=motion)
    _, filtered = samples.stacked([residual], [np.eye(n)], WHITE)
    inverse = np.linalg.inv(filtered)
    covariance = NOISE**2 * inverse @ inverse.T + offset_sd**2
    # With errors of the motion, their noise replaces that of the random effects.
    between = RandomEffects(("zero",), (np.full((n, 1), offset_sd),), 3.0 * NOISE)
    both = replace(samples, between=between)
    square = float(residual @ np.linalg.solve(covariance, residual))
    white = both.whitened([residual], WHITE)
    assert float(white @ white) / NOISE**2 == pytest.approx(square, rel=1e-6)
    determinant = np.linalg.slogdet(covariance)[1]
    assert both.deviance([residual]) == pytest.approx(square + determinant, rel=1e-6)
    # The best linear prediction of the offset is its conditional mean.
    (within,) = both.without_deviations([residual], WHITE)
    mean = offset_sd**2 * np.sum(np.linalg.solve(covariance, residual))
    assert residual - within == pytest.approx(np.full(n, mean), rel=1e-6)


@pytest.mark.parametrize("scale", [0.3, 1.0, 3.0])
def test_likelihood_is_maximal_at_the_simulated_scale_of_the_motion_errors(
    scale: float,
) -> None:
    errors: Any = estimate_motion(drive(3), None).errors
    n = len(errors.covariance)
    sensitivity = np.tile([0.0, VISCOUS, INERTIA], (n, 1))
    residual = drawn_residual(errors, sensitivity, scale, np.random.default_rng(2))
    deviances = [
        ErrorsInMotion((errors,), (sensitivity,), NOISE, scale * share)
        .whitening([np.ones(n)])
        .deviance([residual])
        for share in (0.5, 0.8, 1.0, 1.25, 2.0)
    ]
    assert abs(int(np.argmin(deviances)) - 2) <= 1
    assert min(deviances[0], deviances[-1]) > min(deviances) + 10.0


@pytest.mark.parametrize(("noise", "scale"), [(0.1, 1.0), (0.02, 2.5), (0.002, 1.0)])
def test_estimated_noise_and_scale_of_motion_errors_have_the_largest_likelihood(
    noise: float, scale: float
) -> None:
    """The noise is well determined only where it is as large as the errors of the motion."""
    campaign = Campaign.prepare(Rig(), [drive(3)])
    problem = Problem(campaign, "coulomb", "journal", ("inertia",))
    values = np.array([TRUE.get(name, COULOMB) for name in problem.names])
    exact, samples = problem.solution(values, campaign.samples, WHITE), campaign.samples
    sensitivity = estimate_motion_errors(problem, exact).sensitivity[0]
    (p,) = campaign.prepared
    random = np.random.default_rng(4)
    drawn = drawn_residual(p.motion.errors, sensitivity, scale, random, noise)
    force = problem.predict(values)[0] + drawn
    simulated = problem.with_campaign(
        dataclasses.replace(campaign, prepared=(dataclasses.replace(p, friction=force),))
    )
    solution = simulated.solution(values, samples, WHITE)
    found = estimate_motion_errors(simulated, solution)
    true = ErrorsInMotion(found.errors, found.sensitivity, noise, scale)
    deviances = [
        motion.whitening(samples.weight).deviance(solution.residuals) for motion in (found, true)
    ]
    assert deviances[1] - 8.0 < deviances[0] < deviances[1]
    assert found.scale == pytest.approx(scale, rel=0.05)
    if noise > NOISE:
        assert found.noise == pytest.approx(noise, rel=0.05)


def presliding_run(seed: int, deflection: float, count: float) -> Run:
    """A drive with Dahl's friction (1968), driven by a smooth torque, integrated in fine steps."""
    random, fine_s = np.random.default_rng(seed), 5e-5
    time = fine_s * np.arange(int(6.0 / fine_s))
    phases = np.outer(time, random.uniform(0.5, 1.5, 3)) + random.uniform(0.0, 1.0, 3)
    torque = np.sum(np.sin(2.0 * np.pi * phases), axis=1)
    position, velocity, bristle = 0.0, 0.0, 0.0
    positions = np.zeros(len(time))
    for k, drive_torque in enumerate(torque.tolist()):
        friction = COULOMB * bristle / deflection + VISCOUS * velocity
        velocity += fine_s * (drive_torque - friction) / INERTIA
        position += fine_s * velocity
        bristle += fine_s * (velocity - abs(velocity) * bristle / deflection)
        positions[k] = position
    read = np.arange(200, len(time), 40)
    counted = np.round(positions[read] / count) * count
    force = torque[read] + random.normal(0.0, 0.01, len(read))
    return Run.from_arrays(time[read], None, force, position_m=counted, name=f"dahl_{seed}")


@pytest.mark.parametrize(
    ("deflection", "count"),
    [(5e-3, 1e-4), pytest.param(5e-3, 1.5e-3, marks=EXTENDED)],
)
def test_presliding_is_not_taken_for_errors_of_the_motion(deflection: float, count: float) -> None:
    """Corners of the motion can imitate presliding, with residuals many times as large."""
    runs = [presliding_run(seed, deflection, count) for seed in (1, 2)]
    rig = Rig(drive=Drive("linear", "force"))
    sliding = fit(rig, runs, ["inertia"], law="coulomb")
    found = fit(rig, runs, ["inertia", "presliding"], law="coulomb")
    assert found.rms < 0.5 * sliding.rms < 0.1
    assert found.parameters["presliding.sigma"].value == pytest.approx(
        COULOMB / deflection, rel=0.05
    )
