"""Samples next to jumps whose instants are fitted or uncertain: their weights, and fits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from campaigns import campaign
from delayed_runs import DELAY, TAU, fitted, reversing_campaign
from jbf import Model, Parameter, Rig, Run, compare, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.jumps import (
    active_effects,
    jumps,
    moves_jumps,
    samples_beside_jumps,
    spreads_jumps,
)
from jbf.estimation.problem import Problem
from jbf.estimation.reversals import instant_errors_n
from jbf.models.catalogue import parameters_of

EXTENDED = pytest.mark.extended


# ---- detection -----------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_jump_within_one_step_is_found_at_both_samples_with_its_size(unit: float) -> None:
    """Both samples next to the jump receive its size."""
    t = np.arange(0.0, 10.0, 0.02)
    smooth = 20.0 * unit * np.cos(t)
    assert not jumps(smooth).any()
    assert not jumps(np.zeros(20)).any()
    jumped = np.where(t < 5.0, smooth + 20.0 * unit, smooth - 20.0 * unit)
    found = jumps(jumped)
    assert np.flatnonzero(found).tolist() == [249, 250]
    np.testing.assert_allclose(found[249:251], 40.0 * unit, rtol=0.02)


@pytest.mark.parametrize(("size", "found"), [(0.39, False), (0.41, True)])
def test_change_is_a_jump_only_if_above_a_tenth_of_the_largest_force(
    size: float, found: bool
) -> None:
    force = np.array([4.0 - size] * 3 + [4.0] * 3)
    assert bool(jumps(force).any()) == found


@pytest.mark.parametrize(("neighbour", "found"), [(0.32, True), (0.35, False)])
def test_rise_over_several_samples_is_not_a_jump(neighbour: float, found: bool) -> None:
    """The change is compared with three times the smaller of two neighbours on either side."""
    change = np.array([0.0, neighbour, neighbour, 1.0, 0.0, 0.0])
    for steps in (change, change[::-1]):
        force = np.concatenate(([0.0], np.cumsum(steps)))
        assert bool(np.any(jumps(force) > 0.9)) == found
    # One of the two neighbours may be a part of the jump.
    one = np.concatenate(([0.0], np.cumsum([0.0, 0.0, 0.9, 1.0, 0.0, 0.0])))
    assert jumps(one).any()


def test_two_jumps_around_a_plateau_of_two_samples_are_found() -> None:
    force = np.concatenate((np.full(20, 20.0), np.zeros(2), np.full(20, -20.0)))
    assert np.flatnonzero(jumps(force)).tolist() == [19, 20, 21, 22]


def test_effects_are_classified_by_whether_they_move_or_blur_jumps() -> None:
    assert moves_jumps(["sensor_offset", "time_delay"])
    assert moves_jumps(["backlash"])
    assert not moves_jumps(["sensor_lag", "drive_compliance"])
    assert spreads_jumps(["sensor_lag"])
    assert not spreads_jumps(["time_delay"])
    assert not moves_jumps([])
    assert not spreads_jumps([])


def test_effect_is_inactive_only_if_all_its_nulls_are_reached() -> None:
    pages = {
        "F_c_n": Parameter("F_c_n"),
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


# ---- weights -------------------------------------------------------------------------------------


def square_wave(noise_n: float) -> tuple[Campaign, Array]:
    """A run whose force changes its sign once, at sample 250, with noise of alternating sign."""
    t = np.arange(0.0, 10.0, 0.02)
    force = np.where(t < 5.0, 20.0, -20.0)
    noise = noise_n * np.where(np.arange(len(t)) % 2, 1.0, -1.0)
    run = Run.from_arrays(t, np.where(t < 5.0, 0.1, -0.1), force + noise, name="a")
    prepared = Campaign.prepare(Rig(), [run])
    every = np.ones(len(t))
    samples = replace(prepared.samples, counted=(every > 0.0,), weight=(every,))
    return replace(prepared, samples=samples), force


@pytest.mark.parametrize("noise_n", [0.3, 3.0])
@pytest.mark.parametrize("before", [1.0, 0.5])
def test_weight_next_to_a_moved_jump_is_the_share_of_noise_in_the_total_error(
    noise_n: float, before: float
) -> None:
    """Half of the change, 20 N, is added to the noise in squares; the samples count in no test."""
    campaign_, force = square_wave(noise_n)
    samples = replace(campaign_.samples, weight=(np.full(len(force), before),))
    found = samples_beside_jumps(samples, campaign_.prepared, [force], ["time_delay"])
    adjacent = np.isin(np.arange(len(force)), [249, 250])
    np.testing.assert_array_equal(found.counted[0], ~adjacent)
    np.testing.assert_array_equal(found.weight[0][~adjacent], before)
    expected = before * noise_n / np.hypot(noise_n, 20.0)
    np.testing.assert_allclose(found.weight[0][adjacent], expected, rtol=1e-9)
    assert samples_beside_jumps(samples, campaign_.prepared, [force], ["sensor_offset"]) is samples


def test_weight_after_a_blurred_reversal_is_the_share_of_noise_in_the_total_error() -> None:
    """Samples whose error from the uncertain instant exceeds half of the noise count in no test."""
    t = np.arange(0.0, 20.0, 0.02)
    random = np.random.default_rng(2)
    v = 0.004 * (t - 10.0) + 1e-3 * random.standard_normal(len(t))
    true = 0.004 * (t - 10.0)
    since = np.maximum(t - 10.0, 0.0)
    force = np.where(true < 0.0, -5.0, 5.0 - 10.0 * np.exp(-since / 0.5))
    noise_n = 0.2
    run = Run.from_arrays(t, v, force + noise_n * random.standard_normal(len(t)), name="a")
    campaign_ = Campaign.prepare(Rig(), [run])
    (p,) = campaign_.prepared
    found = samples_beside_jumps(campaign_.samples, [p], [force], ["sensor_lag"])
    counted = campaign_.samples.counted[0]
    rms_n = float(np.sqrt(np.mean((force - p.friction_n)[counted] ** 2)))
    error_n = instant_errors_n(p, force, 0.5 * rms_n)
    assert 5 < np.count_nonzero(error_n) < 200
    np.testing.assert_array_equal(found.counted[0], counted & (error_n == 0.0))
    expected = np.where(counted, rms_n / np.hypot(rms_n, error_n), 0.0)
    np.testing.assert_allclose(found.weight[0], expected)


def test_all_samples_count_if_the_effect_that_moves_jumps_is_at_its_null() -> None:
    bare = fitted(reversing_campaign((0.0,) * 2))[0]
    problem = Problem(bare.campaign, "coulomb", "journal", DELAY)
    values = problem.starts({})[0]
    every = problem.campaign.samples
    assert problem.samples_at(values).count < every.count
    values[problem.names.index(TAU)] = 0.0
    assert problem.samples_at(values) is every


# ---- recovery on simulated campaigns -------------------------------------------------------------


@pytest.mark.parametrize("name", ["time_delay", pytest.param("backlash", marks=EXTENDED)])
def test_parameter_of_an_effect_that_moves_jumps_is_recovered_within_its_error(name: str) -> None:
    rig, runs, truth = campaign(5, (name,))
    solution = fit(rig, runs, [name])
    assert solution.rms_n < 1.03 * truth["noise_n"]
    (short, value), *_ = truth["effects"][name].items()
    full = next(n for n in solution.parameters if n.startswith(f"{name}.{short}"))
    found = solution.parameters[full]
    assert found.stderr is not None
    assert abs(found.value - value) < 3.5 * found.stderr
    assert found.stderr < 0.3 * value
    # Only the samples next to the moved jumps are left out.
    bare = compare(Model(rig), runs)
    assert 0.97 * bare.samples.count < solution.samples < bare.samples.count
    assert compare(solution.model, runs).rms_n < 1.03 * truth["noise_n"]
