"""Data of the plots: thinned series, density of samples, selections."""

import base64

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.errors import InputError
from jbf.workbench import views
from jbf.workbench.plane import Frame, shade, within
from jbf.workbench.series import listed
from jbf.workbench.session import Session
from jbf.workbench.thinning import Stretch, ranges_of, thinned


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.integers(1, 5000), st.integers(1, 800), st.integers(0, 10))
def test_thinned_series_keeps_minimum_and_maximum(samples: int, pixels: int, seed: int) -> None:
    y = np.random.default_rng(seed).normal(size=samples)
    time = np.arange(samples) * 0.02
    stretch = Stretch.between(time, time[0], time[-1], pixels)
    result = thinned(time, {"y": y}, stretch)
    assert len(result["time_s"]) == len(result["y"]) <= max(2 * pixels + 2, 2 * pixels)
    assert result["y"].min() == y.min()
    assert result["y"].max() == y.max()
    assert np.all(np.diff(result["time_s"]) >= 0.0)
    # Each pair lies within its group of samples.
    if stretch.stride > 2:
        k = int(np.argmax(y)) // stretch.stride
        assert result["y"][2 * k : 2 * k + 2].max() == y.max()


SIZE = (100, 80)
BOX = (-0.02, 0.02, -20.0, 0.0)


def test_thinned_series_has_null_values_in_a_gap() -> None:
    y = np.ones(1000)
    y[400:600] = np.nan
    result = thinned(np.arange(1000.0), {"y": y}, Stretch(0, 1000, 100))
    assert np.all(np.isnan(result["y"][84:116]))
    assert listed(result["y"])[90] is None


def test_zoomed_interval_includes_one_sample_beyond_each_end() -> None:
    time = np.arange(100.0)
    assert Stretch.between(time, 10.5, 20.5, 500) == Stretch(10, 22, 500)
    assert Stretch.between(time, -5.0, 500.0, 500) == Stretch(0, 100, 500)


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.lists(st.booleans(), max_size=300), st.integers(1, 12))
def test_limited_ranges_cover_all_selected_samples(mask: list[bool], most: int) -> None:
    selected = np.array(mask, dtype=bool)
    exact = np.zeros(len(selected), dtype=bool)
    for a, b in ranges_of(selected, limit=1000):
        exact[a:b] = True
    assert np.array_equal(exact, selected)
    joined = ranges_of(selected, limit=most)
    covered = np.zeros(len(selected), dtype=bool)
    for a, b in joined:
        covered[a:b] = True
    assert np.all(covered[selected])
    assert len(joined) <= most


def test_density_of_samples_agrees_with_a_histogram_of_numpy() -> None:
    random = np.random.default_rng(4)
    x, y = random.normal(size=3000), random.normal(size=3000)
    frame = Frame.around([x], [y], 50, 40)
    counts = frame.counts([frame.places(x, y)])
    assert counts.sum() == 3000
    edges = [np.linspace(frame.low, frame.high, 41), np.linspace(frame.left, frame.right, 51)]
    expected, _, _ = np.histogram2d(y, x, bins=edges)
    assert np.abs(counts - expected).sum() <= 4  # a sample on an edge may fall to either side
    levels = np.frombuffer(base64.b64decode(shade(counts)), dtype=np.uint8).reshape(40, 50)
    assert np.array_equal(levels > 0, counts > 0)
    assert levels.max() == 255


def test_every_sample_of_a_constant_force_is_counted_in_the_density() -> None:
    frame = Frame.around([np.zeros(5)], [np.full(5, 3.0)], 10, 10)
    assert frame.counts([frame.places(np.zeros(5), np.full(5, 3.0))]).sum() == 5


def test_samples_outside_the_frame_or_nan_are_not_counted_in_the_density() -> None:
    frame = Frame(0.0, 1.0, 0.0, 1.0, 10, 10)
    x = np.array([0.5, -0.01, 1.0, np.nan, 0.5, 0.5, np.inf, 0.99])
    y = np.array([0.5, 0.5, 0.5, 0.5, np.nan, -0.01, 0.5, 0.99])
    assert frame.counts([frame.places(x, y)]).sum() == 2


def test_box_in_the_plane_selects_samples_of_every_shown_run(loaded: Session) -> None:
    runs = loaded.on_bench().runs
    result = views.brushed(loaded, None, {"box": BOX}, [r.name for r in runs], SIZE)
    inside = [within(r.velocity, r.friction, BOX) for r in runs if r.friction is not None]
    assert result["samples"] == sum(int(mask.sum()) for mask in inside)
    assert result["rms"] is None
    for run, mask in zip(runs, inside, strict=True):
        for first, last in result["by_run"].get(run.name, {}).get("stretches_s", []):
            assert mask[np.searchsorted(run.time_s, first)]
            assert mask[np.searchsorted(run.time_s, last)]


def test_density_of_a_selection_counts_only_the_selected_samples(loaded: Session) -> None:
    run = loaded.on_bench().run("stopgo")
    assert run.friction is not None
    complete = views.plane(loaded, None, ["stopgo"], SIZE)
    result = views.brushed(loaded, None, {"box": BOX}, ["stopgo"], SIZE)
    mask = within(run.velocity, run.friction, BOX)
    frame = Frame(**complete["frame"])
    places = frame.places(run.velocity[mask], run.friction[mask])
    assert result["selected"] == frame.picture([places])
    assert result["selected"] != complete["measured"]


def test_time_span_selects_samples_of_its_run_only(loaded: Session) -> None:
    selection = {"run": "stopgo", "from_s": 2.0, "to_s": 3.0}
    result = views.brushed(loaded, None, selection, ["stopgo"], SIZE)
    assert list(result["by_run"]) == ["stopgo"]
    assert result["samples"] == 51


def test_box_with_only_a_lower_speed_limit_selects_all_faster_samples(loaded: Session) -> None:
    selection = {"run": "stopgo", "box": [0.01, None, None, None]}
    result = views.brushed(loaded, None, selection, ["stopgo"], SIZE)
    run = loaded.on_bench().run("stopgo")
    assert list(result["by_run"]) == ["stopgo"]
    assert result["samples"] == int((run.velocity >= 0.01).sum())
    low, high = result["speeds_m_s"]
    assert low >= 0.01
    assert high == run.velocity.max()
    # The cells lie in the row of the run, at positive speeds.
    row = [r.name for r in loaded.on_bench().runs].index("stopgo")
    assert {cell[0] for cell in result["cells"]} == {row}
    assert min(cell[1] for cell in result["cells"]) >= views.MAP_SPEEDS // 2


def test_selection_by_a_mark_is_refused_without_a_model(loaded: Session) -> None:
    with pytest.raises(InputError, match="does not exist"):
        views.brushed(loaded, None, {"mark": 0}, ["stopgo"], SIZE)


def test_series_and_plane_contain_only_the_records_if_no_model_is_given(loaded: Session) -> None:
    result = views.series(loaded, None, "stopgo", (None, None), 1000)
    assert "model_n" not in result
    run = loaded.on_bench().run("stopgo")
    assert result["friction_n"] == pytest.approx(run.friction, abs=1e-4)
    picture = views.plane(loaded, None, ["stopgo"], SIZE)
    assert "model" not in picture


def test_listed_numbers_are_rounded_and_nan_or_infinity_becomes_null() -> None:
    assert listed([1.23456789, -0.000123456]) == [1.23457, -0.00012]
    assert listed([float("nan"), float("inf"), 1.0]) == [None, None, 1.0]
    assert listed([]) == []
    assert listed([1e300, -1e300]) == [1e300, -1e300]
