"""The catalogue of effects as text, with the terms of a bearing and of a drive."""

import re
from dataclasses import replace
from typing import Any

import jbf
import pytest
from jbf import Drive, Model, ParameterValue, Rig
from jbf.models.catalogue import Effect, effects, find_effect
from jbf.records.quantities import LINEAR, ROTARY
from jbf.reporting.catalogue_text import effect_page, effects_page
from jbf.reporting.effect_words import effect_lines, known_mass, limits_of, summary_of

OFFSET = find_effect("sensor_offset")
JOINT = Rig(drive=Drive("rotary", "current", torque_constant_n_m_a=0.5, inertia_kg_m2=4.0))
SLIDE = Rig(drive=Drive("linear", "force", mass_kg=12.5))


def effect_of(**changes: Any) -> Effect:
    """An effect with a short description."""
    short: Any = {"summary": "a zero that is off", "equation": "F + b", "source": "here"}
    short |= {"limits": "the cell and the journal", "needs": (), "refused": {}, "parameters": ()}
    return replace(OFFSET, **short | changes)


def test_effect_list_has_every_effect_once_under_its_stage() -> None:
    pages = effects()
    text = effects_page(pages.values())
    stage, headings, placed = "", [], {}
    for line in text.splitlines():
        if line.startswith("["):
            headings.append(stage := line.strip("[]"))
        elif line[:3].strip() and line.split()[0] in pages:
            placed[line.split()[0]] = stage
    assert placed == {name: page.stage for name, page in pages.items()}
    assert len(headings) == len(set(headings)) > 2
    assert max(map(len, text.splitlines())) <= 100


def test_effects_that_a_law_excludes_are_listed_last_with_the_reason() -> None:
    pages = [effect_of(refused={"coulomb": "has no film"}), effect_of(name="sensor_lag")]
    lines = effects_page(pages, "coulomb").splitlines()
    excluded = lines.index("  sensor_offset  has no film")
    assert lines.index(f"  sensor_lag  {summary_of(pages[1], LINEAR)}") < excluded
    assert "not with coulomb" in lines[excluded - 1]
    assert "not with" not in effects_page(pages, "journal")


@pytest.mark.parametrize("name", list(effects()))
def test_page_of_an_effect_has_its_equation_source_and_parameters(name: str) -> None:
    effect = find_effect(name)
    page = effect_page(effect)
    for fact in ("stage", "equation", "source", "limits"):
        assert f"\n  {fact}" in page
    rows = [line.split() for line in page.partition("vanishes at")[2].splitlines()[1:]]
    for p, row in zip(effect.parameters, rows, strict=True):
        assert row[0] == p.name
        for value in (p.unit, f"{p.lower:g}", f"{p.upper:g}"):
            assert value in " ".join(row)


def test_descriptions_of_drive_effects_mention_neither_load_cell_nor_journal() -> None:
    for page in jbf.effects().values():
        for quantities in (LINEAR, ROTARY):
            if "coulomb" not in page.refused:
                text = f"{summary_of(page, quantities)} {limits_of(page, quantities)}"
                assert not re.search("the cell|the journal", text), page.name


def model_of(rig: Rig, stderr: float | None = 0.25) -> Model:
    """A model with a mass and an offset."""
    values: Any = {"F_c": 5.0, "F_v": 20.0, "sensor_offset.b": 0.5}
    values["inertia.m_e"] = ParameterValue(11.0, stderr)
    return Model(rig, "coulomb", ["inertia", "sensor_offset"], values)


def test_estimated_mass_or_inertia_is_printed_with_the_known_one_of_the_drive() -> None:
    slide = known_mass(model_of(SLIDE), "inertia")
    assert "11.00 +/- 0.25 kg" in slide
    assert "12.50" in slide
    joint = known_mass(model_of(JOINT, None), "inertia")
    assert "11.000 kg m^2" in joint
    assert "4.000" in joint
    assert known_mass(model_of(SLIDE), "sensor_offset") == ""
    for without_mass in (Rig(), Rig(drive=Drive("linear", "force"))):
        assert known_mass(model_of(without_mass), "inertia") == ""


def test_effects_are_described_below_the_parameters_only_if_the_rig_has_a_drive() -> None:
    model = model_of(SLIDE)
    text = " ".join(" ".join(effect_lines(model)).split())
    assert f"inertia: {summary_of(find_effect('inertia'), LINEAR)}" in text
    assert known_mass(model, "inertia") in text
    assert f"sensor_offset: {summary_of(OFFSET, LINEAR)}" in text
    assert effect_lines(model_of(Rig())) == []
