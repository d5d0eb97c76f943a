"""Make every picture and generated page anew, from one commit: `make figures`.

Writes docs/reference/figures.md: which command made what, on which machine, from which commit.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import time
from datetime import date
from pathlib import Path

from pages import DOCS, ROOT

SCRIPTS = {
    "docs/architecture.py": ("images/rooms.png", "images/way_of_data.png"),
    "docs/effects.py": ("effects/*.png", "effects/*.md"),
    "docs/laws.py": ("images/laws/*.png",),
    "docs/failures.py": ("images/failures/*.png", "why/failures.md"),
    "docs/reproduction.py": ("images/reproduction.png",),
    "docs/pictures.py": ("images/error_falling.png", "images/plot/*.svg"),
    "docs/control_pictures.py": ("images/control_*.png",),
    "docs/reduction.py": ("images/reduction.png",),
    "docs/workbench_pictures.py": ("images/workbench_*.png",),
    "docs/site/commands.py": ("reference/commands.md",),
}
"""What each script writes, beside docs."""
NOT_ANEW = {
    "images/detection.png": "a day of campaigns (`benches/hidden_effects`, seed 701, 784478f), "
    "not made anew",
}
PAGE = DOCS / "reference" / "figures.md"
HEAD = """# Figures: command, machine, commit

`make figures` makes all of these anew from one commit, and writes this page. Figures in the text
(times, rates, sizes) stand beside their own command, machine and commit where they are.
"""


def said(*command: str) -> str:
    """What a command prints."""
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout


def commit() -> str:
    """The commit, and whether what the figures depend on differs from it."""
    changed = said("git", "status", "--porcelain", "python", "crates", "docs/*.py", "simulator")
    return said("git", "rev-parse", "--short", "HEAD").strip() + (
        " with changes" if changed else ""
    )


def machine() -> str:
    """Processor, cores, Python."""
    info = Path("/proc/cpuinfo")
    named = [
        line.partition(":")[2].strip()
        for line in (info.read_text().splitlines() if info.exists() else [])
        if line.startswith("model name")
    ]
    processor = named[0] if named else platform.processor() or platform.machine()
    return f"{processor}, {os.cpu_count()} cores, Python {platform.python_version()}"


def main() -> int:
    """Run all; stop at the first that fails."""
    source, rows = commit(), []
    for script, written in SCRIPTS.items():
        begun = time.monotonic()
        print(script, flush=True)
        done = subprocess.run([sys.executable, script], cwd=ROOT)
        if done.returncode != 0:
            return done.returncode
        took = time.monotonic() - begun
        names = ", ".join(f"`{name}`" for name in written)
        rows.append(f"| {names} | `.venv/bin/python {script}` | {took:.0f} s |")
    rows += [f"| `{name}` | {why} | |" for name, why in NOT_ANEW.items()]
    told = f"jbf at commit {source}, {date.today().isoformat()}, on {machine()}."
    head = "| beside `docs` | made by | took |\n| --- | --- | --- |\n"
    text = f"{HEAD}\n{told}\n\n{head}" + "\n".join(rows) + "\n"
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
