"""A chain read at an earlier instant than it is recorded: the reading of a force that is late.

The motion is smooth and the force is not: a delay is exact where the time is shifted at which the
chain is read, and lines drawn through the force are not. A sample close to a reversal is read on
one side of it or on the other: on which one, the errors of the reversal's instant and of the delay
leave open. What is expected of it is the mean of both, and likely is either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.models.chain import chain
from jbf.models.driven import Driven, DrivenChain
from jbf.models.driven_motion import reversals, with_instants
from jbf.models.vocabulary import Clock
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.rig import Rig
from jbf.records.run import Run

Array = npt.NDArray[np.float64]

DELAY = "time_delay"
TAU = "time_delay.tau_s"
DRIFT = "sensor_drift.d_n_s"
BESIDE = 1e-3
"""Share of a step on either side of a jump at which the force is read."""


@dataclass(frozen=True)
class LateReading:
    """Readings of a late force; all arrays of shape (n,).

    Attributes
    ----------
    before_n, after_n
        Readings if the nearest jump was still to come, and if it was over, N; the same where none
        is near.
    over
        Probability that it was over.
    """

    before_n: Array
    after_n: Array
    over: Array

    @property
    def mean_n(self) -> Array:
        """What is expected, N."""
        return self.over * self.after_n + (1.0 - self.over) * self.before_n


class LateChain:
    """A law with effects whose friction is recorded late, without its delay.

    Parameters
    ----------
    effects
        `time_delay` among them.
    names
        Of the parameters, in the order in which their values will be given.
    """

    def __init__(
        self, rig: Rig, law: str, clock: Clock, effects: Sequence[str], names: Sequence[str]
    ) -> None:
        self.rig = rig
        self.chain: DrivenChain = chain(rig, law, clock, [e for e in effects if e != DELAY])
        self.kept = [i for i, name in enumerate(names) if name != TAU]
        self.tau = names.index(TAU)
        self.drift = names.index(DRIFT) if DRIFT in names else None

    def read(
        self, values: Array, run: Run, instants_s: Array, motion: ImposedMotion, sd_s: float
    ) -> LateReading:
        """The readings of a run.

        Parameters
        ----------
        values
            Parameter values, the delay's among them.
        instants_s, motion
            The motion, and the instants at which it was read.
        sd_s
            Standard error of the delay, s.
        """
        # Here, so that a model alone waits for no heavy import.
        from scipy.special import ndtr

        tau_s = float(values[self.tau])
        # Before the run the force is taken to have been what it is at its start.
        read_s = np.maximum(run.time_s - tau_s, instants_s[0])
        there = np.unique(np.append(read_s, instants_s[0]))
        late = run.at(there, np.zeros(len(there)))
        moved = motion.at(instants_s, there)
        turns = reversals(there, moved)
        step = np.diff(there)[turns.interval] if len(turns.at_s) else np.zeros(0)
        sides = np.concatenate([turns.at_s - BESIDE * step, turns.at_s + BESIDE * step])
        whole, driven = with_instants(self.rig, late, moved, sides)
        force = self.chain.predict(values[self.kept], [Driven(driven.motion)])[0]
        found = force[np.searchsorted(whole, read_s)]
        if self.drift is not None:
            # The cell drifts by its own clock, after the delay.
            found = found + values[self.drift] * tau_s
        before, after, over = found, found, np.ones(len(found))
        if len(turns.at_s):
            low, high = np.split(np.interp(sides, whole, force), 2)
            nearest = _nearest(turns.at_s, read_s)
            gone = read_s - turns.at_s[nearest]
            jump = (high - low)[nearest]
            before = found - np.where(gone > 0.0, jump, 0.0)
            after = before + jump
            over = ndtr(gone / np.maximum(np.hypot(turns.sd_s[nearest], sd_s), 1e-12))
        return LateReading(before, after, over)


def _nearest(places: Array, instants: Array) -> npt.NDArray[np.intp]:
    """The nearest of some places, in order, to each instant."""
    middles = 0.5 * (places[1:] + places[:-1])
    return np.searchsorted(middles, instants)
