"""Findings of single channels, each asked directly: sizes, words, and both sides of each
threshold."""

from __future__ import annotations

from dataclasses import replace
from math import erf
from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.findings.digits import last_digit
from jbf.records.findings.glitches import _breakaway, find_glitches, glitches
from jbf.records.findings.held_samples import _by_steps, find_held, held
from jbf.records.findings.saturation import _noise, find_saturation, saturated
from jbf.records.findings.steps import _near_levels, find_steps, step_of
from jbf.records.quantities import ROTARY

N = 2000
TIME: Any = 0.01 * np.arange(N)
NOISE: Any = np.random.default_rng(1).standard_normal(N)
WAVE: Any = 10.0 * np.sin(0.7 * TIME)


def run_of(force: Any, speed: Any = None, **more: Any) -> Run:
    time = TIME[: len(force)]
    velocity = 0.1 * np.sin(0.7 * time + 0.1) if speed is None else speed
    return replace(Run.from_arrays(time, velocity, force, name="a"), **more)


def places(mask: Any) -> list[int]:
    return [int(i) for i in np.flatnonzero(mask)]


@pytest.mark.parametrize(
    ("values", "digit"),
    [
        ([1.25, 3.5, -2.0], 0.01),
        ([120.0, 130.0], 10.0),
        ([100.0, 200.0], 100.0),
        ([0.001, -0.0025], 1e-4),
        ([1.0], 1.0),
        ([0.0, 0.0], 0.0),
        ([99.0, 100.0], 1.0),
        ([1.0, 1.0001], 1e-4),
        ([np.pi, 1.0], 1e-9 * np.pi),
        ([-7e5, 1e5], 1e5),
    ],
)
def test_the_last_digit_that_samples_are_written_with(values: list[float], digit: float) -> None:
    """Up to nine of the largest; beyond that a billionth of it."""
    assert last_digit(np.array(values)) == pytest.approx(digit)


def stuck(*jumps: tuple[int, float], noise: float = 0.1) -> Any:
    values = WAVE + noise * NOISE
    for i, size in jumps:
        values[i] += size
    return values


def test_a_single_sample_that_sticks_out_is_a_glitch() -> None:
    """Up or down, by eight local standard deviations; not two of a row, which have a neighbour."""
    assert places(glitches(stuck((500, 3.0), (900, -3.0)))) == [500, 900]
    assert places(glitches(stuck((500, 3.0), (501, 3.0)))) == []
    assert not glitches(stuck()).any()
    for size, there in ((0.4, False), (2.0, True)):
        assert glitches(stuck((500, size))).any() == there
    # A tenth of the noise elsewhere is quiet here: eight tenths of the usual count as much.
    quiet = WAVE + np.where((TIME > 8.0) & (TIME < 12.0), 0.01, 0.1) * NOISE
    for size, there in ((0.5, False), (0.95, True)):
        told = quiet.copy()
        told[1000] += size
        assert glitches(told).any() == there
    # A steep slope changes as much from sample to sample.
    steep = 100.0 * TIME + 0.01 * NOISE
    for size, there in ((3.7, False), (4.4, True)):
        told = steep.copy()
        told[1000] += size
        assert glitches(told).any() == there
    assert len(glitches(stuck()[:99])) == 99
    assert not glitches(stuck((50, 3.0))[:99]).any()
    assert glitches(stuck((50, 3.0))[:100]).any()
    many = [(20 + 40 * k, 3.0) for k in range(40)]
    assert glitches(stuck(*many)).sum() == 40
    assert not glitches(stuck(*many, (1700, 3.0))).any()
    steady = np.zeros(N)
    steady[500] = 1.0
    assert not glitches(steady).any()


def test_a_peak_where_the_speed_turns_or_rises_is_the_frictions_own() -> None:
    """Within three samples of it; a speed of less than a fiftieth of the top is none."""
    v = np.ones(100)
    v[50:] = -1.0
    assert places(_breakaway(v)) == list(range(47, 53))
    v = np.concatenate((np.zeros(50), np.ones(50)))
    assert places(_breakaway(v)) == list(range(47, 53))
    for slow, there in ((0.019, True), (0.021, False)):
        v = np.concatenate((np.full(50, slow), np.ones(50)))
        assert _breakaway(v).any() == there
    # Within a slow reversal the sign itself turns, too.
    v = np.concatenate((np.ones(20), np.linspace(0.019, -0.019, 40), -np.ones(20)))
    assert places(_breakaway(v)) == [*range(17, 23), *range(37, 43), *range(57, 63)]
    assert not _breakaway(np.ones(100)).any()
    assert places(_breakaway(np.array([1.0, -1.0, -1.0, -1.0, -1.0]))) == [0, 1, 2, 3]


def test_what_is_said_of_glitches() -> None:
    """How many, how far off at most, and where the first three are; none beside a reversal."""
    speed = np.where(TIME < 10.0, 0.1, -0.1)
    force = stuck((200, 3.0), (500, -7.0), (700, 3.0), (900, 3.0), (1001, 9.0))
    told, mask = find_glitches(run_of(force, speed), speed)
    (found,) = told
    assert places(mask) == [200, 500, 700, 900]
    middle = 0.5 * (force[499] + force[501])
    assert found.size == pytest.approx(abs(force[500] - middle))
    assert found.words == (
        f"4 single samples of the force are off by up to {found.size:.3g} N "
        "(at 2.00 s, 5.00 s, 7.00 s)"
    )
    assert (found.kind, found.channel, found.run) == ("glitches", "friction_n", "a")
    assert (found.unit, found.done) == ("N", "set aside")
    (one,), _ = find_glitches(run_of(stuck((200, 3.0)), speed), speed)
    assert one.words.startswith("1 single sample of the force is off by up to")
    assert find_glitches(run_of(stuck(), speed), speed)[0] == []


def test_readings_that_repeat_too_long_for_chance_are_held() -> None:
    """Those after the first; five equal ones where hardly any repeat, more where many do."""
    for count, there in ((4, False), (5, True), (9, True)):
        values = stuck()
        values[301 : 300 + count] = values[300]
        assert places(held(values)) == (list(range(301, 300 + count)) if there else [])
    # Where half of the readings come twice, thirty in a row are chance in two thousand.
    often = np.repeat(NOISE, np.where(np.arange(N) % 2, 1, 2))[:N]
    for count, there in ((30, False), (31, True)):
        values = often.copy()
        values[303 : 302 + count] = values[302]
        assert places(held(values)) == (list(range(303, 302 + count)) if there else [])
    # A force that never changes is one of a law, as far as anybody can tell.
    assert not held(np.full(50, 3.0)).any()
    assert not held(np.arange(50.0)).any()


def test_a_converter_leaves_a_reading_where_it_is_by_chance() -> None:
    """That noise of so many steps stays within half of one."""
    for noise in (0.5, 1.0):
        values = np.round(np.linspace(-50.0, 50.0, N) + noise * NOISE)
        assert _by_steps(values) == pytest.approx(erf(0.5 / noise / np.sqrt(2.0)), rel=0.15)
    assert _by_steps(stuck()) == 0.0
    # Without noise next to all readings stay where they are.
    for step in (1e-6, 1.0, 1e6):
        assert _by_steps(step * np.round(np.linspace(-20.0, 20.0, N))) > 0.99


def test_what_is_said_of_a_force_that_stands_still() -> None:
    """How often, for how long at most, and where first; not what is known to be wrong."""
    force = stuck()
    for first, count in ((300, 6), (800, 21)):
        force[first + 1 : first + count] = force[first]
    run = run_of(force)
    (found,), mask = find_held(run, np.zeros(N, dtype=bool))
    assert mask.sum() == 25
    assert found.size == pytest.approx(0.2)
    assert found.words == "the force stands still 2 times, for up to 0.2 s (first at 3.01 s)"
    assert (found.kind, found.channel, found.unit) == ("held_samples", "friction_n", "s")
    assert (found.run, found.done) == ("a", "set aside")
    known = np.arange(N) > 500
    (one,), mask = find_held(replace(run, quantities=ROTARY), known)
    assert mask.sum() == 5
    assert one.words == "the torque stands still 1 time, for up to 0.05 s (first at 3.01 s)"
    nothing, mask = find_held(run, np.ones(N, dtype=bool))
    assert nothing == []
    assert not mask.any()


def test_readings_come_in_steps_where_their_levels_are_evenly_apart() -> None:
    """Few levels, many samples; some that nobody visited; crumbs of a file's digits."""
    levels = 0.5 * np.round(WAVE / 0.5)
    assert step_of(levels) == pytest.approx(0.5)
    assert step_of(levels[(levels != 2.0) & (levels != -3.0)]) == pytest.approx(0.5)
    assert step_of(levels + 0.01 * np.sin(levels)) == pytest.approx(0.5, rel=0.03)
    assert step_of(WAVE) == 0.0
    assert step_of(np.tile([0.0, 1.0, 2.0], 100)) == 0.0
    assert step_of(np.tile([0.0, 1.0, 2.0, 3.0], 100)) == 1.0
    # A fifth of the samples may be levels.
    assert step_of(np.repeat(np.arange(20.0), 5)) == 1.0
    assert step_of(np.repeat(np.arange(26.0), 4)[:100]) == 0.0
    uneven = np.array([0.0, 1.0, 2.3, 3.1, 4.7, 5.2, 6.6])
    assert step_of(np.tile(uneven, 20)) == 0.0


def test_corners_that_are_nearly_on_a_level_are_on_it() -> None:
    """The middle one of those that are nearer than a thousandth of the smallest step."""
    values = np.tile(np.arange(5.0), 20) + 1e-4 * NOISE[:100]
    assert step_of(values, drawn=True) == pytest.approx(1.0, abs=1e-3)
    assert step_of(values) == 0.0
    # Within 1e-3 of 10 over a fifth of ten samples: 5e-3.
    near = np.array([0.0, 0.004, 0.008, 1.0, 1.006, 5.0, 5.0, 9.0, 9.996, 10.0])
    assert _near_levels(near).tolist() == [0.004, 1.0, 1.006, 5.0, 9.0, 9.996]


def test_steps_are_told_where_they_are_half_of_the_noise_or_more() -> None:
    """In the force's own unit; of the readings that can be used."""
    every = np.ones(N, dtype=bool)
    for step, there in ((0.3, False), (0.7, True)):
        force = step * np.round((WAVE + NOISE) / step)
        assert (find_steps(run_of(force), every) != []) == there
    (found,) = find_steps(run_of(force, quantities=ROTARY), every)
    assert found.words == "the torque comes in steps of 0.7 N m"
    assert (found.kind, found.channel, found.unit) == ("steps", "friction_n", "N m")
    assert found.size == pytest.approx(0.7)
    assert found.done == "counted as noise"
    half = np.where(np.arange(N) < 1000, force, WAVE)
    assert find_steps(run_of(half), every) == []
    assert len(find_steps(run_of(half), np.arange(N) < 1000)) == 1


def clipped(low: float = -np.inf, high: float = np.inf, noise: float = 0.3) -> Any:
    return np.clip(WAVE + noise * NOISE, low, high)


def test_a_force_at_an_end_of_its_range_is_saturated() -> None:
    """Both ends apart, with the seven samples to either side."""
    force = clipped(-8.0, 9.0)
    mask, ends = saturated(force)
    assert ends == [9.0, -8.0]
    at = np.isin(force, ends)
    wide = np.convolve(at, np.ones(15), "same") > 0.0
    np.testing.assert_array_equal(mask, wide)
    assert saturated(clipped(high=9.0))[1] == [9.0]
    assert saturated(clipped(low=-8.0))[1] == [-8.0]
    assert saturated(clipped())[1] == []
    assert not saturated(clipped())[0].any()
    # Five readings at the very end, where noise makes each another.
    for count, there in ((4, False), (5, True)):
        values = clipped(noise=0.3)
        values[100 : 100 + 60 * count : 60] = 20.0
        assert (saturated(values)[1] == [20.0]) == there
    # Of a converter's levels the end must have twice as many as the next three.
    coarse = np.round(clipped())
    assert saturated(coarse)[1] == []
    assert saturated(np.clip(np.round(clipped(noise=1.0)), -8.0, 8.0))[1] == [8.0, -8.0]


def test_the_noise_of_a_force_is_looked_for_where_it_does_not_stand_still() -> None:
    """White noise by its third differences; a curve, corners and a short record have none."""
    assert _noise(WAVE + 0.3 * NOISE) == pytest.approx(0.3, rel=0.1)
    assert _noise(clipped(-5.0, 5.0)) == pytest.approx(0.3, rel=0.15)
    assert _noise(WAVE) == 0.0
    assert _noise(np.sign(WAVE)) == 0.0
    assert _noise((WAVE + 0.3 * NOISE)[:30]) == 0.0
    assert _noise((WAVE + 0.3 * NOISE)[:80]) > 0.0


def test_what_is_said_of_saturation() -> None:
    """The ends from low to high, and the share of readings at them."""
    force = clipped(-8.0, 9.0)
    (found,), mask = find_saturation(run_of(force, quantities=ROTARY))
    share = 100.0 * np.mean((force == -8.0) | (force == 9.0))
    assert found.words == (
        f"the torque stands at the end of its range, -8 N m and 9 N m, in {share:.2g} % of the run"
    )
    assert (found.size, found.unit, found.done) == (9.0, "N m", "set aside")
    assert (found.kind, found.channel, found.run) == ("saturation", "friction_n", "a")
    assert mask.sum() > np.sum(force == 9.0)
    (one,), _ = find_saturation(run_of(clipped(low=-8.0)))
    assert one.size == 8.0
    nothing, mask = find_saturation(run_of(clipped()))
    assert nothing == []
    assert not mask.any()
