"""The state in which a run began, where no record tells it, and how long a model remembers it.

A film, a contact that bends, and a cell with play begin a run in a state that nobody wrote down. It
is forgotten as the shaft moves, or as the force turns round. How soon, the model says: runs of it
that begin in opposite states differ by what is still remembered.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared
from jbf.models.catalogue import find_effect, find_law
from jbf.models.chain import core_motion
from jbf.models.driven import DrivenChain

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

REMEMBERED = 0.2
"""Share of the noise below which a difference is forgotten."""
MOST_OF_A_RUN = 0.5
"""A run that never forgets its beginning is taken as it is: one of a film,"""
MOST_OF_A_STROKE = 0.75
"""and one of a contact, which may be a single stroke, half of it to bend."""
MOST_OF_ALL = 0.5
"""Share of a campaign that may go with cells in their play: a run whose force never turns round
tells nothing of which way its cell was pushed before, and goes whole where others remain."""
BEFORE_S = 6.0
"""How long the imagined motions before a run last."""
SPEEDS = (1e-3, 0.1, 1.0)
"""Their speeds, as shares of the run's top speed: where a film was,"""
WAYS = (-1.0, 1.0)
"""and where a contact bends or a cell has play, which the force may have reached either way."""
LONGER = 1.5
"""The film may be slower than this model's: what follows is set aside for so many times as long,"""
FURTHER = 1.1
"""and a contact softer, whose way to bend the records tell better."""


@dataclass(frozen=True)
class Memory:
    """What begins a run in a state that no record tells.

    Attributes
    ----------
    speeds
        Of motions before a run that each leave another state, as shares of its top speed.
    longer
        How many times as long as they differ is set aside,
    most, most_of_all
        of which share of a run, and of a campaign, at most.
    """

    speeds: tuple[float, ...]
    longer: float
    most: float
    most_of_all: float = 1.0


def memories(law: str, effects: Iterable[str]) -> list[Memory]:
    """What of a law and its effects remembers how a run began."""
    page = find_law(law)
    if begins_anywhere(effects):
        # A film that thickens or breaks down pushes the cell one way or the other.
        return [Memory((*(SPEEDS if page.has_film else ()), *WAYS), FURTHER, np.inf, MOST_OF_ALL)]
    film = [Memory(SPEEDS, LONGER, MOST_OF_A_RUN)] if page.has_film else []
    bent = [Memory(WAYS, FURTHER, MOST_OF_A_STROKE)] if page.has_bristle else []
    return film + bent


def begins_anywhere(effects: Iterable[str]) -> bool:
    """True where one of the effects begins a run in a state of its own."""
    return any(find_effect(name).unknown_start for name in effects)


def remembering(
    chain: DrivenChain, values: Array, prepared: Sequence[Prepared], which: Memory, noise_n: float
) -> list[Mask]:
    """True where a run still remembers how it began, one mask a run.

    Parameters
    ----------
    values
        Parameters of a model that fits roughly.
    noise_n
        Noise on the friction, N.
    """
    # The fit's own motion has starts between samples, these have not: it would differ at each stop.
    begun = []
    for share in which.speeds:
        motions = [core_motion(p.rig, p.run, p.motion, (share, BEFORE_S)) for p in prepared]
        begun.append(chain.predict(values, motions))
    spreads = [np.ptp(np.array(ways), axis=0) for ways in zip(*begun, strict=True)]
    found = [
        _remembered(p, spread > REMEMBERED * noise_n, which)
        for p, spread in zip(prepared, spreads, strict=True)
    ]
    gone, whole = sum(int(f.sum()) for f in found), sum(f.size for f in found)
    if gone > which.most_of_all * whole:
        return [np.zeros(f.size, dtype=bool) for f in found]
    return found


def _remembered(p: Prepared, apart: Mask, which: Memory) -> Mask:
    """The first stretch of motion in which two beginnings are apart, made longer for safety."""
    index = np.flatnonzero(apart)
    if not len(index):
        return np.zeros(len(apart), dtype=bool)
    time = p.run.time_s
    until = time[index[0]] + which.longer * (time[index[-1]] - time[index[0]])
    # What lies before the motion (a rest) does not depend on the start.
    mask: Mask = (time >= time[index[0]]) & (time <= until)
    return mask if mask.mean() < which.most else np.zeros(len(apart), dtype=bool)
