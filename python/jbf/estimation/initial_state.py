"""Initial-state transient: duration of the influence of the unrecorded state at the start of a run.

A film, the age of a contact, a contact that deflects, and a load cell with backlash have an unknown
state at the start of a run. The influence of this state decays as the shaft moves, or ends as the
force reverses. Its duration is the time during which two simulations of the run from opposite
initial states differ.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared
from jbf.estimation.settings import DEFAULT, TransientSettings
from jbf.models.catalogue import find_effect, find_law
from jbf.models.chain import core_motion
from jbf.models.driven import DrivenChain

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Memory:
    """Simulated motions and limits that determine the initial-state transient of a model.

    Attributes
    ----------
    speeds
        Speeds of motions before a run that lead to different states, as fractions of its top speed.
    margin
        Factor on the duration of the difference, for the excluded duration.
    max_run_share, max_campaign_share
        Largest excluded fraction of a run, and of a campaign.
    """

    speeds: tuple[float, ...]
    margin: float
    max_run_share: float
    max_campaign_share: float = 1.0


def initial_memory(
    law: str, effects: Iterable[str], settings: TransientSettings = DEFAULT.transient
) -> Memory | None:
    """Return the transient settings for a law with effects; None if they have no initial state."""
    page, s = find_law(law), settings
    by_speed = page.has_memory and not page.has_bristle
    if has_unknown_start(effects):
        # The initial state of a film determines the side of the backlash on which the load cell is.
        speeds = (*(s.film_speeds if by_speed else ()), *s.contact_speeds)
        return Memory(speeds, s.contact_margin, np.inf, s.max_share_backlash)
    if page.has_bristle:
        return Memory(s.contact_speeds, s.contact_margin, s.max_share_contact)
    return Memory(s.film_speeds, s.film_margin, s.max_share_film) if by_speed else None


def has_unknown_start(effects: Iterable[str]) -> bool:
    """Whether at least one of the effects has an unknown initial state."""
    return any(find_effect(name).unknown_start for name in effects)


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
    for share in memory.speeds:
        motions = [
            core_motion(p.rig, p.run, p.motion, (share, settings.before_s)) for p in prepared
        ]
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
    """Mask of the first interval in which two simulations differ, extended by a margin."""
    index = np.flatnonzero(differs)
    if not len(index):
        return np.zeros(len(differs), dtype=bool)
    time = p.run.time_s
    until = time[index[0]] + memory.margin * (time[index[-1]] - time[index[0]])
    # Samples before the motion (a rest) do not depend on the initial state.
    mask: Mask = (time >= time[index[0]]) & (time <= until)
    return mask if mask.mean() < memory.max_run_share else np.zeros(len(differs), dtype=bool)
