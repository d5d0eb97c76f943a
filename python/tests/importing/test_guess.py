"""Guessing the map of a text file: headers, units, numbers and dates; open questions."""

from __future__ import annotations

import gzip
import math
from pathlib import Path

import numpy as np
import pytest
from jbf import import_files, look
from jbf.errors import InputError

ROWS = 60


def samples() -> list[tuple[float, float, float, float]]:
    """Time (s), position (mm), speed (mm/s), force (N)."""
    result = []
    for i in range(ROWS):
        t = 0.01 * i
        v = 15.0 * math.cos(3.0 * t)
        result.append((t, 5.0 * math.sin(3.0 * t), v, 12.5 * math.copysign(1.0, v) + 0.3 * v))
    return result


def text(header: str, row: str, *, sep: str = ",", decimal: str = ".", digits: int = 4) -> str:
    """A text file; `row` names the quantity of each column."""
    lines = []
    for i, (t, x, v, f) in enumerate(samples()):
        known = {
            "t": t, "ms": 1e3 * t, "x": x, "v": v, "f": f, "rpm": 10.0 * v, "pct": f,
            "load": 100.0, "m": x / 1e3, "n": float(i), "set": 5.0 * (i // 20),
        }  # fmt: skip
        dates = {
            "iso": f"2026-11-22T10:00:{t:09.6f}",
            "german": f"22.11.2026 23:59:{59 + int(t):02d}"[:17] + f"{59:02d},{int(t * 1e6):06d}",
            "clock": f"{10 + (59 + int(t)) // 60:02d}:00:{t:06.3f}",
            "word": "ok",
            "": "",
        }
        cells = [
            dates[c] if c in dates else f"{known[c]:.{digits}f}".replace(".", decimal)
            for c in row.split(" ")
        ]
        lines.append(sep.join(cells))
    return header + "\n".join(lines) + "\n"


def written(tmp_path: Path, content: str, name: str = "run.csv", encoding: str = "utf-8") -> Path:
    path = tmp_path / name
    path.write_bytes(content.encode(encoding))
    return path


CERTAIN = {
    "own names": (text("time_s,position_m,friction_n\n", "t m f"), {"position_m": "position_m"}),
    "semicolon, decimal comma": (
        text("Zeit [s];Kraft [N];Weg [mm]\n", "t f x", sep=";", decimal=","),
        {"friction_n": "Kraft [N]", "position_m": "Weg [mm]", "time_s": "Zeit [s]"},
    ),
    "blanks": (
        text("time_s position_m friction_n\n", "t m f", sep="  "),
        {"friction_n": "friction_n"},
    ),
    "a row of units": (
        text("Zeit;Kraft;Weg\ns;N;mm\n", "t f x", sep=";", decimal=","),
        {"time_s": "`Zeit` [s]", "friction_n": "`Kraft` [N]"},
    ),
    "metadata before": (
        text(
            "Bench 7\nOperator: Kim\nDate;22.11.2026\n\nTime (s);Force (N);Position (mm)\n",
            "t f x",
            sep=";",
        ),
        {"time_s": "Time (s)"},
    ),
    "LabVIEW": (
        text("LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\n"
             "Time (s)\tForce (N)\tDisplacement (mm)\tComment\n", "t f x ", sep="\t"),
        {"position_m": "Displacement (mm)"},
    ),
    "dates": (
        text("Timestamp,Force [N],Position [mm]\n", "iso f x"),
        {"time_s": "Timestamp"},
    ),
    "times of day": (
        text("Uhrzeit;Kraft [N];Weg [mm]\n", "clock f x", sep=";", decimal=","),
        {"time_s": "Uhrzeit"},
    ),
    "the unit of time from speed and position": (
        text("time,Position [mm],Speed [mm/s],Force [N]\n", "ms x v f"),
        {"time_s": "`time` [ms]"},
    ),
    "a set point next to the measurement": (
        text("t [s],Soll-Weg [mm],Ist-Weg [mm],Kraft [N]\n", "t x x f"),
        {"position_m": "Ist-Weg [mm]"},
    ),
    "friction and load": (
        text("Time (s),Friction force (N),Normal load (N),COF,Position (mm)\n", "t f load pct x"),
        {"friction_n": "Friction force (N)", "load_n": "Normal load (N)"},
    ),
    "a joint": (
        text("t [s],q [deg],qd [deg/s],tau [Nm]\n", "t x v f"),
        {"angle_rad": "q [deg]", "velocity_rad_s": "qd [deg/s]", "torque_n_m": "tau [Nm]"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CERTAIN)
def test_columns_with_unambiguous_headers_are_mapped_and_imported(
    case: str, tmp_path: Path
) -> None:
    content, wanted = CERTAIN[case]
    result = look(written(tmp_path, content))
    assert result.questions == ()
    made = {entry.key: entry.expression for entry in result.entries}
    for key, expression in wanted.items():
        assert made[key].strip("`") == expression.strip("`") or made[key] == expression
    runs = import_files(written(tmp_path, content)).runs
    time = np.array([row[0] for row in samples()])
    np.testing.assert_allclose(runs[0].time_s - runs[0].time_s[0], time, atol=1e-9)
    assert runs[0].friction_n is not None
    np.testing.assert_allclose(runs[0].friction_n, [row[3] for row in samples()], atol=1e-4)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "cp1252", "utf-16", "latin-1"])
def test_micrometre_unit_is_read_in_every_text_encoding(encoding: str, tmp_path: Path) -> None:
    content = text("Zeit [s];Kraft [N];Weg [µm]\n", "t f x", sep=";", decimal=",")
    result = look(written(tmp_path, content, encoding=encoding))
    assert {e.key: e.expression for e in result.entries}["position_m"] == "`Weg [µm]`"
    assert result.sure


def test_run_of_a_gzip_compressed_csv_is_named_without_the_suffixes(tmp_path: Path) -> None:
    path = tmp_path / "run_0.5.csv.gz"
    path.write_bytes(gzip.compress(text("time_s,position_m,friction_n\n", "t m f").encode()))
    assert import_files(path).runs[0].name == "run_0.5"


UNCERTAIN = {
    "a time without a unit": (
        text("Zeit;Kraft [N];Weg [mm]\n", "t f x", sep=";", decimal=","),
        ["Zeit"],
    ),
    "no units": (
        text("time,position,velocity,force\n", "t x v f"),
        ["time", "position", "velocity", "force"],
    ),
    "no header": (text("", "t x f"), ["time_s", "friction", "motion"]),
    "the same name twice": (text("t [s],F [N],F [N],x [mm]\n", "t f f x"), ["friction_n"]),
    "a unit that does not fit": (text("t [s],Force [mm],x [mm]\n", "t f x"), ["Force [mm]"]),
    "a speed that is not the derivative of the position": (
        text("t [s],x [m],v [mm/s],F [N]\n", "t x v f"),
        ["velocity_m_s"],
    ),
    "counts": (
        text("time_s,motor_position_counts,iq_a\n", "t n f"),
        ["motor_position_counts", "drive.torque_constant_n_m_a"],
    ),
    "percent on a slide": (
        text("time_s,ActPos_mm,ActTorque_pct\n", "t x pct"),
        ["drive.rated_torque_n_m", "drive.pitch_m"],
    ),
    "missing dimensions of a bearing": (
        text("time_s,angle_rad,velocity_m_s,friction_n,load_n\n", "t x v f load"),
        ["bearing"],
    ),
    "turns or radians": (text("t [s],n [1/s],M [Nm]\n", "t v f"), ["n [1/s]"]),
    "decimal or thousands": (
        "Zeit [s];Kraft [N];Weg [mm]\n"
        + "".join(f"{i},123;{i + 1},456;{i},789\n" for i in range(1, 60)),
        ["file"],
    ),
    "day or month": (
        "Date,Force [N],x [mm]\n"
        + "".join(
            f"0{1 + i // 30}/0{2 + i // 30}/2026 10:00:{i % 30:02d},{i},{i}\n" for i in range(60)
        ),
        ["file"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", UNCERTAIN)
def test_ambiguous_columns_become_questions_and_stop_the_import(case: str, tmp_path: Path) -> None:
    content, places = UNCERTAIN[case]
    path = written(tmp_path, content)
    result = look(path)
    assert {question.place for question in result.questions} == set(places)
    with pytest.raises(InputError):
        import_files(path, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


NUMBERS = {
    "1.234,5": (";", 1234.5),
    "1 234,5": (";", 1234.5),
    "1'234.5": (";", 1234.5),
    '"1,234.5"': (",", 1234.5),
    "0,125": (";", 0.125),
    "1,5e-3": (";", 1.5e-3),
    "+.5": (",", 0.5),
    "-3.": (",", -3.0),
}


@pytest.mark.parametrize("cell", NUMBERS)
def test_numbers_are_read_in_every_notation(cell: str, tmp_path: Path) -> None:
    sep, number = NUMBERS[cell]
    mark = "," if "," in cell and '"' not in cell else "."
    rows = [sep.join((f"{0.5 * i + 0.25:.2f}".replace(".", mark), cell, str(i))) for i in range(30)]
    path = written(tmp_path, sep.join(("t [s]", "F [N]", "x [mm]")) + "\n" + "\n".join(rows) + "\n")
    friction = import_files(path).runs[0].friction_n
    assert friction is not None
    assert set(friction.tolist()) == {number}


def test_time_of_day_continues_over_midnight(tmp_path: Path) -> None:
    stamps = [f"23:59:{50 + i}" for i in range(10)] + [f"00:00:{i:02d}" for i in range(10)]
    rows = "".join(f"{s};{i};{i}\n" for i, s in enumerate(stamps))
    run = import_files(written(tmp_path, "Uhrzeit;Kraft [N];Weg [mm]\n" + rows)).runs[0]
    np.testing.assert_array_equal(np.diff(run.time_s), 1.0)


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_time_stamps_since_1970_keep_their_resolution(unit: str, tmp_path: Path) -> None:
    size = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    ticks = [1_763_800_000 * size + i * size // 100 for i in range(50)]
    stamps = [f"{1_763_800_000 + i / 100:.2f}" for i in range(50)] if size == 1 else ticks
    rows = "".join(f"{t},{i},{i}\n" for i, t in enumerate(stamps))
    for header in (f"stamp_{unit}", "timestamp"):
        path = written(tmp_path, f"{header},F [N],x [mm]\n{rows}")
        result = import_files(path)
        wanted = np.arange(50) / 100.0
        exact = 2e-7 if unit == "s" else (0.0 if size < 10**9 else 3e-7)
        np.testing.assert_allclose(result.runs[0].time_s, wanted, rtol=0.0, atol=exact)
        assert result.ledger["files"][0]["start"].startswith("2025-11-22")


def test_unicode_minus_sign_is_read_as_negative(tmp_path: Path) -> None:
    content = text("t [s],F [N],x [mm]\n", "t f x").replace("-", "\u2212")
    friction = import_files(written(tmp_path, content)).runs[0].friction_n
    assert friction is not None
    assert friction.min() < 0.0


def test_ledger_names_source_column_unit_and_file_hash(tmp_path: Path) -> None:
    result = import_files(written(tmp_path, CERTAIN["semicolon, decimal comma"][0]))
    (page,) = result.ledger["files"]
    force = next(c for c in page["channels"] if c["channel"] == "friction_n")
    assert force["read"] == [{"column": "Kraft [N]", "unit": "N"}]
    assert force["rate_hz"] == 100.0
    assert len(page["sha256"]) == 64
