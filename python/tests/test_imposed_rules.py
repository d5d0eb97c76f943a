"""Which samples have a known sign, where rests lie, and angles that wrap: on motions known."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Model, Rig, Run
from jbf.records.motion import imposed
from jbf.records.motion.imposed import impose
from jbf.records.motion.rests import backward_beside_rest

Array = npt.NDArray[np.float64]
RADIUS_M = 0.0127
STEP_RAD = 1.0 / 2387.3


def test_a_sign_is_known_four_standard_errors_from_zero() -> None:
    # A speed that swings so slowly that it lies within its errors for many samples.
    t = np.arange(0.0, 60.0, 0.02)
    slope = 0.002
    v = slope * (np.mod(t, 20.0) - 10.0) * np.where(np.mod(t, 40.0) < 20.0, 1.0, -1.0)
    shares = []
    for seed in range(4):
        noisy = v + np.random.default_rng(seed).normal(0.0, 1e-3, len(t))
        m = impose(Run.from_arrays(t, noisy), None)
        error = float(np.median(m.velocity_error_m_s))
        # Three crossings, each within four errors on both sides.
        inside = 3 * 8.0 * error / (slope * 0.02)
        assert inside > 100
        shares.append(np.count_nonzero(~m.sign_known) / inside)
        known = m.sign_known
        assert np.all(np.sign(m.velocity_m_s[known]) == np.sign(v[known]))
    assert np.mean(shares) == pytest.approx(1.0, abs=0.2)


def test_rests_are_placed_between_the_steps_of_the_encoder() -> None:
    # Strokes of an odd number of encoder steps: each rest lies elsewhere between two of them.
    t = np.arange(0.0, 80.0, 0.02)
    phase, which = np.mod(t, 4.0), (t // 4.0).astype(int)
    way = np.where(which % 2 == 0, 1.0, -1.0) * (1.0 + 0.0137 * which)
    v = 0.005 * way * np.clip(np.minimum(phase, 2.0 - phase), 0.0, 0.5) * (phase < 2.0)
    path = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 0.02)))
    rounded = np.round(path / RADIUS_M / STEP_RAD) * STEP_RAD
    speed = np.where(v == 0.0, 0.0, v + np.random.default_rng(5).normal(0.0, 1e-5, len(t)))
    m = impose(Run.from_arrays(t, speed, angle_rad=rounded), RADIUS_M)
    deep = [np.flatnonzero((which == k) & (phase > 3.0)) for k in range(20)]
    assert all(m.resting[index].all() for index in deep)

    def off_by(angle: Array) -> float:
        """Root mean square over the rests, in steps."""
        off = [float(np.mean(angle[i] - path[i] / RADIUS_M)) / STEP_RAD for i in deep]
        return float(np.sqrt(np.mean(np.square(off))))

    # Rounded, a rest is off by any part of half a step: 0.29 steps.
    assert off_by(rounded) == pytest.approx(0.29, abs=0.03)
    assert off_by(m.angle_rad) < 0.15


def test_an_angle_that_wraps_is_the_angle_that_does_not() -> None:
    turn = 2.0 * np.pi
    t = np.arange(0.0, 20.0, 0.02)
    v = 0.1 + 0.05 * np.sin(t)
    angle = (0.1 * t + 0.05 * (1.0 - np.cos(t))) / RADIUS_M
    assert angle[-1] > 10.0 * turn
    whole = Run.from_arrays(t, v, angle_rad=angle)
    wraps = Run.from_arrays(t, v, angle_rad=np.mod(angle + 1.0, turn) - 1.0)
    for radius_m in (RADIUS_M, None):
        a, b = impose(whole, radius_m), impose(wraps, radius_m)
        np.testing.assert_allclose(b.velocity_m_s, a.velocity_m_s, atol=1e-9)
        np.testing.assert_allclose(b.angle_rad, a.angle_rad, atol=1e-6)
        assert b.sign_known.all()
    ripple = Model(Rig.thesis(), effects=["position_ripple"], parameters={"position_ripple.a": 0.2})
    np.testing.assert_allclose(ripple.predict(wraps), ripple.predict(whole), atol=1e-6)


def test_what_sets_out_does_not_slow_down() -> None:
    rest = np.array([1, 1, 0, 0, 0, 0, 0, 0, 1, 1], dtype=bool)
    t = 0.02 * np.arange(10)
    # A polynomial swings by a tenth of a sample's worth where the shaft starts, and stops.
    v = np.array([0.0, 0.0, 2e-4, -2e-3, -4e-3, -4e-3, -2e-3, 1e-4, 0.0, 0.0])
    a = np.array([0.0, 0.0, -0.1, -0.1, -0.1, 0.1, 0.1, 0.1, 0.0, 0.0])
    swings = [2, 7]
    assert np.flatnonzero(backward_beside_rest(rest, t, v, a)).tolist() == swings
    # The other way round it is the same, and no rest has none.
    assert np.flatnonzero(backward_beside_rest(rest, t, -v, -a)).tolist() == swings
    assert not backward_beside_rest(np.zeros(10, dtype=bool), t, v, a).any()
    # A speed that is there at once, held with noise on its slope, sets out in any case.
    held = np.where(rest, 0.0, 0.1)
    assert not backward_beside_rest(rest, t, held, np.where(rest, 0.0, -0.1)).any()


def test_an_imposed_motion_has_no_sign_where_it_goes_backward(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    t = np.arange(0.0, 6.0, 0.01)
    v = 0.1 * np.clip(t - 2.0, 0.0, 1.0)
    run = Run.from_arrays(t, v)
    assert impose(run, None).sign_known[210]
    monkeypatch.setattr(imposed, "backward_beside_rest", lambda rest, *_: np.arange(600) == 210)
    assert not impose(run, None).sign_known[210]
