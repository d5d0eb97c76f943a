"""Make every picture and generated page anew, from one commit: `make figures`.

Writes docs/reference/figures.md: the command that made each file, the machine and the commit. If
scripts are named, only these run (`make figures ONLY=...`, which first builds this commit's
extension); for the others the page gives the commit that last changed their files. With
`--as-committed` nothing runs, and the page gives that commit for all files.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import time
from datetime import date
from pathlib import Path

from pages import DOCS, ROOT

SCRIPTS = {
    "docs/architecture.py": ("images/packages.png", "images/data_flow.png"),
    "docs/effects.py": ("effects/*.png", "effects/*.md"),
    "docs/laws.py": ("images/laws/*.png",),
    "docs/phenomena.py": ("images/phenomena/*.png",),
    "docs/failures.py": ("images/failures/*.png", "why/failures.md"),
    "docs/reproduction.py": ("images/reproduction.png",),
    "docs/pictures.py": ("images/error_falling.png", "images/plot/*.svg"),
    "docs/control_pictures.py": ("images/control_*.png",),
    "docs/reduction.py": ("images/reduction.png",),
    "docs/effect_shapes.py": ("../python/jbf/workbench/static/effect_shapes.json",),
    "docs/workbench_pictures.py": ("images/workbench_*.png",),
    "docs/site/commands.py": ("reference/commands.md",),
    "docs/policy.py": ("reference/policy.md",),
    "docs/targets.py": ("reference/targets.md",),
    "docs/target_losses.py": ("reference/target_losses.md",),
}
"""Names of the files that each script writes, relative to docs."""
NOT_ANEW = {
    "images/detection.png": "`benches/hidden_effects --seeds 1 --first-seed 701`, a day of "
    "campaigns, commit 784478f",
    "images/diagnosis_cost.png": "`benches/diagnosis_cost.py`, two minutes on an idle machine, "
    "commit d1e0daed",
}
PAGE = DOCS / "reference" / "figures.md"
HEAD = """# Figures: command, machine, commit

This page lists the command that draws each picture and writes each generated page. `make figures`
runs all of them and writes this page. Numbers in the text have their own command next to them.
"""


def said(*command: str) -> str:
    """Run a command and return its output."""
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def commit() -> str:
    """Return the present commit, with a mark if the sources of the figures differ from it."""
    changed = said("git", "status", "--porcelain", "python", "crates", "docs/*.py", "simulator")
    return said("git", "rev-parse", "--short", "HEAD").strip() + (
        " with changes" if changed else ""
    )


def machine() -> str:
    """Describe the processor, its cores and the Python version of this machine."""
    info = Path("/proc/cpuinfo")
    named = [
        line.partition(":")[2].strip()
        for line in (info.read_text().splitlines() if info.exists() else [])
        if line.startswith("model name")
    ]
    processor = named[0] if named else platform.processor() or platform.machine()
    return f"{processor}, {os.cpu_count()} cores, Python {platform.python_version()}"


def brought(names: tuple[str, ...]) -> str:
    """Return the last commit that changed the files of a script, and its date."""
    paths = [f"docs/{name}" for name in names]
    return said("git", "log", "-1", "--format=%h, %as", "--", *paths).strip()


def write(rows: list[tuple[str, tuple[str, ...], str]], note: str) -> None:
    """Write docs/reference/figures.md."""
    lines = ["| file in `docs` | command | commit |", "| --- | --- | --- |"]
    for script, names, source in rows:
        shown = ", ".join(f"`{name}`" for name in names)
        lines.append(f"| {shown} | `.venv/bin/python {script}` | {source} |")
    lines += [f"| `{name}` | {why} | |" for name, why in NOT_ANEW.items()]
    text = "\n".join([HEAD, note, "", *lines, ""])
    PAGE.write_text(text, encoding="utf-8")


def main() -> int:
    """Run all scripts, or those that are named; stop at the first that fails."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scripts", nargs="*", metavar="SCRIPT", help="such as docs/laws.py")
    parser.add_argument("--as-committed", action="store_true")
    options = parser.parse_args()
    if unknown := [name for name in options.scripts if name not in SCRIPTS]:
        parser.error(f"{unknown[0]} makes no figure; these do: {', '.join(SCRIPTS)}")
    made = [] if options.as_committed else options.scripts or list(SCRIPTS)
    source = commit()
    # The date that matplotlib writes into SVG files is that of the commit.
    dated = {**os.environ, "SOURCE_DATE_EPOCH": said("git", "log", "-1", "--format=%ct").strip()}
    for script in made:
        start = time.monotonic()
        done = subprocess.run([sys.executable, script], cwd=ROOT, env=dated)
        if done.returncode != 0:
            return done.returncode
        print(f"{script}: {time.monotonic() - start:.0f} s", flush=True)
    rows = [(s, names, source if s in made else brought(names)) for s, names in SCRIPTS.items()]
    if made:
        note = f"Made on {date.today().isoformat()} from {source}, on {machine()}."
        if len(made) < len(SCRIPTS):
            note += " Other files: the last commit that changed them."
    else:
        note = "The commit is the last one that changed the files."
    write(rows, note)
    return 0


if __name__ == "__main__":
    sys.exit(main())
