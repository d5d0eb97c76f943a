"""A fitted model as a TOML file: law, effects, parameters, rig."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import asdict
from typing import Any

import tomlkit
from tomlkit.items import Table

from jbf.errors import InputError
from jbf.models.parameter_value import ParameterValue
from jbf.models.vocabulary import ModelFile, Vocabulary
from jbf.records.quantities import Quantities
from jbf.records.rig import Rig
from jbf.records.run import PathLike
from jbf.records.toml_file import read_toml, refuse_unknown, table
from jbf.text_files import write_text

FORMAT = 1
_KEYS = ("format", "law", "clock", "effects", "parameters", "rig", "fit")
_FIELDS = {"value", "stderr", "note", "held"}
_HEADER = """\
jbf model file. Parameters are in SI units, stderr is one standard error; a bare number will do:
f_m = 0.26. What is held was not determined: its value predicts, and is no answer. Each effect in
the list has its parameters in [parameters.EFFECT]."""

_TURNING = """\
The rig is a rotary drive: where a parameter's name ends in n, m or kg, read N m, rad or kg m^2
(F_v_n_s_m is in N m s/rad)."""

_BY_VOLTAGE = """\
The rig is a motor read by its voltage: where a parameter's name ends in n or kg, read V or V s^2
over the unit of the motion (F_v_n_s_m is in {viscous}, m_e_kg in {inertia})."""


def _units_note(quantities: Quantities) -> str:
    """Note on the units in the names of parameters; empty if they are true."""
    if quantities.force == "V":
        return _BY_VOLTAGE.format(viscous=quantities.unit("N s/m"), inertia=quantities.unit("kg"))
    return _TURNING if quantities.motion == "rotary" else ""


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
        # A table of tables belongs to an effect, even if the list of effects omits it.
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


def _inline(parameter: ParameterValue) -> tomlkit.items.InlineTable:
    entry = tomlkit.inline_table()
    # tomlkit writes the repr of a float, which reads back to the same bits.
    entry.update({k: v for k, v in asdict(parameter).items() if v is not None and v is not False})
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
    """Return a model as the text of its file; reading the text gives an equal model."""
    document = tomlkit.document()
    for line in _HEADER.splitlines():
        document.add(tomlkit.comment(line))
    for line in _units_note(model.rig.quantities).splitlines():
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
    """Write a model file atomically.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    write_text(path, model_file_text(model))
