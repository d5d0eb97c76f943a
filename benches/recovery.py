"""Coverage of the intervals of a fit: `python benches/recovery.py [EFFECT...]`.

For every effect of the catalogue, several rigs of `simulator/rigsim` are drawn at random, and each
is recorded many times with new noise. Every record is fitted with the right law and effect, and its
95 % intervals are compared with the true values. All random numbers follow from `--seed`.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import zlib
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import jbf
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

import rigsim
from rigruns import errors_in_sigma, rig_of, runs_of
from rigsim.campaign import draw_base
from rigsim.motions import Motion
from rigsim.warmth import REFERENCE_C, draw_warmth

NOISE_SHARE = 0.0175
WIDTH = 1.959964
"""Half-width of a 95 % interval in standard errors."""
WANTED = (0.90, 0.98)


@dataclass(frozen=True)
class Truth:
    """Simulated rig with one effect, and its exact records by name."""

    base: rigsim.Base
    effects: dict[str, dict[str, float]]
    records: dict[str, rigsim.Record]


def motions_for(effect: str) -> rigsim.Campaign:
    """Return the standard campaign that shows an effect, with several loads if required."""
    return rigsim.standard("loads" if effect == "load_dependence" else "full")


def make_truth(effect: str | None, seed: int, plan: rigsim.Campaign) -> Truth:
    """Draw a random rig with an effect of typical strength, and record it without noise."""
    base = draw_base(seed)
    random = np.random.default_rng([seed, zlib.crc32((effect or "").encode())])
    effects = {} if effect is None else {effect: rigsim.draw(effect, random)}

    def record(number: int, motion: Motion) -> rigsim.Record:
        warmth = None
        if effect in rigsim.BY_THERMOMETER:
            warmth = draw_warmth("wandering", number, motion.duration_s, random)
        return rigsim.simulate_run(
            base,
            effects,
            motion,
            start_angle_rad=float(random.uniform(0.0, 2.0 * math.pi)),
            load_n=base.load_n * plan.load_shares.get(motion.name, 1.0),
            warmth=warmth,
        )

    return Truth(base, effects, {m.name: record(i, m) for i, m in enumerate(plan.motions)})


def measured(truth: Truth, random: np.random.Generator, coloured: bool) -> list[jbf.Run]:
    """Return the records of a rig with measurement noise, as runs."""
    base = truth.base
    meter = rigsim.Noise(NOISE_SHARE * base.f_m * base.load_n, 0.5 if coloured else 0.0)
    return runs_of(
        {
            name: replace(
                r,
                velocity=meter.velocity(r.velocity, random),
                friction=meter.friction(r.friction, float(r.time_s[1]), random),
                angle_rad=meter.angle(r.angle_rad),
            )
            for name, r in truth.records.items()
        }
    )


def errors_of(
    truth: Truth, seed: Iterable[int], coloured: bool, bootstrap: int | None = None
) -> dict[str, float]:
    """Return estimate minus true value in standard errors, by parameter, for new noise on a rig.

    A parameter for which the fit gives no interval has NaN. With `bootstrap`, standard errors that
    the fit reports as unreliable are replaced by those of this number of fits to simulated records.
    """
    runs = measured(truth, np.random.default_rng(list(seed)), coloured)
    # The temperature at which the simulator's own viscosity applies.
    stated = {f"{e}.T_0_c": REFERENCE_C for e in truth.effects if e in rigsim.BY_THERMOMETER}
    fitted = jbf.fit(rig_of(truth.base.load_n), runs, list(truth.effects), fixed=stated)
    if bootstrap is not None and fitted.doubtful:
        fitted = jbf.bootstrap(fitted, runs, repeats=bootstrap).fit
    return errors_in_sigma(fitted, vars(truth.base), truth.effects)


def repeat(
    effect: str | None,
    rig: int,
    repeats: int,
    seed: int,
    coloured: bool,
    bootstrap: int | None = None,
) -> list[dict[str, float]]:
    """Return the errors, in standard errors, of all repeats on one rig."""
    truth = make_truth(effect, 1000 * seed + rig, motions_for(effect or ""))
    return [errors_of(truth, (seed, rig, k), coloured, bootstrap) for k in range(repeats)]


def study(
    effect: str | None,
    repeats: int,
    rigs: int,
    seed: int,
    coloured: bool,
    jobs: int,
    bootstrap: int | None = None,
) -> dict[str, list[float]]:
    """Return the errors of all repeats on all rigs, in standard errors, one list per parameter."""
    share = [repeats // rigs + (i < repeats % rigs) for i in range(rigs)]
    work = partial(_one_rig, effect, share, seed, coloured, bootstrap)
    rows: Iterator[list[dict[str, float]]]
    if jobs == 1:
        rows = map(work, range(rigs))
        errors = [row for part in rows for row in part]
    else:
        with ProcessPoolExecutor(jobs) as pool:
            errors = [row for part in pool.map(work, range(rigs)) for row in part]
    return {name: [row[name] for row in errors] for name in errors[0]}


def _one_rig(
    effect: str | None,
    share: list[int],
    seed: int,
    coloured: bool,
    bootstrap: int | None,
    rig: int,
) -> list[dict[str, float]]:
    return repeat(effect, rig, share[rig], seed, coloured, bootstrap)


@dataclass(frozen=True)
class Row:
    """Summary of the errors of one parameter.

    `bias` is their median and `spread` a robust standard deviation, both in standard errors;
    correct intervals have 0 and 1. `none` counts fits without an interval.
    """

    covered: float
    bias: float
    spread: float
    none: int
    count: int

    @classmethod
    def of(cls, errors: list[float]) -> Row:
        """Summarise the errors of one parameter."""
        z = np.array(errors)
        known = z[np.isfinite(z)]
        if not len(known):
            return cls(math.nan, math.nan, math.nan, len(z), len(z))
        low, high = np.quantile(known, [0.15866, 0.84134])
        return cls(
            covered=float(np.mean(np.abs(known) < WIDTH)),
            bias=float(np.median(known)),
            spread=float(0.5 * (high - low)),
            none=len(z) - len(known),
            count=len(z),
        )


HEADER = """| effect | parameter | covered | bias, sigma | spread, sigma | no interval | fits |
|---|---|---|---|---|---|---|"""


def lines(effect: str, errors: dict[str, list[float]]) -> Iterator[str]:
    """Generate the table rows of one effect, one per parameter."""
    for name, z in errors.items():
        row = Row.of(z)
        mark = "" if WANTED[0] <= row.covered <= WANTED[1] else " (!)"
        yield (
            f"| {effect} | {name.removeprefix(effect + '.')} | {100 * row.covered:.1f} %{mark} "
            f"| {row.bias:+.2f} | {row.spread:.2f} | {row.none or ''} | {row.count} |"
        )


def main() -> None:
    """Run the study and print its table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("effects", nargs="*", metavar="EFFECT", help="all, and none, by default")
    parser.add_argument("--repeats", type=int, default=200, help="fits per effect")
    parser.add_argument("--rigs", type=int, default=8, help="rigs among which they are shared")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--coloured", action="store_true", help="noise with a coloured part")
    parser.add_argument(
        "--bootstrap",
        type=int,
        metavar="N",
        help="errors from N fits of simulated records where a fit says that its own are none",
    )
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--json", type=Path, help="write every error here, effect by effect")
    options = parser.parse_args()
    kept: dict[str, dict[str, list[float]]] = {}
    print(
        f"{options.repeats} fits per effect, {options.rigs} rigs, seed {options.seed}\n\n{HEADER}"
    )
    for effect in options.effects or [None, *rigsim.CATALOGUE]:
        name = None if effect in (None, "none") else effect
        errors = study(
            name,
            options.repeats,
            options.rigs,
            options.seed,
            options.coloured,
            options.jobs,
            options.bootstrap,
        )
        kept[name or "none"] = errors
        print("\n".join(lines(name or "none", errors)), flush=True)
        if options.json is not None:
            options.json.write_text(json.dumps(kept), encoding="utf-8")


if __name__ == "__main__":
    main()
