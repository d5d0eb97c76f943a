"""How large the noise on the friction record is, by what the records alone say."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared
from jbf.estimation.replicates import period_samples
from jbf.estimation.samples import Samples
from jbf.records.motion.roughness import noise_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


def noise_floor(prepared: Sequence[Prepared], samples: Samples) -> float:
    """Standard deviation of the noise on the friction record, N, from the data alone.

    Runs whose force is a command, or was filtered, show none of it. Zero where no run does: the
    floor is not known then.

    The white part comes from third differences of the record, and is at least what a converter's
    steps leave (Widrow 1956): in coarse ones most readings are those before them. A coloured part
    hides from differences; it shows where the same motion comes again a period later and where the
    shaft rests, so the larger of the estimates stands where it is clearly larger.
    """
    noisy = [i for i, p in enumerate(prepared) if p.has_noise]
    if not noisy:
        return 0.0
    prepared, samples = [prepared[i] for i in noisy], samples.only(noisy)
    floor, seen = _white(prepared, samples), _seen(prepared, samples)
    if seen is None:
        return floor
    # Coloured noise leaves few independent samples: ask for a clear excess.
    return seen if seen > 1.04 * floor and seen < 3.0 * floor else floor


def most_noise(prepared: Sequence[Prepared], samples: Samples) -> float | None:
    """The most that the noise can be, N, colour and all; None where the records cannot tell."""
    seen = _seen(prepared, samples)
    return None if seen is None else max(seen, _white(prepared, samples))


def _white(prepared: Sequence[Prepared], samples: Samples) -> float:
    """The white part, N, from third differences, and from the steps of a converter."""
    squares = []
    for p, counted in zip(prepared, samples.counted, strict=True):
        values, added = _dithered(p)
        # Steps that are coarse beside the noise are repeated, and leave no less for that.
        squares.append(max(noise_of(values[counted]) ** 2 - added, added))
    counts = [int(c.sum()) for c in samples.counted]
    return float(np.sqrt(np.average(squares, weights=counts))) if any(counts) else 0.0


def _dithered(p: Prepared) -> tuple[Array, float]:
    """Readings with an even spread of their converter's step added, N, and its variance, N^2.

    Medians of what comes in steps are a step, or none; with dither they are those of the noise
    (Wannamaker et al. 2000). Without steps nothing is added.
    """
    step = p.converter_step_n
    if step == 0.0:
        return p.friction_n, 0.0
    even = np.random.default_rng(0).uniform(-0.5 * step, 0.5 * step, len(p.friction_n))
    return p.friction_n + even, step**2 / 12.0


def _seen(prepared: Sequence[Prepared], samples: Samples) -> float | None:
    """All of it, N, from periods that come again and from rests; None where these are too few."""
    whole, weight = 0.0, 0
    for p, counted in zip(prepared, samples.counted, strict=True):
        rests = _rest_squares(p.motion.resting, p.friction_n)
        for square, count in (*rests, _repeat_square(p, counted)):
            whole += square * count
            weight += count
    return None if weight < 300 else float(np.sqrt(whole / weight))


def _rest_squares(resting: Mask, values: Array) -> list[tuple[float, int]]:
    """Variance about its line in every long rest, with its length."""
    edges = np.diff(np.concatenate(([0], resting.astype(np.int8), [0])))
    found = []
    for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        # The first moments of a rest may still settle.
        begin = first + (end - first) // 4
        if end - begin >= 60:
            part = _off_its_line(values[begin:end])
            found.append((float(part @ part) / (len(part) - 2), len(part)))
    return found


def _off_its_line(values: Array) -> Array:
    """Values less the straight line through them."""
    place = np.arange(len(values)) - 0.5 * (len(values) - 1)
    above = values - np.mean(values)
    left: Array = above - place * float(place @ above) / float(place @ place)
    return left


def _repeat_square(prepared: Prepared, counted: Mask) -> tuple[float, int]:
    """Variance of the noise from the same motion a period later, and the samples it used."""
    shift = period_samples(prepared.motion.velocity_m_s)
    if shift is None:
        return 0.0, 0
    # The first period still carries the start of the film.
    (values, added), begin = _dithered(prepared), shift // 2
    gap = (values[begin + shift :] - values[begin:-shift]) / np.sqrt(2.0)
    ok = counted[begin + shift :] & counted[begin:-shift]
    gap = gap[ok]
    if len(gap) < 100:
        return 0.0, 0
    # Slow drifts between periods are not noise: take them out. Half of the rest may do
    # anything (reversals that do not line up).
    size = max(len(gap) // 12, 25)
    blocks = [gap[i : i + size] for i in range(0, len(gap) - size + 1, size)]
    spread = [np.median(np.abs(b - np.median(b))) / 0.6745 for b in blocks]
    return max(float(np.median(spread) ** 2) - added, added), len(gap)
