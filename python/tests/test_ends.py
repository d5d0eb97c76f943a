"""Ends of a channel that are off what comes next to them: which are found, and what becomes of
them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run, fit
from jbf.records.findings.ends import LEAST_SAMPLES, MOST, TIMES, ends_finding, loose_ends
from jbf.records.findings.examine import examine
from jbf.records.motion.believed import believed
from jbf.records.motion.glitches import mend_speed_ends
from jbf.records.motion.imposed import impose

DT = 0.01
TIME: Any = DT * np.arange(1000)
SPEED: Any = 0.2 * np.sin(1.7 * TIME + 0.4)
FORCE: Any = 5.0 * np.sign(SPEED) + 20.0 * SPEED
PATH: Any = -0.2 / 1.7 * np.cos(1.7 * TIME + 0.4)


def noise(seed: int, sd: float = 1.0) -> Any:
    return sd * np.random.default_rng(seed).standard_normal(len(TIME))


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("last", [False, True])
def test_ends_that_are_off_are_found_up_to_three(count: int, last: bool) -> None:
    assert MOST == 3
    values = noise(1)
    part = slice(len(values) - count, None) if last else slice(count)
    values[part] += 60.0
    wanted = np.zeros(len(values), dtype=bool)
    wanted[part] = True
    np.testing.assert_array_equal(loose_ends(TIME, values, 1), wanted)


def test_a_fourth_sample_makes_a_level_that_the_record_begins_with() -> None:
    values = noise(1)
    values[:4] += 60.0
    assert not loose_ends(TIME, values, 1).any()


def test_an_end_is_off_by_times_what_any_sample_within_is() -> None:
    """Steps of one N to and fro, and a first one of as many as are too many."""
    assert TIMES == 4.0
    within = np.arange(200) % 2.0
    time = DT * np.arange(200)
    for jump, found in ((-4.0, False), (-4.01, True), (4.0, False), (4.01, True)):
        values = within.copy()
        values[0] = values[1] + jump
        assert loose_ends(time, values, 1)[0] == found


def test_jumps_within_are_as_large_as_that_of_a_reversal() -> None:
    """Friction turns round by 10 N: a first value of zero is nothing beside it."""
    force = 5.0 * np.sign(SPEED) + noise(2, 0.1)
    force[0] = 0.0
    assert not loose_ends(TIME, force, 1).any()
    force[0] = 60.0
    assert loose_ends(TIME, force, 1)[0]


def test_a_path_is_told_by_a_parabola_at_any_instants() -> None:
    """Its steps are no jumps, however fast it goes; times are uneven."""
    time = np.cumsum(np.random.default_rng(3).uniform(0.5, 1.5, 200)) * DT
    path = 3.0 + 20.0 * time - 4.0 * time**2 + 1e-4 * noise(4)[:200]
    assert not loose_ends(time, path, 3).any()
    path[-1] += 0.02
    np.testing.assert_array_equal(np.flatnonzero(loose_ends(time, path, 3)), [199])


def test_records_that_are_short_or_never_change_have_no_ends() -> None:
    values = noise(1)[:LEAST_SAMPLES]
    values[0] = 1e3
    assert loose_ends(TIME[:LEAST_SAMPLES], values, 1)[0]
    assert not loose_ends(TIME[: LEAST_SAMPLES - 1], values[:-1], 1).any()
    still = np.full(100, 2.0)
    still[0] = 0.0
    assert not loose_ends(TIME[:100], still, 1).any()


def test_what_is_said_of_ends() -> None:
    mask = np.zeros(100, dtype=bool)
    assert ends_finding("friction_n", "force", "a", mask, mask * 1.0, "N", "set aside") is None
    mask[[0, 98, 99]] = True
    off = np.where(mask, -12.345, 0.0)
    found = ends_finding("friction_n", "force", "a", mask, off, "N", "set aside")
    assert found is not None
    assert (found.kind, found.channel, found.run, found.done) == (
        "glitches",
        "friction_n",
        "a",
        "set aside",
    )
    assert found.size == pytest.approx(12.345)
    assert found.words == (
        "the first sample and the last 2 samples of the force off by up to 12.3 N"
    )


def recorded(**columns: Any) -> Run:
    given = {"velocity_m_s": SPEED + noise(5, 1e-4), "friction_n": FORCE + noise(6, 0.1)}
    return Run.from_arrays(TIME, **{**given, **columns}, name="a")


@pytest.mark.parametrize("place", [0, -1])
def test_a_force_that_begins_or_ends_elsewhere_is_set_aside(place: int) -> None:
    force: Any = np.array(recorded().friction_n)
    force[place] = 400.0
    found = examine(recorded(friction_n=force))
    assert np.flatnonzero(~found.usable).tolist() == [range(len(force))[place]]
    assert [(f.kind, f.channel) for f in found.findings] == [("glitches", "friction_n")]
    # Beside another that sticks out within, which would hide it.
    force[500] = 900.0
    found = examine(recorded(friction_n=force))
    assert np.sum(~found.usable) == 2
    assert len(found.findings) == 2


def test_a_peak_where_the_motion_begins_is_frictions_own() -> None:
    force: Any = np.array(recorded().friction_n)
    speed: Any = np.array(recorded().velocity_m_s)
    force[2], speed[:2] = 400.0, 0.0
    assert examine(recorded(friction_n=force, velocity_m_s=speed)).usable.all()


@pytest.mark.parametrize("place", [0, -1])
@pytest.mark.parametrize("angle", [False, True])
def test_a_speed_that_begins_or_ends_elsewhere_is_left_out(place: int, angle: bool) -> None:
    speed: Any = np.array(recorded().velocity_m_s)
    speed[place] = 40.0
    more = {"angle_rad": PATH / 0.5} if angle else {}
    run = recorded(velocity_m_s=speed, **more)
    found = believed(run, 0.5)
    assert np.flatnonzero(found.loose).tolist() == [range(len(speed))[place]]
    np.testing.assert_allclose(found.speed, SPEED, atol=2e-3)
    motion = impose(run, 0.5)
    assert not motion.sign_known[place]
    assert motion.sign_known[[1, 2, -3, -2]].all()
    assert [(f.kind, f.channel) for f in motion.findings] == [("glitches", "velocity_m_s")]


def test_a_speed_that_the_path_goes_is_believed() -> None:
    """A shaft that is let go within a sample of the end."""
    speed = SPEED + noise(5, 1e-4)
    speed[-1] += 1.0
    path = PATH.copy()
    path[-1] += 0.5 * DT
    mended, loose, found = mend_speed_ends("a", TIME, speed, path, "m/s")
    assert not loose.any()
    assert found == []
    np.testing.assert_array_equal(mended, speed)
    mended, loose, found = mend_speed_ends("a", TIME, speed, PATH, "m/s")
    assert loose.sum() == len(found) == 1
    assert mended[-1] == pytest.approx(SPEED[-1], abs=2e-3)


@pytest.mark.parametrize("place", [0, -1])
@pytest.mark.parametrize("speed", [False, True])
def test_a_position_that_begins_or_ends_elsewhere_is_left_out(place: int, speed: bool) -> None:
    path = PATH.copy()
    path[place] += 0.1
    columns: dict[str, Any] = {"friction_n": recorded().friction_n, "angle_rad": path / 0.5}
    if speed:
        columns["velocity_m_s"] = recorded().velocity_m_s
    run = Run.from_arrays(TIME, **columns, name="a")
    found = believed(run, 0.5)
    assert found.path is not None
    np.testing.assert_allclose(found.path, PATH, atol=1e-4)
    assert np.flatnonzero(found.loose).tolist() == [range(len(path))[place]]
    (finding,) = [f for f in found.findings if f.kind == "glitches"]
    assert (finding.channel, finding.unit) == ("angle_rad", "rad")
    assert finding.size == pytest.approx(0.2, rel=0.02)


def test_a_first_row_of_rubbish_changes_no_fit() -> None:
    """All channels at once, as of a logger that starts with what its memory held."""
    clean = [recorded(), recorded(friction_n=FORCE + noise(8, 0.1))]
    rubbish = []
    for run in clean:
        assert run.friction_n is not None
        speed, force = run.velocity_m_s.copy(), run.friction_n.copy()
        speed[0], force[0] = 99.0, -1234.5
        rubbish.append(recorded(velocity_m_s=speed, friction_n=force))
    wanted = fit(Rig(), clean, law="coulomb")
    found = fit(Rig(), rubbish, law="coulomb")
    for name, value in wanted.model.parameters.items():
        assert found.model.parameters[name].value == pytest.approx(value.value, rel=2e-3), name
