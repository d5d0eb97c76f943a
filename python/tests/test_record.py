"""Runs: what is read, what is refused in which words, and that files read back exactly."""

from __future__ import annotations

import pickle
import random
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import numpy as np
import pytest
from jbf.errors import InputError
from jbf.records.csv_file import read_run
from jbf.records.run import Run, require
from jbf.records.run_files import read_runs

HEADER = "time_s,angle_rad,velocity_m_s,friction_n,load_n"
ROWS = [f"{0.02 * i:.3f},{0.1 * i:.5f},0.01,{0.5 - 0.1 * i:.4f},104.0" for i in range(12)]
Write = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def _write(*lines: str, name: str = "a.csv", newline: str = "\n") -> Path:
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes("".join(line + newline for line in lines).encode())
        return path

    return _write


def refusal(path: object, **options: bool) -> str:
    with pytest.raises(InputError) as caught:
        read_run(path, **options)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
    return str(caught.value)


def changed(line: int, cell: int, text: str) -> list[str]:
    """The good rows with one cell replaced; `line` counts as an editor does."""
    rows = [row.split(",") for row in ROWS]
    rows[line - 2][cell] = text
    return [",".join(row) for row in rows]


def test_reads_what_is_there(write: Write) -> None:
    run = read_run(write(HEADER, *ROWS, name="sweep.csv"))
    assert (run.name, len(run)) == ("sweep", 12)
    assert abs(run.duration_s - 0.22) < 1e-12
    assert run.angle_rad is not None
    assert run.angle_rad[3] == 0.3
    assert run.friction_n is not None
    assert run.friction_n[11] == -0.6
    assert run.position_m is None
    assert run.temperature_c is None
    assert run.extra == {}
    assert run.path is not None
    assert run.path.name == "sweep.csv"
    assert "sweep" in repr(run)
    assert "12 samples" in repr(run)
    with pytest.raises(ValueError, match="read-only"):
        run.time_s[0] = 1.0


def test_tolerates_what_spreadsheets_write(write: Write) -> None:
    plain = read_run(write(HEADER, *ROWS))
    crlf = write(
        "# made by hand",
        "",
        " time_s , angle_rad,velocity_m_s,friction_n,load_n ",
        *ROWS,
        "",
        newline="\r\n",
        name="b.csv",
    )
    crlf.write_bytes(b"\xef\xbb\xbf" + crlf.read_bytes())
    semicolons = write(*(line.replace(",", ";") for line in [HEADER, *ROWS]), name="c.csv")
    tabs = write(*(line.replace(",", "\t") for line in [HEADER, *ROWS]), name="d.csv")
    quotes = write(*(",".join(f'"{c}"' for c in line.split(",")) for line in [HEADER, *ROWS]))
    for path in (crlf, semicolons, tabs, quotes):
        columns = read_run(path).columns()
        assert list(columns) == list(plain.columns())
        assert all(np.array_equal(columns[n], a) for n, a in plain.columns().items())


def test_other_columns_are_kept_when_numeric(write: Write) -> None:
    lines = [f"{row},{i},up,{'' if i == 3 else i}" for i, row in enumerate(ROWS)]
    run = read_run(write(HEADER + ",current_a,gear,patchy", *lines))
    assert list(run.extra) == ["current_a"]
    assert run.extra["current_a"].tolist() == list(range(12))
    # A quantity of its own is no slip of position_m, nor is the unnamed index that pandas writes.
    lines = [f"{i},{row},0.1" for i, row in enumerate(ROWS)]
    assert list(read_run(write("," + HEADER + ",position_ref_m", *lines)).extra) == [
        "position_ref_m"
    ]


BAD_HEADERS = [
    (
        "time_s,angle_rad,velocity_ms,friction_n,load_n",
        "velocity_m_s",
        'is missing; did you mean "velocity_ms"? rename it to velocity_m_s',
    ),
    (
        "time_s,angle_rad,velocity_m_s,freection_n,load_n",
        "friction_n",
        'did you mean "freection_n"?',
    ),
    ("time,angle_rad,velocity_m_s,friction_n,load_n", "time_s", 'did you mean "time"?'),
    ("Time_S,angle_rad,velocity_m_s,friction_n,load_n", "time_s", 'did you mean "Time_S"?'),
    ("time_s,angle_rad,velocity,friction_n,load_n", "velocity_m_s", 'did you mean "velocity"?'),
    ("time_s,angle_rad,speed,friction_n,load_n", "velocity_m_s", 'did you mean "speed"?'),
    (
        "time_s,angle_rad,velocity_m_s,current_a,load_n",
        "friction_n",
        "is missing; add it; the header has time_s, angle_rad, velocity_m_s, current_a, load_n",
    ),
    (
        "time_s,angle_deg,velocity_m_s,friction_n,load_n",
        "angle_deg",
        'is not a known column; did you mean "angle_rad"? rename it',
    ),
    ("time_s,angle_rad,velocity_m_s,friction_n,load", "load", 'did you mean "load_n"?'),
    (
        "time_s,angle_rad,velocity_m_s,friction_n,friction_n",
        "friction_n",
        "stands twice in the header; keep one",
    ),
]


@pytest.mark.parametrize(("header", "column", "words"), BAD_HEADERS)
def test_bad_header(write: Write, header: str, column: str, words: str) -> None:
    path = write(header, *ROWS)
    message = refusal(path)
    assert message.startswith(f"{path}, row 1, column {column}: ")
    assert words in message


BAD_CELLS = [
    (17 - 5, 3, "abc", "friction_n", '"abc" is not a number; correct the cell or drop the row'),
    (5, 1, "", "angle_rad", "the cell is empty; fill it or drop the row"),
    (5, 3, "nan", "friction_n", "nan is not a finite number; correct the cell"),
    (6, 2, "-inf", "velocity_m_s", "-inf is not a finite number; correct the cell"),
    (6, 2, "1e999", "velocity_m_s", "inf is not a finite number"),
    (4, 0, "0.020", "time_s", "time repeats at 0.02; sort the rows and drop repeats"),
    (4, 0, "0.001", "time_s", "time runs back from 0.02 to 0.001; sort the rows"),
    (9, 4, "0", "load_n", "a load of 0.0 N is not above zero; correct the cell"),
    (9, 4, "-104", "load_n", "a load of -104.0 N is not above zero; correct the cell"),
    (9, 4, "x" * 500, "load_n", 'xxx..." is not a number; correct the cell'),
]


@pytest.mark.parametrize(("line", "cell", "text", "column", "words"), BAD_CELLS)
def test_bad_cell(write: Write, line: int, cell: int, text: str, column: str, words: str) -> None:
    path = write(HEADER, *changed(line, cell, text))
    message = refusal(path)
    assert message.startswith(f"{path}, row {line}, column {column}: ")
    assert words in message
    assert len(message) < len(str(path)) + 200


def test_row_counts_comments_and_blank_lines(write: Write) -> None:
    rows = changed(5, 3, "abc")
    path = write("# rig 2", "", HEADER, *rows[:2], "", *rows[2:])
    assert refusal(path).startswith(f"{path}, row 8, column friction_n: ")


@pytest.mark.parametrize(
    ("lines", "place", "words"),
    [
        ([HEADER, *ROWS[:4], "0.08,0.4,0.01", *ROWS[5:]], ", row 6",
         "has 3 cells where the header has 5; give every row one cell a column"),
        ([HEADER, *(row + ",1" for row in ROWS)], ", row 2", "has 6 cells where the header has 5"),
        ([], "", "is empty; start with a header such as time_s,velocity_m_s,friction_n"),
        (["# only", "# comments"], "", "is empty; start with a header"),
        ([HEADER], "", "has a header but no samples; add the samples"),
        ([HEADER, *ROWS[:9]], "", "has 9 samples; a run needs at least 10"),
        (ROWS, ", row 1", "holds numbers where the header should be; put a line with the column"),
        ([x.replace(",", " ") for x in [HEADER, *ROWS]], ", row 1",
         "the names are parted by blanks; part the cells with commas"),
        ([x.replace(",", ";").replace(".", ",") for x in [HEADER, *ROWS]],
         ", row 2, column time_s", '"0,000" has a decimal comma; write every number'),
        ([HEADER, *ROWS[:3], '"0.06,0.3', *ROWS[4:]], ", row 5",
         "a quote is not closed; correct the row; one line is one row"),
        ([HEADER.replace("friction", '"friction'), *ROWS], ", row 1", "a quote is not closed"),
        (["a\0b"], "", "is binary, not text"),
    ],
)  # fmt: skip
def test_bad_file(write: Write, lines: list[str], place: str, words: str) -> None:
    path = write(*lines)
    message = refusal(path)
    assert message.startswith(f"{path}{place}: ")
    assert words in message


def test_unreadable(write: Write, tmp_path: Path) -> None:
    good = write(HEADER, *ROWS, name="sweep.csv")
    assert refusal(tmp_path) == f"{tmp_path}: is a folder; name a file in it"
    assert refusal(tmp_path / "sweeep.csv").endswith(
        'the file does not exist; did you mean "sweep.csv"?'
    )
    assert refusal(tmp_path / "no" / "x.csv").endswith("folder does not exist; correct the path")
    good.write_bytes(HEADER.encode() + b"\n1,\xff\n")
    assert refusal(good) == f"{good}, row 2: is not UTF-8 text; save the file as UTF-8"
    good.write_bytes(HEADER.encode("utf-16"))
    assert refusal(good) == f"{good}: is UTF-16 text; save it as UTF-8"


def test_friction_may_be_absent_on_request(write: Write) -> None:
    path = write("time_s,velocity_m_s", *(f"{i},0.1" for i in range(10)))
    assert read_run(path, need_friction=False).friction_n is None
    assert "column friction_n: is missing" in refusal(path)
    # A near miss is still pointed out, lest friction be dropped unseen.
    path = write("time_s,velocity_m_s,friction", *(f"{i},0.1,1" for i in range(10)))
    assert 'did you mean "friction_n"?' in refusal(path, need_friction=False)


def test_require_names_the_column_and_who_needs_it(write: Write) -> None:
    path = write("time_s,velocity_m_s,friction_n", *(f"{i},0.1,1" for i in range(10)))
    run = read_run(path)
    require(run, ["time_s", "friction_n"], "the law")
    with pytest.raises(InputError) as caught:
        require(run, "angle_rad", "the effect position_ripple")
    assert str(caught.value) == (
        f"{path}, column angle_rad: is missing, and the effect position_ripple needs it; "
        "add the column (it has time_s, velocity_m_s, friction_n)"
    )


def test_from_arrays_checks_alike() -> None:
    t = list(range(10))
    run = Run.from_arrays(t, np.zeros(10, np.float32), load_n=[1] * 10, extra={"i_a": t}, name="x")
    assert run.friction_n is None
    assert run.time_s.dtype == np.float64
    assert len(run) == 10

    def message(*args: object, **kwargs: object) -> str:
        with pytest.raises(InputError) as caught:
            Run.from_arrays(*args, name="x", **kwargs)  # type: ignore[arg-type]
        return str(caught.value)

    bad = [0.0] * 10
    bad[3] = float("nan")
    assert message(t, bad).startswith("x, column velocity_m_s: sample 3: nan is not a finite")
    assert message(t[::-1], t) == (
        "x, column time_s: sample 1: time runs back from 9.0 to 8.0; "
        "sort the rows and drop repeats; one file is one run"
    )
    assert "column load_n: sample 0: a load of 0.0 N" in message(t, t, load_n=t)
    assert "has 9 samples where time_s has 10" in message(t, t[:9])
    assert "has 3 samples; a run needs at least 10" in message(t[:3], t[:3])
    assert "column velocity_m_s: holds <U1, not numbers" in message(t, ["a"] * 10)
    assert "holds complex128" in message(t, [1j] * 10)
    assert "has shape (2, 10)" in message(t, [t, t])
    assert "is not an array of numbers" in message(t, [{}, *t[1:]])
    assert "pass it as its own argument" in message(t, t, extra={"load_n": t})


def test_select(write: Write) -> None:
    run = read_run(write(HEADER + ",current_a", *(f"{r},{i}" for i, r in enumerate(ROWS))))
    assert run.select(slice(2, 8, 2)).extra["current_a"].tolist() == [2, 4, 6]
    assert run.friction_n is not None
    part = run.select(run.friction_n > 0)
    assert len(part) == 5
    assert part.load_n is not None
    assert len(part.load_n) == 5
    assert part.name == run.name
    assert part.path == run.path
    assert run.select(slice(0, 0)).duration_s == 0.0
    for wrong in (slice(None, None, -1), [1, 2], np.ones(3, bool)):
        with pytest.raises(InputError):
            run.select(wrong)


def test_files_read_back_bit_for_bit(tmp_path: Path) -> None:
    rng = random.Random(7)
    odd = [5e-324, -5e-324, 2.2e-308, 1e300, -1.7976931348623157e308, -0.0, 0.1, 1 / 3, 1e22, 2**53]
    n = 500
    v = [*odd, *(rng.uniform(-1, 1) * 10.0 ** rng.randint(-320, 300) for _ in range(n - len(odd)))]
    t = np.cumsum([rng.random() + 1e-9 for _ in range(n)])
    # What is known has the size of a machine's; any other column may hold whatever it likes.
    w = np.array([x if abs(x) < 1e12 else 1.0 / x for x in v])
    run = Run.from_arrays(t, w, w[::-1], load_n=np.abs(w) + 5e-324, extra={"odd, name": v})
    run.write_csv(tmp_path / "r.csv")
    back = read_run(tmp_path / "r.csv")
    assert list(back.columns()) == list(run.columns())
    for name, values in run.columns().items():
        assert values.tobytes() == back.columns()[name].tobytes(), name
    assert [p.name for p in tmp_path.iterdir()] == ["r.csv"]


def test_a_failed_write_leaves_nothing(tmp_path: Path) -> None:
    run = Run.from_arrays(range(10), range(10))
    with pytest.raises(InputError, match="its folder does not exist"):
        run.write_csv(tmp_path / "no" / "r.csv")
    with pytest.raises(InputError, match="is a folder"):
        run.write_csv(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_read_runs_takes_files_folders_and_globs(write: Write, tmp_path: Path) -> None:
    for name in ("a/z.csv", "a/b.CSV", "b/z.csv", "b/c.csv"):
        write(HEADER, *ROWS, name=name)
    (tmp_path / "a" / "rig.toml").write_text("")
    assert [run.name for run in read_runs(tmp_path / "a")] == ["b", "z"]
    assert [run.name for run in read_runs([tmp_path / "a", str(tmp_path / "b" / "*.csv")])] == [
        "b", "a/z", "c", "b/z",
    ]  # fmt: skip

    def message(paths: object) -> str:
        with pytest.raises(InputError) as caught:
            read_runs(paths)  # type: ignore[arg-type]
        return str(caught.value)

    twice = tmp_path / "a" / "z.csv"
    assert message([tmp_path / "a", twice]) == f"{twice}: is given twice; name each run once"
    assert "no file matches; correct the pattern" in message(str(tmp_path / "*.dat"))
    assert "the folder holds no .csv file" in message(tmp_path)
    assert "no run is given" in message([])


def test_an_error_travels_between_processes() -> None:
    error = InputError(file="a.csv", row=3, column="load_n", problem="is\nodd", mend="mend it")
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) == "a.csv, row 3, column load_n: is odd; mend it"
    assert (again.row, again.column, again.key) == (3, "load_n", None)


def test_a_cell_costs_no_call_of_its_own(write: Write) -> None:
    """Columns are read as arrays; what is done line by line is to find where lines end.

    Seconds are `benches/reading.py`'s.
    """

    def calls(rows: int) -> int:
        path = write(
            HEADER, *ROWS[:1], *(f"{i}.0,5.4,0.0003,-0.4962,104.0" for i in range(1, rows))
        )
        count = 0

        def counted(_frame: FrameType, event: str, _argument: object) -> None:
            nonlocal count
            count += event in ("call", "c_call")

        before = sys.getprofile()
        sys.setprofile(counted)
        try:
            read_run(path)
        finally:
            sys.setprofile(before)
        return count

    few, many = 1000, 6000
    assert 0 < calls(many) - calls(few) <= 3 * (many - few)
