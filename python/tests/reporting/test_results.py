"""Methods of all results: summary, plot, page, JSON, frame, repr and HTML table."""

import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from by_hand import LAW, comparison_by_hand, coulomb, diagnosis_by_hand, fit_by_hand, there_and_back
from jbf import (
    Bootstrap,
    Check,
    InputError,
    Model,
    ParameterValue,
    Plan,
    PlannedPower,
    Rig,
    Run,
    TrajectoryFit,
    compare,
    control,
)
from jbf.diagnosis.check import Answer
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.power import Power
from jbf.importing.cutting.piece import Piece
from jbf.importing.result import Import
from jbf.reporting.frames import parameter_columns
from jbf.reporting.json import json_text
from jbf.reporting.short import LONGEST, first_of
from jbf.results import Result, present
from matplotlib.axes import Axes
from matplotlib.figure import Figure

Results = dict[str, Result]
KINDS = (
    "fit", "bootstrap", "trajectory fit", "comparison", "model comparison", "diagnosis", "loop",
    "planned power", "plan", "check",
)  # fmt: skip
TRAJECTORY = TrajectoryFit(
    {"f_m": ParameterValue(0.25, 0.0012), "U_tr_m_s": ParameterValue(0.05)}, 4e-4, 100, 7, True, ""
)


@pytest.fixture(scope="module")
def results() -> Results:
    fit = fit_by_hand(["sensor_offset"])
    answers = {n: p.value + np.arange(3.0) for n, p in fit.parameters.items()}
    task = control.Task("velocity", "sine", -5.0, 5.0, 2.0, seconds=2.0)
    comparison, diagnosis = comparison_by_hand(1.25, (1.0, 1.5)), diagnosis_by_hand("ambiguous")
    loop = control.run(None, "observed", task)
    models = [Model(Rig(), "coulomb", parameters={**LAW, "F_c": force}) for force in (5.0, 6.0)]
    runs = there_and_back(coulomb, noise_rms=0.1)
    power = Power("sensor_offset", "b", "N", 0.1, 0.2, False, 0.02, 0.15, ("sensor_drift",))
    level = Level.in_white_noise(DEFAULT, 12, 2000.0, 0.1)
    planned = PlannedPower(models[0], 0.1, (power,), {}, ("there",), level)
    simulated = tuple(Answer((), draw, "adequate", (), {}) for draw in range(3))
    all_results = (
        fit,
        Bootstrap(fit, answers),
        TRAJECTORY,
        comparison,
        compare(models, runs),
        diagnosis,
        loop,
        planned,
        Plan(tuple(runs), ("forward", "back"), planned),
        Check(models[0], simulated),
    )
    return dict(zip(KINDS, all_results, strict=True))


@pytest.fixture
def frame_is_dict(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace `pandas` by a module whose data frame is the dictionary passed to it."""
    pandas = ModuleType("pandas")
    pandas.DataFrame = dict  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pandas", pandas)


@pytest.mark.usefixtures("frame_is_dict")
@pytest.mark.parametrize("kind", KINDS)
def test_each_result_is_reported_in_every_form(kind: str, results: Results, tmp_path: Path) -> None:
    result = results[kind]
    assert result.summary()
    for ax in np.ravel(result.plot()):
        assert ax.lines or ax.collections or ax.patches
    json.loads(json_text(result.to_dict()))
    result.save_html(tmp_path / "a.html")
    assert "<svg" in (tmp_path / "a.html").read_text(encoding="utf-8")
    assert 20 < len(repr(result)) < 300
    assert result._repr_html_().count("<table>") == 1
    columns: dict[str, Sequence[Any]] = result.to_frame()
    assert len({len(values) for values in columns.values()}) == 1


def test_to_frame_is_rejected_if_pandas_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InputError, match="pip install pandas"):
        fit_by_hand().to_frame()


def test_presentation_of_an_object_that_is_not_a_result_raises_a_type_error() -> None:
    operations: tuple[Any, ...] = ("summary", "small_table", "columns", "plot", "page")
    for operation in operations:
        with pytest.raises(TypeError, match="int"):
            present(operation, 3)


def test_plot_returns_one_axes_or_an_array_and_draws_on_given_axes(results: Results) -> None:
    single, several = results["bootstrap"].plot(), results["comparison"].plot()
    assert isinstance(single, Axes)
    assert isinstance(several, np.ndarray)
    assert several.shape == (2,)
    axes = Figure().subplots(1, 2)
    assert list(results["comparison"].plot(axes)) == list(axes)
    assert results["bootstrap"].plot(axes[0]) is axes[0]
    with pytest.raises(InputError, match="axes"):
        results["bootstrap"].plot(axes)


def test_run_and_model_have_an_html_table() -> None:
    run = Run.from_arrays(np.arange(20.0), np.ones(20), np.ones(20), name="a<b")
    assert "a&lt;b" in run._repr_html_()
    assert "F_c" in Model(Rig(), "coulomb")._repr_html_()


def test_fit_parameter_is_accessible_by_name() -> None:
    fit = fit_by_hand(["sensor_offset"])
    assert fit["sensor_offset.b"] is fit.parameters["sensor_offset.b"]
    assert fit["F_c"].value == fit.params["F_c"] == 4.9876
    assert fit.stderr["F_c"] == 0.0123
    assert "F_v" in fit
    assert "F_x" not in fit
    assert list(fit) == list(fit.parameters)
    with pytest.raises(InputError, match="is not known"):
        fit["F_w_n"]


@pytest.mark.usefixtures("frame_is_dict")
def test_frame_of_a_fit_has_a_row_for_each_parameter() -> None:
    frame: Any = fit_by_hand(["sensor_offset"]).to_frame()
    assert frame["parameter"] == ["F_c", "F_s", "F_v", "sensor_offset.b"]
    assert frame["value"] == [4.9876, 6.0, 20.44, -0.25]
    assert frame["unit"] == ["N", "N", "N s/m", "N"]
    assert frame["held"] == [False, True, False, False]
    assert frame["note"] == ["", "held fixed", "", ""]
    np.testing.assert_array_equal(frame["stderr"], [0.0123, np.nan, 0.52, 0.025])
    unknown = parameter_columns("coulomb", (), {"own": ParameterValue(1.0, 0.5, "a note")})
    assert (unknown["unit"], unknown["stderr"]) == ([""], [0.5])


@pytest.mark.usefixtures("frame_is_dict")
def test_frame_of_a_comparison_has_a_row_for_each_sample() -> None:
    frame: Any = comparison_by_hand(1.25, (1.0, 1.5)).to_frame()
    assert frame["run"] == ["there"] * 501 + ["back"] * 501
    np.testing.assert_array_equal(frame["residual_n"], frame["friction_n"] - frame["model_n"])
    # The record exceeds the model by 1 N in the direction of motion.
    np.testing.assert_allclose(frame["residual_n"], np.sign(frame["velocity_m_s"]), atol=1e-3)
    assert frame["counts"].all()


def numbers(text: str) -> list[str]:
    """Words of a text that begin with a digit."""
    return [word.strip(",;()") for word in text.split() if word[:1].isdigit()]


def test_repr_of_a_fit_has_runs_samples_rms_and_parameters() -> None:
    fit = fit_by_hand(["sensor_offset"])
    head, _, values = repr(fit).partition("\n")
    assert head.startswith("Fit(coulomb + sensor_offset;")
    assert numbers(head) == ["2", "1001", "0.525"]
    assert "F_v 20.44 +/- 0.52" in values
    assert "F_s held at" in values
    assert "not converged" in repr(replace(fit, converged=False))
    answers = {name: np.arange(20.0) for name in fit.parameters}
    assert repr(Bootstrap(fit, answers)).startswith("Bootstrap(20 fits")
    assert "f_m 0.2500 +/- 0.0012, U_tr_m_s 0.050000" in repr(TRAJECTORY)


def test_repr_of_a_comparison_and_a_diagnosis_have_error_and_noise() -> None:
    comparison = comparison_by_hand(1.25, (1.0, 1.5))
    assert numbers(repr(comparison)) == ["2", "1.25", "2.50", "0.500"]
    assert "lack of fit along direction" in repr(comparison)
    assert "no lack of fit" in repr(replace(comparison, failures=()))
    diagnosis = repr(diagnosis_by_hand("missing"))
    assert diagnosis.startswith("Diagnosis(missing: sensor_offset;")
    assert numbers(diagnosis) == ["0.550", "1.10", "0.500"]
    assert repr(diagnosis_by_hand("adequate")).startswith("Diagnosis(adequate;")


def test_repr_list_above_120_characters_is_shortened_after_an_item() -> None:
    assert LONGEST == 120
    assert first_of(["a" * 59, "b" * 59]) == f"{'a' * 59}, {'b' * 59}"
    assert first_of(["a" * 59, "b" * 60]) == f"{'a' * 59}, ..."
    assert first_of(["a" * 56, "b" * 56, "c" * 9]) == f"{'a' * 56}, {'b' * 56}, ..."
    assert first_of([]) == ""


@pytest.mark.parametrize(
    ("kind", "row"),
    [
        ("fit", ("F_c", "4.988", "0.012", "0.25 %", "N", "")),
        ("bootstrap", ("F_s", "held at 6.0000", "", "", "N", "held fixed")),
        ("trajectory fit", ("f_m", "0.2500", "0.0012", "0.48 %", "", "")),
        ("comparison", ("back", "500", "1.50", "3.00")),
        ("diagnosis", ("+ sensor_offset", "0.525", "0.550", "0.500", "1.10")),
    ],
)
def test_html_table_has_rows_of_a_result(results: Results, kind: str, row: tuple[str, ...]) -> None:
    cells = "".join(f"<td>{cell}</td>" for cell in row)
    assert f"<tr>{cells}</tr>" in results[kind]._repr_html_()


def test_html_table_of_an_import_states_why_a_piece_was_excluded() -> None:
    pieces = (Piece("r", "a.csv", 0, 0.0, 1.5), Piece("", "a.csv", 0, 1.5, 2.0, False, "at rest"))
    html = Import(Path("out"), Rig(), pieces, {})._repr_html_()
    assert "<td>r</td><td>a.csv</td><td>0.000</td><td>1.500</td>" in html
    assert "<td>left out: at rest</td><td>a.csv</td><td>1.500</td><td>2.000</td>" in html
