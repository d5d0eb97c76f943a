"""The maps of docs/import.md applied to simulated recordings of a drive and of a seal."""

import re
from pathlib import Path

import jbf
import numpy as np
import pytest

PAGE = Path(__file__).resolve().parents[3] / "docs" / "import.md"
MAPS = dict(
    re.findall(
        r'```toml title="([^"]+)"\n(.*?)```', PAGE.read_text(encoding="utf-8"), flags=re.DOTALL
    )
)


def test_map_with_units_and_run_numbers_imports_two_runs_in_si_units(tmp_path: Path) -> None:
    time = np.arange(400) / 50.0
    rows = [
        f"{t};{5.0 * np.sign(np.cos(t)):.4f};{60.0 * np.sin(t):.4f};{60.0 * np.cos(t):.4f};80;{k}"
        for k in (1, 2)
        for t in time.tolist()
    ]
    header = "Zeit [s];Reibkraft [N];Weg [mm];Geschwindigkeit [mm/s];Normalkraft [N];Versuch"
    (tmp_path / "log.csv").write_text("\n".join([header, *rows]).replace(".", ",") + "\n")
    (tmp_path / "map.toml").write_text(MAPS["map.toml"])
    _, (first, second) = jbf.read_recording(tmp_path / "log.csv", tmp_path / "map.toml")
    for run in (first, second):
        np.testing.assert_allclose(run.position_m, 0.06 * np.sin(time), atol=1e-7)
        np.testing.assert_allclose(run.velocity, 0.06 * np.cos(time), atol=1e-7)
        np.testing.assert_array_equal(run.load_n, 80.0)


def test_torque_in_percent_is_converted_with_the_rated_torque_of_the_drive(tmp_path: Path) -> None:
    """Torque of 30 % at standstill plus 2.5 % per 100 rpm, of a rated torque of 0.64 N m."""
    rng = np.random.default_rng(5)
    lines = ["setpoint_rpm,time_ms,speed_rpm,torque_pct"]
    speeds = [-150, -90, -40, -15, 15, 40, 90, 150]
    for rpm in speeds:
        for i in range(300):
            torque = np.sign(rpm) * 30.0 + 0.025 * rpm + rng.normal()
            lines.append(f"{-rpm},{12.8 * i:.4f},{rpm + rng.integers(-1, 2)},{torque:.1f}")
    (tmp_path / "drive.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "map.toml").write_text(MAPS["screw.toml"])
    rig, runs = jbf.read_recording(tmp_path / "drive.csv", tmp_path / "map.toml")
    assert [len(r) for r in runs] == [300] * len(speeds)
    assert runs[0].time_s[1] == 0.0128
    fit = jbf.fit(rig, runs, law="coulomb")
    assert fit["F_c"].value == pytest.approx(0.30 * 0.64, rel=0.02)
    # 0.025 % of 0.64 N m per revolution per minute.
    assert fit["F_v"].value == pytest.approx(0.00025 * 0.64 * 60 / (2 * np.pi), rel=0.05)


def test_fit_of_imported_strokes_recovers_the_friction_per_pressure(tmp_path: Path) -> None:
    """Strokes under three pressures: 2 N plus 1.5 N per bar."""
    rng = np.random.default_rng(6)
    for bar in (1, 3, 5):
        time = np.arange(4000) / 100.0
        speed = 0.02 * np.sin(2 * np.pi * time / 5.0)
        position = -0.02 * 5.0 / (2 * np.pi) * np.cos(2 * np.pi * time / 5.0)
        force = (2.0 + 1.5 * bar) * np.sign(speed) + 40.0 * speed + rng.normal(0, 0.1, len(time))
        table = np.column_stack((time, position, speed, force, np.full(len(time), bar * 1e5)))
        header = "time_s,position_m,velocity_m_s,friction_n,pressure_pa"
        np.savetxt(tmp_path / f"s_{bar}.csv", table, "%.7g", ",", header=header, comments="")
    (tmp_path / "map.toml").write_text(MAPS["seal.toml"])
    files = sorted(tmp_path.glob("s_*.csv"))
    imported = jbf.import_files(files, tmp_path / "map.toml")
    assert [run.name for run in imported.runs] == ["s_1", "s_3", "s_5"]
    for one, other in zip(jbf.import_files(files).runs, imported.runs, strict=True):
        np.testing.assert_array_equal(one.friction, other.friction)
    fit = jbf.fit(imported.rig, imported.runs, ["dry_load_dependence"], law="coulomb")
    assert fit["F_c"].value == pytest.approx(2.0, abs=0.1)
    assert fit["dry_load_dependence.mu"].value == pytest.approx(1.5, abs=0.05)


def test_files_recorded_side_by_side_are_aligned_by_their_position(tmp_path: Path) -> None:
    """Three records of one motion; the clock of the force is 2 s behind the others."""
    rates = 2.0 * np.pi * np.array([0.11, 0.23, 0.41])

    def position(time: np.ndarray) -> np.ndarray:
        return np.asarray(
            np.sin(np.outer(time, rates) + np.array([0.3, 1.7, 4.0])) @ [20.0, 8.0, 5.0]
        )

    def write(name: str, header: str, *columns: np.ndarray) -> None:
        path = tmp_path / name
        table = np.column_stack(columns)
        np.savetxt(path, table, "%.7g", ",", header=header, comments="", encoding="utf-8")

    time = np.arange(6000) / 100.0
    write("drive.csv", "time [s],pos [mm]", time, position(time))
    sample = np.arange(500, 5500) / 100.0
    force = 5.0 * np.sign(np.gradient(position(sample)))
    write("force.csv", "time [s],F [N],lvdt [mm]", sample - 2.0, force, 3.0 - position(sample))
    seconds = np.arange(60.0)
    write("temp.csv", "time [s],temperature [°C],pos [mm]", seconds + 11.9, 20.0 + 0.0 * seconds,
          position(seconds))  # fmt: skip
    (tmp_path / "map.toml").write_text(MAPS["side_by_side.toml"], encoding="utf-8")
    result = jbf.import_files(tmp_path / "drive.csv", tmp_path / "map.toml")
    of_force, of_temperature = result.ledger["files"][0]["beside"]
    assert of_force["alignment"]["offset_s"] == pytest.approx(2.0, abs=0.002)
    assert of_temperature["alignment"]["offset_s"] == -11.9
    (run,) = result.runs
    np.testing.assert_allclose(run.temperature_c, 20.0)
