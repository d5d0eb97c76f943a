"""Compare the results of two versions of jbf, recorded by the first and compared by the second.

    python benches/same_numbers.py record before.json      # with the first version
    python benches/same_numbers.py compare before.json     # with the second version

Simulated campaigns of every kind (each effect alone, pairs, no effect, a foreign effect, ties,
other laws) are diagnosed, fitted and compared. All numbers and strings of the results must agree,
numbers to `--to` relative (1e-9). Record and compare on one machine: processors round differently.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import jbf
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "simulator"), str(ROOT / "benches")]

from rigruns import simulated  # noqa: E402
from rigsim import CATALOGUE  # noqa: E402

Row = dict[str, Any]
SEED = 8101
SLACK = 1e-9
VOLATILE = ("elapsed_s", "policy")
"""Fields of a result that do not depend on the runs."""


def campaigns() -> dict[str, dict[str, Any]]:
    """Return the campaigns by name, with the options of their simulation and diagnosis."""
    by_name: dict[str, dict[str, Any]] = {}
    for i, name in enumerate(sorted(CATALOGUE)):
        plan = "loads" if name == "load_dependence" else "short"
        by_name[name] = {"effects": (name,), "campaign": plan, "coloured": i % 2 == 1}
    by_name["none"] = {}
    by_name["none coloured"] = {"coloured": True}
    by_name["pair"] = {"effects": ("coulomb_drag", "sensor_lag")}
    by_name["pair with a drive"] = {"effects": ("presliding", "thermal_thinning"), "coloured": True}
    by_name["foreign"] = {"foreign": ("hum",)}
    by_name["foreign chatter"] = {"foreign": ("chatter",), "strength": 1.5}
    by_name["tied"] = {"effects": ("coulomb_drag",), "campaign": "one_way"}
    by_name["slow"] = {"effects": ("sensor_lag",), "campaign": "slow"}
    by_name["stribeck"] = {"effects": ("coulomb_drag",), "law": "stribeck"}
    by_name["lugre"] = {"law": "lugre"}
    return by_name


def answers(name: str, options: dict[str, Any], seed: int) -> Row:
    """Simulate and diagnose one campaign, and return all results of jbf as numbers and strings."""
    law = options.get("law", "journal")
    rig, runs, _ = simulated(
        seed,
        options.get("effects", ()),
        strength=options.get("strength", 1.0),
        coloured=options.get("coloured", False),
        campaign=options.get("campaign", "short"),
        foreign=options.get("foreign", ()),
    )
    diagnosis = jbf.diagnose(rig, runs, law=law)
    fit = jbf.fit(rig, runs, diagnosis.effects, law=law)
    row: Row = {
        "diagnosis": {k: v for k, v in diagnosis.to_dict().items() if k not in VOLATILE},
        "before": diagnosis.before.to_dict(),
        "after": diagnosis.after.to_dict(),
        "fit": {
            "parameters": {n: [p.value, p.stderr, p.note] for n, p in fit.parameters.items()},
            "correlations": fit.correlations.tolist(),
            "rms": fit.rms,
            "noise": [fit.noise.memory_s, fit.noise.colour],
            "samples": fit.nobs,
            "doubtful": list(fit.doubtful),
            "residuals_n": [float(np.sqrt(np.mean(r**2))) for r in fit.residuals],
        },
        "predictions": [digest(f) for f in diagnosis.after.predictions],
        "model": diagnosis.model.to_toml(),
    }
    if diagnosis.experiment is not None:
        run = diagnosis.experiment.run
        row["experiment"] = [
            digest(run.time_s),
            digest(run.velocity),
            diagnosis.experiment.evidence,
        ]
    if name in ("coulomb_drag", "none"):
        again = jbf.bootstrap(fit, runs, repeats=19)
        row["bootstrap"] = {n: digest(v) for n, v in again.values.items()}
        row["bootstrap errors"] = {n: p.stderr for n, p in again.fit.parameters.items()}
    return json.loads(json.dumps(row))


def digest(values: np.ndarray) -> list[float]:
    """Return a few numbers that distinguish one array from another."""
    weights = np.cos(np.arange(len(values)))
    return [float(np.mean(values)), float(np.std(values)), float(values @ weights)]


def differences(before: Any, after: Any, slack: float, place: str = "") -> list[str]:
    """Return the differences between two results, one line each.

    `slack` is the relative tolerance of numbers.
    """
    if isinstance(before, dict) and isinstance(after, dict):
        lines = [f"{place}/{k}: only on one side" for k in before.keys() ^ after.keys()]
        for key in before.keys() & after.keys():
            lines += differences(before[key], after[key], slack, f"{place}/{key}")
        return sorted(lines)
    if isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        pairs = enumerate(zip(before, after, strict=True))
        return [x for i, (a, b) in pairs for x in differences(a, b, slack, f"{place}/{i}")]
    numbers = (int, float)
    if isinstance(before, numbers) and isinstance(after, numbers):
        same = before == after or (before != before and after != after)
        if same or abs(before - after) <= slack * max(abs(before), abs(after)):
            return []
    return [] if before == after else [f"{place}: {before!r} -> {after!r}"]


def main() -> int:
    """Record the results of this version, or compare them with a record."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("work", choices=("record", "compare"))
    parser.add_argument("file", type=Path)
    parser.add_argument("--only", default="", help="names of campaigns, with commas")
    parser.add_argument("--to", type=float, default=SLACK, help="relative difference let pass")
    options = parser.parse_args()
    every = campaigns()
    names = [n for n in options.only.split(",") if n] or list(every)
    results: dict[str, Row] = {}
    recorded = json.loads(options.file.read_text()) if options.work == "compare" else {}
    wrong = 0
    for name in names:
        results[name] = answers(name, every[name], SEED + list(every).index(name))
        verdict = results[name]["diagnosis"]["verdict"]
        if options.work == "record":
            print(f"{name}: {verdict}", flush=True)
            options.file.write_text(json.dumps(results, indent=1))
            continue
        lines = differences(recorded[name], results[name], options.to)
        print(
            f"{name}: {verdict}: {'the same' if not lines else f'{len(lines)} differences'}",
            flush=True,
        )
        for line in lines[:12]:
            print(f"  {line[:200]}")
        wrong += bool(lines)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
