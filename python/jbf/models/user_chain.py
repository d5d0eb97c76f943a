"""Signal chain of the core, extended by user-defined effects or a user-defined law.

The instrument measures the sum of the bearing force and a user-defined force. If the effects of the
instrument are linear in the force, the responses to both forces are added. If an effect is
nonlinear (`NONLINEAR_EFFECTS`), the forces are added before the instrument. A user-defined law is
treated likewise: the effects then belong to a chain of the core whose law is held at nearly zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from jbf import _core
from jbf.arrays import Array
from jbf.models.user_effects import UserEffect

NONLINEAR_EFFECTS = ("sensor_hysteresis", "sensor_nonlinearity")
"""Nonlinear effects of the instrument, for which superposition does not hold."""
DIFFERENCE_STEP = 1e-6
"""Step of a directional difference quotient, as a fraction of the largest force."""


Read = tuple[Array, Array]
"""Reading of the instrument, and its derivatives by the instrument parameters, (n, parameters)."""


class UserChain:
    """Signal chain with user-defined effects or law, and with the interface of `_core.Chain`.

    Parameters
    ----------
    core
        The chain of the core, without user-defined effects.
    instrument
        Names of the effects of the instrument in `core`, each with the indices of its parameters.
    own
        The user-defined effects; their parameters follow those of the core.
    law
        A user-defined law; its parameters come first, and those of the law of the core are omitted.
    held
        Parameter values of the law of `core`, if there is a user-defined law.
    carrier
        The chain of the law of `core` without effects, if there is a user-defined law.
    bare
        The chain of the core without the instrument, if the instrument has an effect of
        `NONLINEAR_EFFECTS`.
    """

    def __init__(
        self,
        core: _core.Chain,
        instrument: Sequence[tuple[str, Sequence[int]]],
        effects: Sequence[UserEffect],
        law: UserEffect | None = None,
        carrier_values: Sequence[float] = (),
        carrier: _core.Chain | None = None,
        bare: _core.Chain | None = None,
    ) -> None:
        self.bare = bare
        self.core, self.instrument, self.carrier = core, list(instrument), carrier
        self.carrier_values = np.array(carrier_values, dtype=np.float64)
        first = 0 if law is None else len(law.parameters)
        rest = len(core.parameter_names) - len(carrier_values)
        self.of_core = range(first, first + rest)
        ends = np.cumsum([first + rest, *(len(e.parameters) for e in effects)]).tolist()
        self.user_forces = [*effects] if law is None else [law, *effects]
        self.places = [range(a, b) for a, b in pairwise(ends)]
        if law is not None:
            self.places.insert(0, range(first))
        self.law = law

    @property
    def parameter_names(self) -> list[str]:
        """Dotted names of the parameters, in the order of `parameters`."""
        first = [] if self.law is None else [p.name for p in self.law.parameters]
        effects = self.user_forces if self.law is None else self.user_forces[1:]
        theirs = [f"{e.name}.{p.name}" for e in effects for p in e.parameters]
        return [*first, *self.core.parameter_names[len(self.carrier_values) :], *theirs]

    def predict(self, parameters: Array, motions: Sequence[_core.Motion]) -> list[Array]:
        """Friction readings, N, one array per run."""
        inner = self.core.predict(self._inner(parameters), motions)
        return [
            f + self._user_contribution(parameters, m)[0]
            for f, m in zip(inner, motions, strict=True)
        ]

    def film_rate_1_s(self, parameters: Array, motions: Sequence[_core.Motion]) -> float:
        """Largest relaxation rate of the film along these motions, 1/s."""
        return self.core.film_rate_1_s(self._inner(parameters), motions)

    def inner_steps(self, parameters: Array, motions: Sequence[_core.Motion]) -> float:
        """Number of integration steps of a prediction along these motions."""
        return self.core.inner_steps(self._inner(parameters), motions)

    def jacobian(
        self, parameters: Array, motions: Sequence[_core.Motion], which: Sequence[int]
    ) -> list[tuple[Array, Array]]:
        """Friction readings, and their derivatives with respect to the parameters `which`."""
        of_core = [w for w in which if w in self.of_core]
        shift = len(self.carrier_values) - self.of_core.start
        inner = [w + shift for w in of_core]
        rows = self.core.jacobian(self._inner(parameters), motions, inner)
        results = []
        for (values, slopes), motion in zip(rows, motions, strict=True):
            added, by_instrument = self._user_contribution(parameters, motion)
            bent = self._derivative_changes(parameters, motion, of_core)
            derivatives = np.empty((len(values), len(which)))
            for k, w in enumerate(which):
                if w in self.of_core:
                    derivatives[:, k] = slopes[:, of_core.index(w)] + by_instrument.get(w, 0.0)
                    derivatives[:, k] += bent.get(w, 0.0)
                else:
                    derivatives[:, k] = self._slope(parameters, motion, w)
            results.append((values + added, derivatives))
        return results

    def _inner(self, parameters: Array) -> Array:
        part = parameters[self.of_core.start : self.of_core.stop]
        return np.ascontiguousarray(np.concatenate((self.carrier_values, part)))

    def _values(self, parameters: Array, number: int) -> list[float]:
        values: list[float] = parameters[self.places[number]].tolist()
        return values

    def _user_contribution(
        self, parameters: Array, motion: _core.Motion
    ) -> tuple[Array, dict[int, Array]]:
        """Contribution of the user-defined effects to the reading of the instrument.

        Its derivatives with respect to the instrument parameters are returned too, by index.
        """
        before, after = self._user_forces(parameters, motion)
        if not self.instrument:
            return before + after, {}
        loaded, empty = self._read(parameters, motion, before)
        order = [place for _, places in self.instrument for place in places]
        slopes = loaded[1] - empty[1]
        by_place = {place: slopes[:, k] for k, place in enumerate(order)}
        return loaded[0] - empty[0] + after, by_place

    def _user_forces(self, parameters: Array, motion: _core.Motion) -> tuple[Array, Array]:
        """Forces of the user-defined effects before and after the instrument, N."""
        n = len(motion.columns["time_s"])
        before, after = np.zeros(n), np.zeros(n)
        for i, effect in enumerate(self.user_forces):
            force = effect.force(motion.columns, self._values(parameters, i))
            if effect.stage == "instrument":
                after += force
            else:
                before += force
        if self.law is not None:
            # Subtract the small force of the built-in law, whose parameters are at their bounds.
            assert self.carrier is not None
            before -= self.carrier.predict(self.carrier_values, [motion])[0]
        return before, after

    def _slope(self, parameters: Array, motion: _core.Motion, place: int) -> Array:
        number = next(i for i, places in enumerate(self.places) if place in places)
        effect, first = self.user_forces[number], self.places[number][0]
        slope = effect.slope(motion.columns, self._values(parameters, number), place - first)
        if effect.stage == "instrument" or not self.instrument:
            return slope
        if self.bare is None:
            loaded, empty = self._read(parameters, motion, slope)
            return loaded[0] - empty[0]
        added, _ = self._user_forces(parameters, motion)
        return self._directional_derivative(
            parameters, motion, self._bearing_force(parameters, motion) + added, slope
        )

    def _read(self, parameters: Array, motion: _core.Motion, force: Array) -> tuple[Read, Read]:
        """Instrument readings of the bearing force with and without an additional force.

        The bearing force is set to zero if the instrument is linear.
        """
        borne = self._bearing_force(parameters, motion)
        return (
            self._instrument_reading(parameters, motion, borne + force),
            self._instrument_reading(parameters, motion, borne),
        )

    def _instrument_reading(self, parameters: Array, motion: _core.Motion, force: Array) -> Read:
        """Instrument reading of a force, and its derivatives by the instrument parameters."""
        effects = [(name, parameters[list(places)].tolist()) for name, places in self.instrument]
        time = np.ascontiguousarray(motion.columns["time_s"])
        return _core.read_force(effects, time, np.ascontiguousarray(force))

    def _bearing_force(self, parameters: Array, motion: _core.Motion) -> Array:
        """Force of the bearing, N, if the instrument is nonlinear; otherwise zeros."""
        if self.bare is None:
            return np.zeros(len(motion.columns["time_s"]))
        force: Array = self.bare.predict(self._before_instrument(parameters), [motion])[0]
        return force

    def _before_instrument(self, parameters: Array) -> Array:
        """Parameters of the core's chain without those of the instrument."""
        instrument = {place for _, places in self.instrument for place in places}
        before = [place for place in self.of_core if place not in instrument]
        return np.ascontiguousarray(np.concatenate((self.carrier_values, parameters[before])))

    def _directional_derivative(
        self, parameters: Array, motion: _core.Motion, force: Array, slope: Array
    ) -> Array:
        """Derivative of the reading for a change of the force along `slope`."""
        largest = float(np.max(np.abs(slope)))
        if largest == 0.0:
            return slope
        step = DIFFERENCE_STEP * max(float(np.max(np.abs(force))), 1e-9) / largest
        above, below = (
            self._instrument_reading(parameters, motion, force + sign * step * slope)[0]
            for sign in (1, -1)
        )
        derivative: Array = (above - below) / (2.0 * step)
        return derivative

    def _derivative_changes(
        self, parameters: Array, motion: _core.Motion, which: Sequence[int]
    ) -> dict[int, Array]:
        """Changes of the derivatives by core parameters due to the user-defined forces.

        The result is empty for a linear instrument.
        """
        if self.bare is None:
            return {}
        instrument = {place for _, places in self.instrument for place in places}
        core_places = [place for place in self.of_core if place not in instrument]
        of_machine = [w for w in which if w not in instrument]
        columns = [len(self.carrier_values) + core_places.index(w) for w in of_machine]
        before = self._before_instrument(parameters)
        ((borne, slopes),) = self.bare.jacobian(before, [motion], columns)
        added, _ = self._user_forces(parameters, motion)
        changes = {}
        for k, w in enumerate(of_machine):
            bent_derivative = self._directional_derivative(
                parameters, motion, borne + added, slopes[:, k]
            )
            changes[w] = bent_derivative - self._directional_derivative(
                parameters, motion, borne, slopes[:, k]
            )
        return changes
