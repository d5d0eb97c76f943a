"""Artefacts of the load cell and its converter: zero and gain per run, range, quantisation."""

from __future__ import annotations

import numpy as np

from ..seeds import Rng
from .draft import Artefact, Draft, Sizes
from .ranges import sized


def _gain(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    gain = 1.0 + sizes["sd"] * float(rng.standard_normal())
    draft.force = draft.force * gain
    return {"gain": gain}


def _zero(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    zero = sizes["sd_over_noise"] * draft.noise_n * float(rng.standard_normal())
    draft.force = draft.force + zero
    return {"zero_n": zero}


def _saturate(draft: Draft, sizes: Sizes, _rng: Rng) -> Sizes:
    limit = sizes["of_peak"] * draft.peak_n
    clipped = float(np.mean(np.abs(draft.force) > limit))
    draft.force = np.clip(draft.force, -limit, limit)
    return {"limit_n": limit, "share_clipped": clipped}


def _quantise(draft: Draft, sizes: Sizes, _rng: Rng) -> Sizes:
    step = sizes["step_over_noise"] * draft.noise_n
    draft.force = np.round(draft.force / step) * step
    return {"step_n": step}


CELL = (
    Artefact(
        "gain_by_run",
        "force",
        "cell",
        sized(sd=((0.004, 0.008), (0.01, 0.02), (0.03, 0.05))),
        _gain,
    ),
    Artefact(
        "retared", "force", "cell", sized(sd_over_noise=((0.5, 0.9), (1.5, 2.5), (4.0, 6.0))), _zero
    ),
)
CONVERTER = (
    Artefact(
        "saturation",
        "force",
        "converter",
        sized(of_peak=((0.9, 0.97), (0.75, 0.88), (0.55, 0.7))),
        _saturate,
    ),
    Artefact(
        "quantised",
        "force",
        "converter",
        sized(step_over_noise=((0.7, 1.5), (1.5, 3.5), (3.5, 6.0))),
        _quantise,
    ),
)
