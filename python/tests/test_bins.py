"""Bins are data: their words are made of it, and pictures and patterns take it, not the words."""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
import pytest
from jbf import Fit, Rig, Run, compare
from jbf.comparison.axes import all_axes
from jbf.comparison.bins import Axis, Bin, Binned, Direction, direction_words, label
from jbf.comparison.patterns import Failure, pattern_words
from jbf.estimation.campaign import Campaign
from jbf.plot.bin_axes import bin_axis

WORDS: list[tuple[Axis, Bin, str]] = [
    ("direction", Bin(direction=-1), "v < 0"),
    ("velocity", Bin(centre=-0.0512, unit="m/s", direction=-1), "v = -0.0512 m/s"),
    ("velocity", Bin(centre=0.0512, unit="m/s", direction=1), "v = +0.0512 m/s"),
    ("regime", Bin("boundary"), "boundary"),
    ("acceleration", Bin("slowing", direction=1), "slowing, v > 0"),
    ("angle", Bin(centre=7.5, unit="deg", direction=-1), "angle 8 deg, v < 0"),
    ("time", Bin(span=(2.0, 4.0), unit="s", direction=-1, with_rest=True), "2 to 4 s, v <= 0"),
    (
        "time since a rest",
        Bin(span=(-math.inf, 0.1), unit="s", direction=1),
        "up to 0.1 s after a rest, v > 0",
    ),
    (
        "distance since a reversal",
        Bin(span=(0.01, 0.025), unit="m", direction=-1),
        "0.01 to 0.025 m after a reversal, v < 0",
    ),
    (
        "time since a rest",
        Bin(span=(2.0, math.inf), unit="s", direction=1),
        "over 2 s after a rest, v > 0",
    ),
    ("run", Bin("2_stops"), "run 2_stops"),
    ("force", Bin(centre=3.14, unit="N"), "f = +3.14 N"),
    ("force", Bin("none"), "none"),
    # Only along some axes is a centre what a bin is called by.
    ("run", Bin("b", centre=2.0), "run b"),
]


@pytest.mark.parametrize(("axis", "b", "words"), WORDS)
def test_words_of_a_bin(axis: Axis, b: Bin, words: str) -> None:
    assert label(axis, b) == words


def test_a_bin_moves_backwards_either_way_or_forwards() -> None:
    assert get_args(Direction) == (-1, 0, 1)
    words = [direction_words(Bin(direction=way)) for way in (-1, 0, 1)]
    assert words == ["v < 0", "", "v > 0"]
    assert direction_words(Bin(direction=-1, with_rest=True)) == "v <= 0"


def _failure(axis: Axis, *bins: Bin) -> Failure:
    return Failure(axis, "", 0.5, bins, np.zeros(len(bins)), np.ones(len(bins), dtype=np.intp))


def test_a_run_may_be_called_what_it_will() -> None:
    place = bin_axis(_failure("run", Bin("up to 5 s, v > 0"), Bin("v = -1 m/s")))
    assert place.ticks == ("up to 5 s, v > 0", "v = -1 m/s")
    assert place.series == ("", "")


def test_numbers_stand_where_they_are_not_where_words_round_them_to() -> None:
    spans = [Bin(span=(0.0, 2.3), unit="s", direction=d, with_rest=d < 0) for d in (-1, 1)]
    place = bin_axis(_failure("time", *spans))
    assert place.x.tolist() == [1.15, 1.15]
    assert place.series == ("v <= 0", "v > 0")
    assert place.ticks == ()


def test_both_ways_of_one_place_stand_above_one_another() -> None:
    ends = [(-math.inf, 0.1), (0.1, math.inf)]
    bins = [Bin(span=end, unit="s", direction=d) for d in (-1, 1) for end in ends]
    place = bin_axis(_failure("time since a rest", *bins))
    assert place.x.tolist() == [0.0, 1.0, 0.0, 1.0]
    assert place.ticks == ("up to\n0.1 s", "over\n0.1 s")


def _words(axis: Axis, bins: list[Bin], means: list[float]) -> str:
    counts = np.full(len(bins), 100)
    return pattern_words(Binned(axis, tuple(bins), []), np.array(means), counts)


def test_a_pattern_says_which_way_the_record_is_off() -> None:
    ways = [Bin(direction=-1), Bin(direction=1)]
    assert _words("direction", ways, [-2.0, 2.0]) == (
        "all of direction, sign of v: record above the model by 2 N in the direction of motion; "
        "most -2 N at v < 0; +2 N at v > 0"
    )
    assert "record below the model by 2 N" in _words("direction", ways, [2.0, -2.0])
    assert "one sign throughout: record minus model +2 N" in _words("direction", ways, [2.0, 2.0])


def test_runs_called_after_directions_have_none() -> None:
    runs = [Bin("v > 0"), Bin("v < 0")]
    assert _words("run", runs, [2.0, -1.0]) == "most +2 N at run v > 0; -1 N at run v < 0"


def test_a_pattern_of_very_many_bins_has_words() -> None:
    runs = [Bin(str(i)) for i in range(80)]
    assert _words("run", runs, [1.0] * 80).startswith("all of run, one sign throughout")


def test_a_pattern_in_two_of_ten_bins_is_not_one_of_all() -> None:
    runs = [Bin(str(i)) for i in range(10)]
    words = _words("run", runs, [2.0, 1.5, *[0.01] * 8])
    assert words.startswith("one sign throughout: record minus model +1.8 N; most +2 N at run 0")
    # Of nine in ten it is.
    assert _words("run", runs, [2.0] * 9 + [0.01]).startswith("all of run, one sign")


def test_samples_go_into_the_bin_of_their_motion(bare_fit: Fit, runs: list[Run]) -> None:
    comparison = compare(bare_fit.model, runs)
    for axis in all_axes(comparison.campaign, 0.055):
        for p, places in zip(comparison.campaign.prepared, axis.places, strict=True):
            v = p.motion.velocity_m_s
            for i, b in enumerate(axis.bins):
                if b.direction > 0:
                    assert np.all(v[places == i] > 0.0)
                elif b.direction < 0 and not b.with_rest:
                    assert np.all(v[places == i] < 0.0)


@pytest.mark.parametrize("speed", [2.2, 0.0375, 1e-7])
def test_one_speed_is_one_bin(speed: float) -> None:
    n = 24
    force = 2.0 + 0.1 * np.random.default_rng(1).standard_normal(n)
    run = Run.from_arrays(0.002 * np.arange(n), np.full(n, speed), force)
    axes = {axis.axis: axis for axis in all_axes(Campaign.prepare(Rig(), [run]), None)}
    centres = [b.centre for b in axes["velocity"].bins]
    assert centres == pytest.approx([-speed, speed])
