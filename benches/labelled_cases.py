"""Score `jbf diagnose` and `jbf predict` on a folder of labelled campaigns.

    .venv/bin/python benches/labelled_cases.py CASES HELDOUT [--only case01,case02]

`CASES/truth.json` has, for each campaign, `effects` (name to parameters), `foreign`, `noise_n`;
`CASES/NAME` and `HELDOUT/NAME` have `rig.toml` and runs. Samples slower than 5e-4 m/s are excluded
from the held-out RMS. All steps use the command line, as a user would.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from jbf import effects as catalogue
from jbf import read_run
from jbf.renamed import current_effect

SLOWEST_M_S = 5e-4


def jbf(*words: str | Path) -> None:
    """Run a `jbf` command in a new process; raise if it fails."""
    subprocess.run([sys.executable, "-m", "jbf", *map(str, words)], check=True, capture_output=True)


def held_out_rms(model: Path, folder: Path, work: Path) -> float:
    """Return the RMS of record minus `jbf predict` over the runs of a folder, N."""
    total, count = 0.0, 0
    paths = sorted(folder.glob("*.csv"))
    if not paths:
        raise SystemExit(f"{folder}: no runs here; give the folder that holds the held-out runs")
    for path in paths:
        jbf("predict", model, path, "--out", work / "p.csv")
        predicted = np.loadtxt(work / "p.csv", delimiter=",", skiprows=1)[:, 1]
        run = read_run(path)
        assert run.friction is not None
        kept = np.abs(run.velocity) >= SLOWEST_M_S
        total += float(np.sum((run.friction - predicted)[kept] ** 2))
        count += int(kept.sum())
    return float(np.sqrt(total / count))


def judge(truth: dict[str, Any], diagnosis: dict[str, Any]) -> str:
    """Assess the effects that a diagnosis names as `right`, `tied`, `wrong` or `abstained`."""
    hidden = {current_effect(name) for name in truth["effects"]}
    named = set(diagnosis["effects"])
    if truth["foreign"] or hidden - set(catalogue()):
        extra = named - hidden
        return "right" if diagnosis["verdict"] == "unexplained" and not extra else "wrong"
    if named == hidden:
        return "right"
    if diagnosis["verdict"] == "unexplained" and not named - hidden:
        return "abstained"
    others = {a for tied in diagnosis["alternatives"].values() for a in tied}
    return "tied" if hidden <= named | others and len(named) == len(hidden) else "wrong"


def main() -> None:
    """Diagnose the campaigns and print a row for each, and the totals."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", type=Path)
    parser.add_argument("heldout", type=Path)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    truths = json.loads((arguments.cases / "truth.json").read_text())
    names = [n for n in arguments.only.split(",") if n] or sorted(truths)
    tally: dict[str, int] = {}
    print(
        f"{'case':8}{'hidden':34}{'verdict':13}{'named':34}{'judged':11}{'held/noise':>10}{'s':>7}"
    )
    for name in names:
        truth = truths[name]
        with tempfile.TemporaryDirectory() as folder:
            work = Path(folder)
            begun = time.monotonic()
            case = arguments.cases / name
            jbf("diagnose", case / "rig.toml", case, "--out", work / "m.toml", "--json", work / "d")
            seconds = time.monotonic() - begun
            diagnosis = json.loads((work / "d").read_text())
            rms = held_out_rms(work / "m.toml", arguments.heldout / name, work)
        hidden = ",".join([*truth["effects"], *truth["foreign"]]) or "-"
        verdict = judge(truth, diagnosis)
        tally[verdict] = tally.get(verdict, 0) + 1
        print(
            f"{name:8}{hidden:34}{diagnosis['verdict']:13}"
            f"{','.join(diagnosis['effects']) or '-':34}{verdict:11}"
            f"{rms / truth['noise_n']:10.4f}{seconds:7.1f}",
            flush=True,
        )
    print(tally)


if __name__ == "__main__":
    main()
