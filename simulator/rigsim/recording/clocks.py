"""Artefacts of the sampling instants of the channels: delay, jitter, clock drift, a slow clock."""

from __future__ import annotations

import numpy as np

from ..seeds import Rng, log_uniform
from .draft import Artefact, Draft, Sizes
from .ranges import chance, either, fixed, sized


def _skew_of(strength: str, rng: Rng) -> Sizes:
    low, high = {"mild": (2.0, 6.0), "usual": (6.0, 14.0), "severe": (14.0, 30.0)}[strength]
    return {"low_ms": low, "high_ms": high, "sense": -1.0 if chance(rng, 0.25) else 1.0}


def _skew(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    late = 1e-3 * sizes["sense"] * rng.uniform(sizes["low_ms"], sizes["high_ms"])
    draft.force_instants = draft.force_instants - late
    return {"late_s": late}


def _jitter(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    # No logger samples in one order and writes in another.
    shaken = np.sort(draft.stamps + sizes["rms_s"] * rng.standard_normal(len(draft.stamps)))
    draft.force_instants = draft.force_instants + (shaken - draft.instants)
    draft.instants = shaken
    return {"rms_s": float(np.std(shaken - draft.stamps))}


def _drift_of(strength: str, rng: Rng) -> Sizes:
    size = {"mild": (5e-5, 1e-4), "usual": (1e-4, 3e-4), "severe": (4e-4, 1e-3)}[strength]
    return {"share": either(rng) * log_uniform(rng, *size)}


def _drift(draft: Draft, sizes: Sizes, _rng: Rng) -> Sizes:
    late = sizes["share"] * draft.stamps
    draft.force_instants = draft.force_instants - late
    return {"share": sizes["share"], "late_at_end_s": float(late[-1])}


def _slow_of(strength: str, rng: Rng) -> Sizes:
    rates = {"mild": (40.0, 47.0), "usual": (20.0, 40.0), "severe": (9.0, 18.0)}[strength]
    return {"rate_hz": float(rng.uniform(*rates)), "held": float(chance(rng, 0.35))}


def _slow(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    # The delays of the force channel were set on the encoder's instants; transfer them to its own.
    step = 1.0 / sizes["rate_hz"]
    ticks = np.arange(-rng.uniform() * step, draft.stamps[-1] + 2.0 * step, step)
    late = np.interp(ticks, draft.stamps, draft.stamps - draft.force_instants)
    draft.force_stamps = ticks
    draft.force_instants = ticks - late
    draft.held = bool(sizes["held"])
    return dict(sizes)


CLOCKS = (
    Artefact(
        "jitter", "time", "clock", sized(rms_s=(fixed(1e-3), fixed(3e-3), fixed(7e-3))), _jitter
    ),
    Artefact("skew", "force", "clock", _skew_of, _skew),
    Artefact("drifting_clock", "force", "clock", _drift_of, _drift),
    Artefact("slow_force", "force", "clock", _slow_of, _slow),
)
