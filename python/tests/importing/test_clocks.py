"""Channels with separate clocks are not resampled; a missing sample is an empty cell."""

from __future__ import annotations

import csv
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from jbf import import_files
from jbf.errors import InputError

DRIVE = '[drive]\nmotion = "linear"\nfriction = "force"\n'


def rows_of(folder: Path, name: str = "log") -> list[dict[str, str]]:
    with (folder / f"{name}.csv").open() as file:
        return list(csv.DictReader(file))


def npz(folder: Path, **columns: np.ndarray) -> Path:
    np.savez(folder / "log.npz", **columns)  # type: ignore[arg-type]
    return folder / "log.npz"


def test_samples_of_two_clocks_are_merged_in_time_order(tmp_path: Path) -> None:
    fast, slow = np.arange(4000) / 1000.0, np.arange(800) / 200.0 + 0.0002
    file = npz(
        tmp_path, t_x=fast, x_mm=np.sin(fast), t_f=slow * 1e3, force=np.cos(slow)
    )  # fmt: skip
    (tmp_path / "map.toml").write_text(
        '[columns]\ntime_s = "t_x [s]"\nposition_m = "x_mm"\nfriction_n = "force [N]"\n'
        f'[clocks]\nfriction_n = "t_f [ms]"\n{DRIVE}'
    )
    result = import_files(file, tmp_path / "map.toml")
    rows = rows_of(result.folder)
    time = np.array([float(row["time_s"]) for row in rows])
    assert (np.diff(time) > 0.0).all()
    assert len(rows) == 4800
    position = [(row["time_s"], row["position_m"]) for row in rows if row["position_m"]]
    assert [float(t) for t, _ in position] == fast.tolist()
    assert [float(x) for _, x in position] == (np.sin(fast) / 1000.0).tolist()
    force = [(float(row["time_s"]), float(row["friction_n"])) for row in rows if row["friction_n"]]
    assert [f for _, f in force] == np.cos(slow).tolist()
    assert [t for t, _ in force] == pytest.approx(slow, abs=1e-12)
    rates = {c["channel"]: c["rate_hz"] for c in result.ledger["files"][0]["channels"]}
    assert rates == {"position_m": 1000.0, "friction_n": 200.0}


@pytest.mark.parametrize("slow_hz", [20.0, 7.0, 900.0])
def test_run_with_two_clocks_keeps_every_recorded_sample(slow_hz: float, tmp_path: Path) -> None:
    fast = np.arange(10_000) / 1000.0
    slow = 0.0103 + np.arange(int(9.9 * slow_hz)) / slow_hz
    file = npz(tmp_path, a=fast, x=np.sin(fast), b=slow, f=np.cos(slow))
    (tmp_path / "map.toml").write_text(
        '[columns]\ntime_s = "a [s]"\nposition_m = "x [m]"\nfriction_n = "f [N]"\n'
        f'[clocks]\nfriction_n = "b [s]"\n{DRIVE}'
    )
    result = import_files(file, tmp_path / "map.toml")
    (run,) = result.runs
    assert run.friction_n is not None
    assert run.position_m is not None
    recorded = run.read["friction_n"]
    np.testing.assert_array_equal(run.time_s[recorded], slow)
    np.testing.assert_array_equal(run.friction_n[recorded], np.cos(slow))
    np.testing.assert_array_equal(run.position_m[run.read["position_m"]], np.sin(fast))


def test_merging_long_channels_with_a_gap_keeps_every_sample(tmp_path: Path) -> None:
    """Rates differ by a factor of 100, and one channel has a long gap."""
    fast = np.arange(180_000) / 1000.0
    slow = np.concatenate((np.arange(100), np.arange(900, 1790))) / 10.0
    file = npz(tmp_path, a=fast, x=fast, b=slow, f=slow)
    (tmp_path / "map.toml").write_text(
        '[columns]\ntime_s = "a [s]"\nposition_m = "x [m]"\nfriction_n = "f [N]"\n'
        f'[clocks]\nfriction_n = "b [s]"\n{DRIVE}'
    )
    result = import_files(file, tmp_path / "map.toml")
    rows = rows_of(result.folder)
    assert [float(row["friction_n"]) for row in rows if row["friction_n"]] == slow.tolist()
    assert [float(row["position_m"]) for row in rows if row["position_m"]] == fast.tolist()


def text_file(folder: Path, empty_every: int, rows: int = 1000) -> Path:
    """A table with the force in one of n rows only, or, from n = 100, in all but one of n rows."""
    lines = ["time_s,position_m,friction_n"]
    for i in range(rows):
        force = "" if i % empty_every else "1.5"
        force = force if empty_every < 100 else ("" if i % empty_every == 1 else "1.5")
        lines.append(f"{i / 100},{i / 1000},{force}")
    (folder / "log.csv").write_text("\n".join(lines) + "\n")
    return folder / "log.csv"


def test_rows_are_kept_with_empty_cells_if_a_channel_has_a_value_in_every_fifth_row(
    tmp_path: Path,
) -> None:
    result = import_files(text_file(tmp_path, empty_every=5), out=tmp_path / "out")
    rows = rows_of(result.folder)
    assert len(rows) == 1000
    assert sum(bool(row["friction_n"]) for row in rows) == 200
    assert result.ledger["files"][0]["dropped"] == []


def test_rows_with_a_missing_value_are_dropped_and_reported_if_they_are_few(tmp_path: Path) -> None:
    result = import_files(text_file(tmp_path, empty_every=250))
    assert len(result.runs[0]) == 996
    assert result.ledger["files"][0]["dropped"] == [{"rows": 4, "why": "a value is missing"}]
    assert "4 rows left out" in result.summary()


def test_row_with_a_repeated_time_stamp_is_dropped_and_reported(tmp_path: Path) -> None:
    lines = ["time_s,position_m,friction_n"]
    lines += [f"{i // 2 if i == 41 else i / 2},{i},1.0" for i in range(100)]
    lines[42] = lines[41].replace(",40,", ",41,")
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    result = import_files(tmp_path / "log.csv")
    (dropped,) = result.ledger["files"][0]["dropped"]
    assert dropped == {"rows": 1, "why": "time repeats", "first_row": 43}


def test_time_that_runs_back_within_a_restarted_record_is_refused(tmp_path: Path) -> None:
    times = [*range(1000, 1050), *range(50), *range(25, 60)]
    lines = ["time_s,position_m,friction_n", *(f"{t},{i},1.0" for i, t in enumerate(times))]
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=r"row 102: .*time runs back"):
        import_files(tmp_path / "log.csv")


def test_clock_that_repeats_every_time_stamp_ten_times_is_refused(tmp_path: Path) -> None:
    lines = ["time_s,position_m,friction_n", *(f"{i // 10},{i},1.0" for i in range(200))]
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match="too coarse a clock"):
        import_files(tmp_path / "log.csv")


def test_expression_of_channels_with_different_clocks_is_refused(tmp_path: Path) -> None:
    time = np.arange(100) / 10.0
    slow = np.arange(50) / 5.0
    file = npz(tmp_path, a=time, x=time, b=slow, f=slow)
    (tmp_path / "map.toml").write_text(
        f'[columns]\ntime_s = "a [s]"\nposition_m = "x [m]"\nfriction_n = "f [N] - x [N]"\n{DRIVE}'
    )
    with pytest.raises(InputError, match="different clocks"):
        import_files(file, tmp_path / "map.toml")


def test_angle_recorded_modulo_360_degrees_is_unwrapped_and_reported(tmp_path: Path) -> None:
    time = np.arange(1000) / 100.0
    angle = 200.0 * np.sin(time)
    lines = ["t [s],angle [deg],M [Nm]"]
    lines += [f"{t},{a % 360.0!r},1.0" for t, a in zip(time.tolist(), angle.tolist(), strict=True)]
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    result = import_files(tmp_path / "log.csv")
    (run,) = result.runs
    assert run.angle_rad is not None
    np.testing.assert_allclose(run.angle_rad, np.radians(angle), atol=1e-9)
    assert "whole turns were added" in result.summary()


def test_waveforms_with_different_starts_keep_their_relative_times(tmp_path: Path) -> None:
    nptdms = pytest.importorskip("nptdms")
    start = np.datetime64("2026-11-22T10:00:00.000000")
    later = start + np.timedelta64(1_500, "ms")

    def channel(name: str, unit: str, begin: np.datetime64) -> object:
        properties = {"wf_increment": 0.01, "unit_string": unit, "wf_start_time": begin}
        return nptdms.ChannelObject("log", name, np.sin(np.arange(400.0)), properties)

    with nptdms.TdmsWriter(tmp_path / "w.tdms") as writer:
        writer.write_segment([channel("Force", "N", later), channel("Position", "mm", start)])
    result = import_files(tmp_path / "w.tdms")
    rows = rows_of(result.folder, "w")
    assert next(float(r["time_s"]) for r in rows if r["position_m"]) == 0.0
    assert next(float(r["time_s"]) for r in rows if r["friction_n"]) == 1.5
    assert result.ledger["files"][0]["start"].startswith("2026-11-22T10:00:00")


def test_topics_of_an_mcap_log_keep_their_relative_times(tmp_path: Path) -> None:
    writers = pytest.importorskip("mcap.writer")
    begin = 1_763_800_000 * 10**9
    with (tmp_path / "l.mcap").open("wb") as file:
        writer = writers.Writer(file)
        writer.start()
        schema = writer.register_schema("s", "jsonschema", b"{}")
        force = writer.register_channel("/force", "json", schema)
        position = writer.register_channel("/place", "json", schema)
        for i in range(200):
            at = begin + i * 10**7
            writer.add_message(position, at, b'{"position_m": %d}' % i, at)
            delayed = at + 3_000_000
            writer.add_message(force, delayed, b'{"friction_n": 1.5}', delayed)
        writer.finish()
    rows = rows_of(import_files(tmp_path / "l.mcap", out=tmp_path / "out").folder, "l")
    assert [float(r["time_s"]) for r in rows if r["position_m"]][:2] == [0.0, 0.01]
    assert [float(r["time_s"]) for r in rows if r["friction_n"]][:2] == [0.003, 0.013]


def test_sheets_of_a_workbook_keep_their_relative_times(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    begin = datetime(2026, 11, 22, 10, 0, 0)
    for at, (name, column) in enumerate((("A", "Force [N]"), ("B", "Position [mm]"))):
        sheet = book.create_sheet(name)
        sheet.append(["Time", column])
        for i in range(50):
            sheet.append([begin + timedelta(seconds=i + 0.5 * at), float(i)])
    book.save(tmp_path / "b.xlsx")
    rows = rows_of(import_files(tmp_path / "b.xlsx", out=tmp_path / "out").folder, "b")
    assert [float(r["time_s"]) for r in rows if r["friction_n"]][:2] == [0.0, 1.0]
    assert [float(r["time_s"]) for r in rows if r["position_m"]][:2] == [0.5, 1.5]
