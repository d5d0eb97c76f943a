"""What the recording did is told wherever runs are compared or fitted: JSON, text, pages, CLI."""

from __future__ import annotations

import json
from pathlib import Path

import jbf
import numpy as np
import pytest
from conftest import LAW, make_runs
from jbf import Model, Rig, Run
from jbf.cli import main
from jbf.estimation.bootstrap import recorded_again
from jbf.estimation.noise import WHITE
from jbf.estimation.prepared import Prepared

WORDS = "single samples of the position off"


@pytest.fixture(scope="module")
def spoilt() -> list[Run]:
    """A run in which two positions are off, and a clean one."""
    clean, other = make_runs(kinds=("sine_w0.5", "sine_w2.0"))
    assert clean.angle_rad is not None
    angle = clean.angle_rad.copy()
    angle[[300, 700]] += 0.2
    columns = clean.columns() | {"angle_rad": angle}
    return [Run.from_arrays(**columns, name=clean.name), other]  # type: ignore[arg-type]


def test_a_comparison_tells(spoilt: list[Run], tmp_path: Path) -> None:
    told = jbf.compare(Model(Rig.thesis(), parameters=LAW), spoilt)
    assert [(f.kind, f.run) for f in told.findings] == [("glitches", "sine_w0.5")]
    assert told.to_dict()["findings"] == [told.findings[0].to_dict()]
    assert "What the recording did" in told.summary()
    assert WORDS in told.summary().replace("\n", " ").replace("  ", "")
    told.save_html(tmp_path / "c.html")
    assert "What the recording did" in (tmp_path / "c.html").read_text()


def test_a_fit_tells(spoilt: list[Run], tmp_path: Path) -> None:
    told = jbf.fit(Rig.thesis(), spoilt)
    assert [f.kind for f in told.findings] == ["glitches"]
    assert json.loads(json.dumps(told.to_dict()))["findings"][0]["channel"] == "angle_rad"
    assert "What the recording did" in told.summary()
    told.save_html(tmp_path / "f.html")
    assert "What the recording did" in (tmp_path / "f.html").read_text()


def test_clean_runs_are_told_nothing_of() -> None:
    told = jbf.compare(Model(Rig.thesis(), parameters=LAW), make_runs(kinds=("sine_w0.5",)))
    assert told.findings == ()
    assert "recording" not in told.summary()


def test_the_command_line_tells(
    spoilt: list[Run], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "runs").mkdir()
    for run in spoilt:
        run.write_csv(tmp_path / "runs" / f"{run.name}.csv")
    model = tmp_path / "model.toml"
    Model(Rig.thesis(), parameters=LAW).save(model)
    assert main(["compare", str(model), str(tmp_path / "runs")]) == 0
    assert "What the recording did" in capsys.readouterr().out
    assert main(["compare", str(model), str(tmp_path / "runs"), "--json", "-"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert [f["kind"] for f in said["findings"]] == ["glitches"]


def test_a_glitch_does_not_move_the_answer(spoilt: list[Run]) -> None:
    clean = make_runs(kinds=("sine_w0.5", "sine_w2.0"))
    a, b = (jbf.fit(Rig.thesis(), runs).model.parameters for runs in (clean, spoilt))
    for name, value in a.items():
        assert value.stderr is not None
        assert b[name].value == pytest.approx(value.value, abs=0.2 * value.stderr)
    assert np.isfinite([p.value for p in b.values()]).all()


@pytest.mark.parametrize("spoil", ["late speed", "degrees", "mm/s", "turned"])
def test_a_record_drawn_again_is_spoilt_again(spoil: str) -> None:
    """Else a bootstrap would believe what the fit did not."""
    run = make_runs(kinds=("sine_w0.5",))[0]
    assert run.angle_rad is not None
    assert run.friction_n is not None
    speed, angle = run.velocity_m_s, run.angle_rad
    if spoil == "late speed":
        speed = np.interp(run.time_s - 0.05, run.time_s, speed)
    elif spoil == "mm/s":
        speed = 1e3 * speed
    else:
        angle = {"degrees": np.degrees(angle / 10.0), "turned": -angle}[spoil]
        speed = speed / 10.0 if spoil == "degrees" else speed
    own = Run.from_arrays(run.time_s, speed, run.friction_n, angle_rad=angle, name="a")
    prepared = Prepared.of(Rig.thesis(), own)
    (found,) = prepared.examined.findings
    assert found.channel in prepared.motion.aside
    random = np.random.default_rng(1)
    again = recorded_again(prepared, run.friction_n, WHITE, 0.3, random)
    (same,) = Prepared.of(Rig.thesis(), again).examined.findings
    assert (same.kind, same.channel) == (found.kind, found.channel)
    assert same.size == pytest.approx(found.size, rel=0.1)
