"""A model: a rig, a law, effects and their parameters. It predicts; it does not fit."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.catalogue import (
    check_applies,
    find_effect,
    find_law,
    find_parameter,
    in_chain_order,
    parameters_of,
    vocabulary,
)
from jbf.conditioning import ImposedMotion, impose
from jbf.errors import FilmWarning, InputError
from jbf.model_file import (
    ModelFile,
    ParameterValue,
    model_file_text,
    read_model_file,
    write_model_file,
)
from jbf.own_chain import OwnChain
from jbf.own_effects import ALWAYS, OwnEffect
from jbf.record import PathLike, Run, require
from jbf.rig import Rig

Array = npt.NDArray[np.float64]

MAX_STEP_S = 0.02
"""Longest inner step of a prediction. The core lands on every reversal and takes shorter steps
where the law or an effect asks for them; at 0.02 s the bare law errs by some 1e-5 of its peak."""


def check_rig(rig: Rig, law: str) -> None:
    """An InputError where the rig lacks what a law needs."""
    if not find_law(law).needs_bearing:
        return
    for section, there in (
        ("bearing", rig.bearing),
        ("lubricant", rig.lubricant),
        ("load", rig.load),
    ):
        if there is None:
            raise InputError(
                problem=f"the rig has no [{section}]",
                mend=f"the law {law} needs one: add a [{section}] section",
            )


def core_bearing(rig: Rig) -> _core.BearingSizes | None:
    """The rig's bearing as the core takes it; None where the rig has none."""
    b = rig.bearing
    if b is None:
        return None
    return {
        "radius_m": b.radius_m,
        "length_m": b.length_m,
        "clearance_m": b.clearance_m,
        "mass_kg": b.mass_kg,
        "count": b.count,
        # A law with a film has been refused by now; any other takes the radius alone.
        "viscosity_pa_s": 1.0 if rig.lubricant is None else rig.lubricant.viscosity_pa_s,
    }


def core_load_n(rig: Rig) -> float | None:
    """The load on one bearing, N; None where the rig has none."""
    return None if rig.load is None else rig.load.normal_n


def warn_of_fast_film(
    core: _core.Chain | OwnChain, values: Array, motions: list[_core.Motion]
) -> None:
    """Say it where a prediction does not follow the film."""
    rate = core.film_rate_1_s(values, motions)
    if rate > _core.FASTEST_FILM_1_S:
        warnings.warn(
            f"the film of this model answers at {rate:.2g} 1/s; a prediction follows it up to "
            f"{_core.FASTEST_FILM_1_S:.2g} 1/s and holds it inside the bearing beyond: are "
            "U_tr_m_s, K0 and the load those of a bearing?",
            FilmWarning,
            stacklevel=4,
        )


def chain(rig: Rig, law: str, clock: str, effects: Sequence[str]) -> _core.Chain | OwnChain:
    """The core's chain for a rig.

    Raises
    ------
    InputError
        The rig lacks what the law needs, or an effect does not go with the law.
    """
    check_rig(rig, law)
    check_applies(law, effects)
    pages = [find_effect(name) for name in in_chain_order(effects)]
    own = [page for page in pages if isinstance(page, OwnEffect)]
    core = _core.Chain(
        law=law,
        bearing=core_bearing(rig),
        load_n=core_load_n(rig),
        clock=clock,
        effects=[page.name for page in pages if page not in own],
        max_step_s=MAX_STEP_S,
    )
    if not own:
        return core
    names = core.parameter_names
    instrument = [
        (page.name, [names.index(f"{page.name}.{p.name}") for p in page.parameters])
        for page in pages
        if page.stage == "instrument" and page not in own
    ]
    return OwnChain(core, instrument, own)


def imposed(rig: Rig, run: Run) -> ImposedMotion:
    """The motion that a run imposed on the rig's journal or slider."""
    return impose(run, None if rig.bearing is None else rig.bearing.radius_m)


def core_motion(rig: Rig, run: Run, motion: ImposedMotion) -> _core.Motion:
    """A run's motion and load, handed to the core; a law in newtons does not ask for the load."""
    load = run.load_n if run.load_n is not None else np.full(len(run), core_load_n(rig) or 1.0)
    made = _core.Motion(
        np.ascontiguousarray(run.time_s),
        motion.velocity_m_s,
        motion.acceleration_m_s2,
        motion.angle_rad,
        np.ascontiguousarray(load),
    )
    # What effects of one's own see: the record, its motion as the models are driven with it.
    made.columns = run.columns() | {
        "velocity_m_s": motion.velocity_m_s,
        "acceleration_m_s2": motion.acceleration_m_s2,
        "angle_rad": motion.angle_rad,
        "load_n": load,
    }
    return made


def has_angle(rig: Rig, run: Run) -> bool:
    """True where the run tells the shaft's angle; on a linear axis there is none."""
    return run.angle_rad is not None and (rig.bearing is not None or run.position_m is None)


def has_path(rig: Rig, run: Run) -> bool:
    """True where the run tells how far the drive has gone, in the units of its speed."""
    return run.position_m is not None or (run.angle_rad is not None and rig.bearing is not None)


def require_record(rig: Rig, run: Run, effects: Iterable[str]) -> None:
    """An InputError where a run lacks a column that one of the effects needs."""
    for name in effects:
        needs = find_effect(name).needs
        for column in find_effect(name).columns:
            if column not in ALWAYS:
                require(run, column, f"the effect {name}")
        if "angle" in needs and not has_angle(rig, run):
            require(run, "angle_rad", f"the effect {name}")
            raise InputError(
                file=run.path or run.name,
                column="position_m",
                problem=f"makes this a linear axis, and the effect {name} needs a shaft's angle",
                mend="drop position_m, or give the rig its [bearing]",
            )
        if "path" in needs and not has_path(rig, run):
            if rig.bearing is not None:
                require(run, "angle_rad", f"the effect {name}")
            require(run, "position_m", f"without a bearing's radius the effect {name}")


@dataclass(frozen=True)
class Model:
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
    law: str = "journal"
    effects: Sequence[str] = ()
    parameters: Mapping[str, float | ParameterValue] = field(default_factory=dict)
    clock: str = "journal"
    fit: Mapping[str, float | int | str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        find_law(self.law)
        chosen = in_chain_order(self.effects)
        known = parameters_of(self.law, chosen)
        given = {
            find_parameter(name, known): v if isinstance(v, ParameterValue) else ParameterValue(v)
            for name, v in self.parameters.items()
        }
        values = {
            name: given.get(name, ParameterValue(p.starts[0] if p.null is None else p.null))
            for name, p in known.items()
        }
        object.__setattr__(self, "effects", chosen)
        object.__setattr__(self, "parameters", values)
        vocabulary().check(self._file())
        chain(self.rig, self.law, self.clock, chosen)

    @property
    def values(self) -> Array:
        """Parameter values in the core's order, shape (k,)."""
        return np.array([p.value for p in self.parameters.values()])  # type: ignore[union-attr]

    def predict(self, run: Run) -> Array:
        """Friction reading of one bearing under the run's motion, N, shape (n,).

        Warns (:class:`jbf.FilmWarning`) where the film is faster than 28,000 1/s: that is held
        inside the bearing, and the friction is not to be relied on.
        """
        return self.predict_many([run])[0]

    def predict_many(self, runs: Iterable[Run]) -> list[Array]:
        """`predict` for several runs, on all cores."""
        runs = list(runs)
        for run in runs:
            self.require_columns(run)
        motions = [core_motion(self.rig, run, imposed(self.rig, run)) for run in runs]
        core = chain(self.rig, self.law, self.clock, self.effects)
        warn_of_fast_film(core, self.values, motions)
        return core.predict(self.values, motions)

    def require_columns(self, run: Run) -> None:
        """An InputError where a run lacks a column that an effect of this model needs."""
        require_record(self.rig, run, self.effects)

    def steady_friction(self, velocity_m_s: npt.ArrayLike) -> Array:
        """Steady friction force of the bare law (the Stribeck curve), N.

        Speeds (m/s) of shape (n,), none of them zero; under the rig's load where the law needs one.
        """
        count = len(find_law(self.law).parameters)
        return _core.steady_friction(
            np.ascontiguousarray(velocity_m_s, dtype=float),
            law=self.law,
            parameters=self.values[:count].tolist(),
            bearing=core_bearing(self.rig),
            load_n=core_load_n(self.rig),
        )

    def _file(self) -> ModelFile:
        return ModelFile(
            law=self.law,
            clock=self.clock,
            effects=tuple(self.effects),
            parameters=dict(self.parameters),  # type: ignore[arg-type]
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
            return cls(file.rig, file.law, file.effects, file.parameters, file.clock, file.fit)
        except InputError as error:
            raise error.within(file=path) from None
