"""Findings of whole runs: gaps, clocks, copies, a force that pushes; both sides of thresholds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.findings.gaps import find_gaps
from jbf.records.findings.own_clock import own_clock
from jbf.records.findings.pushing import _with_way, find_pushing
from jbf.records.findings.repeated_run import copies, repeated, same_recording
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.quantities import ROTARY

N = 2000
TIME: Any = 0.01 * np.arange(N)
NOISE: Any = np.random.default_rng(1).standard_normal(N)
WAVE: Any = 10.0 * np.sin(0.7 * TIME)


def run_of(force: Any, speed: Any = None, **more: Any) -> Run:
    time = TIME[: len(force)]
    velocity = 0.1 * np.sin(0.7 * time + 0.1) if speed is None else speed
    return replace(Run.from_arrays(time, velocity, force, name="a"), **more)


def test_rows_that_are_missing_are_counted_by_the_usual_step() -> None:
    """In all, and the longest gap; of samples without a rate there are none."""
    clock = np.delete(TIME[:200], [50, 100, 101, 102])
    (found,) = find_gaps(Run.from_arrays(clock, np.ones(len(clock)), name="a"))
    assert (found.kind, found.channel, found.run, found.unit) == ("gaps", "time_s", "a", "s")
    assert found.size == pytest.approx(0.04)
    assert found.words == "4 rows are missing, 0.04 s at the longest"
    assert found.done == "stepped over"
    assert find_gaps(Run.from_arrays(TIME[:200], np.ones(200))) == []
    # Steps of 1.4 times the usual are jitter; from 1.5 on a row is missing.
    for times, count in ((1.4, 0), (1.6, 1), (2.4, 1), (2.6, 2)):
        late = TIME[:100].copy()
        late[50:] += (times - 1.0) * 0.01
        told = find_gaps(Run.from_arrays(late, np.ones(100)))
        assert len(told) == (count > 0)
        assert all(f.words.startswith(f"{count} row") for f in told)
    # Nine of ten steps must be the usual one.
    for every, there in ((8, False), (12, True)):
        uneven = np.delete(TIME[:240], np.arange(5, 230, every))
        assert (find_gaps(Run.from_arrays(uneven, np.ones(len(uneven)))) != []) == there


def test_a_force_of_another_clock_is_told_with_both_rates() -> None:
    """Either may be the slower; where both are read at every row nothing is said."""
    every = np.arange(N) % 4 == 0
    other = np.arange(N) % 5 == 0
    (found,) = own_clock(run_of(WAVE, read={"friction_n": every, "velocity_m_s": other}))
    assert found.words == "the force was read at 25 Hz and the motion at 20 Hz"
    assert (found.kind, found.channel, found.run) == ("own_clock", "friction_n", "a")
    assert found.size == pytest.approx(25.0)
    assert (found.unit, found.done) == ("Hz", "compared at its own readings")
    (found,) = own_clock(run_of(WAVE, read={"friction_n": every}, quantities=ROTARY))
    assert found.words == "the torque was read at 25 Hz and the motion at 100 Hz"
    (found,) = own_clock(run_of(WAVE, read={"velocity_m_s": every}))
    assert found.words == "the force was read at 100 Hz and the motion at 25 Hz"
    assert own_clock(run_of(WAVE, read={"load_n": every})) == own_clock(run_of(WAVE)) == []


def test_the_same_recording_under_another_name_is_found() -> None:
    """Whenever it began and wherever its angle stood; not with a digit that differs."""
    angle = 0.3 * TIME
    run = run_of(WAVE, angle_rad=angle)
    later = replace(run, name="b", time_s=run.time_s + 5.0, angle_rad=angle - 2.0)
    other = replace(run, name="c", friction_n=WAVE + np.where(TIME == 5.0, 1e-9, 0.0))
    assert same_recording(run, later)
    assert not same_recording(run, other)
    assert copies([run, other, later, run, other]) == {2: 0, 3: 0, 4: 1}
    assert copies([run, other]) == {}
    for span, alike in ((0.9e-6, True), (1.1e-6, False)):
        moved = angle - 2.0 + np.where(TIME == 5.0, span * 0.3 * TIME[-1], 0.0)
        assert same_recording(run, replace(later, angle_rad=moved)) == alike
    assert not same_recording(run, replace(run, angle_rad=None))
    assert not same_recording(replace(run, friction_n=None), replace(run, friction_n=None))
    assert not same_recording(run, run.select(slice(1, None)))
    warm = np.where(TIME < 5.0, np.nan, 20.0)
    assert same_recording(replace(run, extra={"w": warm}), replace(run, extra={"w": warm}))
    told = repeated(run, later)
    assert told.words == "it is run a again, sample by sample"
    assert (told.kind, told.run, told.size, told.unit) == ("repeated_run", "b", N, "samples")
    assert (told.channel, told.done) == ("friction_n", "left out")


def motion_of(v: Any, known: Any = None) -> ImposedMotion:
    """A motion that is known exactly, with an acceleration and a way that are no friction's."""
    n = len(v)
    path = np.cumsum(v) * 0.01
    sure = np.ones(n, dtype=bool) if known is None else known
    none = np.zeros(n, dtype=bool)
    return ImposedMotion(v, np.gradient(v, 0.01), path, np.zeros(n), none, sure)


SPEED: Any = 0.1 * np.sin(2.3 * TIME + 0.2)


def pushes(push: float, noise: float = 0.1, v: Any = SPEED, known: Any = None,
           usable: Any = None) -> Any:  # fmt: skip
    """What is said of a force of so much against the motion, beside a zero, a mass, a spring."""
    m = motion_of(v, known)
    force = push * np.sign(v) + 3.0 + 0.2 * m.acceleration_m_s2 - 5.0 * m.angle_rad
    run = run_of(force + noise * NOISE[: len(v)], v, quantities=ROTARY)
    return find_pushing(run, m, np.ones(len(v), dtype=bool) if usable is None else usable)


def test_a_force_that_goes_with_the_motion_is_told_by_how_much() -> None:
    """Beside a zero, a mass and a spring; one that brakes is not told."""
    (found,) = pushes(-2.0)
    assert found.size == pytest.approx(-2.0, abs=0.05)
    assert found.words == (
        f"the torque goes with the motion, by {-found.size:.3g} N m: torque_n_m is against it "
        "where it is positive with a positive speed; turn its sign, or the speed's and the "
        "position's"
    )
    assert (found.kind, found.channel, found.run) == ("sign", "friction_n", "a")
    assert (found.unit, found.done) == ("N m", "none")
    assert pushes(2.0) == pushes(0.0) == []


def test_a_push_is_told_where_it_is_sure_and_no_small_share() -> None:
    """Eight standard errors; three tenths of the force's own swing; enough samples, both ways."""
    small = motion_of(SPEED)
    swing = float(np.std(0.2 * small.acceleration_m_s2 - 5.0 * small.angle_rad))
    for share, there in ((0.2, False), (0.5, True)):
        push = -share * swing / np.sqrt(1.0 - share**2)
        assert (pushes(push, noise=1e-3) != []) == there
    assert pushes(-1.0, noise=20.0) == []
    few = np.zeros(N, dtype=bool)
    few[np.linspace(0, N - 1, 95).astype(int)] = True
    assert pushes(-2.0, known=few) == pushes(-2.0, usable=few) == []
    few[np.linspace(5, N - 5, 40).astype(int)] = True
    assert pushes(-2.0, known=few) != []
    for forth, there in ((0.65, True), (0.85, False)):
        v = np.where(np.arange(N) < forth * N, 0.1, -0.1) + 0.02 * np.sin(9.0 * TIME)
        told = pushes(-2.0, v=v)
        assert (told != []) == there
        assert all(f.size == pytest.approx(-2.0, abs=0.03) for f in told)
    # Slower than a fiftieth of the top a force need not be friction's.
    crawl = np.where(np.abs(SPEED) > 0.05, SPEED, 0.0015 * np.sign(SPEED))
    only = np.abs(SPEED) < 0.05
    assert pushes(-2.0, v=crawl, known=only) == []


def test_the_force_that_turns_with_the_motion_has_the_error_of_parts_left_out() -> None:
    """Of white noise that of least squares, nearly."""
    way = np.where(np.arange(N) % 100 < 50, 1.0, -1.0)
    x = np.stack([way, np.ones(N)], axis=1)
    push, error = _with_way(x, 2.0 * way + 5.0)
    assert push == pytest.approx(2.0)
    assert error < 1e-9
    push, error = _with_way(x, 2.0 * way + 5.0 + NOISE)
    assert error == pytest.approx(1.0 / np.sqrt(N), rel=0.5)
    assert abs(push - 2.0) < 4.0 * error


def at_the_edge(samples: int, times: float, *, by_error: bool) -> Any:
    """A force that pushes by so many times the least that is told."""
    v = SPEED[:samples]
    m = motion_of(v)
    way = np.sign(v)
    x = np.stack([way, np.ones(samples), m.acceleration_m_s2, m.angle_rad], axis=1)
    # A mass swings a force and makes it no less sure.
    mass = 0.0 if by_error else m.acceleration_m_s2 / np.std(m.acceleration_m_s2)
    force = (1.0 if by_error else 0.1) * NOISE[:samples] + mass
    moves = np.abs(v) > 0.02 * np.max(np.abs(v))
    x, force = x[moves], force[moves]
    part = np.arange(len(force)) * 12 // len(force)
    push = np.linalg.lstsq(x, force, rcond=None)[0][0]
    each = [np.linalg.lstsq(x[part != k], force[part != k], rcond=None)[0][0] for k in range(12)]
    error = float(np.std(each)) * np.sqrt(11.0)
    more = 0.0
    for _ in range(60):
        # So much that it pushes by the limit, which the push itself widens.
        limit = max(8.0 * error, 0.3 * float(np.std(force + more * x[:, 0])))
        more = -times * limit - push
    assert (8.0 * error > 0.3 * float(np.std(force + more * x[:, 0]))) == by_error
    whole = np.zeros(samples)
    whole[moves] = force + more * x[:, 0]
    return find_pushing(run_of(whole, v), m, np.ones(samples, dtype=bool))


@pytest.mark.parametrize(("times", "there"), [(0.98, False), (1.02, True)])
def test_the_least_push_that_is_told(times: float, there: bool) -> None:
    """Eight standard errors, or three tenths of the force's own swing, whichever is more."""
    assert (at_the_edge(300, times, by_error=True) != []) == there
    assert (at_the_edge(2000, times, by_error=False) != []) == there
