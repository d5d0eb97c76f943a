"""Rate of right diagnoses of simulated campaigns with recording artefacts.

    .venv/bin/python benches/recorded [--artefacts a,b] [--kinds none,single,pair] [--jobs 2]
    .venv/bin/python benches/recorded --folder CASES --heldout HELDOUT

Simulates campaigns with the independent simulator (`simulator/rigsim/recording`), or takes labelled
ones from disk, and reads, diagnoses and assesses them. `--out F` stores one JSON line per campaign.
A second call with the same file continues it; with `--first 0` it only prints the tables. Each
diagnosis is a separate process, ended after `--limit` seconds of processor time.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "simulator"))

from case import Row
from folder import cases
from limited import scored
from plan import KINDS, Task, short, tasks
from rigsim.recording import ARTEFACTS, OFF_GRID
from tables import kept, line, tables
from written import written

Job = tuple[str, Callable[[], Row | None]]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="recorded", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--artefacts", default="", help="only recordings with these and no others")
    parser.add_argument("--kinds", default=",".join(KINDS), help=f"of {', '.join(KINDS)}")
    parser.add_argument("--seeds", type=int, default=2, help="rounds of 245 campaigns; 2")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--first", type=int, metavar="N", help="only the first N, a fair sample")
    parser.add_argument("--short", action="store_true", help="a dozen small campaigns")
    parser.add_argument("--keep", type=Path, help="folder for the campaigns' files; else deleted")
    parser.add_argument("--folder", type=Path, help="labelled campaigns: NAME/*.csv, NAME/rig.toml")
    parser.add_argument("--heldout", type=Path, help="clean runs of the same rigs: NAME/*.csv")
    parser.add_argument("--only", default="", help="only campaigns whose name holds one of these")
    parser.add_argument("--jobs", type=int, default=1, help="campaigns side by side")
    parser.add_argument("--limit", type=float, default=300.0, help="CPU s for a diagnosis; 300")
    parser.add_argument("--least", type=float, metavar="SHARE", help="fail where fewer are right")
    parser.add_argument("--out", type=Path, help="file of JSON lines, one per campaign")
    return parser


def _simulated(options: argparse.Namespace, parser: argparse.ArgumentParser) -> list[Job]:
    kinds = tuple(options.kinds.split(","))
    artefacts = tuple(name for name in options.artefacts.split(",") if name)
    for given, known in ((kinds, KINDS), (artefacts, (OFF_GRID, *ARTEFACTS))):
        if unknown := set(given) - set(known):
            parser.error(f"there is no {', '.join(sorted(unknown))}; there are {', '.join(known)}")
    planned = tasks(kinds, options.seeds, options.first_seed, artefacts)
    if options.short:
        planned = short(options.first_seed)

    def job(task: Task) -> Row | None:
        with tempfile.TemporaryDirectory() as scratch:
            try:
                case = written(task, options.keep or Path(scratch))
            except (ArithmeticError, ValueError) as error:
                print(f"{task.key}: skipped, because it cannot be simulated: {error}", flush=True)
                return None
            return scored(case, options.limit)

    return [(task.key, lambda task=task: job(task)) for task in planned]  # type: ignore[misc]


def _on_disk(options: argparse.Namespace) -> list[Job]:
    campaigns = cases(options.folder, options.heldout)
    return [(c.key, lambda c=c: scored(c, options.limit)) for c in campaigns]  # type: ignore[misc]


def main() -> int:
    """Run the missing campaigns, then print all results."""
    parser = _parser()
    options = parser.parse_args()
    if (options.folder is None) != (options.heldout is None):
        parser.error("name both --folder and --heldout")
    try:
        jobs = _simulated(options, parser) if options.folder is None else _on_disk(options)
    except FileNotFoundError as missing:
        print(f"skipped: {missing}")
        return 0
    jobs = [job for job in jobs if any(part in job[0] for part in options.only.split(","))]
    jobs = jobs[: options.first]
    rows: list[Row] = []
    if options.out is not None and options.out.exists():
        rows = [json.loads(text) for text in options.out.read_text(encoding="utf-8").splitlines()]
    done = {row["key"] for row in rows}
    # These threads only wait and simulate: each diagnosis is a separate process.
    with ThreadPoolExecutor(options.jobs) as pool:
        running = [pool.submit(run) for key, run in jobs if key not in done]
        for future in as_completed(running):
            row = future.result()
            if row is None:
                continue
            rows.append(row)
            print(line(row), flush=True)
            if options.out is not None:
                with options.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
    print(tables(rows))
    return 0 if options.least is None or kept(rows) >= options.least else 1


if __name__ == "__main__":
    sys.exit(main())
