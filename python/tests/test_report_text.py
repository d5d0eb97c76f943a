"""Reports section by section: what stands there, and what does not where there is nothing."""

from __future__ import annotations

import importlib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand, fit_by_hand
from jbf import Bootstrap, Model, ParameterValue, Rig, TrajectoryFit
from jbf.control import TASKS, Task, run
from jbf.diagnosis.check import Rate
from jbf.diagnosis.power import Power
from jbf.diagnosis.which_law import LawTried
from jbf.importing.cutting.piece import Piece
from jbf.importing.result import Import
from jbf.records.findings.finding import Finding
from jbf.reporting import door, fit_page, pictures
from jbf.reporting.check_text import check_report
from jbf.reporting.comparison_page import comparison_page
from jbf.reporting.comparison_text import comparison_report
from jbf.reporting.control_run_text import runs_text
from jbf.reporting.diagnosis_text import diagnosis_report
from jbf.reporting.fit_text import bootstrap_report, fit_report, noise_words
from jbf.reporting.frames import comparison_columns, parameter_columns
from jbf.reporting.power_text import level_words
from jbf.reporting.small_tables import (
    bootstrap_table,
    check_table,
    fit_table,
    import_table,
    loop_table,
    model_table,
    plan_table,
    planned_table,
    run_table,
    table,
    trajectory_table,
)

GAP = Finding("gaps", "time_s", "there", 0.1, "s", "stepped over", "3 rows are missing")


def test_a_comparison_without_a_pattern_says_so_and_tells_its_findings() -> None:
    """No heading for what does not fail."""
    made = comparison_by_hand(1.25, (1.0, 1.5))
    campaign = replace(made.campaign, more_findings=(GAP,))
    found = replace(made, failures=(), campaign=campaign)
    assert comparison_report(found).splitlines() == [
        "RMS 1.25 N against a noise floor of 0.500 N: 2.50 times the noise; no pattern along any "
        "axis",
        "",
        "Runs",
        "    run    samples  RMS (N)  RMS / noise",
        "    there      501     1.00         2.00",
        "    back       500     1.50         3.00",
        "",
        "What the recording did",
        "    gaps: 3 rows are missing, in there (stepped over)",
    ]


def test_a_diagnosis_tells_which_laws_were_tried_and_what_these_runs_would_show() -> None:
    """Each section only where there is something to say."""
    power = (Power("sensor_lag", "tau_s", "s", 0.01, 0.02, False, 0.1, 0.02, ()),)
    laws = (LawTried("coulomb", 2, 0.55, True), LawTried("stribeck", 4, 0.551, True))
    bare = diagnosis_by_hand("missing")
    told = replace(bare, power=power, laws=laws, findings=(GAP,), not_tried={})
    lines = diagnosis_report(told).splitlines()
    at = lines.index("Which law, each beside a zero, a mass and a weight of its own")
    assert lines[at - 1] == ""
    assert lines[at + 1 : at + 5] == [
        "    law       parameters  held out (N)",
        "    coulomb            2         0.550  taken",
        "    stribeck           4         0.551  predicts as well",
        "",
    ]
    at = lines.index("What these runs would have shown, in 80 of 100 campaigns like this one")
    assert lines[at - 1] == ""
    assert lines[at + 1 : at + 3] == [
        "    effect      found from      of friction  alone from  else it could be",
        "    sensor_lag  tau_s 0.0100 s         10 %      0.0200",
    ]
    assert lines[at + 3].startswith("    (noise makes a name")
    said = " ".join(diagnosis_report(told).split())
    assert f"({level_words(told.level)}) The error falling (N)" in said
    assert "What the recording did gaps: 3 rows are missing, in there (stepped over)" in said
    plain = diagnosis_report(replace(bare, not_tried={}))
    for heading in ("Which law", "What these runs", "What the recording did", "Not tried"):
        assert heading not in plain
    first, last = bare.steps
    later = replace(bare, steps=(replace(first, trials=()), replace(last, trials=first.trials)))
    told_later = diagnosis_report(later)
    assert "Candidates tried beside the bare law + sensor_offset" in told_later
    assert "Candidates tried beside the bare law\n" not in told_later
    untried = replace(bare, steps=tuple(replace(s, trials=()) for s in bare.steps))
    assert "Candidates tried" not in diagnosis_report(untried)


def test_a_bare_law_that_does_not_fail_has_no_pattern() -> None:
    """And what remains is nothing."""
    said = diagnosis_report(diagnosis_by_hand("adequate")).splitlines()
    assert "    and shows no pattern along any axis" in said
    assert said[said.index("What remains") + 1] == "    nothing that stands above the noise"
    assert any(line.endswith("5.00 times the noise") for line in said)


def test_a_check_tells_each_rate_with_its_interval() -> None:
    """In percent to three digits, below the model that was recorded again."""
    rates = (Rate("nothing hidden, and adequate", 199, 200, 0.9725, 0.99987),
             Rate("hidden, and named", 1, 3, 0.0084, 0.9057))  # fmt: skip
    check = cast(Any, SimpleNamespace(rates=rates, model=Model(Rig.thesis())))
    assert check_report(check).splitlines() == [
        "Recorded again by journal (clock journal)",
        "",
        "campaigns like this one         so often   share   95 % interval",
        "nothing hidden, and adequate  199 of 200  99.5 %   97.2 to 100 %",
        "hidden, and named                 1 of 3  33.3 %  0.84 to 90.6 %",
    ]
    said = check_table(check)
    assert "<p>Recorded again by journal (clock journal)</p>" in said
    assert said.count("<tr>") == 4


def test_a_noise_is_white_or_has_a_share_of_colour() -> None:
    """Two digits each."""
    noise = fit_by_hand().noise
    assert noise_words(replace(noise, colour=0.0)) == "white"
    assert noise_words(replace(noise, colour=0.126, memory_s=0.0149)) == (
        "coloured, share 0.13, memory 0.015 s"
    )


PAGES: list[tuple[str, Any, str, str]] = [
    ("fit_page", fit_by_hand(), "Fit", "Parameters with standard errors; residuals run after run"),
    ("bootstrap_page", Bootstrap(fit_by_hand(), {n: np.ones(3) for n in fit_by_hand().parameters}),
     "Fit, with errors from fits again", "Parameters, and the answers of repeated fits"),
    ("trajectory_page", TrajectoryFit({"f_m": ParameterValue(0.25, 0.01)}, 1.0, 2, 3, True, ""),
     "Fit of trajectories", "Parameters with standard errors"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "result", "title", "alt"), PAGES)
def test_a_page_of_a_fit_has_its_report_and_its_picture(
    name: str, result: Any, title: str, alt: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same words as the summary's; the door leads to it."""
    made: dict[str, Any] = {}

    def page(template: str, head: str, **content: Any) -> str:
        made.update(content, template=template, title=head)
        return "a page"

    monkeypatch.setattr(fit_page, "page", page)
    monkeypatch.setattr(fit_page, "svg", lambda axes, alt: (alt, len(axes)))
    assert getattr(fit_page, name)(result) == door.page(result) == "a page"
    assert (made["template"], made["title"]) == ("text.html.j2", title)
    assert made["words"] == door.summary(result) == result.summary()
    assert made["picture"] == (alt, len(pictures.plot(result)))


def test_a_loop_has_a_table_and_a_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its errors to three digits, its status, its unit."""
    short = Task("velocity", "sine", -1.0, 1.0, 1.0, seconds=2.0)
    loop = run(None, "none", short)
    monkeypatch.setattr(fit_page, "page", lambda *given, **content: (given, content["words"]))
    monkeypatch.setattr(fit_page, "svg", lambda axes, alt: alt)
    made: Any = fit_page.loop_page(loop)
    assert made == (("text.html.j2", "Loop: none"), runs_text([loop]))
    said = loop_table(replace(loop, status=np.zeros(len(loop.time_s), dtype=np.uint8)))
    assert "<p>velocity control, sine</p>" in said
    for word in ("RMS (rad/s)", "peak (rad/s)", "true RMS (rad/s)", "<td>ok</td>"):
        assert word in said
    assert TASKS["position sine"].unit == "rad"


def test_small_tables_are_escaped_row_by_row() -> None:
    """A title, a head, and a row each."""
    assert table("a < b", ("h&",), [("<x>",), ("y",)]) == (
        "<p>a &lt; b</p><table><tr><th>h&amp;</th></tr><tr><td>&lt;x&gt;</td></tr>"
        "<tr><td>y</td></tr></table>"
    )


def test_small_tables_of_every_result_have_their_title() -> None:
    """What it is, and how good."""
    fit = fit_by_hand(["sensor_offset"])
    assert "<p>Fit: coulomb + sensor_offset; RMS 0.525 N</p>" in fit_table(fit)
    lost = fit_table(replace(fit, converged=False))
    assert "<p>Fit: coulomb + sensor_offset; RMS 0.525 N, not converged</p>" in lost
    assert lost.count("<tr>") == 5
    again = bootstrap_table(Bootstrap(fit, {}))
    assert "<p>Errors from fits of simulated records</p>" in again
    assert again.count("<tr>") == 5
    values = {"f_m": ParameterValue(0.25, 0.01), "U_tr_m_s": ParameterValue(0.05)}
    told = trajectory_table(TrajectoryFit(values, 1.0, 77, 3, True, ""))
    assert "<p>Fit of trajectories: 77 samples</p>" in told
    assert told.count("<tr>") == 3
    assert "<p>Model: coulomb + sensor_offset</p>" in model_table(fit.model)
    one = comparison_by_hand(1.0, (1.0, 1.0)).campaign.prepared[0].run
    said = run_table(replace(one, name="a", extra={"none": np.zeros(0)}))
    assert f"<p>Run a: {len(one)} samples, 10 s</p>" in said
    assert "<td>time_s</td><td>0</td><td>10.0</td>" in said
    assert "none" not in said
    pieces = (Piece("r", "a.csv", 0, 0.0, 1.5), Piece("", "a.csv", 0, 1.5, 2.0, False, "at rest"))
    said = import_table(Import(Path("out"), Rig(), pieces, {}))
    assert "<p>Import: out</p>" in said
    assert "<td>r</td><td>a.csv</td><td>0.000</td><td>1.500</td>" in said
    assert "<td>left out: at rest</td><td>a.csv</td><td>1.500</td><td>2.000</td>" in said


def test_planned_runs_have_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    """A row an effect; a row a run."""
    power = (Power("sensor_lag", "tau_s", "s", 0.01, 0.02, False, 0.1, 0.02, ()),)
    planned = cast(Any, SimpleNamespace(power=power, model=fit_by_hand().model, runs=("a", "b")))
    said = planned_table(planned)
    assert "<p>PlannedPower: 2 runs show 1 of 1 effect, each from" in said
    assert said.count("<tr>") == 2
    runs = (SimpleNamespace(name="slow"), SimpleNamespace(name="fast"))
    plan = cast(Any, SimpleNamespace(runs=runs, words=("one", "two"), planned=planned))
    assert "<td>slow</td><td>one</td></tr><tr><td>fast</td><td>two</td>" in plan_table(plan)


def test_a_frame_has_a_row_a_parameter_and_a_row_a_sample() -> None:
    """A parameter that no page knows has no unit; one without an error has none."""
    found = parameter_columns("coulomb", (), {"F_c_n": ParameterValue(5.0), "own": ParameterValue(
        1.0, 0.5, "a note")})  # fmt: skip
    assert (found["unit"], found["note"]) == (["N", ""], ["", "a note"])
    assert np.isnan(found["stderr"][0])
    assert (found["stderr"][1], found["value"]) == (0.5, [5.0, 1.0])
    whole = comparison_columns(comparison_by_hand(1.0, (1.0, 1.0)))
    assert list(whole) == ["run", "time_s", "velocity_m_s", "friction_n", "model_n", "residual_n",
                           "counts"]  # fmt: skip
    assert {len(values) for values in whole.values()} == {1002}


def test_the_page_of_a_comparison_holds_its_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sentence, axes, law, patterns and runs; four pictures."""
    page: Any = importlib.import_module("jbf.reporting.comparison_page")
    monkeypatch.setattr(page, "page", lambda template, title, **content: (title, content))
    monkeypatch.setattr(page, "svg", lambda axes, alt: alt)
    made: Any = comparison_page(comparison_by_hand(1.25, (1.0, 1.5)), "jbf compare")
    title, told = made
    assert (title, told["command"]) == ("Model against measurement", "jbf compare")
    assert (told["axes"], told["law"], told["unit"]) == ("direction", "law coulomb", "N")
    assert told["failures"] == [("direction", "60 %", "record above the model")]
    assert told["runs"][0] == ("there", "501", "1.00", "2.00")
    assert told["measurement"].endswith("noise floor 0.500 N")
    assert sum(name.endswith("picture") for name in told) == 4


@pytest.mark.parametrize("verb", ["summary", "small_table", "columns"])
def test_the_door_knows_no_stranger(verb: str) -> None:
    """And says of what kind it is."""
    with pytest.raises(TypeError, match="reporting knows no result of type int"):
        getattr(door, verb)(3)
    for ask in (pictures.plot, pictures.page, door.plot, door.page):
        with pytest.raises(TypeError, match="reporting knows no result of type int"):
            ask(3)
    assert door.short_words(object).startswith("<")


def test_the_report_of_a_bootstrap_counts_its_answers() -> None:
    """Above the fit."""
    fit = fit_by_hand()
    found = Bootstrap(fit, {n: np.arange(7.0) for n in fit.parameters})
    assert bootstrap_report(found) == (
        f"Errors from 7 fits of simulated records of the same runs\n{fit_report(fit)}"
    )
