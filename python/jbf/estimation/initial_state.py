"""Initial-state transient: how long a model remembers the unrecorded state at the start of a run.

A film, the age of a contact, a contact that deflects, and a load cell with backlash start a run in
an unknown state. The state is forgotten as the shaft moves, or as the force reverses. The model
gives the duration: two simulations of a run that start from opposite states differ as long as the
state is remembered.
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
    """A part of the model with an unknown state at the start of a run.

    Attributes
    ----------
    speeds
        Speeds of motions before a run that lead to different states, as fractions of its top speed.
    longer
        Factor on the duration of the difference that is excluded.
    most, most_of_all
        Largest excluded fraction of a run, and of a campaign.
    """

    speeds: tuple[float, ...]
    longer: float
    most: float
    most_of_all: float = 1.0


def memories(
    law: str, effects: Iterable[str], settings: TransientSettings = DEFAULT.transient
) -> list[Memory]:
    """Return the parts of a law and its effects that remember the initial state of a run."""
    page, s = find_law(law), settings
    by_speed = page.has_memory and not page.has_bristle
    if has_unknown_start(effects):
        # A film that builds up or breaks down pushes the load cell in one direction or the other.
        speeds = (*(s.film_speeds if by_speed else ()), *s.contact_speeds)
        return [Memory(speeds, s.contact_margin, np.inf, s.max_share_backlash)]
    if page.has_bristle:
        return [Memory(s.contact_speeds, s.contact_margin, s.max_share_contact)]
    return [Memory(s.film_speeds, s.film_margin, s.max_share_film)] if by_speed else []


def has_unknown_start(effects: Iterable[str]) -> bool:
    """Whether one of the effects has an unknown initial state of its own."""
    return any(find_effect(name).unknown_start for name in effects)


def remembering(
    chain: DrivenChain,
    values: Array,
    prepared: Sequence[Prepared],
    which: Memory,
    noise_rms: float,
    settings: TransientSettings = DEFAULT.transient,
) -> list[Mask]:
    """Mask of the samples at which a run still remembers its initial state, one a run.

    Parameters
    ----------
    values
        Parameters of a model that fits roughly.
    noise_rms
        Noise on the friction, N.
    """
    # The motion used by the fit has starts between samples and would differ at each stop.
    begun = []
    for share in which.speeds:
        motions = [
            core_motion(p.rig, p.run, p.motion, (share, settings.before_s)) for p in prepared
        ]
        begun.append(chain.predict(values, motions))
    spreads = [np.ptp(np.array(ways), axis=0) for ways in zip(*begun, strict=True)]
    found = [
        _remembered(p, spread > settings.max_difference * noise_rms, which)
        for p, spread in zip(prepared, spreads, strict=True)
    ]
    gone, whole = sum(int(f.sum()) for f in found), sum(f.size for f in found)
    if gone > which.most_of_all * whole:
        return [np.zeros(f.size, dtype=bool) for f in found]
    return found


def _remembered(p: Prepared, apart: Mask, which: Memory) -> Mask:
    """Mask of the first interval in which two initial states differ, extended for safety."""
    index = np.flatnonzero(apart)
    if not len(index):
        return np.zeros(len(apart), dtype=bool)
    time = p.run.time_s
    until = time[index[0]] + which.longer * (time[index[-1]] - time[index[0]])
    # Samples before the motion (a rest) do not depend on the initial state.
    mask: Mask = (time >= time[index[0]]) & (time <= until)
    return mask if mask.mean() < which.most else np.zeros(len(apart), dtype=bool)
