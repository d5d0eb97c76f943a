"""Robustness of a compensator with a wrong model: cases, error ratios and verdict."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from jbf import Model, Rig
from jbf.control import TASKS, THESIS_BENCH, NoCompensation, Observed, run, thesis_model, tune
from jbf.control.bench import with_noise
from jbf.control.robustness import (
    HARM,
    HELP,
    STRONG,
    Case,
    Outcome,
    cases,
    fit_to_simulated_records,
    robustness,
)
from jbf.models.catalogue import find_effect
from shared import shared

PAGE = Path(__file__).resolve().parents[3] / "docs" / "control.md"
SQUARE = {"position square": TASKS["position square"]}
BASE = thesis_model(elastic="nothing")
"""The model of a rigid bearing, which the compensator uses."""


@shared
def all_cases() -> dict[str, Case]:
    """The cases of the rigid bearing by name."""
    return {case.name: case for case in cases(BASE)}


@shared
def square_outcomes() -> dict[str, Outcome]:
    """Result of each case for the square wave in position, by name."""
    return {o.name: o for o in robustness(tasks=SQUARE)}


@pytest.mark.parametrize(
    ("worst", "verdict"),
    [(0.94, "help"), (HELP, "neutral"), (HARM, "neutral"), (1.03, "harm")],
)
def test_robustness_verdict_is_determined_by_the_largest_error_ratio_of_all_tasks(
    worst: float, verdict: str
) -> None:
    assert (HELP, HARM) == (0.95, 1.02)
    for ratios in ((0.1, worst), (worst, 0.1)):
        outcome = Outcome("", dict(zip("ab", ratios, strict=True)))
        assert (outcome.worst, outcome.verdict) == (worst, verdict)


@pytest.mark.extended
def test_each_hidden_effect_is_added_to_the_plant_at_its_strong_or_starting_value() -> None:
    hidden = {n.removeprefix("hidden "): c for n, c in all_cases().items() if "hidden" in n}
    assert set(STRONG) <= set(hidden)
    assert len(hidden) > 15
    for name, case in hidden.items():
        page = find_effect(name)
        assert "journal" not in page.refused
        if page.stage == "instrument":
            continue
        assert case.carried is None
        assert set(case.plant.effects) == {name}
        for p in page.parameters:
            expected = STRONG.get(name, {}).get(p.name, p.starts[0])
            assert case.plant.parameters[f"{name}.{p.name}"].value == expected
        # The load dependence has an influence only if the load differs from the reference.
        assert case.load_factor == (1.5 if name == "load_dependence" else 1.0)


@pytest.mark.extended
def test_hidden_sensor_offset_alters_the_compensator_model_but_not_the_plant() -> None:
    offset = all_cases()["hidden sensor_offset"]
    assert offset.plant == BASE
    assert offset.carried.effects == ()
    assert offset.carried.parameters["f_m"].value != BASE.parameters["f_m"].value


def test_fit_of_records_without_a_hidden_effect_recovers_the_model() -> None:
    found, true = fit_to_simulated_records(BASE, BASE).parameters, BASE.parameters
    for name in ("f_m", "U_tr_m_s", "gamma"):
        assert found[name].value == pytest.approx(true[name].value, rel=0.05), name
        assert abs(found[name].value - true[name].value) < 4.0 * found[name].stderr


def test_robustness_cases_with_a_wrong_constant_differ_by_the_factor_they_name() -> None:
    found = all_cases()
    for name, field, factor in (
        ("friction 50 % larger", "volts_per_n", 3 / 2),
        ("friction 33 % smaller", "volts_per_n", 2 / 3),
        ("motor gain 10 % larger", "input_rad_s2_v", 1.1),
        ("motor gain 10 % smaller", "input_rad_s2_v", 0.9),
        ("noise quadrupled", "input_noise_v", 4.0),
    ):
        expected = factor * getattr(THESIS_BENCH, field)
        assert getattr(found[name].bench, field) == pytest.approx(expected), name
    for word, factor in (("doubled", 2.0), ("halved", 0.5)):
        assert found[f"load {word}"].load_factor == factor
        viscosity = found[f"viscosity {word}"].plant.rig.lubricant.viscosity_pa_s
        assert viscosity == pytest.approx(factor * BASE.rig.lubricant.viscosity_pa_s)


@pytest.mark.extended
def test_robustness_cases_exclude_effects_of_the_model_and_viscosity_if_the_law_has_no_film() -> (
    None
):
    names = {case.name for case in cases(Model(Rig.thesis(), "coulomb", ["running_in"]))}
    assert "hidden running_in" not in names
    assert "hidden coulomb_drag" not in names  # already contained in the law
    assert not any("viscosity" in name for name in names)
    assert "load doubled" in names


EXTENDED_CASES = (
    pytest.param(name, marks=pytest.mark.extended) for name in ("load doubled", "hidden running_in")
)


@pytest.mark.parametrize("name", ["friction 33 % smaller", *EXTENDED_CASES])
def test_robustness_ratio_is_the_error_with_over_that_without_compensation(name: str) -> None:
    """A task of 27 s; both loops are designed for the undisturbed bench."""
    case = all_cases()[name]
    task = replace(TASKS["position square"], seconds=27.0)
    load_n = case.load_factor * BASE.rig.load.normal_n
    without, with_ = (
        run(case.plant, s, task, bench=case.bench, assumed=THESIS_BENCH, load_n=load_n).true_rms
        for s in (NoCompensation(), Observed(BASE, tune(BASE)))
    )
    assert square_outcomes()[name].ratios == {"position square": pytest.approx(with_ / without)}


def test_robustness_ratios_agree_with_the_table_of_the_documentation() -> None:
    """In every case the largest error ratio is that of the square wave in position."""
    section = PAGE.read_text(encoding="utf-8").partition("## When the model is wrong")[2]
    rows = re.findall(r"\| `?([a-z_][\w %]*?)`? \| (\d\.\d{3}) ", section)
    printed = {name: float(ratio) for name, ratio in rows}
    found = {n.removeprefix("hidden "): o.worst for n, o in square_outcomes().items()}
    assert found == pytest.approx(printed, abs=6e-4)
    assert set(printed) == {n.removeprefix("hidden ") for n in all_cases()}
    assert max(found.values()) < HELP


def test_robustness_ratio_of_no_compensation_is_one() -> None:
    task = {"velocity sine": TASKS["velocity sine"]}
    found = robustness(Model(Rig(), "coulomb"), tasks=task, scheme=NoCompensation())
    assert {(o.ratios["velocity sine"], o.verdict) for o in found} == {(1.0, "neutral")}


@pytest.mark.extended
def test_compensation_never_exceeds_the_harm_limit_at_four_times_the_noise() -> None:
    rows = {row: TASKS[row] for row in ("position sine", "velocity triangle")}
    found = robustness(bench=with_noise(THESIS_BENCH, 4.0), tasks=rows)
    assert len(found) > 20
    assert [o.name for o in found if o.worst > HARM] == []
