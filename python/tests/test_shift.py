"""A run compared with its motion at other instants."""

from __future__ import annotations

import numpy as np
import pytest
from jbf.estimation.prepared import Prepared
from late_runs import LASTS_S, campaign, speed


@pytest.fixture(scope="module")
def prepared() -> Prepared:
    return campaign((0.0,)).prepared[0]


@pytest.mark.parametrize(("late_s", "drift"), [(7.3e-3, 0.0), (-31e-3, 0.0), (25e-3, 2e-3)])
def test_a_force_is_compared_with_the_motion_so_long_before(
    prepared: Prepared, late_s: float, drift: float
) -> None:
    t = prepared.run.time_s
    at = t - late_s - drift * (t - 0.5 * LASTS_S)
    inside = (at >= t[0]) & (at <= t[-1])
    assert 1 <= np.sum(~inside) <= 3
    found = prepared.shifted(late_s, drift)
    np.testing.assert_array_equal(found.friction_n, prepared.friction_n[inside])
    np.testing.assert_allclose(found.run.time_s, at[inside], atol=1e-12)
    assert len(found.examined.usable) == len(found.run)
    # The motion at those instants, as it was: 5 um/s are a ten-thousandth of a newton.
    wanted = speed(0, at[inside])
    edge = slice(3, -3)
    np.testing.assert_allclose(found.motion.velocity_m_s[edge], wanted[edge], atol=5e-6)
    known = found.motion.sign_known
    np.testing.assert_array_equal(np.sign(found.motion.velocity_m_s)[known], np.sign(wanted)[known])
    turns = np.count_nonzero(np.diff(np.sign(wanted)))
    assert np.sum(~known) <= 8 * turns + 4


def test_a_shift_and_its_opposite_leave_the_samples_between(prepared: Prepared) -> None:
    back = prepared.shifted(12e-3, 0.0).shifted(-12e-3, 0.0)
    np.testing.assert_allclose(back.run.time_s, prepared.run.time_s[1:], atol=1e-12)
    np.testing.assert_array_equal(back.friction_n, prepared.friction_n[1:])
    np.testing.assert_allclose(
        back.motion.velocity_m_s, prepared.motion.velocity_m_s[1:], atol=1e-12
    )


def test_no_shift_changes_nothing(prepared: Prepared) -> None:
    same = prepared.shifted(0.0, 0.0)
    np.testing.assert_array_equal(same.run.time_s, prepared.run.time_s)
    np.testing.assert_array_equal(same.friction_n, prepared.friction_n)
    np.testing.assert_allclose(
        same.motion.velocity_m_s, prepared.motion.velocity_m_s, rtol=0.0, atol=1e-15
    )


def test_no_shift_leaves_the_known_signs(prepared: Prepared) -> None:
    known = prepared.motion.sign_known
    assert not known.all()
    np.testing.assert_array_equal(prepared.shifted(0.0, 0.0).motion.sign_known, known)
