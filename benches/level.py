"""How often a diagnosis names an effect where there is none, by the kind of noise.

    .venv/bin/python benches/level.py [--campaigns 40] [--first-seed 1] [--jobs 2]

Six runs of a slide with Coulomb and viscous friction, nothing hidden, under noise of five kinds,
made by numpy alone. Prints, of each, how many campaigns have a name, how many are `adequate`, and
the 95 % upper bound of the rate of names (Clopper & Pearson 1934).
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import jbf
import numpy as np
import numpy.typing as npt
from scipy import signal, stats

Array = npt.NDArray[np.float64]
Random = np.random.Generator

STEP_S, LASTS_S, RUNS = 0.02, 30.0, 6
F_C_N, F_V_N_S_M, NOISE_N = 5.0, 30.0, 0.2


def white(random: Random, force: Array, _run: int) -> Array:
    """Gaussian, independent."""
    return NOISE_N * random.standard_normal(len(force))


def coloured(random: Random, force: Array, _run: int) -> Array:
    """Half of its variance with a memory of 0.2 s."""
    keep = float(np.exp(-STEP_S / 0.2))
    drive = np.sqrt(1.0 - keep**2) * random.standard_normal(len(force))
    slow: Array = signal.lfilter([1.0], [1.0, -keep], drive)
    return NOISE_N * np.sqrt(0.5) * (slow + random.standard_normal(len(force)))


def heavy(random: Random, force: Array, _run: int) -> Array:
    """Student's t with three degrees of freedom."""
    return NOISE_N / np.sqrt(3.0) * random.standard_t(3.0, len(force))


def with_force(random: Random, force: Array, _run: int) -> Array:
    """A fifth that is the cell's, and four per cent of the force."""
    return (0.2 * NOISE_N + 0.04 * np.abs(force)) * random.standard_normal(len(force))


def by_run(random: Random, force: Array, run: int) -> Array:
    """From half to twice as large, run by run."""
    return NOISE_N * 2.0 ** (2.0 * run / (RUNS - 1) - 1.0) * random.standard_normal(len(force))


KINDS: dict[str, Callable[[Random, Array, int], Array]] = {
    "white": white,
    "coloured": coloured,
    "heavy tails": heavy,
    "grows with the force": with_force,
    "differs by run": by_run,
}


def campaign(kind: str, seed: int) -> list[jbf.Run]:
    """Six runs with sines and triangles of their own sizes and periods."""
    random = np.random.default_rng([seed, list(KINDS).index(kind)])
    time = STEP_S * np.arange(round(LASTS_S / STEP_S))
    runs = []
    for i in range(RUNS):
        turns = time / random.uniform(3.0, 7.0) + random.uniform()
        shape = np.sin(2.0 * np.pi * turns) if i % 2 else signal.sawtooth(2.0 * np.pi * turns, 0.5)
        speed = random.uniform(0.02, 0.2) * shape
        force = F_C_N * np.sign(speed) + F_V_N_S_M * speed
        path = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * STEP_S)))
        noisy = force + KINDS[kind](random, force, i)
        runs.append(jbf.Run.from_arrays(time, speed, noisy, position_m=path, name=f"{i}"))
    return runs


def answer(kind: str, seed: int) -> tuple[str, tuple[str, ...]]:
    """Verdict and names of one campaign."""
    found = jbf.diagnose(jbf.Rig(), campaign(kind, seed), law="coulomb")
    return found.verdict, found.effects


def main() -> None:
    """A row a kind of noise."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=40, help="of each kind; 40")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    seeds = range(given.first_seed, given.first_seed + given.campaigns)
    print(
        "| noise | campaigns | with a name | 95 % upper bound | adequate |\n|---|---|---|---|---|"
    )
    with ProcessPoolExecutor(given.jobs) as pool:
        for kind in KINDS:
            answers = list(pool.map(partial(answer, kind), seeds))
            named = sum(bool(names) for _, names in answers)
            adequate = sum(verdict == "adequate" for verdict, _ in answers)
            n = len(answers)
            most = float(stats.beta.ppf(0.95, named + 1, n - named)) if named < n else 1.0
            print(f"| {kind} | {n} | {named} | {100.0 * most:.1f} % | {adequate} |", flush=True)


if __name__ == "__main__":
    main()
