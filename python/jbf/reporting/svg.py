"""Figures as inline SVG with selectable text and the colours of the page's theme."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, cast

from markupsafe import Markup

from jbf.plot.style import BEFORE, INK, MEASURED, MODEL, NOISE, OTHER

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DOTS_PER_INCH = 120
"""Resolution of rasterized parts, which replace lines with too many points."""
_NAMED = {INK: "ink", MODEL: "model", BEFORE: "before", NOISE: "noise", MEASURED: "measured",
          OTHER: "other", "#ffffff": "paper"}  # fmt: skip
_COLOUR = re.compile(r"(?<=: )(" + "|".join(_NAMED) + r")\b")
_FACE = re.compile(r"(font-family: |font: (?:[a-z0-9]+ )*?[\d.]+px )[^;\"]+")
_HEAD = re.compile(r"<svg\b[^>]*?viewBox=\"([^\"]*)\"[^>]*>", re.DOTALL)


def svg(axes: Sequence[Axes], alt: str) -> Markup:
    """Convert the figure of the axes to SVG that scales to the width of its container."""
    from matplotlib import rc_context

    buffer = io.StringIO()
    nothing = {"Date": None, "Creator": None, "Format": None, "Type": None}
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "jbf"}):
        cast("Figure", axes[0].figure).savefig(
            buffer, format="svg", dpi=DOTS_PER_INCH, transparent=True, metadata=nothing
        )
    text = buffer.getvalue()
    text = text[text.index("<svg") :].strip()
    text = _COLOUR.sub(lambda match: f"var(--{_NAMED[match[1]]})", text)
    text = _FACE.sub(r"\1var(--face)", text)
    # The page sets the width.
    names = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
    look = f'class="figure" role="img" aria-label="{escape(alt)}"'
    return Markup(_HEAD.sub(lambda f: f'<svg {names} viewBox="{f[1]}" {look}>', text, count=1))
