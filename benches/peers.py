"""Compare the speed of jbf with that of the best peers: `python benches/peers.py FOLDER`.

FOLDER contains the peers: C kernels (`c/kern.h`, `c/peers.c`, `c/Makefile`) for T1, numbalsoda
(`solvers.py`, `common.py`) for T2 and T3, `t4.py` for T4. They are not distributed with jbf.
Without FOLDER, a compiler or a package, the task is skipped with a message. The folder is copied to
`target/peers` and built there.

Peers and jbf take turns, so that the load of the machine affects both: compare ratios, not times.
Before a timed turn, the machine rests and the row runs untimed for a short period. OpenMP's threads
(the peers') keep a core busy for some milliseconds after their work, waiting for more, which would
count as the next row's time; and any sleeping thread wakes late. `--no-rest` omits the rest.
"""

from __future__ import annotations

import argparse
import ctypes
import importlib
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import ModuleType

import jbf
import numpy as np
from peers_t4 import fit_task

HERE = Path(__file__).resolve().parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", HERE.parent / "target"))
TASKS = ["T1", "batch", "T2", "T3", "T4"]
RIG = jbf.Rig.thesis()
TABLE = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
STEPS, DT_S, SETS = 50_000, 0.002, 1024
SPEED = 0.127 * np.sin(0.25 * DT_S * np.arange(STEPS))

REST_S = 0.05
WARM_S = 0.05

Timed = dict[str, Callable[[], float]]


def table(title: str, unit: str, peer: str, rounds: int, rows: Timed) -> None:
    """Time `rows` in turn, and print each with its ratio to the row `peer`."""
    times: dict[str, list[float]] = {name: [] for name in rows}
    for _ in range(rounds):
        for name, run in rows.items():
            if REST_S > 0.0:
                time.sleep(REST_S)
                warm = time.perf_counter() + WARM_S
                while time.perf_counter() < warm:
                    run()
            times[name].append(run())
    middle = {name: float(np.median(t)) for name, t in times.items()}
    print(f"\n{title}\n\n| | median, {unit} | least | {peer} / this, median | least |")
    print("|---|---|---|---|---|")
    for name, t in times.items():
        ratio, least = middle[peer] / middle[name], min(times[peer]) / min(t)
        print(f"| {name} | {middle[name]:.3g} | {min(t):.3g} | {ratio:.2f} | {least:.2f} |")


def clock(work: Callable[[], object], per: float) -> Callable[[], float]:
    """Return a function that runs `work` and returns its time (s) multiplied by `per`."""

    def timed() -> float:
        begin = time.perf_counter()
        work()
        return (time.perf_counter() - begin) * per

    return timed


def skip(task: str, reason: str) -> None:
    print(f"\n{task}: skipped, {reason}")


def library(folder: Path, name: str) -> ctypes.CDLL:
    return ctypes.CDLL(str(folder / "c" / name))


def pointer(array: np.ndarray | None) -> ctypes.c_void_p:
    return ctypes.c_void_p(None if array is None else array.ctypes.data)


def peer_sets(sets: dict[str, np.ndarray]) -> np.ndarray:
    """Return the parameter table of the peers: one row per quantity, one column per set."""
    bearing, lubricant, load = RIG.bearing, RIG.lubricant, RIG.load
    assert bearing is not None
    assert lubricant is not None
    assert load is not None
    group = bearing.clearance_m**2 / (lubricant.viscosity_pa_s * bearing.length_m**3)
    load_number = group * load.normal_n / sets["U_tr_m_s"]
    eps_tr = np.array([jbf._core.transition_eccentricity(f) for f in load_number])
    ratio = bearing.radius_m * bearing.clearance_m / bearing.length_m**2
    rows = [load_number, eps_tr, sets["K0"], sets["f_m"], sets["gamma"]]
    rows += [np.full(len(eps_tr), ratio), sets["U_tr_m_s"], sets["U_tr_m_s"] / bearing.radius_m]
    return np.ascontiguousarray(rows)


def single(folder: Path, rounds: int) -> None:
    """Time T1, successive steps of one parameter set, in Rust and in C."""
    build = ["cargo", "build", "--release", "--quiet", "-p", "jbf-benches", "--bin", "t1"]
    subprocess.run(build, check=True, cwd=HERE.parent)
    ours = subprocess.Popen(
        [TARGET / "release" / "t1"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )

    def measure(task: str) -> float:
        assert ours.stdin is not None
        assert ours.stdout is not None
        ours.stdin.write(task + "\n")
        ours.stdin.flush()
        return float(ours.stdout.readline().split()[0])

    one = peer_sets({name: np.array([value]) for name, value in TABLE.items()})
    halves = 0.127 * np.sin(0.25 * 0.5 * DT_S * np.arange(2 * STEPS + 1))
    kinds = {"f64": (np.float64, ctypes.c_double, "d"), "f32": (np.float32, ctypes.c_float, "f")}

    def theirs(file: str, method: str, kind: str) -> Callable[[], float]:
        dtype, real, suffix = kinds[kind]
        speed = np.ascontiguousarray(halves if method == "rk4" else halves[: 2 * STEPS : 2], dtype)
        out = np.empty(STEPS, dtype)
        kernel = getattr(library(folder, file), f"{method}_{suffix}")
        dt = real(DT_S)
        return clock(
            lambda: kernel(pointer(one), STEPS, dt, pointer(speed), pointer(out)), 1e9 / STEPS
        )

    for method in ("euler", "rk4"):
        for kind in ("f64", "f32"):
            rows: Timed = {
                "C": theirs("libpeers.so", method, kind),
                "C, -ffast-math": theirs("libpeers_fast.so", method, kind),
                "jbf": lambda task=f"{method} {kind}": measure(task),
            }
            table(f"T1, one step, {method}, {kind}", "ns/step", "C", 5 * rounds, rows)
    assert ours.stdin is not None
    ours.stdin.close()
    ours.wait()


def batch(folder: Path, rounds: int) -> None:
    """Time T1 with many parameter sets, by `jbf.batch` and by C with OpenMP and SIMD."""
    random = np.random.default_rng(1)
    sets = {name: value * random.uniform(0.8, 1.2, SETS) for name, value in TABLE.items()}
    numbers, kernels = peer_sets(sets), library(folder, "libpeers_simd.so")
    kernels.omp_set_num_threads(os.cpu_count())
    per = 1e9 / (STEPS * SETS)
    for kind, dtype, real, suffix in (
        ("f64", np.float64, ctypes.c_double, "d"),
        ("f32", np.float32, ctypes.c_float, "f"),
    ):
        speed, out = SPEED.astype(dtype), np.zeros((STEPS, SETS), dtype)
        sums, kernel = np.zeros(SETS), getattr(kernels, f"batch_{suffix}")

        def theirs(store: bool, kernel=kernel, speed=speed, out=out, sums=sums, real=real) -> None:
            rest = (out, None, None) if store else (None, speed, sums)
            kernel(pointer(numbers), SETS, STEPS, real(DT_S), pointer(speed), *map(pointer, rest))

        def stored(speed=speed, out=out, dtype=dtype) -> None:
            jbf.batch(RIG, speed, DT_S, **sets, dtype=dtype, out=out)

        def squares(speed=speed, dtype=dtype) -> None:
            jbf.batch(RIG, speed, DT_S, **sets, dtype=dtype, data=speed)

        rows = {"C": clock(lambda: theirs(True), per), "jbf": clock(stored, per)}
        table(f"T1, {SETS} sets, {kind}, stored", "ns/step/set", "C", rounds, rows)
        rows = {"C": clock(lambda: theirs(False), per), "jbf": clock(squares, per)}
        table(f"T1, {SETS} sets, {kind}, sum of squares", "ns/step/set", "C", rounds, rows)


def solvers(folder: Path, rounds: int, tasks: list[str]) -> None:
    """Time T2 and T3, eight motions to a required error of the friction, by jbf and by numbalsoda.

    numbalsoda has its best settings.
    """
    sys.path.insert(0, str(folder))
    os.environ.setdefault("NUMBA_NUM_THREADS", "2")
    os.environ.setdefault("RAYON_NUM_THREADS", "2")
    try:
        peers = importlib.import_module("solvers")
    except ImportError as error:
        skip("T2 and T3", f"{error}: pip install numba numbalsoda scipy (gfortran builds it)")
        return
    if "T2" in tasks:
        trajectories(peers, "T2", 2, "journal", 1e-6, rounds)
    if "T3" in tasks:
        trajectories(peers, "T3", 4, "journal_full", 1e-5, rounds)


def references(peers: ModuleType, order: int) -> np.ndarray:
    """Return the eccentricities of the peers' reference solution, stored next to their copy."""
    kept = Path(peers.__file__).with_name(f"reference{order}.npy")
    if not kept.is_file():
        print(f"reference of {order} states: about a minute", file=sys.stderr)
        settings = {2: ("DOP853", 3e-14, 1e-15), 4: ("Radau", 1e-9, 1e-11)}[order]
        common = importlib.import_module("common")
        np.save(kept, [common._ref(order, w, *settings) for w in peers.WS])
    return np.load(kept)


def trajectories(
    peers: ModuleType, task: str, order: int, model: str, wanted: float, rounds: int
) -> None:
    truth = references(peers, order)
    runs = [(np.append(0.0, peers.tgrid(w)[1]), (peers.A, w, 0.0)) for w in peers.WS]
    eps = float(peers.PV0[1])
    solver = peers.numbalsoda_par(order)

    def ours(tolerance: float) -> list[np.ndarray]:
        done = jbf.trajectories(
            RIG, TABLE, runs, model=model, tolerance=tolerance, eps=eps, phi_rad=0.01
        )
        return [d.friction_coefficient for d in done]

    def error(tolerance: float) -> float:
        worst = 0.0
        for w, solution, exact in zip(peers.WS, ours(tolerance), truth, strict=True):
            expected = peers.fric(peers.PV0, exact, peers.tgrid(w)[1], w)
            worst = max(worst, float(np.abs(solution[1:] - expected).max()))
        return worst

    def theirs(rtol: float, atol: float) -> list[np.ndarray]:
        return peers.run_all(solver, rtol=rtol, atol=atol)

    def their_error(rtol: float, atol: float) -> float:
        try:
            return float(peers.err_of(theirs(rtol, atol), truth))
        except RuntimeError:
            return np.inf

    # Try all settings of a grid and select the cheapest that passes for each solver.
    grid = [(r, r * share) for r in np.logspace(-5, -9, 25) for share in (10.0, 1.0, 0.1, 0.01)]
    errors = {setting: their_error(*setting) for setting in grid}
    seconds = {
        s: min(clock(partial(theirs, *s), 1.0)() for _ in range(7))
        for s, e in errors.items()
        if e < wanted
    }
    best = min(seconds, key=lambda s: seconds[s])
    error_of_setting = {float(t): error(t) for t in np.geomspace(wanted * 1000, wanted / 1000, 61)}
    cheapest = max(t for t, e in error_of_setting.items() if e < wanted)
    lost = {
        name: sum(not np.isfinite(e) for e in solution.values())
        for name, solution in (("numbalsoda", errors), ("jbf", error_of_setting))
    }
    print(f"\n{task}: largest friction error wanted {wanted:g}")
    print(
        f"numbalsoda, rtol {best[0]:.1e}, atol {best[1]:.1e}: {errors[best]:.1e}; "
        f"{lost['numbalsoda']} of {len(errors)} settings failed"
    )
    print(f"jbf, tolerance {wanted:.1e}: {error(wanted):.1e}")
    print(
        f"jbf, tolerance {cheapest:.1e}: {error_of_setting[cheapest]:.1e}; "
        f"{lost['jbf']} of {len(error_of_setting)} settings failed"
    )
    peer = "numbalsoda, 2 threads"
    rows: Timed = {
        peer: clock(partial(theirs, *best), 1e3),
        "jbf, as asked": clock(partial(ours, wanted), 1e3),
        "jbf, cheapest passing": clock(partial(ours, cheapest), 1e3),
    }
    table(f"{task}, 8 runs", "ms", peer, 20 * rounds, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="?", help="where the peers are")
    parser.add_argument("--rounds", type=int, default=5, help="turns of the longest task")
    parser.add_argument(
        "--tasks", nargs="+", choices=TASKS, default=TASKS, metavar="TASK", help=" ".join(TASKS)
    )
    parser.add_argument("--no-rest", action="store_true", help="one turn right after the other")
    options = parser.parse_args()
    if options.no_rest:
        global REST_S
        REST_S = 0.0
    if options.folder is None or not (options.folder / "c" / "kern.h").is_file():
        skip("All", f"no peers in {options.folder}: give the folder that holds c/kern.h")
        return
    copy = TARGET / "peers"
    shutil.copytree(
        options.folder, copy, ignore=shutil.ignore_patterns("target", "venv"), dirs_exist_ok=True
    )
    subprocess.run(["chmod", "-R", "u+w", str(copy)], check=True)
    files = ["libpeers.so", "libpeers_fast.so", "libpeers_simd.so"]
    if shutil.which("gcc") is None or shutil.which("make") is None:
        skip("T1 and batch", "gcc and make are needed")
    else:
        subprocess.run(["make", "-s", "-C", str(copy / "c"), *files], check=True)
        if "T1" in options.tasks:
            single(copy, options.rounds)
        if "batch" in options.tasks:
            batch(copy, options.rounds)
    if "T2" in options.tasks or "T3" in options.tasks:
        solvers(copy, options.rounds, options.tasks)
    if "T4" in options.tasks:
        sys.path.insert(0, str(copy))
        fit_task(options.rounds)


if __name__ == "__main__":
    main()
