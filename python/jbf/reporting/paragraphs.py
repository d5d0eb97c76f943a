"""Lines of plain text: aligned columns, hanging paragraphs."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence

WIDTH = 92
_TOGETHER = re.compile(r"v (<|>|<=|>=|=) \S+( m/s| rad/s)?|\d (N m|N|m|s|deg|rad)\b")
"""What a line break would tear: `v < 0`, `0.25 N`."""


def columns(rows: Sequence[Sequence[str]], align: str, indent: int = 2) -> list[str]:
    """Rows of cells as aligned lines; `align` holds `<` or `>` for each column."""
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
    """A paragraph whose further lines start below the text, not below its lead."""
    head = " " * indent + lead
    kept = _TOGETHER.sub(lambda found: found[0].replace(" ", "\0"), text)
    wrapped = textwrap.wrap(kept, WIDTH, initial_indent=head, subsequent_indent=" " * len(head))
    return [line.replace("\0", " ") for line in wrapped] or [head.rstrip()]
