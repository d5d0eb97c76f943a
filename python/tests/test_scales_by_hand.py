"""Sizes of a campaign of a few samples, each worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf import InputError, Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.scales import Scales, moving_samples, scales
from made_of import record, samples_of

SPEEDS = np.arange(1.0, 12.0)


def of(*runs: Any, counted: list[Array] | None = None) -> Any:
    return SimpleNamespace(prepared=list(runs), samples=samples_of(runs, counted))


def each_second(velocity: Array, force: Array) -> Any:
    return record(np.arange(float(len(velocity))), velocity=velocity, friction=force)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_sizes_of_a_line_over_eleven_speeds(way: float) -> None:
    """30 N and 2 N s/m at 1 m/s to 11 m/s: a tenth lies below 2 m/s, half below 6; the halves meet
    at 6 m/s and have their middles at 3.5 m/s and 8.5 m/s."""
    found = scales(of(each_second(way * SPEEDS, way * (30.0 + 2.0 * SPEEDS))))
    assert found == Scales(
        whole_n=42.0,
        kinetic_n=pytest.approx(30.0),
        viscous_n_s_m=2.0,
        # Nine tenths of the way from 32 N to 42 N.
        breakaway_n=pytest.approx(41.0),
        slow_m_s=2.0,
        usual_m_s=6.0,
        stroke_m=60.0,
        resolved_m=pytest.approx(0.2),
    )


def test_what_does_not_count_sets_no_size() -> None:
    v, f = np.append(SPEEDS, 7.0), np.append(30.0 + 2.0 * SPEEDS, 1e6)
    found = scales(of(each_second(v, f), counted=[np.arange(12) < 11]))
    assert (found.whole_n, found.viscous_n_s_m, found.usual_m_s) == (42.0, 2.0, 6.0)


@pytest.mark.parametrize(("fast", "slope"), [(6.0, 0.0), (6.5, 4.0 / 1.5), (4.9, 0.0)])
def test_speeds_within_a_fifth_tell_no_slope(fast: float, slope: float) -> None:
    """10 N at 5 m/s and 14 N at another speed."""
    v = np.repeat([5.0, fast], 5)
    found = scales(of(each_second(v, np.where(v == 5.0, 10.0, 14.0))))
    assert found.viscous_n_s_m == pytest.approx(slope)


def test_friction_that_falls_is_as_high_as_its_slow_half() -> None:
    """No slope is below nothing; and half of the median friction is there in any case."""
    found = scales(of(each_second(SPEEDS, 40.0 - 2.0 * SPEEDS)))
    assert (found.viscous_n_s_m, found.kinetic_n) == (0.0, 33.0)
    # A tenth above that, which is more than nine tenths of the slow half have.
    assert found.breakaway_n == pytest.approx(max(37.0, 36.3))
    flat = scales(of(each_second(SPEEDS, np.full(11, 8.0))))
    assert (flat.kinetic_n, flat.breakaway_n) == (8.0, pytest.approx(8.8))
    steep = scales(of(each_second(SPEEDS, 1.0 + 10.0 * SPEEDS)))
    assert (steep.whole_n, steep.kinetic_n) == (61.0, 30.5)


@pytest.mark.filterwarnings("error")
def test_sizes_of_next_to_nothing_are_not_nothing() -> None:
    found = scales(of(each_second(1e-12 * np.ones(9), np.zeros(9))))
    assert (found.whole_n, found.kinetic_n) == (1e-5, 5e-6)
    assert (found.slow_m_s, found.usual_m_s, found.stroke_m) == (1e-9, 1e-9, 1e-9)


@pytest.mark.parametrize(
    ("step_s", "resolved_m"),
    [(1.0, 0.2), (2.0, 0.4), (3.0, 0.6), (50.0, 0.6), (1e-6, 6e-6), (1e-9, 6e-6)],
)
def test_a_way_is_resolved_by_steps_within_a_hundredth_of_a_stroke(
    step_s: float, resolved_m: float
) -> None:
    """A tenth of the slow speed's way from sample to sample; a ten-millionth of a stroke at
    least."""
    run = each_second(SPEEDS, np.ones(11))
    run.step_s = step_s
    assert scales(of(run)).resolved_m == pytest.approx(resolved_m)


def strokes(*seconds: int) -> Array:
    """There and back at 1 m/s, a sample each second: each way is so long, in m."""
    parts = [np.full(n + 1, 1.0 if k % 2 else -1.0) for k, n in enumerate(seconds)]
    return np.concatenate(parts)


@pytest.mark.parametrize(
    ("seconds", "stroke_m"),
    [
        # The first way, and the last, are cut off.
        ((3, 10, 6, 8, 5), 8.0),
        ((3, 10, 6, 5), 8.0),
        # A tenth of the longest is a stroke, less is none.
        ((3, 10, 1, 10, 1, 5), 5.5),
        ((3, 20, 1, 20, 1, 5), 20.0),
        # One that only turns once, or not at all, is as long as the whole way.
        ((4, 9), 9.0),
        ((7,), 7.0),
    ],
)
def test_strokes_go_from_reversal_to_reversal(seconds: tuple[int, ...], stroke_m: float) -> None:
    v = strokes(*seconds)
    assert scales(of(each_second(v, 5.0 * v))).stroke_m == pytest.approx(stroke_m)


def test_strokes_of_all_runs_are_taken_together() -> None:
    runs = [each_second(v, 5.0 * v) for v in (strokes(2, 4, 2), strokes(2, 6, 9, 2))]
    assert scales(of(*runs)).stroke_m == pytest.approx(6.0)


def test_a_fiftieth_of_the_top_speed_is_no_motion() -> None:
    v = np.full(200, 1.0)
    v[[10, 20, 30]] = 0.02, 0.0201, -0.02
    # A single reading is no top speed.
    v[40] = 100.0
    v[50] = 0.5
    run = each_second(v, v)
    run.motion.resting[50] = True
    (moving,) = moving_samples(of(run))
    assert np.flatnonzero(~moving).tolist() == [10, 30, 50]


def test_of_a_drive_that_hardly_ever_moves_the_top_is_its_highest_speed() -> None:
    v = np.zeros(400)
    v[[7, 8]] = 1.0, 0.01
    (moving,) = moving_samples(of(each_second(v, v)))
    assert np.flatnonzero(moving).tolist() == [7]


def test_where_nothing_counts_the_first_run_is_named() -> None:
    t = np.arange(0.0, 10.0, 0.02)
    v = 0.1 * np.sin(t)
    runs = [Run.from_arrays(t, v, np.sign(v) + k, name=f"{k}") for k in range(3)]
    runs[1:] = [replace(run, path=Path("later.csv")) for run in runs[1:]]
    campaign = Campaign.prepare(Rig(), runs)
    nothing = campaign.without([np.ones(len(p.run), dtype=bool) for p in campaign.prepared])
    with pytest.raises(InputError) as refused:
        scales(nothing)
    assert (refused.value.file, refused.value.column) == ("0", "velocity_m_s")
