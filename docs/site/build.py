"""Build the site: `.venv/bin/python docs/site/build.py`, into `target/site/html`.

The program collects the pages, runs the notebooks, builds the site in strict mode (a warning is an
error), and adds the documentation of the crates. It checks the result for broken links and anchors
and for external resources.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from assemble import assemble
from built import faults
from pages import ROOT

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
EXAMPLES = ROOT / "examples"
SITE = ROOT / "target" / "site"
CRATES = ("jbf-core", "jbf-batch", "jbf-c")


def notebooks(folder: Path) -> None:
    """Run the example notebooks and write them as pages with their pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    convert = [sys.executable, "-m", "nbconvert", "--log-level", "ERROR", "--to", "markdown"]
    subprocess.run(
        [*convert, "--execute", "--output-dir", str(folder), *sorted(EXAMPLES.glob("*.ipynb"))],
        check=True,
    )


def rust(folder: Path) -> None:
    """Build the documentation of the crates with rustdoc."""
    named = [word for crate in CRATES for word in ("-p", crate)]
    subprocess.run(
        ["cargo", "doc", "--quiet", "--no-deps", "--target-dir", str(TARGET / "site-doc"), *named],
        cwd=ROOT,
        env={**os.environ, "RUSTDOCFLAGS": "-D warnings"},
        check=True,
    )
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(TARGET / "site-doc" / "doc", folder)


def main() -> int:
    """Build and check the site; return an exit code other than 0 if there are faults."""
    broken = assemble(SITE / "source")
    for line in broken:
        print(line, file=sys.stderr)
    if broken:
        return 1
    notebooks(SITE / "source" / "notebooks")
    rust(SITE / "source" / "rust")
    zensical = Path(sys.executable).parent / "zensical"
    build = [zensical, "build", "--clean", "--strict"]
    done = subprocess.run(
        build, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    print(done.stdout, end="")
    # Errors in docstrings are printed, but strict mode ignores them.
    if done.returncode != 0 or re.search(r"^(griffe|WARNING)", done.stdout, re.MULTILINE):
        return 1
    problems = faults(SITE / "html", skip=("rust",))
    for line in problems:
        print(line, file=sys.stderr)
    if not problems:
        print(f"{SITE / 'html'}: python -m http.server -d {SITE / 'html'}")
    return len(problems) > 0


if __name__ == "__main__":
    sys.exit(main())
