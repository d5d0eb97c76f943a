"""Tests for periodic structure of the residual: in time, over the travel, and with the motion.

- `find_tones`: spectral lines above the white spectrum of the innovations (Fisher 1929).
- `find_ripples`: spectral lines over the travel, with a different phase in each run. If the
  position counter of a drive is reset to zero before each run, all runs contain the pitch of the
  screw or of the teeth, at different phases. The phases of the present runs do not predict that of
  the next run, so that a model with such phases has no predictive value. If the runs have a common
  phase, the effects `cogging` and `pitch_ripple` describe the ripple.
- `find_replicates`: errors that repeat with a repeated motion (a lack-of-fit test with replicates).
  Noise is independent between periods; a model error is not. The autocorrelation of the residual at
  a lag of one period is therefore the share of the mean square that is not noise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy import special

from jbf.arrays import Array, Mask
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.policy_residual import Ripples
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise_floor import period_samples
from jbf.estimation.pitches import fitted_wave
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.estimation.variance import long_run_variance

MOST_BINS = 2**16
"""Largest number of travel bins. It is a numerical resolution."""
PADDING = 4
"""Number of spectral lines per line width. It is a numerical resolution."""


def _sum_of_squares(residuals: Sequence[Array], samples: Samples) -> float:
    """Sum of squares of the residuals at included samples; replaced by a small value if zero."""
    squares = (np.sum(r[c] ** 2) for r, c in zip(residuals, samples.counted, strict=True))
    return max(sum(map(float, squares)), 1e-300)


# ---- tones ------------------------------------------------------------------------------------


def find_tones(
    prepared: Sequence[Prepared],
    samples: Samples,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    policy: Policy,
    less_smoothed: Callable[[], Sequence[Array]] | None = None,
) -> list[Remainder]:
    """Test for spectral lines in the innovations; their amplitudes are those in the residuals.

    `less_smoothed` returns the residuals with a motion that is smoothed less. A line that changes
    with it is an error of the smoothing.
    """
    most = policy.motion.max_pattern_ratio
    lines: list[tuple[float, float, str]] = []
    power = 0.0
    for i, (p, counted, e, r) in enumerate(
        zip(prepared, samples.counted, innovations, residuals, strict=True)
    ):
        n = len(e)
        if n < policy.tones.min_samples:
            continue
        f = np.fft.rfftfreq(n, p.step_s)
        spectrum = np.abs(np.fft.rfft(e - np.mean(e))) ** 2
        band = f > policy.tones.min_periods / p.run.duration_s
        if not band.any():
            continue
        level = float(np.median(spectrum[band]) / np.log(2.0))
        k = int(np.argmax(np.where(band, spectrum, 0.0)))
        if level <= 0.0 or spectrum[k] / level < -np.log(policy.tones.chance / band.sum()):
            continue
        frequency, amplitude, wave = _refine(p.run.time_s, r, counted, float(f[k]), float(f[1]))
        if less_smoothed is not None:
            ratio = float(wave @ less_smoothed()[i][counted]) / max(float(wave @ wave), 1e-300)
            if not 1.0 / most < ratio < most:
                continue
        lines.append((frequency, amplitude, p.run.name))
        power += 0.5 * amplitude**2 * n
    share = power / _sum_of_squares(residuals, samples)
    if not lines or share < policy.tones.min_share:
        return []
    words = _describe_tones(lines, len(prepared), prepared[0].run.quantities.force)
    return [Remainder("frequency", words, min(share, 1.0))]


def _describe_tones(lines: list[tuple[float, float, str]], runs: int, unit: str) -> str:
    """Describe the tone that all runs have in common, or otherwise the tone of each run."""
    middle = float(np.median([x[0] for x in lines]))
    same = [x for x in lines if abs(x[0] - middle) < 0.02 * middle + 0.02]
    scope = "in all runs" if len(lines) == runs else "in " + ", ".join(x[2] for x in lines)
    if len(same) == len(lines):
        amplitude = float(np.median([x[1] for x in same]))
        return f"a {middle:.2f} Hz tone, amplitude {amplitude:.2g} {unit}, {scope}"
    return "tones: " + ", ".join(f"{x[0]:.2f} Hz of {x[1]:.2g} {unit} in {x[2]}" for x in lines)


def _refine(
    time: Array, r: Array, counted: Mask, near: float, width: float
) -> tuple[float, float, Array]:
    """Frequency, amplitude and values of the best-fitting sine near a spectral line.

    The distance of the frequency from zero and from the Nyquist frequency is at least half a line
    width. At a smaller distance, a sine cannot be distinguished from a constant or from its alias.
    """
    nyquist = 0.5 / float(np.median(np.diff(time)))
    grid = near + width * np.linspace(-1.0, 1.0, 41)
    grid = np.clip(grid, 0.5 * width, nyquist - 0.5 * width)
    fits = [fitted_wave(2.0 * np.pi * f * time[counted], r[counted]) for f in grid]
    best = int(np.argmax([float(wave @ wave) for _, wave in fits]))
    amplitude, wave = fits[best]
    return float(grid[best]), amplitude, wave


# ---- ripples over the travel ------------------------------------------------------------------


def find_ripples(
    campaign: Campaign,
    samples: Samples,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    policy: Policy,
) -> list[Remainder]:
    """Test for a ripple over the travel whose phase differs between runs.

    Two forms are tested: a force, and a force in the direction of motion. Spectra of the runs are
    summed independently of the phases. The list contains the clearest ripple, or nothing.
    """
    prepared = campaign.prepared
    if campaign.rig.bearing is not None or len(prepared) < policy.ripples.min_runs:
        return []
    # Travel since the start of each run, m (for a joint rad).
    travels = [p.motion.angle_rad - p.motion.angle_rad[0] for p in prepared]
    directions = [np.sign(p.motion.velocity) for p in prepared]
    ripples: list[Remainder] = []
    for along in (False, True):
        signs = directions if along else [np.ones(len(w)) for w in travels]
        e = [x * s for x, s in zip(innovations, signs, strict=True)]
        pitch = _significant_pitch(travels, e, samples, policy)
        if pitch is None:
            continue
        r = [x * s for x, s in zip(residuals, signs, strict=True)]
        share, amplitude, common = _ripple_size(travels, r, samples, pitch)
        if _is_a_tone(campaign, e, r, samples, share, policy):
            continue
        if share >= policy.tones.min_share and common < policy.ripples.max_common_share:
            words = _describe_ripple(campaign, pitch, amplitude, along)
            ripples.append(Remainder("way", words, min(share, 1.0)))
    return sorted(ripples, key=lambda x: -x.share)[:1]


def _is_a_tone(
    campaign: Campaign,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    samples: Samples,
    share: float,
    policy: Policy,
) -> bool:
    """Whether one frequency explains a ripple almost as well as one pitch, as at constant speed."""
    times = [p.run.time_s - p.run.time_s[0] for p in campaign.prepared]
    period = _significant_pitch(times, innovations, samples, policy)
    least = policy.ripples.max_tone_share * share
    return period is not None and _ripple_size(times, residuals, samples, period)[0] > least


def _significant_pitch(
    travels: Sequence[Array], innovations: Sequence[Array], samples: Samples, policy: Policy
) -> float | None:
    """Pitch of a significant line in the summed periodograms over travel, m, or None."""
    ripples, spans = policy.ripples, np.array([float(np.ptp(w)) for w in travels])
    longest = float(np.max(spans))
    steps = np.concatenate([np.abs(np.diff(w)) for w in travels])
    if not np.any(steps):
        return None
    fine = max(float(np.median(steps[steps > 0.0])), longest / MOST_BINS)
    length = PADDING * (int(longest / fine) + 1)
    # Waves per metre.
    waves = np.arange(length // 2 + 1) / (length * fine)
    total, degrees = np.zeros(len(waves)), np.zeros(len(waves))
    for travel, e, counted, span in zip(travels, innovations, samples.counted, spans, strict=True):
        level = float(np.mean(e[counted] ** 2)) if counted.any() else 0.0
        if level <= 0.0 or span <= ripples.min_periods * fine:
            continue
        bins = ((travel - travel.min()) / fine).astype(np.intp)
        signal = np.where(counted, e - np.mean(e[counted]), 0.0)
        power = np.abs(np.fft.rfft(np.bincount(bins, signal, length), length)) ** 2
        resolved = waves * span >= ripples.min_periods
        total += np.where(resolved, 2.0 * power / (level * counted.sum()), 0.0)
        degrees += 2.0 * resolved
    band = (degrees >= 2.0 * ripples.min_runs) & (waves * fine * ripples.min_bins <= 1.0)
    if not band.any():
        return None
    chance = np.ones(len(waves))
    # Upper tail of chi-square. If it underflows, select the largest excess over the expectation.
    chance[band] = special.gammaincc(0.5 * degrees[band], 0.5 * total[band])
    k = int(np.argmax(np.where(chance <= chance.min(), total - degrees, -np.inf)))
    if chance[k] * band.sum() > policy.tones.chance:
        return None
    pitch = 1.0 / float(waves[k])
    return pitch if _in_weaker_runs(travels, innovations, samples, pitch, ripples) else None


def _in_weaker_runs(
    travels: Sequence[Array],
    innovations: Sequence[Array],
    samples: Samples,
    pitch: float,
    ripples: Ripples,
) -> bool:
    """Whether the runs with the weakest ripple also show it significantly."""
    lines = []
    for travel, e, counted in zip(travels, innovations, samples.counted, strict=True):
        level = float(np.sum(e[counted] ** 2))
        if level > 0.0 and np.ptp(travel) >= ripples.min_periods * pitch:
            line = abs(np.sum((e * np.exp(2j * np.pi * travel / pitch))[counted])) ** 2
            lines.append(2.0 * float(line) / level)
    weakest = sorted(lines)[: int(np.ceil(ripples.weaker_runs * len(lines)))]
    return bool(special.gammaincc(len(weakest), 0.5 * sum(weakest)) < ripples.weaker_chance)


def _ripple_size(
    travels: Sequence[Array], residuals: Sequence[Array], samples: Samples, pitch: float
) -> tuple[float, float, float]:
    """Share of the mean square, median amplitude over the runs (N) and common share of a ripple.

    The common share is the share of the ripple's power that one common phase explains.
    """
    phases, centred = [], []
    for travel, r, counted in zip(travels, residuals, samples.counted, strict=True):
        phases.append(2.0 * np.pi * travel[counted] / pitch)
        centred.append(r[counted] - np.mean(r[counted]) if counted.any() else r[counted])
    by_run = [fitted_wave(phase, r) for phase, r in zip(phases, centred, strict=True)]
    square = sum(float(wave @ wave) for _, wave in by_run)
    _, common = fitted_wave(np.concatenate(phases), np.concatenate(centred))
    amplitude = float(np.median([size for size, _ in by_run]))
    common_share = float(common @ common) / max(square, 1e-300)
    return square / _sum_of_squares(residuals, samples), amplitude, common_share


def _describe_ripple(campaign: Campaign, pitch: float, amplitude: float, along: bool) -> str:
    """Describe a ripple in one line; `pitch` is its spatial period.

    A ripple of the force in the direction of motion (`along`) is a periodic friction.
    """
    rig, quantities = campaign.rig, campaign.rig.quantities
    if quantities.motion == "rotary":
        often = f"{2.0 * np.pi / pitch:.4g} per revolution"
    else:
        often = f"period {pitch:.4g} {quantities.length}"
    lead = None if rig.drive is None else rig.drive.pitch_m
    if lead is not None:
        often += f" ({lead / pitch:.3g} per revolution)"
    what = "periodic friction" if along else f"periodic {quantities.noun}"
    where = "phase differs between runs"
    return f"{what}, {often}, {amplitude:.2g} {quantities.force}; {where}"


# ---- replicates of the motion -----------------------------------------------------------------


def find_replicates(
    prepared: Sequence[Prepared], solution: Solution, policy: Policy
) -> list[Remainder]:
    """Test for a part of the residual that repeats with a periodic motion, over all such runs."""
    product, spread, square, names = 0.0, 0.0, 0.0, []
    settings = solution.samples.settings
    least = policy.replicates.min_share
    residuals = solution.samples.without_deviations(solution.residuals, solution.noise)
    for residual, counted, p in zip(residuals, solution.samples.counted, prepared, strict=True):
        shift = period_samples(p.motion.velocity, settings.periods)
        if shift is None:
            continue
        both = counted[shift:] & counted[:-shift]
        first, second = residual[:-shift][both], residual[shift:][both]
        if len(first) < policy.replicates.min_pairs:
            continue
        level = float(first @ first + second @ second) / (2.0 * len(first))
        # Noise with a long correlation time is correlated over a period, and more over half of it.
        memory = _memory_of_noise(residual, counted, shift, policy.replicates.memory_lags)
        repeated = float(first @ second) - len(first) * memory
        product += repeated
        square += level * len(first)
        products = first * second
        variance = long_run_variance(
            (products - np.mean(products))[:, None], p.step_s, settings.variance
        )
        spread += max(level**2 * len(first), float(variance[0, 0]))
        if repeated > least * level * len(first):
            names.append(p.run.name)
    if spread == 0.0:
        return []
    share = product / square
    if share < least or product < policy.replicates.min_sigma * np.sqrt(spread):
        return []
    size = float(np.sqrt(share))
    where = f"periodic error, {100.0 * size:.0f} % of the residual RMS, in " + ", ".join(names)
    return [Remainder("period", where, min(share, 1.0))]


def _memory_of_noise(residual: Array, counted: Mask, shift: int, lags: Sequence[float]) -> float:
    """Autocovariance of the noise at a lag of one period, N^2.

    It is estimated by the smallest autocovariance at lags between half a period and one period,
    where that of a repeating error has both signs.
    """
    products = []
    for share in lags:
        lag = max(int(share * shift), 1)
        both = counted[lag:] & counted[:-lag]
        if both.any():
            products.append(float(np.mean(residual[:-lag][both] * residual[lag:][both])))
    return max(min(products, default=0.0), 0.0)
