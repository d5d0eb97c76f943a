"""Sizes of artefacts: for each a range by strength, drawn once a campaign."""

from __future__ import annotations

from collections.abc import Callable

from ..seeds import Rng, log_uniform

STRENGTHS = ("mild", "usual", "severe")
Range = tuple[float, float]


def sized(**ranges: tuple[Range, Range, Range]) -> Callable[[str, Rng], dict[str, float]]:
    """Sizes by name, each from its (mild, usual, severe) range, small ones as likely as large."""

    def draw(strength: str, rng: Rng) -> dict[str, float]:
        at = STRENGTHS.index(strength)
        return {name: log_uniform(rng, *of[at]) for name, of in ranges.items()}

    return draw


def fixed(value: float) -> Range:
    """Always the same."""
    return value, value


def chance(rng: Rng, share: float) -> bool:
    """True with a probability."""
    return bool(rng.random() < share)


def either(rng: Rng) -> float:
    """A sign."""
    return 1.0 if rng.random() < 0.5 else -1.0
