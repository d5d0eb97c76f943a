"""Bins of an axis: labels, and positions in a plot."""

import math

import numpy as np
import pytest
from by_hand import LAW, along, there_and_back
from jbf import Model, Rig, compare
from jbf.comparison.axes import all_axes
from jbf.comparison.bins import Axis, Bin, Binned, label
from jbf.comparison.patterns import Failure
from jbf.plot.bin_axes import bin_axis

INF = math.inf
REST: Axis = "time since a rest"
AFTER = " after a reversal, v < 0"
PATH: Axis = "distance since a reversal"


@pytest.mark.parametrize(
    ("axis", "b", "expected"),
    [
        ("direction", Bin(direction=-1), "v < 0"),
        ("velocity", Bin(centre=-0.0512, unit="m/s", direction=-1), "v = -0.0512 m/s"),
        ("velocity", Bin(centre=0.0512, unit="m/s", direction=1), "v = +0.0512 m/s"),
        ("regime", Bin("boundary"), "boundary"),
        ("acceleration", Bin("slowing", direction=1), "slowing, v > 0"),
        ("angle", Bin(centre=7.5, unit="deg", direction=-1), "angle 8 deg, v < 0"),
        ("time", Bin(span=(2.0, 4.0), unit="s", direction=-1, with_rest=True), "2 to 4 s, v <= 0"),
        (REST, Bin(span=(-INF, 0.1), unit="s", direction=1), "up to 0.1 s after a rest, v > 0"),
        (PATH, Bin(span=(0.01, 0.02), unit="m", direction=-1), "0.01 to 0.02 m" + AFTER),
        (REST, Bin(span=(2.0, INF), unit="s", direction=1), "over 2 s after a rest, v > 0"),
        ("run", Bin("2_stops"), "run 2_stops"),
        ("force", Bin(centre=3.14, unit="N"), "f = +3.14 N"),
    ],
)
def test_bin_label_states_position_unit_and_direction(axis: Axis, b: Bin, expected: str) -> None:
    assert label(axis, b) == expected
    assert Binned(axis, (b,), []).labels == (expected,)


def failure_of(axis: Axis, *bins: Bin) -> Failure:
    """A failure with the given bins and one sample in each."""
    return Failure(axis, "", 0.5, bins, np.zeros(len(bins)), np.ones(len(bins), dtype=np.intp))


def test_bins_with_a_span_are_drawn_at_its_middle() -> None:
    spans = [Bin(span=(0.0, 2.3), unit="s", direction=d, with_rest=d < 0) for d in (-1, 1)]
    place = bin_axis(failure_of("time", *spans))
    assert place.x.tolist() == [1.15, 1.15]
    assert place.series == ("v <= 0", "v > 0")
    assert place.ticks == ()


def test_half_open_spans_of_both_directions_share_a_tick_label() -> None:
    ends = [(-math.inf, 0.1), (0.1, math.inf)]
    bins = [Bin(span=end, unit="s", direction=d) for d in (-1, 1) for end in ends]
    place = bin_axis(failure_of(REST, *bins))
    assert place.x.tolist() == [0.0, 1.0, 0.0, 1.0]
    assert place.ticks == ("up to\n0.1 s", "over\n0.1 s")


def test_bins_of_one_plot_series_have_different_abscissae() -> None:
    comparison = compare(Model(Rig(), "coulomb", parameters=LAW), there_and_back(along(1.0)))
    for axis in all_axes(comparison.campaign, 0.1):
        place = bin_axis(failure_of(axis.axis, *axis.bins))
        assert place.name
        assert np.all(np.isfinite(place.x))
        assert len({*zip(place.x, place.series, strict=True)}) == len(axis.bins)
        assert bool(place.ticks) == (axis.axis not in ("velocity", "angle", "time"))
