"""Make every picture and generated page anew, from one commit: `make figures`.

Writes docs/reference/figures.md: which command made what, on which machine, from which commit.
`--as-committed` makes nothing, and tells of each the commit that brought what stands there now.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
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


def brought(names: tuple[str, ...]) -> str:
    """The commit that last changed what a script writes, and its day."""
    paths = [f"docs/{name}" for name in names]
    return said("git", "log", "-1", "--format=%h, %as", "--", *paths).strip()


def write(rows: list[tuple[str, tuple[str, ...], str]], told: str) -> None:
    """The page."""
    lines = ["| beside `docs` | made by | commit |", "| --- | --- | --- |"]
    for script, names, source in rows:
        shown = ", ".join(f"`{name}`" for name in names)
        lines.append(f"| {shown} | `.venv/bin/python {script}` | {source} |")
    lines += [f"| `{name}` | {why} | |" for name, why in NOT_ANEW.items()]
    text = "\n".join([HEAD, told, "", *lines, ""])
    PAGE.write_text(text, encoding="utf-8")


def main() -> int:
    """Run all; stop at the first that fails."""
    if "--as-committed" in sys.argv[1:]:
        rows = [(script, names, brought(names)) for script, names in SCRIPTS.items()]
        write(
            rows, "Not made at one time: the commit is the one that brought what stands there now."
        )
        return 0
    source = commit()
    for script in SCRIPTS:
        print(script, flush=True)
        done = subprocess.run([sys.executable, script], cwd=ROOT)
        if done.returncode != 0:
            return done.returncode
    rows = [(script, names, source) for script, names in SCRIPTS.items()]
    write(rows, f"Made {date.today().isoformat()} from one commit, on {machine()}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
