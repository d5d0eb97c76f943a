"""Pictures: on given axes or new ones, labelled with units, nothing drawn outside."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np
import pytest
from jbf import Comparison, Fit, Run, compare
from jbf.comparison.axes import all_axes
from jbf.comparison.patterns import Failure
from jbf.diagnosis.result import Diagnosis
from jbf.errors import InputError
from jbf.plot.bin_axes import bin_axis
from jbf.reporting.comparison_plots import plot_comparison, plot_run
from jbf.reporting.diagnosis_plot import plot_diagnosis
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure


@pytest.fixture(scope="module")
def bad(bare_fit: Fit, runs: list[Run]) -> Comparison:
    return compare(bare_fit.model, runs)


@pytest.fixture(scope="module")
def good(full_fit: Fit, runs: list[Run]) -> Comparison:
    return compare(full_fit.model, runs)


def drawn(axes: list[Axes]) -> None:
    """Every axis is labelled, and every text lies inside the figure."""
    figure = cast(Figure, axes[0].figure)
    FigureCanvasAgg(figure).draw()  # carries the layout out
    for ax in axes:
        assert ax.get_xlabel()
        assert "(N)" in ax.get_ylabel() + ax.get_xlabel()
        assert ax.get_title(loc="left")
        box = ax.get_tightbbox()
        assert box is not None
        assert box.x0 >= 0
        assert box.y0 >= 0
        assert box.x1 <= figure.bbox.x1
        assert box.y1 <= figure.bbox.y1


def test_comparison_draws_record_and_model(bad: Comparison) -> None:
    left, right = plot_comparison(bad)
    drawn([left, right])
    assert left.get_xlabel() == "Surface speed (m/s)"
    assert [t.get_text() for t in left.get_legend().get_texts()] == ["measured", "model"]  # type: ignore[union-attr]
    assert bad.failures[0].axis in right.get_title(loc="left")


def test_a_right_model_shows_no_pattern(good: Comparison) -> None:
    right = plot_comparison(good)[1]
    assert right.get_title(loc="left") == "No pattern in the residual"
    means = np.concatenate([np.asarray(line.get_ydata()) for line in right.lines])
    assert np.abs(means).max() < good.noise_n


def test_axes_may_be_given(bad: Comparison) -> None:
    given = list(Figure().subplots(1, 2))
    assert plot_comparison(bad, given) == given
    with pytest.raises(InputError, match="needs 4"):
        plot_diagnosis(cast(Diagnosis, None), given)


@pytest.mark.parametrize("verdict", ["adequate", "missing", "ambiguous", "unexplained"])
def test_diagnosis(verdict: str, make_diagnosis: Callable[[str], Diagnosis]) -> None:
    axes = plot_diagnosis(make_diagnosis(verdict))
    drawn(axes)
    assert axes[0].get_title(loc="left") == "The error falling"
    added = verdict in ("missing", "ambiguous")
    assert axes[3].get_title(loc="left").startswith("Final model" if added else "Residual, run")


def test_the_error_falls_in_the_picture(make_diagnosis: Callable[[str], Diagnosis]) -> None:
    diagnosis = make_diagnosis("missing")
    fit_line = next(x for x in plot_diagnosis(diagnosis)[0].lines if x.get_label() == "fit")
    assert list(np.asarray(fit_line.get_xdata())) == [s.rms_n for s in diagnosis.steps]


def test_run(bad: Comparison) -> None:
    drawn(plot_run(bad, "stopgo"))
    assert plot_run(bad, 0)[0].get_title(loc="left") == "Run sine_w0.5"
    assert plot_run(bad, -1)[0].get_title(loc="left") == "Run stopgo"
    with pytest.raises(InputError, match="no run nope; known"):
        plot_run(bad, "nope")


def test_every_axis_of_a_comparison_has_places_for_its_bins(bad: Comparison) -> None:
    for axis in all_axes(bad.campaign, 0.055):
        size = len(axis.bins)
        place = bin_axis(Failure(axis.axis, "", 0.5, axis.bins, np.zeros(size), np.ones(size, int)))
        assert place.name
        assert len(place.x) == len(place.series) == size
        assert np.all(np.isfinite(place.x))
        # No two bins of one series stand at the same place.
        assert len({*zip(place.x, place.series, strict=True)}) == size
        if axis.axis in ("velocity", "angle", "time"):
            assert not place.ticks
        else:
            assert place.ticks


def test_pictures_do_not_touch_pyplot(bad: Comparison) -> None:
    import subprocess
    import sys

    code = "import jbf.reporting.pictures, sys; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_errors_of_the_ledger_stand_on_a_scale_on_which_each_step_is_seen(
    make_diagnosis: Callable[[str], Diagnosis],
) -> None:
    diagnosis = make_diagnosis("missing")
    falling = plot_diagnosis(diagnosis)[0]
    shown = {line.get_label(): list(line.get_xdata()) for line in falling.lines}
    assert shown["fit"] == [step.rms_n for step in diagnosis.steps]
    assert shown["held out"] == [step.holdout_rms_n for step in diagnosis.steps]
    assert set(shown["noise floor"]) == {diagnosis.steps[-1].noise_n}
    assert falling.get_xscale() == "log"
    low, high = falling.get_xlim()
    drawn = np.concatenate(list(shown.values()))
    least, most = float(drawn.min()), float(drawn.max())
    assert low < least < most < high
    # The errors fill the scale: what is above and below them is a small part of it.
    assert np.log(most / least) > 0.8 * np.log(high / low)
