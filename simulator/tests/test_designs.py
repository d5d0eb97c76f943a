"""Tests of randomly drawn rigs: ranges, motions, effects and initial film states."""

import numpy as np
import pytest
from rigsim import CATALOGUE
from rigsim.designs import draw_design, draw_effect, draw_film_start
from rigsim.excitation import FASTEST, SLOWEST, campaign
from rigsim.film import Film

SEEDS = range(40)


def test_randomly_drawn_rigs_are_repeatable_and_within_documented_ranges():
    designs = [draw_design(seed) for seed in SEEDS]
    assert draw_design(3) == draw_design(3)
    loads = np.array([d.base.load_n for d in designs])
    assert loads.min() < 80.0
    assert loads.max() > 180.0
    assert ((loads >= 50.0) & (loads <= 250.0)).all()
    assert {d.rate_hz for d in designs} == {50.0, 100.0, 200.0}
    for d in designs:
        assert d.base.transition_eccentricity() + (d.base.load_group / d.base.K0) ** 0.5 < 1.0
        assert 0.01 <= d.noise_n / (d.base.f_m * d.base.load_n) <= 0.025


def test_drawn_campaigns_have_three_to_seven_runs_that_start_during_a_motion():
    counts, moving = [], []
    for seed in SEEDS:
        plans = campaign(draw_design(seed), (), seed)
        counts.append(len(plans))
        assert len({p.motion.name for p in plans}) == len(plans)
        for plan in plans:
            assert plan.begins_s > 0.0
            assert plan.begins_s + plan.length_s < plan.motion.duration_s
            moving.append(abs(plan.motion.pieces[0].speed(0.0)) > 1e-3)
    assert min(counts) == 3
    assert max(counts) == 7
    assert 0.3 < np.mean(moving) < 0.8
    assert 0.0 < SLOWEST < FASTEST


@pytest.mark.parametrize("name", CATALOGUE)
def test_drawn_effect_sizes_scale_with_the_friction_of_the_rig(name):
    light, heavy = (
        min((draw_design(s) for s in SEEDS), key=lambda d: d.base.f_m * d.base.load_n),
        max((draw_design(s) for s in SEEDS), key=lambda d: d.base.f_m * d.base.load_n),
    )
    small, large = (draw_effect(name, d.base, np.random.default_rng(1)) for d in (light, heavy))
    ratio = heavy.base.f_m * heavy.base.load_n / (light.base.f_m * light.base.load_n)
    proportional = {"coulomb_drag": "F_d", "sensor_offset": "b", "inertia": "m_e"}
    proportional["sensor_hysteresis"] = "w"
    if name in proportional:
        assert large[proportional[name]] / small[proportional[name]] == pytest.approx(ratio)
    if name == "sensor_nonlinearity":
        assert large["c"] / small["c"] == pytest.approx(ratio**-2)
    assert set(small) == set(CATALOGUE[name])


def test_initial_eccentricity_varies_in_motion_and_exceeds_transition_at_rest():
    base = draw_design(4).base
    film = Film.of(base)
    rng = np.random.default_rng(1)
    moving = [draw_film_start(base, 0.03, rng)[0] for _ in range(20)]
    resting = [draw_film_start(base, 0.0, rng)[0] for _ in range(20)]
    assert np.ptp(moving) > 1e-3
    assert min(resting) >= film.eps_tr
    assert max([*moving, *resting]) < 1.0
