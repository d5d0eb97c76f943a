"""Open points of a map as questions with choices, for the cards of the import."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from jbf.importing.columns import parse_header
from jbf.importing.expression import OPEN
from jbf.importing.guess_rig import LEVER
from jbf.importing.guessed import Question
from jbf.importing.map_text import CHOICES as COMMENTS
from jbf.importing.mapping import Map
from jbf.importing.targets import FRICTION, MOTION, wanted_unit
from jbf.units.unit import parse_unit
from jbf.workbench.map_form import PLAIN, WORDS, units_for

Point = dict[str, Any]
BY_UNIT = {
    "friction": (("N", "friction_n"), ("N m", "torque_n_m"), ("A", "current_a"),
                 ("%", "torque_percent"), ("V", "voltage_v")),
    "motion": (("m", "position_m"), ("m/s", "velocity_m_s"), ("rad", "angle_rad"),
               ("rad/s", "velocity_rad_s"), ("rpm", "speed_rpm")),
}  # fmt: skip
"""Column of a run for the unit of a column of a file; the first one without a unit."""
RIG_WORDS = {
    "rated_torque_n_m": ("What is the rated torque of the motor (100 %)?", "1.27 N m"),
    "rated_force_n": ("What is the rated force of the motor (100 %)?", "60 N"),
    "torque_constant_n_m_a": ("What is the torque of the motor per ampere?", "0.5 N m/A"),
    "force_constant_n_a": ("What is the force of the motor per ampere?", "24 N/A"),
    "pitch_m": ("How far does the slide travel per revolution of the screw?", "10 mm"),
    "gear_ratio": ("How many turns of the motor is one turn of the output?", "100"),
    "inertia_kg_m2": ("What is the moved inertia?", "0.02 kg m^2"),
    "mass_kg": ("What is the moved mass?", "3.5 kg"),
    "radius_m": ("Radius of the journal, half its diameter", "20 mm"),
    "length_m": ("Length of the bearing", "30 mm"),
    "clearance_m": ("Radial clearance", "0.05 mm"),
    "count": ("Number of bearings on the shaft", "1"),
    "viscosity_pa_s": ("Viscosity of the lubricant", "5 mPa s"),
    "normal_n": ("Load on one bearing", "200 N"),
    "friction": ("What does the friction column contain?", ""),
    "motion": ("How does the machine move?", ""),
}
"""Question about each value of the rig, and an example of an answer."""


def open_points(mapping: Map, columns: Sequence[Mapping[str, Any]]) -> list[Point]:
    """Questions that the map leaves open, each with the choices that are valid.

    Parameters
    ----------
    columns
        Columns of the file (`map_form.file_columns`).

    Returns
    -------
    list of dict
        `kind`, `title`, and `choices`: pairs of value and label. The kinds are `unit` and `formula`
        (of the column `key`), `column` (which column is `key`), `quantity` (which column is a
        friction or a motion), `value` (of the rig at `place`) and `values` (several `fields` of the
        rig, each with its place, title and example).
    """
    points: list[Point] = []
    for key, expression in mapping.columns.items():
        if OPEN in expression:
            points.append(_of_column(key, expression, columns, mapping))
    keys = set(mapping.columns)
    without_friction = any(part.get("friction") == "none" for part in mapping.rig.values())
    for what, group, words in (
        ("friction", FRICTION, "Which column is the friction force, torque or motor current?"),
        ("motion", MOTION, "Which column is a position, an angle or a speed?"),
    ):
        if not keys & set(group) and not (what == "friction" and without_friction):
            points.append({"kind": "quantity", "key": what, "title": words,
                           "choices": _quantities(what, columns, mapping)})  # fmt: skip
    if "time_s" not in keys and not mapping.options.rate_hz and not mapping.options.steady:
        names = [str(c["name"]) for c in columns if c["kind"] != "word"]
        points.append({"kind": "column", "key": "time_s", "title": "Which column is the time?",
                       "choices": [(name, name) for name in names]})  # fmt: skip
    if "bearing" in mapping.rig:
        points += _of_bearing(mapping)
    for section, part in mapping.rig.items():
        for key, value in part.items():
            if (
                "bearing" not in mapping.rig
                and value == OPEN
                and not (key == "friction" and not keys & set(FRICTION))
            ):
                title, example = RIG_WORDS.get(key, (f"What is {key.replace('_', ' ')}?", ""))
                choices = [(c, c) for c in re.findall(r'"(\w+)"', COMMENTS.get(key, ""))]
                points.append({"kind": "value", "place": f"{section}.{key}", "title": title,
                               "example": example, "choices": choices})  # fmt: skip
    return points


def _of_column(
    key: str, expression: str, columns: Sequence[Mapping[str, Any]], mapping: Map
) -> Point:
    """Question about an open expression of a column of a run."""
    words, plain = WORDS.get(key, key), PLAIN.fullmatch(expression)
    if plain is not None and plain["unit"] == OPEN:
        return {"kind": "unit", "key": key, "column": plain["column"],
                "title": f"In which unit is {plain['column']} ({words})?",
                "choices": [(u, u) for u in units_for(key)]}  # fmt: skip
    if expression.strip() == OPEN:
        used = " ".join(mapping.columns.values())
        names = [str(c["name"]) for c in columns if c["kind"] != "word"]
        likely = [n for n in names if _could_be(n, key, columns) and f"`{n}`" not in used]
        return {"kind": "column", "key": key, "title": f"Which column is the {words}?",
                "choices": [(n, n) for n in likely or names]}  # fmt: skip
    if expression.endswith(LEVER):
        force = expression.removesuffix(LEVER).replace("`", "")
        return {"kind": "formula", "key": key, "expression": expression, "number": "radius, mm",
                "title": f"At what radius does the force {force} act?",
                "choices": [("bearing", "it is a journal bearing")]}  # fmt: skip
    return {"kind": "formula", "key": key, "expression": expression, "choices": [],
            "title": f"{words} = {expression}: which number is the {OPEN}?"}  # fmt: skip


def _of_bearing(mapping: Map) -> list[Point]:
    """Question about the open values of a journal bearing, on one card; empty without any."""
    words = {**RIG_WORDS, "mass_kg": ("Rotating mass", "2 kg")}
    fields = [
        {"place": f"{section}.{key}", "title": words[key][0], "example": words[key][1]}
        for section, part in mapping.rig.items()
        for key, value in part.items()
        if value == OPEN and key in words
    ]
    title = "What are the dimensions of the bearing?"
    return [{"kind": "values", "title": title, "fields": fields, "choices": []}] if fields else []


def _could_be(name: str, key: str, columns: Sequence[Mapping[str, Any]]) -> bool:
    """Whether the unit of a column permits a quantity; a column without a unit permits any."""
    unit = _unit_of(name, columns)
    parsed = parse_unit(unit) if unit else None
    return parsed is None or parsed.fits(wanted_unit(key))


def _unit_of(name: str, columns: Sequence[Mapping[str, Any]]) -> str:
    stated = next((str(c["unit"] or "") for c in columns if c["name"] == name), "")
    return stated or parse_header(name).unit


def _quantities(
    what: str, columns: Sequence[Mapping[str, Any]], mapping: Map
) -> list[tuple[str, str]]:
    """Columns that could be a friction or a motion: pairs `key column` and label."""
    used = " ".join(mapping.columns.values())
    pairs = []
    for column in columns:
        name = str(column["name"])
        if column["kind"] == "word" or f"`{name}`" in used:
            continue
        unit = _unit_of(name, columns)
        parsed = parse_unit(unit) if unit else None
        key = next((k for u, k in BY_UNIT[what] if parsed is not None
                    and parsed.fits(wanted_unit(k))), None)  # fmt: skip
        if key is None and parsed is not None:
            continue
        pairs.append((f"{key or BY_UNIT[what][0][1]} {name}", name))
    if what == "friction":
        pairs.append(("none", "no force was recorded: a coast-down"))
    return pairs


def remaining(questions: Sequence[Question], points: Sequence[Point]) -> list[Point]:
    """Questions of a proposal that no open point of its map covers, to be confirmed by the user."""
    covered = {str(p.get(k, "")) for p in points for k in ("key", "place", "column")}
    covered |= {str(f["place"]) for p in points for f in p.get("fields", ())}
    covered |= {value for p in points if p["kind"] == "column" for value, _ in p["choices"]}
    covered |= {"friction", "motion"} if any(p["kind"] == "quantity" for p in points) else set()
    return [
        {"kind": "confirm", "title": f"{q.place}: {q.asks}", "choices": []}
        for q in questions
        if q.place not in covered and q.place.rpartition("/")[2] not in covered
    ]


def of_joints(joints: Sequence[str], chosen: str) -> list[Point]:
    """Question which joint of a file with several joints is imported."""
    return [{"kind": "joint", "title": "Which joint?", "chosen": chosen,
             "choices": [(j, j) for j in joints]}]  # fmt: skip
