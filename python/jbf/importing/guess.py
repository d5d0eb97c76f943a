"""Proposal of a map for a file: quantity and unit of each column, with their certainty."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from jbf.errors import InputError
from jbf.importing.candidates import Candidate, candidates_of, choose, is_unambiguous
from jbf.importing.columns import parse_header
from jbf.importing.expression import OPEN, written
from jbf.importing.formats.registry import format_of
from jbf.importing.formats.table import Column, Source, Table, Values
from jbf.importing.guess_rig import (
    by_machine,
    column_of,
    force_as_torque,
    guess_rig,
    redundant_motor_columns,
)
from jbf.importing.guess_time import guess_time, time_by_motion
from jbf.importing.guessed import Entry, Guess, Question
from jbf.importing.joints import JointNotChosen, with_units_of_joint_states
from jbf.importing.names import qualified
from jbf.importing.plausible import contradictions
from jbf.importing.side_by_side import file_of
from jbf.importing.targets import FRICTION, KNOWN, MOTION

HEAD = 5_000
"""Number of rows of a file that are inspected."""


def guess(source: Source, joint: str | None = None) -> Guess:
    """Propose a map for an open file.

    Parameters
    ----------
    joint
        Name or number of one joint, if the file holds several.

    Raises
    ------
    InputError
        If the inspected part of the file is broken, or the file holds several joints and none is
        named.
    """
    entries: dict[str, Entry] = {}
    ignored: dict[str, str] = {}
    clocks: dict[str, str] = {}
    questions: list[Question] = []
    heads: dict[str, Values] = {}
    made_in: dict[str, Path] = {}
    several = len(source.tables) > 1
    tables = tuple(with_units_of_joint_states(table) for table in source.tables)
    occurrences = Counter(column.name for table in tables for column in table.columns)
    joints = _joints(tables)
    by_voltage = not any(
        c.key in FRICTION and c.key != "voltage_v" for table in tables for c in candidates_of(table)
    )
    if joints and joint not in joints:
        raise JointNotChosen(source.path, joints, joint)
    if joint is not None and not joints:
        raise InputError(
            file=source.path, problem="contains only one joint", remedy="omit the joint"
        )
    for table in tables:
        questions += [
            Question(f"[{table.name}]" if several else "file", q) for q in table.questions
        ]
        head = source.head(table, HEAD)
        heads |= {qualified(table, name, occurrences): values for name, values in head.items()}
        candidates = [
            replace(c, called=qualified(table, c.column.name, occurrences))
            for c in candidates_of(table)
            if (c.header.label not in joints or c.header.label == joint)
            and (by_voltage or c.key != "voltage_v")
        ]
        whole_head = len(next(iter(head.values()), ())) < HEAD
        blank = [c for c in candidates if whole_head and not np.isfinite(head[c.column.name]).any()]
        candidates = [c for c in candidates if c not in blank]
        # Each of several groups has its own clock; no single line of the map names them all.
        own_clock = several and table.clock is not None
        time, open_ = (None, []) if own_clock else guess_time(table, head)
        if time is not None and several:
            time = replace(time, expression=_qualify_names(time.expression, table, occurrences))
        chosen = {} if time is None else {time.key: time}
        for key in dict.fromkeys(c.key for c in candidates):
            rivals = [c for c in candidates if c.key == key]
            if key in ("temperature_c", "pressure_pa") and not is_unambiguous(rivals, key):
                # Columns that no model requires are left out without a question.
                ignored |= {c.column.name: f"several columns may be {key}" for c in rivals}
                continue
            entry, rest, open_questions = choose(key, rivals)
            chosen[key] = entry
            ignored |= dict.fromkeys(rest, f"another column is used for {key}")
            file = made_in.get(key, file_of(source, table))
            if key in FRICTION or file == file_of(source, table):
                questions += open_questions
        if not several or len(chosen) > (0 if time is None else 1):
            questions += (
                open_ if file_of(source, table) == source.path else _with_table(open_, table)
            )
            for key, entry in chosen.items():
                if key not in entries:
                    entries[key] = entry
                    made_in[key] = file_of(source, table)
                    separate_clock = time is not None and time is not entries.get("time_s")
                    if separate_clock and key != "time_s" and time is not None:
                        clocks[key] = time.expression
                elif key not in (*FRICTION, "time_s") and made_in[key] != file_of(source, table):
                    # The clock of the main file is that of the recording.
                    ignored[column_of(entry)] = f"{key} is read from {made_in[key].name}"
                elif key != "time_s":
                    message = (
                        f"is also in [{table.name}]; set table under [file], or write the full name"
                    )
                    questions.append(Question(key, message))
        ignored |= _unused_columns(table, candidates, time)
        ignored |= {c.column.name: "contains no value" for c in blank}
    if "load_n_m" in entries and not any(key in entries for key in FRICTION):
        entries["torque_n_m"] = replace(entries.pop("load_n_m"), key="torque_n_m")
    entries = by_machine(entries)
    for key in redundant_motor_columns(entries):
        ignored[column_of(entries.pop(key))] = "redundant: a force and a position are recorded"
    lone_motion = all(c.kind != "number" or _is_used(c, entries) for t in tables for c in t.columns)
    questions += _missing_questions(entries, source, lone_motion)
    questions += force_as_torque(entries, ignored)
    sections, about_rig = guess_rig(set(entries), lone_motion)
    questions += about_rig
    by_motion = time_by_motion(entries, tables, heads)
    if by_motion is not None:
        questions = [q for q in questions if q.place not in entries["time_s"].expression]
        entries["time_s"] = by_motion
        unit = by_motion.expression[by_motion.expression.rindex("[") :]
        # The unit of times in another file is independent.
        file = made_in["time_s"]
        clocks = {
            key: text.replace(f"[{OPEN}]", unit) if made_in[key] == file else text
            for key, text in clocks.items()
        }
    questions += contradictions(entries, tables, heads)
    ordered = sorted(entries.values(), key=lambda e: _order(e.key))
    return Guess(
        source.path,
        format_of(source.path).name,
        tables,
        tuple(ordered),
        ignored,
        sections,
        tuple(dict.fromkeys(questions)),
        clocks,
    )


def _joints(tables: Sequence[Table]) -> list[str]:
    """Labels of joints, if several joints have both a friction and a motion; otherwise empty."""
    labels: dict[bool, list[str]] = {True: [], False: []}
    for table in tables:
        for candidate in candidates_of(table):
            if candidate.key in (*FRICTION, *MOTION) and candidate.header.label:
                labels[candidate.key in FRICTION].append(candidate.header.label)
    both = [label for label in dict.fromkeys(labels[False]) if label in labels[True]]
    return both if len(both) > 1 else []


def _with_table(questions: list[Question], table: Table) -> list[Question]:
    """Add the name of the table to the place that each question names."""
    return [replace(question, place=f"{table.name}/{question.place}") for question in questions]


def _qualify_names(expression: str, table: Table, occurrences: Counter[str]) -> str:
    """Add the table name to the columns of a time expression whose names occur in other tables."""
    for column in table.columns:
        if occurrences[column.name] > 1:
            expression = expression.replace(
                written(column.name), written(qualified(table, column.name, occurrences))
            )
    return expression


def _order(key: str) -> int:
    """Position of a column of a run in the map."""
    return KNOWN.index(key) if key in KNOWN else len(KNOWN)


def _is_used(column: Column, entries: Mapping[str, Entry]) -> bool:
    """Whether an entry of the map uses a column of the file."""
    return any(written(column.name) in entry.expression for entry in entries.values())


def _missing_questions(
    entries: Mapping[str, Entry], source: Source, lone_motion: bool
) -> list[Question]:
    """Questions for a missing friction or motion; a motion alone is taken as a coast-down."""
    names = [c.name for t in source.tables for c in t.columns]
    shown = ", ".join(names[:8]) + (", ..." if len(names) > 8 else "")
    questions = []
    if not any(key in entries for key in FRICTION) and not lone_motion:
        if "load_n" in entries:
            question = (
                f"is {entries['load_n'].expression} the friction or the load? For "
                "friction write friction_n"
            )
        else:
            question = (
                f"which column is the friction force or torque? Columns: {shown}. For "
                'a coast-down write friction = "none" and the moved mass or inertia '
                "under [drive]"
            )
        questions.append(Question("friction", question))
    if not any(key in entries for key in MOTION):
        questions.append(
            Question("motion", f"which column is a position or a speed? Columns: {shown}")
        )
    return questions


def _unused_columns(
    table: Table, candidates: list[Candidate], time: Entry | None
) -> dict[str, str]:
    """Columns of a table that the map does not use, with the reason."""
    used = {c.column.name for c in candidates}
    reasons = {}
    for column in table.columns:
        if (
            column.name in used
            or column.name == table.clock
            or (time is not None and written(column.name) in time.expression)
        ):
            continue
        header = parse_header(column.name, column.unit)
        if column.kind == "word":
            why = "words"
        elif header.setpoint:
            why = "a set point"
        elif header.modelled:
            why = "computed, not measured"
        elif header.kind == "run":
            why = "run number: [cut] can use it"
        elif header.kind is None:
            why = "not known"
        else:
            why = f"{header.kind}: not used"
        reasons[column.name] = why
    return reasons
