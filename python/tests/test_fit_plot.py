"""Pictures of fits and comparisons: how large they are, and what each of their axes holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand, fit_by_hand
from jbf import Bootstrap, InputError, ParameterValue, TrajectoryFit
from jbf.plot.style import BEFORE, MODEL
from jbf.reporting.comparison_plots import plot_comparison, plot_run
from jbf.reporting.diagnosis_plot import before_and_after, plot_diagnosis
from jbf.reporting.fit_plot import plot_bootstrap, plot_fit, plot_trajectory_fit
from matplotlib.axes import Axes
from matplotlib.figure import Figure

FIT = fit_by_hand(["sensor_offset"])


def size_of(axes: Sequence[Axes]) -> tuple[float, float]:
    """Width and height of the figure, inches."""
    figure: Any = axes[0].figure
    width, height = figure.get_size_inches()
    return float(width), float(height)


def places_of(axes: Sequence[Axes]) -> list[tuple[int, int]]:
    """Row and column of each of the axes."""
    found: list[Any] = [ax.get_subplotspec() for ax in axes]
    return [(spec.rowspan.start, spec.colspan.start) for spec in found]


def test_a_fit_has_its_parameters_to_the_left_of_its_residuals() -> None:
    """High enough for the parameters, and never too low for the residuals."""
    axes = plot_fit(FIT)
    assert [ax.get_title(loc="left") for ax in axes] == [
        "Parameters with standard errors", "What the fit leaves, run after run"
    ]  # fmt: skip
    assert places_of(axes) == [(0, 0), (0, 1)]
    assert size_of(axes) == pytest.approx((10.0, 4.2))
    many = {f"own_{i}": ParameterValue(1.0, 0.1) for i in range(8)}
    large = replace(FIT, parameters=many, correlations=np.eye(8))
    assert size_of(plot_fit(large)) == pytest.approx((10.0, 5.6))
    given = list(np.ravel(Figure().subplots(1, 2)))
    assert plot_fit(FIT, given) == given


def test_a_bootstrap_has_the_answers_behind_the_intervals() -> None:
    """In percent off the value; one axes, as high as there are parameters."""
    answers = {name: p.value * np.array([0.9, 1.2]) for name, p in FIT.parameters.items()}
    (ax,) = axes = plot_bootstrap(Bootstrap(FIT, answers))
    assert ax.get_title(loc="left") == "Parameters, and the answers of repeated fits"
    off = [np.asarray(line.get_xdata()) for line in ax.lines if line.get_marker() == "|"]
    assert any(np.allclose(values, [-10.0, 20.0]) for values in off)
    assert size_of(axes) == pytest.approx((7.0, 1.6 + 0.5 * len(answers)))
    with pytest.raises(InputError, match="needs 1"):
        plot_bootstrap(Bootstrap(FIT, answers), list(np.ravel(Figure().subplots(1, 2))))


def test_a_fit_of_trajectories_has_its_parameters_alone() -> None:
    """A row each."""
    values = {"f_m": ParameterValue(0.25, 0.05), "K0": ParameterValue(6.5e5)}
    (ax,) = axes = plot_trajectory_fit(TrajectoryFit(values, 4e-4, 1, 7, True, ""))
    assert [t.get_text() for t in ax.get_yticklabels()] == ["f_m\n0.250 ± 0.050", "K0\n650000"]
    assert size_of(axes) == pytest.approx((7.0, 2.6))
    with pytest.raises(InputError, match="needs 1"):
        plot_trajectory_fit(TrajectoryFit(values, 4e-4, 1, 7, True, ""), [ax, ax])


def test_a_comparison_shows_the_worst_run_beside_the_worst_axis() -> None:
    """Whichever run is the worst; without a failure the title says so."""
    for rms, name in (((1.0, 1.5), "back"), ((1.5, 1.0), "there")):
        left, right = axes = plot_comparison(comparison_by_hand(1.25, rms))
        assert name in left.get_title(loc="left")
        assert right.get_title(loc="left") == "Residual along direction"
        assert places_of(axes) == [(0, 0), (0, 1)]
        assert size_of(axes) == pytest.approx((10.0, 4.2))
    fine = replace(comparison_by_hand(1.25, (1.0, 1.5)), failures=())
    assert plot_comparison(fine)[1].get_title(loc="left") == "No pattern in the residual"


def test_a_run_has_its_residual_below_it() -> None:
    """The run that was asked for, by default the worst; both have one time."""
    found = comparison_by_hand(1.25, (1.0, 1.5))
    for asked, name in ((None, "back"), (0, "there"), ("back", "back")):
        top, bottom = axes = plot_run(found, asked)
        assert top.get_title(loc="left") == f"Run {name}"
        assert bottom.get_title(loc="left") == f"Residual, run {name}"
        assert places_of(axes) == [(0, 0), (1, 0)]
    assert size_of(axes) == pytest.approx((10.0, 6.0))
    top.set_xlim(1.0, 2.0)
    assert bottom.get_xlim() == (1.0, 2.0)


@pytest.mark.parametrize(
    ("verdict", "last"), [("missing", "Final model, run "), ("unexplained", "Residual, run ")]
)
def test_a_diagnosis_has_four_pictures(verdict: str, last: str) -> None:
    """The error falling, the pattern before and after, the loop of the bare law and of the final
    one on one scale; where nothing was added what is left in time."""
    axes = plot_diagnosis(diagnosis_by_hand(verdict))
    falling, residual, first, final = axes
    assert places_of(axes) == [(0, 0), (0, 1), (1, 0), (1, 1)]
    assert size_of(axes) == pytest.approx((11.0, 8.0))
    assert falling.get_title(loc="left") == "The error falling"
    assert residual.get_title(loc="left") == "Residual along direction"
    name = first.get_title(loc="left").removeprefix("Bare law, run ")
    assert name in ("there", "back")
    assert final.get_title(loc="left") == f"{last}{name}"
    assert (final.get_ylim() == first.get_ylim()) == (verdict == "missing")


def colours_of(ax: Axes) -> set[object]:
    """Of the lines with marks, which are the means."""
    return {line.get_color() for line in ax.lines if line.get_marker() in ("o", "s")}


def test_the_final_models_means_stand_beside_the_bare_laws_where_they_differ() -> None:
    """With a title, or without one and with the legend above."""
    d = diagnosis_by_hand("missing")
    ax = Figure().subplots()
    before_and_after(d, d.failures[0], ax)
    assert colours_of(ax) == {BEFORE, MODEL}
    assert ax.get_title(loc="left") == "Residual along direction"
    legend = ax.get_legend()
    assert legend is not None
    words = " ".join(t.get_text() for t in legend.get_texts())
    assert "bare law" in words
    assert "final" in words

    same = replace(d, after=d.before)
    for diagnosis, titled in ((same, False), (diagnosis_by_hand("unexplained"), False)):
        ax = Figure().subplots()
        before_and_after(diagnosis, d.failures[0], ax, titled=titled)
        assert colours_of(ax) == {BEFORE}
        assert ax.get_title(loc="left") == ""
        legend = ax.get_legend()
        assert legend is not None
        assert "bare law" not in " ".join(t.get_text() for t in legend.get_texts())
