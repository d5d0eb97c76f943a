"""Columns of a file as candidates for the columns of a run: quantity, unit and open question."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.importing.columns import KINDS, Header, parse_header
from jbf.importing.expression import OPEN, written
from jbf.importing.formats.table import Column, Table
from jbf.importing.guess_time import is_doubtful_time
from jbf.importing.guessed import Entry, Question
from jbf.importing.targets import FRICTION, KNOWN, MOTION, wanted_unit
from jbf.units.table import ANGLE, ASK, COUNT, NONE, SPEED, TORQUE
from jbf.units.unit import parse_unit

_NEVER = ("index", "acceleration", "coefficient", "run")
"""Quantities that never become a column of a run."""
_TURNS = tuple(unit.in_si for unit in map(parse_unit, ("rpm", "rps")) if unit is not None)
_EXAMPLES = {
    "m": "[mm]",
    "m/s": "[mm/s]",
    "rad": "[deg], [rad], or [counts] / 4096 [counts/rev]",
    "rad/s": "[rad/s] or [deg/s]",
    "rpm": "[rpm], [rad/s] or [deg/s]",
}
"""Usual units of a column of a run without a unit in the file, by the unit of the column."""
_BY_UNIT = ("temperature", "pressure", "current", "time", "speed", "force", "torque", "place")


@dataclass(frozen=True)
class Candidate:
    """Column of a file that may provide a column of a run.

    Attributes
    ----------
    key
        Column of the run.
    column, header
        Column of the file, and its analysed header.
    sure
        Whether quantity and unit are certain.
    why
        Evidence: `by name`, `by unit` or both.
    question
        Open question to the user; None if there is none.
    called
        Name of the column in an expression, if it differs from its header.
    """

    key: str
    column: Column
    header: Header
    sure: bool
    why: str
    question: str | None = None
    called: str = ""

    @property
    def expression(self) -> str:
        """Expression of the column for a map, with its unit if the name lacks it; `[?]` if open."""
        name = written(self.called or self.column.name)
        if self.question is not None:
            return f"{name} [{OPEN}]"
        in_name = parse_header(self.column.name).unit
        unit = "" if in_name or self.column.kind == "instant" else self.column.unit
        return f"{name} [{unit}]" if unit else name


def candidates_of(table: Table) -> list[Candidate]:
    """Columns of a table that may provide a column of a run, except the time."""
    candidates = [c for column in table.columns if (c := _candidate(column, table)) is not None]
    return [c for c in candidates if c.key != "time_s"]


def _candidate(column: Column, table: Table) -> Candidate | None:
    if column.kind != "number":
        return None
    if column.name in KNOWN:
        header = parse_header(column.name)
        if column.unit and not _fits(column.unit, column.name):
            question = (
                f"its unit {column.unit} contradicts its name ({wanted_unit(column.name).text})"
            )
            return Candidate(column.name, column, header, False, "by name", question)
        return Candidate(column.name, column, header, True, "name of a jbf column")
    header = parse_header(column.name, column.unit)
    if header.kind is None and not header.setpoint:
        # `force/value`: the name of the group applies, unless another column has its quantity.
        by_group = parse_header(f"{table.name} {column.name}", column.unit)
        if by_group.kind not in {parse_header(c.name, c.unit).kind for c in table.columns}:
            header = by_group
    if header.setpoint or header.modelled or header.kind in _NEVER or is_doubtful_time(header):
        return None
    unit = None if header.unit in ASK else parse_unit(header.unit)
    kind, why = header.kind, "by name"
    if kind == "force" and unit is not None and unit.dimensions == TORQUE:
        kind = "torque"  # a friction in N m
    if unit is not None and (kind is None or unit.dimensions not in KINDS[kind]):
        # A name of at most two letters does not contradict a unit.
        if kind == "time":
            return None  # a time without a unit of time: the time is searched for elsewhere
        if kind is not None and header.sure:
            question = f"{header.unit} is not a unit of {kind}; write its unit"
            return Candidate(_key(kind, header), column, header, False, why, question)
        kind = next((k for k in _BY_UNIT if unit.dimensions in KINDS[k]), None)
        if kind == "torque" and unit.dimensions == NONE:
            kind = None
        why = "by unit"
    if kind is None or kind == "time":
        return None
    key = _key(kind, header)
    if header.unit in ASK:
        question = (
            f"the unit {header.unit} is ambiguous: {ASK[header.unit]}; write one of "
            "them after the column"
        )
        return Candidate(key, column, header, False, why, question)
    if kind == "voltage" and not header.motor:
        question = (
            "is this the motor's voltage? If so, replace [?] by [V]; results are then in volts"
        )
        return Candidate(key, column, header, False, why, question)
    if unit is None:
        problem = f"the unit {header.unit!r} is not known" if header.unit else "it has no unit"
        target = wanted_unit(key).text
        question = (
            f"{problem}; write it after the column, such as {_EXAMPLES.get(target, f'[{target}]')}"
        )
        return Candidate(key, column, header, False, why, question)
    if unit.dimensions == COUNT:
        question = (
            "how many counts per revolution (or metre)? Write / 4096 [counts/rev] after the column"
        )
        return Candidate(key, column, header, False, why, question)
    certain = why == "by name" or len(header.name) <= 2
    return Candidate(key, column, header, certain, "by name and unit" if why == "by name" else why)


def _fits(unit: str, key: str) -> bool:
    """Whether a unit text denotes the unit of a column of a run."""
    stated = parse_unit(unit)
    return stated is not None and stated.in_si == wanted_unit(key).in_si


def _key(kind: str, header: Header) -> str:
    """Name of the column of a run for a quantity, `kind`, with the unit of its header."""
    unit = parse_unit(header.unit)
    size = NONE if unit is None else unit.dimensions
    motor = "motor_" if header.motor else ""
    if kind == "place":
        turning = size in (ANGLE, COUNT) or (unit is None and header.turning)
        return f"{motor}angle_rad" if turning else "position_m"
    if kind == "speed":
        if size == SPEED or (unit is None and not header.turning and not header.motor):
            return "velocity_m_s"
        turns = header.unit in ASK or unit is None or unit.in_si in _TURNS
        return f"{motor}speed_rpm" if turns else f"{motor}velocity_rad_s"
    if kind == "torque":
        if unit is not None and size != TORQUE:
            return "torque_percent"
        return f"{motor}torque_n_m"
    if kind == "force" and unit is not None and size == NONE:
        return "force_percent"
    names = {
        "force": "friction_n",
        "load": "load_n_m" if size == TORQUE else "load_n",
        "current": "current_a",
        "temperature": "temperature_c",
        "pressure": "pressure_pa",
        "voltage": "voltage_v",
    }
    return names[kind]


def is_unambiguous(rivals: list[Candidate], key: str) -> bool:
    """Whether exactly one of the candidates for a column of a run can be meant."""
    exact = [c for c in rivals if c.column.name == key]
    return len(exact) == 1 or (len(rivals) == 1 and rivals[0].sure)


def choose(key: str, rivals: list[Candidate]) -> tuple[Entry, list[str], list[Question]]:
    """Choose among the candidates for a column of a run.

    Returns
    -------
    tuple
        Map entry of the chosen column, names of the rejected columns, and open questions.
    """
    certain = [c for c in rivals if c.sure]
    named = [c for c in rivals if c.why != "by unit"]
    if named and len(named) < len(rivals):
        # A candidate identified by its name takes precedence over those identified by unit only.
        entry, rest, open_questions = choose(key, named)
        return entry, [*rest, *(c.called for c in rivals if c not in named)], open_questions
    exact = [c for c in rivals if c.column.name == key]
    if exact or len(certain) == 1 or len(rivals) == 1:
        best = (exact or certain or rivals)[0]
        questions = [] if best.question is None else [Question(best.column.name, best.question)]
        if not best.sure and best.question is None and key in (*FRICTION, *MOTION):
            question = f"is it {key}? Only its unit indicates this; write it into the map"
            questions = [Question(best.column.name, question)]
        rest = [c.column.name for c in rivals if c is not best]
        return Entry(key, best.expression, best.why, not questions), rest, questions
    names = ", ".join(c.called for c in rivals)
    entry = Entry(key, OPEN, f"one of: {names}", sure=False)
    return entry, [], [Question(key, f"which of these is it: {names}?")]
