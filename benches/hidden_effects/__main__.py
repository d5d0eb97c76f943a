"""Rate of right diagnoses of campaigns with hidden effects.

    .venv/bin/python benches/hidden_effects [--kinds single,none] [--seeds 2] [--rivals]

Simulates campaigns with the independent simulator (`simulator/rigsim`), diagnoses them, and prints
tables. `--out F` stores one JSON line per campaign; a second call with the same file continues it.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "simulator"))

from plan import KINDS, tasks
from tables import shares, tables
from work import Row, work


def main() -> int:
    """Run the missing campaigns, then print all results."""
    parser = argparse.ArgumentParser(prog="hidden_effects", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--kinds", default=",".join(KINDS), help=f"of {', '.join(KINDS)}")
    parser.add_argument("--seeds", type=int, default=1, help="rounds of each kind")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--only", default="", help="only tasks whose name holds one of these")
    parser.add_argument("--rivals", action="store_true", help="simpler rules on the same data")
    parser.add_argument("--jobs", type=int, default=1, help="campaigns side by side")
    parser.add_argument("--short", action="store_true", help="campaigns of 150 s, not of 420 s")
    parser.add_argument(
        "--least", type=float, metavar="SHARE", help="fail where fewer answers of a kind are good"
    )
    parser.add_argument("--out", type=Path, help="file of JSON lines, one per campaign")
    parser.add_argument("--picture", type=Path, help="detection rate against strength, PNG")
    options = parser.parse_args()
    wanted = tuple(options.kinds.split(","))
    if unknown := set(wanted) - set(KINDS):
        parser.error(f"no kind named {', '.join(sorted(unknown))}; there are {', '.join(KINDS)}")
    planned = tasks(wanted, options.seeds, options.first_seed, short=options.short)
    todo = [t for t in planned if any(part in t.key for part in options.only.split(","))]
    rows: list[Row] = []
    if options.out is not None and options.out.exists():
        rows = [json.loads(line) for line in options.out.read_text(encoding="utf-8").splitlines()]
    done = {row["key"] for row in rows}
    with ProcessPoolExecutor(options.jobs) as pool:
        running = [pool.submit(work, t, options.rivals) for t in todo if t.key not in done]
        for future in as_completed(running):
            row = future.result()
            rows.append(row)
            print(
                f"{row['key']:52}{row['verdict']:12}{','.join(row['named']) or '-':32}"
                f"{row['judged']:10}{row['held_out_over_noise']:8.3f}{row['seconds']:7.1f} s",
                flush=True,
            )
            if options.out is not None:
                with options.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
    print(tables(rows))
    if options.picture is not None:
        from picture import detection

        detection(rows, options.picture)
    return 0 if options.least is None or shares(rows, options.least) else 1


if __name__ == "__main__":
    sys.exit(main())
