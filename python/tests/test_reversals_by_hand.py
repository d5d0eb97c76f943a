"""What the instant of a reversal costs a late reading: one reversal after the other, by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.reversals import _reversals, instant_errors_n
from made_of import record

Array = npt.NDArray[np.float64]
STEP_S = 0.1


def run(velocity: list[float], *, error: float = 1e-3, unknown: tuple[int, ...] = ()) -> Any:
    """A motion at these speeds, each known to an error; at rest where the speed is nothing."""
    v = np.array(velocity)
    p = record(STEP_S * np.arange(len(v)), velocity=v, resting=v == 0.0)
    known = ~p.motion.resting
    known[list(unknown)] = False
    p.motion.sign_known = known
    p.motion.velocity_error_m_s = np.full(len(v), error)
    return p


# ---- reversals ---------------------------------------------------------------------------------


def test_a_reversal_lies_between_two_signs_that_are_known() -> None:
    assert _reversals(run([1.0, 1.0, -1.0, -1.0, 1.0])) == ([1, 3], [2, 4])
    # Samples whose sign nobody knows lie between.
    assert _reversals(run([1.0, 0.1, -0.1, -1.0, -1.0], unknown=(1, 2))) == ([0], [3])
    # A rest between is none, nor is a motion that goes on.
    assert _reversals(run([1.0, 0.0, -1.0, -1.0, 1.0])) == ([3], [4])
    assert _reversals(run([0.0, 1.0, 1.0, 2.0])) == ([], [])
    assert _reversals(run([1.0, 0.0, 0.0, 1.0, -1.0, 0.0])) == ([3], [4])


# ---- what they cost ----------------------------------------------------------------------------


def reading(n: int, turn: int, rate_n_s: float, memory: int) -> Array:
    """A prediction that moves by so much a second for some samples behind a reversal."""
    slope = np.zeros(n)
    slope[turn : turn + memory] = rate_n_s
    found: Array = np.concatenate(([0.0], np.cumsum(slope[:-1] * STEP_S)))
    return found


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_the_error_of_the_instant_moves_the_reading(unit: float) -> None:
    """An error of 2 mm/s at 2 m/s^2 is 1 ms; of a reading that moves by 50 N/s, 0.05 N, until it
    is less than what matters."""
    v = [0.2] * 4 + [-0.2] * 12
    v[3], v[4] = 0.1, -0.1
    p = run(v, error=2e-3)
    rate = np.abs(np.gradient(unit * reading(16, 3, 50.0, 6), p.run.time_s))
    found = instant_errors_n(p, unit * reading(16, 3, 50.0, 6), 0.02 * unit)
    assert found[:4].tolist() == [0.0] * 4
    assert found[4:9] == pytest.approx(1e-3 * rate[4:9])
    assert found[5] == pytest.approx(0.05 * unit)
    # At the ninth the rate has sunk to a half, at the tenth to nothing.
    assert found[9] == pytest.approx(0.025 * unit)
    assert found[10:].tolist() == [0.0] * 6
    less = instant_errors_n(p, unit * reading(16, 3, 50.0, 6), 0.03 * unit)
    assert less[9] == 0.0
    assert less[8] > 0.0


def test_the_instant_lies_between_the_two_samples() -> None:
    """However unsure the speed: as anywhere in between, 0.29 of their distance."""
    v = [0.2] * 4 + [-0.2] * 8
    p = run(v, error=1e3)
    found = instant_errors_n(p, reading(12, 3, 10.0, 9), 1e-9)
    assert found[5] == pytest.approx(0.29 * STEP_S * 10.0)
    # Of samples of unknown sign between, in all of their time, and by the largest error there.
    wide = run([0.2, 0.2, 0.1, -0.1, -0.2, -0.2, -0.2, -0.2], unknown=(2, 3))
    wide.motion.velocity_error_m_s = np.array([9.0, 1e-3, 5e-3, 1e-3, 2e-3, 9.0, 9.0, 9.0])
    steady = 10.0 * wide.run.time_s
    found = instant_errors_n(wide, steady, 1e-9)
    error_s = 5e-3 / (0.4 / 0.3)
    assert found[2:] == pytest.approx(np.full(6, 10.0 * error_s))
    assert found[:2].tolist() == [0.0, 0.0]


def test_each_reversal_costs_until_the_next_one() -> None:
    """Of the second the speed is known ten times as well."""
    p = run([0.2] * 3 + [-0.2] * 4 + [0.2] * 4)
    p.motion.velocity_error_m_s[6:] = 1e-4
    steady = 20.0 * p.run.time_s
    found = instant_errors_n(p, steady, 1e-9)
    first, second = 1e-3 / 4.0 * 20.0, 1e-4 / 4.0 * 20.0
    assert found == pytest.approx([0.0] * 3 + [first] * 4 + [second] * 4)
    # It dies away from where the sign is known again, and not before.
    p = run([0.2] * 3 + [-0.2] * 8)
    flat = np.where(np.arange(11) < 6, 0.0, steady - steady[6])
    assert not instant_errors_n(p, flat, 1e-9).any()


def test_of_fewer_than_three_samples_nothing_is_told() -> None:
    assert instant_errors_n(run([0.2, -0.2]), np.array([1.0, -1.0]), 0.0).tolist() == [0.0, 0.0]
    assert instant_errors_n(run([0.2, -0.2, -0.2]), np.array([1.0, -1.0, -1.0]), 1e-9).any()
