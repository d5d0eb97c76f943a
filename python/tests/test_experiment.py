"""The next experiment: within its limits, and decisive where it is made."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import jbf
import numpy as np
import pytest
from campaigns import campaign
from jbf.cli import main
from jbf.diagnosis.excitations import Limits, excitations
from rigsim.motions import Motion, polyline, sine, sweep

ONE_WAY = (
    sine("one_way_0.25", 50.3, 0.0595, 0.25, bias=0.0728),
    sine("one_way_1", 25.2, 0.0595, 1.0, bias=0.0728),
)
"""Runs in which nothing turns round: a drag and a sensor's offset are the same there."""


@cache
def _tied() -> jbf.Diagnosis:
    rig, runs, _ = campaign(65, ("coulomb_drag",), motions=ONE_WAY)
    return jbf.diagnose(rig, runs)


def _played(run: jbf.Run) -> Motion:
    """The motion of a proposed run on the simulated rig, drawn through every fifth sample."""
    knots = zip(run.time_s[::5].tolist(), run.velocity_m_s[::5].tolist(), strict=True)
    return polyline("next", list(knots))


def test_the_next_run_breaks_the_tie() -> None:
    found = _tied()
    assert found.verdict == "ambiguous"
    names = {*found.effects, *found.alternatives[found.effects[0]]}
    assert names == {"coulomb_drag", "sensor_offset"}
    assert found.experiment is not None
    assert found.next_experiment == found.experiment.words
    assert "two-way" in found.experiment.words
    assert found.experiment.evidence > 100.0

    motions = (*ONE_WAY, _played(found.experiment.run))
    rig, runs, _ = campaign(65, ("coulomb_drag",), motions=motions)
    after = jbf.diagnose(rig, runs)
    assert after.verdict == "missing"
    assert after.effects == ("coulomb_drag",)


def test_the_motion_keeps_to_the_limits() -> None:
    limits = Limits(0.05, 0.02, 30.0, (80.0, 120.0))
    seen = list(excitations(limits, 0.02))
    assert len(seen) > 10
    for excitation in seen:
        assert np.max(np.abs(excitation.velocity_m_s)) <= 0.05 * (1.0 + 1e-12)
        assert np.max(np.abs(np.diff(excitation.velocity_m_s))) <= 1.02 * 0.02 * 0.02
        assert len(excitation.velocity_m_s) == 1500
        assert abs(excitation.velocity_m_s[0]) < 1e-3
    assert {e.load_n for e in seen} == {80.0, 120.0}


@pytest.mark.parametrize("top", [0.1, 2.0])
def test_a_motion_goes_as_fast_as_it_is_said_to(top: float) -> None:
    kinds = set()
    for excitation in excitations(Limits(top, 5.0 * top, 60.0), 0.01):
        fastest = max(float(said) for said in re.findall(r"(\S+) m/s", excitation.words))
        assert np.max(np.abs(excitation.velocity_m_s)) == pytest.approx(fastest, rel=0.02)
        kinds.add(excitation.words.split()[1])
    assert kinds >= {"two-way", "one-way", "run", "and"}


def test_a_mixed_motion_has_rests_a_fast_and_a_quick_part() -> None:
    limits = Limits(0.1, 0.5, 60.0)
    mixed = [e for e in excitations(limits, 0.01) if e.words.count(", then ") == 2]
    assert mixed
    for excitation in mixed:
        v = excitation.velocity_m_s
        third = len(v) // 3
        assert np.mean(v[:third] == 0.0) > 0.3
        assert np.max(v) == pytest.approx(0.1, rel=0.01)
        assert np.min(v) == pytest.approx(-0.1, rel=0.01)
        turns = np.flatnonzero(np.diff(np.sign(v[-third // 2 :])))
        assert len(turns) > 4
    # A run too short for a rest there and back has no such motion.
    short = excitations(Limits(0.1, 0.5, 12.0), 0.01)
    assert not any(", then " in e.words for e in short)


def test_what_slow_sweeps_cannot_show_is_said_and_the_next_run_shows_it() -> None:
    sweeps = (sweep("sweep", 0.13, 60.0), sine("slow", 140.0, 0.127, 0.045))
    rig, runs, _ = campaign(67, ("inertia_leak",), motions=sweeps)
    found = jbf.diagnose(rig, runs)
    assert found.verdict == "adequate"
    assert "inertia_leak" in found.unseen
    assert "coulomb_drag" not in found.unseen
    assert found.next_experiment is not None
    assert "inertia_leak" in found.next_experiment
    assert "inertia_leak" in found.summary()
    assert found.experiment is not None

    motions = (*sweeps, _played(found.experiment.run))
    rig, runs, _ = campaign(67, ("inertia_leak",), motions=motions)
    assert "inertia_leak" in jbf.diagnose(rig, runs).effects


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ({"velocity_m_s": -1.0}, "velocity_m_s"),
        ({"duration_s": 0.0}, "duration_s"),
        ({"acceleration_m_s2": float("nan")}, "acceleration_m_s2"),
        ({"load_n": (2.0, 1.0)}, "load_n"),
    ],
)
def test_limits_that_are_none_are_refused(given: dict[str, float], name: str) -> None:
    with pytest.raises(jbf.InputError, match=name):
        Limits(**given)  # type: ignore[arg-type]


def test_from_the_shell(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig, runs, _ = campaign(65, ("coulomb_drag",), motions=ONE_WAY)
    rig.write(tmp_path / "rig.toml")
    for run in runs:
        run.write_csv(tmp_path / f"{run.name}.csv")
    out = tmp_path / "next.csv"
    words = [
        "diagnose",
        str(tmp_path / "rig.toml"),
        *(str(tmp_path / f"{r.name}.csv") for r in runs),
    ]
    assert main([*words, "--next-run", str(out), "--max-velocity-m-s", "0.05"]) == 0
    assert "Next experiment: record" in capsys.readouterr().out
    played = jbf.read_run(out, need_friction=False)
    assert np.max(np.abs(played.velocity_m_s)) <= 0.05
    assert played.friction_n is None
    assert played.angle_rad is not None

    assert main([*words, "--max-velocity-m-s", "0"]) == 2
    assert "velocity_m_s" in capsys.readouterr().err
