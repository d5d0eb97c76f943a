"""Friction model for predictions: a rig, a law, effects and their parameters."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from textwrap import shorten
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.arrays import Array
from jbf.errors import InputError, quoted
from jbf.models.catalogue import (
    find_clock,
    find_law,
    find_parameter,
    in_chain_order,
    parameters_of,
    vocabulary,
)
from jbf.models.chain import (
    chain,
    core_bearing,
    core_load_n,
    core_refusals,
    estimated_motion,
    sampled_motion,
    warn_of_fast_film,
)
from jbf.models.delayed_reading import TAU, DelayedChain
from jbf.models.driven_motion import driven_motion
from jbf.models.model_file import model_file_text, read_model_file
from jbf.models.parameter_units import units_of
from jbf.models.parameter_value import ParameterValue
from jbf.models.requirements import require_record
from jbf.models.user_laws import UserLaw
from jbf.models.vocabulary import Clock, ModelFile
from jbf.records.arguments import by_name, list_of_runs, numbers, of_kind, one_run
from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.rig import Rig
from jbf.records.run import PathLike, Run
from jbf.records.weight_angle import require_weight_angle
from jbf.results import Shown
from jbf.text_files import write_text

NONE: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True, init=False, repr=False)
class Model(Shown):
    """Friction model: a law with effects, for the prediction of readings.

    Parameters
    ----------
    rig
        Bearing, lubricant and load; `Rig()` is sufficient for a law in newtons.
    law
        Name of the base law (`jbf.laws()`).
    effects
        Names of effects, in any order; they act in the order of the signal chain.
    parameters
        Mapping of dotted names (`f_m`, `presliding.sigma`; the unit may be omitted) to values with
        or without standard errors. Missing parameters of the law take the starting value of the
        catalogue. Those of effects take their null value, or the starting value if they have no
        null.
    clock
        Definition of the time constant of the film: `journal` (tbar = t U_tr/R) or `thesis` (tbar =
        t/1 s, of Cohn (1998)).

    Raises
    ------
    InputError
        A name is unknown, a value is out of bounds, the rig lacks a section that the law needs, or
        an effect cannot be combined with the law.

    Examples
    --------
    >>> import numpy as np
    >>> parameters = {"F_c": 5.0, "F_v": 20.0, "sensor_offset.b": 0.5}
    >>> model = jbf.Model(jbf.Rig(), "coulomb", ["sensor_offset"], parameters)
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> run = jbf.Run.from_arrays(t, np.full(len(t), 0.1))
    >>> round(float(model.predict(run)[-1]), 3)
    7.5
    """

    rig: Rig
    law: str
    effects: tuple[str, ...]
    parameters: Mapping[str, ParameterValue]
    clock: Clock
    fit: Mapping[str, float | int | str]

    # Explicit constructor, because the arguments differ from the attributes: effects in any order,
    # plain numbers, parameter names without units.
    def __init__(
        self,
        rig: Rig,
        law: str = "journal",
        effects: Iterable[str] = (),
        parameters: Mapping[str, float | ParameterValue] = NONE,
        clock: Clock = "journal",
        fit: Mapping[str, float | int | str] = NONE,
    ) -> None:
        find_law(law)
        chosen = in_chain_order(effects)
        catalogue = parameters_of(law, chosen)
        given = {
            find_parameter(name, catalogue): _with_error(name, v)
            for name, v in by_name(parameters, "parameters").items()
        }
        values = {
            name: given.get(name, ParameterValue(p.starts[0] if p.null is None else p.null))
            for name, p in catalogue.items()
        }
        for name, value in (
            ("rig", rig),
            ("law", law),
            ("effects", chosen),
            ("parameters", values),
            ("clock", find_clock(clock)),
            ("fit", by_name(fit, "fit")),
        ):
            object.__setattr__(self, name, value)
        chain(rig, law, self.clock, chosen)
        vocabulary().check(self._file())

    def __repr__(self) -> str:
        sum_ = shorten(" + ".join([self.law, *self.effects]), 100, placeholder=" ...")
        named = ", ".join(
            f"{name} {'held at' if p.held else '='} {p.value:.5g}"
            for name, p in self.parameters.items()
        )
        return f"Model({sum_}; {shorten(named, 150, placeholder=' ...')})"

    @property
    def values(self) -> Array:
        """Parameter values in the order of the core, shape (k,)."""
        return np.array([p.value for p in self.parameters.values()])

    def predict(self, run: Run) -> Array:
        """Predict the friction reading of one bearing for the motion of a run, N, shape (n,).

        With `time_delay`, a sample close to a reversal is the weighted mean of the values before
        and after it. The weights follow from the errors of the instant of the reversal and of the
        delay.

        A :class:`jbf.FilmWarning` is issued if the rate of the film exceeds 28,000 1/s. The journal
        is then confined to the bearing clearance, and the predicted friction is not reliable.
        """
        return self.predict_many([one_run(run)])[0]

    def predict_many(self, runs: Iterable[Run]) -> list[Array]:
        """Predict the friction readings of several runs as `predict` does, on all cores."""
        runs = list_of_runs(runs)
        for run in runs:
            self.require_columns(run)
        motions = [
            driven_motion(self.rig, run, estimated_motion(self.rig, run, self.force_delay_s))
            for run in runs
        ]
        core = chain(self.rig, self.law, self.clock, self.effects)
        warn_of_fast_film(core, self.values, motions)
        with core_refusals():
            if self.delay is None:
                return core.predict(self.values, motions)
            return self.predict_late((run, *sampled_motion(self.rig, run)) for run in runs)

    @property
    def delay(self) -> ParameterValue | None:
        """Time delay of the recorded force, s; None without a delay."""
        tau = self.parameters.get(TAU)
        return None if tau is None or tau.value <= 0.0 else tau

    @property
    def force_delay_s(self) -> float:
        """Delay of the recorded force in a further run, s; zero if the fit found none.

        It is the delay that all fitted runs have in common, negative for an early force. It is a
        property of the logger: `predict` and :func:`jbf.compare` apply it to every run, exports do
        not. Delays that differ between runs are not predicted. See `delay` for the effect
        `time_delay`.
        """
        return float(self.fit.get("force_delay_s", 0.0))

    def predict_late(self, read: Iterable[tuple[Run, Array, EstimatedMotion]]) -> list[Array]:
        """Predict the readings of a force with time delay, N, one array per run.

        Parameters
        ----------
        read
            For each run: the run, the instants at which its motion was sampled, s, and the motion.
        """
        assert self.delay is not None
        sd_s = self.delay.stderr or 0.0
        delayed = DelayedChain(self.rig, self.law, self.clock, self.effects, list(self.parameters))
        return [delayed.read(self.values, *sample, sd_s).mean_n for sample in read]

    def require_columns(self, run: Run) -> None:
        """Raise an InputError if a run lacks a column that this model or its fit needs."""
        require_record(self.rig, run, self.effects)
        if "weight_acts_over" in self.fit:
            require_weight_angle(run, str(self.fit["weight_acts_over"]))

    def steady_friction(self, velocity: npt.ArrayLike) -> Array:
        """Steady friction force of the base law (the Stribeck curve), N.

        The speeds (m/s) have shape (n,), none of them zero. The load is that of the rig if the law
        needs one.
        """
        page = find_law(self.law)
        count = len(page.parameters)
        speeds = numbers(velocity, "velocity_m_s", flat=True)
        if isinstance(page, UserLaw):
            return page.steady_n(speeds, self.values[:count].tolist(), core_load_n(self.rig))
        with core_refusals():
            return _core.steady_friction(
                speeds,
                law=self.law,
                parameters=self.values[:count].tolist(),
                bearing=core_bearing(self.rig),
                load_n=core_load_n(self.rig),
            )

    def units_for_json(self) -> dict[str, dict[str, str]]:
        """Units of the rig's quantities, JSON-serialisable."""
        return {"units": self.rig.quantities.to_dict()}

    def parameters_for_json(
        self, parameters: Mapping[str, ParameterValue]
    ) -> dict[str, dict[str, float | str | bool | None]]:
        """Parameters with their `unit` (absent if dimensionless), JSON-serialisable."""
        units = units_of(self.law, self.effects, self.rig.quantities)
        return {name: p.to_dict() | {"unit": units[name]} for name, p in parameters.items()}

    def _file(self) -> ModelFile:
        return ModelFile(
            law=self.law,
            clock=self.clock,
            effects=self.effects,
            parameters=dict(self.parameters),
            rig=self.rig,
            fit=dict(self.fit),
        )

    def to_toml(self) -> str:
        """Text of the model file that `save` writes."""
        units = units_of(self.law, self.effects, self.rig.quantities)
        return model_file_text(self._file(), units)

    def save(self, path: PathLike) -> None:
        """Write the model as TOML; `Model.load` reads it back exactly."""
        write_text(path, self.to_toml())

    @classmethod
    def load(cls, path: PathLike) -> Model:
        """Read a model file.

        Raises
        ------
        InputError
            The message names the file, the key and the remedy.
        """
        file = read_model_file(path, vocabulary())
        try:
            clock = find_clock(file.clock)
            return cls(file.rig, file.law, file.effects, file.parameters, clock, file.fit)
        except InputError as error:
            raise error.within(file=path) from None


def the_model(given: object) -> Model:
    """Check that a value is a model and return it; raise an InputError otherwise."""
    remedy = "give a jbf.Model"
    if isinstance(given, str | os.PathLike):
        remedy = f"read it: jbf.Model.load({quoted(os.fspath(given))})"
    elif isinstance(getattr(given, "model", None), Model):
        remedy = "give its .model"
    return of_kind(given, Model, "the model", remedy)


def _with_error(name: str, value: float | ParameterValue) -> ParameterValue:
    """Convert a plain number to a ParameterValue; return a ParameterValue unchanged."""
    if isinstance(value, ParameterValue):
        return value
    try:
        return ParameterValue(value)
    except InputError as error:
        raise error.within(key_prefix=f"parameters.{name}.") from None
