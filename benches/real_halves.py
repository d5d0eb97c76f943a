"""What a diagnosis of one half of a real recording predicts of the other half:
`python benches/real_halves.py FOLDER [--law stribeck]`.

FOLDER holds `leadscrew/drive1.csv` and `drive2.csv` (time_ms, speed_rpm, torque_pct; the torque of
a drive in % stands for the force), `seal/NAP310_1bar.csv` and so on, and `emps/run.csv` (time_s,
position_m, velocity_m_s, friction_n). Drives are cut into their sweeps, each of which is halved; of
the seal every other pair of strokes is fitted, one pressure at a time and all of them; of a
tribometer (`tribometer/run.csv`, for laws that bend: --law maxwell_slip) every other cycle; EMPS
and the joints of a robot (`ur10e_joints/joint1.csv`, on a radius of 1 m: N are N m) are halved. The
recordings are not ours to ship: without them this says so and does nothing.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import jbf
import numpy as np
import numpy.typing as npt
from jbf.estimation.campaign import Campaign

Array = npt.NDArray[np.float64]
Halves = tuple[list[jbf.Run], list[jbf.Run]]
SLOW = 0.05
"""Share of the top speed below which a stroke's direction is not told."""


def columns(path: Path) -> dict[str, Array]:
    """The columns of a CSV file by name."""
    names = path.read_text(encoding="utf-8").split("\n", 1)[0].strip().split(",")
    values = np.loadtxt(path, delimiter=",", skiprows=1)
    return dict(zip(names, values.T, strict=True))


def drive(path: Path) -> Halves:
    """The first and the second halves of a drive's sweeps."""
    c = columns(path)
    t, v, f = c["time_ms"] / 1e3, c["speed_rpm"] * 2.0 * np.pi / 60.0, c["torque_pct"]
    fitted, left = [], []
    for i, at in enumerate(np.split(np.arange(len(t)), np.flatnonzero(np.diff(t) < 0.0) + 1)):
        for half, into in ((at[: len(at) // 2], fitted), (at[len(at) // 2 :], left)):
            into.append(jbf.Run.from_arrays(t[half], v[half], f[half], name=f"sweep {i}"))
    return fitted, left


def part(c: dict[str, Array], at: npt.NDArray[np.intp], name: str) -> jbf.Run:
    """Some samples of a recording."""
    t, v, f = (c[k][at] for k in ("time_s", "velocity_m_s", "friction_n"))
    others = {k: c[k][at] for k in ("position_m", "angle_rad") if k in c}
    pressure = {k: c[k][at] for k in ("pressure_pa",) if k in c}
    return jbf.Run.from_arrays(t, v, f, **others, extra=pressure, name=name)


def strokes(path: Path) -> Halves:
    """Every other pair of strokes, and the others."""
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


def all_strokes(paths: list[Path]) -> Halves:
    """The same of several pressures at once."""
    fitted, left = [], []
    for path in paths:
        for some, into in zip(strokes(path), (fitted, left), strict=True):
            into += [replace(run, name=f"{path.stem} {run.name}") for run in some]
    return fitted, left


def cycles(path: Path) -> Halves:
    """Every other cycle of a slide to and fro, and the others.

    They are cut where the slide enters the upper fifth of its stroke: there it slides, and a
    contact that bends begins a run as it ended the last one.
    """
    c = columns(path)
    place = c["position_m"]
    upper = np.min(place) + 0.8 * np.ptp(place)
    cuts = np.flatnonzero((place[1:] >= upper) & (place[:-1] < upper)) + 1
    parts = [p for p in np.split(np.arange(len(place)), cuts) if len(p) > 50]
    runs = [part(c, p, f"cycle {i}") for i, p in enumerate(parts)]
    return runs[0::2], runs[1::2]


def steady(folder: Path) -> Halves:
    """Every other pair of steady strokes of a cylinder, a run for each valve voltage, and the
    others: away from the ends of its way, where what is measured is the force of the stop."""
    fitted: list[jbf.Run] = []
    left: list[jbf.Run] = []
    for path in sorted(folder.glob("valve*V.csv")):
        c = columns(path)
        place, v = c["position_m"], c["velocity_m_s"]
        at = np.flatnonzero((np.abs(v) > 0.01) & (place > 0.01) & (place < 0.19))
        cuts = (np.diff(at) > 1) | (np.diff(np.sign(v[at])) != 0.0)
        parts = [p for p in np.split(at, np.flatnonzero(cuts) + 1) if len(p) > 50]
        for into, which in ((fitted, (0, 1)), (left, (2, 3))):
            chosen = np.concatenate([p for i, p in enumerate(parts) if i % 4 in which])
            into.append(part(c, chosen, path.stem))
    return fitted, left


def halved(path: Path) -> Halves:
    """The first half, and the second."""
    c = columns(path)
    at = np.arange(len(c["time_s"]))
    return [part(c, at[: len(at) // 2], "first")], [part(c, at[len(at) // 2 :], "second")]


def row(title: str, halves: Halves, law: str, whole: bool = False) -> None:
    """Print what is found in one half, and the RMS in the other; or in all, and of all."""
    fitted, left = halves
    if whole:
        fitted = left = [*fitted, *left]
    begun = time.process_time()
    found = jbf.diagnose(jbf.Rig(), fitted, law=law)
    took = time.process_time() - begun
    campaign = Campaign.prepare(jbf.Rig(), left)
    errors = [p.friction_n - found.model.predict(p.run) for p in campaign.prepared]
    names = ", ".join(found.effects) or "-"
    kinds = ", ".join(sorted({f.kind for f in found.findings})) or "-"
    rms = campaign.samples.rms(errors)
    law = law if law == found.model.law else f"{law}: {found.model.law}"
    print(f"| {title} | {law} | {rms:.3g} | {found.verdict} | {names} | {kinds} | {took:.0f} |")
    sys.stdout.flush()


def main() -> int:
    """Do it for every recording that is there."""
    parser = argparse.ArgumentParser(prog="real_halves", description=__doc__.split("\n", 1)[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--law", default="stribeck", help="base law; stribeck")
    parser.add_argument("--only", default="", help="recordings whose path holds this")
    parser.add_argument(
        "--whole", action="store_true", help="fit all and judge by all, as most fits by hand do"
    )
    asked = parser.parse_args()
    if asked.folder is None:
        print("skipped: name the folder of the recordings: python benches/real_halves.py FOLDER")
        return 0
    plan = [(f"leadscrew/drive{k}.csv", drive) for k in (1, 2)]
    plan += [(f"seal/NAP310_{bar}bar.csv", strokes) for bar in (1, 3, 5, 7)]
    plan += [("emps/run.csv", halved)]
    plan += [(f"ur10e_joints/joint{k}.csv", halved) for k in (1, 2, 3, 4, 5)]
    plan += [("tribometer/run.csv", cycles)]
    plan += [(f"openarm_joints/joint{k}.csv", halved) for k in (3, 5, 6, 7)]
    plan += [("hydraulic_cylinder", steady)]
    of = "" if asked.whole else "left-out "
    print(f"| recording | law | {of}RMS, N (drives: %) | verdict | named | findings | CPU s |")
    print("|---|---|---|---|---|---|---|")
    for name, cut in plan:
        path = asked.folder / name
        if asked.only not in name:
            continue
        if not path.exists():
            print(f"skipped: there is no {path}")
            continue
        row(name, cut(path), asked.law, asked.whole)
    seals = [asked.folder / f"seal/NAP310_{bar}bar.csv" for bar in (1, 3, 5, 7)]
    if asked.only in "seal/all" and all(path.is_file() for path in seals):
        row("seal/all", all_strokes(seals), asked.law, asked.whole)
    return 0


if __name__ == "__main__":
    sys.exit(main())
