"""Would the tests notice? Puts deliberate faults into a copy of the tree, one at a time.

    .venv/bin/python benches/mutants [--only NAME] [--jobs 1]

Each table `*.toml` beside this file holds `[[mutant]]` with `what` is wrong, the `file`, the `old`
text, the `new` one in its place, and the `test` that must fail: a command, or a list of arguments
of `cargo test`. Fails where a mutant lives, no longer applies, or has a test that fails without it.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from faults import Copy, Mutant, Outcome, read_table, try_one  # noqa: E402

ROOT = HERE.parents[1]


def outcomes(mutants: list[Mutant], root: Path, jobs: int) -> Iterator[Outcome]:
    """Every mutant's fate, in order; each job has a copy of its own."""
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        copies = [Copy(root, Path(folder) / str(i)) for i in range(jobs)]
        passing: dict[str, bool] = {}

        def share(i: int) -> list[Outcome]:
            return [try_one(copies[i], mutant, passing) for mutant in mutants[i::jobs]]

        if jobs == 1:
            yield from (try_one(copies[0], mutant, passing) for mutant in mutants)
            return
        with ThreadPoolExecutor(jobs) as pool:
            for part in pool.map(share, range(jobs)):
                yield from part


def main(arguments: list[str] | None = None) -> int:
    """Try the mutants that were asked for; 1 where one of them was not noticed."""
    parser = argparse.ArgumentParser(prog="mutants", description=__doc__.split("\n", 1)[0])
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="NAME",
        help="those whose table and words hold this; may be given again",
    )
    parser.add_argument("--jobs", type=int, default=1, help="copies tested side by side")
    parser.add_argument("--tables", type=Path, default=HERE, help=argparse.SUPPRESS)
    parser.add_argument("--root", type=Path, default=ROOT, help=argparse.SUPPRESS)
    asked = parser.parse_args(arguments)
    every = [m for path in sorted(asked.tables.glob("*.toml")) for m in read_table(path)]
    chosen = [m for m in every if not asked.only or any(words in m.name for words in asked.only)]
    if not chosen:
        parser.error("no mutant has such a name")
    tally: Counter[str] = Counter()
    good = True
    for found in outcomes(chosen, asked.root, max(asked.jobs, 1)):
        print(f"{found.word:<22}{found.took_s:6.1f} s  {found.mutant.name}", flush=True)
        tally[found.word] += 1
        good &= found.good
    print(", ".join(f"{count} {word}" for word, count in tally.most_common()))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
