"""The report of an import: runs, columns, dropped rows, excluded pieces and file hashes."""

from __future__ import annotations

import hashlib
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.reporting.cut_plot import import_page
from jbf.reporting.import_text import (
    channel_rows,
    guess_report,
    import_columns,
    import_report,
    left_out_lines,
    provenance_rows,
)

MAP = """\
[columns]
time_s = "t [ms]"
position_m = "x [mm]"
friction_n = "F [kN] - Zero [kN]"
[cut]
by = "rests"
[drive]
motion = "linear"
friction = "force"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings with two motions each; the first one misses three values."""
    folder = tmp_path_factory.mktemp("report")
    time = np.arange(0.0, 40.0, 0.02)
    moving = (time % 20.0 > 5.0) & (time % 20.0 < 17.0)
    position = np.cumsum(np.where(moving, np.sin(time), 0.0))
    for name, holes in (("a.csv", (100, 101, 700)), ("b.csv", ())):
        rows = [
            f"{1e3 * t!r},{x!r},{'' if i in holes else 2.0},1.0"
            for i, (t, x) in enumerate(zip(time.tolist(), position.tolist(), strict=True))
        ]
        (folder / name).write_text("t,x,F,Zero\n" + "\n".join(rows) + "\n")
    (folder / "map.toml").write_text(MAP)
    return folder


@pytest.fixture(scope="module")
def imported(folder: Path) -> jbf.Import:
    return jbf.import_files([folder / "a.csv", folder / "b.csv"], folder / "map.toml")


def test_import_table_has_a_row_for_each_piece_and_a_reason_for_each_excluded_one(
    imported: jbf.Import,
) -> None:
    columns = import_columns(imported)
    assert sum(columns["keep"]) == len(imported.runs) == 4
    for piece, name, begin, end, keep in zip(
        imported.pieces,
        columns["name"],
        columns["from_s"],
        columns["to_s"],
        columns["keep"],
        strict=True,
    ):
        assert (piece.name, piece.from_s, piece.to_s, piece.keep) == (name, begin, end, keep)
    kept = np.array(columns["keep"])
    assert all(reason for reason, keep in zip(columns["why"], kept, strict=True) if not keep)


def test_each_channel_is_listed_once_with_its_conversion_of_units(imported: jbf.Import) -> None:
    rows = channel_rows(imported.ledger["files"])
    assert [row[0] for row in rows] == ["position_m", "friction_n"]
    position, friction = rows
    assert position[2] == "mm -> m"
    assert friction[2].startswith("kN")
    assert friction[2].endswith("-> N")
    np.testing.assert_allclose(imported.runs[0].friction_n, 1e3, rtol=1e-12)


def test_dropped_rows_are_counted_for_their_file_only(imported: jbf.Import) -> None:
    lines = [line for line in left_out_lines(imported.ledger) if "row" in line]
    (line,) = lines
    assert "a.csv" in line
    assert "3 rows" in line
    assert left_out_lines({"files": [imported.ledger["files"][1] | {"notes": []}]}) == []


def test_provenance_contains_the_sha256_of_each_file(folder: Path, imported: jbf.Import) -> None:
    rows = provenance_rows([imported.ledger])
    assert [row[0] for row in rows] == ["a.csv", "b.csv"]
    for name, digest, _ in rows:
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest().startswith(digest)
        assert len(digest) >= 12


def test_text_report_and_html_page_list_every_run(imported: jbf.Import) -> None:
    text, page = import_report(imported), import_page(imported)
    for run in imported.runs:
        assert run.name in text
        assert run.name in page
    assert "<svg" in page


def test_report_of_look_lists_guessed_entries_and_open_questions(tmp_path: Path) -> None:
    rows = "".join(f"{i},{i},{i}\n" for i in range(20))
    (tmp_path / "log.csv").write_text("time,Weg [mm],Kraft [N]\n" + rows)
    guess = jbf.look(tmp_path / "log.csv")
    report = guess_report(guess, "map.toml")
    assert len(guess.questions) == 1
    for entry in guess.entries:
        assert entry.key in report
    for question in guess.questions:
        assert question.place in report
