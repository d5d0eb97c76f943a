"""Friction laws of drives: recovery of parameters from data of an independent implementation."""

import dataclasses
from pathlib import Path

import friction_laws as independent
import jbf
import numpy as np
import pytest
from jbf.diagnosis.which_law import followed
from jbf.estimation.campaign import Campaign
from shared import shared

DRIVE_LAWS = [law.name for law in jbf.laws().values() if not law.needs_bearing]
T = np.arange(0.0, 10.0, 0.004)
EXTENDED = pytest.mark.extended


@shared
def runs_of(
    law: str, amplitude_m: float, noise_rms: float, count_m: float = 1e-7, **p: float
) -> list[jbf.Run]:
    """A slow and a fast run, with position counts of `count_m`."""
    result = []
    for seed, omega in enumerate((0.8, 4.0)):
        speed = independent.stroke_speed(amplitude_m, omega)
        friction = getattr(independent, law)(speed, T, **p)
        result.append(
            independent.record(speed, T, friction, noise_rms, seed, f"run{seed}", count_m)
        )
    return result


def check_recovery(fit: jbf.Fit, truth: dict[str, float], noise_rms: float, within: float) -> None:
    assert fit.rms < 1.05 * noise_rms, fit.report()
    for name, value in truth.items():
        assert fit.parameters[name].value == pytest.approx(value, rel=within), fit.report()


@pytest.mark.parametrize("size", [*(pytest.param(s, marks=EXTENDED) for s in (0.02, 1.0)), 40.0])
def test_stribeck_parameters_are_recovered_at_each_force_scale(size: float) -> None:
    p = {"fc": 6.0 * size, "fs": 9.0 * size, "vs": 0.004, "delta": 1.6, "fv": 40.0 * size}
    fit = jbf.fit(jbf.Rig(), runs_of("stribeck", 0.01, 0.05 * size, **p), law="stribeck")
    truth = {"F_c": p["fc"], "F_s": p["fs"], "v_s": 0.004, "F_v": p["fv"]}
    check_recovery(fit, truth, 0.05 * size, 0.04)


@pytest.mark.parametrize("size", [0.02, pytest.param(40.0, marks=EXTENDED)])
def test_coulomb_parameters_are_recovered_from_a_flat_stribeck_curve(size: float) -> None:
    p = {"fc": 6.0 * size, "fs": 6.0 * size, "vs": 0.004, "delta": 1.0, "fv": 40.0 * size}
    fit = jbf.fit(jbf.Rig(), runs_of("stribeck", 0.01, 0.05 * size, **p), law="coulomb")
    check_recovery(fit, {"F_c": p["fc"], "F_v": p["fv"]}, 0.05 * size, 0.01)
    assert fit.parameters["F_s"].held
    assert fit.params["F_s"] == fit.params["F_c"]


@pytest.mark.parametrize("exponent", [1.0, *(pytest.param(e, marks=EXTENDED) for e in (0.6, 1.8))])
def test_dahl_parameters_are_recovered_within_three_percent(exponent: float) -> None:
    p = {"fc": 2.3, "s0": 5e4, "exponent": exponent, "fv": 20.0}
    fit = jbf.fit(jbf.Rig(), runs_of("dahl", 2e-4, 0.02, **p), law="dahl")
    check_recovery(fit, {"F_c": 2.3, "sigma_0": 5e4, "exponent": exponent}, 0.02, 0.03)


LUGRE = {"fc": 6.0, "fs": 9.0, "vs": 0.003, "s0": 6e4, "s1": 150.0, "vd": 0.02, "fv": 40.0}


def test_lugre_parameters_are_recovered_within_five_percent() -> None:
    fit = jbf.fit(jbf.Rig(), runs_of("lugre", 1e-3, 0.03, **LUGRE), law="lugre")
    truth = {"F_c": 6.0, "F_s": 9.0, "v_s": 0.003, "sigma_0": 6e4, "F_v": 40.0}
    check_recovery(fit, truth, 0.03, 0.05)


RATE_AND_STATE = {"f0": 20.0, "a": 0.4, "b": 0.6, "dc": 1e-4, "v0": 1e-3, "fv": 30.0}


def velocity_steps(low: float, high: float) -> independent.Speed:
    """Speed (m/s) that steps between two values every 2 s, within 10 ms, and reverses every 8 s."""

    def speed(t: float) -> float:
        levels = [low, high, low, high, -low, -high, -low, -high]
        i, phase = divmod(t, 2.0)
        begin, end = (levels[int(k) % len(levels)] for k in (i - 1, i))
        if i < 1.0:
            begin = end
        return float(begin + (end - begin) * min(phase / 0.01, 1.0))

    return speed


@shared
def velocity_step_runs() -> list[jbf.Run]:
    """Two runs with velocity steps over a decade each, simulated by SciPy."""
    time_s = np.arange(0.0, 20.0, 0.002)
    result = []
    for seed, (low, high) in enumerate([(1e-4, 1e-3), (3e-4, 3e-3)]):
        speed = velocity_steps(low, high)
        friction = independent.rate_and_state(speed, time_s, **RATE_AND_STATE)
        result.append(independent.record(speed, time_s, friction, 0.02, seed, f"run{seed}", 1e-9))
    return result


def test_rate_and_state_parameters_are_recovered_within_their_errors() -> None:
    fixed = {"v_0": RATE_AND_STATE["v0"]}
    fit = jbf.fit(jbf.Rig(), velocity_step_runs(), law="rate_and_state", fixed=fixed)
    assert fit.rms < 1.05 * 0.02, fit.report()
    truth = {"F_0": "f0", "a": "a", "b": "b", "D_c": "dc", "F_v": "fv"}
    for name, key in truth.items():
        parameter = fit.parameters[name]
        assert parameter.stderr is not None
        error = parameter.value - RATE_AND_STATE[key]
        assert abs(error) < 3.0 * parameter.stderr + 0.002 * RATE_AND_STATE[key], fit.report()
        assert parameter.stderr < 0.1 * RATE_AND_STATE[key], fit.report()


def test_rate_and_state_prediction_agrees_with_a_scipy_integration() -> None:
    speed = velocity_steps(1e-4, 1e-3)
    t = np.arange(0.0, 20.0, 0.002)
    v = np.array([speed(x) for x in t])
    names = ["F_0", "a", "b", "D_c", "v_0", "F_v"]
    values = dict(zip(names, RATE_AND_STATE.values(), strict=True))
    model = jbf.Model(jbf.Rig(), "rate_and_state", parameters=values)
    difference = model.predict(jbf.Run.from_arrays(t, v)) - independent.rate_and_state(
        speed, t, **RATE_AND_STATE
    )
    # The initial ages differ, and at a reversal the motion between the samples is not recorded.
    assert float(np.quantile(np.abs(difference[t > 4.0]), 0.99)) < 0.02


def test_automatic_law_selection_excludes_the_rate_and_state_law() -> None:
    t = np.arange(0.0, 4.0, 0.02)
    run = jbf.Run.from_arrays(t, 0.1 * np.sin(3.0 * t), np.sign(np.sin(3.0 * t)))
    resolved, refused = followed(Campaign.prepare(jbf.Rig(), [run]), "journal")
    assert "rate_and_state" not in resolved
    assert "law rate_and_state" not in refused
    assert "stribeck" in resolved


# Amplitude and Coulomb level of a joint (rad, N m), a machine slide and a precision stage (m, N).
LARGE, SMALL = (pytest.param(*p, marks=EXTENDED) for p in ((0.05, 40.0), (2e-6, 0.05)))
SIZES = [LARGE, (2e-4, 2.3), SMALL]


def presliding_runs(law: str, amplitude_m: float, fc: float, **shape: float) -> list[jbf.Run]:
    """Two runs with a presliding displacement of a fifth of the amplitude."""
    p = {"fc": fc, "s0": fc / (0.2 * amplitude_m), "fv": 0.02 * fc / amplitude_m, **shape}
    return runs_of(law, amplitude_m, 0.02 * fc, 1e-4 * amplitude_m, **p)


@pytest.mark.parametrize(("amplitude_m", "fc"), SIZES)
@pytest.mark.parametrize(
    ("law", "name", "value"),
    [
        ("maxwell_slip", "exponent", 0.7),
        pytest.param("maxwell_slip", "exponent", 1.0 / 3.0, marks=EXTENDED),
        ("elasto_plastic", "breakaway", 0.3),
        pytest.param("elasto_plastic", "breakaway", 0.8, marks=EXTENDED),
    ],
)
def test_presliding_law_parameters_are_recovered_within_ten_percent(
    amplitude_m: float, fc: float, law: str, name: str, value: float
) -> None:
    fit = jbf.fit(jbf.Rig(), presliding_runs(law, amplitude_m, fc, **{name: value}), law=law)
    check_recovery(fit, {"F_c": fc, "sigma_0": fc / (0.2 * amplitude_m)}, 0.02 * fc, 0.02)
    check_recovery(fit, {name: value, "F_v": 0.02 * fc / amplitude_m}, 0.02 * fc, 0.1)


@pytest.mark.extended
@pytest.mark.parametrize(
    ("law", "shape"),
    [
        ("maxwell_slip", {"exponent": 0.5}),
        ("maxwell_slip", {"exponent": 1.0}),
        ("elasto_plastic", {"breakaway": 0.6}),
    ],
)
def test_presliding_law_is_adequate_for_data_of_that_law(law: str, shape: dict[str, float]) -> None:
    diagnosis = jbf.diagnose(jbf.Rig(), presliding_runs(law, 2e-4, 2.3, **shape), law=law)
    assert diagnosis.verdict == "adequate", diagnosis.summary()
    assert diagnosis.effects == ()
    tried = {t.effect for step in diagnosis.steps for t in step.trials}
    assert not tried & {"presliding", "drive_compliance", "backlash"}


@pytest.mark.extended
@pytest.mark.parametrize(("amplitude_m", "fc"), SIZES)
def test_diagnosis_identifies_stribeck_excess_in_generalised_maxwell_slip_data(
    amplitude_m: float, fc: float
) -> None:
    """Generalised Maxwell slip equals the law `maxwell_slip` with `stribeck_excess`."""
    vs = 0.6 * amplitude_m
    runs = presliding_runs("maxwell_slip", amplitude_m, fc, exponent=0.5, excess=0.4 * fc, vs=vs)
    diagnosis = jbf.diagnose(jbf.Rig(), runs, law="maxwell_slip")
    assert diagnosis.effects == ("stribeck_excess",), diagnosis.summary()
    result = diagnosis.model.parameters
    assert result["stribeck_excess.a"].value == pytest.approx(0.4 * fc, rel=0.05)
    assert result["stribeck_excess.v_s"].value == pytest.approx(vs, rel=0.1)
    assert result["F_c"].value == pytest.approx(fc, rel=0.02)


def test_nanometre_vibration_at_rest_causes_no_presliding_force() -> None:
    """After the start the force rises monotonically during the first stroke."""
    t = np.arange(0.0, 4.0, 0.005)
    v = np.where(t < 1.0, -1e-9 * np.cos(40.0 * t), 2e-4 * np.minimum(2.0 * (t - 1.0), 1.0))
    for law in ("dahl", "maxwell_slip", "elasto_plastic"):
        force = jbf.Model(jbf.Rig(), law).predict(jbf.Run.from_arrays(t, v))
        assert np.max(np.abs(force[t < 1.0])) < 1e-3, law
        assert np.all(np.diff(force[t > 1.0]) > -1e-9), law


def test_dahl_prediction_starts_at_the_sliding_force_if_the_run_starts_moving() -> None:
    t = np.arange(0.0, 4.0, 0.005)
    sliding = jbf.Run.from_arrays(t, np.where(t < 2.0, -2e-4, 2e-4))
    # Coulomb friction of 10 N and viscous friction of 2 mN.
    assert jbf.Model(jbf.Rig(), "dahl").predict(sliding)[0] == pytest.approx(-10.002)


@pytest.mark.extended
def test_diagnosis_of_runs_that_start_deflected_is_adequate_and_reports_the_initial_state() -> None:
    """The initial presliding deflection of each run is the final one of the previous run."""
    p = {"fc": 2.3, "s0": 6e4, "exponent": 0.5, "fv": 0.0}

    def speed(t: float) -> float:
        # A stroke in each direction, followed by a rest.
        phase = t % 2.0
        direction = 1.0 if (t // 2.0) % 2.0 == 0.0 else -1.0
        return direction * 2.5e-4 * np.sin(np.pi * min(phase, 1.0))

    t = np.arange(0.0, 40.0, 0.005)
    friction = independent.maxwell_slip(speed, t, **p)
    complete = independent.record(speed, t, friction, 0.03, 0, count_m=1e-9)
    parts = [complete.select((t >= 8.0 * k + 1.5) & (t < 8.0 * k + 9.5)) for k in range(5)]
    runs = [dataclasses.replace(part, name=f"run{k}") for k, part in enumerate(parts)]
    diagnosis = jbf.diagnose(jbf.Rig(), runs, law="maxwell_slip")
    assert diagnosis.verdict == "adequate", diagnosis.summary()
    assert {f.kind for f in diagnosis.findings} == {"unsettled_start"}
    assert diagnosis.model.parameters["F_c"].value == pytest.approx(2.3, rel=0.01)


@pytest.mark.extended
def test_parameters_of_the_seven_parameter_law_are_recovered_within_six_percent() -> None:
    p = {"kt": 1e5, "fc": 6.0, "fv": 40.0, "fs": 3.0, "vs": 0.003, "tau": 0.03, "gamma": 0.8}
    fit = jbf.fit(jbf.Rig(), runs_of("seven", 2e-3, 0.03, **p), law="seven_parameter")
    truth = {"k_t": 1e5, "F_c": 6.0, "F_v": 40.0, "tau_L_s": 0.03}
    check_recovery(fit, truth, 0.03, 0.06)


def test_settled_lugre_prediction_agrees_with_a_scipy_integration() -> None:
    speed = independent.stroke_speed(1e-3, 3.0)
    t = np.arange(0.0, 8.0, 1e-3)
    v = np.array([speed(x) for x in t])
    names = ["F_c", "F_s", "v_s", "sigma_0", "sigma_1", "v_d", "F_v"]
    values = dict(zip(names, LUGRE.values(), strict=True))
    prediction = jbf.Model(jbf.Rig(), "lugre", parameters=values).predict(jbf.Run.from_arrays(t, v))
    # The initial states differ: deflected in the direction of motion, and zero.
    difference = prediction - independent.lugre(speed, t, **LUGRE)
    assert float(np.max(np.abs(difference[t > 2.0]))) < 2e-3


@pytest.mark.parametrize("law", DRIVE_LAWS)
def test_model_of_a_drive_law_is_unchanged_by_saving_and_loading(law: str, tmp_path: Path) -> None:
    model = jbf.Model(jbf.Rig(), law)
    model.save(tmp_path / "model.toml")
    again = jbf.Model.load(tmp_path / "model.toml")
    assert (again.law, again.parameters) == (law, model.parameters)
    backward, forward = again.steady_friction([-0.02, 0.02])
    assert forward == -backward > 0.0


def test_effects_that_do_not_apply_to_a_catalogue_law_are_refused() -> None:
    with pytest.raises(jbf.InputError, match=r"thermal_thinning .* coulomb has no lubricant film"):
        jbf.Model(jbf.Rig(), "coulomb", ["thermal_thinning"])
    with pytest.raises(jbf.InputError, match="contains presliding"):
        jbf.Model(jbf.Rig(), "lugre", ["presliding"])


def test_effect_on_a_linear_axis_is_refused_if_its_angle_or_position_is_missing() -> None:
    run = runs_of("stribeck", 0.01, 0.05, fc=6.0, fs=6.0, vs=0.01, delta=1.0, fv=1.0)[0]
    with pytest.raises(jbf.InputError, match="position_ripple"):
        jbf.Model(jbf.Rig(), "coulomb", ["position_ripple"]).predict(run)
    drive = {"drive_compliance.k": 1e4, "drive_compliance.c": 20.0, "drive_compliance.J": 1.0}
    values = {"F_c": 6.0, "F_s": 7.0, **drive}
    soft = jbf.Model(jbf.Rig(), "coulomb", ["drive_compliance"], values)
    assert np.all(np.isfinite(soft.predict(run)))
    with pytest.raises(jbf.InputError, match="position_m"):
        soft.predict(jbf.Run.from_arrays(run.time_s, run.velocity, run.friction))


@pytest.mark.extended
def test_diagnosis_of_dahl_data_with_a_coulomb_law_identifies_presliding() -> None:
    runs = runs_of("dahl", 2e-3, 0.05, fc=6.0, s0=3e4, exponent=1.0, fv=40.0)
    diagnosis = jbf.diagnose(jbf.Rig(), runs, law="coulomb")
    assert diagnosis.effects == ("presliding",), diagnosis.summary()
    tried = {t.effect for step in diagnosis.steps for t in step.trials}
    assert not tried & {"thermal_thinning", "coulomb_drag", "position_ripple"}
    assert all(f.axis != "regime" for f in diagnosis.failures)
