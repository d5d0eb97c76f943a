"""Sizes of a campaign and where a fit starts from them: motions and forces of round numbers."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import Array
from jbf import InputError, Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.scales import moving_samples, scales
from jbf.estimation.starts import LINEAR_RULES, RULES
from made_of import SIZES

STEP_S = 0.01


def swinging(force: float = 5.0, viscous: float = 20.0, top: float = 0.1) -> Run:
    """A sine of one turn in 4 s: strokes of 2 s, each `top` times 4 / pi long."""
    t = np.arange(0.0, 40.0, STEP_S)
    v = top * np.sin(0.5 * np.pi * t)
    return Run.from_arrays(t, v, force * np.sign(v) + viscous * v, name="sine")


def of(*runs: Run) -> Campaign:
    return Campaign.prepare(Rig(), list(runs))


@pytest.mark.parametrize("top", [0.01, 1.0])
@pytest.mark.parametrize("force", [0.5, 50.0])
def test_friction_is_read_off_a_line_through_slow_and_fast(top: float, force: float) -> None:
    """Of a straight line both halves tell the same: its height and its slope."""
    viscous = force / top
    found = scales(of(swinging(force, viscous, top)))
    assert found.kinetic_n == pytest.approx(force, rel=0.02)
    assert found.viscous_n_s_m == pytest.approx(viscous, rel=0.02)
    # Of a sine's size the median is sin(pi / 4), a tenth lies below sin(pi / 20).
    assert found.usual_m_s == pytest.approx(top * np.sin(0.25 * np.pi), rel=0.03)
    assert found.slow_m_s == pytest.approx(top * np.sin(0.05 * np.pi), rel=0.15)
    assert found.whole_n == pytest.approx(force + viscous * found.usual_m_s, rel=0.02)
    # Nine tenths of the slow half's friction: nearly all of a line that rises.
    slow = top * np.sin(0.9 * 0.25 * np.pi)
    assert found.breakaway_n == pytest.approx(force + viscous * slow, rel=0.02)
    assert found.stroke_m == pytest.approx(top * 4.0 / np.pi, rel=0.02)
    # A tenth of the slow speed's way from sample to sample.
    assert found.resolved_m == pytest.approx(0.1 * found.slow_m_s * STEP_S, rel=1e-6)


def test_friction_that_falls_has_no_viscous_part() -> None:
    found = scales(of(swinging(5.0, -10.0)))
    assert found.viscous_n_s_m == 0.0
    assert found.kinetic_n == pytest.approx(5.0 - 10.0 * 0.1 * np.sin(np.pi / 8.0), rel=0.02)
    assert found.breakaway_n >= 1.1 * found.kinetic_n


def test_of_one_speed_no_slope_is_told() -> None:
    t = np.arange(0.0, 20.0, STEP_S)
    v = np.full(len(t), 0.1)
    found = scales(of(Run.from_arrays(t, v, 5.0 + 0.1 * np.sin(t))))
    assert found.viscous_n_s_m == 0.0
    # Without a reversal the whole way is one stroke.
    assert found.stroke_m == pytest.approx(2.0, rel=0.01)
    assert found.kinetic_n == pytest.approx(5.0, rel=0.02)
    assert found.breakaway_n == pytest.approx(1.1 * found.kinetic_n, rel=0.01)


def test_ways_that_a_drive_overshoots_by_are_no_strokes() -> None:
    """Strokes of 0.2 m, and after each a swing of a twentieth of that."""
    t = np.arange(0.0, 60.0, STEP_S)
    phase = np.mod(t, 3.0)
    way = np.where((t // 3.0) % 2 == 0, 1.0, -1.0)
    after = np.where(phase < 2.2, -0.05, np.where(phase < 2.4, 0.05, 0.0))
    v = way * np.where(phase < 2.0, 0.1, after)
    found = scales(of(Run.from_arrays(t, v, 5.0 * np.sign(v))))
    assert found.stroke_m == pytest.approx(0.2, rel=0.1)


def test_rests_and_hum_are_no_motion() -> None:
    """A speed below a fiftieth of the top has no direction to speak of."""
    t = np.arange(0.0, 40.0, STEP_S)
    v = 0.1 * np.sin(0.5 * np.pi * t)
    half = np.arange(len(t)) < len(t) // 2
    (rest,) = moving_samples(of(Run.from_arrays(t, np.where(half, v, 0.0), np.sign(v))))
    assert rest[half].mean() > 0.9
    assert not rest[len(t) // 2 + 50 :].any()
    hum = np.where(half, v, 0.0015 * np.sign(np.sin(20.0 * t)))
    (found,) = moving_samples(of(Run.from_arrays(t, hum, np.sign(v))))
    assert not found[~half].any()
    slow = np.where(half, v, 0.0025)
    (found,) = moving_samples(of(Run.from_arrays(t, slow, np.sign(v))))
    assert found[~half].mean() > 0.9


def test_where_nothing_counts_there_are_no_sizes() -> None:
    campaign = of(swinging())
    with pytest.raises(InputError, match="in any run"):
        scales(campaign.without([np.ones(len(p.run), dtype=bool) for p in campaign.prepared]))


@pytest.mark.parametrize(
    ("rule", "starts"),
    [
        ("kinetic", (5.0, 7.0)),
        ("breakaway", (8.0,)),
        ("breakaway_excess", (3.0,)),
        ("viscous", (20.0, 0.0)),
        ("stribeck_speed", (0.01, 0.03, 0.1)),
        ("usual_speed", (0.1,)),
        ("slowness", (5.0, 50.0)),
        # Over a tenth of the stroke, 0.04 m, over 1e-6 m, and over 0.2 mm between them.
        ("stiffness", (200.0, 4e4, 8e6)),
        ("damping", (2.5,)),
        ("drag", (0.5,)),
    ],
)
def test_a_fit_starts_from_the_sizes(rule: str, starts: tuple[float, ...]) -> None:
    assert RULES[rule](SIZES) == pytest.approx(starts)


@pytest.mark.parametrize(
    ("rule", "starts"),
    [
        ("drive_play", (4e-3, 4e-4, 4e-5)),
        ("drive_stiffness", (2e3, 2e4)),
        # 8 N over 4 mm, swinging within a fiftieth of the 4 s of a stroke.
        ("drive_inertia", (2e3 * 0.08**2,)),
        ("drive_damping", (80.0,)),
    ],
)
def test_a_drive_on_an_axis_starts_from_its_stroke(rule: str, starts: tuple[float, ...]) -> None:
    assert LINEAR_RULES[rule](SIZES) == pytest.approx(starts)


def test_a_bad_sample_sets_no_size() -> None:
    run = swinging()
    force: Array = np.array(run.friction_n)
    force[777] = 1e5
    wild = Run.from_arrays(run.time_s, run.velocity_m_s, force, name="wild")
    plain, found = scales(of(run)), scales(of(wild))
    for name, value in vars(plain).items():
        assert getattr(found, name) == pytest.approx(value, rel=0.02), name
