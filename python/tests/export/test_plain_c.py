"""C code without the core: compiled, run along reference motions and compared with the core."""

import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Literal

import jbf
import numpy as np
import pytest
from equation_models import (
    EFFECTS,
    model_of,
    model_with,
    models_with_many_effects,
    runs_with_all_columns,
)
from jbf import export
from jbf.export.equations import LAWS
from joint_runs import JOINT, joint_runs

ULPS = 2
ALL_BITS = ("coulomb", "maxwell_slip", "elasto_plastic", "seven_parameter")
"""Laws whose force is that of the core to the last bit: they use no function of math.h."""

STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off")
CORTEX_M4F = ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")
MAIN = """
#include <stdio.h>
#include "model.h"
int main(void) {
  joint_friction_motion m;
  joint_friction_state state;
  double x[7];
  int first = 1;
  while (scanf("%lf %lf %lf %lf %lf %lf %lf", x, x + 1, x + 2, x + 3, x + 4, x + 5, x + 6) == 7) {
    m.time_s = x[0];
    m.velocity = (joint_friction_real)x[1];
    m.acceleration = (joint_friction_real)x[2];
    m.position = (joint_friction_real)x[3];
    m.weight_offset = (joint_friction_real)x[4];
    m.load = (joint_friction_real)x[5];
    m.temperature = (joint_friction_real)x[6];
    printf("%.17g\\n", (double)(first ? joint_friction_start(&state, &m)
                                      : joint_friction_step(&state, &m)));
    first = 0;
  }
  return 0;
}
"""


def compiler(name: str = "cc") -> str:
    path = shutil.which(name) or (shutil.which("gcc") if name == "cc" else None)
    if path is None:
        pytest.skip(f"needs a compiler, {name}")
    return path


def run_program(
    exported: export.Exported, folder: Path, record: export.Record, name: str = "cc"
) -> np.ndarray:
    """Compile an export with a program of its own and run it along a motion."""
    exported.save(folder / "model.c")
    (folder / "main.c").write_text(MAIN)
    build = [compiler(name), *STRICT, "-O1", "model.c", "main.c", "-lm", "-o", "program"]
    done = subprocess.run(build, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    zero = np.zeros(len(record.time_s))
    rows = np.stack(
        [
            record.time_s,
            record.velocity_m_s,
            record.acceleration_m_s2,
            record.angle_rad,
            zero if record.weight_offset_rad is None else record.weight_offset_rad,
            record.load_n,
            zero if record.temperature_c is None else record.temperature_c,
        ],
        axis=1,
    )
    text = "\n".join(" ".join(map(repr, row)) for row in rows.tolist())
    out = subprocess.run([folder / "program"], input=text, capture_output=True, text=True)
    assert out.returncode == 0
    return np.array(out.stdout.split(), float)[record.samples]


@pytest.mark.parametrize(("law", "step_s"), [*((law, 0.005) for law in LAWS), ("lugre", 0.001)])
def test_compiled_law_gives_the_numbers_of_the_core(
    law: str, step_s: float, tmp_path: Path
) -> None:
    model = model_of(law)
    run = runs_with_all_columns(step_s)[0]
    exported = export.to(model, "c", [run])
    force = run_program(exported, tmp_path, export.record(model, run))
    expected = model.predict(run)
    if law in ALL_BITS:
        assert force.tolist() == expected.tolist()
    spacing = np.spacing(np.max(np.abs(expected)))
    assert np.max(np.abs(force - expected)) <= ULPS * spacing
    assert exported.ledger.term(law).status == "exact"
    assert exported.ledger.share < 1e-15


@pytest.mark.parametrize("effect", EFFECTS)
def test_compiled_effect_gives_the_numbers_of_the_core(effect: str) -> None:
    compiler()
    model = model_with(effect)
    ledger = export.to(model, "c", runs_with_all_columns(0.01)).ledger
    assert ledger.term(effect).status == "exact"
    assert "compiled" in ledger.evaluated_by
    scale = max(np.max(np.abs(model.predict(run))) for run in runs_with_all_columns(0.01))
    assert max(loss.largest for loss in ledger.runs) <= 2 * ULPS * np.spacing(scale)


def test_compiled_model_with_many_effects_gives_the_numbers_of_the_core(tmp_path: Path) -> None:
    names = ("stribeck_excess", "viscous_thinning", "dry_asymmetry", "pitch_ripple")
    model = model_of("maxwell_slip", *names, "coulomb_drag", "gravity", "inertia", "cogging")
    run = runs_with_all_columns(0.002)[1]
    exported = export.to(model, "c", [run])
    force = run_program(exported, tmp_path, export.record(model, run))
    expected = model.predict(run)
    assert np.max(np.abs(force - expected)) <= 2 * ULPS * np.spacing(np.max(np.abs(expected)))


@pytest.mark.parametrize(
    "law",
    [law if law == "lugre" else pytest.param(law, marks=pytest.mark.extended) for law in LAWS],
)
def test_clang_gives_the_numbers_of_the_core(law: str, tmp_path: Path) -> None:
    compiler("clang")
    model, run = model_of(law), runs_with_all_columns(0.005)[0]
    exported = export.to(model, "c", [run])
    force = run_program(exported, tmp_path, export.record(model, run), "clang")
    expected = model.predict(run)
    assert np.max(np.abs(force - expected)) <= ULPS * np.spacing(np.max(np.abs(expected)))


@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("model", models_with_many_effects(), ids=lambda model: model.law)
def test_code_compiles_for_a_cortex_m4f_without_warnings(
    model: jbf.Model, precision: Literal["double", "float"], tmp_path: Path
) -> None:
    command = [compiler("arm-none-eabi-gcc"), *CORTEX_M4F, *STRICT, "-Wconversion", "-O2", "-c"]
    if precision == "float":
        # A promotion would call the double-precision library of a single-precision processor.
        command += ["-Wdouble-promotion"]
    runs, settings = runs_with_all_columns(0.02), export.Settings(precision=precision)
    export.to(model, "c", runs, settings=settings).save(tmp_path / "model.c")
    done = subprocess.run([*command, "model.c"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "law", ["stribeck", "lugre", "maxwell_slip", "seven_parameter", "rate_and_state"]
)
def test_single_precision_agrees_to_its_rounding_errors(law: str, tmp_path: Path) -> None:
    model, run = model_of(law), runs_with_all_columns(0.005)[0]
    settings = export.Settings(precision="float")
    exported = export.to(model, "c", [run], settings=settings)
    force = run_program(exported, tmp_path, export.record(model, run))
    assert force == pytest.approx(model.predict(run), abs=2e-3 * np.max(np.abs(force)))
    assert exported.ledger.share < 1e-3


def test_header_and_code_compile_as_cpp(tmp_path: Path) -> None:
    exported = export.to(model_of("lugre"), "c", joint_runs())
    exported.save(tmp_path / "elbow.c")
    (tmp_path / "main.cpp").write_text(
        '#include "elbow.h"\n'
        "int main() { joint_friction_motion m = {}; joint_friction_state s;\n"
        "  return joint_friction_start(&s, &m) != 0; }\n"
    )
    strict = ["-Wall", "-Wextra", "-Werror"]
    for command in (
        [compiler(), "-std=c99", *strict, "-c", "elbow.c"],
        [compiler("c++"), *strict, "main.cpp", "elbow.o", "-lm", "-o", "main"],
        [str(tmp_path / "main")],
    ):
        assert subprocess.run(command, cwd=tmp_path).returncode == 0


def test_sample_that_is_not_later_or_not_finite_changes_nothing(tmp_path: Path) -> None:
    model, run = model_of("lugre"), runs_with_all_columns(0.01)[0]
    exported = export.to(model, "c", [run])
    record = export.record(model, run)
    plain = run_program(exported, tmp_path, record)
    twice = {name: np.repeat(getattr(record, name), 2) for name in (
        "time_s", "acceleration_m_s2", "angle_rad", "load_n", "temperature_c",
    )}  # fmt: skip
    speed = np.repeat(record.velocity_m_s, 2)
    speed[1::2] = np.where(np.arange(len(record.time_s)) % 2, np.nan, 1e3)
    doubled = export.Record(
        samples=2 * record.samples + 1, velocity_m_s=speed, weight_offset_rad=None, **twice
    )
    assert run_program(exported, tmp_path, doubled).tolist() == plain.tolist()


def test_driven_side_that_rings_and_reverses_within_a_step_gives_the_numbers_of_the_core(
    tmp_path: Path,
) -> None:
    values = {"F_c": 5e-4, "F_s": 5e-4, "F_v": 0.0, "presliding.sigma": 100.0}
    values |= {"drive_compliance.k": 60.0, "drive_compliance.c": 1e-4, "drive_compliance.J": 2e-3}
    values["inertia.m_e"] = 3e-3
    effects = ["drive_compliance", "backlash", "inertia", "presliding"]
    model = jbf.Model(JOINT, "coulomb", effects, values | {"backlash.gap": 1e-3})
    run = runs_with_all_columns(0.01)[0]
    force = run_program(export.to(model, "c", [run]), tmp_path, export.record(model, run))
    assert force.tolist() == model.predict(run).tolist()


def test_time_and_distance_of_a_state_count_from_the_start_of_the_motion(tmp_path: Path) -> None:
    model, run = model_of("coulomb", "warm_up", "running_in"), runs_with_all_columns(0.01)[0]
    exported = export.to(model, "c", [run])
    record = export.record(model, run)
    first = run_program(exported, tmp_path, record)
    later = run_program(exported, tmp_path, replace(record, time_s=record.time_s + 1000.0))
    assert later == pytest.approx(first, rel=1e-9)


@pytest.mark.parametrize(
    ("model", "settings"),
    [
        (jbf.Model(jbf.Rig.thesis()), export.Settings()),
        (jbf.Model(JOINT, "coulomb", ["presliding"]), export.Settings()),
        (jbf.Model(JOINT, "coulomb"), export.Settings(joint="left elbow")),
    ],
)
def test_law_effect_or_name_without_a_form_in_c_is_refused(
    model: jbf.Model, settings: export.Settings
) -> None:
    with pytest.raises(jbf.InputError):
        export.to(model, "c", joint_runs(model.rig), settings=settings)


def test_without_a_compiler_the_ledger_says_that_the_code_was_not_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PATH", "")
    ledger = export.to(model_of("coulomb"), "c", joint_runs()).ledger
    assert "no C compiler" in ledger.evaluated_by


@pytest.mark.parametrize("refused", ["friction", "math.h"])
def test_code_that_a_working_compiler_refuses_is_an_error(
    refused: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    script = tmp_path / "cc"
    script.write_text(
        "#!/bin/sh\n"
        'for file in "$@"; do case "$file" in model.c|probe.c) '
        f'if {shutil.which("grep")} -q "{refused}" "$file"; then '
        'echo "$file:1: error: refused" >&2; exit 1; fi;; esac; done\n'
        f'exec {compiler()} "$@"\n'
    )
    script.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    model, runs = model_of("coulomb"), joint_runs(step_s=0.02)
    if refused == "friction":
        with pytest.raises(jbf.InputError, match="error: refused"):
            export.to(model, "c", runs)
    else:
        assert "no C compiler" in export.to(model, "c", runs).ledger.evaluated_by
