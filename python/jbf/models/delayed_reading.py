"""Readings of a force with a time delay, from the signal chain at earlier instants.

The motion is smooth, but the force has jumps. The delay is therefore applied to the instants at
which the chain is evaluated, which is exact; interpolation of the force is not. Due to the errors
of the delay and of the instant of a reversal, a sample close to the reversal may precede or follow
the jump. The expected value is the mean of both readings, weighted by their probabilities.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.models.chain import chain
from jbf.models.driven import Driven, DrivenChain
from jbf.models.driven_motion import reversals, with_instants
from jbf.models.vocabulary import Clock
from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.rig import Rig
from jbf.records.run import Run

DELAY = "time_delay"
TAU = "time_delay.tau_s"
DRIFT = "sensor_drift.d"
JUMP_MARGIN = 1e-3
"""Distance from a jump at which the force is evaluated on both sides, as a fraction of a step."""


@dataclass(frozen=True)
class DelayedReading:
    """Readings of a delayed force; all arrays of shape (n,).

    Attributes
    ----------
    before_n, after_n
        Readings before and after the nearest jump, N; equal if no jump is near.
    over
        Probability that the jump has occurred.
    """

    before_n: Array
    after_n: Array
    over: Array

    @property
    def mean_n(self) -> Array:
        """Expected value of the reading, N, shape (n,)."""
        return self.over * self.after_n + (1.0 - self.over) * self.before_n


class DelayedChain:
    """Signal chain whose friction is recorded with a time delay.

    The chain is evaluated without the delay, at shifted instants.

    Parameters
    ----------
    effects
        Names of the effects, including `time_delay`.
    names
        Names of the parameters, in the order in which their values are passed.
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
        self, values: Array, run: Run, instants_s: Array, motion: EstimatedMotion, sd_s: float
    ) -> DelayedReading:
        """Compute the delayed readings of a run.

        Parameters
        ----------
        values
            Parameter values, including that of the delay.
        instants_s, motion
            The motion, and the instants at which it was sampled, s.
        sd_s
            Standard error of the delay, s.
        """
        # Imported here because a model without a delay does not need scipy.
        from scipy.special import ndtr

        tau_s = float(values[self.tau])
        # Before the run, the force is assumed to equal that at its start.
        read_s = np.maximum(run.time_s - tau_s, instants_s[0])
        read_instants = np.unique(np.append(read_s, instants_s[0]))
        delayed_run = run.at(read_instants, np.zeros(len(read_instants)))
        moved = motion.at(instants_s, read_instants)
        turns = reversals(read_instants, moved)
        step = np.diff(read_instants)[turns.interval] if len(turns.at_s) else np.zeros(0)
        sides = np.concatenate([turns.at_s - JUMP_MARGIN * step, turns.at_s + JUMP_MARGIN * step])
        all_instants, driven = with_instants(self.rig, delayed_run, moved, sides)
        force = self.chain.predict(values[self.kept], [Driven(driven.motion)])[0]
        reading = force[np.searchsorted(all_instants, read_s)]
        if self.drift is not None:
            # The sensor drifts with the time of the record, after the delay.
            reading = reading + values[self.drift] * tau_s
        before, after, over = reading, reading, np.ones(len(reading))
        if len(turns.at_s):
            low, high = np.split(np.interp(sides, all_instants, force), 2)
            nearest = _nearest(turns.at_s, read_s)
            since_s = read_s - turns.at_s[nearest]
            jump = (high - low)[nearest]
            before = reading - np.where(since_s > 0.0, jump, 0.0)
            after = before + jump
            over = ndtr(since_s / np.maximum(np.hypot(turns.sd_s[nearest], sd_s), 1e-12))
        return DelayedReading(before, after, over)


def _nearest(places: Array, instants: Array) -> npt.NDArray[np.intp]:
    """Index of the nearest of the sorted `places` for each of the `instants`."""
    middles = 0.5 * (places[1:] + places[:-1])
    return np.searchsorted(middles, instants)
