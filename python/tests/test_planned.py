"""Planned runs as they would be recorded, and runs made ready: by motions of round numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from by_hand import LAW
from jbf import InputError, Model, Rig, Run
from jbf.diagnosis.planned import _as_read, as_recorded, planned_power
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.prepared import Prepared
from jbf.models.chain import chain
from jbf.records.findings.finding import Finding
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.toml_file import MOST

STEP_S = 0.02
TIME = STEP_S * np.arange(600.0)
SPEED = 0.1 * np.sin(TIME)
MODEL = Model(Rig(), "coulomb", parameters={**LAW, "F_s_n": 5.0})


def run(name: str = "a", **columns: Any) -> Run:
    force = columns.pop("force", 5.0 * np.sign(SPEED) + 20.0 * SPEED)
    return Run.from_arrays(TIME, SPEED, force, name=name, **columns)


# ---- planned -----------------------------------------------------------------------------------


def test_samples_next_to_a_reversal_are_of_unknown_sign() -> None:
    v = np.array([1.0, 1.0, -1.0, -1.0, -1.0, 0.0, 0.0, 1.0])
    known = np.array([True, True, True, True, True, False, False, True])
    motion = ImposedMotion(v, np.zeros(8), np.zeros(8), np.zeros(8), v == 0.0, known)
    found = _as_read(motion)
    assert found.sign_known.tolist() == [True, False, False, True, False, False, False, False]
    assert motion.sign_known[1]
    assert found.velocity_m_s is motion.velocity_m_s


@pytest.mark.parametrize("noise_n", [0.01, 0.5])
def test_planned_runs_are_recorded_with_white_noise(noise_n: float) -> None:
    candidates = as_recorded(MODEL, [run("a"), run("b", force=7.0 * SPEED)], noise_n, DEFAULT)
    clean = MODEL.predict_many([run(), run()])
    noise = [p.friction_n - f for p, f in zip(candidates.campaign.prepared, clean, strict=True)]
    assert [float(np.std(e)) for e in noise] == pytest.approx([noise_n] * 2, rel=0.1)
    assert abs(np.corrcoef(noise[0], noise[1])[0, 1]) < 0.15
    again = as_recorded(MODEL, [run("a"), run("b", force=7.0 * SPEED)], noise_n, DEFAULT)
    assert np.array_equal(
        again.campaign.prepared[0].friction_n, candidates.campaign.prepared[0].friction_n
    )
    # What is not known of the motion counts nowhere.
    p = candidates.campaign.prepared[0]
    turns = np.flatnonzero(np.diff(np.sign(p.motion.velocity_m_s)) != 0.0)
    assert len(turns) > 2
    assert not candidates.campaign.samples.counted[0][turns].any()
    assert not candidates.campaign.samples.counted[0][turns + 1].any()


@pytest.mark.parametrize(
    ("noise_n", "said"),
    [
        (0.0, "not above zero"),
        (-1.0, "not above zero"),
        (np.inf, "not above zero"),
        (2.0 * MOST, "beyond what any"),
    ],
)
def test_a_noise_is_above_zero(noise_n: float, said: str) -> None:
    with pytest.raises(InputError, match=said):
        planned_power(MODEL, [run()], noise_n=noise_n)


def test_a_plan_has_runs() -> None:
    with pytest.raises(InputError, match="no run was given"):
        planned_power(MODEL, [], noise_n=0.1)


def test_what_planned_runs_would_show_is_told() -> None:
    found = planned_power(MODEL, [run("a"), run("b"), run("c")], noise_n=0.1)
    told = found.to_dict()
    assert (told["law"], told["effects"], told["noise_n"]) == ("coulomb", [], 0.1)
    assert told["runs"] == ["a", "b", "c"]
    assert told["level"] == found.level.to_dict()
    assert told["power"] == [p.to_dict() for p in found.power]
    assert told["not_tried"] == found.not_tried
    assert {p.effect for p in found.power} >= {"sensor_offset", "inertia_leak"}


# ---- runs made ready ---------------------------------------------------------------------------


def test_a_run_is_ready_with_its_usual_step_and_its_readings() -> None:
    p = Prepared.of(Rig(), run())
    assert p.step_s == pytest.approx(STEP_S)
    assert np.array_equal(p.readings_n, p.friction_n)
    instants, motion = p.motion_as_read
    assert instants is p.run.time_s
    assert motion is p.motion
    assert p.recorded is None
    assert p.converter_step_n == 0.0
    found = Finding("steps", "friction_n", "a", 0.5, "N", "none", "")
    other = Finding("steps", "friction_n", "a", 0.75, "N", "none", "")
    more = p.finding([found, other, Finding("made_up", "x", "a", 9.0, "N", "none", "")])
    assert more.converter_step_n == 0.75
    assert len(more.examined.findings) == len(p.examined.findings) + 3
    assert p.converter_step_n == 0.0


def test_what_never_moves_is_refused() -> None:
    still = Run.from_arrays(TIME, np.zeros(600), np.ones(600), name="still")
    with pytest.raises(InputError, match="never moves"):
        Prepared.of(Rig(), still)


@pytest.mark.parametrize(("late_s", "drift"), [(0.1, 0.0), (-0.1, 0.0), (0.0, -5e-3)])
def test_a_late_force_is_compared_with_the_motion_so_long_before(
    late_s: float, drift: float
) -> None:
    """In the middle by so much, and by so much more in a second; what was read beyond the motion
    is left."""
    p = Prepared.of(Rig(), run())
    shifted = p.shifted(late_s, drift)
    read = TIME - late_s - drift * (TIME - 0.5 * TIME[-1])
    kept = (read >= TIME[0]) & (read <= TIME[-1])
    assert not kept.all()
    assert shifted.run.time_s == pytest.approx(read[kept])
    assert shifted.friction_n == pytest.approx(p.friction_n[kept])
    assert len(shifted.examined.usable) == int(kept.sum())
    expected = 0.1 * np.sin(read[kept])
    assert shifted.motion.velocity_m_s == pytest.approx(expected, abs=2e-4)
    assert shifted.recorded is not None
    assert np.array_equal(shifted.recorded[0], TIME)
    # From where it was recorded: shifted twice is not shifted by the sum.
    again = shifted.shifted(0.0, 0.0)
    assert again.run.time_s == pytest.approx(shifted.run.time_s)


def test_a_motion_read_more_often_than_the_force_is_followed_in_between() -> None:
    p = Prepared.of(Rig(), run())
    fine = np.asarray(np.linspace(TIME[0], TIME[-1], 4 * 599 + 1), dtype=np.float64)
    sparse = Prepared(
        p.rig, p.run, p.motion, p.friction_n, p.step_s, p.examined, (fine, p.motion.at(TIME, fine))
    )
    driven = sparse.core
    assert driven.kept is not None
    assert len(driven.kept) == 600
    assert np.array_equal(driven.kept, 4 * np.arange(600))
    # As often as the force it tells no more.
    same = Prepared(p.rig, p.run, p.motion, p.friction_n, p.step_s, p.examined, (TIME, p.motion))
    model = MODEL
    law = model.predict(run())
    core = chain(Rig(), "coulomb", "journal", ())
    for ready in (p, same, sparse):
        assert core.predict(model.values, [ready.core])[0] == pytest.approx(law, abs=2e-2)
    assert "core" not in sparse.__getstate__()


def test_a_force_with_a_clock_of_its_own_is_read_from_the_first_to_the_last_of_the_motion() -> None:
    """Readings before the motion begins, and after it ends, are left."""
    motion = 0.01 * np.arange(1001.0)
    force = 0.02 * np.arange(-5.0, 506.0)
    v = 0.1 * np.sin(motion)
    there = 5.0 * np.sign(np.sin(force)) + 2.0 * np.sin(force)
    given = {"velocity_m_s": (motion, v), "friction_n": (force, there)}
    p = Prepared.of(Rig(), Run.from_channels(given, name="a"))
    inside = (force >= -1e-12) & (force <= motion[-1] + 1e-12)
    assert inside.sum() == 501
    assert p.run.time_s == pytest.approx(force[inside])
    assert p.friction_n == pytest.approx(there[inside])
    assert p.recorded is not None
    assert p.recorded[0] == pytest.approx(motion)
    assert p.motion.velocity_m_s == pytest.approx(0.1 * np.sin(force[inside]), abs=1e-3)
