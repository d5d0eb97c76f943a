"""Laws in newtons: recovered from data that scipy made, on machines of any size, and through the
command line."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import friction_laws as other
import jbf
import numpy as np
import pytest
from jbf.cli import main

NEWTONS = [law for law in jbf.laws().values() if not law.needs_bearing]
T = np.arange(0.0, 20.0, 0.004)


def runs_of(law: str, amplitude_m: float, noise_n: float, **p: float) -> list[jbf.Run]:
    """Two runs, slow and fast."""
    found = []
    for seed, omega in enumerate((0.8, 4.0)):
        speed = other.stroke_speed(amplitude_m, omega)
        friction = getattr(other, law)(speed, T, **p)
        found.append(other.record(speed, T, friction, noise_n, seed, f"run{seed}"))
    return found


def check(fit: jbf.Fit, truth: dict[str, float], noise_n: float, within: float) -> None:
    assert fit.rms_n < 1.05 * noise_n, fit.report()
    for name, value in truth.items():
        found = fit.parameters[name]
        assert found.value == pytest.approx(value, rel=within), fit.report()


@pytest.mark.parametrize("size", [0.02, 1.0, 40.0])
def test_stribeck_is_recovered_on_machines_of_any_size(size: float) -> None:
    p = {"fc": 6.0 * size, "fs": 9.0 * size, "vs": 0.004, "delta": 1.6, "fv": 40.0 * size}
    fit = jbf.fit(jbf.Rig(), runs_of("stribeck", 0.01, 0.05 * size, **p), law="stribeck")
    truth = {"F_c_n": p["fc"], "F_s_n": p["fs"], "v_s_m_s": 0.004, "F_v_n_s_m": p["fv"]}
    check(fit, truth, 0.05 * size, 0.04)


@pytest.mark.parametrize("size", [0.02, 40.0])
def test_coulomb_is_recovered(size: float) -> None:
    p = {"fc": 6.0 * size, "fs": 6.0 * size, "vs": 0.004, "delta": 1.0, "fv": 40.0 * size}
    fit = jbf.fit(jbf.Rig(), runs_of("stribeck", 0.01, 0.05 * size, **p), law="coulomb")
    check(fit, {"F_c_n": p["fc"], "F_v_n_s_m": p["fv"]}, 0.05 * size, 0.01)
    assert "never moved" in str(fit.parameters["F_s_n"].note)


@pytest.mark.parametrize("exponent", [0.6, 1.0, 1.8])
def test_dahl_is_recovered(exponent: float) -> None:
    p = {"fc": 2.3, "s0": 5e4, "exponent": exponent, "fv": 20.0}
    fit = jbf.fit(jbf.Rig(), runs_of("dahl", 2e-4, 0.02, **p), law="dahl")
    truth = {"F_c_n": 2.3, "sigma_0_n_m": 5e4, "exponent": exponent}
    check(fit, truth, 0.02, 0.03)


def test_lugre_is_recovered() -> None:
    p = {"fc": 6.0, "fs": 9.0, "vs": 0.003, "s0": 6e4, "s1": 150.0, "vd": 0.02, "fv": 40.0}
    fit = jbf.fit(jbf.Rig(), runs_of("lugre", 1e-3, 0.03, **p), law="lugre")
    truth = {"F_c_n": 6.0, "F_s_n": 9.0, "v_s_m_s": 0.003, "sigma_0_n_m": 6e4, "F_v_n_s_m": 40.0}
    check(fit, truth, 0.03, 0.05)


# A robot's joint (rad, N m), a machine's slide, a fine stage.
SIZES = [(0.05, 40.0), (2e-4, 2.3), (2e-6, 0.05)]


def bending(law: str, amplitude_m: float, fc: float, **shape: float) -> list[jbf.Run]:
    """Two runs of a contact that bends over a fifth of the amplitude."""
    s0, fv = fc / (0.2 * amplitude_m), 0.02 * fc / amplitude_m
    found = []
    for seed, omega in enumerate((0.8, 4.0)):
        speed = other.stroke_speed(amplitude_m, omega)
        friction = getattr(other, law)(speed, T, fc=fc, s0=s0, fv=fv, **shape)
        count = 1e-4 * amplitude_m
        found.append(other.record(speed, T, friction, 0.02 * fc, seed, f"run{seed}", count_m=count))
    return found


@pytest.mark.parametrize(("amplitude_m", "fc"), SIZES)
@pytest.mark.parametrize("exponent", [1.0 / 3.0, 0.7])
def test_maxwell_slip_is_recovered(amplitude_m: float, fc: float, exponent: float) -> None:
    runs = bending("maxwell_slip", amplitude_m, fc, exponent=exponent)
    fit = jbf.fit(jbf.Rig(), runs, law="maxwell_slip")
    check(fit, {"F_c_n": fc, "sigma_0_n_m": fc / (0.2 * amplitude_m)}, 0.02 * fc, 0.02)
    check(fit, {"exponent": exponent, "F_v_n_s_m": 0.02 * fc / amplitude_m}, 0.02 * fc, 0.1)


@pytest.mark.parametrize(("amplitude_m", "fc"), SIZES)
@pytest.mark.parametrize("breakaway", [0.3, 0.8])
def test_elasto_plastic_is_recovered(amplitude_m: float, fc: float, breakaway: float) -> None:
    runs = bending("elasto_plastic", amplitude_m, fc, breakaway=breakaway)
    fit = jbf.fit(jbf.Rig(), runs, law="elasto_plastic")
    check(fit, {"F_c_n": fc, "sigma_0_n_m": fc / (0.2 * amplitude_m)}, 0.02 * fc, 0.02)
    check(fit, {"breakaway": breakaway, "F_v_n_s_m": 0.02 * fc / amplitude_m}, 0.02 * fc, 0.1)


def test_the_half_sine_of_the_paper_is_nearly_the_same() -> None:
    runs = bending("elasto_plastic_sine", 2e-4, 2.3, breakaway=0.6)
    fit = jbf.fit(jbf.Rig(), runs, law="elasto_plastic")
    check(fit, {"F_c_n": 2.3, "sigma_0_n_m": 2.3 / 4e-5}, 0.02 * 2.3, 0.02)


@pytest.mark.parametrize(
    ("law", "shape"),
    [
        ("maxwell_slip", {"exponent": 0.5}),
        ("maxwell_slip", {"exponent": 1.0}),
        ("elasto_plastic", {"breakaway": 0.6}),
    ],
)
def test_a_law_that_bends_lacks_nothing_in_its_own_data(law: str, shape: dict[str, float]) -> None:
    diagnosis = jbf.diagnose(jbf.Rig(), bending(law, 2e-4, 2.3, **shape), law=law)
    assert diagnosis.verdict == "adequate", diagnosis.summary()
    assert diagnosis.effects == ()
    tried = {t.effect for step in diagnosis.steps for t in step.trials}
    assert not tried & {"presliding", "drive_compliance", "backlash"}


@pytest.mark.parametrize(("amplitude_m", "fc"), SIZES)
def test_a_level_that_falls_with_speed_is_found(amplitude_m: float, fc: float) -> None:
    """Generalised Maxwell slip: the law and `stribeck_excess`, whatever the machine's size."""
    vs = 0.6 * amplitude_m
    runs = bending("maxwell_slip", amplitude_m, fc, exponent=0.5, excess=0.4 * fc, vs=vs)
    diagnosis = jbf.diagnose(jbf.Rig(), runs, law="maxwell_slip")
    assert diagnosis.effects == ("stribeck_excess",), diagnosis.summary()
    found = diagnosis.model.parameters
    assert found["stribeck_excess.a"].value == pytest.approx(0.4 * fc, rel=0.05)
    assert found["stribeck_excess.v_s_m_s"].value == pytest.approx(vs, rel=0.1)
    assert found["F_c_n"].value == pytest.approx(fc, rel=0.02)


def test_a_load_dependent_elasto_plastic_law_is_found() -> None:
    """A level that grows with the load, as strain-wave drives have it."""
    mu, fc = 0.3, 2.3
    runs = []
    for seed, omega in enumerate((0.8, 4.0)):
        speed = other.stroke_speed(2e-4, omega)
        load = 4.0 + 3.0 * np.sin(0.21 * T + seed)

        def bent(t: float, f: float, speed: other.Speed = speed, seed: int = seed) -> float:
            level = fc + mu * (4.0 + 3.0 * np.sin(0.21 * t + seed))
            v = speed(t)
            share = f / level * np.sign(v)
            beyond = (share - 0.6) / 0.4 if share > 0.6 else 0.0
            return float(6e4 * v * (1.0 - beyond))

        friction = other.driven(bent, T)
        run = other.record(speed, T, friction, 0.05, seed, f"run{seed}")
        runs.append(dataclasses.replace(run, load_n=load))
    diagnosis = jbf.diagnose(jbf.Rig(), runs, law="elasto_plastic")
    assert diagnosis.effects == ("dry_load_dependence",), diagnosis.summary()
    found = diagnosis.model.parameters
    assert found["dry_load_dependence.mu"].value == pytest.approx(mu, rel=0.05)
    assert found["breakaway"].value == pytest.approx(0.6, rel=0.1)


def test_a_hum_before_the_first_stroke_bends_nothing() -> None:
    """A machine that stands, its speed a hum to and fro, then a stroke: the virgin curve."""
    t = np.arange(0.0, 4.0, 0.005)
    v = np.where(t < 1.0, -1e-9 * np.cos(40.0 * t), 2e-4 * np.minimum(2.0 * (t - 1.0), 1.0))
    for law in ("dahl", "maxwell_slip", "elasto_plastic"):
        force = jbf.Model(jbf.Rig(), law).predict(jbf.Run.from_arrays(t, v))
        assert np.max(np.abs(force[t < 1.0])) < 1e-3, law
        assert np.all(np.diff(force[t > 1.0]) > -1e-9), law
    sliding = jbf.Run.from_arrays(t, np.where(t < 2.0, -2e-4, 2e-4))
    # Friction of 10 N, and 2 mN of viscous.
    assert jbf.Model(jbf.Rig(), "dahl").predict(sliding)[0] == pytest.approx(-10.002)


def test_runs_cut_at_rest_lack_nothing() -> None:
    """Strokes with rests between, cut within the rests: each run begins bent as the one before it
    left the contact, which no record of a motion tells."""
    p = {"fc": 2.3, "s0": 6e4, "exponent": 0.5, "fv": 0.0}

    def speed(t: float) -> float:
        # To and fro, a rest after each.
        phase = t % 2.0
        way = 1.0 if (t // 2.0) % 2.0 == 0.0 else -1.0
        return way * 2.5e-4 * np.sin(np.pi * min(phase, 1.0))

    t = np.arange(0.0, 40.0, 0.005)
    whole = other.record(speed, t, other.maxwell_slip(speed, t, **p), 0.03, 0, count_m=1e-9)
    runs = []
    for k in range(5):
        part = whole.select((t >= 8.0 * k + 1.5) & (t < 8.0 * k + 9.5))
        runs.append(dataclasses.replace(part, name=f"run{k}"))
    diagnosis = jbf.diagnose(jbf.Rig(), runs, law="maxwell_slip")
    assert diagnosis.verdict == "adequate", diagnosis.summary()
    assert {f.kind for f in diagnosis.findings} == {"unsettled_start"}
    assert diagnosis.model.parameters["F_c_n"].value == pytest.approx(2.3, rel=0.01)


def test_seven_parameters_are_recovered() -> None:
    p = {
        "kt": 1e5,
        "fc": 6.0,
        "fv": 40.0,
        "fs": 3.0,
        "vs": 0.003,
        "tau": 0.03,
        "gamma": 0.8,
    }
    runs = runs_of("seven", 2e-3, 0.03, **p)
    fit = jbf.fit(jbf.Rig(), runs, law="seven_parameter")
    truth = {"k_t_n_m": 1e5, "F_c_n": 6.0, "F_v_n_s_m": 40.0, "tau_L_s": 0.03}
    check(fit, truth, 0.03, 0.06)


def test_the_core_agrees_with_scipy() -> None:
    speed = other.stroke_speed(1e-3, 3.0)
    t = np.arange(0.0, 8.0, 1e-3)
    v = np.array([speed(x) for x in t])
    run = jbf.Run.from_arrays(t, v)
    p = {"fc": 6.0, "fs": 9.0, "vs": 0.003, "s0": 6e4, "s1": 150.0, "vd": 0.02, "fv": 40.0}
    names = ["F_c_n", "F_s_n", "v_s_m_s", "sigma_0_n_m", "sigma_1_n_s_m", "v_d_m_s", "F_v_n_s_m"]
    values = dict(zip(names, p.values(), strict=True))
    model = jbf.Model(jbf.Rig(), "lugre", parameters=values)
    # The core's bristle starts bent in the direction of motion, scipy's at rest.
    settled = t > 2.0
    gap = model.predict(run) - other.lugre(speed, t, **p)
    assert float(np.max(np.abs(gap[settled]))) < 2e-3


@pytest.mark.parametrize("law", [law.name for law in NEWTONS])
def test_a_model_is_kept_by_its_file(law: str, tmp_path: Path) -> None:
    model = jbf.Model(jbf.Rig(), law)
    model.save(tmp_path / "model.toml")
    again = jbf.Model.load(tmp_path / "model.toml")
    assert again.law == law
    assert again.parameters == model.parameters
    f = again.steady_friction([-0.02, 0.02])
    assert f[1] == -f[0] > 0.0
    assert "clock" not in again.law


def test_effects_that_mean_nothing_are_refused() -> None:
    with pytest.raises(jbf.InputError, match=r"thermal_thinning .* coulomb has no lubricant film"):
        jbf.Model(jbf.Rig(), "coulomb", ["thermal_thinning"])
    with pytest.raises(jbf.InputError, match="bristle of its own"):
        jbf.Model(jbf.Rig(), "lugre", ["presliding"])


def test_a_linear_axis_has_no_angle() -> None:
    run = runs_of("stribeck", 0.01, 0.05, fc=6.0, fs=6.0, vs=0.01, delta=1.0, fv=1.0)[0]
    with pytest.raises(jbf.InputError, match="position_ripple"):
        jbf.Model(jbf.Rig(), "coulomb", ["position_ripple"]).predict(run)
    soft = jbf.Model(
        jbf.Rig(),
        "coulomb",
        ["drive_compliance"],
        {
            "F_c_n": 6.0,
            "F_s_n": 7.0,
            "drive_compliance.k": 1e4,
            "drive_compliance.c": 20.0,
            "drive_compliance.J": 1.0,
        },
    )
    assert np.all(np.isfinite(soft.predict(run)))
    bare = jbf.Run.from_arrays(run.time_s, run.velocity_m_s, run.friction_n)
    with pytest.raises(jbf.InputError, match="position_m"):
        soft.predict(bare)


def test_a_hidden_effect_is_found_beside_a_law_in_newtons() -> None:
    p = {"fc": 6.0, "s0": 3e4, "exponent": 1.0, "fv": 40.0}
    runs = runs_of("dahl", 2e-3, 0.05, **p)
    diagnosis = jbf.diagnose(jbf.Rig(), runs, law="coulomb")
    assert diagnosis.effects == ("presliding",), diagnosis.summary()
    tried = {t.effect for step in diagnosis.steps for t in step.trials}
    assert not tried & {"thermal_thinning", "coulomb_drag", "position_ripple"}
    assert all(f.axis != "regime" for f in diagnosis.failures)


# ---- the command line -----------------------------------------------------------------------


@pytest.fixture
def axis(tmp_path: Path) -> Path:
    """A folder with an empty rig and two runs of a linear axis."""
    p = {"fc": 2.3, "s0": 5e4, "exponent": 1.0, "fv": 20.0}
    (tmp_path / "rig.toml").write_text("")
    (tmp_path / "runs").mkdir()
    for run in runs_of("dahl", 2e-4, 0.02, **p):
        run.write_csv(tmp_path / "runs" / f"{run.name}.csv")
    return tmp_path


def test_fit_compare_predict(axis: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig, runs, model = str(axis / "rig.toml"), str(axis / "runs"), str(axis / "model.toml")
    assert main(["fit", rig, runs, "--law", "dahl", "--out", model]) == 0
    said = capsys.readouterr().out
    assert "law                    = dahl\n" in said
    assert main(["compare", model, runs, "--report", str(axis / "c.html")]) == 0
    csv = str(axis / "runs" / "run0.csv")
    assert main(["predict", model, csv, "--out", str(axis / "p.csv")]) == 0
    assert "law dahl" in (axis / "c.html").read_text()


def test_diagnose(axis: Path) -> None:
    rig, runs = str(axis / "rig.toml"), str(axis / "runs")
    out, page = str(axis / "d.json"), str(axis / "d.html")
    command = ["diagnose", rig, runs, "--law", "dahl", "--json", out, "--report", page]
    assert main(command) == 0
    found: dict[str, Any] = json.loads(Path(out).read_text())
    assert found["verdict"] == "adequate"
    assert found["effects"] == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--law", "dhal"], 'there is no law "dhal"'),
        (["--law", "coulomb", "--effects", "thermal_thinning"], "has no lubricant film"),
        (["--law", "lugre", "--effects", "presliding"], "bristle of its own"),
        (["--law", "journal"], "the rig has no [bearing]"),
    ],
)
def test_wrong_input_is_one_line(
    axis: Path, arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    rig, runs, model = str(axis / "rig.toml"), str(axis / "runs"), axis / "model.toml"
    assert main(["fit", rig, runs, *arguments, "--out", str(model)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert words in said
    assert not model.exists()


def test_effects_of_a_law(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "--law", "lugre"]) == 0
    said = capsys.readouterr().out
    applies, refused = said.split("[not with lugre")
    assert "sensor_lag" in applies
    assert "thermal_thinning" not in applies
    assert "thermal_thinning" in refused
    assert "presliding" in refused
