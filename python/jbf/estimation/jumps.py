"""Samples next to a jump of the friction whose time is uncertain.

Friction jumps at a reversal of the motion. The record does not determine the sign of the samples
there, and these samples are excluded (`Samples`). An effect that shifts the jump in time (a delay
or backlash) also shifts the uncertain samples. The model then has a ramp over one sampling interval
where the record has a jump within the interval. The prediction error is about half of the change
over the interval. It reduces the weight of the sample in a fit, and tests exclude the sample.

If an effect spreads a jump over time, more samples are affected by the error of the jump's time.
This error is the standard error of the speed divided by the acceleration. The prediction error, N,
is the change of the reading during the error of the time. It reduces the weights of the samples in
a fit. Tests exclude samples for which it is a large part of the noise.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT, JumpSettings
from jbf.models.catalogue import Parameter, find_effect

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
MOST = 0.29
"""Standard deviation of a uniform position between two samples, relative to their distance."""


def moves_jumps(effects: Iterable[str]) -> bool:
    """Whether any of the effects shifts friction jumps in time."""
    return any(find_effect(name).moves_jumps for name in effects)


def spreads_jumps(effects: Iterable[str]) -> bool:
    """Whether any of the effects spreads a friction jump over many samples."""
    return any(find_effect(name).spreads_jumps for name in effects)


def active_effects(
    effects: Iterable[str], pages: Mapping[str, Parameter], values: Iterable[float]
) -> list[str]:
    """Effects with at least one parameter that differs from its null.

    `pages` and `values` are in the same order, that of the parameters' full names.
    """
    active: dict[str, bool] = {}
    for (name, page), value in zip(pages.items(), values, strict=True):
        effect, dot, _ = name.partition(".")
        if dot and page.null is not None:
            active[effect] = active.get(effect, False) or page.null != value
    return [effect for effect in effects if active.get(effect, True)]


def jumps(prediction: Array, settings: JumpSettings = DEFAULT.jumps) -> Array:
    """Change of a prediction, N, at samples in or next to a friction jump; zero elsewhere."""
    change = np.abs(np.diff(prediction))
    # A ramp across a sample contributes to two changes, so one neighbour may belong to it. The two
    # jumps at a backlash gap may be equally close.
    around = np.pad(change, 2)
    before = np.minimum(around[:-4], around[1:-3])
    after = np.minimum(around[3:-1], around[4:])
    isolated = change > settings.min_ratio * np.maximum(before, after)
    largest = np.max(np.abs(prediction), initial=0.0)
    steep = np.where(isolated & (change > settings.min_share * largest), change, 0.0)
    return np.asarray(np.maximum(np.append(steep, 0.0), np.append(0.0, steep)))


def samples_near_jumps(
    samples: Samples,
    prepared: Sequence[Prepared],
    predictions: Sequence[Array],
    effects: Sequence[str],
) -> Samples:
    """Reduce the weights of samples at which the time of a predicted friction jump is uncertain.

    The weights are unchanged if the effects neither shift nor spread jumps. The effects must not be
    at their null.
    """
    moves, spreads = moves_jumps(effects), spreads_jumps(effects)
    if not (moves or spreads):
        return samples
    counted, weight, settings = [], [], samples.settings.jumps
    for p, c, w, prediction in zip(
        prepared, samples.counted, samples.weight, predictions, strict=True
    ):
        if moves:
            # The prediction is wrong by half of the jump.
            change = jumps(prediction, settings)
            c = c & (change == 0.0)
            w = w * _share(0.5 * change, _residual_rms(p, c, prediction))
        if spreads:
            noise_rms = _residual_rms(p, c, prediction)
            error_n = timing_errors(p, prediction, settings.max_timing_error * noise_rms)
            c, w = c & (error_n == 0.0), w * _share(error_n, noise_rms)
        counted.append(c)
        weight.append(w)
    return replace(samples, counted=tuple(counted), weight=tuple(weight))


def _residual_rms(p: Prepared, kept: Mask, prediction: Array) -> float:
    """Root mean square of the residual of a prediction at the samples of a mask, N."""
    return float(np.sqrt(np.mean((prediction - p.friction)[kept] ** 2))) if kept.any() else 0.0


def _share(error_n: Array, noise_rms: float) -> Array:
    """Weight of a sample whose prediction has an error `error_n` in addition to the noise."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(error_n > 0.0, noise_rms / np.hypot(noise_rms, error_n), 1.0))


def timing_errors(p: Prepared, prediction: Array, least_n: float) -> Array:
    """Standard error of a prediction after each reversal, N, due to the uncertain reversal time.

    Shape (n,); zero elsewhere, and from where the error falls below `least_n`.
    """
    motion, time_s = p.motion, p.run.time_s
    errors = np.zeros(len(prediction))
    if len(prediction) < 3:
        return errors
    rate_n_s = np.abs(np.gradient(prediction, time_s))
    befores, afters = _reversals(p)
    for k, (before, after) in enumerate(zip(befores, afters, strict=True)):
        between_s = float(time_s[after] - time_s[before])
        slope = float(abs(motion.velocity[after] - motion.velocity[before])) / between_s
        error = float(np.max(motion.velocity_error_m_s[before : after + 1]))
        error_s = min(error / slope, MOST * between_s)
        last = befores[k + 1] if k + 1 < len(befores) else len(prediction)
        behind_n = error_s * rate_n_s[before + 1 : last + 1]
        # The error decays from where the sign is known again.
        small = np.flatnonzero(behind_n[after - before - 1 :] < least_n)
        if len(small):
            behind_n = behind_n[: after - before - 1 + int(small[0])]
        errors[before + 1 : before + 1 + len(behind_n)] = behind_n
    return errors


def _reversals(p: Prepared) -> tuple[list[int], list[int]]:
    """Indices of the last sample before, and of the first sample after, each reversal.

    Only reversals without a rest in between are included.
    """
    motion = p.motion
    directed = np.flatnonzero(motion.sign_known & ~motion.resting & (motion.velocity != 0.0))
    turned = np.flatnonzero(np.diff(np.sign(motion.velocity[directed])) != 0.0)
    befores, afters = directed[turned], directed[turned + 1]
    rests = np.concatenate(([0], np.cumsum(motion.resting)))
    moving = rests[afters] == rests[befores]
    return befores[moving].tolist(), afters[moving].tolist()
