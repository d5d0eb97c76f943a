"""A look at a file and an import in words: whole texts, and the rows behind them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from jbf.importing.cutting.piece import Piece
from jbf.importing.guessed import Entry, Guess, Question
from jbf.importing.result import Import
from jbf.records.rig import Rig
from jbf.reporting.import_text import (
    channel_rows,
    guess_report,
    import_columns,
    import_report,
    left_out_lines,
    provenance_rows,
    short_import,
)

ENTRIES = (
    Entry("time_s", "t / 1000", "its name"),
    Entry("friction_n", "F [?]", "no unit", sure=False),
)
TIME = {
    "channel": "time_s",
    "made_of": "t",
    "read": [{"unit": "ms"}],
    "unit": "s",
    "rate_hz": 1000.0,
    "clock": "own",
}
FORCE = {
    "channel": "friction_n",
    "made_of": "F - G",
    "read": [{"unit": "kN"}, {"unit": ""}],
    "unit": "N",
    "rate_hz": None,
    "clock": "time_s",
}
CUT = TIME | {"channel": "cut"}


def page_of(name: str = "a.csv", **more: Any) -> dict[str, Any]:
    """A file's page in a ledger."""
    there: dict[str, Any] = {
        "file": name,
        "sha256": "0123456789abcdef",
        "channels": [TIME, CUT, FORCE],
        "dropped": [],
        "notes": [],
        "left_out": [],
    }
    return there | more


def table_of(columns: int, **more: Any) -> Any:
    """A table of a file, as far as a text tells it."""
    return SimpleNamespace(
        **{"name": "", "rows": None, "rate_hz": None, "columns": ("c",) * columns, **more}
    )


def guess_of(*tables: Any, **more: Any) -> Guess:
    return Guess(Path("in/log.csv"), "CSV", tables, **{"entries": ENTRIES, **more})


def made(pieces: Sequence[Piece], *pages: dict[str, Any]) -> Import:
    return Import(Path("out"), Rig(), tuple(pieces), {"files": [*pages]})


def pieces_of(kept: int, out: int = 0) -> list[Piece]:
    """So many runs of a quarter of a second each, and so many pieces that are left out."""
    runs = [Piece(f"r_{k}", "a.csv", 0, k, k + 0.25) for k in range(kept)]
    rest = [Piece("", "a.csv", 0, 50.0 + k, 50.5 + k, False, "at rest") for k in range(out)]
    return runs + rest


def test_a_look_that_leaves_nothing_open_says_what_comes_next() -> None:
    """Columns of each table with its name, rows and rate; the map's lines, open ones marked."""
    said = guess_report(guess_of(table_of(1), table_of(3, name="fast", rows=1, rate_hz=2.5)), "m")
    assert said.splitlines() == [
        "log.csv: CSV, 1 column; 3 columns [fast], 1 row, 2.5 Hz stated",
        "",
        "What was found:",
        "  time_s      t / 1000     (its name)",
        "  friction_n  F [?]     ?  (no unit)",
        "",
        "Nothing is open. m was written, should you want to change it; then",
        "  jbf import in/log.csv --map m --out FOLDER",
    ]


def test_a_look_that_leaves_questions_asks_them() -> None:
    """Each question in a line, and where to answer; no heading without a line of the map."""
    asked = (Question("F", "which unit?"), Question("x", "rad or deg?"))
    said = guess_report(guess_of(table_of(2, rows=2), entries=(), questions=asked), "m.toml")
    assert said.splitlines() == [
        "log.csv: CSV, 2 columns, 2 rows",
        "",
        "Not sure:",
        "  - F: which unit?",
        "  - x: rad or deg?",
        "",
        "m.toml was written: answer there, then",
        "  jbf import in/log.csv --map m.toml --out FOLDER",
    ]


@pytest.mark.parametrize(("count", "named", "more"), [(1, 1, ""), (12, 12, ""), (13, 12, "1")])
def test_columns_of_which_nothing_is_made_are_named_up_to_a_dozen(
    count: int, named: int, more: str
) -> None:
    """Up to twelve with their reasons, then how many more."""
    ignored = {f"q{k:02}": "text" for k in range(count)}
    said = " ".join(guess_report(guess_of(table_of(2), ignored=ignored), "m").split())
    words = ", ".join([f"q{k:02} (text)" for k in range(named)] + [f"and {more} more"] * bool(more))
    assert f"(no unit) Not taken: {words} Nothing is open." in said
    assert "Not taken" not in guess_report(guess_of(table_of(2)), "m")


def test_an_import_is_told_from_runs_to_what_was_left_out() -> None:
    """Runs with their instants, the columns of the first file, and pieces with their reason."""
    found = made(pieces_of(2, 1), page_of(), page_of("b.csv"))
    assert import_report(found).splitlines() == [
        "2 runs of 0.5 s in all, from 2 files:",
        "  r_0  0.0000  to  0.2500 s  of a.csv",
        "  r_1  1.0000  to  1.2500 s  of a.csv",
        "",
        "Columns:",
        "  time_s      t      ms -> s           1000 Hz  clock: own",
        "  friction_n  F - G  kN, no unit -> N           clock: time_s",
        "",
        "Left out:",
        "  50.0000  to  50.5000 s  of a.csv:  at rest",
    ]


def test_an_import_without_a_loss_has_no_heading_for_it() -> None:
    """Neither pieces nor rows were left out, and nothing says so."""
    said = import_report(made(pieces_of(1), page_of()))
    assert said.startswith("1 run of 0.25 s in all, from 1 file:\n")
    assert "Left out:" not in said
    assert "On the way:" not in said


@pytest.mark.parametrize("count", [12, 13, 15])
def test_runs_and_pieces_are_listed_up_to_a_dozen(count: int) -> None:
    """Of more than twelve the number of the others is told, and where they are."""
    lines = import_report(made(pieces_of(count, count), page_of())).splitlines()
    assert lines[0].startswith(f"{count} runs of {0.25 * count:g} s")
    assert [x.split()[0] for x in lines if "of a.csv" in x and "r_" in x] == [
        f"r_{k}" for k in range(12)
    ]
    assert sum("at rest" in line for line in lines) == 12
    assert (f"  and {count - 12} more" in lines) == (count > 12)
    assert (f"  and {count - 12} more: see cut.toml" in lines) == (count > 12)


def test_each_channel_is_told_once_and_the_cut_is_none() -> None:
    """Channel, what it was made of, units, rate, clock; the same of two files is one row."""
    other = FORCE | {"rate_hz": 12.5}
    assert channel_rows([page_of(), page_of("b.csv", channels=[CUT, TIME, other])]) == [
        ("time_s", "t", "ms -> s", "1000 Hz", "clock: own"),
        ("friction_n", "F - G", "kN, no unit -> N", "", "clock: time_s"),
        ("friction_n", "F - G", "kN, no unit -> N", "12.5 Hz", "clock: time_s"),
    ]


def test_rows_that_were_left_out_are_told_with_the_first_of_them() -> None:
    """By file: rows that were dropped, why, where they begin; then its notes."""
    dropped = [{"rows": 1, "why": "no number", "first_row": 7}, {"rows": 3, "why": "an old time"}]
    ledger = {"files": [page_of(dropped=dropped, notes=["a note"]), page_of("b.csv")]}
    assert left_out_lines(ledger) == [
        "",
        "On the way:",
        "  - a.csv: 1 row left out, for no number, the first in row 7",
        "  - a.csv: 3 rows left out, for an old time",
        "  - a.csv: a note",
    ]
    assert left_out_lines({"files": [page_of()]}) == []
    assert "  - a.csv: a note" in import_report(made(pieces_of(1), page_of(notes=["a note"])))


@pytest.mark.parametrize(("kept", "out", "said"), [(1, 2, "1 run"), (2, 0, "2 runs")])
def test_an_import_in_a_line_counts_what_was_kept(kept: int, out: int, said: str) -> None:
    """Runs, not pieces; and files."""
    assert short_import(made(pieces_of(kept, out), page_of())) == f"Import({said} from 1 file: out)"


def test_pieces_as_columns() -> None:
    """One row a piece, what was left out among them."""
    assert import_columns(made(pieces_of(1, 1), page_of())) == {
        "name": ["r_0", ""],
        "file": ["a.csv", "a.csv"],
        "from_s": [0, 50.0],
        "to_s": [0.25, 50.5],
        "keep": [True, False],
        "why": ["", "at rest"],
    }


def test_provenance_names_file_hash_channels_and_losses() -> None:
    """Twelve digits of the hash; a rate where there is one; rows and pieces that were left out."""
    dropped = [{"rows": 3, "why": "no number"}]
    lossy = page_of("b.csv", dropped=dropped, left_out=[{}], channels=[TIME])
    two = page_of("c.csv", left_out=[{}, {}], channels=[FORCE])
    plain = "time_s = t (ms -> s, 1000 Hz); friction_n = F - G (kN, no unit -> N)"
    assert provenance_rows(cast(Any, [{"files": [page_of()]}, {"files": [lossy, two]}])) == [
        ("a.csv", "0123456789ab", plain),
        (
            "b.csv",
            "0123456789ab",
            "time_s = t (ms -> s, 1000 Hz); 3 rows left out: no number; 1 piece left out",
        ),
        ("c.csv", "0123456789ab", "friction_n = F - G (kN, no unit -> N); 2 pieces left out"),
    ]
