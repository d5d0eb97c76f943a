"""Errors from repeated fits of simulated records: parametric bootstrap (Efron 1979) and wild
bootstrap (Wu 1986)."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb, four_runs
from campaigns import campaign
from jbf import Fit, InputError, Model, Parameter, ParameterValue, Rig, Run, fit
from jbf.errors import Stopped
from jbf.estimation.bootstrap import (
    LEAST_REPEATS,
    MOST_REPEATS,
    bootstrap,
    check_repeats,
    simulated_readings,
    simulated_recording,
    simulated_runs,
    with_error,
)
from jbf.estimation.campaign import Campaign
from jbf.estimation.identifiability import reason_not_identifiable
from jbf.estimation.noise import Noise
from jbf.estimation.prepared import Prepared

PAGE = Parameter("b", lower=-1e5, upper=1e5, null=0.0, starts=(0.3,))
SCALE = Parameter("F_c", lower=0.0, upper=1e5, starts=(1.0,))
ANGLE = Parameter("phase", lower=-np.pi, upper=np.pi, starts=(0.0,), period=2.0 * np.pi)
MIDDLE = 0.84134 - 0.15866
"""Probability within one standard deviation of a normal distribution."""


@pytest.mark.parametrize("shift", [-3.0, 100.0])
def test_bootstrap_error_is_half_the_central_68_percent_width_of_estimates(shift: float) -> None:
    """Fifty of 100,051 estimates at a distant likelihood maximum do not change the error."""
    estimates = 5.0 + shift + np.append(np.linspace(0.0, 1.0, 100_001), np.full(50, 1e6))
    found = with_error(ParameterValue(5.0, 1e-3), estimates, PAGE)
    assert found.stderr == pytest.approx(0.5 * MIDDLE, rel=2e-3)
    assert (found.value, found.held, found.note) == (5.0, False, None)


def test_bootstrap_error_is_never_below_the_error_from_the_curvature() -> None:
    found = with_error(ParameterValue(5.0, 0.5), np.linspace(4.9, 5.1, 1001), PAGE)
    assert found.stderr == 0.5


def test_bootstrap_returns_a_held_parameter_unchanged() -> None:
    held = ParameterValue(5.0, None, "held fixed", held=True)
    assert with_error(held, np.linspace(4.9, 5.1, 1001), PAGE) is held


def test_scale_parameter_is_held_if_its_bootstrap_error_exceeds_its_value() -> None:
    found = with_error(ParameterValue(5.0, 1.0), np.linspace(0.0, 40.0, 1001), SCALE)
    assert (found.stderr, found.held) == (None, True)
    assert found.note == reason_not_identifiable(SCALE, 5.0, 20.0 * MIDDLE)


def test_bootstrap_estimates_of_an_angle_are_compared_modulo_its_period() -> None:
    estimates = np.linspace(3.0, 3.2, 1001)
    turned = np.where(np.arange(1001) % 2, estimates, estimates - 2.0 * np.pi)
    found = with_error(ParameterValue(3.1, 1e-3), turned, ANGLE)
    assert found.stderr == pytest.approx(0.1 * MIDDLE, rel=0.01)
    plain = with_error(ParameterValue(3.1, 1e-3), turned, PAGE)
    assert plain.stderr == pytest.approx(np.pi, rel=0.1)


def test_bootstrap_rejects_a_number_of_repeats_outside_its_limits() -> None:
    for repeats in (LEAST_REPEATS, MOST_REPEATS):
        check_repeats(repeats)
    for repeats in (LEAST_REPEATS - 1, MOST_REPEATS + 1):
        with pytest.raises(InputError, match=f"draws {repeats} "):
            check_repeats(repeats, "draws")


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    return four_runs(coulomb, noise_rms=0.2, seed=3)[:2]


@pytest.fixture(scope="module")
def fitted(runs: list[Run]) -> Fit:
    return fit(Rig(), runs, ["sensor_offset"], law="coulomb", fixed={"F_s": 6.0})


def test_bootstrap_errors_of_a_linear_fit_are_those_of_regression(
    fitted: Fit, runs: list[Run]
) -> None:
    v = np.concatenate([r.velocity for r in runs])
    x = np.column_stack([np.sign(v), v, np.ones(len(v))])
    errors = 0.2 * np.sqrt(np.diag(np.linalg.inv(x.T @ x)))
    # The errors of the fit are divided by 1000 so that the estimates determine the result.
    values = fitted.parameters.items()
    precise = {name: replace(p, stderr=p.stderr and p.stderr / 1e3) for name, p in values}
    steps: list[Any] = []
    options: dict[str, Any] = {"seed": 7, "progress": lambda *step: steps.append(step[1:])}
    found = bootstrap(replace(fitted, parameters=precise), runs, repeats=19, **options)
    assert steps == [(k, 19) for k in range(19)]
    for name, error in zip(("F_c", "F_v", "sensor_offset.b"), errors, strict=True):
        # The half width of the middle 68 % of 19 estimates is known to 22 %, their spread to 16 %.
        assert found.fit.parameters[name].stderr == pytest.approx(error, rel=0.6), name
        assert np.std(found.values[name]) == pytest.approx(error, rel=0.45), name
        assert abs(np.mean(found.values[name]) - fitted.parameters[name].value) < 0.8 * error
    assert found.fit.model.parameters == found.fit.parameters
    assert set(found.values["F_s"]) == {6.0}
    assert found.fit.parameters["F_s"].stderr is None


def test_innovation_rms_is_that_of_the_run_or_of_all_runs_if_the_run_is_short() -> None:
    runs = [four_runs(coulomb, noise_rms=0.1 * (k + 1), seed=k)[k] for k in range(3)]
    runs[2] = runs[2].select(np.arange(501) < 99)
    found = fit(Rig(), runs, law="coulomb", fixed={"F_s": 6.0})
    innovations = [found.noise.innovations(r, 0.02) for r in found.residuals]
    own = [float(np.sqrt(np.mean(e**2))) for e in innovations]
    pooled = float(np.sqrt(np.mean(np.concatenate(innovations) ** 2)))
    assert found.innovation_rms == pytest.approx([own[0], own[1], pooled])


@pytest.fixture(scope="module", params=["slide", "bearing"])
def prepared(request: pytest.FixtureRequest) -> Prepared:
    """A run with rests, noisy speed and noisy position."""
    t = 0.01 * np.arange(3000)
    phase = np.mod(t, 10.0)
    v = np.where(phase < 8.0, 0.1 * np.sin(0.25 * np.pi * phase) ** 3, 0.0)
    x = np.concatenate(([0.0], np.cumsum(0.005 * (v[1:] + v[:-1]))))
    random = np.random.default_rng(3)
    speed = np.where(v == 0.0, 0.0, v + 1e-4 * random.standard_normal(len(t)))
    force = coulomb(t, v, v) + 0.1 * random.standard_normal(len(t))
    position = x + 2e-6 * random.standard_normal(len(t))
    run = Run.from_arrays(t, speed, force, position_m=position, name="a")
    rig = Rig.thesis() if request.param == "bearing" else Rig()
    return Campaign.prepare(rig, [run]).prepared[0]


def test_resampled_motion_has_the_recorded_errors_with_random_signs(prepared: Prepared) -> None:
    run, motion = prepared.run, prepared.motion
    again = simulated_readings(prepared, np.full(len(run), 3.0), np.random.default_rng(1))
    moving = ~motion.resting
    assert 0.1 < np.mean(motion.resting) < 0.4
    bearing = prepared.rig.bearing
    arm_m = 1.0 if bearing is None else bearing.radius_m
    for new, old, true in (
        (again.velocity, run.velocity, motion.velocity),
        (again.position_m, run.position_m, arm_m * motion.angle_rad),
    ):
        error, recorded_error = (new - true)[moving], (old - true)[moving]
        np.testing.assert_allclose(np.abs(error), np.abs(recorded_error), atol=1e-12)
        assert 0.4 < np.mean(np.sign(error) != np.sign(recorded_error)) < 0.6
        np.testing.assert_array_equal(new[~moving], old[~moving])


def test_resampling_keeps_friction_that_is_missing_or_of_unknown_sign(prepared: Prepared) -> None:
    known = prepared.motion.sign_known
    friction = np.where(np.arange(len(known)) == 57, np.nan, prepared.friction)
    some, random = replace(prepared, friction=friction), np.random.default_rng(1)
    again = simulated_readings(some, np.full(len(known), 99.0), random)
    assert 0 < np.count_nonzero(~known) < len(known) // 2
    np.testing.assert_array_equal(again.friction[~known], friction[~known])
    kept = known & (np.arange(len(known)) != 57)
    assert set(again.friction[kept]) == {99.0}
    assert np.isnan(again.friction[57])


def test_simulated_record_has_noise_of_the_fitted_rms_and_correlation(prepared: Prepared) -> None:
    noise = Noise(0.3, 0.5)
    n, known = len(prepared.run), prepared.motion.sign_known
    again = simulated_recording(prepared, np.full(n, 3.0), noise, 0.5, np.random.default_rng(7))
    kicks = np.random.default_rng(7).normal(0.0, 0.5, n)
    wanted = 3.0 + noise.coloured(kicks, prepared.step_s)
    np.testing.assert_allclose(again.friction[known], wanted[known])


def test_resampled_encoder_position_has_the_recorded_step_at_another_phase() -> None:
    rig, some, _ = campaign(5)
    (p,) = Campaign.prepare(rig, some[:1]).prepared
    again = simulated_readings(p, np.zeros(len(p.run)), np.random.default_rng(2)).angle_rad
    recorded, moving = np.unwrap(p.run.angle_rad), ~p.motion.resting
    size = min(change for change in np.abs(np.diff(recorded)) if change > 1e-12)
    steps = np.diff(again[moving]) / size
    assert np.quantile(np.abs(steps - np.round(steps)), 0.95) < 1e-6
    assert np.max(np.abs(again - p.motion.angle_rad)[moving]) < 0.51 * size
    shift = (again - recorded)[moving][0] / size
    assert abs(shift - round(shift)) > 0.01


def wild_errors(model: Model, runs: list[Run], hidden: tuple[str, ...], draw: int) -> list[Array]:
    """Noise of simulated records: record minus the law with the simulated effects."""
    known = {n: p for n, p in model.parameters.items() if n.partition(".")[0] in (n, *hidden)}
    some = Model(model.rig, model.law, hidden, known)
    again = simulated_runs(model, runs, hidden, draw)
    return [np.asarray(a.friction) - some.predict(r) for a, r in zip(again, runs, strict=True)]


def test_wild_bootstrap_flips_signs_of_residuals_in_blocks_of_one_second() -> None:
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 0.5, noise_rms=0.1)[:2]
    values = {**LAW, "F_s": 6.0, "sensor_offset.b": 0.5}
    model = Model(Rig(), "coulomb", ["sensor_offset"], values)
    residuals = [np.asarray(r.friction) - model.predict(r) for r in runs]
    patterns = set()
    for draw in range(2):
        for hidden in (("sensor_offset",), ()):
            for e, r in zip(wild_errors(model, runs, hidden, draw), residuals, strict=True):
                np.testing.assert_allclose(np.abs(e), np.abs(r), atol=1e-3)
                turns = np.diff(np.sign(e * r)[np.abs(r) > 0.01])
                assert np.count_nonzero(turns) <= len(r) // 50 + 1
                patterns.add(tuple(np.sign(e * r)[25::50]))
    assert len(patterns) > 5
    first, second = (wild_errors(model, runs, (), 5) for _ in range(2))
    np.testing.assert_array_equal(first[0], second[0])


DELAY_S = 0.012


def white_noise_n() -> Array:
    """White noise of 0.1 N at 500 samples."""
    return 0.1 * np.random.default_rng(6).standard_normal(500)


@pytest.fixture(scope="module")
def delayed() -> list[Run]:
    """Reversals of 1 kg on a slide; the force is late by three samples, with noise of 0.1 N."""
    random, t = np.random.default_rng(5), 0.004 * np.arange(500)

    def motion(time_s: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration."""
        w = np.array([[4.0], [9.3]])
        s, c = np.sin(w * time_s), np.cos(w * time_s)
        return (0.05 * s).sum(0), (0.05 * w * c).sum(0), (-0.05 * w**2 * s).sum(0)

    _, v, a = motion(t - DELAY_S)
    force = 3.0 * np.sign(v) + 2.0 * v + a + 0.1 * random.standard_normal(len(t))
    position = motion(t)[0] + 8e-6 * random.standard_normal(len(t))
    return [Run.from_arrays(t, None, force, position_m=position, name="late")]


def test_bootstrap_estimates_a_common_delay_again(delayed: list[Run]) -> None:
    found = fit(Rig(), delayed, ["inertia"], law="coulomb", fixed={"F_s": 3.0})
    assert found.model.force_delay_s == pytest.approx(DELAY_S, abs=4e-4)
    estimates = bootstrap(found, delayed, repeats=19).values
    for name, true in (("F_c", 3.0), ("F_v", 2.0), ("inertia.m_e", 1.0)):
        assert np.mean(estimates[name]) == pytest.approx(true, rel=0.03), name


@pytest.mark.parametrize("delay_s", [DELAY_S, -0.0055])
def test_wild_bootstrap_simulates_recordings_with_the_common_delay(
    delayed: list[Run], delay_s: float
) -> None:
    values = {"F_c": 3.0, "F_s": 3.0, "F_v": 2.0, "inertia.m_e": 1.0}
    late = Model(Rig(), "coulomb", ["inertia"], values, fit={"force_delay_s": delay_s})
    records = delayed
    if delay_s != DELAY_S:
        records = [replace(delayed[0], friction=late.predict(delayed[0]) + white_noise_n())]
    again = simulated_runs(late, records, ["inertia"], 1)
    found = fit(Rig(), again, ["inertia"], law="coulomb", fixed={"F_s": 3.0})
    assert found.model.force_delay_s == pytest.approx(delay_s, abs=2.5e-3)
    assert found.rms == pytest.approx(0.1, rel=0.2)


def test_bootstrap_refuses_a_fit_to_other_runs(fitted: Fit, runs: list[Run]) -> None:
    with pytest.raises(InputError, match="these 1 runs"):
        bootstrap(fitted, runs[:1])


def test_interrupted_fit_keeps_the_corrected_delay(
    delayed: list[Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("jbf.estimation.generalised_least_squares.best_weighting", interrupt)
    with pytest.raises(Stopped) as stopped:
        fit(Rig(), delayed, ["inertia"], law="coulomb", fixed={"F_s": 3.0})
    assert stopped.value.fit.model.force_delay_s == pytest.approx(DELAY_S, abs=2.5e-3)
    assert stopped.value.fit.rms == pytest.approx(0.1, rel=0.2)
