"""What the instrument adds: white noise, and a coloured part with a memory of its own.

The residual of a right model is noise. It is described as white noise plus a first-order
coloured part (correlation time tau), which at even steps is an ARMA(1,1) process; its one-step
innovations are white, so likelihoods and standard errors are taken from them. The memory is
held below `LONGEST_MEMORY_S`, so that slow structure cannot pass for noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import optimize, signal, special

from jbf.estimation.campaign import Campaign, Prepared
from jbf.records.motion.roughness import noise_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

LONGEST_MEMORY_S = 0.6
"""Longest correlation time that still counts as noise."""


@dataclass(frozen=True)
class Noise:
    """White plus first-order coloured noise.

    Attributes
    ----------
    memory_s
        Correlation time of the coloured part.
    colour
        From 0 (white) to 1 (all coloured): the share by which innovations remember.
    """

    memory_s: float = 0.0
    colour: float = 0.0

    def innovations(self, values: Array, step_s: float) -> Array:
        """Whiten values of shape (n,) or (n, k) along the first axis."""
        now, before = self._filter(step_s)
        out: Array = signal.lfilter(now, before, values, axis=0) if before else values
        return out

    def coloured(self, innovations: Array, step_s: float) -> Array:
        """The noise whose innovations these are; undoes :meth:`innovations`."""
        now, before = self._filter(step_s)
        out: Array = signal.lfilter(before, now, innovations, axis=0) if before else innovations
        return out

    def _filter(self, step_s: float) -> tuple[list[float], list[float]]:
        """Coefficients of the filter that whitens; none of white noise."""
        if self.colour <= 0.0 or self.memory_s <= 0.0:
            return [], []
        phi = float(np.exp(-step_s / self.memory_s))
        return [1.0, -phi], [1.0, -phi * (1.0 - self.colour)]

    def coloured_share(self, step_s: float) -> float:
        """Share of the variance that the coloured part has, 0 to 1."""
        if self.colour <= 0.0 or self.memory_s <= 0.0:
            return 0.0
        keep = float(np.exp(-2.0 * step_s / self.memory_s))
        left = 1.0 - self.colour
        if left <= 0.0:
            return 1.0
        ratio = ((1.0 + keep * left**2) / left - (1.0 + keep)) / (1.0 - keep)
        return ratio / (1.0 + ratio)

    def with_share(self, share: float, step_s: float) -> Noise:
        """The same memory, the coloured part having this share (below 1) of the variance."""
        if share <= 0.0:
            return WHITE
        keep = float(np.exp(-2.0 * step_s / self.memory_s))
        total = share / (1.0 - share) * (1.0 - keep) + 1.0 + keep
        left = (total - np.sqrt(total**2 - 4.0 * keep)) / (2.0 * keep)
        return Noise(self.memory_s, float(1.0 - left))


WHITE = Noise()


def innovation_cost(
    noise: Noise, residuals: Sequence[Array], steps: Sequence[float], masks: Sequence[Mask]
) -> float:
    """`n log(mean square innovation)`: minus twice the log likelihood, up to a constant."""
    total, count = 0.0, 0
    for residual, step, mask in zip(residuals, steps, masks, strict=True):
        e = noise.innovations(residual, step)[mask]
        total += float(e @ e)
        count += len(e)
    return count * float(np.log(max(total, 1e-300) / max(count, 1)))


def independent_share(innovations: Sequence[Array], steps: Sequence[float]) -> float:
    """How many independent samples one sample of these innovations is worth, 0 to 1.

    Innovations of noise alone are white. Those of a wrong model are not, and n samples of them tell
    less than n (Bartlett 1946): the autocorrelations are summed until they sink into chance, or
    are older than any noise.
    """
    count = max(sum(len(e) for e in innovations), 1)
    longest = int(LONGEST_MEMORY_S / min(steps)) + 1
    total = np.zeros(longest + 1)
    middle = sum(float(np.sum(e)) for e in innovations) / count
    for e in innovations:
        n = len(e)
        power = np.fft.irfft(np.abs(np.fft.rfft(e - middle, 2 * n)) ** 2)[: min(n, len(total))]
        total[: len(power)] += power
    if total[0] <= 0.0:
        return 1.0
    rho = total[1:] / total[0]
    sunk = np.flatnonzero(rho < 2.0 / np.sqrt(count))
    end = int(sunk[0]) if len(sunk) else len(rho)
    return float(1.0 / (1.0 + 2.0 * np.sum(rho[:end])))


def estimate_noise(
    residuals: Sequence[Array],
    steps: Sequence[float],
    masks: Sequence[Mask],
    most_n: float | None = None,
) -> Noise:
    """The noise that makes the innovations of these residuals smallest.

    White unless colour earns its two parameters clearly. The coloured part's standard deviation is
    held to `most_n`, N, where that is known: the error of a wrong model is as smooth as coloured
    noise, and would be forgiven as such.
    """
    shortest = 2.0 * min(steps)
    longest = max(LONGEST_MEMORY_S, 2.0 * shortest)
    low, high = np.log(shortest), np.log(longest)

    def unpack(x: Array) -> Noise:
        memory, colour = special.expit(x)
        return Noise(float(np.exp(low + (high - low) * memory)), float(colour))

    def cost(x: Array) -> float:
        return innovation_cost(unpack(x), residuals, steps, masks)

    starts = [np.array([m, c]) for m in (-1.0, 1.5) for c in (-4.0, -1.5, 0.5)]
    best = min(starts, key=cost)
    found = optimize.minimize(
        cost, best, method="Nelder-Mead", options={"maxiter": 80, "xatol": 0.02, "fatol": 0.1}
    )
    white = innovation_cost(WHITE, residuals, steps, masks)
    if found.fun >= white - 20.0:
        return WHITE
    noise = unpack(found.x)
    if most_n is None:
        return noise
    square = sum(float(np.sum(r[m] ** 2)) for r, m in zip(residuals, masks, strict=True))
    square /= max(sum(int(m.sum()) for m in masks), 1)
    step = float(np.median(steps))
    most = most_n**2 / max(square, 1e-300)
    return noise if noise.coloured_share(step) <= most else noise.with_share(most, step)


def noise_floor(campaign: Campaign) -> float:
    """Standard deviation of the noise on the friction record, N, from the data alone.

    The white part comes from third differences of the record. A coloured part hides from
    differences; it shows where the same motion comes again a period later and where the shaft
    rests, so the larger of the estimates stands where it is clearly larger.
    """
    floor, seen = _white(campaign), _seen(campaign)
    if seen is None:
        return floor
    # Coloured noise leaves few independent samples: ask for a clear excess.
    return seen if seen > 1.04 * floor and seen < 3.0 * floor else floor


def most_noise(campaign: Campaign) -> float | None:
    """The most that the noise can be, N, colour and all; None where the records cannot tell."""
    seen = _seen(campaign)
    return None if seen is None else max(seen, _white(campaign))


def _white(campaign: Campaign) -> float:
    """The white part, N, from third differences."""
    prepared = campaign.prepared
    squares = [noise_of(p.friction_n[p.trusted]) ** 2 for p in prepared]
    return float(np.sqrt(np.average(squares, weights=[int(p.trusted.sum()) for p in prepared])))


def _seen(campaign: Campaign) -> float | None:
    """All of it, N, from periods that come again and from rests; None where these are too few."""
    whole, weight = 0.0, 0
    for p in campaign.prepared:
        rests = _rest_squares(p.motion.resting, p.friction_n)
        for square, count in (*rests, _repeat_square(p, p.friction_n)):
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
            part = signal.detrend(values[begin:end])
            found.append((float(part @ part) / (len(part) - 2), len(part)))
    return found


def _repeat_square(prepared: Prepared, values: Array) -> tuple[float, int]:
    """Variance of the noise from the same motion a period later, and the samples it used."""
    shift = period_samples(prepared.motion.velocity_m_s)
    if shift is None:
        return 0.0, 0
    # The first period still carries the start of the film.
    begin = shift // 2
    gap = (values[begin + shift :] - values[begin:-shift]) / np.sqrt(2.0)
    ok = prepared.trusted[begin + shift :] & prepared.trusted[begin:-shift]
    gap = gap[ok]
    if len(gap) < 100:
        return 0.0, 0
    # Slow drifts between periods are not noise: take them out. Half of the rest may do
    # anything (reversals that do not line up).
    size = max(len(gap) // 12, 25)
    blocks = [gap[i : i + size] for i in range(0, len(gap) - size + 1, size)]
    spread = [np.median(np.abs(b - np.median(b))) / 0.6745 for b in blocks]
    return float(np.median(spread) ** 2), len(gap)


def period_samples(velocity: Array) -> int | None:
    """The period of a repeated motion in samples, or None."""
    n = len(velocity)
    if n < 100 or np.ptp(velocity) == 0.0:
        return None
    centred = velocity - velocity.mean()
    power = np.fft.irfft(np.abs(np.fft.rfft(centred, 2 * n)) ** 2)[: n // 2 + n // 4]
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = power / power[0] * n / (n - np.arange(len(power)))
    falls = np.flatnonzero(rho < 0.0)
    if not len(falls):
        return None
    start = int(falls[0])
    inner = rho[start:-1]
    tops = start + np.flatnonzero(
        (inner > rho[start - 1 : -2]) & (inner >= rho[start + 1 :]) & (inner > 0.9)
    )
    if not len(tops):
        return None
    # The first repetition that is about as good as any, not a multiple of it.
    peak = int(tops[np.flatnonzero(rho[tops] > 0.98 * np.max(rho[tops]))[0]])
    # The correlation of a record with a ragged end peaks a little beside the period.
    reach = max(peak // 30, 2)
    gaps = {
        shift: float(np.std(velocity[shift:] - velocity[:-shift]))
        for shift in range(max(peak - reach, 1), min(peak + reach + 1, n - 1))
    }
    best = min(gaps, key=gaps.__getitem__)
    return best if gaps[best] < 0.02 * float(np.std(velocity)) else None
