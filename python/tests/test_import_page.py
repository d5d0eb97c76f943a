"""docs/import.md: its maps do what it says, its tables name all there is."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf.importing.cutting.settings import WAYS, CutSettings
from jbf.importing.expression import FUNCTIONS
from jbf.importing.formats.registry import FORMATS
from jbf.importing.formats.table import Options

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "import.md"


def blocks(kind: str) -> list[str]:
    text = PAGE.read_text(encoding="utf-8")
    return re.findall(rf"```{kind}[^\n]*\n(.*?)```", text, flags=re.DOTALL)


def test_maps_have_at_most_ten_lines() -> None:
    first, screw, seal = blocks("toml")
    assert len(first.splitlines()) <= 12
    assert len(screw.splitlines()) <= 10
    assert len(seal.splitlines()) <= 10


def test_a_drive_of_set_points_one_after_the_other(tmp_path: Path) -> None:
    """Simulated here: 2.5 % a hundred turns a minute, 30 % at standstill, ripple and noise."""
    rng = np.random.default_rng(5)
    lines = ["setpoint_rpm,time_ms,speed_rpm,torque_pct"]
    speeds = [-150, -90, -40, -15, 15, 40, 90, 150]
    for rpm in speeds:
        for i in range(300):
            torque = np.sign(rpm) * 30.0 + 0.025 * rpm + rng.normal()
            lines.append(f"{-rpm},{12.8 * i:.4f},{rpm + rng.integers(-1, 2)},{torque:.1f}")
    (tmp_path / "drive.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "map.toml").write_text(blocks("toml")[1])
    rig, runs = jbf.read_recording(tmp_path / "drive.csv", tmp_path / "map.toml")
    assert [len(r) for r in runs] == [300] * len(speeds)
    assert runs[0].time_s[1] == 0.0128
    fit = jbf.fit(rig, runs, law="coulomb")
    assert fit["F_c"].value == pytest.approx(0.30 * 0.64, rel=0.02)
    # 0.025 % of 0.64 N m for a turn a minute.
    assert fit["F_v"].value == pytest.approx(0.00025 * 0.64 * 60 / (2 * np.pi), rel=0.05)


def test_seals_under_a_pressure_each(tmp_path: Path) -> None:
    """Simulated here: a level of 2 N and 1.5 N more for each bar, strokes to and fro."""
    rng = np.random.default_rng(6)
    for bar in (1, 3, 5):
        time = np.arange(4000) / 100.0
        speed = 0.02 * np.sin(2 * np.pi * time / 5.0)
        place = -0.02 * 5.0 / (2 * np.pi) * np.cos(2 * np.pi * time / 5.0)
        force = (2.0 + 1.5 * bar) * np.sign(speed) + 40.0 * speed + rng.normal(0, 0.1, len(time))
        table = np.column_stack((time, place, speed, force, np.full(len(time), bar * 1e5)))
        header = "time_s,position_m,velocity_m_s,friction_n,pressure_pa"
        np.savetxt(tmp_path / f"s_{bar}.csv", table, "%.7g", ",", header=header, comments="")
    (tmp_path / "map.toml").write_text(blocks("toml")[2])
    files = sorted(tmp_path.glob("s_*.csv"))
    without = jbf.import_files(files)
    found = jbf.import_files(files, tmp_path / "map.toml")
    assert [run.name for run in found.runs] == ["s_1", "s_3", "s_5"]
    for one, other in zip(without.runs, found.runs, strict=True):
        np.testing.assert_array_equal(one.friction_n, other.friction_n)
    fit = jbf.fit(found.rig, found.runs, ["dry_load_dependence"], law="coulomb")
    assert fit["F_c"].value == pytest.approx(2.0, abs=0.1)
    assert fit["dry_load_dependence.mu"].value == pytest.approx(1.5, abs=0.05)


def test_the_page_names_every_key_way_function_and_format() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name in (*(f.name for f in fields(Options)), *(f.name for f in fields(CutSettings))):
        assert f"`{name}`" in text, name
    for word in (*WAYS, *FUNCTIONS):
        assert f'"{word}"' in text or f"`{word}`" in text, word
    for known in FORMATS:
        assert not known.extra or f"`jbf[{known.extra}]`" in text, known.extra
        assert known.library in text


def test_the_extras_are_those_of_the_package() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for known in FORMATS:
        if known.extra:
            assert re.search(rf"^{known.extra} = \[", text, flags=re.MULTILINE), known.extra


def test_links_are_there() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", PAGE.read_text(encoding="utf-8")):
        assert PAGE.parent.joinpath(target).exists(), target
