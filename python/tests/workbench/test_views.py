"""What the plots are sent: no extreme lost, every sample counted, selections everywhere."""

from __future__ import annotations

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
def test_thinning_keeps_every_extreme(samples: int, pixels: int, seed: int) -> None:
    y = np.random.default_rng(seed).normal(size=samples)
    time = np.arange(samples) * 0.02
    stretch = Stretch.between(time, time[0], time[-1], pixels)
    found = thinned(time, {"y": y}, stretch)
    assert len(found["time_s"]) == len(found["y"]) <= max(2 * pixels + 2, 2 * pixels)
    assert found["y"].min() == y.min()
    assert found["y"].max() == y.max()
    assert np.all(np.diff(found["time_s"]) >= 0.0)
    # Each pair lies within the time of its own group.
    if stretch.stride > 2:
        k = int(np.argmax(y)) // stretch.stride
        assert found["y"][2 * k : 2 * k + 2].max() == y.max()


SIZE = (100, 80)


def test_a_gap_stays_a_gap() -> None:
    y = np.ones(1000)
    y[400:600] = np.nan
    found = thinned(np.arange(1000.0), {"y": y}, Stretch(0, 1000, 100))
    assert np.all(np.isnan(found["y"][84:116]))
    assert listed(found["y"])[90] is None


def test_a_zoom_has_one_sample_more_at_either_end() -> None:
    time = np.arange(100.0)
    assert Stretch.between(time, 10.5, 20.5, 500) == Stretch(10, 22, 500)
    assert Stretch.between(time, -5.0, 500.0, 500) == Stretch(0, 100, 500)


@settings(max_examples=60, derandomize=True, deadline=None)
@given(st.lists(st.booleans(), max_size=300), st.integers(1, 12))
def test_ranges_hold_every_sample_of_a_mask(mask: list[bool], most: int) -> None:
    there = np.array(mask, dtype=bool)
    exact = np.zeros(len(there), dtype=bool)
    for a, b in ranges_of(there, most=1000):
        exact[a:b] = True
    assert np.array_equal(exact, there)
    joined = ranges_of(there, most=most)
    covered = np.zeros(len(there), dtype=bool)
    for a, b in joined:
        covered[a:b] = True
    assert np.all(covered[there])
    assert len(joined) <= most


def test_the_plane_counts_every_sample_once() -> None:
    random = np.random.default_rng(4)
    x, y = random.normal(size=3000), random.normal(size=3000)
    frame = Frame.around([x], [y], 50, 40)
    counts = frame.counts([frame.places(x, y)])
    assert counts.sum() == 3000
    expected, _, _ = np.histogram2d(
        y,
        x,
        bins=[np.linspace(frame.low, frame.high, 41), np.linspace(frame.left, frame.right, 51)],
    )
    assert np.abs(counts - expected).sum() <= 4  # a sample on an edge may fall to either side
    levels = np.frombuffer(base64.b64decode(shade(counts)), dtype=np.uint8).reshape(40, 50)
    assert np.array_equal(levels > 0, counts > 0)
    assert levels.max() == 255


def test_a_constant_force_has_a_plane() -> None:
    frame = Frame.around([np.zeros(5)], [np.full(5, 3.0)], 10, 10)
    assert frame.counts([frame.places(np.zeros(5), np.full(5, 3.0))]).sum() == 5


def test_what_lies_outside_or_is_no_number_is_in_no_pixel() -> None:
    frame = Frame(0.0, 1.0, 0.0, 1.0, 10, 10)
    x = np.array([0.5, -0.01, 1.0, np.nan, 0.5, 0.5, np.inf, 0.99])
    y = np.array([0.5, 0.5, 0.5, 0.5, np.nan, -0.01, 0.5, 0.99])
    assert frame.counts([frame.places(x, y)]).sum() == 2


def test_a_box_selects_in_every_run(on_bench: Session) -> None:
    runs = on_bench.on_bench().runs
    box = (-0.02, 0.02, -20.0, 0.0)
    found = views.brushed(on_bench, None, {"box": box}, [r.name for r in runs], SIZE)
    inside = [within(r.velocity_m_s, r.friction_n, box) for r in runs if r.friction_n is not None]
    assert found["samples"] == sum(int(mask.sum()) for mask in inside)
    assert found["rms_n"] is None
    for run, mask in zip(runs, inside, strict=True):
        for first, last in found["by_run"].get(run.name, {}).get("stretches_s", []):
            assert mask[np.searchsorted(run.time_s, first)]
            assert mask[np.searchsorted(run.time_s, last)]


def test_the_picture_of_a_selection_is_that_of_its_samples(on_bench: Session) -> None:
    box = (-0.02, 0.02, -20.0, 0.0)
    run = on_bench.on_bench().run("stopgo")
    assert run.friction_n is not None
    whole = views.plane(on_bench, None, ["stopgo"], SIZE)
    found = views.brushed(on_bench, None, {"box": box}, ["stopgo"], SIZE)
    mask = within(run.velocity_m_s, run.friction_n, box)
    frame = Frame(**whole["frame"])
    assert found["selected"] == frame.picture(
        [frame.places(run.velocity_m_s[mask], run.friction_n[mask])]
    )
    assert found["selected"] != whole["measured"]


def test_a_stretch_selects_in_its_run_alone(on_bench: Session) -> None:
    selection = {"run": "stopgo", "from_s": 2.0, "to_s": 3.0}
    found = views.brushed(on_bench, None, selection, ["stopgo"], SIZE)
    assert list(found["by_run"]) == ["stopgo"]
    assert found["samples"] == 51


def test_an_open_box_of_one_run_is_a_band_of_its_speeds(on_bench: Session) -> None:
    selection = {"run": "stopgo", "box": [0.01, None, None, None]}
    found = views.brushed(on_bench, None, selection, ["stopgo"], SIZE)
    run = on_bench.on_bench().run("stopgo")
    assert list(found["by_run"]) == ["stopgo"]
    assert found["samples"] == int((run.velocity_m_s >= 0.01).sum())
    low, high = found["speeds_m_s"]
    assert low >= 0.01
    assert high == run.velocity_m_s.max()
    # Its cells lie in its row of the map, on the right of standstill.
    row = [r.name for r in on_bench.on_bench().runs].index("stopgo")
    assert {cell[0] for cell in found["cells"]} == {row}
    assert min(cell[1] for cell in found["cells"]) >= views.MAP_SPEEDS // 2


def test_every_selection_is_refused_in_words_where_it_names_nothing(on_bench: Session) -> None:
    with pytest.raises(InputError, match="no such model"):
        views.brushed(on_bench, None, {"mark": 0}, ["stopgo"], SIZE)


def test_raw_records_are_there_without_any_model(on_bench: Session) -> None:
    found = views.series(on_bench, None, "stopgo", (None, None), 1000)
    assert "model_n" not in found
    run = on_bench.on_bench().run("stopgo")
    assert found["friction_n"] == pytest.approx(run.friction_n, abs=1e-4)
    picture = views.plane(on_bench, None, ["stopgo"], SIZE)
    assert "model" not in picture


def test_numbers_are_rounded_to_what_a_screen_shows() -> None:
    assert listed([1.23456789, -0.000123456]) == [1.23457, -0.00012]
    assert listed([float("nan"), float("inf"), 1.0]) == [None, None, 1.0]
    assert listed([]) == []
    assert listed([1e300, -1e300]) == [1e300, -1e300]
