"""One recording in every file format gives bit-identical runs; unreadable files are refused."""

from __future__ import annotations

import builtins
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

MAP = """\
[columns]
{columns}
[cut]
by = "rests"
[drive]
motion = "linear"
friction = "force"
"""


def imported(folder: Path, name: str, columns: Columns) -> jbf.Import:
    path = folder / name
    WRITERS[name](path, columns)
    # Formats with a clock need no time column; fields of a structure are named log.FIELD.
    own_clock = name.endswith((".mf4", ".mcap", "bag")) or name.startswith("waveform")
    lead = "log." if name.startswith("structure") else ""
    made = [n for n in columns if not (own_clock and n == "time_s")]
    text = "\n".join(f'{n} = "`{lead}{n}`"' for n in made)
    (folder / f"{name}.toml").write_text(MAP.format(columns=text))
    return jbf.import_files(path, folder / f"{name}.toml")


def lines_of_runs(result: jbf.Import) -> list[list[str]]:
    """The lines of each written run."""
    names = [piece.name for piece in result.pieces if piece.keep]
    return [(result.folder / f"{name}.csv").read_text().splitlines() for name in names]


@pytest.fixture(scope="module")
def short() -> Columns:
    return recording(3, 10.0, 4.0).columns


@pytest.fixture(scope="module")
def wanted(short: Columns, tmp_path_factory: pytest.TempPathFactory) -> list[list[str]]:
    return lines_of_runs(imported(tmp_path_factory.mktemp("wanted"), "r.csv", short))


@pytest.mark.parametrize("name", WRITERS)
def test_recording_in_every_format_gives_bit_identical_runs(
    name: str, short: Columns, wanted: list[list[str]], tmp_path: Path
) -> None:
    if name.endswith(".xlsx"):
        # A spreadsheet stores 15 digits of a number.
        short = {column: np.round(values, 9) for column, values in short.items()}
        (tmp_path / "wanted").mkdir()
        wanted = lines_of_runs(imported(tmp_path / "wanted", "r.csv", short))
    result = lines_of_runs(imported(tmp_path, name, short))
    assert len(result) == 3
    header = result[0][0].split(",")
    assert set(header) == set(short)
    order = [header.index(column) for column in wanted[0][0].split(",")]
    for run, as_csv in zip(result, wanted, strict=True):
        sorted_run = [",".join(line.split(",")[i] for i in order) for line in run]
        assert sorted_run == as_csv


def test_imported_values_equal_the_recorded_arrays(short: Columns, wanted: list[list[str]]) -> None:
    table = np.array([[float(c) for c in line.split(",")] for line in wanted[1][1:]])
    header = wanted[1][0].split(",")
    first = np.flatnonzero(short["time_s"] == table[0, header.index("time_s")])[0]
    for at, column in enumerate(header):
        np.testing.assert_array_equal(table[:, at], short[column][first : first + len(table)])


@pytest.mark.parametrize("name", WRITERS)
def test_format_is_recognised_by_its_first_bytes(name: str, short: Columns, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path, short)
    if name.endswith((".csv", ".xlsx", ".npz")) or path.is_dir():
        pytest.skip("text, archives and folders are recognised by their names")
    known = format_of(path)
    renamed = path.rename(tmp_path / "nameless")
    assert format_of(renamed) is known


# asammdf closes a truncated file twice.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", [n for n in WRITERS if n not in ("bag", "r.csv")])
def test_truncated_file_is_refused_in_one_line_and_writes_no_output(
    name: str, short: Columns, tmp_path: Path
) -> None:
    path = tmp_path / name
    WRITERS[name](path, short)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    with pytest.raises(InputError) as refused:
        jbf.import_files(path, out=tmp_path / "out")
    assert "\n" not in str(refused.value)
    assert str(path) in str(refused.value)
    assert not (tmp_path / "out").exists()
    assert [p.name for p in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("known", [f for f in FORMATS if f.extra], ids=lambda f: f.extra)
def test_missing_library_of_a_format_is_reported_with_the_extra_to_install(
    known: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"a{(known.suffixes or ('.mat',))[0]}"
    path.write_bytes(bytes(known.magic_at) + (known.magic or (b"PK\x03\x04",))[0])
    module = f"jbf.importing.formats.{known.opener.partition(':')[0]}"
    monkeypatch.delitem(sys.modules, module, raising=False)
    real = builtins.__import__
    libraries = ("openpyxl", "h5py", "pyarrow", "nptdms", "asammdf", "mcap", "mcap_ros2", "rosbags")

    def absent(name: str, *rest: Any, **named: Any) -> Any:
        if name.partition(".")[0] in libraries:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return real(name, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", absent)
    with pytest.raises(InputError, match=rf"pip install 'jbf\[{known.extra}\]'"):
        open_source(path)


@pytest.mark.parametrize("version", ["v7", "v7.3"])
@pytest.mark.filterwarnings("ignore:.*timedelta64")
def test_matlab_timetable_is_imported_with_its_row_times(
    version: str, short: Columns, tmp_path: Path
) -> None:
    matio = pytest.importorskip("matio")
    pandas = pytest.importorskip("pandas")
    time = pandas.to_timedelta(np.arange(400) * 20, unit="ms").astype("timedelta64[ms]")
    own = {name: short[name][:400] for name in ("position_m", "friction_n")}
    frame = pandas.DataFrame(own, index=time)
    frame.index.name = "Time"
    path = tmp_path / "t.mat"
    matio.save_to_mat(str(path), {"log": frame}, version=version)
    (run,) = jbf.import_files(path).runs
    np.testing.assert_array_equal(run.time_s, np.arange(400) / 50.0)
    np.testing.assert_array_equal(run.friction_n, own["friction_n"])
