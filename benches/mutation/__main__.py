"""Fraction of random mutants that the tests detect, one mutant at a time in a copy of the tree.

    python benches/mutation --package NAME --sample N --seed S --out F.jsonl [--reach REACH.json]

`--package` names a package of `python/jbf`. Sites are drawn at random, with one of cosmic-ray's
operators at each. The tests that reach the line (`reach.py`; without it, those that import the
module) run, the quickest first, until one fails. Each mutant is a line of the record; a mutant in
the record is not tested again (`--again` repeats its survivors). In contrast to `faults.py`, the
mutants are not chosen by hand.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from itertools import islice
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from imports import by_imports  # noqa: E402
from reach import Chosen, Reach  # noqa: E402
from score import read, table  # noqa: E402
from sites import drawn  # noqa: E402
from tree_copy import TreeCopy  # noqa: E402
from trial import Bench, Trial  # noqa: E402

ROOT = HERE.parents[1]
PACKAGES = ("records", "estimation", "comparison", "diagnosis", "reporting", "control")


def arguments(given: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="mutation", description=__doc__.split("\n", 1)[0])
    parser.add_argument(
        "--package", action="append", default=[], help=f"one of {', '.join(PACKAGES)} (all)"
    )
    parser.add_argument("--sample", type=int, default=12, help="mutants of each package")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="the record, a line of JSON each")
    parser.add_argument(
        "--reach", type=Path, default=HERE / "reach.json", help="without it, tests by their imports"
    )
    parser.add_argument("--budget", type=float, default=60.0, help="seconds of tests a mutant")
    parser.add_argument("--again", action="store_true", help="survivors in the record once more")
    parser.add_argument("--tests", nargs="+", default=[], help="these, whatever reaches the line")
    parser.add_argument("--least", type=float, default=0.0, help="fail below this share")
    parser.add_argument("--root", type=Path, default=ROOT, help=argparse.SUPPRESS)
    parser.add_argument("--sources", default="python/jbf", help=argparse.SUPPRESS)
    return parser.parse_args(given)


def tried_in(
    options: argparse.Namespace, package: str, bench: Bench, done: list[Trial]
) -> list[Trial]:
    """Test random mutants of one package; results that are already in `done` are reused."""
    reach = Reach.read(options.reach) if options.reach.is_file() else by_imports(options.root)
    known = {t.name: t for t in done if (t.package, t.seed) == (package, options.seed)}
    files = sorted((options.root / options.sources / package).rglob("*.py"))
    if not files:
        raise SystemExit(f"{package} is not a package")
    trials: list[Trial] = []
    for fault in islice(drawn(options.root, files, f"{package} {options.seed}"), options.sample):
        trial = known.get(fault.name)
        if trial is None or (options.again and not trial.caught):
            chosen = reach.chosen(fault.file, fault.line, options.budget)
            if options.tests:
                chosen = Chosen(tuple(options.tests), 60.0)
            trial = bench.tried(fault, chosen)
            trial.package, trial.seed = package, options.seed
            if options.out:
                with options.out.open("a", encoding="utf-8") as record:
                    record.write(json.dumps(trial.row()) + "\n")
            print(f"{trial.word:<12}{trial.took_s:6.1f} s  {trial.name}", flush=True)
            if not trial.caught:
                print("\n".join(f"    {line}" for line in trial.diff), flush=True)
        trials.append(trial)
    return trials


def main(given: list[str] | None = None) -> int:
    """Test the mutants of all selected packages; return 1 if too few were detected."""
    options = arguments(given)
    done = read(options.out) if options.out else []
    trials: list[Trial] = []
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        bench = Bench(TreeCopy(options.root, Path(folder)))
        for package in options.package or PACKAGES:
            trials += tried_in(options, package, bench, done)
    print(table(trials))
    share = sum(trial.caught for trial in trials) / max(len(trials), 1)
    if share < options.least:
        print(f"{share:.0%} caught, {options.least:.0%} were asked for", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
