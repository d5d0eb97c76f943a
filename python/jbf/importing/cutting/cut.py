"""Division of a recording into pieces by the selected cutting methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jbf.errors import InputError
from jbf.importing.channels import CUT_COLUMN, KEPT_COLUMN
from jbf.importing.cutting.changes import cut_at_changes
from jbf.importing.cutting.cycles import cut_at_cycles, cut_into_parts
from jbf.importing.cutting.load_steps import cut_at_load_steps
from jbf.importing.cutting.motion_kinds import cut_at_motion_kinds
from jbf.importing.cutting.piece import Cut, Piece
from jbf.importing.cutting.rests import cut_at_rests
from jbf.importing.cutting.settings import CutSettings
from jbf.importing.formats.table import BLOCK
from jbf.importing.spool import Recording
from jbf.importing.targets import FRICTION, MOTION
from jbf.records.checks import MIN_SAMPLES

TOO_FEW = f", but a run needs at least {MIN_SAMPLES}"
REST_S, KEEP_REST_S = 0.25, 0.1
"""Default shortest rest at which a recording is cut, and the part of it that is kept, s."""
MAX_DISCARDED_SHARE, SHORTEST_S = 0.05, 1.0
"""Largest share of discarded motion, and minimum median duration of runs, s, by default cutting.

The default cutting is rejected outside these limits, so that an axis with stick-slip is not cut at
every stop.
"""


def cut(recording: Recording, settings: CutSettings) -> list[Piece]:
    """Divide a recording into pieces in order of time, including pieces that are omitted."""
    timed = [method for method in settings.by or () if method in ("rests", "cycles", "motion")]
    if recording.steady and timed:
        problem = f'"{timed[0]}" requires a motion over time, but the file contains steady states'
        raise InputError(key="cut.by", problem=problem, remedy="remove it")
    if settings.by is not None or recording.steady:
        return _cut(recording, settings)
    pieces = at_rests_by_default(recording, settings)
    return _cut(recording, replace(settings, by=())) if pieces is None else pieces


def at_rests_by_default(recording: Recording, settings: CutSettings) -> list[Piece] | None:
    """Divide a recording at its rests, if this yields plausible runs; otherwise None.

    The result is not plausible without additional runs, or beyond the limits `MAX_DISCARDED_SHARE`
    and `SHORTEST_S`.
    """
    by_rests = replace(settings, by=("rests",), rest_s=REST_S, keep_rest_s=KEEP_REST_S)
    pieces = _cut(recording, by_rests)
    runs = [p.to_s - p.from_s for p in pieces if p.keep]
    lost = sum(p.to_s - p.from_s for p in pieces if p.why.endswith(TOO_FEW))
    if (
        len(runs) <= recording.segments
        or np.median(runs) < SHORTEST_S
        or lost > MAX_DISCARDED_SHARE * sum(runs)
    ):
        return None
    recording.notes.append(f"cut at its rests into {len(runs)} runs (--no-cut keeps it whole)")
    return pieces


def _cut(recording: Recording, settings: CutSettings) -> list[Piece]:
    cuts: list[Cut] = []
    for method in settings.by or ():
        if method == "rests":
            cuts += cut_at_rests(recording, settings)
        elif method == "load_step":
            cuts += cut_at_load_steps(recording)
        elif method == "cycles":
            found_cycles = cut_at_cycles(recording, settings)
            if not found_cycles:
                recording.notes.append("no cycle was found: the motion has no reversals")
            cuts += found_cycles
        elif method == "parts":
            cuts += cut_into_parts(recording, settings.parts)
        elif method == "motion":
            cuts += cut_at_motion_kinds(recording, settings)
        else:
            cut_stream = recording.stream_of(CUT_COLUMN)
            if cut_stream is None:
                remedy = "name another column"
                raise InputError(
                    file=recording.path,
                    key="cut.column",
                    problem="contains no value",
                    remedy=remedy,
                )
            cuts += cut_at_changes(cut_stream[0], CUT_COLUMN, method.replace("_", " "))
    keep_stream = recording.stream_of(KEPT_COLUMN)
    if keep_stream is not None:
        cuts += cut_at_changes(keep_stream[0], KEPT_COLUMN, "keep")
    pieces: list[Piece] = []
    for segment in range(recording.segments):
        segment_cuts = sorted(
            (c for c in cuts if c.segment == segment), key=lambda c: (c.first_s, c.last_s)
        )
        pieces += _pieces_between(recording, segment, segment_cuts)
    return _name_runs(recording, [_mark_unusable(recording, piece, settings) for piece in pieces])


def ends(recording: Recording, segment: int) -> tuple[float, float]:
    """First and last instant of a segment of increasing time, over all clocks, s."""
    rows = [(stream, stream.segments[segment]) for stream in recording.streams]
    first = min(stream.at(a) for stream, (a, _) in rows)
    return first, max(stream.at(b - 1) for stream, (_, b) in rows)


def _pieces_between(recording: Recording, segment: int, cuts: Sequence[Cut]) -> list[Piece]:
    """Pieces between cuts, and the spans that the cuts remove as omitted pieces."""
    first_s, last_s = ends(recording, segment)
    pieces: list[Piece] = []
    begin = first_s
    file = recording.path.name
    for c in cuts:
        if c.first_s <= begin and c.last_s <= begin and c.first_s != first_s:
            continue
        if c.last_s > begin:
            pieces.append(Piece("", file, segment, begin, c.last_s))
        if c.first_s > max(c.last_s, begin) and _contains_rows(recording, segment, c):
            out = Piece("", file, segment, max(c.last_s, begin), c.first_s, False, c.why)
            pieces.append(out)
        begin = max(begin, c.first_s)
    if begin < last_s:
        pieces.append(Piece("", file, segment, begin, last_s))
    return pieces


def _contains_rows(recording: Recording, segment: int, c: Cut) -> bool:
    """Whether the recording has rows in the span that a cut removes."""
    for stream in recording.streams:
        first, end = stream.rows_between(segment, c.last_s, c.first_s)
        if end - first > 2:
            return True
    return False


def _mark_unusable(recording: Recording, piece: Piece, settings: CutSettings) -> Piece:
    """Mark a piece as omitted if it cannot be a run, with the reason."""
    if not piece.keep:
        return piece
    read = [k for k in FRICTION if any(k in s.columns for s in recording.streams)]
    motion_stream = recording.stream_of(*(read or MOTION))
    if motion_stream is None:
        raise InputError(
            file=recording.path,
            column=next(iter(read), "motion"),
            problem="contains no value",
            remedy="name another column in the map",
        )
    first, end = motion_stream[0].rows_between(piece.segment, piece.from_s, piece.to_s)
    why = ""
    if settings.keep is not None and not _kept(recording, piece):
        why = f"not {settings.keep.text}"
    elif end - first < MIN_SAMPLES:
        why = f"{end - first} samples{TOO_FEW}"
    elif piece.to_s - piece.from_s < settings.shortest_s:
        why = f"shorter than {settings.shortest_s:g} s"
    return Piece(piece.name, piece.file, piece.segment, piece.from_s, piece.to_s, not why, why)


def _kept(recording: Recording, piece: Piece) -> bool:
    """Whether the `keep` condition of the map holds in a piece, from its first known value.

    A single value suffices because the recording is cut where the condition changes.
    """
    keep_stream = recording.stream_of(KEPT_COLUMN)
    if keep_stream is None:
        return False
    stream, key = keep_stream
    first, end = stream.rows_between(piece.segment, piece.from_s, piece.to_s)
    at = stream.columns.index(key)
    for block in stream.blocks(first, end):
        finite = block[np.isfinite(block[:, at]), at]
        if len(finite):
            return bool(finite[0] == 1.0)
    before = stream.read(max(first - BLOCK, 0), first)[:, at]
    finite = before[np.isfinite(before)]
    return bool(len(finite) and finite[-1] == 1.0)


def _name_runs(recording: Recording, pieces: Sequence[Piece]) -> list[Piece]:
    """Name the runs of a recording after its file, with a number if there are several."""
    runs = [piece for piece in pieces if piece.keep]
    digits = len(str(len(runs)))
    number = 0
    named = []
    for p in pieces:
        name = ""
        if p.keep:
            number += 1
            name = recording.name if len(runs) == 1 else f"{recording.name}_{number:0{digits}d}"
        named.append(Piece(name, p.file, p.segment, p.from_s, p.to_s, p.keep, p.why))
    return named
