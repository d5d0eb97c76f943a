"""Content of a model file, and the names and bounds that are valid in it."""

from __future__ import annotations

import numbers
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

from jbf.errors import InputError, did_you_mean, quoted
from jbf.models.parameter_value import ParameterValue
from jbf.records.rig import Rig
from jbf.records.toml_file import number, refuse_unknown

Clock = Literal["journal", "thesis"]
"""Definition of a film's time constant: `journal` (tbar = t U_tr/R), `thesis` (tbar = t/1 s).

The latter is that of Cohn (1998).
"""

AUTO = "auto"
"""Placeholder for the name of a law that is selected from the data."""

CLOCKS: tuple[Clock, ...] = get_args(Clock)


def _plain(value: object, key: str) -> float | int | str:
    """Convert to a type that TOML can represent; numpy scalars become Python scalars."""
    if isinstance(value, str):
        return str(value)
    if isinstance(value, numbers.Integral) and not isinstance(value, bool):
        return int(value)
    return number(value, key)


@dataclass(frozen=True)
class ModelFile:
    """Content of a model file.

    Attributes
    ----------
    law, clock : str
        Names of the friction law, and of the definition of its film's time constant (`Clock`).
    effects : tuple of str
        Names of the effects, in the order in which they were added.
    parameters : dict of str to ParameterValue
        Parameters of the law by name, those of an effect as ``"coulomb_drag.F_d"``.
    rig : Rig
        The rig that the model was fitted for.
    fit : dict of str to float, int or str
        Metadata of the fit.
    """

    law: str
    clock: str = "journal"
    effects: tuple[str, ...] = ()
    parameters: dict[str, ParameterValue] = field(default_factory=dict)
    rig: Rig = field(default_factory=Rig)
    fit: dict[str, float | int | str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "effects", tuple(self.effects))
        object.__setattr__(self, "fit", {k: _plain(v, f"fit.{k}") for k, v in self.fit.items()})
        if len(set(self.effects)) < len(self.effects):
            raise InputError(
                key="effects", problem="contains a name twice", remedy="name each once"
            )
        for name in self.parameters:
            effect, dot, parameter = name.partition(".")
            if dot and effect not in self.effects:
                problem = f"the effect {quoted(effect)} is not in the list of effects"
                remedy = "add it to effects or remove its parameters"
            elif (dot and not parameter) or name in self.effects or "." in parameter:
                problem, remedy = "is not the name of a parameter", "write NAME or EFFECT.NAME"
            else:
                continue
            raise InputError(key=f"parameters.{name}", problem=problem, remedy=remedy)


Bounds = tuple[float, float]


@dataclass(frozen=True)
class Vocabulary:
    """Names that are valid in a model file, with the bounds of each parameter.

    Attributes
    ----------
    laws, clocks
        Names of the laws, and of the definitions of a film's time constant.
    effects, law_parameters
        Bounds (lower, upper), both inclusive, by effect or law and by parameter name.
    """

    laws: Collection[str]
    effects: Mapping[str, Mapping[str, Bounds]]
    law_parameters: Mapping[str, Mapping[str, Bounds]]
    clocks: Collection[str] = CLOCKS

    def check(self, model: ModelFile) -> None:
        """Check every name and value of a model; an absent parameter is not an error.

        Raises
        ------
        InputError
            A law, clock, effect or parameter is unknown, or a value is out of its bounds.
        """
        named = [("law", model.law, self.laws), ("clock", model.clock, self.clocks)]
        named += [("effects", effect, list(self.effects)) for effect in model.effects]
        for key, word, valid in named:
            if word not in valid:
                problem = f"{quoted(word)} is not known"
                remedy = did_you_mean(word, valid)
                if key == "effects":
                    remedy += "; register a user-defined one first: --effects-from FILE.py"
                raise InputError(key=key, problem=problem, remedy=remedy)
        for name, parameter in model.parameters.items():
            effect, dot, short_name = name.rpartition(".")
            bounds = self.effects[effect] if dot else self.law_parameters.get(model.law, {})
            refuse_unknown([short_name], bounds, f"parameters.{effect}{dot}")
            lower, upper = bounds[short_name]
            if not lower <= parameter.value <= upper:
                problem = f"{parameter.value} is out of range"
                remedy = f"choose from {lower} to {upper}"
                raise InputError(key=f"parameters.{name}", problem=problem, remedy=remedy)
