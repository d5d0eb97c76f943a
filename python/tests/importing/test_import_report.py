"""The report of an import: runs, columns, dropped rows, excluded pieces and file hashes."""

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
    provenance_rows,
    skipped_row_lines,
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
    """Two recordings with two motions each; the first one lacks three values."""
    folder = tmp_path_factory.mktemp("report")
    time = np.arange(0.0, 40.0, 0.02)
    position = np.cumsum(np.where(abs(time % 20.0 - 11.0) < 6.0, np.sin(time), 0.0))
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


def test_import_table_has_each_piece_with_a_reason_if_excluded(imported: jbf.Import) -> None:
    columns = import_columns(imported)
    assert sum(columns["keep"]) == len(imported.runs) == 4
    keys = ("name", "from_s", "to_s", "keep")
    rows = list(zip(*(columns[key] for key in keys), strict=True))
    assert rows == [tuple(getattr(piece, key) for key in keys) for piece in imported.pieces]
    assert all(why for why, keep in zip(columns["why"], columns["keep"], strict=True) if not keep)


def test_import_report_lists_each_channel_once_with_its_conversion(imported: jbf.Import) -> None:
    position, friction = channel_rows(imported.ledger["files"])
    assert (position[0], friction[0]) == ("position_m", "friction_n")
    assert position[2] == "mm -> m"
    assert friction[2].startswith("kN")
    assert friction[2].endswith("-> N")
    np.testing.assert_allclose(imported.runs[0].friction, 1e3, rtol=1e-12)


def test_dropped_rows_are_reported_only_for_the_file_with_gaps(imported: jbf.Import) -> None:
    (line,) = [line for line in skipped_row_lines(imported.ledger) if "row" in line]
    assert "a.csv" in line
    assert "3 rows" in line
    assert skipped_row_lines({"files": [imported.ledger["files"][1] | {"notes": []}]}) == []


def test_provenance_rows_have_the_sha256_of_each_file(folder: Path, imported: jbf.Import) -> None:
    rows = provenance_rows([imported.ledger])
    assert [row[0] for row in rows] == ["a.csv", "b.csv"]
    for name, digest, _ in rows:
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest().startswith(digest)
        assert len(digest) >= 12


def test_text_report_and_html_page_of_an_import_list_every_run(imported: jbf.Import) -> None:
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
    for name in (*(e.key for e in guess.entries), *(q.place for q in guess.questions)):
        assert name in report
