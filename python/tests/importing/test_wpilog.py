"""Entries of WPILib data logs keep their values, units and instants."""

import struct
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from jbf.errors import InputError
from jbf.importing.formats.registry import open_source

US = 1_000_000
N = 400
TIME_US = 3 * US + 20_000 * np.arange(N)
POSITION = 0.05 * np.sin(np.arange(N) / 50.0)
FORCE = 3.0 + 40.0 * POSITION
FORMATS = {"double": "d", "float": "f", "int64": "q", "boolean": "?"}
Entries = dict[str, tuple[str, Any, Any, str]]
"""Type, instants in us, samples and metadata of each entry by its name."""


def record(number: int, stamp: int, content: bytes) -> bytes:
    """A record that stores each number in the minimum number of bytes."""
    parts = [max(1, (value.bit_length() + 7) // 8) for value in (number, len(content), stamp)]
    head = bytes([parts[0] - 1 | parts[1] - 1 << 2 | parts[2] - 1 << 4])
    for size, value in zip(parts, (number, len(content), stamp), strict=True):
        head += value.to_bytes(size, "little")
    return head + content


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def payload(kind: str, sample: Any) -> bytes:
    if kind == "string":
        return str(sample).encode()
    samples = sample if kind.endswith("[]") else [sample]
    return struct.pack(f"<{len(samples)}{FORMATS[kind.removesuffix('[]')]}", *samples)


def write(path: Path, entries: Entries) -> None:
    """Write entries according to the specification of the format."""
    log = b"WPILOG\x00\x01" + text("bench")
    for number, (name, (kind, _, _, metadata)) in enumerate(entries.items(), 1):
        start = b"\x00" + struct.pack("<I", number) + text(name) + text(kind) + text(metadata)
        log += record(0, US, start)
    for number, (kind, stamps, samples, _) in enumerate(entries.values(), 1):
        for stamp, sample in zip(stamps.tolist(), samples, strict=True):
            log += record(number, stamp, payload(kind, sample))
    path.write_bytes(log)


def test_wpilog_entries_with_equal_instants_share_a_table(tmp_path: Path) -> None:
    path = tmp_path / "a.wpilog"
    entries = {
        "/axis/position": ("double", TIME_US, POSITION.tolist(), '{"unit": "m"}'),
        "/axis/friction_n": ("float", TIME_US, FORCE.tolist(), ""),
        "/axis/enabled": ("boolean", TIME_US, [True] * N, ""),
        "/axis/ticks": ("int64", TIME_US[::2] + 7, list(range(N // 2)), ""),
        "/axis/note": ("string", TIME_US, ["rest"] * N, ""),
    }
    write(path, entries)
    with open_source(path) as source:
        fast, slow = source.tables
        heads = source.head(fast), source.head(slow)
    assert [c.name for c in fast.columns] == ["time", *list(entries)[:3]]
    assert fast.column("/axis/position").unit == "m"
    np.testing.assert_array_equal(heads[0]["time"], np.arange(N) / 50.0)
    np.testing.assert_array_equal(heads[0]["/axis/position"], POSITION)
    np.testing.assert_array_equal(heads[0]["/axis/friction_n"], FORCE.astype(np.float32))
    np.testing.assert_array_equal(heads[1]["/axis/ticks"], np.arange(N // 2))
    np.testing.assert_allclose(heads[1]["time"], np.arange(N // 2) / 25.0 + 7e-6, atol=1e-12)


def test_wpilog_with_units_is_imported_without_a_map(tmp_path: Path) -> None:
    path = tmp_path / "a.wpilog"
    entries = {
        "/axis/position_m": ("double", TIME_US, POSITION.tolist(), ""),
        "/axis/friction_n": ("double", TIME_US, FORCE.tolist(), ""),
    }
    write(path, entries)
    assert jbf.look(path).sure
    (run,) = jbf.import_files(path, whole=True).runs
    np.testing.assert_array_equal(run.position_m, POSITION)
    np.testing.assert_array_equal(run.friction, FORCE)


def test_wpilog_array_has_a_column_for_each_element(tmp_path: Path) -> None:
    path = tmp_path / "a.wpilog"
    pairs = np.column_stack([POSITION, FORCE]).tolist()
    write(path, {"pose": ("double[]", TIME_US, pairs, "")})
    with open_source(path) as source:
        head = source.head(source.tables[0])
    np.testing.assert_array_equal(head["pose[0]"], POSITION)
    np.testing.assert_array_equal(head["pose[1]"], FORCE)


def test_wpilog_records_are_sorted_by_their_instants(tmp_path: Path) -> None:
    path = tmp_path / "a.wpilog"
    write(path, {"force_n": ("double", TIME_US[::-1], FORCE[::-1].tolist(), "")})
    with open_source(path) as source:
        head = source.head(source.tables[0])
    np.testing.assert_array_equal(head["force_n"], FORCE)
    assert (np.diff(head["time"]) > 0.0).all()


def test_truncated_wpilog_keeps_the_samples_before_the_torn_record(tmp_path: Path) -> None:
    path = tmp_path / "a.wpilog"
    write(path, {"force_n": ("double", TIME_US, FORCE.tolist(), "")})
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    with open_source(path) as source:
        force = source.head(source.tables[0])["force_n"]
        (torn,) = source.skipped_rows()
    assert "truncated" in torn[1]
    assert 100 < len(force) < N
    np.testing.assert_array_equal(force, FORCE[: len(force)])


@pytest.mark.parametrize("size", [6, 11, 12, 30])
def test_wpilog_without_a_sample_is_refused_in_one_line(size: int, tmp_path: Path) -> None:
    path = tmp_path / "a.wpilog"
    write(path, {"force_n": ("double", TIME_US, FORCE.tolist(), "")})
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(InputError) as refused:
        open_source(path)
    assert "\n" not in str(refused.value)


def test_wpilog_written_by_wpilib_is_read(tmp_path: Path) -> None:
    wpiutil = pytest.importorskip("wpiutil")
    entries = pytest.importorskip("wpiutil.log")
    path = tmp_path / "a.wpilog"
    log = wpiutil.DataLogWriter(str(path))
    position = entries.DoubleLogEntry(log, "/axis/position", '{"unit": "m"}')
    for stamp, value in zip(TIME_US.tolist(), POSITION.tolist(), strict=True):
        position.append(value, stamp)
    log.flush()
    log.stop()
    with open_source(path) as source:
        (table,) = source.tables
        head = source.head(table)
    assert table.column("/axis/position").unit == "m"
    np.testing.assert_array_equal(head["/axis/position"], POSITION)
    np.testing.assert_array_equal(head["time"], np.arange(N) / 50.0)


def test_wpilog_entry_number_reused_after_its_end_starts_a_new_entry(tmp_path: Path) -> None:
    path = tmp_path / "a.wpilog"
    write(path, {"first_n": ("double", TIME_US[:10], FORCE[:10].tolist(), "")})
    finish = record(0, US, b"\x01" + struct.pack("<I", 1))
    start = b"\x00" + struct.pack("<I", 1) + text("second_n") + text("double") + text("")
    later = b"".join(record(1, 9 * US + k, payload("double", 2.0)) for k in range(5))
    path.write_bytes(path.read_bytes() + finish + record(0, US, start) + later)
    with open_source(path) as source:
        heads = [source.head(table) for table in source.tables]
    np.testing.assert_array_equal(heads[0]["first_n"], FORCE[:10])
    np.testing.assert_array_equal(heads[1]["second_n"], np.full(5, 2.0))
