"""Collect the pages of the site in one folder and adapt their links.

The pages are written for the repository, where they link to neighbouring files. In the site, pages
from other places have separate paths (`pages.OUTSIDE`). A linked source file becomes a page that
shows it, so that the site is complete without the repository.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from pages import DOCS, LINK, OUTSIDE, ROOT, prose

RUSTDOC = {"reference/jbf_core.md": "jbf_core", "reference/jbf_c.md": "jbf_c"}
"""Pages that link to the documentation of a crate below their heading."""
LEFT_OUT = {".py", ".pyc"}
LEXERS = {".rs": "rust", ".py": "python", ".toml": "toml", ".h": "c", ".c": "c", ".x": "text"}


class Broken(Exception):
    """Error for a link without a target."""


class Source:
    """Folder from which the site is built, with the pages collected in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.shown: dict[Path, str] = {}
        self.broken: list[str] = []

    def place(self, page: Path) -> str:
        """Return the path in the site of a file of the repository."""
        if page.is_dir():
            # A folder is represented by its README, a program by its main module.
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
        # Folders whose name begins with a dot are omitted from a site.
        self.shown[page] = f"source/{name.lstrip('.')}.md"
        return self.shown[page]

    def turned(self, page: Path, text: str) -> str:
        """Return the text of a page with its links adapted to the site."""
        here = os.path.dirname(self.place(page))
        bare = prose(text)
        out, at = [], 0
        for match in LINK.finditer(text):
            target = match["target"]
            within_code = bare[match.start()] != text[match.start()]
            if within_code or "://" in target or target.startswith(("#", "mailto:")):
                continue
            path, hash_, anchor = target.partition("#")
            resolved = (page.parent / path).resolve()
            try:
                if not resolved.exists():
                    raise Broken("is not there")
                new = os.path.relpath(self.place(resolved), here or ".")
            except (Broken, ValueError) as why:
                self.broken.append(f"{page.relative_to(ROOT)}: {target}: {why}")
                continue
            out += [text[at : match.start()], match["head"], new, hash_, anchor, match["tail"]]
            at = match.end()
        return "".join([*out, text[at:]])

    def write(self, name: str, text: str) -> None:
        """Write a page of the site."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def show(self) -> None:
        """Write a page for each source file to which pages link."""
        for path, place in self.shown.items():
            name = path.relative_to(ROOT).as_posix()
            lexer = LEXERS.get(path.suffix, "text")
            text = path.read_text(encoding="utf-8")
            self.write(
                place, f"# {path.name}\n`{name}` of the repository.\n\n`````{lexer}\n{text}`````\n"
            )


def assemble(folder: Path) -> list[str]:
    """Collect all pages in a folder and return the broken links."""
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
