"""Plain-text layout: aligned columns and paragraphs with a hanging indent."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence

WIDTH = 92
_TOGETHER = re.compile(r"v (<|>|<=|>=|=) \S+( m/s| rad/s)?|\d (N m|N|m|s|deg|rad)\b")
"""Expressions that must not be broken across lines, such as `v < 0` and `0.25 N`."""


def columns(rows: Sequence[Sequence[str]], align: str, indent: int = 2) -> list[str]:
    """Align rows of cells; `align` holds `<` or `>` for each column."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(align))]
    return [
        (
            " " * indent
            + "  ".join(
                f"{cell:{side}{width}}"
                for cell, side, width in zip(row, align, widths, strict=True)
            )
        ).rstrip()
        for row in rows
    ]


def hanging(lead: str, text: str, indent: int = 2) -> list[str]:
    """Wrap a paragraph so that continuation lines are indented by the width of its lead."""
    head = " " * indent + lead
    unbroken = _TOGETHER.sub(lambda match: match[0].replace(" ", "\0"), text)
    wrapped = textwrap.wrap(unbroken, WIDTH, initial_indent=head, subsequent_indent=" " * len(head))
    return [line.replace("\0", " ") for line in wrapped] or [head.rstrip()]
