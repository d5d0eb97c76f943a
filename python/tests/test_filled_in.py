"""Samples that an export or a logger put on the straight line between two readings."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Run
from jbf.records.findings.examine import examine
from jbf.records.findings.filled_in import find_filled_in
from scipy.signal import butter, filtfilt

Array = npt.NDArray[np.float64]
TIME = 0.02 * np.arange(3000)


def force(time: Array, seed: int, sd: float = 0.3) -> Array:
    """Friction to and fro with noise of its own at each instant, N."""
    noise = sd * np.random.default_rng(seed).standard_normal(len(time))
    return 20.0 * np.tanh(50.0 * np.sin(0.3 * time)) + noise


@pytest.mark.parametrize("digits", [4, 12])
@pytest.mark.parametrize("pattern", [[2, 3], [3, 1, 4], [2]])
def test_readings_at_uneven_rows_are_all_that_stays(pattern: list[int], digits: int) -> None:
    read = np.cumsum(np.tile(pattern, 2000))
    read = np.concatenate(([0], read[read < len(TIME) - 1], [len(TIME) - 1]))
    values = np.round(force(TIME[read], 1), 4)
    native = find_filled_in(TIME, np.round(np.interp(TIME, TIME[read], values), digits))
    assert native is not None
    # A reading may happen to lie on a line of its own.
    assert len(native.time_s) > 0.985 * len(read)
    assert np.isin(native.time_s, TIME[read]).all()
    assert native.period_s == pytest.approx(0.02 * np.median(np.diff(read)))


@pytest.mark.parametrize("seed", range(3))
def test_the_union_of_two_clocks(seed: int) -> None:
    """An export onto all instants of both channels, each interpolated to the other's."""
    random = np.random.default_rng(seed)
    ticks = np.cumsum(random.uniform(0.04, 0.06, 1000))
    both = np.unique(np.concatenate([TIME[(ticks[0] < TIME) & (ticks[-1] > TIME)], ticks]))
    native = find_filled_in(both, np.interp(both, ticks, force(ticks, seed)))
    assert native is not None
    assert np.isin(native.time_s, ticks).mean() > 0.999


def test_lost_samples_that_were_filled_in() -> None:
    lost = np.random.default_rng(3).random(len(TIME)) < 0.05
    lost[[0, -1]] = False
    y = force(TIME, 3)
    native = find_filled_in(TIME, np.interp(TIME, TIME[~lost], y[~lost]))
    assert native is not None
    assert not np.isin(TIME[lost], native.time_s).any()


@pytest.mark.parametrize(("share", "is_found"), [(0.005, False), (0.04, True)])
def test_a_few_that_were_filled_in_are_no_channel_of_its_own(share: float, is_found: bool) -> None:
    lost = np.zeros(len(TIME), dtype=bool)
    lost[5 : -5 : round(1.0 / share)] = True
    y = force(TIME, 3)
    native = find_filled_in(TIME, np.interp(TIME, TIME[~lost], y[~lost]))
    assert (native is not None) == is_found


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("step_n", [0.0, 1e-4, 0.0137, 0.1, 0.31, 1.7])
def test_steps_of_a_converter_are_no_lines(step_n: float, seed: int) -> None:
    for y in (force(TIME, seed), 0.3 * TIME + force(TIME, seed, 0.1)):
        for digits in (3, 4, 6, 15):
            value = np.round(y / step_n) * step_n if step_n else y
            assert find_filled_in(TIME, np.round(value, digits)) is None


@pytest.mark.parametrize("omega", [0.02, 0.3, 3.0])
def test_smooth_straight_and_filtered_records_are_friction(omega: float) -> None:
    smooth = 20.0 * np.tanh(5.0 * np.sin(omega * TIME))
    triangle = np.abs(np.mod(omega * TIME, 2.0) - 1.0)
    random = np.random.default_rng(5)
    noise = 0.3 * random.standard_normal(len(TIME))
    low = filtfilt(*butter(4, 0.2), 20.0 * np.sign(np.sin(omega * TIME)) + noise)
    held = np.repeat(noise[::3], 3)
    for y in (smooth, triangle, np.sign(triangle - 0.5), low, held, np.zeros(len(TIME))):
        assert find_filled_in(TIME, y) is None
        assert find_filled_in(TIME, np.round(y, 4)) is None


def test_what_is_said() -> None:
    lost = np.arange(len(TIME)) % 5 == 2
    y = np.interp(TIME, TIME[~lost], force(TIME, 6)[~lost])
    run = Run.from_arrays(TIME, 0.1 * np.sin(0.3 * TIME), y, name="slow")
    found = examine(run)
    (finding,) = found.findings
    assert finding.kind == "interpolated"
    assert "20 % of the samples" in finding.words
    assert found.native is not None
    assert len(found.native.time_s) == 2400
