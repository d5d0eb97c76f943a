"""Diagnose one half of a real recording, predict the other half, and compare with fits by hand.

    .venv/bin/python benches/real_halves.py FOLDER [--law auto]

FOLDER holds `leadscrew/drive1.csv` and `drive2.csv` (time_ms, speed_rpm, torque_pct: the torque of
a drive, %), `seal/NAP310_1bar.csv` and so on, `tribometer/run.csv`, `emps/run.csv`,
`hydraulic_cylinder/valve1V.csv` and so on, and joints and motors (`ur10e_joints/joint1.csv`,
`openarm_joints`, `direct_drive_arm/joint1_speeds.csv`, `servo_pendulum/xl330.csv`,
`motor_dyno/m1_*.csv`), with the columns time_s, velocity_m_s (rad/s of a joint), friction_n (N m)
and position_m or angle_rad. Every other run, stroke pair or cycle is fitted, or the first half.

By hand: inertia, offset and, with an angle, gravity, with each law of `HAND_LAWS` and each set of
`HAND_EFFECTS`, are fitted to the same half. The model with the smallest error on the other half is
reported, although a user who has only the first half could not select it. The recordings are not
distributed: without them a message is printed and nothing is done.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import jbf
import numpy as np
import numpy.typing as npt
from jbf.errors import Unfinished

Array = npt.NDArray[np.float64]
Halves = tuple[list[jbf.Run], list[jbf.Run]]
SLOW = 0.05
"""Speed relative to the top speed below which the direction of a stroke is unknown."""
LEAST = 15
"""Smallest number of samples of a run."""
HAND_LAWS = ("coulomb", "stribeck")
HAND_EFFECTS = (
    (),
    ("presliding",),
    ("direction_asymmetry",),
    ("viscous_thinning",),
    ("torque_proportional",),
    ("stroke_dependence",),
    ("dry_load_dependence", "zero_load_dependence"),
)
"""Effects that the fits by hand try in addition to the machine, if the recording shows them."""


def columns(path: Path) -> dict[str, Array]:
    """Read the columns of a CSV file by name."""
    names = path.read_text(encoding="utf-8").split("\n", 1)[0].strip().split(",")
    values = np.loadtxt(path, delimiter=",", skiprows=1)
    return dict(zip(names, values.T, strict=True))


def drive(path: Path) -> Halves:
    """Split each sweep of a drive in a recording into its first and its second half."""
    c = columns(path)
    t, v, f = c["time_ms"] / 1e3, c["speed_rpm"] * 2.0 * np.pi / 60.0, c["torque_pct"]
    fitted, held_out = [], []
    for i, at in enumerate(np.split(np.arange(len(t)), np.flatnonzero(np.diff(t) < 0.0) + 1)):
        for half, into in ((at[: len(at) // 2], fitted), (at[len(at) // 2 :], held_out)):
            into.append(jbf.Run.from_arrays(t[half], v[half], f[half], name=f"sweep {i}"))
    return fitted, held_out


def part(c: dict[str, Array], at: npt.NDArray[np.intp], name: str) -> jbf.Run:
    """Return the samples `at` of the columns `c` as a run; a pressure in kPa replaces the load."""
    t, v, f = (c[k][at] for k in ("time_s", "velocity_m_s", "friction_n"))
    others = {k: c[k][at] for k in ("position_m", "angle_rad") if k in c}
    if "pressure_pa" in c:
        others["load_n"] = c["pressure_pa"][at] / 1e3
    return jbf.Run.from_arrays(t - t[0], v, f, **others, name=name)


def strokes(path: Path) -> Halves:
    """Assign the pairs of strokes of a recording alternately to two halves."""
    c = columns(path)
    v = c["velocity_m_s"]
    sign = np.sign(np.where(np.abs(v) > SLOW * np.max(np.abs(v)), v, 0.0))
    known = np.flatnonzero(sign)
    turns = np.flatnonzero(sign[known[1:]] != sign[known[:-1]])
    cuts = set(((known[turns] + known[turns + 1]) // 2).tolist())
    cuts |= set((np.flatnonzero(np.diff(c["time_s"]) > 1.0) + 1).tolist())
    parts = [p for p in np.split(np.arange(len(v)), sorted(cuts)) if len(p) > 50]
    pairs = [np.concatenate(parts[i : i + 2]) for i in range(0, len(parts) - 1, 2)]
    runs = [part(c, p, f"pair {i}") for i, p in enumerate(pairs)]
    return runs[0::2], runs[1::2]


def all_strokes(folder: Path) -> Halves:
    """Assign the stroke pairs of the recordings at all pressures to two halves, as in `strokes`."""
    fitted, held_out = [], []
    for path in sorted(folder.glob("NAP310_*bar.csv")):
        for some, into in zip(strokes(path), (fitted, held_out), strict=True):
            into += [replace(run, name=f"{path.stem} {run.name}") for run in some]
    return fitted, held_out


def cycles(path: Path) -> Halves:
    """Assign the cycles of a reciprocating slide alternately to two halves.

    A cycle begins where the slide enters the upper fifth of its stroke. The contact is fully
    deflected there, at the beginning and at the end of each run.
    """
    c = columns(path)
    place = c["position_m"]
    upper = np.min(place) + 0.8 * np.ptp(place)
    cuts = np.flatnonzero((place[1:] >= upper) & (place[:-1] < upper)) + 1
    parts = [p for p in np.split(np.arange(len(place)), cuts) if len(p) > 50]
    runs = [part(c, p, f"cycle {i}") for i, p in enumerate(parts)]
    return runs[0::2], runs[1::2]


def steady(folder: Path) -> Halves:
    """Assign the pairs of steady strokes of a cylinder alternately to two halves.

    There is one run per valve voltage.

    The ends of the travel are excluded, where the force of the end stop is measured.
    """
    fitted: list[jbf.Run] = []
    held_out: list[jbf.Run] = []
    for path in sorted(folder.glob("valve*V.csv")):
        c = columns(path)
        place, v = c["position_m"], c["velocity_m_s"]
        at = np.flatnonzero((np.abs(v) > 0.01) & (place > 0.01) & (place < 0.19))
        cuts = (np.diff(at) > 1) | (np.diff(np.sign(v[at])) != 0.0)
        parts = [p for p in np.split(at, np.flatnonzero(cuts) + 1) if len(p) > 50]
        for into, which in ((fitted, (0, 1)), (held_out, (2, 3))):
            chosen = np.concatenate([p for i, p in enumerate(parts) if i % 4 in which])
            into.append(part(c, chosen, path.stem))
    return fitted, held_out


def halved(path: Path) -> Halves:
    """Split a recording into its first and its second half."""
    c = columns(path)
    at = np.arange(len(c["time_s"]))
    return [part(c, at[: len(at) // 2], "first")], [part(c, at[len(at) // 2 :], "second")]


def runs_of(path: Path) -> Halves:
    """Assign the runs numbered in the column `run` of a file alternately to two halves.

    If a column `powered` exists, only samples with power are used.
    """
    c = columns(path)
    on = c.get("powered", np.ones(len(c["time_s"]))) == 1.0
    parts = [np.flatnonzero((c["run"] == k) & on) for k in np.unique(c["run"])]
    runs = [part(c, at, f"run {i}") for i, at in enumerate(parts) if len(at) >= LEAST]
    return runs[0::2], runs[1::2]


def files(pattern: Path) -> Halves:
    """Assign the files that match a pattern alternately to two halves, without the first second."""
    runs = []
    for path in sorted(pattern.parent.glob(pattern.name)):
        c = columns(path)
        runs.append(part(c, np.flatnonzero(c["time_s"] > c["time_s"][0] + 1.0), path.stem))
    return runs[0::2], runs[1::2]


@dataclass(frozen=True)
class Task:
    """Recording with the function that splits it, the kind of its motion and its base law."""

    title: str
    path: Path
    cut: Callable[[Path], Halves]
    motion: str
    law: str


def plan(folder: Path, law: str) -> Iterator[Task]:
    """Generate the tasks for all recordings."""
    for k in (1, 2):
        yield Task(f"leadscrew/drive{k}", folder / f"leadscrew/drive{k}.csv", drive, "rotary", law)
    for bar in (1, 3, 5, 7):
        path = folder / f"seal/NAP310_{bar}bar.csv"
        yield Task(f"seal/{bar}bar", path, strokes, "linear", law)
    yield Task("seal/all", folder / "seal", all_strokes, "linear", law)
    yield Task("tribometer", folder / "tribometer/run.csv", cycles, "linear", law)
    yield Task("emps", folder / "emps/run.csv", halved, "linear", law)
    yield Task("hydraulic_cylinder", folder / "hydraulic_cylinder", steady, "linear", law)
    for arm, joints in (("ur10e_joints", (1, 2, 3, 4, 5)), ("openarm_joints", (3, 5, 6, 7))):
        for k in joints:
            path = folder / f"{arm}/joint{k}.csv"
            yield Task(f"{arm}/{k}", path, halved, "rotary", law)
    path = folder / "direct_drive_arm/joint1_speeds.csv"
    yield Task("direct_drive_arm/1", path, runs_of, "rotary", law)
    yield Task("servo_pendulum", folder / "servo_pendulum/xl330.csv", runs_of, "rotary", law)
    yield Task("motor_dyno/1", folder / "motor_dyno/m1_*.csv", files, "rotary", law)


def by_hand(rig: jbf.Rig, fitted: list[jbf.Run], held_out: list[jbf.Run]) -> tuple[float, str]:
    """Return the smallest held-out error among the fits by hand, and its model as text."""
    machine = ["sensor_offset", "inertia"]
    if all(run.angle_rad is not None for run in fitted):
        machine.append("gravity")
    errors: dict[str, float] = {}
    for law in HAND_LAWS:
        for effects in HAND_EFFECTS:
            if "dry_load_dependence" in effects and fitted[0].load_n is None:
                continue
            try:
                model = jbf.fit(rig, fitted, [*machine, *effects], law=law).model
                errors[" + ".join([law, *effects])] = jbf.compare(model, held_out).rms
            except (jbf.InputError, Unfinished):
                continue
    best = min(errors, key=lambda name: errors[name])
    return errors[best], best


def row(task: Task) -> str:
    """Diagnose one half of a recording and return its row of the table."""
    quantity = "force" if task.motion == "linear" else "torque"
    rig = jbf.Rig(drive=jbf.Drive(task.motion, quantity))
    fitted, held_out = (
        [replace(run, quantities=rig.quantities) for run in half] for half in task.cut(task.path)
    )
    begun = time.process_time()
    try:
        diagnosis = jbf.diagnose(rig, fitted, law=task.law)
    except Unfinished as error:
        return f"| {task.title} | no answer: {error} |"
    took = time.process_time() - begun
    rms = jbf.compare(diagnosis.model, held_out).rms
    hand, model = by_hand(rig, fitted, held_out)
    names = ", ".join(diagnosis.effects) or "-"
    return (
        f"| {task.title} | {diagnosis.model.law} | {rms:.3g} | {hand:.3g} ({model}) | "
        f"{rms / hand:.3f} | {diagnosis.verdict} | "
        f"{', '.join(diagnosis.machine) or '-'} | {names} | {took:.0f} |"
    )


def main() -> int:
    """Print one row for each available recording."""
    parser = argparse.ArgumentParser(prog="real_halves", description=__doc__.split("\n", 1)[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--law", default="auto", help="base law (default auto)")
    parser.add_argument("--only", default="", help="recordings whose name contains this")
    parser.add_argument("--jobs", type=int, default=1, help="processes (default 1)")
    options = parser.parse_args()
    if options.folder is None:
        print("skipped: name the folder of the recordings: python benches/real_halves.py FOLDER")
        return 0
    print(
        "| recording | law | held-out RMS | by hand | ratio | verdict | machine | named | CPU s |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    tasks = []
    for task in plan(options.folder, options.law):
        if options.only not in task.title:
            continue
        if not list(task.path.parent.glob(task.path.name)):
            print(f"skipped: there is no {task.path}")
            continue
        tasks.append(task)
    with ProcessPoolExecutor(options.jobs) as pool:
        for line in pool.map(row, tasks):
            print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
