"""How often `jbf.diagnose` is right on campaigns as a logger hands them over.

    .venv/bin/python benches/recorded --folder CASES --heldout HELDOUT [--out rows.jsonl]

scores labelled campaigns on disk. `--out F` keeps one JSON line a campaign; a second call with the
same file goes on from it. A campaign runs in a process of its own, ended after `--limit` seconds.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from case import Row
from folder import cases
from limited import scored
from tables import kept, line, tables


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="recorded", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--folder", type=Path, help="labelled campaigns: NAME/*.csv, NAME/rig.toml")
    parser.add_argument("--heldout", type=Path, help="clean runs of the same rigs: NAME/*.csv")
    parser.add_argument("--only", default="", help="only campaigns whose name holds one of these")
    parser.add_argument("--jobs", type=int, default=1, help="campaigns side by side")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds for a campaign; 300")
    parser.add_argument("--least", type=float, metavar="SHARE", help="fail where fewer are right")
    parser.add_argument("--out", type=Path, help="JSON lines, one a campaign")
    return parser


def main() -> int:
    """Run what is missing, then print all of it."""
    parser = _parser()
    asked = parser.parse_args()
    if asked.folder is None or asked.heldout is None:
        parser.error("name both --folder and --heldout")
    try:
        planned = cases(asked.folder, asked.heldout)
    except FileNotFoundError as missing:
        print(f"skipped: {missing}")
        return 0
    planned = [c for c in planned if any(part in c.key for part in asked.only.split(","))]
    rows: list[Row] = []
    if asked.out is not None and asked.out.exists():
        rows = [json.loads(text) for text in asked.out.read_text(encoding="utf-8").splitlines()]
    done = {row["key"] for row in rows}
    # Threads only wait here: each campaign is a process of its own.
    with ThreadPoolExecutor(asked.jobs) as pool:
        running = [pool.submit(scored, c, asked.limit) for c in planned if c.key not in done]
        for future in as_completed(running):
            row = future.result()
            rows.append(row)
            print(line(row), flush=True)
            if asked.out is not None:
                with asked.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(row) + "\n")
    print(tables(rows))
    return 0 if asked.least is None or kept(rows) >= asked.least else 1


if __name__ == "__main__":
    sys.exit(main())
