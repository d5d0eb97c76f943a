"""Inference of the map of a text file: headers, units, numbers and dates; open questions."""

import gzip
import json
import math
from pathlib import Path

import numpy as np
import pytest
from jbf import import_files, look
from jbf.cli import main
from jbf.errors import InputError


def samples() -> list[tuple[float, float, float, float]]:
    """Time (s), position (mm), speed (mm/s), force (N)."""
    result = []
    for i in range(60):
        t = 0.01 * i
        v = 15.0 * math.cos(3.0 * t)
        result.append((t, 5.0 * math.sin(3.0 * t), v, 12.5 * math.copysign(1.0, v) + 0.3 * v))
    return result


def text(header: str, row: str, *, sep: str = ",", decimal: str = ".") -> str:
    """A text file; `row` contains the quantity of each column."""
    lines = []
    for i, (t, x, v, f) in enumerate(samples()):
        numbers = {
            "t": t, "ms": 1e3 * t, "x": x, "v": v, "f": f, "pct": f, "load": 100.0, "m": x / 1e3,
            "n": float(i),
        }  # fmt: skip
        cells = {name: f"{number:.4f}".replace(".", decimal) for name, number in numbers.items()}
        cells |= {"iso": f"2026-11-22T10:00:{t:09.6f}", "clock": f"10:59:{t:06.3f}", "": ""}
        lines.append(sep.join(cells[name] for name in row.split(" ")))
    return header + "\n".join(lines) + "\n"


def written(tmp_path: Path, content: str, encoding: str = "utf-8") -> Path:
    path = tmp_path / "run.csv"
    path.write_bytes(content.encode(encoding))
    return path


CERTAIN = {
    "own names": (text("time_s,position_m,friction_n\n", "t m f"), {"position_m": "position_m"}),
    "semicolon, decimal comma": (
        text("Zeit [s];Kraft [N];Weg [mm]\n", "t f x", sep=";", decimal=","),
        {"friction_n": "Kraft [N]", "position_m": "Weg [mm]", "time_s": "Zeit [s]"}),
    "blanks": (
        text("time_s position_m friction_n\n", "t m f", sep="  "), {"friction_n": "friction_n"}),
    "a row of units": (text("Zeit;Kraft;Weg\ns;N;mm\n", "t f x", sep=";", decimal=","),
        {"time_s": "`Zeit` [s]", "friction_n": "`Kraft` [N]"}),
    "metadata before": (
        text("Bench 7\nOperator: Kim\nDate;22.11.2026\n\n"
             "Time (s);Force (N);Position (mm)\n", "t f x", sep=";"),
        {"time_s": "Time (s)"}),
    "LabVIEW": (
        text("LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\n"
             "Time (s)\tForce (N)\tDisplacement (mm)\tComment\n", "t f x ", sep="\t"),
        {"position_m": "Displacement (mm)"}),
    "dates": (text("Timestamp,Force [N],Position [mm]\n", "iso f x"), {"time_s": "Timestamp"}),
    "times of day": (text("Uhrzeit;Kraft [N];Weg [mm]\n", "clock f x", sep=";", decimal=","),
        {"time_s": "Uhrzeit"}),
    "the unit of time from speed and position": (
        text("time,Position [mm],Speed [mm/s],Force [N]\n", "ms x v f"),
        {"time_s": "`time` [ms]"}),
    "a set point next to the measurement": (
        text("t [s],Soll-Weg [mm],Ist-Weg [mm],Kraft [N]\n", "t x x f"),
        {"position_m": "Ist-Weg [mm]"}),
    "friction and load": (
        text("Time (s),Friction force (N),Normal load (N),COF,Position (mm)\n", "t f load pct x"),
        {"friction_n": "Friction force (N)", "load_n": "Normal load (N)"}),
    "a set point in a compound": (
        text("t [s],Sollposition [mm],Position [mm],Kraft [N]\n", "t x x f"),
        {"position_m": "Position [mm]"}),
    "a time named by its unit": (text("ms,Position [mm],Force [N]\n", "ms x f"), {"time_s": "ms"}),
    "a joint": (text("t [s],q [deg],qd [deg/s],tau [Nm]\n", "t x v f"),
        {"angle_rad": "q [deg]", "velocity_rad_s": "qd [deg/s]", "torque_n_m": "tau [Nm]"}),
}  # fmt: skip


@pytest.mark.parametrize("case", CERTAIN)
def test_columns_with_unambiguous_headers_are_imported(case: str, tmp_path: Path) -> None:
    content, expected = CERTAIN[case]
    path = written(tmp_path, content)
    result = look(path)
    assert result.questions == ()
    expressions = {key: text.strip("`") for key, text in dict(result.map().columns).items()}
    assert expressions.items() >= {key: text.strip("`") for key, text in expected.items()}.items()
    (run,) = import_files(path).runs
    np.testing.assert_allclose(run.time_s - run.time_s[0], [s[0] for s in samples()], atol=1e-9)
    np.testing.assert_allclose(run.friction, [s[3] for s in samples()], atol=1e-4)


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
        text("Zeit;Kraft [N];Weg [mm]\n", "t f x", sep=";", decimal=","), ["Zeit"]),
    "no units": (text("time,position,velocity,force\n", "t x v f"),
        ["position", "velocity", "force"]),
    "no header": (text("", "t x f"), ["time_s", "friction", "motion"]),
    "the same name twice": (text("t [s],F [N],F [N],x [mm]\n", "t f f x"), ["friction_n"]),
    "a unit that does not fit": (text("t [s],Force [mm],x [mm]\n", "t f x"), ["Force [mm]"]),
    "a speed that is not the derivative of the position": (
        text("t [s],x [m],v [mm/s],F [N]\n", "t x v f"), ["velocity_m_s"]),
    "counts": (text("time_s,motor_position_counts,iq_a\n", "t n f"),
        ["motor_position_counts", "drive.torque_constant_n_m_a"]),
    "percent on a slide": (text("time_s,ActPos_mm,ActTorque_pct\n", "t x pct"),
        ["drive.rated_torque_n_m", "drive.pitch_m"]),
    "radius at which a force acts": (
        text("time_s,angle_rad,velocity_m_s,friction_n,load_n\n", "t x v f load"), ["torque_n_m"]),
    "a torque elsewhere": (
        text("t [s],angle [rad],friction [Nm],shaft_torque [Nm]\n", "t x f load"), ["torque_n_m"]),
    "two clocks": (text("time [s],cpu_time_ms,F [N],x [mm]\n", "t ms f x"), ["time_s"]),
    "a rate that no logger has": (text("time_ns,F [N],x [mm]\n", "t f x"), ["time_ns"]),
    "turns or radians": (text("t [s],n [1/s],M [Nm]\n", "t v f"), ["n [1/s]"]),
    "decimal or thousands": ("Zeit [s];Kraft [N];Weg [mm]\n"
        + "".join(f"{i},123;{i + 1},456;{i},789\n" for i in range(1, 60)),
        ["file"]),
    "day or month": ("Date,Force [N],x [mm]\n"
        + "".join(f"0{1 + i // 30}/0{2 + i // 30}/2026 10:00:{i % 30:02d},{i},{i}\n"
                  for i in range(60)),
        ["file"]),
}  # fmt: skip


@pytest.mark.parametrize("case", UNCERTAIN)
def test_ambiguous_columns_become_questions_and_stop_the_import(case: str, tmp_path: Path) -> None:
    content, places = UNCERTAIN[case]
    path = written(tmp_path, content)
    assert {question.place for question in look(path).questions} == set(places)
    with pytest.raises(InputError):
        import_files(path, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["uart_latency_ms", "dt_ms", "jitter_us", "loop_time_us"])
def test_column_that_does_not_increase_is_not_taken_as_the_time(name: str, tmp_path: Path) -> None:
    random = np.random.default_rng(4)
    lines = [f"time [s],{name},F [N],x [mm]"]
    lines += [f"{t:.3f},{40.0 + random.normal():.3f},{f:.3f},{x:.4f}" for t, x, _, f in samples()]
    found = look(written(tmp_path, "\n".join(lines) + "\n"))
    assert found.sure
    assert found.map().columns["time_s"] == "`time [s]`"
    assert name in found.ignored


def test_joint_states_without_units_are_those_of_a_revolute_joint(tmp_path: Path) -> None:
    path = written(tmp_path, text("time,position,velocity,effort\n", "t x v f"))
    found = look(path)
    assert found.sure
    assert found.rig == {"drive": {"motion": "rotary", "friction": "torque"}}
    expected = {"angle_rad": "`position` [rad]", "velocity_rad_s": "`velocity` [rad/s]",
                "torque_n_m": "`effort` [N m]", "time_s": "`time` [s]"}  # fmt: skip
    assert found.map().columns == expected


STAMPS = [
    (i, 1_763_800_000 + i // 100, i % 100 * 10**7 + i * i % 997 + 456_789_012 % 10**7)
    for i in range(60)
]
"""Number, seconds and nanoseconds of the stamp of each message."""


@pytest.mark.parametrize(
    ("header", "unused"),
    [
        ("secs,nsecs,position,velocity,effort", 0),
        ("sec,nanosec,position,velocity,effort", 0),
        ("header.stamp.secs,header.stamp.nsecs,position,velocity,effort", 0),
        ("Time,header.seq,header.stamp.secs,header.stamp.nsecs,position,velocity,effort", 2),
        ("%time,field.header.seq,field.header.stamp,field.position0,field.velocity0,field.effort0",
         2),
    ],
)  # fmt: skip
def test_stamp_of_a_joint_state_is_read_to_the_nanosecond(
    header: str, unused: int, tmp_path: Path
) -> None:
    lines = [header]
    whole = "secs" not in header and "nanosec" not in header
    for (i, seconds, nanoseconds), (_, x, v, f) in zip(STAMPS, samples(), strict=True):
        stamp = [f"{seconds}{nanoseconds:09d}"] if whole else [str(seconds), str(nanoseconds)]
        log = [f"{seconds}{nanoseconds + 1234:09d}" if whole else f"{seconds + 0.5:.6f}", str(i)]
        lines.append(",".join([*log[:unused], *stamp, f"{x:.5f}", f"{v:.5f}", f"{f:.5f}"]))
    path = written(tmp_path, "\n".join(lines) + "\n")
    found = look(path)
    assert found.sure
    assert found.rig == {"drive": {"motion": "rotary", "friction": "torque"}}
    time_s = import_files(path, whole=True).runs[0].time_s
    exact = [(s - STAMPS[0][1]) + n / 1e9 for _, s, n in STAMPS]
    np.testing.assert_allclose(time_s - time_s[0], np.subtract(exact, exact[0]), atol=1e-12)


def test_stamp_next_to_another_time_becomes_a_question(tmp_path: Path) -> None:
    lines = ["time [s],cmd.secs,cmd.nsecs,F [N],x [mm]"]
    lines += [
        f"{t:.2f},{s},{n},{f:.4f},{x:.4f}"
        for (_, s, n), (t, x, _, f) in zip(STAMPS, samples(), strict=True)
    ]
    found = look(written(tmp_path, "\n".join(lines) + "\n"))
    assert [question.place for question in found.questions] == ["time_s"]


@pytest.mark.parametrize("suffix", ["csv", "npz", "json", "parquet"])
def test_integer_stamps_since_1970_are_exact_in_every_format(suffix: str, tmp_path: Path) -> None:
    ticks = [seconds * 10**9 + nanoseconds for _, seconds, nanoseconds in STAMPS]
    columns = {"stamp_ns": ticks, "friction_n": [s[3] for s in samples()],
               "position_m": [s[1] / 1e3 for s in samples()]}  # fmt: skip
    path = tmp_path / f"run.{suffix}"
    if suffix == "csv":
        rows = [",".join(map(repr, row)) for row in zip(*columns.values(), strict=True)]
        path.write_text("\n".join([",".join(columns), *rows]))
    elif suffix == "npz":
        np.savez(path, **{name: np.array(values) for name, values in columns.items()})
    elif suffix == "json":
        path.write_text(json.dumps(columns))
    else:
        arrow = pytest.importorskip("pyarrow")
        pytest.importorskip("pyarrow.parquet").write_table(arrow.table(columns), path)
    time_s = import_files(path, whole=True).runs[0].time_s
    expected = [(tick - ticks[0]) / 1e9 for tick in ticks]
    np.testing.assert_allclose(time_s - time_s[0], expected, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("header", "joints"),
    [
        ("t [s],q1 [rad],q2 [rad],qd1 [rad/s],qd2 [rad/s],tau1 [N m],tau2 [N m]", ("1", "2")),
        ("time,field.position0,field.position1,field.velocity0,field.velocity1,field.effort0,"
         "field.effort1", ("0", "1")),
        ("time,position.hip,position.knee,velocity.hip,velocity.knee,effort.hip,effort.knee",
         ("hip", "knee")),
    ],
)  # fmt: skip
def test_each_joint_of_a_recording_is_imported_as_a_separate_campaign(
    header: str, joints: tuple[str, str], tmp_path: Path
) -> None:
    lines = [header]
    for t, x, v, f in samples():
        lines.append(f"{t:.3f},{x:.5f},{2 * x:.5f},{v:.5f},{2 * v:.5f},{f:.4f},{3 * f:.4f}")
    path = written(tmp_path, "\n".join(lines) + "\n")
    with pytest.raises(InputError, match=f"contains the joints {joints[0]}, {joints[1]}"):
        look(path)
    torques = [
        import_files(path, joint=joint, out=tmp_path / joint).runs[0].friction for joint in joints
    ]
    assert torques[0] is not None
    assert torques[1] is not None
    np.testing.assert_allclose(torques[1], 3.0 * torques[0], atol=2e-4)
    assert main(["import", str(path), "--joint", "all", "--folder", str(tmp_path / "each")]) == 0
    assert {p.name for p in (tmp_path / "each").iterdir()} == set(joints)


def test_channel_without_any_value_is_omitted_from_the_import(tmp_path: Path) -> None:
    lines = ["t [s],F [N],x [mm],v [mm/s]"]
    lines += [f"{t:.3f},{f:.3f},{x:.4f},nan" for t, x, _, f in samples()]
    path = written(tmp_path, "\n".join(lines) + "\n")
    found = look(path)
    assert found.ignored["v [mm/s]"] == "contains no value"
    channels = import_files(path).ledger["files"][0]["channels"]
    assert [c["channel"] for c in channels] == ["position_m", "friction_n"]


def test_computed_torque_is_not_taken_for_the_measured_one(tmp_path: Path) -> None:
    header = "t [s],q [rad],torque [Nm],gravity_torque [Nm]\n"
    found = look(written(tmp_path, text(header, "t x f load")))
    assert found.sure
    assert found.map().columns["torque_n_m"] == "`torque [Nm]`"


NUMBERS = {
    "1.234,5": (";", 1234.5), "1 234,5": (";", 1234.5), "1'234.5": (";", 1234.5),
    '"1,234.5"': (",", 1234.5), "0,125": (";", 0.125), "1,5e-3": (";", 1.5e-3),
    "+.5": (",", 0.5), "-3.": (",", -3.0), "\u22123.5": (",", -3.5),
}  # fmt: skip
"""Delimiter and value by notation; the last one has the Unicode minus sign."""


@pytest.mark.parametrize("cell", NUMBERS)
def test_number_is_read_in_each_sign_and_decimal_notation(cell: str, tmp_path: Path) -> None:
    sep, number = NUMBERS[cell]
    mark = "," if "," in cell and '"' not in cell else "."
    rows = [sep.join((f"{0.5 * i + 0.25:.2f}".replace(".", mark), cell, str(i))) for i in range(30)]
    path = written(tmp_path, sep.join(("t [s]", "F [N]", "x [mm]")) + "\n" + "\n".join(rows) + "\n")
    assert set(import_files(path).runs[0].friction.tolist()) == {number}


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_time_stamps_since_1970_keep_their_resolution(unit: str, tmp_path: Path) -> None:
    size = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    ticks = [1_763_800_000 * size + i * size // 100 for i in range(50)]
    stamps = [f"{1_763_800_000 + i / 100:.2f}" for i in range(50)] if size == 1 else ticks
    rows = "".join(f"{t},{i},{i}\n" for i, t in enumerate(stamps))
    for header in (f"stamp_{unit}", "timestamp"):
        result = import_files(written(tmp_path, f"{header},F [N],x [mm]\n{rows}"))
        atol = 2e-7 if unit == "s" else 0.0
        np.testing.assert_allclose(result.runs[0].time_s, np.arange(50) / 100, rtol=0.0, atol=atol)
        assert result.ledger["files"][0]["start"].startswith("2025-11-22")


def test_import_ledger_has_column_unit_rate_and_sha256_of_the_source(tmp_path: Path) -> None:
    result = import_files(written(tmp_path, CERTAIN["semicolon, decimal comma"][0]))
    (page,) = result.ledger["files"]
    force = next(c for c in page["channels"] if c["channel"] == "friction_n")
    assert force["read"] == [{"column": "Kraft [N]", "unit": "N"}]
    assert force["rate_hz"] == 100.0
    assert len(page["sha256"]) == 64
