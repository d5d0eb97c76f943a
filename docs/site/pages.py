"""Pages of the documentation: text, code blocks, links, and their paths in the site."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

OUTSIDE = {
    "ARCHITECTURE.md": "project/architecture.md",
    "CHANGELOG.md": "project/changelog.md",
    "CONTRIBUTING.md": "project/contributing.md",
    "CODE_OF_CONDUCT.md": "project/code_of_conduct.md",
    "SECURITY.md": "project/security.md",
    "release/README.md": "project/release.md",
    "benches/README.md": "project/benchmarks.md",
    "crates/jbf-core/README.md": "reference/jbf_core.md",
    "crates/jbf-c/README.md": "reference/jbf_c.md",
    "examples/firmware/README.md": "project/firmware.md",
}
"""Paths in the site of pages that are stored next to their subject."""

FENCE = re.compile(
    r"^(?P<ticks>`{3,})(?P<info>[^`\n]*)\n(?P<body>.*?)^(?P=ticks)[ \t]*$", re.M | re.S
)
NOTE = re.compile(r"<!--((?:(?!-->).)*)-->\s*\Z", re.S)
"""Pattern of an HTML comment at the end of a text."""
TITLE = re.compile(r'title="([^"]*)"')
LINK = re.compile(r"(?P<head>!?\[(?:[^\[\]]|\[[^\]]*\])*\]\()(?P<target>[^)\s]+)(?P<tail>\))")


@dataclass(frozen=True)
class Block:
    """Code block of a page: its language, the name of its file, its text and its line.

    `note` is the HTML comment directly above the block.
    """

    language: str
    title: str
    body: str
    row: int
    note: str = ""


def every_page() -> list[Path]:
    """Return all pages of the site and the README, in a fixed order."""
    inside = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
    return [*inside, *(ROOT / name for name in OUTSIDE if (ROOT / name).exists())]


def name_of(page: Path) -> str:
    """Return the path of a page relative to the root of the repository."""
    return page.resolve().relative_to(ROOT).as_posix()


def blocks(text: str) -> list[Block]:
    """Return the code blocks of a page, in order."""
    code_blocks = []
    for match in FENCE.finditer(text):
        info = match["info"].strip()
        title = TITLE.search(info)
        language = info.split()[0] if info and not info.startswith("title=") else ""
        row = text.count("\n", 0, match.start()) + 1
        note = NOTE.search(text, 0, match.start())
        code_blocks.append(
            Block(
                language,
                title[1] if title else "",
                match["body"],
                row,
                note[1].strip() if note else "",
            )
        )
    return code_blocks


def prose(text: str) -> str:
    """Return a page with its code blocks replaced by blanks, because code contains no links."""
    blank = re.compile(r"[^\n]")
    text = FENCE.sub(lambda match: blank.sub(" ", match[0]), text)
    return re.sub(r"(`+)(?:(?!\1).)+?\1", lambda m: "`" * len(m[0]), text)
