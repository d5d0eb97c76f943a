"""Write the licences of the code that is linked into a wheel: THIRD_PARTY.md.

`python release/licences.py` writes the file from the crates that cargo fetched and from the notices
of the Rust toolchain. `--check` only checks that every crate of Cargo.lock that a wheel links is
listed correctly.
"""

from __future__ import annotations

import argparse
import html
import json
import re
import sys
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

from steps import ROOT, run

FILE = ROOT / "THIRD_PARTY.md"
HEAD = """# What a jbf wheel holds besides jbf

The extension links these Rust libraries into itself; the texts below are theirs. Written by
`make licences`. The workbench's uPlot has its text beside its files
(`jbf/workbench/vendored_files/uPlot.LICENSE`). Python packages are installed beside jbf, not in it:
docs/dependencies.md.
"""


@dataclass(frozen=True)
class Library:
    """Linked library, with the licence notice that must be distributed."""

    name: str
    version: str
    licence: str
    notice: str

    @property
    def row(self) -> str:
        """Row of the licence table: name, version and licence of the library."""
        return f"| `{self.name}` | {self.version} | {self.licence} |"


def linked() -> list[Library]:
    """Return the crates that the extension links on any machine.

    Macros and build scripts are not included, because they are not in the binary.
    """
    tree = "cargo tree --locked -p jbf-py --edges normal,no-proc-macro --target all --prefix none"
    told = run([*tree.split(), "--format", "{p}"], cwd=ROOT, quiet=True)
    wanted = {(m[1], m[2]) for m in re.finditer(r"^(\S+) v(\S+)", told, re.MULTILINE)}
    told = run(["cargo", "metadata", "--locked", "--format-version", "1"], cwd=ROOT, quiet=True)
    packages = json.loads(told[told.index("{") :])["packages"]
    return sorted(
        (
            Library(p["name"], p["version"], _spdx(p["license"]), _notice(p))
            for p in packages
            if (p["name"], p["version"]) in wanted and not p["name"].startswith("jbf-")
        ),
        key=lambda library: library.name,
    )


def _spdx(licence: str) -> str:
    return licence.replace("/", " OR ")


def _notice(package: dict[str, str]) -> str:
    """Return the text of the selected licence of a package: MIT if there is a choice."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(p for p in folder.iterdir() if re.match(r"(?i)licen[cs]e|copying", p.name))
    chosen = [p for p in files if "MIT" in p.name.upper()] or [p for p in files if p.is_file()]
    if not chosen:
        return f"(The crate brings no text; its licence is {_spdx(package['license'])}.)"
    return chosen[0].read_text(encoding="utf-8").strip()


def standard_library() -> tuple[str, list[Library]]:
    """Return the version of the toolchain and the crates of Rust's standard library."""
    root = Path(run(["rustc", "--print", "sysroot"], cwd=ROOT, quiet=True).strip())
    version = run(["rustc", "--version"], cwd=ROOT, quiet=True).split()[1]
    page = (root / "share/doc/rust/COPYRIGHT-library.html").read_text(encoding="utf-8")
    libraries = []
    for part in page.split("<h3>📦 ")[1:]:
        name, number = part[: part.index("<")].rsplit("-", 1)
        licence = re.search(r"<b>License:</b>\s*([^<]+)<", part)
        texts = dict(
            re.findall(r"<code>([^<]+)</code></summary>\s*<pre>(.*?)</pre>", part, re.DOTALL)
        )
        notice = next((t for n, t in texts.items() if "MIT" in n), next(iter(texts.values()), ""))
        assert licence is not None, name
        said = html.unescape(licence[1]).strip()
        text = html.unescape(notice).strip() or f"(No text; its licence is {said}.)"
        libraries.append(Library(name, number, said, text))
    return version, libraries


def written() -> str:
    """Return the text of THIRD_PARTY.md."""
    version, standard = standard_library()
    crates = linked()
    table = "| library | version | licence |\n| --- | --- | --- |\n"
    parts = [HEAD, table + "\n".join(library.row for library in crates) + "\n"]
    parts.append(
        f"Rust's standard library (of Rust {version}; MIT OR Apache-2.0, copyright The Rust\n"
        "Project Developers, <https://thanks.rust-lang.org>; its Unicode tables Unicode-3.0,\n"
        "copyright 1991-2024 Unicode, Inc.) brings:\n"
    )
    parts.append(table + "\n".join(library.row for library in standard) + "\n")
    texts: dict[str, list[str]] = defaultdict(list)
    for library in [*crates, *standard]:
        # Except for line breaks, many of these texts are identical.
        texts[library.notice].append(f"{library.name} {library.version}")
    for text, names in texts.items():
        parts.append(f"## {', '.join(dict.fromkeys(names))}\n\n```text\n{text}\n```\n")
    return "\n".join(parts)


def main() -> None:
    """Write or check THIRD_PARTY.md for the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    if not parser.parse_args().check:
        FILE.write_text(written(), encoding="utf-8")
        return
    page = FILE.read_text(encoding="utf-8")
    if missing := [c.row for c in linked() if c.row not in page or c.notice not in page]:
        sys.exit("\n".join([f"{FILE.name} is stale: make licences", *missing]))


if __name__ == "__main__":
    main()
