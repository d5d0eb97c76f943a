"""Text of a proposed map (`map.toml`): certain, open and unused columns, each with its reason."""

from __future__ import annotations

import os
import re
from pathlib import Path

import tomlkit

from jbf.importing.columns import parse_header
from jbf.importing.guess_rig import assumed_machine, force_of_motor
from jbf.importing.guessed import Guess
from jbf.text_files import real_path

_HEAD = """\
# Map from the columns of the file to the columns of a run. Written by jbf import; edit it, then
#   jbf import {file} --map {map} --folder FOLDER
# Columns have the names of the file, optionally in back quotes; + - * / and brackets are allowed,
# and units in square brackets: "`Torque [Nm]` / 12.7 [mm]", "-`Speed` [rpm]". Units are converted
# to the unit in the name on the left. Replace each ? by its value.
"""
_CUT = """\
# A recording is cut into several runs, by default at its rests. It is always cut where time
# restarts.
# [cut]
# by = "{way}"  # one or several of: "rests", "cycles", "set_point", "load_step", "motion",
#               # "run", "parts"
"""

_GEAR = ["# gear_ratio = 1.0  # turns of the motor per turn of the joint or screw"]

CHOICES = {
    "motion": '  # "linear" or "rotary"',
    "friction": '  # "force" (linear only), "torque", "current", "percent", "voltage", "none"',
}
"""Comments that list the alternatives for a value of the map."""


def map_was_written_for(text: str, file_name: str) -> bool:
    """Whether the text of a map was proposed by an inspection of a file of this name."""
    command = re.search(r"^#   jbf import (.+) --map ", text, re.MULTILINE)
    return command is not None and Path(command[1]).name == file_name


def map_text(guess: Guess, name: str = "map.toml") -> str:
    """Text of a proposed map, with comments."""
    parts = [_HEAD.format(file=guess.path, map=name)]
    if guess.questions:
        questions = "\n".join(f"#   {question}" for question in guess.questions)
        parts.append(f"# Open:\n{questions}\n")
    if guess.beside:
        names = ", ".join(_quoted(_relative(path, guess.path)) for path in guess.beside)
        parts.append(
            f"# Recorded at the same time, with separate clocks.\n[file]\nbeside = [{names}]\n"
        )
    rates = [t.rate_hz for t in guess.tables if t.rate_hz is not None]
    if not any(e.key == "time_s" for e in guess.entries):
        if rates:
            head = "" if guess.beside else "[file]\n"
            parts.append(f"{head}rate_hz = {rates[0]!r}  # stated in the file\n")
        elif all(t.clock is None for t in guess.tables):
            parts.append("# [file]\n# rate_hz = 1000.0\n")
    lines = ["[columns]"]
    lines += _aligned(
        [
            (f"{e.key} = {_quoted(e.expression)}", e.why + ("" if e.sure else "; open"))
            for e in guess.entries
        ]
    )
    lines += [f"# not taken: {name} ({why})" for name, why in guess.ignored.items()]
    parts.append("\n".join(lines) + "\n")
    if guess.clocks:
        assignments = [f"{key} = {_quoted(text)}" for key, text in guess.clocks.items()]
        parts.append(
            "\n".join(["# Columns with a time of their own.", "[clocks]", *assignments]) + "\n"
        )
    parts += _align(guess)
    parts.append(_cut(guess))
    machine = assumed_machine(guess.rig)
    if machine is not None:
        parts.append(f"# The machine: {machine}.")
    for section, content in guess.rig.items():
        lines = tomlkit.dumps({section: dict(content)}).rstrip("\n").split("\n")
        choices = [CHOICES.get(line.split(" = ")[0], "") for line in lines]
        lines = list(map("".join, zip(lines, choices, strict=True)))
        lines += _GEAR if section == "drive" and force_of_motor(guess) else []
        parts.append("\n".join(lines) + "\n")
    if not guess.rig:
        parts.append(
            '# What it was recorded on, as in rig.toml:\n# [drive]\n# motion = "linear"\n'
            '# friction = "force"\n# or [bearing], [lubricant] and [load] '
            "(docs/import.md#a-journal-bearing)\n"
        )
    return "\n".join(parts)


def _align(guess: Guess) -> list[str]:
    """Lines of the section `[align]` for the clocks of further files."""
    if not guess.beside:
        return []
    lines = [
        "# The clock of a further file: a common signal (column of the first file ~ column of that",
        "# file), or the seconds that are added to its times.",
    ]
    entries = [
        (f"{tomlkit.key(stem).as_string()} = {_quoted(text)}", guess.align_notes.get(stem, ""))
        for stem, text in guess.align.items()
        if isinstance(text, str)
    ]
    lines += ["[align]", *_aligned(entries)] if entries else []
    lines += [f"# {n}: {note}" for n, note in guess.align_notes.items() if n not in guess.align]
    return ["\n".join(lines) + "\n"]


def _relative(path: Path, main: Path) -> str:
    """Path relative to the folder of the main file, in which the map is stored."""
    try:
        return Path(os.path.relpath(path.absolute(), real_path(main).parent)).as_posix()
    except ValueError:
        return path.absolute().as_posix()


def _quoted(text: str) -> str:
    return tomlkit.item(text).as_string()


def _aligned(lines: list[tuple[str, str]]) -> list[str]:
    """Join each line with its comment, and align the comments."""
    width = max((len(line) for line, _ in lines), default=0)
    return [f"{line:<{width}}  # {why}" for line, why in lines]


def _cut(guess: Guess) -> str:
    """Text of the section `[cut]`, with a column of the file that is suitable for cutting."""
    for table in guess.tables:
        for column in table.columns:
            header = parse_header(column.name, column.unit)
            if header.kind == "run" or header.setpoint:
                method = "run" if header.kind == "run" else "set_point"
                return f"{_CUT.format(way=method)}# column = {_quoted(f'`{column.name}`')}\n"
    return _CUT.format(way="rests")
