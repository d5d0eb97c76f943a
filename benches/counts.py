"""Instructions of every kind of step, counted by callgrind and compared with `benches/counts.txt`.

`make counts` fails if a step takes over 5 % more instructions than in the baseline. `python
benches/counts.py --write` rewrites the baseline, as part of a change that justifies it.

Counts do not depend on the load of the machine, but on the compiler. If the rustc differs from that
of the baseline, the commit that wrote the baseline is built with the present rustc and measured
again. If git does not have this commit, the limit is 20 %.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BASELINE = ROOT / "benches" / "counts.txt"
LIMIT, LOOSE = 0.05, 0.20
MARK = "*jbf_counts_mark*"

Counts = dict[str, float]


def stop(reason: str) -> None:
    print(f"counts: {reason}", file=sys.stderr)
    raise SystemExit(2)


def rustc() -> str:
    return subprocess.run(["rustc", "--version"], check=True, capture_output=True, text=True).stdout


def measured(root: Path, target: Path) -> Counts:
    """Build the source tree `root` into `target` and count the instructions per step, by name."""
    # Flags set by the user would produce other code than the baseline's.
    environment = {
        k: v for k, v in os.environ.items() if k not in ("RUSTFLAGS", "CARGO_BUILD_RUSTFLAGS")
    }
    build = ["cargo", "build", "--quiet", "--release", "-p", "jbf-benches", "--bin", "counts"]
    subprocess.run([*build, "--target-dir", str(target)], check=True, cwd=root, env=environment)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        tool = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}"]
        run = subprocess.run(
            [*tool, f"--dump-before={MARK}", target / "release" / "counts"],
            capture_output=True,
            text=True,
        )
        if run.returncode != 0:
            stop(f"valgrind failed: {run.stderr.strip().splitlines()[-1]}")
        first, *names = run.stdout.split("\n")[:-1]
        steps = int(first.split()[1])

        def part(number: int) -> int:
            text = out.with_name(f"out.{number}").read_text(encoding="ascii", errors="replace")
            match = re.search(r"^summary: (\d+)", text, re.MULTILINE)
            return int(match.group(1)) if match else 0

        # Two marks per name: the instructions between them are counted.
        return {name: part(2 * i + 2) / steps for i, name in enumerate(names)}


def read() -> tuple[str, Counts]:
    if not BASELINE.is_file():
        stop(f"no {BASELINE.relative_to(ROOT)}: write one with --write")
    lines = BASELINE.read_text(encoding="utf-8").splitlines()
    rows = [line.split() for line in lines if line and not line.startswith("#")]
    compiler = next(line for line in lines if line.startswith("# rustc "))
    return compiler[2:], {name: float(count) for name, count in rows}


def write(counts: Counts) -> None:
    head = "# Instructions per step, counted by callgrind. Written by `benches/counts.py --write`."
    rows = [f"{name} {count:.1f}" for name, count in counts.items()]
    BASELINE.write_text("\n".join([head, f"# {rustc().strip()}", *rows]) + "\n", encoding="utf-8")


def by_this_compiler(target: Path) -> Counts | None:
    """Measure the commit that wrote the baseline with the present rustc.

    None if the history of the repository is not available.
    """
    log = ["git", "log", "-1", "--format=%H", "--", str(BASELINE)]
    commit = subprocess.run(log, cwd=ROOT, capture_output=True, text=True).stdout.strip()
    if not commit:
        return None
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        add = ["git", "worktree", "add", "--detach", str(tree), commit]
        if subprocess.run(add, cwd=ROOT, capture_output=True).returncode != 0:
            return None
        try:
            return measured(tree, target / "baseline")
        except subprocess.CalledProcessError:
            return None
        finally:
            remove = ["git", "worktree", "remove", "--force", str(tree)]
            subprocess.run(remove, cwd=ROOT, capture_output=True, check=True)


def baseline(target: Path) -> tuple[Counts, float]:
    """Return the instruction counts of the baseline, and the permitted relative increase."""
    compiler, counts = read()
    if compiler == rustc().strip():
        return counts, LIMIT
    print(f"the baseline is of {compiler}, this is {rustc().strip()}:", end=" ")
    again = by_this_compiler(target)
    if again is None:
        print(f"compared loosely, limit {LOOSE:.0%}")
        return counts, LOOSE
    print("its commit is measured with this compiler")
    return again, LIMIT


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write the baseline anew")
    options = parser.parse_args()
    if shutil.which("valgrind") is None:
        stop("valgrind is missing: apt-get install valgrind")
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve() / "counts"
    now = measured(ROOT, target)
    if options.write:
        write(now)
        print(f"{len(now)} counts written to {BASELINE.relative_to(ROOT)}")
        return
    before, limit = baseline(target)
    print("instructions per step: before      now")
    worse = []
    for name in sorted({*before, *now}):
        old, new = before.get(name), now.get(name)
        if old is None or new is None:
            print(f"{name:32} {'new' if old is None else 'gone'}")
            continue
        change = new / old - 1.0
        verdict = "" if abs(change) <= limit else "  MORE" if change > 0 else "  less"
        print(f"{name:32} {old:8.1f} {new:8.1f}  {change:+7.1%}{verdict}")
        if change > limit:
            worse.append(name)
    if worse:
        print(
            f"{len(worse)} over the limit of {limit:.0%}: {', '.join(worse)}\n"
            "where that is worth it, `python benches/counts.py --write` and say why",
            file=sys.stderr,
        )
        raise SystemExit(1)


if __name__ == "__main__":
    main()
