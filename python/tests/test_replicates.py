"""Where a record shows the same motion again, by motions of known period; and what rests and
repetitions say of the noise, by records put together by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.noise_floor import most_noise, noise_floor
from jbf.estimation.replicates import period_samples
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]


def wave(count: int, period: int) -> Array:
    """A sine with a corner: no half of a period is like another."""
    turn = 2.0 * np.pi * np.arange(count) / period
    found: Array = np.sin(turn) + 0.3 * np.sin(2.0 * turn + 0.5)
    return found


# ---- the period --------------------------------------------------------------------------------


@pytest.mark.parametrize("period", [7, 20, 61, 150])
@pytest.mark.parametrize("level", [0.0, 5.0, -2.0])
def test_the_period_is_found_to_the_sample(period: int, level: float) -> None:
    """Whatever speed the motion is about, and of several turns the first."""
    assert period_samples(level + wave(5 * period + 130, period)) == period


@pytest.mark.parametrize(("count", "found"), [(99, None), (100, 20)])
def test_fewer_than_a_hundred_samples_have_no_period(count: int, found: int | None) -> None:
    assert period_samples(wave(count, 20)) == found


def test_what_never_changes_or_never_turns_has_no_period() -> None:
    assert period_samples(np.zeros(300)) is None
    assert period_samples(np.full(300, -0.7)) is None
    assert period_samples(np.linspace(-1.0, 1.0, 300)) is None
    assert period_samples(np.random.default_rng(1).standard_normal(400)) is None


@pytest.mark.parametrize(("size", "there"), [(0.010, True), (0.018, False)])
def test_a_repetition_is_the_same_within_a_fiftieth(size: float, there: bool) -> None:
    """The difference of two noises has sqrt(2) times the deviation of one; the sine's is 1."""
    sine = np.sqrt(2.0) * np.sin(2.0 * np.pi * np.arange(2000) / 100)
    noise = size * np.random.default_rng(2).standard_normal(2000)
    for unit in (1e-3, 1.0, 1e3):
        assert period_samples(unit * (sine + noise)) == (100 if there else None)


def test_a_period_of_two_unlike_strokes_is_both_of_them() -> None:
    """Where every second stroke is less high the motion comes again after two."""
    stroke = np.sin(2.0 * np.pi * np.arange(40) / 40)
    assert period_samples(np.tile(np.concatenate((stroke, 0.5 * stroke)), 8)) == 80
    # Even where the first is nearly as good: 0.976 of the second in their correlation.
    assert period_samples(np.tile(np.concatenate((stroke, 0.8 * stroke)), 8)) == 80
    # Next to no difference is none: the first repetition is as good as any.
    assert period_samples(np.tile(np.concatenate((stroke, 0.995 * stroke)), 8)) == 40


def test_a_motion_that_comes_again_but_once_has_a_period() -> None:
    """In three quarters of a record there must be room for it."""
    assert period_samples(wave(300, 150)) == 150
    assert period_samples(wave(300, 240)) is None


# ---- the noise ---------------------------------------------------------------------------------


def record(force: Array, *, rests: Array | None = None, speed: Array | None = None) -> Any:
    """What the noise is told of: a run's readings, and its motion."""
    n = len(force)
    resting = np.zeros(n, dtype=bool) if rests is None else rests.astype(bool)
    velocity = np.linspace(0.1, 0.2, n) if speed is None else speed
    motion = SimpleNamespace(resting=resting, velocity_m_s=velocity)
    return SimpleNamespace(friction_n=force, motion=motion, converter_step_n=0.0)


def of(*records: Any, counted: list[npt.NDArray[Any]] | None = None) -> tuple[list[Any], Samples]:
    """Records, and samples that all count where nothing else is said."""
    masks = tuple(
        np.ones(len(r.friction_n), dtype=bool) if counted is None else counted[i].astype(bool)
        for i, r in enumerate(records)
    )
    names = tuple(f"{i}" for i in range(len(records)))
    weight = tuple(m.astype(float) for m in masks)
    return list(records), Samples(names, (0.02,) * len(records), masks, weight)


def waves(n: int, size: float) -> Array:
    """Of ten samples each, slow enough for third differences to see little of; RMS so large."""
    found: Array = size * np.sqrt(2.0) * np.sin(2.0 * np.pi * np.arange(n) / 10.0)
    return found


@pytest.mark.parametrize(
    ("length", "known"), [(397, False), (398, False), (399, True), (400, True)]
)
def test_a_rest_tells_the_noise_after_its_first_quarter(length: int, known: bool) -> None:
    """Three hundred samples are needed; what moves along a line is no noise, and the first quarter
    may do anything."""
    n = length + 100
    force = waves(n, 0.5) + 0.01 * np.arange(n) + 3.0
    rests = np.zeros(n)
    rests[60 : 60 + length] = 1.0
    force[60 : 60 + length // 4] += 50.0 * np.sin(np.arange(length // 4))
    found = most_noise(*of(record(force, rests=rests)))
    # Thirty waves about a line, whose two parameters are taken off.
    assert found == (pytest.approx(0.5 * np.sqrt(300.0 / 298.0), rel=0.01) if known else None)


@pytest.mark.parametrize(("length", "known"), [(78, False), (79, True)])
def test_short_rests_tell_nothing(length: int, known: bool) -> None:
    """Of 79 samples a quarter, 19, is left out, and 60 stay; of 78 only 59."""
    rests = np.tile(np.concatenate((np.ones(length), np.zeros(10))), 6)
    slow = waves(len(rests), 0.5)
    found = most_noise(*of(record(slow, rests=rests)))
    assert (found is not None) == known
    if known:
        # About its own line a rest of six waves has nearly the wave's whole variance.
        assert found == pytest.approx(0.5 * np.sqrt(60.0 / 58.0), rel=0.02)


def test_rests_at_both_ends_of_a_record_count() -> None:
    """Of 200 samples each 150 stay: together they are just enough, at either end."""
    rests = np.concatenate((np.ones(200), np.zeros(50), np.ones(200)))
    slow = waves(450, 0.5)
    assert most_noise(*of(record(slow, rests=rests))) == pytest.approx(0.5, rel=0.02)
    rests[:8] = 0.0
    assert most_noise(*of(record(slow, rests=rests))) is None


@pytest.mark.parametrize(("slow", "taken"), [(0.1, False), (1.0, True), (6.0, False)])
def test_colour_seen_at_rest_is_the_floor_where_it_is_clear_but_not_wild(
    slow: float, taken: bool
) -> None:
    """White noise of 1 N, and a slow wave of so many newtons RMS beside it: less than 4 % more is
    nothing, three times as much is no noise."""
    n = 8000
    white = np.random.default_rng(3).standard_normal(n)
    wavy = slow * np.sqrt(2.0) * np.sin(2.0 * np.pi * np.arange(n) / 200.0)
    whole = np.sqrt(1.0 + slow**2)
    for unit in (0.1, 1.0, 20.0):
        given = of(record(unit * (white + wavy), rests=np.ones(n)))
        assert noise_floor(*given) == pytest.approx(unit * (whole if taken else 1.0), rel=0.04)
        assert most_noise(*given) == pytest.approx(unit * whole, rel=0.04)


def test_what_comes_again_a_period_later_is_no_noise() -> None:
    """The difference of two periods is the noise's, twice; a drift from one to the next is not."""
    n, period = 6000, 200
    speed = wave(n, period)
    random = np.random.default_rng(4)
    force = 30.0 * speed**2 + 0.002 * np.arange(n) + 0.4 * random.standard_normal(n)
    given = of(record(force, speed=speed))
    assert most_noise(*given) == pytest.approx(0.4, rel=0.06)
    # Colour that third differences do not see, a period shows.
    slow = np.repeat(random.standard_normal(n // 10), 10)
    given = of(record(force + 0.4 * slow, speed=speed))
    assert most_noise(*given) == pytest.approx(0.4 * np.sqrt(2.0), rel=0.15)


def test_only_pairs_that_both_count_tell_a_repetition() -> None:
    n, period = 6000, 200
    speed = wave(n, period)
    force = 0.4 * np.random.default_rng(5).standard_normal(n)
    bad = np.arange(n) % (2 * period) < 90
    wild = np.where(bad, 1e3 * np.sin(np.arange(n) ** 2), force)
    given = of(record(wild, speed=speed), counted=[~bad])
    assert most_noise(*given) == pytest.approx(0.4, rel=0.1)
    # Of a hundred pairs and less nothing is known.
    few = of(record(force, speed=speed), counted=[np.arange(n) < 2 * period])
    assert most_noise(*few) is None


def test_the_floor_of_runs_is_the_mean_square_over_samples_that_count() -> None:
    random = np.random.default_rng(6)
    one, two = 1.0 * random.standard_normal(9000), 3.0 * random.standard_normal(9000)
    half = np.arange(9000) < 3000
    given = of(record(one), record(two), counted=[np.ones(9000), half])
    assert noise_floor(*given) == pytest.approx(np.sqrt((3.0 + 9.0) / 4.0), rel=0.07)


def test_a_converters_steps_leave_a_twelfth_of_their_square() -> None:
    """Of readings that never change the floor is what rounding may hide."""
    steady = record(np.zeros(4000))
    steady.converter_step_n = 0.6
    assert noise_floor(*of(steady)) == pytest.approx(0.6 / np.sqrt(12.0), rel=1e-9)
    # Of noise that is larger than the steps, the noise and what they add.
    noisy = record(0.6 * np.round(np.random.default_rng(7).standard_normal(9000) / 0.6))
    noisy.converter_step_n = 0.6
    assert noise_floor(*of(noisy)) == pytest.approx(np.sqrt(1.0 + 0.03), rel=0.04)


@pytest.mark.parametrize("step", [0.6, 5.0])
def test_noise_of_a_third_of_a_step_is_seen_in_what_is_rounded(step: float) -> None:
    """Beyond half a step go 15.3 % of the samples, each by a step: so large is the variance."""
    n = 12000
    coarse = step * np.round(0.35 * np.random.default_rng(8).standard_normal(n))
    assert np.mean(coarse != 0.0) == pytest.approx(0.153, abs=0.01)
    seen = record(coarse)
    seen.converter_step_n = step
    assert noise_floor(*of(seen)) == pytest.approx(step * np.sqrt(0.153), rel=0.15)
    again = record(coarse, speed=wave(n, 200))
    again.converter_step_n = step
    assert most_noise(*of(again)) == pytest.approx(step * np.sqrt(0.153), rel=0.15)
