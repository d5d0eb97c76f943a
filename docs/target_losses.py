"""Write the table of measured losses, docs/reference/target_losses.md.

Run it as `.venv/bin/python docs/target_losses.py`, with a C compiler, and with mujoco, rumoca and
blark installed. Every law is exported to every target. An independent run of each exported form,
which reads the written file, is compared with `jbf predict` and with the loss that the ledger
states.
"""

from __future__ import annotations

import csv
import io
import subprocess
import sys
import tempfile
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import jbf
import numpy as np
import numpy.typing as npt
from jbf.export import Exported, to
from jbf.export.reference import Reference
from jbf.models.catalogue import built_in_laws

Array = npt.NDArray[np.float64]
PAGE = Path(__file__).resolve().parent / "reference" / "target_losses.md"
TESTS = Path(__file__).resolve().parents[1] / "python" / "tests"
STEP_S = 0.005
JOINT = jbf.Rig(drive=jbf.Drive("rotary", "torque"))
VALUES = {
    "F_c": 5.0, "F_s": 8.0, "F_s_inf": 3.0, "F_0": 5.0, "v_s": 0.1, "F_v": 2.0,
    "sigma_0": 2e3, "k_t": 2e3, "sigma_1": 3.0, "v_d": 0.3,
}  # fmt: skip
HEAD = """# Measured losses of the export targets

This page lists the error of each law in each target of `jbf export --to`, for users who choose a
target. Each law has typical values (F_c 5 N m, F_s 8 N m, Stribeck velocity 0.1 rad/s, F_v
2 N m s/rad, stiffness 2000 N m/rad) and moves along 4 s of a modulated sine with a speed amplitude
of 0.8 rad/s, sampled at 5 ms. The figures are the RMS error relative to the exact law, as a share
of the RMS friction. Samples at rest or with an unknown direction of sliding are excluded; those
after a reversal, where a bristle deflects, are included. In each cell the first figure is the loss
that the ledger of the export states, and the second is measured by an independent run of the
written file. A dash marks a law that the target refuses ([all laws and effects](targets.md)). The
time step of MuJoCo is 0.5 ms for the stated and 0.25 ms for the measured error. `fmu2` and `fmu3`
have the losses of `c`, whose code they contain.

*(Written by `docs/target_losses.py`.)*

"""


def run_of(step_s: float = STEP_S) -> jbf.Run:
    """Return the motion of the table."""
    time_s = step_s * np.arange(round(4.0 / step_s))
    velocity = 0.8 * np.sin(1.3 * time_s) * (1.0 + 0.2 * np.sin(0.31 * time_s))
    path = np.concatenate([[0.0], np.cumsum(0.5 * step_s * (velocity[1:] + velocity[:-1]))])
    return jbf.Run.from_arrays(time_s, velocity, angle_rad=path)


def model_of(law: str) -> jbf.Model:
    """Return a model of a law with the values of the table."""
    names = [p.name for p in built_in_laws()[law].parameters]
    return jbf.Model(JOINT, law, parameters={n: v for n, v in VALUES.items() if n in names})


def _table(exported: Exported, run: jbf.Run) -> Array:
    _, *rows = csv.reader(io.StringIO(exported.text))
    speed, friction = np.array(rows, float).T[:2]
    return np.asarray(np.interp(run.velocity, speed, friction))


def _level_and_damping(level: float, damping: float, run: jbf.Run) -> Array:
    return level * np.sign(run.velocity) + damping * run.velocity


def _urdf(exported: Exported, run: jbf.Run) -> Array:
    (dynamics,) = ET.fromstring(exported.text).iter("dynamics")
    return _level_and_damping(
        float(dynamics.get("friction", "nan")), float(dynamics.get("damping", "nan")), run
    )


def _sdf(exported: Exported, run: jbf.Run) -> Array:
    (dynamics,) = ET.fromstring(exported.text).iter("dynamics")
    return _level_and_damping(
        float(dynamics.findtext("friction", "nan")), float(dynamics.findtext("damping", "nan")), run
    )


def _isaac(exported: Exported, run: jbf.Run) -> Array:
    class Fields(dict):  # type: ignore[type-arg]
        pass

    names: dict[str, object] = {"ImplicitActuatorCfg": Fields}
    exec(exported.text.replace("from isaaclab.actuators import ImplicitActuatorCfg", ""), names)
    (fields,) = (value for value in names.values() if isinstance(value, Fields))
    return _level_and_damping(fields["dynamic_friction"], fields["viscous_friction"], run)


MAIN = """
#include <stdio.h>
#include "model.h"
int main(void) {
  joint_friction_motion m = {0};
  joint_friction_state s;
  int first = 1;
  while (scanf("%lf %lf %lf", &m.time_s, &m.velocity, &m.position) == 3) {
    printf("%.17g\\n", first ? joint_friction_start(&s, &m) : joint_friction_step(&s, &m));
    first = 0;
  }
  return 0;
}
"""


def _c(exported: Exported, run: jbf.Run) -> Array:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        exported.save(folder / "model.c")
        (folder / "main.c").write_text(MAIN)
        build = ["cc", "-std=c99", "-ffp-contract=off", "model.c", "main.c", "-lm", "-o", "run"]
        subprocess.run(build, cwd=folder, check=True)
        rows = zip(run.time_s, run.velocity, run.angle_rad, strict=True)  # type: ignore[arg-type]
        text = "\n".join(" ".join(repr(float(x)) for x in row) for row in rows)
        out = subprocess.run([folder / "run"], input=text, capture_output=True, text=True)
    return np.array(out.stdout.split(), float)


def _st(exported: Exported, run: jbf.Run) -> Array:
    sys.path.append(str(TESTS))
    import structured_text

    scope = structured_text.load(exported.text)
    block = scope["joint_friction"]()
    force = []
    for dt_s, velocity in zip(np.diff(run.time_s, prepend=0.0), run.velocity, strict=True):
        block.dt_s, block.velocity = float(dt_s), float(velocity)
        scope["run"](block)
        force.append(block.force)
    return np.array(force)


def _modelica(exported: Exported, run: jbf.Run) -> Array:
    """Run Rumoca along the motion as an equation, with another tolerance of the solver."""
    import rumoca

    course = """
model Course
  JointFriction.Friction friction;
equation
  friction.velocity = 0.8 * sin(1.3 * time) * (1.0 + 0.2 * sin(0.31 * time));
end Course;
"""
    model = rumoca.Session().loads(exported.text + course, model="Course")
    end_s = float(run.time_s[-1])
    config = rumoca.SimConfig(solver="bdf", rtol=1e-6, atol=1e-6)
    result = model.simulate(t=(0.0, end_s), dt=STEP_S, config=config)
    return np.asarray(np.interp(run.time_s, result.time, result["friction.force"]))


def _mjcf(exported: Exported, run: jbf.Run) -> Array:
    """Run MuJoCo along the imposed motion, with a time step of 0.25 ms."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(exported.files["_test.xml"])
    model.opt.timestep = 0.00025
    data = mujoco.MjData(model)
    time_s = np.arange(0.0, run.time_s[-1], model.opt.timestep)
    speeds = np.interp(time_s, run.time_s, run.velocity)
    places = np.interp(time_s, run.time_s, run.angle_rad)  # type: ignore[arg-type]
    force = np.empty(len(time_s))
    for k, (place, speed) in enumerate(zip(places, speeds, strict=True)):
        data.qpos[0], data.qvel[0] = place, speed
        mujoco.mj_forward(model, data)
        driven = data.qfrc_actuator[0]
        data.qacc[0] = 0.0
        mujoco.mj_inverse(model, data)
        force[k] = data.qfrc_inverse[0] - driven
        mujoco.mj_step(model, data)
    return np.asarray(np.interp(run.time_s, time_s, force))


MEASURED: dict[str, Callable[[Exported, jbf.Run], Array]] = {
    "table": _table,
    "c": _c,
    "st": _st,
    "modelica": _modelica,
    "mjcf": _mjcf,
    "urdf": _urdf,
    "sdf": _sdf,
    "isaac": _isaac,
}
"""Independent runs of the exported forms. FMUs contain the file of `c`; test_fmu.py runs them."""


def losses(law: str, target: str) -> tuple[float, float, str] | None:
    """Stated loss, measured loss, and the status of a law in a target; None if it is refused."""
    model, run = model_of(law), run_of()
    try:
        exported = to(model, target, [run])
    except jbf.InputError:
        return None
    reference = Reference.of(model, [run])
    measured = reference.rms_error([MEASURED[target](exported, run)]) / reference.friction_rms
    return exported.ledger.share, measured, exported.ledger.term(law).status


def percent(share: float) -> str:
    """Text of a share; below 0.001 % it depends on compiler and solver."""
    return "< 0.001" if share < 1e-5 else f"{100.0 * share:.3g}"


def page() -> str:
    """Return the text of the page."""
    lines = [f"| law | {' | '.join(MEASURED)} |", "| --- |" + " --- |" * len(MEASURED)]
    for law, entry in built_in_laws().items():
        if entry.needs_bearing:
            continue
        cells = []
        for target in MEASURED:
            found = losses(law, target)
            cells.append("–" if found is None else f"{percent(found[0])}, {percent(found[1])}")
        lines.append(f"| [{law}](../laws.md#{law}) | {' | '.join(cells)} |")
    return HEAD + "Stated and measured loss, %:\n\n" + "\n".join([*lines, ""])


if __name__ == "__main__":
    missing = [name for name in ("mujoco", "rumoca", "blark") if find_spec(name) is None]
    if missing:
        print(f"{PAGE.name} stays as it is: pip install {' '.join(missing)}")
        sys.exit(0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        PAGE.write_text(page(), encoding="utf-8")
