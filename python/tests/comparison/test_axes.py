"""Axes of a residual: the motion determines the bin of every sample."""

import math
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Rig, Run
from jbf.comparison.axes import all_axes, force_axis
from jbf.comparison.bins import Binned
from jbf.estimation.campaign import Campaign

Array = npt.NDArray[np.float64]

Axes = dict[str, Binned]

U_TR_M_S = 0.05


def run_with_rests(seed: int, duration_s: float, start_s: float = 0.0) -> Run:
    """A motion in both directions at many speeds, with rests in between."""
    time = start_s + np.arange(0.0, duration_s, 0.02)
    speed = 0.12 * np.sin(0.9 * time) * np.sin(0.23 * time + 0.3 * seed)
    speed[np.sin(0.31 * time + seed) > 0.93] = 0.0
    path = np.concatenate(([0.0], np.cumsum(0.01 * (speed[1:] + speed[:-1]))))
    noise = np.random.default_rng(seed).normal(0.0, 0.3, len(time))
    force = 20.0 * np.sign(speed) + noise
    return Run.from_arrays(time, speed, force, angle_rad=path / 0.0127, name=f"{seed}")


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """Two runs; the clock of the second does not start at zero."""
    runs = [run_with_rests(1, 60.0), run_with_rests(2, 41.0, start_s=100.0)]
    return Campaign.prepare(Rig.thesis(), runs)


@pytest.fixture(scope="module")
def axes(campaign: Campaign) -> Axes:
    return {axis.axis: axis for axis in all_axes(campaign, U_TR_M_S)}


def axis_of(campaign: Campaign, name: str, u_tr: float | None = U_TR_M_S) -> Binned:
    return next(axis for axis in all_axes(campaign, u_tr) if axis.axis == name)


def velocities(campaign: Campaign) -> Array:
    """Velocities of all runs in one array, m/s."""
    return np.concatenate([p.motion.velocity for p in campaign.prepared])


def places(axis: Binned) -> Array:
    """Bin index of every sample of all runs."""
    return np.concatenate(axis.places)


def test_bins_of_one_direction_exclude_the_other_direction(campaign: Campaign, axes: Axes) -> None:
    velocity = velocities(campaign)
    for name, axis in axes.items():
        directions = [b.direction for b in axis.bins]
        half = len(directions) // 2
        both = name in ("regime", "run")
        assert directions == ([0] * len(directions) if both else [-1] * half + [1] * half)
        for i, b in enumerate(axis.bins):
            if b.direction:
                assert -b.direction not in np.sign(velocity[places(axis) == i]), (name, i)
            # Only the backward bins of the time axis contain samples at rest as well.
            assert b.with_rest == (name == "time" and b.direction < 0)


def test_bins_of_every_axis_have_the_units_of_the_rig(axes: Axes) -> None:
    expected = {name: {""} for name in ("direction", "regime", "acceleration", "run")}
    expected |= {"velocity": {"m/s"}, "time": {"s"}, "angle": {"deg"}}
    expected |= {"time since a rest": {"s"}, "distance since a reversal": {"m"}}
    assert {name: {b.unit for b in axis.bins} for name, axis in axes.items()} == expected
    assert {axis.force_unit for axis in axes.values()} == {"N"}


def test_direction_axis_separates_the_signs_of_the_velocity(campaign: Campaign, axes: Axes) -> None:
    at, sign = places(axes["direction"]), np.sign(velocities(campaign))
    assert np.array_equal(at, np.where(sign > 0, 1, np.where(sign < 0, 0, -1)))


def test_run_axis_has_one_bin_for_each_run(axes: Axes) -> None:
    assert [b.name for b in axes["run"].bins] == ["1", "2"]
    assert [set(at.tolist()) for at in axes["run"].places] == [{0}, {1}]


def assert_changes_at(axis: Binned, campaign: Campaign, slow: float, fast: float) -> None:
    """Check that bin 0 contains the rests, and bins 1 to 3 the speeds below, between and above."""
    for p, at in zip(campaign.prepared, axis.places, strict=True):
        speed = np.abs(p.motion.velocity)
        ranges = 1 + (speed >= slow).astype(int) + (speed >= fast)
        assert np.array_equal(at, np.where(p.motion.resting, 0, ranges))


def test_regime_changes_at_0_2_and_1_0_transition_speeds(campaign: Campaign, axes: Axes) -> None:
    axis = axes["regime"]
    assert [b.name for b in axis.bins] == ["at rest", "boundary", "mixed", "full film"]
    assert_changes_at(axis, campaign, 0.2 * U_TR_M_S, U_TR_M_S)


def test_speed_ranges_without_a_film_are_thirds_of_recorded_speeds(campaign: Campaign) -> None:
    axis = axis_of(campaign, "speed range", u_tr=None)
    speeds = np.abs(velocities(campaign))
    slow, fast = np.quantile(speeds[speeds > 0.0], [1 / 3, 2 / 3])
    assert len(axis.bins) == 4
    assert_changes_at(axis, campaign, slow, fast)


def test_velocity_axis_has_12_bins_of_equal_count_in_each_direction(
    campaign: Campaign, axes: Axes
) -> None:
    axis, velocity = axes["velocity"], velocities(campaign)
    at = places(axis)
    assert len(axis.bins) == 24
    assert np.all((at < 0) == (velocity == 0.0))
    for i in range(12):
        backward, forward = -velocity[at == i], velocity[at == i + 12]
        speeds = np.concatenate((backward, forward))
        assert np.all(speeds > 0.0)
        assert len(speeds) == pytest.approx(np.count_nonzero(velocity) / 12, abs=2)
        assert axis.bins[i + 12].centre == pytest.approx(np.median(speeds))
        assert axis.bins[i].centre == pytest.approx(-np.median(speeds))


@pytest.mark.parametrize("speed", [2.2, 0.0375, 1e-7])
def test_velocity_axis_has_one_bin_in_each_direction_at_constant_speed(speed: float) -> None:
    n = 24
    force = 2.0 + 0.1 * np.random.default_rng(1).standard_normal(n)
    run = Run.from_arrays(0.002 * np.arange(n), np.full(n, speed), force)
    axis = axis_of(Campaign.prepare(Rig(), [run]), "velocity", u_tr=None)
    assert [b.centre for b in axis.bins] == pytest.approx([-speed, speed])


def test_acceleration_axis_separates_speeding_up_from_slowing(
    campaign: Campaign, axes: Axes
) -> None:
    """Accelerations below 2 % of the maximum of the run count as steady motion."""
    axis = axes["acceleration"]
    for p, at in zip(campaign.prepared, axis.places, strict=True):
        v, a = p.motion.velocity, p.motion.acceleration
        ignored = (np.abs(a) < 0.02 * np.max(np.abs(a))) | (v == 0.0)
        assert np.array_equal(at < 0, ignored)
        for i in np.flatnonzero(~ignored):
            assert axis.bins[at[i]].name == ("speeding up" if v[i] * a[i] > 0 else "slowing")
            assert axis.bins[at[i]].direction == np.sign(v[i])


def test_angle_is_within_half_a_width_of_its_bin_centre(campaign: Campaign, axes: Axes) -> None:
    axis = axes["angle"]
    assert len(axis.bins) == 48
    centres = np.array([b.centre for b in axis.bins], dtype=float)
    for p, at in zip(campaign.prepared, axis.places, strict=True):
        assert np.array_equal(at < 0, p.motion.resting)
        moving = at >= 0
        distance = np.degrees(p.motion.angle_rad[moving]) - centres[at[moving]]
        assert np.max(np.abs((distance + 180.0) % 360.0 - 180.0)) <= 7.5 + 1e-9


def test_time_axis_has_12_spans_from_the_start_of_each_run(campaign: Campaign, axes: Axes) -> None:
    axis = axes["time"]
    # The longest run takes 59.98 s.
    edges = np.linspace(0.0, 59.98, 13)
    for i, span in enumerate(pairwise(edges.tolist())):
        assert axis.bins[i].span == axis.bins[i + 12].span == pytest.approx(span)
    for p, at in zip(campaign.prepared, axis.places, strict=True):
        span = np.minimum(((p.run.time_s - p.run.time_s[0]) / 59.98 * 12).astype(int), 11)
        expected = np.where(p.motion.velocity > 0, span + 12, span)
        # Rounding may move a sample on an edge into the neighbouring bin.
        assert np.mean(at == expected) > 0.999


def since_last(event: npt.NDArray[np.bool_], measure: Array) -> Array:
    """`measure` since the last event, NaN before the first one, sample by sample."""
    since, last = np.full(len(event), np.nan), math.nan
    for i, happened in enumerate(event):
        last = measure[i] if happened else last
        since[i] = measure[i] - last
    return since


def test_time_since_rest_and_path_since_reversal_match_bins(campaign: Campaign, axes: Axes) -> None:
    seen: dict[str, list[Array]] = {"time since a rest": [], "distance since a reversal": []}
    for number, p in enumerate(campaign.prepared):
        v, time = p.motion.velocity, p.run.time_s
        step = 0.5 * (np.abs(v[1:]) + np.abs(v[:-1])) * np.diff(time)
        path = np.concatenate(([0.0], np.cumsum(step)))
        sign = np.sign(v)
        reversed_ = np.concatenate(([False], (sign[1:] != sign[:-1]) & (v[1:] != 0.0)))
        measured = {
            "time since a rest": since_last(p.motion.resting, time),
            "distance since a reversal": since_last(reversed_, path),
        }
        for name, since in measured.items():
            at = axes[name].places[number]
            known = np.isfinite(since) & (since > 1e-9) & ~p.motion.resting
            assert np.all(at[~np.isfinite(since) | p.motion.resting] == -1)
            for i in np.flatnonzero(known):
                b = axes[name].bins[at[i]]
                assert b.span is not None
                assert b.span[0] - 1e-9 <= since[i] <= b.span[1] + 1e-9
                assert b.direction == (1 if v[i] > 0 else -1)
            seen[name].append(since[known])
    for name, parts in seen.items():
        # Five edges at quantiles give six bins in each direction.
        bins = axes[name].bins
        assert len(bins) == 12
        edges = [b.span[1] for b in bins[:5] if b.span is not None]
        below = [np.mean(np.concatenate(parts) < edge) for edge in edges]
        assert below == pytest.approx([0.05, 0.1, 0.2, 0.4, 0.7], abs=0.02)


def test_samples_before_the_first_reversal_have_no_distance_since_a_reversal() -> None:
    time = 0.02 * np.arange(600)
    forward = time < 6.0
    run = Run.from_arrays(time, np.where(forward, 0.1, -0.1), np.where(forward, 2.0, -2.0))
    campaign = Campaign.prepare(Rig(), [run])
    (at,) = axis_of(campaign, "distance since a reversal").places
    reversal = int(np.flatnonzero(campaign.prepared[0].motion.velocity < 0.0)[0])
    assert np.all(at[: reversal + 1] == -1)
    assert np.all(at[reversal + 1 :] >= 0)


@pytest.mark.parametrize(("count", "exists"), [(99, False), (100, True)])
def test_axis_of_time_since_a_rest_needs_100_samples_after_it(count: int, exists: bool) -> None:
    speed = np.concatenate((np.zeros(40), np.full(count, 0.1)))
    time = 0.02 * np.arange(len(speed))
    run = Run.from_arrays(time, speed, 2.0 + 0.01 * np.cos(time))
    campaign = Campaign.prepare(Rig(), [run])
    last = int(np.flatnonzero(campaign.prepared[0].motion.resting)[-1])
    assert len(time) - 1 - last == count
    found = {axis.axis: axis for axis in all_axes(campaign, U_TR_M_S)}
    assert ("time since a rest" in found) == exists
    if exists:
        since = time[last + 1 :] - time[last]
        edges = np.quantile(since, [0.05, 0.1, 0.2, 0.4, 0.7])
        expected = np.concatenate((np.full(last + 1, -1), 6 + np.digitize(since, edges)))
        assert np.array_equal(found["time since a rest"].places[0], expected)


def test_force_axis_has_sixteen_bins_of_equal_count() -> None:
    forces = np.random.default_rng(3).normal(0.0, 1.0, 1600)
    axis = force_axis([forces[:700], forces[700:]], unit="N m")
    at = np.concatenate(axis.places)
    assert np.bincount(at).tolist() == [100] * 16
    for i, b in enumerate(axis.bins):
        assert b.centre == pytest.approx(np.median(forces[at == i]))
        assert b.unit == "N m"


@pytest.mark.parametrize(("error", "bins"), [(0.0, 16), (0.02, 2)])
def test_force_axis_merges_bins_whose_differences_are_below_the_force_error(
    error: float, bins: int
) -> None:
    """The force at a drive's limit is constant; more bins would separate signs of its error."""
    rng = np.random.default_rng(1)
    forces = np.repeat([-3.5, 3.5], 800) + 0.02 * rng.normal(size=1600)
    assert len(force_axis([forces], error).bins) == bins


def test_force_axis_keeps_bins_that_are_wider_than_the_error_of_the_forces() -> None:
    forces = np.linspace(-10.0, 10.0, 1600)
    assert len(force_axis([forces], 0.02).bins) == 16
