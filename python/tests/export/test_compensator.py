"""Compensator in C: replayed along a loop that the core ran, and compared with its signals."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import jbf
import numpy as np
import pytest
from equation_models import model_of
from jbf import control, export
from jbf.cli import main
from joint_runs import AXIS, JOINT, joint_runs

BENCH = control.THESIS_BENCH
MAIN = """
#include <stdio.h>
#include "model.h"
int main(void) {
  joint_friction_compensator c;
  joint_friction_loop loop = {0};
  double moved, applied, rate, x[3];
  loop.may_learn = 1;
  joint_friction_compensator_start(&c, (joint_friction_real)LOAD, 0);
  while (scanf("%lf %lf %lf %lf %lf %lf", &moved, &applied, x, x + 1, x + 2, &rate) == 6) {
    loop.velocity = joint_friction_compensator_observe(&c, (joint_friction_real)moved,
                                                       (joint_friction_real)applied, 0);
    loop.position = (joint_friction_real)x[0];
    loop.error = (joint_friction_real)x[1];
    loop.reference = (joint_friction_real)x[2];
    loop.reference_rate = (joint_friction_real)rate;
    printf("%.17g %.17g ", (double)loop.velocity,
           (double)joint_friction_compensator_step(&c, &loop));
    printf("%.17g %.17g %.17g %d\\n", (double)c.friction, (double)c.correction, (double)c.forward,
           joint_friction_compensator_doubts(&c));
  }
  return 0;
}
"""


def run_in_core(model: jbf.Model, position: bool) -> tuple[control.Result, np.ndarray]:
    """Run a loop on the bench with another friction than the model; return the rates too."""
    time_s = BENCH.dt_s * np.arange(1500)
    omega = 2.0 * np.pi
    value, rate = 3.0 * np.sin(omega * time_s), 3.0 * omega * np.cos(omega * time_s)
    truth = jbf.Model(JOINT, "coulomb", parameters={"F_c": 0.9, "F_s": 0.9, "F_v": 0.05})
    task = control.TASKS["position sine" if position else "velocity sine"]
    bench = replace(BENCH, volts_per_n=1.0)
    result = control.run(
        truth, "observed", task, bench=bench, carried=model, reference=(value, rate)
    )
    assert not np.any(result.status)
    return result, rate


def settings_of(model: jbf.Model, position: bool) -> export.Compensator:
    """Settings that `control.run` uses for the loop."""
    bench = replace(BENCH, volts_per_n=1.0)
    a, b = bench.damping_1_s, bench.input_rad_s2_v
    tuned = control.tune(model, bench)
    chosen = export.Compensator(
        damping_1_s=a,
        input_rad_s2_v=b,
        volts_per_force=1.0,
        dt_s=bench.dt_s,
        bandwidth_rad_s=tuned.bandwidth_rad_s,
        slow_rad_s=tuned.slow_rad_s,
        learning_1_s=tuned.learning_1_s,
        level_limit_v=tuned.level_limit_v,
        rest_limit_v=tuned.rest_limit_v,
        breakaway=tuned.breakaway,
    )
    from jbf.control.loop import gains

    first, second = gains(control.TASKS["position sine" if position else "velocity sine"], bench)
    if not position:
        return replace(chosen, law_forward_v_s_rad=second)
    w = tuned.loop_rad_s
    return replace(
        chosen,
        law_forward_v_s_rad=-second,
        approach_1_s=w / 3.0,
        stiffer_v_rad=w**2 / b - first,
        stiffer_v_s_rad=(2.0**0.5 * w - a) / b - second,
    )


def replayed(
    model: jbf.Model, chosen: export.Compensator, inputs: np.ndarray, folder: Path
) -> np.ndarray:
    compiler = shutil.which("cc") or pytest.skip("needs a C compiler")
    settings = export.Settings(compensator=chosen)
    export.to(model, "c", joint_runs(step_s=0.02), settings=settings).save(folder / "model.c")
    (folder / "main.c").write_text(MAIN)
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off"]
    build = [compiler, *strict, "-DLOAD=1.0", "model.c", "main.c", "-lm", "-o", "program"]
    done = subprocess.run(build, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    text = "\n".join(" ".join(map(repr, row)) for row in inputs.tolist())
    out = subprocess.run([folder / "program"], input=text, capture_output=True, text=True)
    return np.array(out.stdout.split(), float).reshape(len(inputs), -1)


SMALL = {"F_c": 0.6, "F_s": 0.8, "F_v": 0.03, "sigma_0": 50.0, "sigma_1": 0.05}


@pytest.mark.parametrize("position", [False, True])
@pytest.mark.parametrize(
    ("law", "effects"),
    [
        ("coulomb", ("dry_asymmetry", "cogging")),
        ("coulomb", ("presliding",)),
        ("stribeck", ("quadratic_drag",)),
        ("lugre", ()),
        ("maxwell_slip", ("coulomb_drag",)),
    ],
)
def test_compensator_in_c_gives_the_signals_of_the_core(
    law: str, effects: tuple[str, ...], position: bool, tmp_path: Path
) -> None:
    model = model_of(law, *effects)
    values = {name: p.value for name, p in model.parameters.items()} | {
        name: value for name, value in SMALL.items() if name in model.parameters
    }
    values |= {"cogging.A": 0.05, "dry_asymmetry.a": 0.1, "quadratic_drag.c": 0.002}
    values |= {"coulomb_drag.F_d": 0.1, "presliding.sigma": 50.0}
    values = {name: value for name, value in values.items() if name in model.parameters}
    model = jbf.Model(JOINT, law, model.effects, values)
    result, rate = run_in_core(model, position)
    angle = result.measured_angle_rad
    speed, slope = (rate, np.zeros(len(rate))) if position else (result.reference, rate)
    inputs = np.stack(
        [
            np.diff(angle, prepend=0.0),
            np.concatenate([[0.0], result.output_v[:-1]]),
            angle,
            result.error,
            speed,
            slope,
        ],
        axis=1,
    )
    signals = replayed(model, settings_of(model, position), inputs, tmp_path)
    expected = (
        result.estimated_velocity_rad_s,
        result.compensation_v,
        result.estimated_friction_v,
        result.correction_v,
        result.forward_v,
    )
    for found, values_of_core in zip(signals.T, expected, strict=False):
        scale = np.max(np.abs(values_of_core))
        assert np.max(np.abs(found - values_of_core)) < 1e-9 * scale
    assert not np.any(signals[:, 5])
    assert np.max(np.abs(result.learned_0)) > 0.01  # the level was corrected


def test_settings_out_of_range_are_refused() -> None:
    good = {"damping_1_s": 1.0, "input_rad_s2_v": 1.0, "volts_per_force": 1.0, "dt_s": 0.001}
    good |= {"bandwidth_rad_s": 60.0, "slow_rad_s": 0.05}
    export.Compensator(**good)
    for wrong in ({"dt_s": 0.0}, {"level_limit_v": -1.0}, {"learning_1_s": 1e3}):
        with pytest.raises(jbf.InputError):
            export.Compensator(**{**good, **wrong})


@pytest.mark.parametrize(
    "model", [jbf.Model(AXIS, "coulomb"), model_of("coulomb", "backlash")], ids=["axis", "backlash"]
)
def test_compensator_of_a_linear_axis_or_a_loose_drive_is_refused(model: jbf.Model) -> None:
    settings = export.Settings(compensator=export.Compensator(1.0, 1.0, 1.0, 0.001, 60.0, 0.05))
    with pytest.raises(jbf.InputError, match=r"observer|rotary"):
        export.to(model, "c", joint_runs(model.rig), settings=settings)


def test_settings_are_read_from_a_file_and_wrong_keys_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "compensator.toml"
    lines = ["damping_1_s = 1.0", "input_rad_s2_v = 2.0", "volts_per_force = 3.0", "dt_s = 0.001"]
    lines += ["bandwidth_rad_s = 60.0", "slow_rad_s = 0.05"]
    file.write_text("\n".join(lines))
    assert export.Compensator.load(file) == export.Compensator(1.0, 2.0, 3.0, 0.001, 60.0, 0.05)
    for wrong in (lines[1:], [*lines, "bandwith = 1.0"], [*lines[:-1], "slow_rad_s = 0.0"]):
        file.write_text("\n".join(wrong))
        with pytest.raises(jbf.InputError, match=r"compensator\.toml"):
            export.Compensator.load(file)


def test_command_writes_the_compensator_for_c_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lines = ["damping_1_s = 1.0", "input_rad_s2_v = 2.0", "volts_per_force = 3.0", "dt_s = 0.001"]
    lines += ["bandwidth_rad_s = 60.0", "slow_rad_s = 0.05"]
    Path("settings.toml").write_text("\n".join(lines))
    model = model_of("coulomb")
    model.save("model.toml")
    (run, _) = joint_runs(step_s=0.02)
    columns = zip(run.time_s, run.velocity, model.predict(run), strict=True)
    rows = [",".join(map(repr, map(float, row))) for row in columns]
    Path("run.csv").write_text("\n".join(["time_s,velocity_rad_s,torque_n_m", *rows]))
    arguments = ["export", "model.toml", "run.csv", "--compensator", "settings.toml"]
    assert main([*arguments, "--to", "c", "--out", "joint.c"]) == 0
    assert "joint_friction_compensator_step" in Path("joint.h").read_text()
    assert main([*arguments, "--to", "st", "--out", "joint.st"]) != 0
