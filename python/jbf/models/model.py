"""A model: a rig, a law, effects and their parameters. It predicts; it does not fit."""

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
    imposed,
    imposed_as_read,
    warn_of_fast_film,
)
from jbf.models.driven_motion import driven_motion
from jbf.models.late_reading import TAU, LateChain
from jbf.models.model_file import model_file_text, read_model_file, write_model_file
from jbf.models.own_laws import OwnLaw
from jbf.models.parameter_units import shown
from jbf.models.parameter_value import ParameterValue
from jbf.models.requirements import require_record
from jbf.models.vocabulary import Clock, ModelFile
from jbf.records.arguments import by_name, list_of_runs, numbers, of_kind, one_run
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.rig import Rig
from jbf.records.run import PathLike, Run
from jbf.results import Shown

Array = npt.NDArray[np.float64]
NONE: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True, init=False, repr=False)
class Model(Shown):
    """A law with effects, ready to predict.

    Parameters
    ----------
    rig
        Bearing, lubricant and load; `Rig()` will do for a law in newtons.
    law
        Name of the base law (`jbf.laws()`).
    effects
        Names of effects, in any order; they act in the order of the signal chain.
    parameters
        Dotted name (`f_m`, `presliding.sigma_1_m`; the unit may be left off) to a value, or to a
        value with its error. The law's missing ones take the catalogue's starting value; those
        of effects their null, or the starting value where they have none.
    clock
        `journal` (tbar = t U_tr/R) or `thesis` (tbar = t/1 s).

    Raises
    ------
    InputError
        An unknown name, a value out of bounds, a rig without what the law needs, or an effect
        that does not go with the law.
    """

    rig: Rig
    law: str
    effects: tuple[str, ...]
    parameters: Mapping[str, ParameterValue]
    clock: Clock
    fit: Mapping[str, float | int | str]

    # Written out, because it takes what the attributes do not hold: effects in any order, bare
    # numbers, parameters without their unit.
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
        known = parameters_of(law, chosen)
        given = {
            find_parameter(name, known): _with_error(name, v)
            for name, v in by_name(parameters, "parameters").items()
        }
        values = {
            name: given.get(name, ParameterValue(p.starts[0] if p.null is None else p.null))
            for name, p in known.items()
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
        """Parameter values in the core's order, shape (k,)."""
        return np.array([p.value for p in self.parameters.values()])

    def predict(self, run: Run) -> Array:
        """Friction reading of one bearing under the run's motion, N, shape (n,).

        Of a model with `time_delay` a sample close to a reversal reads the mean of what comes
        before it and after it, weighed by the errors of the reversal's instant and of the delay.

        Warns (:class:`jbf.FilmWarning`) where the film is faster than 28,000 1/s: that is held
        inside the bearing, and the friction is not to be relied on.
        """
        return self.predict_many([one_run(run)])[0]

    def predict_many(self, runs: Iterable[Run]) -> list[Array]:
        """`predict` for several runs, on all cores."""
        runs = list_of_runs(runs)
        for run in runs:
            self.require_columns(run)
        motions = [driven_motion(self.rig, run, imposed(self.rig, run)) for run in runs]
        core = chain(self.rig, self.law, self.clock, self.effects)
        warn_of_fast_film(core, self.values, motions)
        with core_refusals():
            if self.delay is None:
                return core.predict(self.values, motions)
            return self.predict_late((run, *imposed_as_read(self.rig, run)) for run in runs)

    @property
    def delay(self) -> ParameterValue | None:
        """How late the record of the force is, s; None where it is not."""
        tau = self.parameters.get(TAU)
        return None if tau is None or tau.value <= 0.0 else tau

    def predict_late(self, read: Iterable[tuple[Run, Array, ImposedMotion]]) -> list[Array]:
        """Readings of a force that is recorded late, N, one array a run: runs, the instants at
        which their motion was read, s, and that motion."""
        assert self.delay is not None
        sd_s = self.delay.stderr or 0.0
        late = LateChain(self.rig, self.law, self.clock, self.effects, list(self.parameters))
        return [late.read(self.values, *one, sd_s).mean_n for one in read]

    def require_columns(self, run: Run) -> None:
        """An InputError where a run lacks a column that an effect of this model needs."""
        require_record(self.rig, run, self.effects)

    def steady_friction(self, velocity_m_s: npt.ArrayLike) -> Array:
        """Steady friction force of the bare law (the Stribeck curve), N.

        Speeds (m/s) of shape (n,), none of them zero; under the rig's load where the law needs one.
        """
        page = find_law(self.law)
        count = len(page.parameters)
        speeds = numbers(velocity_m_s, "velocity_m_s", flat=True)
        if isinstance(page, OwnLaw):
            return page.steady_n(speeds, self.values[:count].tolist(), core_load_n(self.rig))
        with core_refusals():
            return _core.steady_friction(
                speeds,
                law=self.law,
                parameters=self.values[:count].tolist(),
                bearing=core_bearing(self.rig),
                load_n=core_load_n(self.rig),
            )

    def told_units(self) -> dict[str, dict[str, str]]:
        """For JSON: `units` of a rig with a drive, whose keys name newtons and metres whatever it
        is; empty of any other."""
        said = self.rig.quantities
        return {} if self.rig.drive is None else {"units": said.to_dict()}

    def told_parameters(
        self, parameters: Mapping[str, ParameterValue]
    ) -> dict[str, dict[str, float | str | bool | None]]:
        """For JSON: each parameter, of a rig with a drive with its `unit`."""
        units = shown(self.law, self.effects, self.rig.quantities)
        return {
            name: p.to_dict() | ({} if self.rig.drive is None else {"unit": units[name][1]})
            for name, p in parameters.items()
        }

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
        """The text that `save` writes."""
        return model_file_text(self._file())

    def save(self, path: PathLike) -> None:
        """Write the model as TOML; `Model.load` reads it back exactly."""
        write_model_file(path, self._file())

    @classmethod
    def load(cls, path: PathLike) -> Model:
        """Read a model file.

        Raises
        ------
        InputError
            Names the file, the key and the mend.
        """
        file = read_model_file(path, vocabulary())
        try:
            clock = find_clock(file.clock)
            return cls(file.rig, file.law, file.effects, file.parameters, clock, file.fit)
        except InputError as error:
            raise error.within(file=path) from None


def the_model(given: object) -> Model:
    """A model; an InputError says how to come by one."""
    mend = "give a jbf.Model"
    if isinstance(given, str | os.PathLike):
        mend = f"read it: jbf.Model.load({quoted(os.fspath(given))})"
    elif isinstance(getattr(given, "model", None), Model):
        mend = "give its .model"
    return of_kind(given, Model, "the model", mend)


def _with_error(name: str, value: float | ParameterValue) -> ParameterValue:
    """A parameter as it is kept, also where a bare number was given."""
    if isinstance(value, ParameterValue):
        return value
    try:
        return ParameterValue(value)
    except InputError as error:
        raise error.within(key_prefix=f"parameters.{name}.") from None
