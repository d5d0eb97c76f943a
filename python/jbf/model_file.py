"""A fitted model as a TOML file: law, effects, parameters, rig. Data only, no physics."""

from __future__ import annotations

import math
import numbers
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import tomlkit
from tomlkit.items import Table

from .errors import InputError, did_you_mean, quoted, write_text
from .rig import PathLike, Rig, number, read_toml, refuse_unknown, table

FORMAT = 1
_KEYS = ("format", "law", "clock", "effects", "parameters", "rig", "fit")
_FIELDS = {"value", "stderr", "note"}
_HEADER = """\
jbf model file. Parameters are in SI units, stderr is one standard error; a bare number will do:
f_m = 0.26. Each effect in the list has its parameters in [parameters.EFFECT]."""

Bounds = tuple[float, float]


@dataclass(frozen=True)
class ParameterValue:
    """One parameter.

    `value` is in the unit that the parameter's name tells, and may be infinite but not nan;
    `stderr` is one standard error in that unit, None when not known (nan becomes None); `note` is
    a remark, such as "at its lower bound".
    """

    value: float
    stderr: float | None = None
    note: str | None = None

    def __post_init__(self) -> None:
        value = number(self.value, "value")
        if math.isnan(value):
            raise InputError(key="value", problem="nan is not a value", mend="write a number")
        object.__setattr__(self, "value", value)
        if self.stderr is not None:
            stderr = number(self.stderr, "stderr")
            if stderr < 0.0:
                raise InputError(key="stderr", problem="is negative", mend="drop the sign")
            object.__setattr__(self, "stderr", None if math.isnan(stderr) else stderr)
        if self.note is not None and not isinstance(self.note, str):
            raise InputError(key="note", problem="is not text", mend="put it in quotes")


def _plain(value: object, key: str) -> float | int | str:
    """A value that TOML can hold; numpy's scalars become Python's."""
    if isinstance(value, str):
        return str(value)
    if isinstance(value, numbers.Integral) and not isinstance(value, bool):
        return int(value)
    return number(value, key)


@dataclass(frozen=True)
class ModelFile:
    """What a model file holds.

    Attributes
    ----------
    law, clock : str
        Names of the friction law and of its clock.
    effects : tuple of str
        Names of the effects, in the order in which they were added.
    parameters : dict of str to ParameterValue
        The law's parameters by name, an effect's as ``"coulomb_drag.F_d_n"``.
    rig : Rig
        What the model was fitted on.
    fit : dict of str to float, int or str
        How it was fitted, for people to read.
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
            raise InputError(key="effects", problem="names one twice", mend="name each once")
        for name in self.parameters:
            effect, dot, parameter = name.partition(".")
            if dot and effect not in self.effects:
                problem = f"the effect {quoted(effect)} is not in the list of effects"
                mend = "add it to effects or remove its parameters"
            elif (dot and not parameter) or name in self.effects or "." in parameter:
                problem, mend = "is not the name of a parameter", "write NAME or EFFECT.NAME"
            else:
                continue
            raise InputError(key=f"parameters.{name}", problem=problem, mend=mend)


@dataclass(frozen=True)
class Vocabulary:
    """The names that a model file may use, and the bounds (lower, upper; both legal) of each."""

    laws: Collection[str]
    effects: Mapping[str, Mapping[str, Bounds]]
    law_parameters: Mapping[str, Mapping[str, Bounds]]
    clocks: Collection[str] = ("journal", "thesis")

    def check(self, model: ModelFile) -> None:
        """Check every name and value of a model; an absent parameter is not an error.

        Raises
        ------
        InputError
            A law, clock, effect or parameter is unknown, or a value is out of its bounds.
        """
        named = [("law", model.law, self.laws), ("clock", model.clock, self.clocks)]
        named += [("effects", effect, list(self.effects)) for effect in model.effects]
        for key, word, known in named:
            if word not in known:
                problem = f"{quoted(word)} is not known"
                mend = did_you_mean(word, known)
                if key == "effects":
                    mend += "; one of your own is registered first: --effects-from FILE.py"
                raise InputError(key=key, problem=problem, mend=mend)
        for name, parameter in model.parameters.items():
            effect, dot, short = name.rpartition(".")
            bounds = self.effects[effect] if dot else self.law_parameters.get(model.law, {})
            refuse_unknown([short], bounds, f"parameters.{effect}{dot}")
            lower, upper = bounds[short]
            if not lower <= parameter.value <= upper:
                problem = f"{parameter.value} is out of range"
                mend = f"choose from {lower} to {upper}"
                raise InputError(key=f"parameters.{name}", problem=problem, mend=mend)


def _text(content: Mapping[str, Any], key: str, default: str | None = None) -> str:
    value = content.get(key, default)
    if not isinstance(value, str):
        problem = "is missing" if value is None else "is not text"
        raise InputError(key=key, problem=problem, mend=f'write {key} = "NAME"')
    return value


def _parameter(entry: object, key: str) -> ParameterValue:
    entry = entry if isinstance(entry, Mapping) else {"value": entry}
    refuse_unknown(entry, sorted(_FIELDS), f"{key}.")
    if "value" not in entry:
        raise InputError(key=f"{key}.value", problem="is missing", mend="write { value = 0.26 }")
    try:
        return ParameterValue(**entry)
    except InputError as error:
        raise error.within(key_prefix=f"{key}.") from None


def _parameters(content: Mapping[str, Any], effects: Collection[str]) -> dict[str, ParameterValue]:
    found = {}
    for name, entry in content.items():
        # A table of tables is an effect's, also where the list of effects forgot it.
        inner = isinstance(entry, Mapping) and entry and not _FIELDS & set(entry)
        if name in effects or inner:
            for short, value in table(entry, f"parameters.{name}").items():
                found[f"{name}.{short}"] = _parameter(value, f"parameters.{name}.{short}")
        else:
            found[name] = _parameter(entry, f"parameters.{name}")
    return found


def _from_mapping(content: Mapping[str, Any]) -> ModelFile:
    if repr(content.get("format")) != repr(FORMAT):
        problem = "is not one this jbf reads" if "format" in content else "is missing"
        raise InputError(key="format", problem=problem, mend=f"write format = {FORMAT}")
    refuse_unknown(content, _KEYS)
    effects = content.get("effects", [])
    if not isinstance(effects, list) or not all(isinstance(name, str) for name in effects):
        mend = 'write effects = ["coulomb_drag"]'
        raise InputError(key="effects", problem="is not a list of names", mend=mend)
    return ModelFile(
        law=_text(content, "law"),
        clock=_text(content, "clock", "journal"),
        effects=tuple(effects),
        parameters=_parameters(table(content.get("parameters", {}), "parameters"), effects),
        rig=Rig.from_mapping(table(content.get("rig", {}), "rig"), prefix="rig."),
        fit=dict(table(content.get("fit", {}), "fit")),
    )


def read_model_file(path: PathLike, vocabulary: Vocabulary | None = None) -> ModelFile:
    """Read a model file; names and bounds are checked when a vocabulary is given.

    Raises
    ------
    InputError
        The file is not TOML or not a model; the message names file, key and the mend.
    """
    try:
        model = _from_mapping(read_toml(path))
        if vocabulary is not None:
            vocabulary.check(model)
    except InputError as error:
        raise error.within(file=path) from None
    return model


def _inline(parameter: ParameterValue) -> tomlkit.items.InlineTable:
    entry = tomlkit.inline_table()
    # tomlkit writes the repr of a float, which reads back to the same bits.
    entry.update({k: v for k, v in asdict(parameter).items() if v is not None})
    return entry


def _parameters_table(model: ModelFile) -> Table:
    parameters = tomlkit.table()
    for name, value in model.parameters.items():
        if "." not in name:
            parameters[name] = _inline(value)
    for effect in model.effects:
        own = {n: v for n, v in model.parameters.items() if n.startswith(f"{effect}.")}
        if own:
            parameters[effect] = tomlkit.table()
        for name, value in own.items():
            parameters[effect][name.partition(".")[2]] = _inline(value)
    return parameters


def model_file_text(model: ModelFile) -> str:
    """A model as the text of its file; reading it gives an equal model."""
    document = tomlkit.document()
    for line in _HEADER.splitlines():
        document.add(tomlkit.comment(line))
    document["format"] = FORMAT
    document["law"] = model.law
    document["clock"] = model.clock
    document["effects"] = list(model.effects)
    if model.parameters:
        document["parameters"] = _parameters_table(model)
    if model.rig != Rig():
        document["rig"] = model.rig.to_mapping()
    if model.fit:
        document["fit"] = dict(model.fit)
    return tomlkit.dumps(document)


def write_model_file(path: PathLike, model: ModelFile) -> None:
    """Write a model file, whole or not at all.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_text(path, model_file_text(model))
