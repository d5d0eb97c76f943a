"""Plots: the numbers that they draw, their axes, and the files that they are written to."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, cast

import by_hand
import jbf.plot
import numpy as np
import pytest
from by_hand import LAW, comparison_by_hand, coulomb, diagnosis_by_hand, fit_by_hand, one_way
from jbf import Bootstrap, Comparison, Diagnosis, InputError, Model, Rig, compare, control
from jbf.comparison.over_speed import friction_over_speed
from jbf.diagnosis.power import Power
from jbf.plot.power import deviate
from jbf.plot.runs import index_of, largest_error_run
from jbf.plot.style import BEFORE, MEASURED, MODEL, NOISE, OTHER, one_axes
from jbf.reporting.diagnosis_plot import plot_diagnosis
from jbf.reporting.fit_plot import plot_bootstrap
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.special import ndtr

POWER = Power("backlash", "gap", "rad", 0.1, 0.13, False, 0.02, 0.1, ())


def line(ax: Axes, label: str) -> tuple[np.ndarray, np.ndarray]:
    (artist,) = [one for one in ax.lines if one.get_label() == label]
    return np.asarray(artist.get_xdata(), dtype=float), np.asarray(artist.get_ydata(), dtype=float)


def title(ax: Axes) -> str:
    return ax.get_title(loc="left")


@pytest.fixture(scope="module")
def comparison() -> Comparison:
    """Noise-free friction 1 N larger than that of the model, with a noise floor set to 0.5 N."""
    return comparison_by_hand(1.25, (1.0, 1.5))


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    return replace(diagnosis_by_hand("missing"), power=(POWER,))


@pytest.fixture(scope="module")
def loop() -> control.Result:
    return control.run(None, "observed", replace(control.TASKS["velocity sine"], seconds=8.0))


def test_each_plot_draws_on_given_or_new_axes_and_is_named_in_the_documentation(
    diagnosis: Diagnosis, loop: control.Result, tmp_path: Path
) -> None:
    page = Path(__file__).resolve().parents[3] / "docs" / "pictures.md"
    text = page.read_text(encoding="utf-8")
    of_diagnosis, of_fit = {"ledger", "ranking", "power"}, {"parameters", "residuals_in_a_row"}
    for name in sorted(set(jbf.plot.__all__) - {"save"}):
        shown: Any = diagnosis.before
        shown = diagnosis if name in of_diagnosis else diagnosis.fit if name in of_fit else shown
        draw = partial(getattr(jbf.plot, name), loop if name == "control_trace" else shown)
        given = Figure().subplots()
        assert draw(ax=given) is given, name
        ax = draw()
        assert ax.figure is not given.figure, name
        assert ax.get_xlabel() + ax.get_ylabel(), name
        assert title(ax), name
        jbf.plot.save(ax, tmp_path / f"{name}.svg")
        assert "<text" in (tmp_path / f"{name}.svg").read_text()
        assert f"`{name}(" in text
        assert (page.parent / "images" / "plot" / f"{name}.svg").is_file()


def test_plot_colours_are_distinguishable_with_red_green_colour_deficiency() -> None:
    """Distances after the projection of Vienot et al. (1999) for deuteranopes."""

    def least_distance(*colours: str) -> float:
        seen = np.array([[0.293, 0.707, 0.0], [0.293, 0.707, 0.0], [-0.022, 0.022, 1.0]])
        rgb = np.array([[int(c[i : i + 2], 16) / 255.0 for i in (1, 3, 5)] for c in colours])
        places = rgb**2.2 @ seen.T
        return min(float(np.linalg.norm(a - b)) for i, a in enumerate(places) for b in places[:i])

    assert least_distance(MEASURED, MODEL, BEFORE, NOISE, OTHER) > 0.08
    assert least_distance("#8c6d00", "#5f8c00") < 0.08  # an indistinguishable pair


def test_wrong_number_of_axes_for_a_diagnosis_plot_is_rejected(diagnosis: Diagnosis) -> None:
    with pytest.raises(InputError, match="requires 4"):
        plot_diagnosis(diagnosis, list(Figure().subplots(1, 2)))


def test_plot_file_of_unknown_format_or_in_a_missing_folder_is_rejected(tmp_path: Path) -> None:
    ax = one_axes(None)
    for path in (tmp_path / "a.nonsense", tmp_path / "none" / "a.svg"):
        with pytest.raises(InputError, match="cannot be written"):
            jbf.plot.save(ax, path)


def test_friction_loop_plot_has_record_and_model_over_speed(comparison: Comparison) -> None:
    ax = jbf.plot.loops(comparison, "there")
    p = comparison.campaign.prepared[0]
    v, measured = line(ax, "measured")
    assert np.array_equal(v, p.motion.velocity)
    assert np.array_equal(measured, p.friction)
    v, modelled = line(ax, "model")
    known = np.isfinite(modelled)
    assert modelled[known] == pytest.approx(5.0 + 20.0 * v[known], rel=1e-3)


def test_friction_loop_plot_of_isolated_friction_excludes_the_sensor_offset() -> None:
    runs = by_hand.there_and_back(lambda t, v, a: coulomb(t, v, a) + 2.0)
    model = Model(Rig(), "coulomb", ["sensor_offset"], {**LAW, "sensor_offset.b": 2.0})
    v, measured = line(jbf.plot.loops(compare(model, runs), 0, alone=True), "measured")
    assert measured == pytest.approx(5.0 + 20.0 * v, rel=1e-4)


def test_record_and_model_are_drawn_over_time(comparison: Comparison) -> None:
    ax = jbf.plot.record_and_model(comparison, 1)
    p = comparison.campaign.prepared[1]
    for label, values in (("measured", p.friction), ("model", comparison.predictions[1])):
        time_s, drawn = line(ax, label)
        assert np.array_equal(time_s, p.run.time_s)
        assert np.array_equal(drawn, values)


def test_stribeck_plot_has_the_means_over_speed_and_the_steady_law(comparison: Comparison) -> None:
    ax = jbf.plot.stribeck(comparison)
    modelled = [one for one in ax.lines if one.get_linestyle() == "-" and len(one.get_xdata()) > 2]  # type: ignore[arg-type]
    for found, drawn in zip(friction_over_speed(comparison), modelled, strict=False):
        assert np.array_equal(np.asarray(drawn.get_xdata()), found.speed_m_s)
        assert np.array_equal(np.asarray(drawn.get_ydata()), found.modelled_n)
    steady = [np.asarray(one.get_xydata()).T for one in ax.lines if one.get_linestyle() == ":"]
    assert [np.sign(v).mean() for v, _ in steady] == [1.0, -1.0]
    for v, force in steady:
        assert force == pytest.approx(5.0 * np.sign(v) + 20.0 * v, rel=1e-3)


def test_friction_map_has_sample_counts_and_mean_of_the_model(comparison: Comparison) -> None:
    ax = jbf.plot.friction_map(comparison)
    counts = np.ma.filled(cast(Any, ax.collections[0]).get_array(), 0.0)
    total = comparison.samples.count
    # At most 0.05 % of the samples lie beyond each of the four sides.
    assert total * (1.0 - 4 * 0.0005) - 4 <= np.nansum(counts) <= total
    for drawn in ax.lines:
        x, y = np.asarray(drawn.get_xdata()), np.asarray(drawn.get_ydata())
        assert y == pytest.approx(5.0 * np.sign(x) + 20.0 * x, rel=1e-3)


def test_residual_is_positive_where_record_is_above_the_model(comparison: Comparison) -> None:
    ax = jbf.plot.residual_along(comparison, "direction")
    assert [tick.get_text() for tick in ax.get_xticklabels()] == ["v < 0", "v > 0"]
    _, means = line(ax, "mean in the bin")
    assert means == pytest.approx([-1.0, 1.0], abs=1e-3)


def test_residual_map_shows_the_mean_in_units_of_the_noise(comparison: Comparison) -> None:
    """1 N with noise of 0.5 N: above the model in the first run, below it in the second."""
    ax = jbf.plot.residual_map(comparison, "time", "run")
    cells = np.ma.filled(cast(Any, ax.collections[0]).get_array(), np.nan).reshape(2, -1)
    assert np.nanmean(cells, axis=1) == pytest.approx([2.0, -2.0], abs=0.01)
    with pytest.raises(InputError, match="over nothing"):
        jbf.plot.residual_map(comparison, "nothing")  # type: ignore[arg-type]


def test_residual_over_time_omits_excluded_samples(comparison: Comparison) -> None:
    masks = [np.arange(501) >= 100, np.arange(501) >= 0]
    partial = replace(comparison, samples=comparison.samples.within(masks))
    ax = jbf.plot.residual_in_time(partial, 0)
    _, residual = line(ax, "record minus model")
    assert np.all(np.isnan(residual[:100]))
    assert residual[100:] == pytest.approx(np.ones(401), abs=1e-3)


def test_residual_plot_of_a_fit_has_all_runs_in_order(diagnosis: Diagnosis) -> None:
    ax = jbf.plot.residuals_in_a_row(diagnosis.fit)
    drawn = [one for one in ax.lines if one.get_marker() == "."]
    x = np.concatenate([np.asarray(one.get_xdata()) for one in drawn])
    y = np.concatenate([np.asarray(one.get_ydata()) for one in drawn])
    assert np.array_equal(y, np.concatenate(diagnosis.fit.residuals))
    assert np.array_equal(x, np.arange(len(y)))


def test_spectrum_has_the_level_of_white_noise_and_a_peak_at_a_tone() -> None:
    """White noise of standard deviation s has the density s sqrt(2 dt)."""
    model = Model(Rig(), "coulomb", parameters=LAW)
    runs = by_hand.there_and_back(coulomb, noise_rms=0.2)
    quiet = jbf.plot.spectrum(compare(model, runs), 0)
    _, density = line(quiet, "record minus model")
    assert np.sqrt(np.mean(density**2)) == pytest.approx(0.2 * np.sqrt(2.0 * 0.02), rel=0.15)
    _, floor = line(quiet, "white noise of equal power")
    assert floor[0] == pytest.approx(0.2 * np.sqrt(2.0 * 0.02), rel=0.1)

    tone_n = 0.5 * np.sin(2.0 * np.pi * 7.0 * runs[0].time_s)
    with_tone = replace(runs[0], friction=runs[0].friction + tone_n)
    frequency, density = line(jbf.plot.spectrum(compare(model, [with_tone])), "record minus model")
    assert frequency[np.argmax(density)] == pytest.approx(7.0, abs=0.5)


def test_plotted_run_is_selected_by_name_index_or_largest_rms(comparison: Comparison) -> None:
    assert [index_of(comparison, run) for run in ("there", "back", 0, -1, None)] == [0, 1, 0, 1, 1]
    assert index_of(comparison_by_hand(1.25, (1.5, 1.0)), None) == 0
    with pytest.raises(InputError, match="run nope does not exist; known: there, back"):
        index_of(comparison, "nope")


def test_default_run_of_a_plot_is_that_with_the_largest_difference_between_two_models() -> None:
    """5 N + 20 N s/m and 1 N + 40 N s/m agree at 0.2 m/s and differ by 2 N at 0.1 m/s."""
    runs = [one_way("slow", coulomb), one_way("fast", coulomb, direction=2.0)]
    first, second = (
        compare(Model(Rig(), "coulomb", parameters=values), runs)
        for values in (LAW, {"F_c": 1.0, "F_s": 1.0, "F_v": 40.0})
    )
    assert largest_error_run(first, second) == 0
    assert largest_error_run(first, first) == largest_error_run(first)


def test_parameter_intervals_are_standard_errors_in_percent_of_the_value() -> None:
    fit = fit_by_hand(["sensor_offset"])
    ax = jbf.plot.parameters(fit)
    widths = {
        float(c[0].get_ydata()[0]): float(np.ptp(c[2][0].get_segments()[0][:, 0]))
        for c in cast(Any, ax.containers)
    }
    known = {float(i): p for i, p in enumerate(fit.parameters.values()) if p.stderr is not None}
    expected = {row: 200.0 * abs(cast(float, p.stderr) / p.value) for row, p in known.items()}
    assert widths == pytest.approx(expected)
    labels = [tick.get_text() for tick in ax.get_yticklabels()]
    # A held parameter is drawn without an interval.
    assert labels[:2] == ["F_c\n4.988 ± 0.012 N", "F_s\nheld at 6.0000 N"]
    assert len(ax.containers) == 3


def test_bootstrap_plot_has_the_deviation_of_each_fit_in_percent_of_the_value() -> None:
    fit = fit_by_hand()
    answers = {name: p.value * np.array([0.9, 1.2]) for name, p in fit.parameters.items()}
    (ax,) = plot_bootstrap(Bootstrap(fit, answers))
    off = [np.asarray(one.get_xdata(), dtype=float) for one in ax.lines if one.get_marker() == "|"]
    # The caps of the intervals have the same marker and one point each.
    assert [x for x in off if len(x) == 2] == [pytest.approx([-10.0, 20.0])] * 2


def test_ledger_plot_has_fit_and_held_out_errors_and_their_reduction(diagnosis: Diagnosis) -> None:
    ax = jbf.plot.ledger(diagnosis)
    assert line(ax, "fit")[0].tolist() == [2.5, 0.525]
    assert line(ax, "held out")[0].tolist() == [2.75, 0.55]
    assert set(line(ax, "noise floor")[0]) == {0.5}
    assert ax.get_xscale() == "log"
    low, high = ax.get_xlim()
    assert low < 0.5
    assert high > 2.75
    # 0.55 N is 80 % below 2.75 N; the minus sign is the typographic one.
    assert [t.get_text() for t in ax.texts] == ["2.75 N", "0.550 N  (−80 %)"]


def test_ranking_plot_has_descending_gains_and_rejects_unknown_step(diagnosis: Diagnosis) -> None:
    ax = jbf.plot.ranking(diagnosis)
    assert [cast(Any, bar).get_width() for bar in ax.patches] == [812.4, 55.0, 7.4]
    names = [t.get_text() for t in ax.get_yticklabels()]
    assert names == ["sensor_offset", "sensor_drift", "inertia"]
    with pytest.raises(InputError, match="tested at step 1"):
        jbf.plot.ranking(diagnosis, 1)
    with pytest.raises(InputError, match="step 7 does not exist"):
        jbf.plot.ranking(diagnosis, 7)


def test_power_curve_agrees_with_the_detection_probability_at_two_sizes(
    diagnosis: Diagnosis,
) -> None:
    """80 % of effects of 0.1 rad, or 2 % of the friction, are detected, and 95 % of 0.13 rad."""
    shares = np.array([0.02, 0.02 * 1.3])
    assert ndtr(deviate(POWER, shares)) == pytest.approx([0.80, 0.95])
    x, y = line(jbf.plot.power(diagnosis), "backlash")
    assert np.interp(2.0, x, y) == pytest.approx(80.0, abs=0.2)
    assert np.interp(2.6, x, y) == pytest.approx(95.0, abs=0.2)
    unknown = replace(diagnosis, power=(replace(POWER, detectable_80=None),))
    with pytest.raises(InputError, match="is unknown"):
        jbf.plot.power(unknown)


def inside(axes: Sequence[Axes]) -> bool:
    """Return whether every text lies inside the figure after layout."""
    figure = cast(Figure, axes[0].figure)
    FigureCanvasAgg(figure).draw()
    boxes = [cast(Any, ax.get_tightbbox()) for ax in axes]
    low = min(min(box.x0, box.y0) for box in boxes)
    right, top = max(box.x1 for box in boxes), max(box.y1 for box in boxes)
    return bool(low >= 0 and right <= figure.bbox.x1 and top <= figure.bbox.y1)


@pytest.mark.parametrize(("verdict", "added"), [("missing", True), ("unexplained", False)])
def test_diagnosis_plot_has_four_titled_axes_within_figure(verdict: str, added: bool) -> None:
    axes = plot_diagnosis(diagnosis_by_hand(verdict))
    assert title(axes[0]) == "Error by step"
    assert title(axes[1]) == "Residual along direction"
    assert title(axes[2]).startswith("Base law, run ")
    assert title(axes[3]).startswith("Final model, run " if added else "Residual, run ")
    # The loops of the base law and of the final model have equal scales.
    assert (axes[3].get_ylim() == axes[2].get_ylim()) == added
    assert inside(axes)


def test_control_traces_draw_response_error_and_friction(loop: control.Result) -> None:
    traces: dict[Any, dict[str, np.ndarray]] = {
        "response": {"reference": loop.reference, "response": loop.velocity_rad_s},
        "error": {"of the shaft": loop.true_error, "of the estimate": loop.error},
        "friction": {"true": loop.friction_v, "estimated": loop.estimated_friction_v},
        "learned": {"level correction (V)": loop.learned_0, "rest (V)": loop.learned_1},
    }
    for trace, curves in traces.items():
        ax = jbf.plot.control_trace(loop, trace)
        for label, values in curves.items():
            assert np.array_equal(line(ax, label)[1], values), label
    speed, _ = line(jbf.plot.control_trace(loop, "loop"), "true")
    assert np.array_equal(speed, loop.velocity_rad_s)
    with pytest.raises(InputError, match="trace speed"):
        jbf.plot.control_trace(loop, "speed")  # type: ignore[arg-type]


def test_learned_parameters_of_the_thesis_scheme_are_drawn_in_scaled_units() -> None:
    """K0 in units of 1e5, gamma in units of ten."""
    task = replace(control.TASKS["velocity sine"], seconds=4.0)
    r = control.run(None, "learning", task)
    ax = jbf.plot.control_trace(r, "learned")
    assert line(ax, "K0 / 1e5")[1] == pytest.approx(r.learned_0 / 1e5)
    assert line(ax, "gamma / 10")[1] == pytest.approx(r.learned_1 / 10.0)
