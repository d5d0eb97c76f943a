"""The core's chain with effects, or a law, of one's own beside it.

A force beside the bearing's passes through the instrument, whose effects are linear in the force:
what they make of the bearing's force and of this one adds up. So does a law of one's own: the
core's chain then carries the effects, round a law that is held at next to nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.models.own_effects import OwnEffect

Array = npt.NDArray[np.float64]


class OwnChain:
    """As `_core.Chain`, with effects of one's own after the catalogue's.

    Parameters
    ----------
    core
        The chain without them.
    instrument
        Names of the instrument's effects in it, each with the places of its parameters.
    own
        The effects of one's own; their parameters follow those of the core.
    law
        A law of one's own; its parameters come first, and the core's law has none.
    held
        What the parameters of the core's law are held at, where there is a law of one's own.
    carrier
        The core's law alone, then.
    """

    def __init__(
        self,
        core: _core.Chain,
        instrument: Sequence[tuple[str, Sequence[int]]],
        own: Sequence[OwnEffect],
        law: OwnEffect | None = None,
        held: Sequence[float] = (),
        carrier: _core.Chain | None = None,
    ) -> None:
        self.core, self.instrument, self.carrier = core, list(instrument), carrier
        self.held = np.array(held, dtype=np.float64)
        first = 0 if law is None else len(law.parameters)
        rest = len(core.parameter_names) - len(held)
        self.of_core = range(first, first + rest)
        ends = np.cumsum([first + rest, *(len(e.parameters) for e in own)]).tolist()
        self.own = [*own] if law is None else [law, *own]
        self.places = [range(a, b) for a, b in pairwise(ends)]
        if law is not None:
            self.places.insert(0, range(first))
        self.law = law

    @property
    def parameter_names(self) -> list[str]:
        """Dotted names of the parameters, in the order of every array here."""
        first = [] if self.law is None else [p.name for p in self.law.parameters]
        effects = self.own if self.law is None else self.own[1:]
        theirs = [f"{e.name}.{p.name}" for e in effects for p in e.parameters]
        return [*first, *self.core.parameter_names[len(self.held) :], *theirs]

    def predict(self, parameters: Array, motions: Sequence[_core.Motion]) -> list[Array]:
        """Friction readings, N, one array a run."""
        inner = self.core.predict(self._inner(parameters), motions)
        return [f + self._added(parameters, m)[0] for f, m in zip(inner, motions, strict=True)]

    def film_rate_1_s(self, parameters: Array, motions: Sequence[_core.Motion]) -> float:
        """Fastest rate of the law's film, 1/s."""
        return self.core.film_rate_1_s(self._inner(parameters), motions)

    def jacobian(
        self, parameters: Array, motions: Sequence[_core.Motion], which: Sequence[int]
    ) -> list[tuple[Array, Array]]:
        """Readings and their derivatives by the parameters `which`."""
        of_core = [w for w in which if w in self.of_core]
        shift = len(self.held) - self.of_core.start
        inner = [w + shift for w in of_core]
        rows = self.core.jacobian(self._inner(parameters), motions, inner)
        found = []
        for (values, slopes), motion in zip(rows, motions, strict=True):
            added, by_instrument = self._added(parameters, motion)
            whole = np.empty((len(values), len(which)))
            for k, w in enumerate(which):
                if w in self.of_core:
                    whole[:, k] = slopes[:, of_core.index(w)] + by_instrument.get(w, 0.0)
                else:
                    whole[:, k] = self._slope(parameters, motion, w)
            found.append((values + added, whole))
        return found

    def _inner(self, parameters: Array) -> Array:
        part = parameters[self.of_core.start : self.of_core.stop]
        return np.ascontiguousarray(np.concatenate((self.held, part)))

    def _values(self, parameters: Array, number: int) -> list[float]:
        found: list[float] = parameters[self.places[number]].tolist()
        return found

    def _added(self, parameters: Array, motion: _core.Motion) -> tuple[Array, dict[int, Array]]:
        """What one's own effects add to the reading, and how that hangs on the instrument."""
        n = len(motion.columns["time_s"])
        beside, beyond = np.zeros(n), np.zeros(n)
        for i, effect in enumerate(self.own):
            force = effect.force(motion.columns, self._values(parameters, i))
            if effect.stage == "instrument":
                beyond += force
            else:
                beside += force
        if self.law is not None:
            # What the core's law has at its bounds is not the law's.
            assert self.carrier is not None
            beside -= self.carrier.predict(self.held, [motion])[0]
        read, slopes = self._read(parameters, motion, beside)
        return read + beyond, slopes

    def _slope(self, parameters: Array, motion: _core.Motion, place: int) -> Array:
        number = next(i for i, places in enumerate(self.places) if place in places)
        effect, first = self.own[number], self.places[number][0]
        slope = effect.slope(motion.columns, self._values(parameters, number), place - first)
        return slope if effect.stage == "instrument" else self._read(parameters, motion, slope)[0]

    def _read(
        self, parameters: Array, motion: _core.Motion, force: Array
    ) -> tuple[Array, dict[int, Array]]:
        """The part of a reading that goes with the force, and its derivatives by place."""
        if not self.instrument:
            return force, {}
        effects = [(name, parameters[list(places)].tolist()) for name, places in self.instrument]
        time = np.ascontiguousarray(motion.columns["time_s"])
        loaded = _core.read_force(effects, time, np.ascontiguousarray(force))
        empty = _core.read_force(effects, time, np.zeros_like(time))
        order = [place for _, places in self.instrument for place in places]
        slopes = loaded[1] - empty[1]
        return loaded[0] - empty[0], {place: slopes[:, k] for k, place in enumerate(order)}
