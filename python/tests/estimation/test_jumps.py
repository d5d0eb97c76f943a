"""Samples next to jumps whose instants are fitted or uncertain: their weights, and fits.

The standard error of the instant of a reversal is that of the speed over the acceleration; the
error of the prediction is its rate of change times that.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from campaigns import campaign
from jbf import Drive, Model, Parameter, Rig, Run, compare, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.uncertain_samples import (
    active_effects,
    after_rests,
    jumps,
    moves_jumps,
    samples_near_jumps,
    spreads_jumps,
    timing_error_is_small,
    timing_errors,
)
from jbf.models.catalogue import parameters_of
from jbf.records.motion.estimated_motion import EstimatedMotion
from rigsim.motions import sine

EXTENDED = pytest.mark.extended


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_jump_within_one_step_is_located_at_both_samples_with_its_size(unit: float) -> None:
    t = np.arange(0.0, 10.0, 0.02)
    smooth = 20.0 * unit * np.cos(t)
    assert not jumps(smooth).any()
    assert not jumps(np.zeros(20)).any()
    found = jumps(smooth + unit * np.where(t < 5.0, 20.0, -20.0))
    assert np.flatnonzero(found).tolist() == [249, 250]
    np.testing.assert_allclose(found[249:251], 40.0 * unit, rtol=0.02)


@pytest.mark.parametrize(("size", "found"), [(0.39, False), (0.41, True)])
def test_change_is_a_jump_above_a_tenth_of_the_largest_force(size: float, found: bool) -> None:
    force = np.array([4.0 - size] * 3 + [4.0] * 3)
    assert bool(jumps(force).any()) == found


@pytest.mark.parametrize(("neighbour", "found"), [(0.32, True), (0.35, False)])
def test_gradual_rise_over_several_samples_is_not_a_jump(neighbour: float, found: bool) -> None:
    """The change is compared with three times the smaller of two neighbours on either side."""
    change = np.array([0.0, neighbour, neighbour, 1.0, 0.0, 0.0])
    for steps in (change, change[::-1]):
        force = np.concatenate(([0.0], np.cumsum(steps)))
        assert bool(np.any(jumps(force) > 0.9)) == found
    # One of the two neighbours may belong to the jump.
    one = np.concatenate(([0.0], np.cumsum([0.0, 0.0, 0.9, 1.0, 0.0, 0.0])))
    assert jumps(one).any()


def test_two_jumps_around_a_plateau_of_two_samples_are_both_detected() -> None:
    force = np.concatenate((np.full(20, 20.0), np.zeros(2), np.full(20, -20.0)))
    assert np.flatnonzero(jumps(force)).tolist() == [19, 20, 21, 22]


def test_effects_are_classified_by_whether_they_move_or_spread_jumps() -> None:
    assert moves_jumps(["sensor_offset", "time_delay"])
    assert moves_jumps(["backlash"])
    assert not moves_jumps(["sensor_lag", "drive_compliance"])
    assert spreads_jumps(["sensor_lag"])
    assert not spreads_jumps(["time_delay"])
    assert not moves_jumps([])
    assert not spreads_jumps([])


def test_effect_is_inactive_only_if_all_its_nulls_are_reached() -> None:
    pages = {
        "F_c": Parameter("F_c"),
        "one.a": Parameter("a", null=0.0),
        "one.b": Parameter("b"),
        "two.c": Parameter("c", null=np.inf),
        "three.d": Parameter("d"),
    }
    effects = ("one", "two", "three")
    assert active_effects(effects, pages, [1.0, 0.0, 5.0, np.inf, 7.0]) == ["three"]
    assert active_effects(effects, pages, [1.0, 0.1, 5.0, 1e9, 7.0]) == ["one", "two", "three"]
    dependence = parameters_of("journal", ("load_dependence",))
    law = [page.starts[0] for name, page in dependence.items() if "." not in name]
    for values, active in (((0.0, 1.5), True), ((0.4, 0.0), True), ((0.0, 0.0), False)):
        found = active_effects(["load_dependence"], dependence, [*law, *values])
        assert found == (["load_dependence"] if active else [])


def square_wave(noise_rms: float) -> tuple[Campaign, Array]:
    """A run whose force changes its sign once, at sample 250, with noise of alternating sign."""
    t = np.arange(0.0, 10.0, 0.02)
    force = np.where(t < 5.0, 20.0, -20.0)
    noise = noise_rms * np.where(np.arange(len(t)) % 2, 1.0, -1.0)
    run = Run.from_arrays(t, np.where(t < 5.0, 0.1, -0.1), force + noise, name="a")
    prepared = Campaign.prepare(Rig(), [run])
    every = np.ones(len(t))
    samples = replace(prepared.samples, counted=(every > 0.0,), weight=(every,))
    return replace(prepared, samples=samples), force


@pytest.mark.parametrize("noise_rms", [0.3, 3.0])
@pytest.mark.parametrize("before", [1.0, 0.5])
def test_weight_at_a_moved_jump_is_the_share_of_noise(noise_rms: float, before: float) -> None:
    """Half of the change, 20 N, is added to the noise in squares; tests exclude these samples."""
    campaign_, force = square_wave(noise_rms)
    samples = replace(campaign_.samples, weight=(np.full(len(force), before),))
    found = samples_near_jumps(samples, campaign_.prepared, [force], ["time_delay"])
    adjacent = np.isin(np.arange(len(force)), [249, 250])
    np.testing.assert_array_equal(found.counted[0], ~adjacent)
    np.testing.assert_array_equal(found.weight[0][~adjacent], before)
    expected = before * noise_rms / np.hypot(noise_rms, 20.0)
    np.testing.assert_allclose(found.weight[0][adjacent], expected, rtol=1e-9)
    assert samples_near_jumps(samples, campaign_.prepared, [force], ["sensor_offset"]) is samples


def test_weight_after_a_spread_reversal_is_the_share_of_noise_in_the_total_error() -> None:
    """Tests exclude samples whose error from the uncertain instant exceeds half of the noise."""
    t = np.arange(0.0, 20.0, 0.02)
    random = np.random.default_rng(2)
    v = 0.004 * (t - 10.0) + 1e-3 * random.standard_normal(len(t))
    true = 0.004 * (t - 10.0)
    since = np.maximum(t - 10.0, 0.0)
    force = np.where(true < 0.0, -5.0, 5.0 - 10.0 * np.exp(-since / 0.5))
    noise_rms = 0.2
    run = Run.from_arrays(t, v, force + noise_rms * random.standard_normal(len(t)), name="a")
    campaign_ = Campaign.prepare(Rig(), [run])
    (p,) = campaign_.prepared
    found = samples_near_jumps(campaign_.samples, [p], [force], ["sensor_lag"])
    counted = campaign_.samples.counted[0]
    rms = float(np.sqrt(np.mean((force - p.friction)[counted] ** 2)))
    error_n = timing_errors(p, force, 0.5 * rms)
    assert 5 < np.count_nonzero(error_n) < 200
    np.testing.assert_array_equal(found.counted[0], counted & (error_n == 0.0))
    expected = np.where(counted, rms / np.hypot(rms, error_n), 0.0)
    np.testing.assert_allclose(found.weight[0], expected)


@pytest.mark.parametrize("name", ["time_delay", pytest.param("backlash", marks=EXTENDED)])
def test_parameter_of_an_effect_that_moves_jumps_is_recovered_within_its_error(name: str) -> None:
    rig, complete, truth = campaign(5, (name,))
    runs = complete[:2]
    solution = fit(rig, runs, [name])
    assert solution.rms < 1.03 * truth["noise_n"]
    (short, value), *_ = truth["effects"][name].items()
    full = next(n for n in solution.parameters if n.startswith(f"{name}.{short}"))
    found = solution.parameters[full]
    assert abs(found.value - value) < 3.5 * found.stderr
    assert found.stderr < 0.3 * value
    # Only the samples next to the moved jumps are excluded.
    bare = compare(Model(rig), runs)
    assert 0.97 * bare.samples.count < solution.nobs < bare.samples.count
    assert compare(solution.model, runs).rms < 1.03 * truth["noise_n"]


STEP_S = 0.1
SLOW = (sine("slow", 160.0, 0.02, 0.05),)


DRIVE = Rig(drive=Drive("linear", "force"))


def prepared(
    velocity: Sequence[float],
    *,
    error: float | Array = 1e-3,
    unknown: Sequence[int] = (),
    rig: Rig | None = None,
) -> Prepared:
    """A run with a given motion; `unknown` are the samples at which its sign is not known."""
    v = np.array(velocity)
    n = len(v)
    long = np.where(np.arange(200) < 100, 0.2, -0.2)
    run = Run.from_arrays(STEP_S * np.arange(200), long, 5.0 * np.sign(long) + 0.01 * np.cos(long))
    made = Prepared.of(Rig(), run)
    rest = v == 0.0
    known = ~rest & ~np.isin(np.arange(n), unknown)
    errors = np.broadcast_to(np.asarray(error, dtype=float), (n,)).copy()
    motion = EstimatedMotion(v, np.zeros(n), STEP_S * np.cumsum(v), errors, rest, known)
    short = made.run.select(np.arange(200) < n)
    made = replace(made, rig=made.rig if rig is None else rig)
    return replace(made, run=short, motion=motion, friction=made.friction[:n])


def ramp(p: Prepared, rate_n_s: float = 10.0) -> Array:
    return rate_n_s * np.asarray(p.run.time_s)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_error_after_a_reversal_is_rate_of_change_times_error_of_the_instant(unit: float) -> None:
    """2 mm/s at 2 m/s^2 are 1 ms, or 0.05 N at 50 N/s, until the error is below the minimum."""
    p = prepared([0.2] * 3 + [0.1, -0.1] + [-0.2] * 11, error=2e-3)
    slope = 50.0 * ((np.arange(15) >= 3) & (np.arange(15) < 9))
    prediction = unit * np.concatenate(([0.0], np.cumsum(slope * STEP_S)))
    rate = np.abs(np.gradient(prediction, p.run.time_s))
    found = timing_errors(p, prediction, 0.02 * unit)
    np.testing.assert_array_equal(found[:4], 0.0)
    np.testing.assert_allclose(found[4:10], 1e-3 * rate[4:10])
    assert found[5] == pytest.approx(0.05 * unit)
    np.testing.assert_array_equal(found[10:], 0.0)
    # The rate falls to half at the ninth sample.
    assert timing_errors(p, prediction, 0.03 * unit)[9] == 0.0


def test_error_of_the_instant_is_limited_to_that_of_a_uniform_distribution_over_a_step() -> None:
    p = prepared([0.2] * 4 + [-0.2] * 8, error=1e3)
    found = timing_errors(p, ramp(p), 1e-9)
    np.testing.assert_allclose(found[4:], STEP_S * 10.0 / np.sqrt(12.0), rtol=0.01)


def test_samples_of_unknown_sign_at_a_reversal_have_the_timing_error_of_the_reversal() -> None:
    error = np.array([9.0, 1e-3, 5e-3, 1e-3, 2e-3, 9.0, 9.0, 9.0])
    p = prepared([0.2, 0.2, 0.1, -0.1, -0.2, -0.2, -0.2, -0.2], error=error, unknown=(2, 3))
    found = timing_errors(p, ramp(p), 1e-9)
    np.testing.assert_array_equal(found[:2], 0.0)
    np.testing.assert_allclose(found[2:], 10.0 * 5e-3 / (0.4 / 0.3))


def test_force_error_of_the_instant_of_a_reversal_applies_until_the_next_reversal() -> None:
    error = np.where(np.arange(11) < 6, 1e-3, 1e-4)
    p = prepared([0.2] * 3 + [-0.2] * 4 + [0.2] * 4, error=error)
    first, second = 1e-3 / 4.0 * 20.0, 1e-4 / 4.0 * 20.0
    found = timing_errors(p, ramp(p, 20.0), 1e-9)
    np.testing.assert_allclose(found, [0.0] * 3 + [first] * 4 + [second] * 4)
    # A rate of change that begins after the reversal has no error from its instant.
    p = prepared([0.2] * 3 + [-0.2] * 8)
    late = np.maximum(ramp(p) - ramp(p)[6], 0.0)
    assert not timing_errors(p, late, 1e-9).any()


@pytest.mark.parametrize(
    ("velocity", "unknown", "first"),
    [
        ([1.0, 1.0, -1.0, -1.0, -1.0], (), 2),
        ([1.0, 0.1, -0.1, -1.0, -1.0], (1, 2), 1),
        # A stop between two directions is not a reversal, and neither is a start.
        ([1.0, 0.0, -1.0, -1.0, -1.0], (), None),
        ([0.0, 1.0, 1.0, 2.0, 2.0], (), None),
        ([1.0, 0.0, 0.0, 1.0, -1.0], (), 4),
    ],
)
def test_reversal_is_a_sign_change_without_a_rest(velocity: Any, unknown: Any, first: Any) -> None:
    p = prepared(velocity, unknown=unknown)
    found = np.flatnonzero(timing_errors(p, ramp(p), 1e-9))
    assert (int(found[0]) if len(found) else None) == first


@pytest.mark.parametrize("rig", [DRIVE, Rig()], ids=["drive", "load cell"])
def test_force_at_rest_is_forgotten_with_the_time_constant_of_the_sensor(rig: Rig) -> None:
    """A force of 5 N decreases to 5 N exp(-3) in three time constants of one sample."""
    p = prepared([0.0, 1.0, 1.0, 1.0, 1.0, 0.0, -1.0, -1.0, -1.0, -1.0], rig=rig)
    largest_n = float(np.max(np.abs(p.friction)))
    excluded = after_rests(p, STEP_S, largest_n * np.exp(-3.0) * 0.99)
    assert excluded.tolist() == [True] * 4 + [False] + [True] * 4 + [False]
    assert not after_rests(prepared([1.0, 1.0, 1.0], rig=rig), STEP_S, 1e-9).any()


def test_force_at_rest_of_a_bearing_is_not_excluded() -> None:
    assert not after_rests(prepared([0.0, 1.0, 1.0], rig=Rig.thesis()), STEP_S, 1e-9).any()


def test_reversal_error_is_zero_in_a_record_of_two_samples() -> None:
    two = prepared([0.2, -0.2])
    assert timing_errors(two, np.array([1.0, -1.0]), 0.0).tolist() == [0.0, 0.0]


def true_model(
    seed: int, effects: tuple[str, ...], speed_noise_m_s: float = 0.0
) -> tuple[Problem, Array, float]:
    """Problem and true values of slow runs; with noise of the speed the angle is omitted."""
    rig, runs, truth = campaign(seed, effects, motions=SLOW)
    if speed_noise_m_s > 0.0:
        random = np.random.default_rng(seed)
        noisy = [r.velocity + random.normal(0.0, speed_noise_m_s, len(r)) for r in runs]
        pairs = zip(runs, noisy, strict=True)
        runs = [replace(r, velocity=v, angle_rad=None) for r, v in pairs]
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", effects)
    known = {name.removesuffix("_m_s"): value for name, value in truth["base"].items()}
    for effect, values in truth["effects"].items():
        known |= {f"{effect}.{name}": value for name, value in values.items()}
    names = [name.removesuffix("_m_s").removesuffix("_s") for name in problem.names]
    return problem, np.array([known[name] for name in names]), truth["noise_n"]


@pytest.mark.parametrize(
    "seeds", [range(20, 23), pytest.param(range(23, 32), marks=pytest.mark.extended)]
)
def test_errors_after_slow_reversals_are_as_large_as_predicted(seeds: range) -> None:
    doubtful, others = [], []
    for seed in seeds:
        problem, values, noise_rms = true_model(seed, ("sensor_lag",), speed_noise_m_s=1e-3)
        (p,), (prediction,) = problem.campaign.prepared, problem.predict(values)
        error_n = timing_errors(p, prediction, 0.5 * noise_rms)
        residual = p.friction - prediction
        counted = p.motion.sign_known
        behind = counted & (error_n > 0.0)
        doubtful.append(residual[behind] / np.hypot(noise_rms, error_n[behind]))
        others.append(residual[counted & (error_n == 0.0)] / noise_rms)
        assert 0 < behind.sum() < 0.1 * counted.sum()
        assert np.max(error_n) > 2.0 * noise_rms
    assert 0.4 < np.sqrt(np.mean(np.concatenate(doubtful) ** 2)) < 2.0
    assert np.sqrt(np.mean(np.concatenate(others) ** 2)) == pytest.approx(1.0, abs=0.05)


def test_instant_is_known_where_its_error_changes_the_force_by_less_than_the_noise() -> None:
    """Position read up to 3 ms off the time stamps; force that reverses within 0.1 s."""
    t, error_s, noise_rms = 0.005 * np.arange(4000), 1e-3, 0.07
    read_s = t + error_s * np.random.default_rng(3).standard_normal(len(t))
    position = 0.05 * np.sin(3.0 * read_s)
    force = 10.0 * np.tanh(np.cos(3.0 * t) / 0.15)
    run = Run.from_arrays(t, None, force, position_m=position, name="a")
    (p,) = Campaign.prepare(Rig(), [run]).prepared
    known = timing_error_is_small(p, np.zeros(len(t)), noise_rms)
    change_n = error_s * np.abs(np.gradient(force, t))
    assert 100 < np.sum(change_n > 1.5 * noise_rms) < 1000
    assert not known[change_n > 1.5 * noise_rms].any()
    assert known[change_n < 0.5 * noise_rms].all()
    # The speed is uncertain instead of the time stamps.
    error_m_s = error_s * np.abs(p.motion.acceleration)
    uncertain = replace(p.motion, velocity_error_m_s=error_m_s, errors=None)
    known = timing_error_is_small(replace(p, motion=uncertain), np.zeros(len(t)), noise_rms)
    np.testing.assert_array_equal(known, change_n <= noise_rms)
