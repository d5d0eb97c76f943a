"""Artefacts at some instants only: spikes, a held force, a wrong position, lost rows."""

from __future__ import annotations

import numpy as np

from ..seeds import Rng, log_uniform
from .draft import Artefact, Draft, Sizes
from .ranges import fixed, sized


def _spikes(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    count = max(1, int(rng.poisson(sizes["share"] * len(draft.force))))
    at = rng.choice(len(draft.force), min(count, len(draft.force)), replace=False)
    heights = [log_uniform(rng, sizes["low"], sizes["high"]) for _ in at]
    force = draft.force.copy()
    force[at] += draft.noise_n * np.array(heights) * rng.choice([-1.0, 1.0], len(at))
    draft.force = force
    return {"samples": float(len(at)), "largest_n": draft.noise_n * max(heights)}


def _dropout(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    count = max(1, int(rng.poisson(sizes["a_run"])))
    force, lost = draft.force.copy(), 0
    for _ in range(count):
        length = log_uniform(rng, sizes["shortest_s"], sizes["longest_s"])
        first = int(rng.integers(1, len(force)))
        last = min(first + max(1, round(length / draft.step_s)), len(force))
        force[first:last] = force[first - 1]
        lost += last - first
    draft.force = force
    return {"times": float(count), "samples": float(lost)}


def _position_glitch(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    count = max(1, int(rng.poisson(sizes["a_run"])))
    at = rng.choice(len(draft.angle), count, replace=False)
    off = [log_uniform(rng, sizes["low_rad"], sizes["high_rad"]) for _ in at]
    angle = draft.angle.copy()
    angle[at] += np.array(off) * rng.choice([-1.0, 1.0], count)
    draft.angle = angle
    return {"samples": float(count), "largest_rad": max(off)}


def _gaps(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    keep = rng.random(len(draft.stamps)) >= sizes["share"]
    begun = rng.uniform(0.0, draft.stamps[-1] - sizes["stretch_s"])
    keep &= (draft.stamps < begun) | (draft.stamps > begun + sizes["stretch_s"])
    keep[0] = True
    draft.rows = np.flatnonzero(keep)
    return {"rows": float(np.sum(~keep)), "stretch_s": sizes["stretch_s"]}


CONVERTER_FAULTS = (
    Artefact(
        "spikes",
        "force",
        "converter",
        sized(
            share=(fixed(5e-4), fixed(2e-3), fixed(6e-3)),
            low=(fixed(6.0), fixed(10.0), fixed(20.0)),
            high=(fixed(20.0), fixed(60.0), fixed(120.0)),
        ),
        _spikes,
    ),
)
LATER_FAULTS = (
    Artefact(
        "dropout",
        "force",
        "transport",
        sized(
            a_run=(fixed(1.5), fixed(3.0), fixed(6.0)),
            shortest_s=(fixed(0.05), fixed(0.1), fixed(0.4)),
            longest_s=(fixed(0.15), fixed(0.5), fixed(1.2)),
        ),
        _dropout,
    ),
    Artefact(
        "position_glitch",
        "position",
        "motion",
        sized(
            a_run=(fixed(1.5), fixed(3.0), fixed(8.0)),
            low_rad=(fixed(0.01), fixed(0.03), fixed(0.1)),
            high_rad=(fixed(0.1), fixed(0.3), fixed(1.0)),
        ),
        _position_glitch,
    ),
    Artefact(
        "gaps",
        "rows",
        "rows",
        sized(
            share=(fixed(3e-3), fixed(0.015), fixed(0.05)),
            stretch_s=((0.1, 0.3), (0.3, 0.8), (1.0, 2.5)),
        ),
        _gaps,
    ),
)
