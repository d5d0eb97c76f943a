"""A run made ready: what its findings say of its readings, its force at other instants of the
motion, and the core's copy."""

from __future__ import annotations

import pickle
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf import InputError, Rig, Run
from jbf.estimation.prepared import FINER, Prepared
from jbf.records.findings.examine import Examined
from jbf.records.findings.finding import Finding
from jbf.records.findings.interpolated import Native

module = sys.modules["jbf.estimation.prepared"]
STEP_S = 3.0 / 128.0
TIME = 5.0 + STEP_S * np.arange(400)


def speed(time: Array) -> Array:
    found: Array = 0.1 * np.sin(1.7 * time) + 0.02 * np.cos(4.1 * time)
    return found


def run(**more: Any) -> Run:
    v = speed(TIME)
    return Run.from_arrays(TIME, v, 5.0 * np.sign(v) + 20.0 * v, name="slide", **more)


@pytest.fixture(scope="module")
def ready() -> Prepared:
    return Prepared.of(Rig(), run())


def finding(kind: str, size: float, unit: str = "N") -> Finding:
    return Finding(kind, "friction_n", "slide", size, unit, "told", kind)


def test_findings_tell_steps_and_the_rate_of_what_was_drawn(ready: Prepared) -> None:
    """The largest of each; a time is no rate, and a bias of steps is no step."""
    assert (ready.converter_step_n, ready.drawn_at_hz) == (0.0, 0.0)
    some = ready.finding(
        [
            finding("steps", 0.25),
            finding("interpolated", 50.0, "Hz"),
            finding("interpolated", 900.0, "s"),
        ]
    )
    more = some.finding(
        [finding("steps", 0.5), finding("late", 70.0, "Hz"), finding("interpolated", 20.0, "Hz")]
    )
    assert (some.converter_step_n, some.drawn_at_hz) == (0.25, 50.0)
    assert (more.converter_step_n, more.drawn_at_hz) == (0.5, 50.0)
    assert more.examined.findings[: len(some.examined.findings)] == some.examined.findings
    assert more.friction_n is ready.friction_n


def test_the_motion_is_that_of_the_run_where_it_has_no_clock_of_its_own(ready: Prepared) -> None:
    instants, motion = ready.motion_as_read
    assert instants is ready.run.time_s
    assert motion is ready.motion
    other = (TIME[::2], ready.motion)
    assert replace(ready, recorded=other).motion_as_read is other


def test_a_run_that_never_moves_is_named() -> None:
    still = Run.from_arrays(TIME, np.zeros(len(TIME)), np.ones(len(TIME)), name="still")
    with pytest.raises(InputError) as refused:
        Prepared.of(Rig(), still)
    assert refused.value.file == "still"
    assert "never moves" in str(refused.value)


def test_a_load_is_steadied_before_anything_is_drawn_through_it() -> None:
    """Noise about 100 N is 100 N; a load that moves is as it was."""
    noise = 0.5 * np.random.default_rng(1).standard_normal(len(TIME))
    steady = Prepared.of(Rig(), run(load_n=100.0 + noise)).run.load_n
    assert steady is not None
    assert np.ptp(steady) == 0.0
    assert steady[0] == pytest.approx(100.0, abs=0.1)
    assert not steady.flags.writeable
    swings = 100.0 + 20.0 * np.sin(TIME)
    assert Prepared.of(Rig(), run(load_n=swings)).run.load_n == pytest.approx(swings)


# ---- clocks of its own -------------------------------------------------------------------------


def test_a_force_is_compared_where_its_motion_is_known() -> None:
    """What was read before the motion begins, or after it ends, has none; at its ends it has."""
    instants = TIME[10:301]
    force = TIME[::5]
    channels = {
        "velocity_m_s": (instants, speed(instants)),
        "position_m": (instants, STEP_S * np.cumsum(speed(instants))),
        "friction_n": (force, 5.0 * np.sign(speed(force))),
    }
    found = Prepared.of(Rig(), Run.from_channels(channels, name="slide"))
    assert found.run.time_s.tolist() == TIME[10:301:5].tolist()
    assert found.run.read == {}
    assert len(found.motion.velocity_m_s) == len(found.run)
    assert found.recorded is not None
    assert found.recorded[0].tolist() == instants.tolist()


@pytest.mark.parametrize("own_clock", [False, True])
def test_what_was_drawn_in_lines_is_compared_at_its_readings(
    own_clock: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The motion stays that of its own instants; steps are looked for as in what was drawn."""
    ticks = TIME[20:380:6]
    native = Native(ticks, 5.0 * np.sign(speed(ticks)), 6.0 * STEP_S)
    usable = np.arange(len(ticks)) % 7 > 0
    asked: list[Any] = []

    def examine(run: Run, velocity: Array, period_s: float | None) -> Examined:
        asked.append(period_s)
        return Examined((finding("interpolated", 7.0, "Hz"),), np.ones(len(run), bool), native)

    def steps(run: Run, may: Array, *, drawn: bool = False) -> list[Finding]:
        asked.append((may is usable, drawn))
        return [finding("steps", 0.25)]

    monkeypatch.setattr(module, "examine", examine)
    monkeypatch.setattr(
        module, "examine_readings", lambda run, v: Examined((finding("spikes", 1.0),), usable)
    )
    monkeypatch.setattr(module, "find_steps", steps)
    given = run()
    if own_clock:
        fine = TIME[0] + 0.5 * STEP_S * np.arange(799)
        v = speed(fine)
        channels = {
            "velocity_m_s": (fine, v),
            "position_m": (fine, 0.5 * STEP_S * np.cumsum(v)),
            "friction_n": (TIME, 5.0 * np.sign(speed(TIME))),
        }
        given = Run.from_channels(channels, name="slide")
    found = Prepared.of(Rig(), given, 3.0)
    assert asked == [3.0, (True, True)]
    assert found.run.time_s.tolist() == ticks.tolist()
    assert found.friction_n.tolist() == native.values.tolist()
    assert found.examined.usable is usable
    assert [f.kind for f in found.examined.findings[:3]] == ["interpolated", "spikes", "steps"]
    assert found.step_s == pytest.approx(6.0 * STEP_S)
    assert found.recorded is not None
    assert len(found.recorded[0]) == (799 if own_clock else 400)
    assert len(found.recorded[1].velocity_m_s) == len(found.recorded[0])
    assert found.motion.velocity_m_s == pytest.approx(speed(ticks), abs=2e-3)


# ---- a force at other instants -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("late", "drift", "first", "last"),
    [
        (0.0, 0.0, 0, 400),
        # Read just as the motion begins, or ends, it can be compared.
        (2.0, 0.0, 2, 400),
        (-3.0, 0.0, 0, 397),
        (2.5, 0.0, 3, 400),
        # It is late so in the middle, whenever the run began.
        (0.0, 2.0**-7, 0, 400),
        (0.0, -(2.0**-7), 2, 398),
    ],
)
def test_a_force_is_late_by_its_steps_in_the_middle(
    ready: Prepared, late: float, drift: float, first: int, last: int
) -> None:
    found = ready.shifted(late * STEP_S, drift)
    middle = 0.5 * (TIME[0] + TIME[-1])
    read = TIME - late * STEP_S - drift * (TIME - middle)
    assert found.run.time_s == pytest.approx(read[first:last], abs=1e-12)
    assert found.friction_n.tolist() == ready.friction_n[first:last].tolist()
    assert found.readings_n.tolist() == ready.readings_n[first:last].tolist()
    assert found.examined.usable.tolist() == ready.examined.usable[first:last].tolist()
    assert found.motion.velocity_m_s[5:-5] == pytest.approx(speed(read[first:last])[5:-5], abs=1e-4)
    assert found.recorded is not None
    assert found.recorded[0] is ready.run.time_s


# ---- the core's copy ---------------------------------------------------------------------------


def instants_of_core(p: Prepared, monkeypatch: pytest.MonkeyPatch) -> tuple[Array, Any]:
    """The instants that the core was given, and which of them are the run's samples."""
    asked: list[Array] = []
    real = module.driven_motion

    def seen(rig: Rig, run: Run, motion: Any) -> Any:
        assert len(motion.velocity_m_s) == len(run)
        asked.append(run.time_s)
        return real(rig, run, motion)

    monkeypatch.setattr(module, "driven_motion", seen)
    kept = p.core.kept
    return asked[0], kept


@pytest.mark.parametrize(
    ("step", "whole"),
    # Of a motion that was read at half as many instants again, or at more, those are the core's.
    [(3.0, False), (2.01, False), (2.0, True), (1.0, True)],
)
def test_a_motion_that_was_read_more_often_is_the_cores(
    ready: Prepared, step: float, whole: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert FINER == 1.5
    count = int(1.1 * 400 * 3.0 / step)
    instants = TIME[0] - 0.25 + step / 128.0 * np.arange(count)
    fine = Run.from_arrays(instants, speed(instants), np.ones(count))
    motion = Prepared.of(Rig(), fine).motion
    given, kept = instants_of_core(replace(ready, recorded=(instants, motion)), monkeypatch)
    if not whole:
        assert given.tolist() == TIME.tolist()
        return
    inside = instants[(instants > TIME[0]) & (instants < TIME[-1])]
    assert given.tolist() == np.union1d(inside, TIME).tolist()
    # Its predictions stand at the run's samples.
    assert len(kept) == len(TIME)


def test_what_goes_to_another_process_makes_its_own_copy(ready: Prepared) -> None:
    assert ready.core is ready.core
    again = pickle.loads(pickle.dumps(ready))
    assert "core" not in vars(again)
    assert again.friction_n.tolist() == ready.friction_n.tolist()
    assert again.core is not ready.core
