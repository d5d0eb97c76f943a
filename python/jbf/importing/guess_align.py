"""Proposal for the alignment of the clocks of files recorded at the same time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from jbf.errors import InputError
from jbf.importing.alignment import QUESTION
from jbf.importing.channels import channels_of
from jbf.importing.columns import parse_header
from jbf.importing.expression import OPEN
from jbf.importing.formats.table import Column, Table
from jbf.importing.guessed import Guess, Question
from jbf.importing.mapping import Map
from jbf.importing.recording import aligned
from jbf.importing.side_by_side import SideBySide, stem_of

_NEVER = ("time", "index", "run")
"""Quantities that cannot be a common signal."""


def with_alignment(guess: Guess, source: SideBySide) -> Guess:
    """Add the further files and the section `[align]` to a proposed map, or open questions.

    Dates align files without an entry. Otherwise, if two files have exactly one numeric column in
    common, that column is proposed. The proposal is certain if its records determine the offset.
    """
    guess = replace(guess, beside=source.files[1:])
    align: dict[str, str | float] = {}
    notes: dict[str, str] = {}
    questions = list(guess.questions)
    for file in source.files[1:]:
        stem = stem_of(file)
        if not _is_used(guess, source, file):
            notes[stem] = "not used"
            continue
        note = _try_alignment(guess, source, file, {})
        if isinstance(note, str):
            notes[stem] = note
            continue
        shared = _shared_columns(source, file)
        if len(shared) == 1:
            align[stem] = shared[0]
            note = _try_alignment(guess, source, file, {stem: shared[0]})
            if not isinstance(note, InputError):
                notes[stem] = note or "the only common column"
                continue
            notes[stem] = note.problem
            questions.append(Question(f"align.{stem}", f"{note.problem}; {note.remedy}"))
            continue
        align[stem] = OPEN
        notes[stem] = f"common to both files: {', '.join(shared)}" if shared else "no common column"
        questions.append(Question(f"align.{stem}", QUESTION))
    return replace(guess, align=align, align_notes=notes, questions=tuple(questions))


def _is_used(guess: Guess, source: SideBySide, file: Path) -> bool:
    """Whether the proposed map uses columns of a file, as far as its entries are decided."""
    try:
        channels = channels_of(source, _without_open_columns(guess))
    except InputError:
        return True
    return any(source.file_of(channel.table) == file for channel in channels)


def _without_open_columns(guess: Guess) -> Map:
    """Proposed map without the columns whose expressions are still open."""
    mapping = guess.map()
    columns = {key: text for key, text in mapping.columns.items() if text != OPEN}
    return replace(mapping, columns=columns)


def _try_alignment(
    guess: Guess, source: SideBySide, file: Path, align: Mapping[str, str | float]
) -> str | InputError | None:
    """Align a file with the proposed entry, and describe the result.

    Returns the error if the alignment fails, and None if a time column is still open.
    """
    mapping = replace(_without_open_columns(guess), align=align)
    try:
        every = channels_of(source, mapping)
        channels = [c for c in every if source.file_of(c.table) in (source.path, file)]
        if any(f"[{OPEN}]" in channel.clock for channel in channels):
            return None if align else InputError(problem="a time is unknown")
        with TemporaryDirectory(prefix="jbf-align-") as folder:
            (alignment,) = aligned(source, mapping, channels, Path(folder))
    except InputError as error:
        return error
    if alignment.by == "dates":
        return str(alignment)
    return f"{alignment.brief}: correlation {abs(alignment.correlation or 0.0):.3f}"


def _shared_columns(source: SideBySide, file: Path) -> list[str]:
    """Pairs of equally named columns of the main file and another file, as `[align]` entries."""
    by_name: tuple[dict[str, str], dict[str, str]] = ({}, {})
    for table in source.tables:
        path = source.file_of(table)
        if path in (source.path, file):
            place = by_name[path == file]
            for column in table.columns:
                if _may_be_common(column, table):
                    name = parse_header(column.name).name.lower()
                    place.setdefault(name, f"`{table.name}/{column.name}`")
    return [f"{by_name[0][name]} ~ {by_name[1][name]}" for name in by_name[0] if name in by_name[1]]


def _may_be_common(column: Column, table: Table) -> bool:
    """Whether a column can be a signal that two files have in common."""
    if column.kind != "number" or column.name == table.clock:
        return False
    header = parse_header(column.name, column.unit)
    return header.kind not in _NEVER and column.name != "time_s"
