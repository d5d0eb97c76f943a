"""Exported Rust and C code is compiled, run and compared bit for bit with `jbf predict`."""

import shutil
import subprocess
from pathlib import Path

import jbf
import numpy as np
import pytest
from input_checks import Capture
from jbf import cli, export
from jbf.models.chain import MAX_STEP_S

ROOT = Path(__file__).resolve().parents[3]
Rows = dict[str, list[list[str]]]
TEMPERATURE_EFFECTS = ("dry_temperature_dependence", "viscous_temperature_dependence")

RUST_MAIN = """
mod drag;
mod gear;
mod gms;
mod joint;
mod slider;
mod warm;

use jbf_core::effect::Effect;
use jbf_core::law::Named;
use jbf_core::run::{predict, Record};
use jbf_core::{Chain, Motion, Real};

fn main() {
    let text = std::fs::read_to_string(std::env::args().nth(1).unwrap()).unwrap();
    let mut columns: [Vec<f64>; 7] = Default::default();
    for line in text.lines() {
        for (column, cell) in columns.iter_mut().zip(line.split(' ')) {
            column.push(cell.parse().unwrap());
        }
    }
    match std::env::args().nth(2).unwrap().as_str() {
        "drag" => run(drag::model::<f64>().unwrap(), drag::model::<f32>().unwrap(), &columns),
        "gear" => run(gear::model::<f64>().unwrap(), gear::model::<f32>().unwrap(), &columns),
        "warm" => run(warm::model::<f64>().unwrap(), warm::model::<f32>().unwrap(), &columns),
        "gms" => run(gms::model::<f64>().unwrap(), gms::model::<f32>().unwrap(), &columns),
        "joint" => run(joint::model::<f64>().unwrap(), joint::model::<f32>().unwrap(), &columns),
        _ => run(slider::model::<f64>().unwrap(), slider::model::<f32>().unwrap(), &columns),
    }
}

fn step<T: Real, L: Named<T>, E: Effect<T>>(
    chain: &Chain<T, L, E>,
    c: &[Vec<f64>; 7],
) -> Vec<T> {
    let motion = |i: usize| Motion {
        time_s: T::of(c[0][i]),
        velocity_m_s: T::of(c[1][i]),
        acceleration_m_s2: T::of(c[2][i]),
        angle_rad: T::of(c[3][i]),
        weight_offset_rad: T::of(if c[6][i].is_nan() { 0.0 } else { c[6][i] }),
        load_n: T::of(c[4][i]),
        temperature_c: (!c[5][i].is_nan()).then(|| T::of(c[5][i])),
    };
    let mut state = chain.start(&motion(0));
    let mut out = vec![state.reading_n];
    for i in 1..c[0].len() {
        out.push(chain.step(&mut state, &motion(i), T::of(c[0][i] - c[0][i - 1])));
    }
    out
}

fn optional(column: &[f64]) -> Option<&[f64]> {
    (!column[0].is_nan()).then_some(column)
}

fn run<L, E, S, F>(model: Chain<f64, L, E>, small: Chain<f32, S, F>, c: &[Vec<f64>; 7])
where
    L: Named<f64>,
    E: Effect<f64>,
    S: Named<f32>,
    F: Effect<f32>,
{
    let [time_s, velocity_m_s, acceleration_m_s2, angle_rad, load_n, celsius, offset] = c;
    let record = Record {
        time_s,
        velocity_m_s,
        acceleration_m_s2,
        angle_rad,
        load_n,
        temperature_c: optional(celsius),
        weight_offset_rad: optional(offset),
    };
    let mut predicted = vec![0.0; time_s.len()];
    predict(&model, &record, MAX_STEP_S, |i, f| predicted[i] = f);
    let (f64s, f32s) = (step(&model, c), step(&small, c));
    for ((a, b), c) in predicted.iter().zip(f64s).zip(f32s) {
        println!("{:016x} {:016x} {:08x}", a.to_bits(), b.to_bits(), c.to_bits());
    }
}
"""

C_MAIN = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

#define MAX_ROWS 5000
static double column[7][MAX_ROWS], predicted[MAX_ROWS];

int main(int argc, char **argv) {
  size_t n = 0;
  FILE *file = argc > 1 ? fopen(argv[1], "r") : NULL;
  if (!file) return 1;
  while (n < MAX_ROWS && fscanf(file, "%lf %lf %lf %lf %lf %lf %lf", &column[0][n], &column[1][n],
                            &column[2][n], &column[3][n], &column[4][n], &column[5][n],
                            &column[6][n]) == 7)
    n++;
  model_f64 model;
  model_f64_state state;
  model_f32 small;
  model_f32_state small_state;
  jbf_error error;
  if (model_f64_init(&model, &error) || model_f32_init(&small, NULL)) {
    fprintf(stderr, "%s %s\\n", error.name, error.rule);
    return 2;
  }
  const double wrong = -1.0;
  if (model_f64_init(NULL, &error) != JBF_NULL) return 3;
  const double *celsius = isnan(column[5][0]) ? NULL : column[5];
  const double *offset = isnan(column[6][0]) ? NULL : column[6];
  jbf_record record = {n, column[0], column[1], column[2], column[3], column[4], celsius, offset};
  if (model_f64_predict(&model, &record, MAX_STEP_S, predicted)) return 4;
  for (size_t i = 0; i < n; i++) {
    jbf_motion_f64 m = {column[0][i], column[1][i], column[2][i], column[3][i],
                        column[4][i], column[5][i], offset ? offset[i] : 0};
    jbf_motion_f32 s = {(float)m.time_s, (float)m.velocity_m_s,
                        (float)m.acceleration_m_s2,
                        (float)m.angle_rad, (float)m.load_n, (float)m.temperature_c,
                        (float)m.weight_offset_rad};
    double dt_s = i ? m.time_s - column[0][i - 1] : 0;
    double f = i ? model_f64_step(&model, &state, &m, dt_s) : model_f64_start(&model, &state, &m);
    float g = i ? model_f32_step(&small, &small_state, &s, (float)dt_s)
                : model_f32_start(&small, &small_state, &s);
    unsigned long long a, b;
    unsigned c;
    memcpy(&a, &predicted[i], 8);
    memcpy(&b, &f, 8);
    memcpy(&c, &g, 4);
    printf("%016llx %016llx %08x\\n", a, b, c);
  }
  if (EFFECT(&model, "sensor_lag", &wrong, 1, &error) != JBF_PARAMETER) return 5;
  if (strcmp(error.name, "tau_s") || error.value != -1.0) return 6;
  if (EFFECT(&model, "no_such", &wrong, 1, &error) != JBF_NAME) return 7;
  return 0;
}
"""

CARGO = """
[package]
name = "exported"
version = "0.0.0"
edition = "2021"
[dependencies]
jbf-core = {{ path = "{core}" }}
[workspace]
"""


def models() -> dict[str, jbf.Model]:
    """Bearings with effects at several stages, and drives without a bearing."""
    return {
        "drag": jbf.Model(
            jbf.Rig.thesis("4.2"),
            effects=["presliding", "sensor_lag", "coulomb_drag"],
            parameters={"f_m": 0.26, "presliding.sigma": 2e3, "coulomb_drag.F_d": 1.058},
            clock="thesis",
        ),
        "slider": jbf.Model(jbf.Rig(), law="lugre", effects=["sensor_offset"]),
        "gms": jbf.Model(jbf.Rig(), law="maxwell_slip", effects=["stribeck_excess"]),
        "gear": jbf.Model(
            jbf.Rig(), law="elasto_plastic", effects=["dry_load_dependence", *TEMPERATURE_EFFECTS]
        ),
        "joint": jbf.Model(
            jbf.Rig(drive=jbf.Drive("rotary", "torque")),
            law="coulomb",
            effects=["gravity"],
            parameters={"gravity.G": 5.0, "gravity.theta_0_rad": 0.7},
        ),
        "warm": jbf.Model(jbf.Rig.thesis("4.2"), effects=["vogel_viscosity"]),
    }


def motion(model: jbf.Model) -> jbf.Run:
    """A sine with a rest, and a rising temperature if an effect requires it.

    The joint is behind another moving joint.
    """
    time_s = np.arange(0.0, 8.0, 0.01)
    speed = 0.05 * np.sin(2.0 * time_s) * (np.abs(time_s - 4.0) > 0.5)
    path = np.cumsum(speed) * 0.01
    thermal = {"vogel_viscosity", *TEMPERATURE_EFFECTS} & set(model.effects)
    celsius = 25.0 + 2.0 * time_s if thermal else None
    if model.rig.drive is not None:
        link = {"weight_angle_rad": path + 0.9 * np.sin(0.4 * time_s)}
        return jbf.Run.from_arrays(time_s, speed, angle_rad=path, extra=link)
    if model.rig.bearing is None:
        return jbf.Run("motion", time_s, speed, position_m=path, temperature_c=celsius)
    angle = path / model.rig.bearing.radius_m
    return jbf.Run.from_arrays(time_s, speed, angle_rad=angle, temperature_c=celsius)


def run(*command: object, folder: Path) -> str:
    """Run a command that must succeed; return what it prints."""
    words = [str(c) for c in command]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the motion of each model: its columns, NaN where one was not recorded."""
    if shutil.which("cargo") is None or not (ROOT / "crates" / "jbf-c").is_dir():
        pytest.skip("needs cargo and the source tree")
    folder = tmp_path_factory.mktemp("export")
    for name, model in models().items():
        r = export.record(model, motion(model))
        columns = (r.time_s, r.velocity_m_s, r.acceleration_m_s2, r.angle_rad, r.load_n)
        missing = np.full(len(r.time_s), np.nan)
        optional = (missing if c is None else c for c in (r.temperature_c, r.weight_offset_rad))
        rows = zip(*(c.tolist() for c in (*columns, *optional)), strict=True)
        text = "\n".join(" ".join(map(repr, row)) for row in rows)
        (folder / f"{name}.txt").write_text(text + "\n")
    return folder


@pytest.fixture(scope="module")
def rust(prepared: Path) -> Rows:
    """Output of the exported Rust code: batch prediction, steps in f64, steps in f32."""
    source = prepared / "src"
    source.mkdir()
    core = (ROOT / "crates" / "jbf-core").as_posix()
    (prepared / "Cargo.toml").write_text(CARGO.format(core=core))
    shutil.copy(ROOT / "Cargo.lock", prepared / "Cargo.lock")
    (source / "main.rs").write_text(RUST_MAIN.replace("MAX_STEP_S", repr(MAX_STEP_S)))
    for name, model in models().items():
        (source / f"{name}.rs").write_text(export.rust(model))
    target = ROOT / "target" / "exported"
    run("cargo", "build", "--quiet", "--target-dir", target, folder=prepared)
    program = target / "debug" / "exported"
    texts = {name: run(program, f"{name}.txt", name, folder=prepared) for name in models()}
    return {name: [row.split() for row in text.split("\n")] for name, text in texts.items()}


def bits(text: str) -> float:
    """Return the float64 with the given bits, in hexadecimal digits."""
    return float(np.array([int(text, 16)], dtype=np.uint64).view(np.float64)[0])


@pytest.mark.extended
@pytest.mark.parametrize("name", models())
def test_exported_rust_predicts_the_same_bits_as_the_model(rust: Rows, name: str) -> None:
    model = models()[name]
    force = np.array([bits(row[0]) for row in rust[name] if row])
    samples = export.record(model, motion(model)).samples
    assert force[samples].tolist() == model.predict(motion(model)).tolist()
    assert len(set(force)) > 100


@pytest.mark.extended
@pytest.mark.parametrize("name", models())
def test_exported_rust_in_single_precision_agrees_with_double(rust: Rows, name: str) -> None:
    single = [np.uint32(int(row[2], 16)).view(np.float32) for row in rust[name] if row]
    double = [bits(row[1]) for row in rust[name] if row]
    assert np.allclose(single, double, atol=2e-3 * np.max(np.abs(double)))


@pytest.mark.extended
@pytest.mark.parametrize("name", models())
def test_exported_c_returns_the_bits_of_exported_rust(
    prepared: Path, rust: Rows, name: str
) -> None:
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("needs a C compiler")
    model = models()[name]
    folder = prepared / name
    folder.mkdir()
    (folder / "model.h").write_text(export.c(model))
    (folder / "main.c").write_text(C_MAIN)
    run("cargo", "build", "--quiet", "-p", "jbf-c", "--target-dir", ROOT / "target", folder=ROOT)
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1"]
    options += [f"-DMAX_STEP_S={MAX_STEP_S!r}", f"-DEFFECT=jbf_{model.law}_f64_effect"]
    include, library = ROOT / "crates" / "jbf-c" / "include", ROOT / "target/debug/libjbf_c.a"
    libraries = ["-lm", "-lpthread", "-ldl"]
    run(compiler, *options, f"-I{include}", "main.c", library, *libraries, "-o", "c", folder=folder)
    out = run(folder / "c", prepared / f"{name}.txt", folder=folder)
    assert [row.split() for row in out.split("\n")] == rust[name]


@pytest.mark.parametrize("name", models())
def test_exported_source_contains_every_constant_of_the_model(name: str) -> None:
    model = models()[name]
    rust, c = export.rust(model), export.c(model)
    for dotted, parameter in model.parameters.items():
        block, _, parameter_name = dotted.rpartition(".")
        table = (block or model.law).upper()
        for source, head, end in (
            (rust, f"pub const {table}: ", f", // {parameter_name}"),
            (c, f"MODEL_{table}[", f", /* {parameter_name} */"),
        ):
            constants = source[source.index(head) :].split(";\n")[0].splitlines()
            (line,) = [line for line in constants if line.endswith(end)]
            assert float(line.split(",")[0].split(":")[-1]) == parameter.value
    if model.rig.bearing is not None:
        assert f"LOAD_N: f64 = {model.rig.load.normal_n!r};" in rust
        assert f"MODEL_LOAD_N = {model.rig.load.normal_n!r};" in c
        for key in ("radius_m", "length_m", "clearance_m", "mass_kg"):
            assert f".with_{key}({getattr(model.rig.bearing, key)!r})" in rust
            assert f".{key} = {getattr(model.rig.bearing, key)!r}," in c
        assert f"Clock::{model.clock.capitalize()}" in rust
        assert f"JBF_CLOCK_{model.clock.upper()}" in c


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    """The model file of `drag`."""
    models()["drag"].save(tmp_path / "model.toml")
    return tmp_path / "model.toml"


def test_export_command_writes_rust_and_c_source(saved: Path) -> None:
    rust, c = saved.with_suffix(".rs"), saved.with_suffix(".h")
    assert cli.main(["export", str(saved), "--rust", str(rust), "--c", str(c)]) == 0
    assert rust.read_text() == export.rust(models()["drag"], "model.toml")
    assert c.read_text() == export.c(models()["drag"], "model.toml")


def test_export_command_without_an_output_file_is_refused(saved: Path, capsys: Capture) -> None:
    assert cli.main(["export", str(saved)]) == 2
    assert "no output is given" in capsys.readouterr().err


def test_effect_is_exported_unless_its_parameter_is_at_an_infinite_null() -> None:
    for sigma, written in ((2e3, True), (np.inf, False)):
        values = {"presliding.sigma": sigma}
        model = jbf.Model(jbf.Rig.thesis("4.2"), effects=["presliding"], parameters=values)
        assert ("presliding" in export.rust(model)) is written
        assert ("presliding" in export.c(model)) is written
