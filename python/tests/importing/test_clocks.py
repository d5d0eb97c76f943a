"""Channels with separate clocks are not resampled; missing samples are empty cells."""

import csv
from collections.abc import Iterable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jbf import Import, import_files, look
from jbf.errors import InputError

DRIVE = '[drive]\nmotion = "linear"\nfriction = "force"\n'
TWO_CLOCKS = (
    '[columns]\ntime_s = "a [s]"\nposition_m = "x [m]"\nfriction_n = "f [N]"\n'
    f'[clocks]\nfriction_n = "b [s]"\n{DRIVE}'
)


def imported(folder: Path, text: str, **columns: np.ndarray) -> Import:
    """The import of an NPZ file with the given map."""
    np.savez(folder / "log.npz", **columns)  # type: ignore[arg-type]
    (folder / "map.toml").write_text(text)
    return import_files(folder / "log.npz", folder / "map.toml")


def text_file(folder: Path, rows: Iterable[str], header: str) -> Path:
    (folder / "log.csv").write_text("\n".join([header, *rows]) + "\n")
    return folder / "log.csv"


def cells(result: Import, column: str) -> tuple[list[float], list[float]]:
    """Time stamps (s) and values of the cells of a column that are not empty."""
    with (result.folder / f"{result.pieces[0].name}.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row[column]]
    return [float(row["time_s"]) for row in rows], [float(row[column]) for row in rows]


def test_samples_of_two_clocks_are_merged_in_time_order(tmp_path: Path) -> None:
    fast, slow = np.arange(4000) / 1000.0, np.arange(800) / 200.0 + 0.0002
    text = (
        '[columns]\ntime_s = "t_x [s]"\nposition_m = "x_mm"\nfriction_n = "force [N]"\n'
        f'[clocks]\nfriction_n = "t_f [ms]"\n{DRIVE}'
    )
    result = imported(tmp_path, text, t_x=fast, x_mm=np.sin(fast), t_f=slow * 1e3, force=slow**2)
    time, _ = cells(result, "time_s")
    assert (np.diff(time) > 0.0).all()
    assert len(time) == 4800
    assert cells(result, "position_m") == (fast.tolist(), (np.sin(fast) / 1000.0).tolist())
    force_time, force = cells(result, "friction_n")
    assert force == (slow**2).tolist()
    assert force_time == pytest.approx(slow, abs=1e-12)
    rates = {c["channel"]: c["rate_hz"] for c in result.ledger["files"][0]["channels"]}
    assert rates == {"position_m": 1000.0, "friction_n": 200.0}


@pytest.mark.parametrize(
    ("samples", "slow"),
    [
        *((10_000, 0.0103 + np.arange(int(9.9 * hz)) / hz) for hz in (20.0, 7.0, 900.0)),
        # One channel has a hundredth of the rate, another a gap of 80 s.
        (180_000, np.concatenate((np.arange(100), np.arange(900, 1790))) / 10.0),
    ],
    ids=["20 Hz", "7 Hz", "900 Hz", "gap"],
)
def test_run_with_two_clocks_keeps_every_sample(samples: int, slow: Any, tmp_path: Path) -> None:
    fast = np.arange(samples) / 1000.0
    (run,) = imported(tmp_path, TWO_CLOCKS, a=fast, x=np.sin(fast), b=slow, f=np.cos(slow)).runs
    force = run.read["friction_n"]
    # In the case with a gap each sample of the force coincides with one of the position.
    position = run.read.get("position_m", np.ones(len(run), dtype=bool))
    np.testing.assert_array_equal(run.time_s[force], slow)
    np.testing.assert_array_equal(run.friction[force], np.cos(slow))
    np.testing.assert_array_equal(run.position_m[position], np.sin(fast))


JBF_HEADER = "time_s,position_m,friction_n"


def test_rows_with_an_empty_cell_are_kept_if_four_of_five_rows_have_one(tmp_path: Path) -> None:
    rows = (f"{i / 100},{i / 1000},{'' if i % 5 else '1.5'}" for i in range(1000))
    result = import_files(text_file(tmp_path, rows, JBF_HEADER))
    assert len(cells(result, "time_s")[0]) == 1000
    assert len(cells(result, "friction_n")[0]) == 200
    assert result.ledger["files"][0]["dropped"] == []


def test_rows_with_an_empty_cell_are_dropped_and_reported_if_they_are_few(tmp_path: Path) -> None:
    rows = (f"{i / 100},{i / 1000},{'' if i % 250 == 1 else '1.5'}" for i in range(1000))
    result = import_files(text_file(tmp_path, rows, JBF_HEADER))
    assert len(result.runs[0]) == 996
    assert result.ledger["files"][0]["dropped"] == [{"rows": 4, "why": "a value is missing"}]
    assert "4 rows left out" in result.summary()


def test_row_with_a_repeated_time_stamp_is_dropped_and_reported(tmp_path: Path) -> None:
    rows = [f"{i // 2 if i == 41 else i / 2},{i},1.0" for i in range(100)]
    rows[41] = rows[40].replace(",40,", ",41,")
    (dropped,) = import_files(text_file(tmp_path, rows, JBF_HEADER)).ledger["files"][0]["dropped"]
    assert dropped == {"rows": 1, "why": "time repeats", "first_row": 43}


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([*range(1000, 1050), *range(50), *range(25, 60)], r"row 102: .*time decreases"),
        ([i // 10 for i in range(200)], "the clock is too coarse"),
    ],
    ids=["back", "coarse"],
)
def test_time_that_decreases_after_a_restart_or_repeats_ten_times_is_refused(
    times: list[int], message: str, tmp_path: Path
) -> None:
    rows = (f"{t},{i},1.0" for i, t in enumerate(times))
    with pytest.raises(InputError, match=message):
        import_files(text_file(tmp_path, rows, JBF_HEADER))


def test_expression_of_channels_with_different_clocks_is_refused(tmp_path: Path) -> None:
    time, slow = np.arange(100) / 10.0, np.arange(50) / 5.0
    columns = 'time_s = "a [s]"\nposition_m = "x [m]"\nfriction_n = "f [N] - x [N]"\n'
    with pytest.raises(InputError, match="different clocks"):
        imported(tmp_path, f"[columns]\n{columns}{DRIVE}", a=time, x=time, b=slow, f=slow)


def test_angle_recorded_modulo_360_degrees_is_unwrapped_and_reported(tmp_path: Path) -> None:
    time = np.arange(1000) / 100.0
    angle = 200.0 * np.sin(time)
    rows = (f"{t},{a!r},1.0" for t, a in zip(time.tolist(), (angle % 360.0).tolist(), strict=True))
    result = import_files(text_file(tmp_path, rows, "t [s],angle [deg],M [Nm]"))
    np.testing.assert_allclose(result.runs[0].angle_rad, np.radians(angle), atol=1e-9)
    assert "whole revolutions were added" in result.summary()


def test_tdms_waveforms_with_different_starts_keep_their_relative_times(tmp_path: Path) -> None:
    nptdms = pytest.importorskip("nptdms")
    start = np.datetime64("2026-11-22T10:00:00.000000")

    def channel(name: str, unit: str, begin: np.datetime64) -> object:
        properties = {"wf_increment": 0.01, "unit_string": unit, "wf_start_time": begin}
        return nptdms.ChannelObject("log", name, np.sin(np.arange(400.0)), properties)

    force = channel("Force", "N", start + np.timedelta64(1_500, "ms"))
    with nptdms.TdmsWriter(tmp_path / "w.tdms") as writer:
        writer.write_segment([force, channel("Position", "mm", start)])
    result = import_files(tmp_path / "w.tdms")
    assert cells(result, "position_m")[0][0] == 0.0
    assert cells(result, "friction_n")[0][0] == 1.5
    assert result.ledger["files"][0]["start"].startswith("2026-11-22T10:00:00")


def test_topics_of_an_mcap_log_keep_their_relative_times(tmp_path: Path) -> None:
    writers = pytest.importorskip("mcap.writer")
    with (tmp_path / "l.mcap").open("wb") as file:
        writer = writers.Writer(file)
        writer.start()
        schema = writer.register_schema("s", "jsonschema", b"{}")
        force = writer.register_channel("/force", "json", schema)
        position = writer.register_channel("/place", "json", schema)
        for i in range(200):
            at = 1_763_800_000 * 10**9 + i * 10**7
            writer.add_message(position, at, b'{"position_m": %d}' % i, at)
            delayed = at + 3_000_000
            writer.add_message(force, delayed, b'{"friction_n": 1.5}', delayed)
        writer.finish()
    result = import_files(tmp_path / "l.mcap")
    assert cells(result, "position_m")[0][:2] == [0.0, 0.01]
    assert cells(result, "friction_n")[0][:2] == [0.003, 0.013]


def test_imported_sheets_of_a_workbook_keep_their_relative_times(tmp_path: Path) -> None:
    book = pytest.importorskip("openpyxl").Workbook()
    begin = datetime(2026, 11, 22, 10, 0, 0)
    for at, (name, column) in enumerate((("A", "Force [N]"), ("B", "Position [mm]"))):
        sheet = book.create_sheet(name)
        sheet.append(["Time", column])
        for i in range(50):
            sheet.append([begin + timedelta(seconds=i + 0.5 * at), float(i)])
    book.save(tmp_path / "b.xlsx")
    result = import_files(tmp_path / "b.xlsx")
    assert cells(result, "friction_n")[0][:2] == [0.0, 1.0]
    assert cells(result, "position_m")[0][:2] == [0.5, 1.5]


def serial_log(folder: Path, header: str, pos_scale: float, time_scale: float) -> Path:
    """A serial log of integers and short decimals with 100 rows per second."""
    time = 0.01 * np.arange(400)
    rows = [
        f"{time_scale * t:.0f},{pos_scale * 3.0 * np.sin(1.3 * t):.4f},{3.9 * np.cos(1.3 * t):.4f},"
        f"{0.1 * np.sign(np.cos(1.3 * t)):.2f}"
        for t in time
    ]
    path = folder / "serial.csv"
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


@pytest.mark.parametrize(("name", "scale"), [("millis", 1e3), ("micros", 1e6)])
def test_unit_of_a_microcontroller_clock_is_inferred_from_its_header(
    name: str, scale: float, tmp_path: Path
) -> None:
    header = f"{name},angle [rad],speed [rad/s],torque [Nm]"
    (run,) = import_files(serial_log(tmp_path, header, 1.0, scale), whole=True).runs
    np.testing.assert_allclose(run.time_s, 0.01 * np.arange(400), atol=1e-9)


def test_unit_of_time_is_inferred_from_position_and_speed_without_units(tmp_path: Path) -> None:
    guess = look(serial_log(tmp_path, "t,pos,vel,torque", 1.0, 1e3))
    assert "ms" in next(e.expression for e in guess.entries if e.key == "time_s")
    assert [q.place for q in guess.questions] == ["pos", "vel", "torque"]


def test_unit_of_time_is_an_open_question_if_position_and_speed_are_inconsistent(
    tmp_path: Path,
) -> None:
    """A position in degrees together with a speed in rad/s."""
    guess = look(serial_log(tmp_path, "t,pos,vel,torque", 57.3, 1e3))
    assert "t" in [q.place for q in guess.questions]
