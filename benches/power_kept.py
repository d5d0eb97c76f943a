"""Detection rates of effects compared with their predicted power: `python benches/power_kept.py`.

The diagnosis of simulated campaigns without hidden effects reports two strengths per effect. At
`detectable_80`, 80 % of similar campaigns would show it; at `distinguishable_80`, it would be
named alone. The fitted model then simulates the same motions with the effect at that strength and
with similar noise, and the campaign is diagnosed. `--out F` stores one JSON line per campaign, in
the format of `benches/promises.py`; a second call with the same file continues.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf
from jbf.diagnosis.power import Power
from jbf.estimation.bootstrap import simulated_runs

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

from rigruns import simulated
from scipy import stats

PROMISED = 0.80


def at_strength(bare: jbf.Model, power: Power, value: float) -> jbf.Model:
    """Return the model with an effect whose size parameter is `value`.

    The other size parameters of the effect are scaled by the same factor from their starting
    values.
    """
    page = jbf.effects()[power.effect]
    usual = {p.name: (p.starts[0], p.null) for p in page.parameters}
    start, null = usual[power.parameter]
    assert null is not None
    times = start / value if math.isinf(null) else (value - null) / (start - null)
    parameters = {}
    for name, (size, zero) in usual.items():
        value_at_strength = size
        if zero is not None:
            value_at_strength = size / times if math.isinf(zero) else zero + times * (size - zero)
        parameters[f"{power.effect}.{name}"] = value_at_strength
    return jbf.Model(
        bare.rig, bare.law, [power.effect], {**bare.parameters, **parameters}, bare.clock
    )


def with_effect(
    bare: jbf.Model, strong: jbf.Model, runs: list[jbf.Run], draw: int
) -> list[jbf.Run]:
    """Simulate the runs by a model with noise, and add the change of the friction by an effect.

    The change is the difference between the predictions of `strong` (with the effect) and `bare`.
    `draw` is the seed of the noise.
    """
    again = simulated_runs(bare, runs, (), draw)
    changes = [
        a - b for a, b in zip(strong.predict_many(runs), bare.predict_many(runs), strict=True)
    ]
    return [
        replace(run, friction=run.friction + change)
        for run, change in zip(again, changes, strict=True)
    ]


def campaign(seed: int, effects: Sequence[str] | None = None) -> Iterator[dict[str, Any]]:
    """Yield a row of results for each effect with a stated power, and each of two sizes.

    The effect is added to the simulated runs at its detectable size and at its distinguishable
    size. Nothing is yielded if the diagnosis of the original campaign names an effect. `effects`
    limits the effects.
    """
    rig, runs, _ = simulated(seed, campaign="short", coloured=seed % 2 == 1)
    diagnosis = jbf.diagnose(rig, runs)
    if diagnosis.effects:
        return
    bare = diagnosis.model
    # Separate noise for each: with common noise all or none of the effects would be found.
    draws = itertools.count(1000 * seed)
    for power in diagnosis.power:
        for kind, value in (("found", power.detectable_80), ("alone", power.distinguishable_80)):
            draw = next(draws)
            if value is None or power.always or power.effect not in (effects or [power.effect]):
                continue
            yield answer(seed, kind, power, value, bare, runs, draw)


def answer(
    seed: int,
    kind: str,
    power: Power,
    value: float,
    bare: jbf.Model,
    runs: list[jbf.Run],
    draw: int,
) -> dict[str, Any]:
    """Diagnose simulated runs with an effect of size `value` added; return a row of results."""
    strong = at_strength(bare, power, value)
    again = jbf.diagnose(bare.rig, with_effect(bare, strong, runs, draw))
    could = {other for name in again.effects for other in (name, *again.alternatives[name])}
    alone = again.effects == (power.effect,) and not again.alternatives[power.effect]
    return {
        "key": f"power/{kind}/{power.effect}/{seed}",
        "kind": f"power_{kind}",
        "hidden": power.effect,
        "verdict": again.verdict,
        "named": list(again.effects),
        "alternatives": {k: list(v) for k, v in again.alternatives.items()},
        "judged": "right" if (alone if kind == "alone" else power.effect in could) else "wrong",
    }


def _all(seed: int, effects: Sequence[str] | None) -> list[dict[str, Any]]:
    return list(campaign(seed, effects))


def main() -> int:
    """Run the study and print a line per effect."""
    parser = argparse.ArgumentParser(prog="power_kept", description=__doc__.split(":")[0])
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=4, help="campaigns with nothing hidden; 4")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--effects", nargs="+", help="only these; all by default")
    parser.add_argument("--out", type=Path, help="file of JSON lines, one per diagnosis")
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    if options.out is not None and options.out.exists():
        rows = [json.loads(line) for line in options.out.read_text(encoding="utf-8").splitlines()]
    done = {int(row["key"].rsplit("/", 1)[1]) for row in rows}
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    with ProcessPoolExecutor(options.jobs) as pool:
        for future in as_completed(
            [pool.submit(_all, s, options.effects) for s in seeds if s not in done]
        ):
            rows += future.result()
            if options.out is not None:
                with options.out.open("a", encoding="utf-8") as file:
                    file.writelines(json.dumps(row) + "\n" for row in future.result())
            print(f"{len(rows)} diagnoses", flush=True)
    for kind in ("power_found", "power_alone"):
        print(f"\n{kind}: {PROMISED:.0%} promised")
        of_kind = [row for row in rows if row["kind"] == kind]
        for effect in sorted({row["hidden"] for row in of_kind}):
            named = [row["judged"] == "right" for row in of_kind if row["hidden"] == effect]
            sure = stats.binomtest(sum(named), len(named)).proportion_ci(0.95, method="exact")
            share = f"{sure.low:.0%} to {sure.high:.0%}"
            print(f"{effect:24}{sum(named):4} of {len(named):3}   {share}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
