"""One recording in every file format gives bit-identical runs; unreadable files are refused."""

import csv
import json
import sys
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from jbf.errors import InputError
from jbf.importing.formats.registry import FORMATS, format_of, open_source
from long_recording import recording
from recording_files import WRITERS, Columns

MAP = '[columns]\n{columns}\n[cut]\nby = "rests"\n[drive]\nmotion = "linear"\nfriction = "force"\n'
SHORT = recording(3, 10.0, 4.0).columns


def imported(folder: Path, name: str, columns: Columns) -> jbf.Import:
    path = folder / name
    WRITERS[name](path, columns)
    # Formats with a clock need no time column; fields of a structure are named log.FIELD.
    own_clock = name.endswith((".mf4", ".mcap", "bag")) or name.startswith("waveform")
    lead = "log." if name.startswith("structure") else ""
    mapped = [n for n in columns if not (own_clock and n == "time_s")]
    text = "\n".join(f'{n} = "`{lead}{n}`"' for n in mapped)
    if name == "trace.csv":
        text = text.replace('time_s = "`time_s`"', 'time_s = "time [s]"')
    (folder / f"{name}.toml").write_text(MAP.format(columns=text))
    return jbf.import_files(path, folder / f"{name}.toml")


def lines_of_runs(result: jbf.Import) -> list[list[str]]:
    """The lines of each written run."""
    names = [piece.name for piece in result.pieces if piece.keep]
    return [(result.folder / f"{name}.csv").read_text().splitlines() for name in names]


@pytest.fixture(scope="module")
def wanted(tmp_path_factory: pytest.TempPathFactory) -> list[list[str]]:
    """The lines of each run after an import of the recording from a CSV file."""
    return lines_of_runs(imported(tmp_path_factory.mktemp("wanted"), "r.csv", SHORT))


@pytest.fixture
def path(name: str, tmp_path: Path) -> Path:
    """A file in the format with the given name."""
    WRITERS[name](tmp_path / name, SHORT)
    return tmp_path / name


@pytest.mark.parametrize("name", WRITERS)
def test_imported_runs_are_bit_identical_for_a_recording_in_every_format(
    name: str, wanted: list[list[str]], tmp_path: Path
) -> None:
    columns = SHORT
    if name.endswith(".xlsx"):
        # A spreadsheet stores 15 digits of a number.
        columns = {column: np.round(values, 9) for column, values in SHORT.items()}
        (tmp_path / "wanted").mkdir()
        wanted = lines_of_runs(imported(tmp_path / "wanted", "r.csv", columns))
    result = lines_of_runs(imported(tmp_path, name, columns))
    assert len(result) == 3
    assert set(result[0][0].split(",")) == set(SHORT)
    for run, from_csv in zip(result, wanted, strict=True):
        assert list(csv.DictReader(run)) == list(csv.DictReader(from_csv))


def test_values_imported_from_csv_equal_the_recording(wanted: list[list[str]]) -> None:
    rows = list(csv.DictReader(wanted[1]))
    first = SHORT["time_s"].tolist().index(float(rows[0]["time_s"]))
    for column in rows[0]:
        values = [float(row[column]) for row in rows]
        assert values == SHORT[column][first : first + len(rows)].tolist()


@pytest.mark.parametrize("name", WRITERS)
def test_file_format_is_recognised_by_the_first_bytes(name: str, path: Path) -> None:
    if name.endswith((".csv", ".xlsx", ".npz")) or path.is_dir():
        pytest.skip("text, archives and folders are recognised by their names")
    known = format_of(path)
    assert format_of(path.rename(path.with_name("nameless"))) is known


TEXTS = ("bag", "r.csv", "trace.csv", "r.jsonl")
"""Formats of lines, whose truncated last line is ignored, and a folder."""


# asammdf closes a truncated file twice.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", [n for n in WRITERS if n not in TEXTS])
def test_truncated_file_is_refused_in_one_line_and_writes_nothing(name: str, path: Path) -> None:
    data, folder = path.read_bytes(), path.parent
    path.write_bytes(data[: len(data) // 2])
    with pytest.raises(InputError) as refused:
        jbf.import_files(path, out=folder / "out")
    assert "\n" not in str(refused.value)
    assert str(path) in str(refused.value)
    assert [p.name for p in folder.iterdir()] == [name]


@pytest.mark.parametrize("known", [f for f in FORMATS if f.extra], ids=lambda f: f.extra)
def test_missing_library_of_a_format_is_reported_with_the_extra_to_install(
    known: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"a{(known.suffixes or ('.mat',))[0]}"
    path.write_bytes(bytes(known.magic_at) + (known.magic or (b"PK\x03\x04",))[0])
    module = f"jbf.importing.formats.{known.opener.partition(':')[0]}"
    monkeypatch.delitem(sys.modules, module, raising=False)
    libraries = ("openpyxl", "h5py", "pyarrow", "nptdms", "asammdf", "mcap", "mcap_ros2", "rosbags")
    imported_before = [name for name in sys.modules if name.partition(".")[0] in libraries]
    for name in (*libraries, *imported_before):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(InputError, match=rf"pip install 'jbf\[{known.extra}\]'"):
        open_source(path)


def test_joint_states_in_json_lines_are_rows_with_a_column_for_each_joint(tmp_path: Path) -> None:
    time = np.arange(100) / 50.0
    lines = []
    for k, t in enumerate(time.tolist()):
        stamp = {"sec": 1_700_000_000 + k // 50, "nanosec": 20_000_000 * (k % 50)}
        position = [float(np.sin(t)), 2.0 * t]
        velocity, effort = [float(np.cos(t)), 2.0], [1.0 + k, 2.0 + k]
        state = {"position": position, "velocity": velocity, "effort": effort}
        lines.append(json.dumps({"header": {"stamp": stamp}, **state}))
    path = tmp_path / "states.jsonl"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="contains the joints 0, 1"):
        jbf.look(path)
    with open_source(path) as source:
        head = source.head(source.tables[0])
    np.testing.assert_array_equal(head["effort[1]"], 2.0 + np.arange(100))
    np.testing.assert_allclose(np.diff(head["header.stamp"]), 0.02, atol=1e-6)


def test_list_of_recordings_in_json_is_one_table_with_the_number_of_the_run(tmp_path: Path) -> None:
    data = [{"type": "chirp", "position": [0.0, k, 2.0 * k], "torque": [1, 2, 3]} for k in (1, 2)]
    path = tmp_path / "log.json"
    path.write_text(json.dumps({"config": {"hz": 50}, "data": data}))
    with open_source(path) as source:
        (table,) = source.tables
        head = source.head(table)
    assert table.rate_hz == 50.0
    assert head["run"].tolist() == [1, 1, 1, 2, 2, 2]
    assert head["position"].tolist() == [0, 1, 2, 0, 2, 4]


@pytest.mark.parametrize("version", ["v7", "v7.3"])
@pytest.mark.filterwarnings("ignore:.*timedelta64")
def test_matlab_timetable_is_imported_with_its_row_times(version: str, tmp_path: Path) -> None:
    matio = pytest.importorskip("matio")
    pandas = pytest.importorskip("pandas")
    time = pandas.to_timedelta(np.arange(400) * 20, unit="ms").astype("timedelta64[ms]")
    columns = {name: SHORT[name][:400] for name in ("position_m", "friction_n")}
    frame = pandas.DataFrame(columns, index=time.rename("Time"))
    matio.save_to_mat(str(tmp_path / "t.mat"), {"log": frame}, version=version)
    (run,) = jbf.import_files(tmp_path / "t.mat").runs
    np.testing.assert_array_equal(run.time_s, np.arange(400) / 50.0)
    np.testing.assert_array_equal(run.friction, columns["friction_n"])
