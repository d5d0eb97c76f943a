"""Test for ripple: a periodic force over the travel, with a different phase in each run.

A drive may be logged set point by set point, with its counter reset to zero each time. Every run
then shows the pitch of the screw or of the teeth, each at another phase. No effect of the catalogue
has a phase for each run: the phases of the present runs do not predict that of the next run, so
such a model has no predictive value. The ripple is therefore reported as residual structure.

The spectrum of each run's innovations over its travel is computed (Fisher 1929). Ordinates are
summed over runs independently of the phases. Where the runs share a phase, the effects `cogging`
and `pitch_ripple` describe it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.policy_residual import Ripples
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]

MOST_BINS = 2**16
"""Largest number of travel bins. It is a numerical resolution."""
PADDING = 4
"""Number of spectral lines per line width. It is a numerical resolution."""


def find_ripples(
    campaign: Campaign,
    samples: Samples,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    policy: Policy,
) -> list[Remainder]:
    """Find the clearest ripple over the travel whose phase differs between runs.

    Two forms are tested: a force, and a force in the direction of motion. The list has at most one
    element.
    """
    prepared = campaign.prepared
    if campaign.rig.bearing is not None or len(prepared) < policy.ripples.min_runs:
        return []
    ways = [_travel(p) for p in prepared]
    turned = [np.sign(p.motion.velocity) for p in prepared]
    found: list[Remainder] = []
    for along in (False, True):
        signs = turned if along else [np.ones(len(w)) for w in ways]
        e = [x * s for x, s in zip(innovations, signs, strict=True)]
        pitch = _pitch(ways, e, samples, policy)
        if pitch is None:
            continue
        r = [x * s for x, s in zip(residuals, signs, strict=True)]
        share, size, one = _waves(ways, r, samples, pitch)
        if _is_a_tone(campaign, e, r, samples, share, policy):
            continue
        if share >= policy.tones.min_share and one < policy.ripples.max_common_share:
            words = _words(campaign, pitch, size, along)
            found.append(Remainder("way", words, min(share, 1.0)))
    return sorted(found, key=lambda x: -x.share)[:1]


def _is_a_tone(
    campaign: Campaign,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    samples: Samples,
    share: float,
    policy: Policy,
) -> bool:
    """Whether one frequency explains about as much as one pitch, as it does at constant speed."""
    times = [p.run.time_s - p.run.time_s[0] for p in campaign.prepared]
    period = _pitch(times, innovations, samples, policy)
    least = policy.ripples.max_tone_share * share
    return period is not None and _waves(times, residuals, samples, period)[0] > least


def _travel(p: Prepared) -> Array:
    """Travel since the start of a run, m (for a joint rad)."""
    found: Array = p.motion.angle_rad - p.motion.angle_rad[0]
    return found


def _pitch(
    ways: Sequence[Array], innovations: Sequence[Array], samples: Samples, policy: Policy
) -> float | None:
    """The pitch whose lines, summed over the runs, are significant; None without such a pitch."""
    ripples, spans = policy.ripples, np.array([float(np.ptp(w)) for w in ways])
    longest = float(np.max(spans))
    steps = np.concatenate([np.abs(np.diff(w)) for w in ways])
    if not np.any(steps):
        return None
    fine = max(float(np.median(steps[steps > 0.0])), longest / MOST_BINS)
    length = PADDING * (int(longest / fine) + 1)
    # Waves per metre.
    waves = np.arange(length // 2 + 1) / (length * fine)
    total, degrees = np.zeros(len(waves)), np.zeros(len(waves))
    for way, e, counted, span in zip(ways, innovations, samples.counted, spans, strict=True):
        level = float(np.mean(e[counted] ** 2)) if counted.any() else 0.0
        if level <= 0.0 or span <= ripples.min_periods * fine:
            continue
        bins = ((way - way.min()) / fine).astype(np.intp)
        signal = np.where(counted, e - np.mean(e[counted]), 0.0)
        power = np.abs(np.fft.rfft(np.bincount(bins, signal, length), length)) ** 2
        told = waves * span >= ripples.min_periods
        total += np.where(told, 2.0 * power / (level * counted.sum()), 0.0)
        degrees += 2.0 * told
    band = (degrees >= 2.0 * ripples.min_runs) & (waves * fine * ripples.min_bins <= 1.0)
    if not band.any():
        return None
    chance = np.ones(len(waves))
    # Upper tail of chi-square; where it underflows, the excess over the expectation decides.
    chance[band] = special.gammaincc(0.5 * degrees[band], 0.5 * total[band])
    k = int(np.argmax(np.where(chance <= chance.min(), total - degrees, -np.inf)))
    if chance[k] * band.sum() > policy.tones.chance:
        return None
    pitch = 1.0 / float(waves[k])
    return pitch if _in_weaker_runs(ways, innovations, samples, pitch, ripples) else None


def _in_weaker_runs(
    ways: Sequence[Array],
    innovations: Sequence[Array],
    samples: Samples,
    pitch: float,
    ripples: Ripples,
) -> bool:
    """Whether the weaker two thirds of the runs also show the ripple significantly."""
    lines = []
    for way, e, counted in zip(ways, innovations, samples.counted, strict=True):
        level = float(np.sum(e[counted] ** 2))
        if level > 0.0 and np.ptp(way) >= ripples.min_periods * pitch:
            line = abs(np.sum((e * np.exp(2j * np.pi * way / pitch))[counted])) ** 2
            lines.append(2.0 * float(line) / level)
    weakest = sorted(lines)[: int(np.ceil(ripples.weaker_runs * len(lines)))]
    return bool(special.gammaincc(len(weakest), 0.5 * sum(weakest)) < ripples.weaker_chance)


def _waves(
    ways: Sequence[Array], residuals: Sequence[Array], samples: Samples, pitch: float
) -> tuple[float, float, float]:
    """Size of a ripple of given pitch.

    Returns
    -------
    tuple of float
        Share of the mean square; median amplitude over the runs, N; share of the ripple's power
        that one common phase explains.
    """
    pairs, rest = [], []
    for way, r, counted in zip(ways, residuals, samples.counted, strict=True):
        turns = np.exp(2j * np.pi * way[counted] / pitch)
        pairs.append(np.stack([turns.real, turns.imag], axis=1))
        rest.append(r[counted] - np.mean(r[counted]) if counted.any() else r[counted])
    square = sum(float(np.sum(r[c] ** 2)) for r, c in zip(residuals, samples.counted, strict=True))
    own, sizes = 0.0, []
    for pair, r in zip(pairs, rest, strict=True):
        solution, *_ = np.linalg.lstsq(pair, r, rcond=None)
        own += float(np.sum((pair @ solution) ** 2))
        sizes.append(float(np.hypot(*solution)))
    whole = np.concatenate(pairs)
    one, *_ = np.linalg.lstsq(whole, np.concatenate(rest), rcond=None)
    shared = float(np.sum((whole @ one) ** 2))
    return own / max(square, 1e-300), float(np.median(sizes)), shared / max(own, 1e-300)


def _words(campaign: Campaign, pitch: float, size: float, along: bool) -> str:
    rig, said = campaign.rig, campaign.rig.quantities
    if said.motion == "rotary":
        often = f"{2.0 * np.pi / pitch:.4g} times a turn"
    else:
        often = f"with every {pitch:.4g} {said.length}"
    lead = None if rig.drive is None else rig.drive.pitch_m
    if lead is not None:
        often += f" ({lead / pitch:.3g} times a turn)"
    what = "friction" if along else f"a {said.noun}"
    where = "in each run at a phase of its own"
    return f"{what} that comes again {often}, {size:.2g} {said.force}, {where}"
