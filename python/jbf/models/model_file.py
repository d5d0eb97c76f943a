"""Model files: a fitted model as TOML with law, effects, parameters and rig."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import asdict
from typing import Any

import tomlkit
from tomlkit.items import Table

from jbf.errors import InputError
from jbf.models.parameter_value import ParameterValue
from jbf.models.vocabulary import ModelFile, Vocabulary
from jbf.records.rig import Rig
from jbf.records.run import PathLike
from jbf.records.toml_file import read_toml, refuse_unknown, table
from jbf.renamed import current_effect, current_parameter

FORMAT = 1
_KEYS = ("format", "law", "clock", "effects", "parameters", "rig", "fit")
_FIELDS = {"value", "stderr", "note", "held"}
_HEADER = """\
jbf model file. Parameters are in the SI units given in the comments; stderr is one standard error.
A plain number is sufficient: f_m = 0.26. A parameter that is held was not determined by the data.
The parameters of each effect in the list are in [parameters.EFFECT]."""


def _text(content: Mapping[str, Any], key: str, default: str | None = None) -> str:
    value = content.get(key, default)
    if not isinstance(value, str):
        problem = "is missing" if value is None else "is not text"
        raise InputError(key=key, problem=problem, remedy=f'write {key} = "NAME"')
    return value


def _parameter(entry: object, key: str) -> ParameterValue:
    entry = entry if isinstance(entry, Mapping) else {"value": entry}
    refuse_unknown(entry, sorted(_FIELDS), f"{key}.")
    if "value" not in entry:
        raise InputError(key=f"{key}.value", problem="is missing", remedy="write { value = 0.26 }")
    try:
        return ParameterValue(**entry)
    except InputError as error:
        raise error.within(key_prefix=f"{key}.") from None


def _parameters(content: Mapping[str, Any], effects: Collection[str]) -> dict[str, ParameterValue]:
    parameters = {}
    for name, entry in content.items():
        # A nested table contains parameters of an effect, even of one missing in the list of
        # effects.
        inner = isinstance(entry, Mapping) and entry and not _FIELDS & set(entry)
        effect = current_effect(name) if inner else name
        if effect in effects or inner:
            for short_name, value in table(entry, f"parameters.{name}").items():
                full = current_parameter(f"{effect}.{short_name}")
                parameters[full] = _parameter(value, f"parameters.{name}.{short_name}")
        else:
            parameters[current_parameter(name)] = _parameter(entry, f"parameters.{name}")
    return parameters


def _from_mapping(content: Mapping[str, Any]) -> ModelFile:
    if repr(content.get("format")) != repr(FORMAT):
        problem = "is not supported by this version of jbf" if "format" in content else "is missing"
        raise InputError(key="format", problem=problem, remedy=f"write format = {FORMAT}")
    refuse_unknown(content, _KEYS)
    effects = content.get("effects", [])
    if not isinstance(effects, list) or not all(isinstance(name, str) for name in effects):
        remedy = 'write effects = ["coulomb_drag"]'
        raise InputError(key="effects", problem="is not a list of names", remedy=remedy)
    effects = [current_effect(name) for name in effects]
    return ModelFile(
        law=_text(content, "law"),
        clock=_text(content, "clock", "journal"),
        effects=tuple(effects),
        parameters=_parameters(table(content.get("parameters", {}), "parameters"), effects),
        rig=Rig.from_mapping(table(content.get("rig", {}), "rig"), prefix="rig."),
        fit=dict(table(content.get("fit", {}), "fit")),
    )


def read_model_file(path: PathLike, vocabulary: Vocabulary | None = None) -> ModelFile:
    """Read a model file; names and bounds are checked if a vocabulary is given.

    Raises
    ------
    InputError
        The file is not TOML or not a model; the message names file, key and remedy.
    """
    try:
        model = _from_mapping(read_toml(path))
        if vocabulary is not None:
            vocabulary.check(model)
    except InputError as error:
        raise error.within(file=path) from None
    return model


def _inline(parameter: ParameterValue, unit: str) -> tomlkit.items.InlineTable:
    entry = tomlkit.inline_table()
    # tomlkit writes the repr of a float, which is read back without a rounding error.
    entry.update({k: v for k, v in asdict(parameter).items() if v is not None and v is not False})
    if unit:
        entry.comment(unit)
    return entry


def _parameters_table(model: ModelFile, units: Mapping[str, str]) -> Table:
    parameters = tomlkit.table()
    for name, value in model.parameters.items():
        if "." not in name:
            parameters[name] = _inline(value, units.get(name, ""))
    for effect in model.effects:
        of_effect = {n: v for n, v in model.parameters.items() if n.startswith(f"{effect}.")}
        if of_effect:
            parameters[effect] = tomlkit.table()
        for name, value in of_effect.items():
            parameters[effect][name.partition(".")[2]] = _inline(value, units.get(name, ""))
    return parameters


def model_file_text(model: ModelFile, units: Mapping[str, str]) -> str:
    """Text of the model file of a model; reading the text gives an equal model.

    The unit of each parameter is written as a comment.
    """
    document = tomlkit.document()
    for line in _HEADER.splitlines():
        document.add(tomlkit.comment(line))
    document["format"] = FORMAT
    document["law"] = model.law
    document["clock"] = model.clock
    document["effects"] = list(model.effects)
    if model.parameters:
        document["parameters"] = _parameters_table(model, units)
    if model.rig != Rig():
        document["rig"] = model.rig.to_mapping()
    if model.fit:
        document["fit"] = dict(model.fit)
    return tomlkit.dumps(document)
