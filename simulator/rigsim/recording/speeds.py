"""Artefacts of the speed: differences of encoder counts, and filtered speeds."""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi

from ..record import Vector
from ..seeds import Rng
from .draft import Artefact, Draft, Sizes
from .ranges import chance, fixed, sized

FINE_HZ = 1000.0
COARSE_COUNTS = {"mild": 36000.0, "usual": 10000.0, "severe": 4000.0}  # counts per turn


def _difference(draft: Draft, counts_per_rad: float, before: int, after: int) -> Vector:
    """Speed (m/s) from whole counts between `before` samples earlier and `after` samples later.

    At the ends of a record the interval is shortened. The logger divides by the stamps, not by the
    true instants.
    """
    draft.counts_per_rad = counts_per_rad
    angle = np.round(draft.signals.angle(draft.instants) * counts_per_rad) / counts_per_rad
    draft.angle = angle
    at = np.arange(len(angle))
    low, high = np.maximum(at - before, 0), np.minimum(at + after, len(angle) - 1)
    low, high = np.where(low == high, 0, low), np.where(low == high, 1, high)
    distance = (angle[high] - angle[low]) * draft.signals.base.bearing.radius_m
    speed: Vector = distance / (draft.stamps[high] - draft.stamps[low])
    return speed


def _coarse_of(strength: str, rng: Rng) -> Sizes:
    span = {"mild": 3.0, "usual": 5.0, "severe": 9.0}[strength]
    counts = COARSE_COUNTS[strength] / (2.0 * math.pi)
    return {"span": span, "counts_per_rad": counts, "trailing": float(chance(rng, 0.3))}


def _coarse(draft: Draft, sizes: Sizes, _rng: Rng) -> Sizes:
    span = int(sizes["span"])
    after = 0 if sizes["trailing"] else span // 2
    draft.speed = _difference(draft, sizes["counts_per_rad"], span - after, after)
    return {"over_s": span * draft.step_s} | sizes


def _backward_of(strength: str, _rng: Rng) -> Sizes:
    return {"counts_per_rad": COARSE_COUNTS[strength] / (2.0 * math.pi)}


def _backward(draft: Draft, sizes: Sizes, _rng: Rng) -> Sizes:
    draft.speed = _difference(draft, sizes["counts_per_rad"], 1, 0)
    return {"over_s": draft.step_s} | sizes


def _filtered(draft: Draft, sizes: Sizes, _rng: Rng) -> Sizes:
    fine = np.arange(0.0, draft.stamps[-1] + 1.0 / FINE_HZ, 1.0 / FINE_HZ)
    speed = draft.signals.speed(fine)
    sections = butter(2, sizes["cut_hz"], fs=FINE_HZ, output="sos")
    smooth, _ = sosfilt(sections, speed, zi=sosfilt_zi(sections) * speed[0])
    # The tachometer noise also passes the filter; the small remainder is neglected.
    draft.speed = np.interp(draft.instants, fine, smooth)
    return dict(sizes)


SPEEDS = (
    Artefact("coarse_velocity", "speed", "motion", _coarse_of, _coarse),
    Artefact("backward_velocity", "speed", "motion", _backward_of, _backward),
    Artefact(
        "filtered_velocity",
        "speed",
        "motion",
        sized(cut_hz=(fixed(12.0), fixed(5.0), fixed(2.5))),
        _filtered,
    ),
)
