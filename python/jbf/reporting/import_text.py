"""Text reports of the inspection of a file and of an import."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from jbf.importing.guess_rig import assumed_machine
from jbf.importing.guessed import Guess
from jbf.importing.recording import STEADY
from jbf.importing.result import Import
from jbf.records.counts import count_of
from jbf.reporting.paragraphs import columns, hanging

_MOST = 12
"""Maximum number of runs or pieces in a list; the ledger contains all of them."""


def guess_report(
    guess: Guess, map_path: str, *, files: Sequence[str] = (), kept: bool = False
) -> str:
    """Report the format and contents of a file, and which assignments are certain or uncertain.

    Parameters
    ----------
    files
        All files to import with the map; by default the inspected file.
    kept
        True if a map from an earlier inspection exists and was not overwritten.
    """
    contents = []
    for table in guess.tables:
        name = f" [{table.name}]" if table.name else ""
        rows = "" if table.rows is None else f", {count_of(table.rows, 'row')}"
        rate = "" if table.rate_hz is None else f", {table.rate_hz:g} Hz stated"
        contents.append(f"{count_of(len(table.columns), 'column')}{name}{rows}{rate}")
    further = ", ".join(path.name for path in guess.beside)
    names = f"{guess.path.name} with {further}" if further else guess.path.name
    lines = [f"{names}: {guess.format}, {'; '.join(contents)}"]
    rows_ = [(e.key, e.expression, "" if e.sure else "?", f"({e.why})") for e in guess.entries]
    if rows_:
        lines += ["", "Columns found:", *columns(rows_, "<<<<")]
    if guess.ignored:
        unused = [f"{name} ({why})" for name, why in guess.ignored.items()]
        omitted = [f"and {len(unused) - _MOST} more"] if len(unused) > _MOST else []
        lines += ["", *hanging("Not used: ", ", ".join(unused[:_MOST] + omitted), 0)]
    if guess.align_notes:
        lines += ["", "Clocks:"]
        for stem, note in guess.align_notes.items():
            lines += hanging("- ", f"{stem}: {note}")
    machine = assumed_machine(guess.rig)
    if machine is not None:
        lines += ["", f"Machine: {machine}"]
    if guess.questions:
        lines += ["", "Questions:"]
        for question in guess.questions:
            lines += hanging("- ", str(question))
    if kept:
        lines += ["", f"{map_path} exists and was kept (--force replaces it); continue with"]
    elif guess.questions:
        lines += ["", f"{map_path} was written; answer the questions there, then run"]
    else:
        lines += [
            "",
            f"No questions are open. {map_path} was written; edit it if necessary, then run",
        ]
    names = " ".join(files or [str(guess.path)])
    lines.append(f"  jbf import {names} --map {map_path} --folder FOLDER")
    return "\n".join(lines)


def import_report(campaign: Import) -> str:
    """List the runs, their columns, the clock alignments, and the excluded pieces."""
    runs = [piece for piece in campaign.pieces if piece.keep]
    out = [piece for piece in campaign.pieces if not piece.keep]
    seconds = sum(piece.to_s - piece.from_s for piece in runs)
    files = campaign.ledger["files"]
    steady = any(channel["clock"] == STEADY for channel in files[0]["channels"])
    length = "steady states" if steady else f"{seconds:.4g} s in total"
    lines = [f"{count_of(len(runs), 'run')} of {length}, from {_file_count(files)}:"]
    rows = [
        (piece.name, f"of {piece.file}", "", "", "")
        if steady
        else (piece.name, f"{piece.from_s:.4f}", "to", f"{piece.to_s:.4f} s", f"of {piece.file}")
        for piece in runs[:_MOST]
    ]
    lines += columns(rows, "<><><")
    if len(runs) > _MOST:
        lines.append(f"  and {len(runs) - _MOST} more")
    lines += ["", "Columns:", *columns(channel_rows(files[:1]), "<<<<<")]
    clocks = clock_lines(campaign.ledger)
    lines += ["", "Clocks:", *clocks] if clocks else []
    lines += skipped_row_lines(campaign.ledger)
    if out:
        lines += ["", "Left out:"]
        lines += columns(
            [
                (f"{p.from_s:.4f}", "to", f"{p.to_s:.4f} s", f"of {p.file}:", p.why)
                for p in out[:_MOST]
            ],
            "><<<<",
        )
        if len(out) > _MOST:
            lines.append(f"  and {len(out) - _MOST} more: see cut.toml")
    return "\n".join(lines)


def channel_rows(files: Iterable[Mapping[str, Any]]) -> list[tuple[str, str, str, str, str]]:
    """Name, expression, unit conversion, rate and clock of each imported channel, as text."""
    channels: dict[tuple[str, str, str, str, str], None] = {}
    for page in files:
        for channel in page["channels"]:
            if channel["channel"] == "cut":
                continue
            read = ", ".join(r["unit"] or "no unit" for r in channel["read"])
            rate = "" if channel["rate_hz"] is None else f"{channel['rate_hz']:g} Hz"
            row = (channel["channel"], channel["made_of"], f"{read} -> {channel['unit']}")
            channel_row = (*row, rate, f"clock: {channel['clock']}")
            channels[channel_row] = None
    return list(channels)


def _file_count(files: Sequence[Mapping[str, Any]]) -> str:
    further = sum(len(page.get("beside", ())) for page in files)
    if not further:
        return count_of(len(files), "file")
    return f"{count_of(len(files) + further, 'file')} recorded together"


def clock_lines(ledger: Mapping[str, Any]) -> list[str]:
    """Describe how the clock of each further file was aligned, one line per file."""
    lines = []
    for page in ledger["files"]:
        for further in page.get("beside", ()):
            alignment = further["alignment"]
            how = "no column is used" if alignment is None else alignment["text"]
            lines += hanging("- ", f"{further['file']}: {how}")
    return lines


def skipped_row_lines(ledger: Mapping[str, Any]) -> list[str]:
    """List the excluded rows of each file, and the notes on the file."""
    notes = []
    for page in ledger["files"]:
        for dropped in page["dropped"]:
            first = f", the first in row {dropped['first_row']}" if "first_row" in dropped else ""
            rows = count_of(dropped["rows"], "row")
            file = dropped.get("file", page["file"])
            notes.append(f"{file}: {rows} left out: {dropped['why']}{first}")
        notes += [f"{page['file']}: {note}" for note in page["notes"]]
    return ["", "Notes:", *[line for s in notes for line in hanging("- ", s)]] if notes else []


def short_import(campaign: Import) -> str:
    """Summarize the import in one line."""
    runs = sum(piece.keep for piece in campaign.pieces)
    return (
        f"Import({count_of(runs, 'run')} from {_file_count(campaign.ledger['files'])}: "
        f"{campaign.folder})"
    )


def import_columns(campaign: Import) -> dict[str, list[Any]]:
    """Table of the pieces of an import, one row per piece."""
    names = ("name", "file", "from_s", "to_s", "keep", "why")
    return {name: [getattr(piece, name) for piece in campaign.pieces] for name in names}


def provenance_rows(ledgers: Iterable[Mapping[str, Any]]) -> list[tuple[str, str, str]]:
    """File, hash prefix and description of the reading of each recording, for a page."""
    rows = []
    for ledger in ledgers:
        for page in ledger["files"]:
            channels = "; ".join(
                f"{c} = {expression} ({unit}{', ' + rate if rate else ''})"
                for c, expression, unit, rate, _ in channel_rows([page])
            )
            dropped = "".join(f"; {d['rows']} rows left out: {d['why']}" for d in page["dropped"])
            out = page["left_out"]
            omitted = f"; {count_of(len(out), 'piece')} left out" if out else ""
            rows.append((page["file"], page["sha256"][:12], channels + dropped + omitted))
            for further in page.get("beside", ()):
                alignment = further["alignment"]
                how = "" if alignment is None else alignment["text"]
                rows.append((further["file"], further["sha256"][:12], how))
    return rows
