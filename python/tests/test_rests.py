"""Where a shaft rests, and what its speed is beside a rest."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf.records.motion.rests import rest_edges, still_samples, unsure_beside_rest, without_swings


def test_the_edges_of_a_rest_are_its_samples_beside_motion() -> None:
    rest = np.array([1, 1, 1, 0, 0, 1, 1, 1, 0, 1], dtype=bool)

    def edges(rest: npt.NDArray[np.bool_], speed: float = 0.0, rate: float = 0.0) -> list[int]:
        n = len(rest)
        v, a = np.where(rest, 0.0, speed), np.where(rest, 0.0, rate)
        return np.flatnonzero(rest_edges(rest, 0.1 * np.arange(n), v, a)).tolist()

    assert edges(rest) == [2, 5, 7, 9]
    # 0.18 s ago by the motion after the rest; the motion before it came from elsewhere.
    assert edges(rest, 0.9, 5.0) == [1, 2, 5, 6, 7, 9]
    assert edges(rest, 0.9, -5.0) == [2, 5, 6, 7, 9]
    assert edges(np.ones(5, dtype=bool)) == []
    assert edges(np.zeros(5, dtype=bool)) == []


def test_a_slow_reversal_is_no_rest() -> None:
    time = np.arange(400) * 5e-3
    rate, step = 0.008, 7e-6
    v = rate * (time - 1.0)
    v[-1] = 0.2
    path = step * np.round(0.5 * rate * (time - 1.0) ** 2 / step)
    assert np.ptp(path[190:211]) <= step
    assert not still_samples(time, path, v, step).any()
    # One that turns back at once is two of them.
    graze = 0.05 * (time - 1.0) ** 2 - 3e-5
    graze[-1] = 0.2
    path = step * np.round((0.05 / 3.0 * (time - 1.0) ** 3 - 3e-5 * (time - 1.0)) / step)
    assert np.ptp(path[188:213]) <= step
    assert not still_samples(time, path, graze, step).any()
    # Nor is a long rest a reversal, where rounding leaves speeds of either sign about it.
    at_rest = np.where(np.abs(time - 1.0) < 0.8, 0.0, 1e-15 * np.sign(time - 1.0))
    at_rest[-1] = 1.0
    assert still_samples(time, np.zeros(400), at_rest, step)[45:355].all()
    # A stop on the way is one, as fast before as after.
    way = np.where(np.abs(time - 1.0) < 0.4, 0.0, 0.01)
    path = step * np.round(np.cumsum(way) * 5e-3 / step)
    way[-1] = 0.2
    assert still_samples(time, path, way, step)[140:260].all()
    # As long a rest between the same speeds is one.
    still = np.where(np.abs(time - 1.0) < 0.4, 0.0, v)
    path = step * np.round(np.cumsum(still) * 5e-3 / step)
    assert still_samples(time, path, still, step)[140:260].all()


@pytest.mark.parametrize(("share", "rests"), [(0.7, False), (1.1, True), (1.3, True)])
def test_a_rest_lasts_twice_as_long_as_a_reversal_seems_to(share: float, rests: bool) -> None:
    """0.14 s on the way from one direction to the other, or 0.23 s, at 8 mm/s^2 and a count of
    7 um: a reversal stays within a count and a half for 0.1 s."""
    time = np.arange(400) * 5e-3
    rate, step = 0.008, 7e-6
    within_s = 2.0 * np.sqrt(2.0 * 1.5 * step / rate)
    assert within_s == pytest.approx(0.1, abs=0.003)
    beyond = np.maximum(np.abs(time - 1.0) - share * within_s, 0.0)
    way = np.sign(time - 1.0)
    v = rate * way * beyond
    v[-1] = 0.2
    path = step * np.round(0.5 * rate * way * beyond**2 / step)
    still = still_samples(time, path, v, step)
    assert still.any() == rests
    if rests:
        np.testing.assert_array_equal(still[100:300], (beyond == 0.0)[100:300])


def test_a_shaft_does_not_go_back_before_it_sets_out() -> None:
    v = np.array([-0.1, 0.0, -0.1, 0.1, 0.5, -0.5, 0.1, -0.2, 0.0, 0.3])
    rest = np.array([0, 1, 0, 0, 0, 0, 0, 0, 1, 0], dtype=bool)
    known = np.array([0, 0, 0, 0, 1, 1, 0, 0, 0, 1], dtype=bool)
    without_swings(rest, v, known)
    # Beside the rests alone, and only what is not sure; no sure sample, no way.
    assert v.tolist() == [-0.1, 0.0, 0.0, 0.1, 0.5, -0.5, 0.0, -0.2, 0.0, 0.3]


def test_the_first_way_from_a_rest_is_the_paths() -> None:
    path = np.array([0.0, 0.0, 0.0, 0.0, -1.0, -2.0, -3.0, -3.0, -3.0])
    speed = np.array([0.0, 0.0, 0.0, 0.4, -0.8, -1.0, -1.0, 0.0, 0.0])
    rest = np.array([1, 1, 1, 0, 0, 0, 0, 1, 1], dtype=bool)
    assert np.flatnonzero(unsure_beside_rest(rest, path, speed, 0.9)).tolist() == [3, 6]
