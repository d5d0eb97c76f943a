"""Samples that were filled in, slow thermometers, and what is said of a run's readings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Run
from jbf.records.findings.examine import examine, examine_readings
from jbf.records.findings.filled_in import find_filled_in
from jbf.records.findings.interpolated import Native
from jbf.records.findings.slow_temperature import (
    _averaged,
    _steady,
    _through_jumps,
    find_slow_temperature,
    recorded_temperature,
)
from jbf.records.quantities import ROTARY

N = 600
TIME: Any = 0.02 * np.arange(N)
NOISE: Any = np.random.default_rng(1).standard_normal(4 * N)
FORCE: Any = 20.0 * np.tanh(50.0 * np.sin(0.3 * TIME)) + 0.3 * NOISE[:N]


def filled(lost: Any) -> Any:
    return np.interp(TIME, TIME[~lost], FORCE[~lost])


@pytest.mark.parametrize(("count", "there"), [(9, False), (11, False), (14, True)])
def test_samples_on_a_line_were_filled_in_where_chance_puts_none(count: int, there: bool) -> None:
    """Ten, and a fiftieth of all, at least."""
    lost = np.zeros(N, dtype=bool)
    lost[20 : 20 + 40 * count : 40] = True
    found = find_filled_in(TIME, filled(lost))
    assert (found is not None) == there
    if found is not None:
        np.testing.assert_array_equal(found.time_s, TIME[~lost])
        np.testing.assert_array_equal(found.values, FORCE[~lost])
        assert found.period_s == pytest.approx(0.02)


def test_samples_that_lie_on_a_line_for_another_reason_stay() -> None:
    """Equal ones, those of coarse digits, lines and curves of the friction itself, few samples."""
    lost = np.arange(N) % 3 == 1
    assert find_filled_in(TIME, filled(lost)) is not None
    assert find_filled_in(TIME[:4], filled(lost)[:4]) is None
    assert find_filled_in(TIME, np.repeat(NOISE, 3)[:N]) is None
    for digits, there in ((1, False), (4, True)):
        assert (find_filled_in(TIME, np.round(filled(lost), digits)) is not None) == there
    half = np.arange(N) % 2 == 1
    for values, there in ((FORCE, True), (np.sin(0.3 * TIME), False)):
        along = np.interp(TIME, TIME[~half], values[~half])
        assert (find_filled_in(TIME, along) is not None) == there
    for own in (FORCE, np.zeros(N), np.ones(N), TIME):
        assert find_filled_in(TIME, own) is None
    uneven = np.sort(np.random.default_rng(5).uniform(0.0, 12.0, N))
    along = np.interp(uneven, uneven[~lost], FORCE[~lost])
    found = find_filled_in(uneven, along)
    assert found is not None
    assert np.isin(found.time_s, uneven[~lost]).all()


def test_a_staircase_is_drawn_through_the_middles_of_its_jumps() -> None:
    """And held so long as its steps last; what jumps at most samples is none."""
    time = np.arange(8.0)
    celsius = np.array([20.0, 20.0, 20.0, 22.0, 22.0, 22.0, 24.0, 24.0])
    through, held_s = _through_jumps(time, celsius)
    np.testing.assert_allclose(through, np.interp(time, [0, 2.5, 5.5, 7], [20, 21, 23, 24]))
    assert held_s == pytest.approx(2.5)
    for values in (celsius[:3], time, np.array([20.0, 21.0, 21.0, 22.0])):
        same, none = _through_jumps(np.arange(float(len(values))), values)
        np.testing.assert_array_equal(same, values)
        assert none == 0.0
    half = np.array([20.0, 20.0, 21.0, 21.0, 22.0])
    assert _through_jumps(np.arange(5.0), half)[1] > 0.0


def test_a_noisy_temperature_is_its_mean_over_two_seconds() -> None:
    """Symmetric to the ends, so that a steady rise stays what it is; at them the sample itself."""
    time: Any = 0.1 * np.arange(100)
    np.testing.assert_allclose(_averaged(time, 20.0 + 3.0 * time), 20.0 + 3.0 * time)
    square = np.where(time < 5.0, 0.0, 1.0)
    mean = _averaged(time, square)
    assert mean[50] == pytest.approx(0.525)
    assert mean[39] == 0.0
    assert mean[45] == pytest.approx(0.275)
    assert mean[61] == pytest.approx(1.0)
    assert (mean[0], mean[-1]) == (square[0], square[-1])
    for noise, told in ((0.08, False), (0.13, True)):
        celsius = 20.0 + noise * NOISE[:1000]
        clock: Any = 0.1 * np.arange(1000)
        steady, held_s, noise_k = _steady(clock, celsius)
        assert held_s == 0.0
        assert (noise_k > 0.0) == told
        assert (np.std(steady) < 0.5 * noise) == told


def test_what_is_said_of_a_thermometer() -> None:
    """How long it is held, how noisy it is; nothing of one that is quick and quiet, or of none."""
    time: Any = 0.1 * np.arange(2000)
    run = Run.from_arrays(time, np.ones(2000), temperature_c=20.0 + 0.01 * time, name="a")
    assert find_slow_temperature(run) == []
    np.testing.assert_array_equal(recorded_temperature(run), run.temperature_c)
    held = replace(run, temperature_c=20.0 + np.floor(time / 4.0) * 0.5)
    (found,) = find_slow_temperature(held)
    assert found.words == "the temperature stands still for 4 s and jumps to its next reading"
    assert (found.kind, found.channel, found.unit) == ("held_samples", "temperature_c", "s")
    assert found.size == pytest.approx(4.0)
    assert (found.run, found.done) == ("a", "straight lines through the jumps")
    noisy = replace(run, temperature_c=20.0 + 0.5 * NOISE[:2000])
    (found,) = find_slow_temperature(noisy)
    assert found.words == f"the temperature has noise of {found.size:.2g} K"
    assert (found.kind, found.channel, found.unit) == ("noisy_temperature", "temperature_c", "K")
    assert found.size == pytest.approx(0.5, rel=0.1)
    assert (found.run, found.done) == ("a", "averaged over 2 s")
    bare = replace(run, temperature_c=None)
    assert find_slow_temperature(bare) == []
    assert recorded_temperature(bare) is None


def examined(force: Any, time: Any = TIME) -> Any:
    speed = 0.1 * np.sin(0.3 * time)
    return examine(replace(Run.from_arrays(time, speed, force, name="a"), quantities=ROTARY))


def test_readings_are_told_by_how_they_came() -> None:
    """Drawn, repeated, filled in: each with its rate or its share, and the readings themselves."""
    ticks = 0.013 + 0.057 * np.arange(-1, 215)
    read = 3.0 + 5.0 * np.sin(0.9 * ticks) + 0.4 * NOISE[: len(ticks)]
    found = examined(np.interp(TIME, ticks, read))
    (told,) = found.findings
    assert told.words == (
        f"the torque was read at {told.size:.4g} Hz and drawn as straight lines between"
    )
    assert told.size == pytest.approx(1.0 / 0.057, rel=1e-3)
    assert (told.kind, told.unit) == ("interpolated", "Hz")
    assert told.done == "taken back to its readings"
    assert found.native.period_s == pytest.approx(0.057, rel=1e-3)
    assert found.usable.all()
    last = np.floor(0.4 + np.arange(N) / 2.7).astype(int)
    (told,) = examined(20.0 * NOISE[last]).findings
    assert told.words == (
        f"the torque was read at {told.size:.4g} Hz and repeated until the next reading"
    )
    assert (told.kind, told.unit) == ("held_samples", "Hz")
    assert told.done == "taken back to its readings"
    assert told.size == pytest.approx(1.0 / 0.054, rel=1e-3)
    lost = np.arange(N) % 3 == 1
    lost[400:] = False
    found = examined(filled(lost))
    (told,) = found.findings
    assert isinstance(found.native, Native)
    assert told.size == pytest.approx(100.0 * lost.mean())
    assert told.words == (
        f"{told.size:.2g} % of the samples of the torque lie on the straight line between their "
        "neighbours: they were filled in, not read"
    )
    assert (told.kind, told.unit, told.done) == ("interpolated", "%", "left out")
    assert (told.channel, told.run) == ("friction_n", "a")


def test_single_readings_that_are_wrong_are_not_usable() -> None:
    """A glitch, an end of the range, one that is held; a run without a force is all usable."""
    force = FORCE.copy()
    force[300] += 20.0
    of_readings = examine_readings(Run.from_arrays(TIME, 0.1 * np.sin(0.3 * TIME), force),
                                   0.1 * np.sin(0.3 * TIME))  # fmt: skip
    assert [f.kind for f in of_readings.findings] == ["glitches"]
    assert np.flatnonzero(~of_readings.usable).tolist() == [300]
    force[101:110] = force[100]
    found = examined(force)
    assert [f.kind for f in found.findings] == ["glitches", "held_samples"]
    assert np.flatnonzero(~found.usable).tolist() == [*range(101, 110), 300]
    assert found.native is None
    assert examine(Run.from_arrays(TIME, 0.1 * np.sin(0.3 * TIME))).usable.sum() == N
