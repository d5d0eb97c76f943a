"""Tests of each simulated effect against its null value, its typical size and its closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rigsim import CATALOGUE, Base, Warmth, draw, polyline, simulate_run, sine, stop_and_go
from rigsim.catalogue import NULLS

BASE = Base()
SWING = sine("swing", 13.0, 0.127, 1.0)
STOP = stop_and_go("stop", [(0.5, 1), (8.0, -1)], 0.05, 1.0, 2.0, 14.0)


def force(effects, motion=SWING, **options):
    return simulate_run(BASE, effects, motion, **options).friction


def hold(speed, seconds=40.0):
    return polyline("hold", [(0.0, speed), (seconds, speed)])


def drawn(name):
    return draw(name, np.random.default_rng(5))


@pytest.mark.parametrize("name", CATALOGUE)
def test_effect_with_null_parameters_reproduces_the_base_law_exactly(name):
    np.testing.assert_array_equal(force({name: drawn(name) | NULLS[name]}), force({}))


SMALL = {
    "thermal_thinning": {"beta_q": 1e-9},
    "shear_thinning": {"U_c": 1e9},
    "film_memory": {"factor": 1.0 + 1e-9},
    "presliding": {"sigma": 1e7},
    "sensor_lag": {"tau": 1e-7},
}


@pytest.mark.parametrize(
    "name", [name for name in CATALOGUE if name not in ("drive_compliance", "backlash")]
)
def test_effect_vanishes_as_its_parameter_approaches_the_null(name):
    small = SMALL.get(name) or dict.fromkeys(NULLS[name], 1e-9)
    plain = simulate_run(BASE, {}, STOP)
    moving = plain.velocity != 0.0  # at rest a bristle of any stiffness holds its force
    gap = force({name: drawn(name) | small}, STOP) - plain.friction
    assert np.max(np.abs(gap[moving])) < 1e-3


def test_drags_and_inertia_add_the_forces_of_their_closed_forms():
    extra = {
        "coulomb_drag": {"F_d": 0.7},
        "quadratic_drag": {"c": 50.0},
        "inertia": {"m_e": 4.0},
    }
    record = simulate_run(BASE, extra, SWING)
    v, t = record.velocity, record.time_s
    expected = 0.7 * np.sign(v) + 50.0 * v * abs(v) + 4.0 * 0.127 * np.cos(t)
    np.testing.assert_allclose(record.friction - force({}), expected, atol=1e-9)


def test_sensor_lag_acts_as_a_first_order_filter_of_the_force():
    lagged = force({"sensor_lag": {"tau": 0.1}}, rate_hz=2000.0)
    plain = simulate_run(BASE, {}, SWING, rate_hz=2000.0)
    rate = np.gradient(lagged, 1.0 / 2000.0)
    inner = np.abs(plain.velocity) > 0.005
    np.testing.assert_allclose((lagged + 0.1 * rate)[inner], plain.friction[inner], atol=2e-3)


def test_presliding_friction_settles_at_the_base_friction():
    motion = polyline("start", [(0.0, 0.0), (1.0, 0.03), (30.0, 0.03)])
    bristled = force({"presliding": {"sigma": 2000.0}}, motion)
    assert bristled[-1] == pytest.approx(force({}, motion)[-1], rel=1e-6)


def test_presliding_force_is_constant_while_the_shaft_rests():
    motion = polyline("stop", [(0.0, 0.03), (3.0, 0.03), (4.0, 0.0), (9.0, 0.0)])
    record = simulate_run(BASE, {"presliding": {"sigma": 2000.0}}, motion)
    rest = record.friction[record.time_s >= 4.0]
    assert rest[0] > 1.0
    np.testing.assert_allclose(rest, rest[0], rtol=1e-9)


def test_dwell_stiction_grows_with_the_duration_of_a_rest_by_its_closed_form():
    p = {"a": 0.06, "t_0": 4.0, "m": 0.65, "s_0": 0.002}
    np.testing.assert_array_equal(force({"dwell_stiction": p}), force({}))
    gap = force({"dwell_stiction": p}, STOP) - force({}, STOP)
    t = simulate_run(BASE, {}, STOP).time_s
    for start, dwell, sign in ((0.5, 0.5, 1.0), (8.0, 3.5, -1.0)):
        i = int(np.argmin(np.abs(t - start - 0.1)))
        slid = 0.5 * 0.05 * (t[i] - start) ** 2
        aged = p["a"] * (1.0 - math.exp(-((dwell / 4.0) ** 0.65))) * math.exp(-slid / 0.002)
        assert gap[i] == pytest.approx(sign * BASE.load_n * aged, rel=1e-6)


def test_thermal_thinning_satisfies_the_steady_heat_balance():
    p = {"beta_q": 0.1, "tau": 2.0}
    final = force({"thermal_thinning": p}, hold(0.1, 60.0))[-1]
    heat = 0.1 * 2.0 * final * 0.1
    thinner = force({}, hold(0.1 * math.exp(-heat), 60.0))[-1]
    assert final == pytest.approx(thinner, rel=1e-6)


def test_ripple_and_asymmetry_scale_bearing_friction_but_not_drag():
    effects = {
        "position_ripple": {"a": 0.2, "theta_0": 1.0},
        "direction_asymmetry": {"a": 0.1},
        "coulomb_drag": {"F_d": 0.5},
    }
    record = simulate_run(BASE, effects, SWING, start_angle_rad=2.0)
    factor = 1.0 + 0.2 * np.cos(record.angle_rad - 1.0)
    factor *= 1.0 + 0.1 * np.sign(record.velocity)
    expected = force({}) * factor + 0.5 * np.sign(record.velocity)
    np.testing.assert_allclose(record.friction, expected, atol=1e-9)


def test_time_delay_shifts_the_record_by_whole_samples():
    delayed = force({"time_delay": {"tau": 0.1}})
    np.testing.assert_allclose(delayed[5:], force({})[:-5], atol=1e-9)
    assert np.all(delayed[:5] == delayed[0])


def test_backlash_holds_the_journal_until_the_gap_is_crossed():
    gap = 0.2  # rad; the drive reverses at pi
    record = simulate_run(BASE, {"backlash": {"gap": gap}}, SWING)
    plain = simulate_run(BASE, {}, SWING)
    t = record.time_s
    closes = 2.0 * math.pi - math.acos(gap * BASE.bearing.radius_m / 0.127 - 1.0)
    np.testing.assert_allclose(record.friction[t < 3.14], plain.friction[t < 3.14], atol=1e-7)
    assert np.all(record.friction[(t > 3.15) & (t < closes)] == 0.0)
    assert np.all(record.friction[(t > closes) & (t < 6.28)] < 0.0)
    np.testing.assert_array_equal(record.velocity, plain.velocity)


def test_load_dependence_reproduces_the_second_published_table_at_its_load():
    share = math.log(83.5 / 104.0)
    p = {"p": math.log(0.05 / 0.06) / share, "q": math.log(6.25e5 / 7.5e5) / share}
    other = simulate_run(Base(load_n=83.5, U_tr=0.05, K0=6.25e5), {}, SWING).friction
    np.testing.assert_allclose(force({"load_dependence": p}, load_n=83.5), other, atol=1e-7)
    np.testing.assert_array_equal(force({"load_dependence": p}), force({}))


def test_sensor_hysteresis_trails_a_monotonic_force_by_its_half_width():
    width = 0.8
    record, plain = force({"sensor_hysteresis": {"w": width}}), force({})
    gap = record - plain
    assert record[0] == plain[0]
    assert np.max(np.abs(gap)) <= width + 1e-6
    # Samples after a monotonic change of the force by more than three half widths.
    change = np.convolve(np.diff(plain), np.ones(25))[24:-24]
    for sign in (1.0, -1.0):
        candidates = np.flatnonzero(sign * change > 3.0 * width) + 25
        assert len(candidates) > 5
        monotonic = [i for i in candidates if np.all(sign * np.diff(plain[i - 25 : i + 1]) > 0.0)]
        np.testing.assert_allclose(gap[monotonic], -sign * width, atol=1e-6)
    np.testing.assert_allclose(
        force({"sensor_hysteresis": {"w": width}}, rate_hz=400.0)[::8], record, atol=0.05
    )


def test_sensor_effects_act_in_the_order_hysteresis_nonlinearity_offset():
    play, bend = {"sensor_hysteresis": {"w": 0.8}}, {"sensor_nonlinearity": {"c": -3e-4}}
    zero = {"sensor_offset": {"b": 0.5}}
    held = force(play)
    np.testing.assert_allclose(force(play | bend | zero), held - 3e-4 * held**3 + 0.5, atol=1e-6)


def test_lag_and_delay_computed_on_a_grid_agree_with_those_computed_by_a_state():
    """With a nonlinear sensor, filter and delay are computed on a grid instead of by a state."""
    straight = {"sensor_nonlinearity": {"c": 1e-12}}
    for other in ({"sensor_lag": {"tau": 0.1}}, {"time_delay": {"tau": 0.1}}):
        gap = np.abs(force(straight | other) - force(other))
        assert np.max(gap) < 5e-3


def test_simulator_refuses_unknown_effect_and_parameter_names():
    with pytest.raises(ValueError, match="no effect named"):
        force({"magic": {}})
    with pytest.raises(ValueError, match="takes F_d"):
        force({"coulomb_drag": {"force": 1.0}})


def test_vogel_viscosity_at_a_steady_temperature_equals_a_thinner_oil():
    """The transition speed of a thinner oil is also higher."""
    thin = math.exp(800.0 / (45.0 + 95.0) - 800.0 / (25.0 + 95.0))
    oil = replace(BASE.bearing, viscosity_pa_s=BASE.bearing.viscosity_pa_s * thin)
    other = replace(BASE, U_tr=BASE.U_tr / thin, bearing=oil)
    warm = force({"vogel_viscosity": {"B": 800.0}}, warmth=Warmth(45.0))
    thinner = simulate_run(other, {}, SWING).friction
    np.testing.assert_allclose(warm, thinner, atol=1e-5)
    assert np.max(np.abs(warm - force({}))) > 0.5


def test_vogel_viscosity_reaches_the_friction_of_the_final_temperature():
    hidden = {"vogel_viscosity": {"B": 900.0}}
    speed = hold(0.03)
    cold, warm = (force(hidden, speed, warmth=Warmth(c)) for c in (15.0, 40.0))
    warming = force(hidden, speed, warmth=Warmth(15.0, rise_k=25.0, tau_s=6.0))
    difference = abs(cold[-1] - warm[-1])
    assert difference > 1.0
    assert abs(warming[-1] - warm[-1]) < 0.02 * difference
    assert np.max(np.abs(warming - warm)) > 0.5 * difference
