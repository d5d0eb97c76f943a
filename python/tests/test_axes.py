"""Every sample stands in the bin that its motion says, sample by sample."""

from __future__ import annotations

import math
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf import Model, Rig, Run, compare
from jbf.comparison.axes import all_axes, force_axis
from jbf.comparison.bins import Bin, Binned
from jbf.comparison.patterns import find_failures, pattern_along, pattern_words
from jbf.estimation.campaign import Campaign
from made_of import record

U_TR = 0.05


def moved(seed: int, seconds: float, starts: float = 0.0) -> Run:
    """To and fro at many speeds, at rest now and then."""
    time = starts + np.arange(0.0, seconds, 0.02)
    speed = 0.12 * np.sin(0.9 * time) * np.sin(0.23 * time + 0.3 * seed)
    speed[np.sin(0.31 * time + seed) > 0.93] = 0.0
    path = np.concatenate(([0.0], np.cumsum(0.01 * (speed[1:] + speed[:-1]))))
    random = np.random.default_rng(seed)
    force = 20.0 * np.sign(speed) + random.normal(0.0, 0.3, len(time))
    return Run.from_arrays(time, speed, force, angle_rad=path / 0.0127, name=f"{seed}")


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return Campaign.prepare(Rig.thesis(), [moved(1, 60.0), moved(2, 41.0, starts=100.0)])


@pytest.fixture(scope="module")
def axes(campaign: Campaign) -> dict[str, Binned]:
    return {axis.axis: axis for axis in all_axes(campaign, U_TR)}


def expected_place(axis: Binned, value: float, direction: int) -> int:
    """The bin whose span, or whose centre by half a width, holds a value."""
    for i, b in enumerate(axis.bins):
        if b.direction == direction and b.span is not None and b.span[0] <= value < b.span[1]:
            return i
    raise AssertionError((axis.axis, value))


def test_each_axis_is_there_once(axes: dict[str, Binned]) -> None:
    assert list(axes) == [
        "direction",
        "velocity",
        "regime",
        "acceleration",
        "time",
        "run",
        "angle",
        "time since a rest",
        "distance since a reversal",
    ]


def test_direction_regime_and_run(campaign: Campaign, axes: dict[str, Binned]) -> None:
    for number, p in enumerate(campaign.prepared):
        assert set(axes["run"].places[number].tolist()) == {number}
        for i, v in enumerate(p.motion.velocity_m_s.tolist()):
            at = axes["direction"].places[number][i]
            assert (0 if at < 0 else axes["direction"].bins[at].direction) == np.sign(v)
            regime = axes["regime"].bins[axes["regime"].places[number][i]].name
            if p.motion.resting[i]:
                assert regime == "at rest"
            else:
                # Below a fifth of U_tr the asperities carry most of the load.
                low, high = abs(v) >= 0.2 * U_TR, abs(v) >= U_TR
                assert regime == ("boundary", "mixed", "full film")[low + high]


def test_a_sample_without_a_bin_has_the_place_minus_one(axes: dict[str, Binned]) -> None:
    for axis in axes.values():
        at = np.concatenate(axis.places)
        assert np.min(at) >= -1
        assert np.max(at) < len(axis.bins)


def test_each_bin_says_which_way_its_samples_move(
    campaign: Campaign, axes: dict[str, Binned]
) -> None:
    """First those backwards, then the same forwards; regimes and runs hold both."""
    for name, axis in axes.items():
        ways = [b.direction for b in axis.bins]
        half = len(ways) // 2
        assert ways == (
            [0] * len(ways) if name in ("regime", "run") else [-1] * half + [1] * half
        ), name
        v = np.concatenate([p.motion.velocity_m_s for p in campaign.prepared])
        at = np.concatenate(axis.places)
        for i, b in enumerate(axis.bins):
            if b.direction:
                assert -b.direction not in np.sign(v[at == i]), (name, i)
            assert b.with_rest == (name == "time" and b.direction < 0)


def test_units_are_those_of_the_rig(axes: dict[str, Binned]) -> None:
    units = {name: {b.unit for b in axis.bins} for name, axis in axes.items()}
    assert units == {
        "direction": {""},
        "velocity": {"m/s"},
        "regime": {""},
        "acceleration": {""},
        "time": {"s"},
        "run": {""},
        "angle": {"deg"},
        "time since a rest": {"s"},
        "distance since a reversal": {"m"},
    }
    assert {axis.force_unit for axis in axes.values()} == {"N"}


def test_a_law_without_a_film_has_thirds_of_the_speeds_on_record(campaign: Campaign) -> None:
    axis = next(a for a in all_axes(campaign, None) if a.axis == "speed range")
    speeds = [np.abs(p.motion.velocity_m_s) for p in campaign.prepared]
    moving = np.concatenate(speeds)
    slow, fast = np.quantile(moving[moving > 0.0], [1 / 3, 2 / 3])
    assert [b.name for b in axis.bins] == [
        "at rest",
        f"slow (to {slow:.2g} m/s)",
        "medium",
        f"fast (over {fast:.2g} m/s)",
    ]
    for p, places, speed in zip(campaign.prepared, axis.places, speeds, strict=True):
        wanted = np.where(p.motion.resting, 0, 1 + (speed >= slow).astype(int) + (speed >= fast))
        assert np.array_equal(places, wanted)


def test_speeds_fall_into_twelve_bins_of_as_many_samples(
    campaign: Campaign, axes: dict[str, Binned]
) -> None:
    axis = axes["velocity"]
    v = np.concatenate([p.motion.velocity_m_s for p in campaign.prepared])
    at = np.concatenate(axis.places)
    assert len(axis.bins) == 24
    assert np.all((at < 0) == (v == 0.0))
    moving = np.count_nonzero(v)
    for i in range(12):
        back, forth = v[at == i], v[at == i + 12]
        assert np.all(back < 0.0)
        assert np.all(forth > 0.0)
        sizes = np.abs(np.concatenate((back, forth)))
        assert len(sizes) == pytest.approx(moving / 12, abs=2)
        assert axis.bins[i + 12].centre == pytest.approx(np.median(sizes))
        assert axis.bins[i].centre == pytest.approx(-np.median(sizes))


def test_slowing_down_and_speeding_up(campaign: Campaign, axes: dict[str, Binned]) -> None:
    axis = axes["acceleration"]
    for number, p in enumerate(campaign.prepared):
        v, a = p.motion.velocity_m_s, p.motion.acceleration_m_s2
        steady = np.abs(a) < 0.02 * np.max(np.abs(a))
        for i, place in enumerate(axis.places[number].tolist()):
            assert (place < 0) == (v[i] == 0.0 or bool(steady[i]))
            if place >= 0:
                assert axis.bins[place].name == ("speeding up" if v[i] * a[i] > 0 else "slowing")
                assert axis.bins[place].direction == np.sign(v[i])


def test_angle_within_half_a_width_of_its_centre(
    campaign: Campaign, axes: dict[str, Binned]
) -> None:
    axis = axes["angle"]
    assert len(axis.bins) == 48
    for number, p in enumerate(campaign.prepared):
        for i, place in enumerate(axis.places[number].tolist()):
            assert (place < 0) == bool(p.motion.resting[i])
            if place >= 0:
                degrees = math.degrees(p.motion.angle_rad[i]) - axis.bins[place].centre
                assert abs((degrees + 180.0) % 360.0 - 180.0) <= 7.5 + 1e-9
                assert axis.bins[place].direction == (-1 if p.motion.velocity_m_s[i] < 0 else 1)


def test_time_is_counted_from_the_first_sample(campaign: Campaign, axes: dict[str, Binned]) -> None:
    axis = axes["time"]
    # Twelve spans of the longest run.
    assert [b.span for b in axis.bins[:12]] == [
        pytest.approx((59.98 * i / 12, 59.98 * (i + 1) / 12)) for i in range(12)
    ]
    for number, p in enumerate(campaign.prepared):
        for i, place in enumerate(axis.places[number].tolist()[:-1]):
            since = p.run.time_s[i] - p.run.time_s[0]
            assert place == expected_place(axis, since, 1 if p.motion.velocity_m_s[i] > 0 else -1)


def test_since_a_rest_and_since_a_reversal(campaign: Campaign, axes: dict[str, Binned]) -> None:
    rest, turn = axes["time since a rest"], axes["distance since a reversal"]
    # Five edges at quantiles part six bins, once each way.
    assert len(rest.bins) == len(turn.bins) == 12
    waits: list[float] = []
    ways: list[float] = []
    for number, p in enumerate(campaign.prepared):
        v, time = p.motion.velocity_m_s.tolist(), p.run.time_s.tolist()
        rested = turned = None
        path = 0.0
        for i in range(len(v)):
            if i:
                path += 0.5 * (abs(v[i]) + abs(v[i - 1])) * (time[i] - time[i - 1])
                if v[i] != 0.0 and np.sign(v[i]) != np.sign(v[i - 1]):
                    turned = path
            if p.motion.resting[i]:
                rested = time[i]
            for axis, last, now, seen in (
                (rest, rested, time[i], waits),
                (turn, turned, path, ways),
            ):
                place = axis.places[number][i]
                if last is None or now - last <= 1e-12 or p.motion.resting[i]:
                    assert place == -1
                elif abs(now - last) > 1e-9:
                    seen.append(now - last)
                    low, high = axis.bins[place].span or (math.nan, math.nan)
                    assert low - 1e-9 <= now - last <= high + 1e-9
                    assert axis.bins[place].direction == (1 if v[i] > 0 else -1)
    for axis, seen in ((rest, waits), (turn, ways)):
        edges = [b.span[1] for b in axis.bins[:5] if b.span is not None]
        below = [np.mean(np.array(seen) < edge) for edge in edges]
        assert below == pytest.approx([0.05, 0.1, 0.2, 0.4, 0.7], abs=0.02)


def test_forces_fall_into_sixteen_bins_of_as_many_samples() -> None:
    forces = np.random.default_rng(3).normal(0.0, 1.0, 1600)
    axis = force_axis([forces[:700], forces[700:]], "N m")
    at = np.concatenate(axis.places)
    assert np.bincount(at).tolist() == [100] * 16
    for i, b in enumerate(axis.bins):
        assert b.centre == pytest.approx(np.median(forces[at == i]))
        assert b.unit == "N m"


def test_forces_of_few_values_are_few_bins() -> None:
    """Two forces part in two bins; below the least of them there is none."""
    forces = np.repeat([1.0, 3.0], 40)
    axis = force_axis([forces])
    filled = {i: b for i, b in enumerate(axis.bins) if np.any(axis.places[0] == i)}
    assert [b.centre for b in filled.values()] == [1.0, 3.0]
    empty = [b for i, b in enumerate(axis.bins) if i not in filled]
    assert empty
    assert {(b.name, b.centre) for b in empty} == {("none", None)}
    assert (axis.force_unit, filled.popitem()[1].unit) == ("N", "N")


def test_before_the_first_reversal_there_is_no_way_since_one() -> None:
    """A run that moves from its first sample has not turned round there."""
    time = 0.02 * np.arange(600)
    run = Run.from_arrays(time, np.where(time < 6.0, 0.1, -0.1), np.where(time < 6.0, 2.0, -2.0))
    campaign = Campaign.prepare(Rig(), [run])
    axis = next(a for a in all_axes(campaign, U_TR) if a.axis == "distance since a reversal")
    turned = int(np.flatnonzero(campaign.prepared[0].motion.velocity_m_s < 0.0)[0])
    assert np.all(axis.places[0][: turned + 1] == -1)
    assert np.all(axis.places[0][turned + 1 :] >= 0)


@pytest.mark.parametrize(("count", "there"), [(99, False), (100, True)])
def test_a_hundred_samples_after_a_rest_are_an_axis(count: int, there: bool) -> None:
    """Counted from the last sample at rest; a run that sets out from rest has it at its start."""
    speed = np.concatenate((np.zeros(40), np.full(count, 0.1)))
    time = 0.02 * np.arange(len(speed))
    run = Run.from_arrays(time, speed, 2.0 + 0.01 * np.cos(time))
    campaign = Campaign.prepare(Rig(), [run])
    (p,) = campaign.prepared
    last = int(np.flatnonzero(p.motion.resting)[-1])
    assert len(time) - 1 - last == count
    made = {a.axis: a for a in all_axes(campaign, U_TR)}
    assert ("time since a rest" in made) == there
    if there:
        axis = made["time since a rest"]
        since = time[last + 1 :] - time[last]
        edges = np.quantile(since, [0.05, 0.1, 0.2, 0.4, 0.7]).tolist()
        ends = [-math.inf, *edges, math.inf]
        assert [b.span for b in axis.bins[6:]] == [pytest.approx(pair) for pair in pairwise(ends)]
        wanted = np.concatenate((np.full(last + 1, -1), 6 + np.digitize(since, edges)))
        assert np.array_equal(axis.places[0], wanted)


def test_a_rest_of_the_first_sample_alone_is_one() -> None:
    p = record(0.02 * np.arange(201.0), resting=np.arange(201) == 0)
    p.motion.acceleration_m_s2 = np.zeros(201)
    campaign: Any = SimpleNamespace(prepared=(p,), rig=Rig(), has_angle=False)
    axis = next(a for a in all_axes(campaign, U_TR) if a.axis == "time since a rest")
    since = p.run.time_s[1:]
    edges = np.quantile(since, [0.05, 0.1, 0.2, 0.4, 0.7])
    assert axis.places[0].tolist() == [-1, *(6 + np.digitize(since, edges)).tolist()]


def test_few_samples_after_events_are_no_axis() -> None:
    short = [moved(1, 1.5)]
    named = [a.axis for a in all_axes(Campaign.prepare(Rig.thesis(), short), U_TR)]
    assert "time since a rest" not in named


@pytest.mark.parametrize("scale", [1e-4, 1.0, 1e4])
def test_a_pattern_is_the_same_in_another_unit(scale: float) -> None:
    means = np.array([0.01, 1.0, -2.0, 0.02])
    axis = Binned("run", tuple(Bin(name) for name in "abcd"), [])
    words = pattern_words(axis, scale * means, np.full(4, 50))
    assert words == f"most {-2 * scale:+.2g} N at run c; {scale:+.2g} N at run b"


def test_a_pattern_stands_above_chance_or_is_none(campaign: Campaign) -> None:
    """Of pure noise none; of noise and a step between runs the share is what it explains."""
    random = np.random.default_rng(5)
    samples = campaign.samples
    noise = [random.normal(0.0, 1.0, len(p.run)) for p in campaign.prepared]
    assert find_failures(campaign, samples, noise, U_TR, 1.0) == ()
    step = [r + level for r, level in zip(noise, (0.5, -0.5), strict=True)]
    found = find_failures(campaign, samples, step, U_TR, 1.0)
    assert found[0].axis == "run"
    # A quarter of the mean square 1.25 is the step's.
    assert found[0].share == pytest.approx(0.2, abs=0.03)
    assert found[0].means_n == pytest.approx([0.5, -0.5], abs=0.1)
    assert [f.share for f in found] == sorted((f.share for f in found), reverse=True)


def test_the_least_that_is_told_is_six_deviations_and_a_hundredth(campaign: Campaign) -> None:
    axis = next(a for a in all_axes(campaign, U_TR) if a.axis == "run")
    samples = campaign.samples
    flat = [np.ones(len(p.run)) for p in campaign.prepared]

    def told(explained_over_noise: float) -> bool:
        """Two bins; all of the mean square is explained."""
        noise = math.sqrt(samples.count / explained_over_noise)
        return pattern_along(axis, samples, flat, noise) is not None

    # Chance explains two variances, give or take 2: six times that is told.
    assert told(2.0 + 6.0 * 2.0 + 0.01)
    assert not told(2.0 + 6.0 * 2.0 - 0.01)
    assert pattern_along(axis, samples, flat, 1e-9, least_share=0.999) is not None
    assert pattern_along(axis, samples, [0.0 * r for r in flat], 1e-9) is None


def test_samples_beside_jumps_count_unless_the_model_moves_them(campaign: Campaign) -> None:
    runs = [p.run for p in campaign.prepared]
    bare = compare(Model(Rig.thesis()), runs)
    assert bare.samples is bare.campaign.samples
    late = compare(
        Model(Rig.thesis(), effects=["time_delay"], parameters={"time_delay.tau_s": 0.05}), runs
    )
    assert late.samples.count < bare.samples.count


def test_no_axis_divides_by_a_speed_of_zero(campaign: Campaign) -> None:
    assert any(np.any(p.motion.velocity_m_s == 0.0) for p in campaign.prepared)
    with np.errstate(all="raise"):
        assert len(all_axes(campaign, U_TR)) == 9


def test_a_sample_without_speed_that_does_not_rest_counts_as_backwards() -> None:
    """As it turns round: since the rest before it is known, which way it moves is not."""
    n = np.arange(201)
    v = np.where(n == 100, 0.0, 0.1)
    p = record(0.02 * n.astype(float), velocity=v, resting=n == 0)
    p.motion.acceleration_m_s2 = np.zeros(201)
    campaign: Any = SimpleNamespace(prepared=(p,), rig=Rig(), has_angle=False)
    axis = next(a for a in all_axes(campaign, U_TR) if a.axis == "time since a rest")
    ways = [axis.bins[place].direction for place in axis.places[0][1:]]
    assert ways == [1] * 99 + [-1] + [1] * 100


def test_less_than_a_fiftieth_of_the_largest_acceleration_is_steady() -> None:
    """Of 50 m/s^2 one is just a fiftieth."""
    a = np.array([50.0, 1.0, np.nextafter(1.0, 0.0), -1.0, -50.0, 0.0])
    p = record(0.02 * np.arange(6.0))
    p.motion.acceleration_m_s2 = a
    campaign: Any = SimpleNamespace(prepared=(p,), rig=Rig(), has_angle=False)
    axis = next(x for x in all_axes(campaign, U_TR) if x.axis == "acceleration")
    names = [axis.bins[i].name if i >= 0 else "" for i in axis.places[0]]
    assert names == ["speeding up", "speeding up", "", "slowing", "slowing", ""]


def test_an_angle_that_rounds_to_a_whole_turn_is_in_the_last_bin() -> None:
    """Just below zero is just below 360 degrees, which no number near it says."""
    way = np.array([-1e-18, 0.0, np.pi, 0.1])
    v = np.array([0.1, 0.1, -0.1, 0.0])
    p = record(0.02 * np.arange(4.0), way=way, velocity=v)
    p.motion.acceleration_m_s2 = np.zeros(4)
    campaign: Any = SimpleNamespace(prepared=(p,), rig=Rig(), has_angle=True)
    axis = next(x for x in all_axes(campaign, U_TR) if x.axis == "angle")
    assert np.mod(way[0], 2.0 * np.pi) == 2.0 * np.pi
    bins = [axis.bins[i] for i in axis.places[0]]
    assert [b.centre for b in bins] == pytest.approx([352.5, 7.5, 187.5, 7.5])
    # What neither rests nor moves backwards is with what moves forwards.
    assert [b.direction for b in bins] == [1, 1, -1, 1]
