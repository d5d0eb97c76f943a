"""Sizes of artefacts, drawn once per campaign from a range for each strength."""

from __future__ import annotations

from collections.abc import Callable

from ..seeds import Rng, log_uniform

STRENGTHS = ("mild", "usual", "severe")
Range = tuple[float, float]


def sized(**ranges: tuple[Range, Range, Range]) -> Callable[[str, Rng], dict[str, float]]:
    """Return a function that draws sizes log-uniformly from the (mild, usual, severe) ranges."""

    def draw(strength: str, rng: Rng) -> dict[str, float]:
        at = STRENGTHS.index(strength)
        return {name: log_uniform(rng, *of[at]) for name, of in ranges.items()}

    return draw


def fixed(value: float) -> Range:
    """Return a range that contains only `value`."""
    return value, value


def chance(rng: Rng, share: float) -> bool:
    """Return True with the probability `share`."""
    return bool(rng.random() < share)


def either(rng: Rng) -> float:
    """Return +1 or -1 with equal probability."""
    return 1.0 if rng.random() < 0.5 else -1.0
