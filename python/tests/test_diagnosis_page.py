"""What stands on the page of a diagnosis: every table, every picture and its size."""

from __future__ import annotations

import importlib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import TRIALS, diagnosis_by_hand, fit_by_hand
from jbf import Diagnosis, ParameterValue
from jbf.errors import InputError
from jbf.plot.ranking import ranking_height
from jbf.plot.style import BEFORE, MODEL
from jbf.reporting.diagnosis_page import diagnosis_page

PAGE = importlib.import_module("jbf.reporting.diagnosis_page")


@pytest.fixture(autouse=True)
def parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page as what its template is given, a picture as its words and its axes."""
    monkeypatch.setattr(PAGE, "page", lambda template, title, **content: (template, title, content))
    monkeypatch.setattr(PAGE, "svg", lambda axes, alt: (alt, axes))
    monkeypatch.setattr(PAGE, "failure_cards", lambda d: ["failures"])
    monkeypatch.setattr(PAGE, "remainder_cards", lambda d: ["remainders"])


def content_of(diagnosis: Diagnosis, command: str = "") -> dict[str, Any]:
    """What the template is given."""
    made: Any = diagnosis_page(diagnosis, command)
    template, title, content = made
    assert (template, title) == ("diagnosis.html.j2", f"Diagnosis: {diagnosis.verdict}")
    return dict(content)


def size_of(picture: tuple[str, list[Any]]) -> tuple[float, float]:
    """Width and height of a picture, inches."""
    width, height = picture[1][0].figure.get_size_inches()
    return float(width), float(height)


def test_verdict_measurement_and_tables_are_the_diagnosiss() -> None:
    """Headline and rest, noise of the bare law, ledger, laws, parameters, correlations."""
    told = content_of(diagnosis_by_hand("missing"), "jbf diagnose")
    assert (told["command"], told["verdict"]) == ("jbf diagnose", "missing")
    assert (told["headline"], told["next_experiment"]) == ("Missing: sensor_offset.", None)
    assert told["measurement"] == (
        "2 runs of 20 s in all, 1002 samples where the sign of the motion is known, noise floor "
        "0.500 N"
    )
    assert (told["failures"], told["unexplained"]) == (["failures"], ["remainders"])
    assert (told["unit"], told["taken_out"], told["remains"]) == ("N", "", False)
    assert [row[0] for row in told["ledger"]] == ["bare law", "+ sensor_offset"]
    assert [row[0] for row in told["parameters"]] == [
        "F_c_n", "F_s_n", "F_v_n_s_m", "sensor_offset.b_n"
    ]  # fmt: skip
    assert told["held"] == [1]
    assert told["correlations"] == (
        "F_c_n with F_v_n_s_m -0.90; F_c_n with sensor_offset.b_n +0.45"
    )
    assert told["not_tried"] == [("position_ripple", "not every run has the shaft's angle")]
    assert (told["imported"], told["files"], told["laws"], told["unseen"]) == ([], [], [], "")
    assert content_of(diagnosis_by_hand("unexplained"))["remains"] is True
    assert content_of(diagnosis_by_hand("adequate"))["unseen"] == "backlash"
    assert content_of(diagnosis_by_hand("ambiguous"))["next_experiment"] == "record a rest"


def test_no_more_than_five_correlations_are_told() -> None:
    """The strongest."""
    d = diagnosis_by_hand("missing")
    size = 4
    table = np.eye(size)
    for k, (i, j) in enumerate([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]):
        table[i, j] = table[j, i] = 0.9 - 0.1 * k
    parameters = {f"own_{i}": ParameterValue(1.0, 0.1) for i in range(size)}
    fit = replace(fit_by_hand(), parameters=parameters, correlations=table)
    told = content_of(replace(d, fit=fit))["correlations"].split("; ")
    assert [words[-5:] for words in told] == ["+0.90", "+0.80", "+0.70", "+0.60", "+0.50"]


def test_runs_have_their_error_before_and_after() -> None:
    """Over the noise of the final model; where nothing was added each has but one."""
    told = content_of(diagnosis_by_hand("missing"))
    assert told["run_head"] == (
        "run", "samples", "bare law (N)", "final model (N)", "final / noise"
    )  # fmt: skip
    assert told["runs"] == [
        ("there", "501", "2.00", "0.450", "0.90"),
        ("back", "500", "3.00", "0.600", "1.20"),
    ]
    told = content_of(diagnosis_by_hand("unexplained"))
    assert told["run_head"] == ("run", "samples", "RMS (N)", "RMS / noise")
    assert told["runs"] == [("there", "501", "2.00", "4.00"), ("back", "500", "3.00", "6.00")]


def test_a_round_tells_who_gained_and_names_who_did_not() -> None:
    """A picture where somebody gained; a round that tried nobody is none."""
    d = diagnosis_by_hand("missing")
    second = replace(d.steps[1], trials=(replace(TRIALS[3], evidence=0.0), TRIALS[2]))
    first, last = content_of(replace(d, steps=(d.steps[0], second)))["rounds"]
    assert (first.beside, last.beside) == ("bare law", "bare law + sensor_offset")
    assert [row[0] for row in first.rows] == ["sensor_offset", "sensor_drift", "inertia_leak"]
    assert first.nothing == last.nothing == "sensor_lag"
    assert [row[0] for row in last.rows] == ["inertia_leak"]
    assert first.picture[0] == "Evidence of each candidate"
    assert size_of(first.picture) == pytest.approx((10.0, ranking_height(d.steps[0])))
    untried = replace(d.steps[0], trials=())
    (only,) = content_of(replace(d, steps=(untried, second)))["rounds"]
    assert only.beside == "bare law + sensor_offset"
    none = replace(d.steps[0], trials=(replace(TRIALS[3], evidence=0.0),))
    (only,) = content_of(replace(d, steps=(none, d.steps[1])))["rounds"]
    assert (only.picture, only.rows, only.nothing) == ("", [], "sensor_lag")


def test_the_two_models_stand_side_by_side_where_something_was_added() -> None:
    """In the run in which they differ most, the record once and each model in its colour."""
    d = diagnosis_by_hand("missing")
    alt, (left, right) = content_of(d)["before_picture"]
    assert alt == "Bare law and final model, in one run and along the worst axis"
    assert left.get_title(loc="left") in ("Run there", "Run back")
    words = [t.get_text() for t in left.get_legend().get_texts()]
    assert words == ["measured", "bare law", "final"]
    colours = [line.get_color() for line in left.lines]
    assert BEFORE in colours
    assert MODEL in colours
    assert right.get_title(loc="left") == "Residual along direction"
    assert size_of((alt, [left])) == pytest.approx((10.0, 3.3))
    assert content_of(diagnosis_by_hand("unexplained"))["before_picture"] == ""


def test_pictures_of_the_final_model_are_as_wide_as_the_page() -> None:
    """What it leaves in time and along an axis; loops beside means; the ledger by its steps."""
    d = diagnosis_by_hand("missing")
    told = content_of(d)
    alt, (left, right) = told["last_picture"]
    assert alt == "Residual of the final model in time, and along its worst axis"
    # It leaves most in the second run.
    assert left.get_title(loc="left") == "Final model: residual, run back"
    assert right.get_title(loc="left") == "Residual along direction"
    assert size_of((alt, [left])) == pytest.approx((10.0, 3.6))
    alt, axes = told["friction_picture"]
    assert alt == "Friction against speed in one run, and means over all runs"
    assert len(axes) == 2
    assert size_of((alt, axes)) == pytest.approx((10.0, 4.0))
    assert size_of(told["map_picture"]) == pytest.approx((10.0, 4.2))
    assert told["map_picture"][0] == "Samples of all runs over speed and friction"
    assert told["residual_picture"][0] == "What the final model leaves, in all runs"
    alt, axes = told["ledger_picture"]
    assert alt == "Error of each step, fit and held out, and the noise"
    assert size_of((alt, axes)) == pytest.approx((10.0, 1.25 + 2 * 0.3))
    bare = content_of(diagnosis_by_hand("unexplained"))["ledger_picture"]
    assert size_of(bare) == pytest.approx((10.0, 1.25 + 0.3))


def test_power_has_a_picture_unless_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """As wide as the page."""
    monkeypatch.setattr(PAGE, "power", lambda diagnosis, ax: ax)
    picture = content_of(diagnosis_by_hand("missing"))["power_picture"]
    assert picture[0] == "Chance that such runs show an effect, over its strength"
    assert size_of(picture) == pytest.approx((10.0, 3.6))

    def refused(*_: object, **__: object) -> None:
        raise InputError(problem="no power", mend="none")

    monkeypatch.setattr(PAGE, "power", refused)
    assert content_of(diagnosis_by_hand("missing"))["power_picture"] == ""


def test_an_effect_that_was_added_has_its_page() -> None:
    """In the words of the rig; none where none was added."""
    (effect,) = content_of(diagnosis_by_hand("missing"))["effects"]
    assert effect.name == "sensor_offset"
    assert effect.summary.startswith("the zero of the force sensor is off")
    assert "the cell" not in effect.limits
    assert content_of(diagnosis_by_hand("unexplained"))["effects"] == []
