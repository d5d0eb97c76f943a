"""Exports of TwinCAT Scope and other files with several tables keep the times of each channel."""

from pathlib import Path

import jbf
import numpy as np
import numpy.typing as npt
import pytest
from input_errors import input_error
from jbf.errors import InputError
from jbf.importing.formats.registry import open_source
from jbf.importing.formats.table import Source, Values

Array = npt.NDArray[np.float64]
START = 132_959_733_843_760_000
"""File time of the first sample: 2022-05-02, 13:56:24.376 UTC."""
UNITS = {"Position": "mm (Length)", "Speed": "mm/s (Velocity)", "Force": "N (Force)"}
TIME_MS = {"Position": np.arange(800) * 1.0, "Speed": np.arange(800) * 1.0}
TIME_MS["Force"] = np.arange(160) * 5.0
VALUES = {
    "Position": np.round(20.0 * np.sin(TIME_MS["Position"] / 300.0), 4),
    "Speed": np.round(20.0 / 0.3 * np.cos(TIME_MS["Speed"] / 300.0), 4),
    "Force": np.round(3.0 + np.cos(TIME_MS["Force"] / 300.0), 4),
}
PERIOD_MS = {"Position": "1", "Speed": "1", "Force": "5"}


def write(
    path: Path,
    delimiter: str = ";",
    decimal: str = ",",
    timelines: str = "all",
    full_timestamp: bool = False,
    eof: bool = True,
    heads: tuple[str, str] = ("Starttime of export", "Endtime of export"),
) -> None:
    """Write an export in the layout of the scope; a column is the list of its texts."""
    columns: list[list[str]] = []
    keys = ["Name", "SymbolComment", "Data-Type", "SampleTime[ms]", "SymbolName", "NetID", "Port"]
    last = None
    for name, values in VALUES.items():
        times = TIME_MS[name]
        shared = timelines == "sampletime" and last == PERIOD_MS[name]
        if timelines != "none" and not shared:
            ticks = [f"{START + round(1e4 * t)}" for t in times.tolist()]
            shown = ticks if full_timestamp else [f"{t:g}" for t in times.tolist()]
            columns.append([*keys, "Unit", *shown])
        last = PERIOD_MS[name]
        head = [name, "", "REAL64", last, f"MAIN.{name}", "5.1.2.3.1.1", "851", UNITS[name]]
        columns.append([*head, *(f"{v:.4f}" for v in values.tolist())])
    if timelines == "none":
        columns.insert(0, [*keys, "Unit", *[""] * 800])
    lines = ["Name;export", "File;C:\\export.csv"]
    lines += [f"{head};{START};Montag, 2. Mai 2022;15:56:24.376" for head in heads]
    lines += ["", ""]
    for at in range(max(map(len, columns))):
        cells = [column[at] if at < len(column) else "" for column in columns]
        lines.append(";".join(cells).rstrip(";") if at > 8 else ";".join(cells))
        if at == 7:
            lines.append("")
    table = "\n".join(lines).replace(";", delimiter)
    body = table.replace(".", decimal) if decimal != "." else table
    path.write_text(body + ("\nEOF\n" if eof else "\n"), encoding="utf-8")


def channels(source: Source) -> dict[str, tuple[Values, Values, str, str]]:
    """Times, values, unit of the times and unit of the values of each channel."""
    by_name = {}
    for table in source.tables:
        head = source.head(table)
        clock, *others = table.columns
        for column in others:
            by_name[column.name] = (head[clock.name], head[column.name], clock.unit, column.unit)
    return by_name


@pytest.mark.parametrize("timelines", ["all", "sampletime"])
@pytest.mark.parametrize(("delimiter", "decimal"), [(";", ","), ("\t", "."), ("\t", ",")])
def test_twincat_export_keeps_the_times_of_each_channel(
    delimiter: str, decimal: str, timelines: str, tmp_path: Path
) -> None:
    write(tmp_path / "a.csv", delimiter, decimal, timelines)
    with open_source(tmp_path / "a.csv") as source:
        found = channels(source)
        names = [table.name for table in source.tables]
    assert names == ["Position, Speed", "Force"]
    for name in VALUES:
        times, values, time_unit, unit = found[name]
        np.testing.assert_array_equal(times, TIME_MS[name])
        np.testing.assert_array_equal(values, VALUES[name])
        assert (time_unit, unit) == ("ms", UNITS[name].partition(" ")[0])


def test_twincat_export_is_imported_without_a_map(tmp_path: Path) -> None:
    write(tmp_path / "a.csv")
    guess = jbf.look(tmp_path / "a.csv")
    assert guess.sure, guess.questions
    (run,) = jbf.import_files(tmp_path / "a.csv", whole=True).runs
    np.testing.assert_allclose(run.time_s, TIME_MS["Position"] / 1e3, rtol=1e-15)
    np.testing.assert_allclose(run.position_m, VALUES["Position"] / 1e3, rtol=1e-15)
    np.testing.assert_array_equal(run.friction[::5], VALUES["Force"])


def test_twincat_export_with_full_timestamps_counts_from_its_first_sample(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", full_timestamp=True)
    with open_source(tmp_path / "a.csv") as source:
        found = channels(source)
        assert {table.start for table in source.tables} == {"2022-05-02T13:56:24.376000000"}
    for name in VALUES:
        np.testing.assert_allclose(found[name][0], TIME_MS[name] / 1e3, atol=1e-9)
    assert jbf.look(tmp_path / "a.csv").sure


def test_twincat_export_without_timelines_takes_rates_from_the_sample_times(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", timelines="none")
    with open_source(tmp_path / "a.csv") as source:
        rates = {column.name: t.rate_hz for t in source.tables for column in t.columns}
    assert rates == {"Position": 1000.0, "Speed": 1000.0, "Force": 200.0}


def test_twincat_export_whose_samples_lack_the_columns_of_times_is_read(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", timelines="none")
    lines = (tmp_path / "a.csv").read_text().splitlines()
    first = next(at for at, line in enumerate(lines) if line.startswith("Unit")) + 1
    lines[first:] = [line.removeprefix(";") for line in lines[first:]]
    (tmp_path / "a.csv").write_text("\n".join(lines))
    with open_source(tmp_path / "a.csv") as source:
        fast, slow = source.tables
        speed, force = source.head(fast)["Speed"], source.head(slow)["Force"]
    assert (fast.rate_hz, slow.rate_hz) == (1000.0, 200.0)
    np.testing.assert_array_equal(speed, VALUES["Speed"])
    np.testing.assert_array_equal(force[np.isfinite(force)], VALUES["Force"])


def test_twincat_channel_that_begins_later_keeps_its_times(tmp_path: Path) -> None:
    lines = [
        "Name;a",
        "",
        "Name;A;Name;B",
        "SampleTime[ms];1;SampleTime[ms];1",
        "Port;1;Port;1",
        "",
    ]
    lines += [f"{k};{2 * k}" + (f";{k + 0.5};{3 * k}" if k > 9 else "") for k in range(50)]
    (tmp_path / "a.csv").write_text("\n".join(lines))
    with open_source(tmp_path / "a.csv") as source:
        found = channels(source)
    np.testing.assert_array_equal(found["A"][1], 2.0 * np.arange(50))
    np.testing.assert_array_equal(found["B"][0], np.arange(10, 50) + 0.5)
    np.testing.assert_array_equal(found["B"][1], 3.0 * np.arange(10, 50))


def test_twincat_export_with_the_older_header_is_read(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", heads=("StartRecord", "EndRecord"), eof=False)
    with open_source(tmp_path / "a.csv") as source:
        assert set(channels(source)) == set(VALUES)


@pytest.mark.parametrize("share", [0.02, 0.05, 0.3, 0.7, 0.99])
def test_truncated_twincat_export_returns_its_complete_samples_or_a_one_line_error(
    share: float, tmp_path: Path
) -> None:
    path = tmp_path / "a.csv"
    write(path)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    if share < 0.05:
        with pytest.raises(InputError) as refused:
            open_source(path)
        assert "\n" not in str(refused.value)
        return
    with open_source(path) as source:
        found = channels(source)
    values = found["Position"][1]
    np.testing.assert_array_equal(values[:-1], VALUES["Position"][: len(values) - 1])


def test_twincat_export_separated_by_blanks_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", " ", ".", "sampletime")
    error = input_error(open_source, tmp_path / "a.csv")
    assert error.file == str(tmp_path / "a.csv")


def test_damaged_cell_of_a_twincat_export_is_reported_with_row_and_column(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    write(path)
    lines = path.read_text().splitlines()
    for row in (40, 60, 61):
        lines[row] = lines[row].replace(",", "x", 1)
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match=r"row 41, column Position: .* is not a number"):
        jbf.import_files(path, whole=True)


def test_tables_side_by_side_in_a_file_keep_their_separate_times(tmp_path: Path) -> None:
    fast, slow = np.arange(400) / 100.0, np.arange(100) / 25.0
    lines = ["Time [s];Position [mm];Velocity [mm/s];Time [s];Force [N]"]
    for k, t in enumerate(fast.tolist()):
        own = f";{float(slow[k])!r};{2.0 + k}" if k < 100 else ";;"
        lines.append(f"{t!r};{5.0 * t!r};5.0{own}")
    (tmp_path / "a.csv").write_text("\n".join(lines))
    with open_source(tmp_path / "a.csv") as source:
        found = channels(source)
    np.testing.assert_array_equal(found["Position [mm]"][0], fast)
    np.testing.assert_array_equal(found["Force [N]"][0], slow)
    np.testing.assert_array_equal(found["Force [N]"][1], 2.0 + np.arange(100))
    assert jbf.look(tmp_path / "a.csv").sure
