"""Recording artefacts of the noise of the force.

The noise is heavy-tailed or autocorrelated, or its standard deviation depends on the force or the
run.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.signal import lfilter

from ..seeds import Rng
from .draft import Artefact, Draft, Sizes
from .ranges import fixed, sized


def _heavy_tails(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    freedom = sizes["freedom"]
    unit = math.sqrt((freedom - 2.0) / freedom)  # same s.d. as without heavy tails
    draft.unit = unit * rng.standard_t(freedom, len(draft.unit))
    return dict(sizes)


def _with_force(draft: Draft, sizes: Sizes, _rng: Rng) -> Sizes:
    draft.scale = draft.scale * (1.0 + sizes["at_peak"] * np.abs(draft.force) / draft.peak_n)
    return dict(sizes)


def _by_run(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    times = float(sizes["factor"] ** rng.uniform(-1.0, 1.0))
    draft.scale = draft.scale * times
    return {"times": times}


def _long_memory(draft: Draft, sizes: Sizes, rng: Rng) -> Sizes:
    steps = np.diff(draft.force_instants)
    keep = math.exp(-float(np.median(steps)) / sizes["memory_s"])
    kicks = math.sqrt(1.0 - keep * keep) * rng.standard_normal(len(draft.extra))
    kicks[0] = rng.standard_normal()
    size = sizes["over_noise"] * draft.noise_n
    draft.extra = draft.extra + size * lfilter([1.0], [1.0, -keep], kicks)
    return {"memory_s": sizes["memory_s"], "sd_n": size}


NOISES = (
    Artefact(
        "heavy_tails",
        "force",
        "noise",
        sized(freedom=(fixed(6.0), fixed(3.0), fixed(2.3))),
        _heavy_tails,
    ),
    Artefact(
        "noise_with_force",
        "force",
        "noise",
        sized(at_peak=((0.5, 1.0), (1.0, 2.5), (3.0, 5.0))),
        _with_force,
    ),
    Artefact(
        "noise_by_run",
        "force",
        "noise",
        sized(factor=(fixed(1.3), fixed(2.0), fixed(3.5))),
        _by_run,
    ),
    Artefact(
        "long_memory",
        "force",
        "noise",
        sized(over_noise=((0.2, 0.3), (0.4, 0.6), (0.9, 1.3)), memory_s=((2.0, 4.0),) * 3),
        _long_memory,
    ),
)
