"""Samples at which a prediction is uncertain: next to a friction jump, and at the start of a run.

Friction jumps at a reversal of the motion. The record does not determine the sign of the samples
there, and these samples are excluded (`Samples`). An effect that shifts the jump in time (a delay
or backlash) also shifts the uncertain samples. The model then has a ramp over one sampling interval
where the record has a jump within the interval. The prediction error is about half of the change
over the interval. It reduces the weight of the sample in a fit, and tests exclude the sample.

If an effect spreads a jump over time, more samples are affected by the error of the jump's time.
This error is the standard error of the speed divided by the acceleration. The prediction error, N,
is the change of the reading during the error of the time. It reduces the weights of the samples in
a fit. Tests exclude samples for which it is a large part of the noise.

Without a bearing, the force at rest is unknown and may change at any time. If an effect spreads a
jump, the readings after a rest contain this force. They are excluded while the largest force of the
run, decreasing with the time constant of the effect, is a large part of the noise.

A film, the age of a contact, a contact that deflects, and a load cell with backlash have an unknown
state at the start of a run. The influence of this state (initial-state transient) decays as the
shaft moves, or ends as the force reverses. Its duration is the time during which simulations of the
run from different initial states differ.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jbf.arrays import Array, Mask
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.estimation.settings import DEFAULT, JumpSettings, TransientSettings
from jbf.models.catalogue import Parameter, find_effect, find_law
from jbf.models.chain import MotionBefore, core_motion
from jbf.models.driven import DrivenChain

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
    spread_s: float = 0.0,
) -> Samples:
    """Reduce the weights of samples at which the time of a predicted friction jump is uncertain.

    The weights are unchanged if the effects neither shift nor spread jumps. The effects must not be
    at their null. `spread_s` is the time constant with which they spread a jump (`time_constant`).
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
            least_n = settings.max_timing_error * noise_rms
            error_n = timing_errors(p, prediction, least_n)
            error_n = np.where(after_rests(p, spread_s, least_n), np.inf, error_n)
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


def timing_error_is_small(p: Prepared, residual: Array, max_error_n: float) -> Mask:
    """Mask of the samples at which the timing error changes a prediction by little.

    The change is at most `max_error_n`, N. The timing error is that of the time stamps and of the
    motion: the standard error of the speed divided by the acceleration, at most that of a uniform
    instant between two samples. `residual` is record minus prediction. Shape (n,).
    """
    motion, smoothed = p.motion, None if p.motion.errors is None else p.motion.errors.smoothed
    stamp_s = 0.0 if smoothed is None else float(np.sqrt(smoothed.errors.stamp_variance))
    with np.errstate(divide="ignore", invalid="ignore"):
        of_motion_s = motion.velocity_error_m_s / np.abs(motion.acceleration)
    of_motion_s = np.minimum(np.nan_to_num(of_motion_s), MOST * p.step_s)
    rate_n_s = np.gradient(p.friction - residual, p.run.time_s)
    mask: Mask = np.hypot(stamp_s, of_motion_s) * np.abs(rate_n_s) <= max_error_n
    return mask


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


def after_rests(p: Prepared, spread_s: float, least_n: float) -> Mask:
    """Mask, shape (n,), of the samples that contain the unknown force at a rest.

    The largest force of the run, decreasing from the end of the rest with the time constant
    `spread_s`, is above `least_n` at these samples. None for a bearing.
    """
    resting, time_s = p.motion.resting, p.run.time_s
    if p.rig.bearing is not None or not np.any(resting):
        return np.zeros(len(resting), dtype=bool)
    largest_n = float(np.max(np.abs(p.friction)))
    memory_s = spread_s * float(np.log(max(largest_n / max(least_n, 1e-300), 1.0)))
    last_rest_s = np.maximum.accumulate(np.where(resting, time_s, -np.inf))
    mask: Mask = time_s - last_rest_s <= memory_s
    return mask


def time_constant(
    effects: Iterable[str], pages: Mapping[str, Parameter], values: Iterable[float]
) -> float:
    """Time constant with which the effects spread a friction jump, s.

    `pages` and `values` are in the same order, that of the parameters' full names.
    """
    spreading = {name for name in effects if find_effect(name).spreads_jumps}
    return sum(
        value
        for (name, page), value in zip(pages.items(), values, strict=True)
        if name.partition(".")[0] in spreading and page.unit == "s"
    )


@dataclass(frozen=True)
class Memory:
    """Simulated motions and limits that determine the initial-state transient of a model.

    Attributes
    ----------
    motions
        Motions before a run that lead to different states.
    margin
        Factor on the duration of the difference, for the excluded duration.
    max_run_share, max_campaign_share
        Largest excluded fraction of a run, and of a campaign.
    """

    motions: tuple[MotionBefore, ...]
    margin: float
    max_run_share: float
    max_campaign_share: float = 1.0


def initial_memories(
    law: str, effects: Iterable[str], settings: TransientSettings = DEFAULT.transient
) -> list[Memory]:
    """Return the transient settings for each kind of unknown initial state of a law with effects.

    The list is empty if they have no unknown initial state.
    """
    page, s, effects = find_law(law), settings, tuple(effects)
    films = tuple(MotionBefore(share, s.before_s) for share in s.film_speeds)
    # Before its first motion, a contact may have moved, or rested for longer than recorded.
    contacts = tuple(
        MotionBefore(share, s.before_s, replaces_rest=share != 0.0) for share in s.contact_speeds
    )
    by_film = page.has_memory and not page.has_bristle
    memories = [Memory(films, s.film_margin, s.max_share_film)] if by_film else []
    if page.has_bristle:
        memories.append(Memory(contacts, s.contact_margin, s.max_share_contact))
    if has_state_erased_by_sliding(effects):
        memories.append(Memory(contacts, s.contact_margin, s.max_share_sliding))
    if has_unknown_start(effects):
        # The initial state of a film determines the side of the backlash on which the load cell is.
        motions = (*(films if by_film else ()), *contacts)
        memories.append(Memory(motions, s.contact_margin, np.inf, s.max_share_backlash))
    return memories


def has_unknown_start(effects: Iterable[str]) -> bool:
    """Whether a reversal is needed to erase the initial state of at least one of the effects."""
    return any(find_effect(name).unknown_start for name in effects)


def has_state_erased_by_sliding(effects: Iterable[str]) -> bool:
    """Whether sliding erases an unknown initial state of at least one of the effects."""
    return any(find_effect(name).erased_by_sliding for name in effects)


def transient_masks(
    chain: DrivenChain,
    values: Array,
    prepared: Sequence[Prepared],
    memory: Memory,
    noise_rms: float,
    settings: TransientSettings = DEFAULT.transient,
) -> list[Mask]:
    """Mask of the samples that depend on the initial state of their run, one mask per run.

    The parameter values are those of an approximate fit; `noise_rms` is the noise on the friction,
    N.
    """
    # The motion used by the fit has starts between samples and would differ at each stop.
    predictions = []
    for before in memory.motions:
        motions = [core_motion(p.rig, p.run, p.motion, before) for p in prepared]
        predictions.append(chain.predict(values, motions))
    spreads = [np.ptp(np.array(by_speed), axis=0) for by_speed in zip(*predictions, strict=True)]
    masks = [
        _transient_mask(p, spread > settings.max_difference * noise_rms, memory)
        for p, spread in zip(prepared, spreads, strict=True)
    ]
    excluded, total = sum(int(m.sum()) for m in masks), sum(m.size for m in masks)
    if excluded > memory.max_campaign_share * total:
        return [np.zeros(m.size, dtype=bool) for m in masks]
    return masks


def _transient_mask(p: Prepared, differs: Mask, memory: Memory) -> Mask:
    """Mask from the first to the last sample at which simulations differ, with a margin."""
    # Samples at rest do not depend on the initial state.
    index = np.flatnonzero(differs & ~p.motion.resting)
    if not len(index):
        return np.zeros(len(differs), dtype=bool)
    time = p.run.time_s
    until = time[index[0]] + memory.margin * (time[index[-1]] - time[index[0]])
    mask: Mask = (time >= time[index[0]]) & (time <= until)
    return mask if mask.mean() <= memory.max_run_share else np.zeros(len(differs), dtype=bool)
