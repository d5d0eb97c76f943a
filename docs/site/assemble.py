"""Gather the site's pages in one folder, their links turned to where each page stands there.

The pages are written for the repository, where they link to files beside them. In the site a page
that lives elsewhere has a place of its own (`pages.OUTSIDE`), and a source file that is linked to
becomes a page that shows it: a reader with only the site has all of it.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from pages import DOCS, LINK, OUTSIDE, ROOT, prose

RUSTDOC = {"reference/jbf_core.md": "jbf_core", "reference/jbf_c.md": "jbf_c"}
"""Pages beneath whose heading the documentation of a crate is linked to."""
LEFT_OUT = {".py", ".pyc"}
LEXERS = {".rs": "rust", ".py": "python", ".toml": "toml", ".h": "c", ".c": "c", ".x": "text"}


class Broken(Exception):
    """A link to nothing."""


class Source:
    """The folder from which the site is built."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.shown: dict[Path, str] = {}
        self.broken: list[str] = []

    def place(self, page: Path) -> str:
        """Where a file of the repository stands in the site."""
        if page.is_dir():
            # What a folder is about is told by its README, of a program by its first lines.
            page = next(
                (page / n for n in ("README.md", "__main__.py") if (page / n).exists()), page
            )
        name = page.relative_to(ROOT).as_posix()
        if name in OUTSIDE:
            return OUTSIDE[name]
        if name == "README.md":
            return "index.md"
        if page.is_relative_to(DOCS) and page.suffix not in LEFT_OUT:
            return page.relative_to(DOCS).as_posix()
        if page.suffix == ".ipynb":
            return f"notebooks/{page.stem}.md"
        if page.is_dir():
            raise Broken(f"{name} is a folder that nothing tells of")
        # Folders that begin with a dot are left out of a site.
        self.shown[page] = f"source/{name.lstrip('.')}.md"
        return self.shown[page]

    def turned(self, page: Path, text: str) -> str:
        """The text of a page with its links as they are in the site."""
        here = os.path.dirname(self.place(page))
        bare = prose(text)
        out, at = [], 0
        for match in LINK.finditer(text):
            target = match["target"]
            within_code = bare[match.start()] != text[match.start()]
            if within_code or "://" in target or target.startswith(("#", "mailto:")):
                continue
            path, hash_, anchor = target.partition("#")
            there = (page.parent / path).resolve()
            try:
                if not there.exists():
                    raise Broken("is not there")
                new = os.path.relpath(self.place(there), here or ".")
            except (Broken, ValueError) as why:
                self.broken.append(f"{page.relative_to(ROOT)}: {target}: {why}")
                continue
            out += [text[at : match.start()], match["head"], new, hash_, anchor, match["tail"]]
            at = match.end()
        return "".join([*out, text[at:]])

    def write(self, name: str, text: str) -> None:
        """A page of the site."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def show(self) -> None:
        """The source files that pages link to, each a page."""
        for path, place in self.shown.items():
            name = path.relative_to(ROOT).as_posix()
            lexer = LEXERS.get(path.suffix, "text")
            text = path.read_text(encoding="utf-8")
            self.write(
                place, f"# {path.name}\n`{name}` of the repository.\n\n`````{lexer}\n{text}`````\n"
            )


def assemble(folder: Path) -> list[str]:
    """Fill the folder; returns the links that lead nowhere."""
    shutil.rmtree(folder, ignore_errors=True)
    source = Source(folder)
    for path in sorted(DOCS.rglob("*")):
        if path.is_dir() or path.suffix in LEFT_OUT or (DOCS / "site") in path.parents:
            continue
        if path.suffix == ".md":
            source.write(source.place(path), source.turned(path, path.read_text(encoding="utf-8")))
        else:
            copy = folder / path.relative_to(DOCS)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)
    for name, place in OUTSIDE.items():
        page = ROOT / name
        if page.exists():
            text = source.turned(page, page.read_text(encoding="utf-8"))
            if place in RUSTDOC:
                head, _, rest = text.partition("\n")
                all_of_it = f"[Every type and function](../rust/{RUSTDOC[place]}/index.html)"
                text = f"{head}\n{all_of_it}, as rustdoc has it.\n{rest}"
            source.write(place, text)
    source.show()
    return source.broken
