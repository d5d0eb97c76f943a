"""The page's colours: told apart by people who confuse red and green, and read on their ground."""

from __future__ import annotations

import re
from importlib.resources import files

import numpy as np
import numpy.typing as npt
import pytest

Array = npt.NDArray[np.float64]

STYLE = (files("jbf") / "workbench" / "static" / "style.css").read_text()
TOGETHER = (
    ("model", "beside"), ("measured", "model"), ("measured", "beside"), ("measured", "selected"),
    ("model", "selected"),
)  # fmt: skip
"""What lies over one another; the noise is a line of its own, the law alone is dotted ink."""
LEAST = 20.0
"""Distance in L*a*b*; 2.3 is the least that can be noticed side by side."""
SIGHT = {
    "full": np.eye(3),
    # Machado, Oliveira and Fernandes 2009, severity 1.
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
         [-0.003882, -0.048116, 1.051998]]
    ),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
         [-0.011820, 0.042940, 0.968881]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
         [0.004733, 0.691367, 0.303900]]
    ),
}  # fmt: skip


def linear(colour: str) -> Array:
    """Light of a colour written #rrggbb."""
    part = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    return np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)


def lab(light: Array) -> Array:
    """CIE L*a*b* of light."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    x = to_xyz @ np.clip(light, 0.0, 1.0) / np.array([0.9505, 1.0, 1.089])
    f = np.where(x > 0.008856, np.cbrt(x), 7.787 * x + 16.0 / 116.0)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


def palette(scheme: str) -> dict[str, str]:
    """The colours of a scheme by name."""
    light, dark = re.findall(r":root \{(.*?)\n\s*\}", STYLE, re.DOTALL)[:2]
    found: dict[str, str] = {}
    for text in (light, dark)[: 1 + (scheme == "dark")]:
        found |= dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", text))
    return found


def contrast(a: str, b: str) -> float:
    """WCAG 2 contrast."""
    one, other = (float(np.array([0.2126, 0.7152, 0.0722]) @ linear(c)) for c in (a, b))
    return (max(one, other) + 0.05) / (min(one, other) + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("sight", list(SIGHT))
def test_what_is_drawn_together_is_told_apart(scheme: str, sight: str) -> None:
    colours = palette(scheme)
    seen = {name: lab(SIGHT[sight] @ linear(colour)) for name, colour in colours.items()}
    for one, other in TOGETHER:
        assert np.linalg.norm(seen[one] - seen[other]) > LEAST, (one, other)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_and_lines_stand_out_of_their_ground(scheme: str) -> None:
    colours = palette(scheme)
    for ground in ("paper", "panel"):
        assert contrast(colours["ink"], colours[ground]) > 7.0
        for name in ("faint", "bad"):
            assert contrast(colours[name], colours[ground]) > 4.5, name
    for name in ("model", "beside", "noise", "measured"):
        assert contrast(colours[name], colours["paper"]) > 3.0, name
