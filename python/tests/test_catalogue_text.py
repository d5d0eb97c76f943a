"""Effects as text, in the words of a bearing's rig and of a drive; power and level in words."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import jbf
import pytest
from jbf import Model, Parameter, ParameterValue, Rig
from jbf.diagnosis.decoys import rate_below
from jbf.diagnosis.level import Level
from jbf.diagnosis.power import Power
from jbf.models.catalogue import Effect, find_effect
from jbf.records.drive import Drive
from jbf.records.quantities import LINEAR, OF_BEARING, ROTARY
from jbf.reporting.catalogue_text import (
    NEEDS,
    effect_page,
    effects_page,
    meaning_of,
    refused_words,
)
from jbf.reporting.effect_words import effect_lines, known_mass, limits_of, summary_of
from jbf.reporting.power_text import level_words, plan_report, planned_report, power_lines

OFFSET = find_effect("sensor_offset")
JOINT = Rig(drive=Drive("rotary", "current", torque_constant_n_m_a=0.5, inertia_kg_m2=4.0))
SLIDE = Rig(drive=Drive("linear", "force", mass_kg=12.5))


def effect_of(**more: Any) -> Effect:
    """An effect whose page is known to the last word."""
    known = {"name": "sensor_offset", "summary": "a zero that is off", "equation": "F + b",
             "source": "here", "limits": "the cell and the journal", "needs": (), "refused": {},
             "parameters": ()}  # fmt: skip
    return replace(OFFSET, **cast(Any, {**known, **more}))


def test_laws_that_an_effect_does_not_go_with_stand_by_their_reason() -> None:
    """Each reason once, in the order of the first of its laws."""
    refused = {"a": "has no film", "b": "has one already", "c": "has no film"}
    assert refused_words(effect_of(refused=refused)) == ("a, c (has no film); b (has one already)")
    assert refused_words(effect_of()) == ""


def test_a_page_holds_all_that_the_catalogue_has_of_an_effect() -> None:
    """Facts that it has, and a row a parameter; a null only where there is one."""
    stated = Parameter("T", "s", meaning="how long", lower=0.5, upper=2.0, stated=True)
    free = Parameter("b_n", "N", meaning="the zero", lower=-50.0, upper=50.0, null=0.0)
    whole = effect_of(needs=("angle", "loads"), columns=("a", "b"), refused={"x": "has none"},
                      parameters=(free, stated))  # fmt: skip
    assert effect_page(whole).splitlines() == [
        "sensor_offset: a zero that is off",
        "",
        f"  stage     {OFFSET.stage}",
        "  equation  F + b",
        "  source    here",
        "  limits    the cell and the journal",
        f"  needs     {NEEDS['angle']}",
        f"  needs     {NEEDS['loads']}",
        "  columns   a, b",
        "  not with  x (has none)",
        "",
        "  parameter  unit  from  to  vanishes at  meaning",
        "  b_n        N      -50  50            0  the zero",
        "  T          s      0.5   2               how long (stated, not fitted)",
    ]
    assert meaning_of(free) == "the zero"
    bare = effect_page(effect_of()).splitlines()
    assert [line.split()[0] for line in bare[2:6]] == ["stage", "equation", "source", "limits"]
    assert bare[6:] == ["", "  parameter  unit  from  to  vanishes at  meaning"]


def test_effects_stand_below_the_heading_of_their_stage() -> None:
    """Names as wide as the widest; an empty line before each heading but the first."""
    pages = [
        effect_of(),
        effect_of(name="sensor_lag"),
        effect_of(name="wear_in", stage="other friction"),
        effect_of(name="nobodys", stage="other friction"),
    ]
    assert effects_page(pages).splitlines() == [
        f"[{OFFSET.stage}]",
        "  sensor_offset  a zero that is off",
        "  sensor_lag     a zero that is off",
        "",
        "[other friction]",
        "  wear_in        a zero that is off",
        "",
        "[your own, other friction]",
        "  nobodys        a zero that is off",
    ]
    assert effects_page([]) == ""


def test_effects_that_do_not_go_with_a_law_follow_with_the_reason() -> None:
    """A law in newtons has no bearing to speak of; without a refusal there is no heading."""
    pages = [effect_of(refused={"coulomb": "has no film"}), effect_of(name="sensor_lag")]
    lag = summary_of(pages[1], LINEAR)
    assert effects_page(pages, "coulomb").splitlines() == [
        f"[{OFFSET.stage}]",
        f"  sensor_lag  {lag}",
        "",
        "[not with coulomb: the law ...]",
        "  sensor_offset  has no film",
    ]
    assert effects_page(pages, "journal").splitlines() == [
        f"[{OFFSET.stage}]",
        "  sensor_offset  a zero that is off",
        "  sensor_lag     a zero that is off",
    ]


def test_an_effect_is_told_in_the_words_of_the_machine() -> None:
    """A bearing's rig has the catalogue's; a drive its own, or the catalogue's without a cell."""
    page = effect_of(summary="the cell on the journal, which gamma takes up")
    assert summary_of(page, OF_BEARING) == page.summary
    assert limits_of(page, OF_BEARING) == "the cell and the journal"
    assert limits_of(page, ROTARY) == "the torque sensor and what is driven"
    other = replace(page, name="wear_in")
    assert summary_of(other, LINEAR) == (
        "the force sensor on what is driven, which the law's viscous friction takes up"
    )
    mass = find_effect("inertia_leak")
    assert summary_of(mass, LINEAR) == (
        "the mass that the drive accelerates, in what the force sensor reads"
    )
    assert summary_of(mass, ROTARY).startswith("the inertia that the drive accelerates")
    assert summary_of(page, LINEAR) == (
        "the zero of the force sensor is off, or a constant force is there (gravity on an inclined "
        "axis, a spring, a counterweight)"
    )


def model_of(rig: Rig, stderr: float | None = 0.25) -> Model:
    """A model with a mass and an offset."""
    values = {
        "F_c_n": ParameterValue(5.0),
        "F_v_n_s_m": ParameterValue(20.0),
        "inertia_leak.m_e_kg": ParameterValue(11.0, stderr),
        "sensor_offset.b_n": ParameterValue(0.5),
    }
    return Model(rig, "coulomb", ["inertia_leak", "sensor_offset"], values)


def test_a_mass_that_was_found_stands_beside_the_one_that_is_known() -> None:
    """A drive's mass or a joint's inertia; nothing of another effect or of what nobody knows."""
    assert known_mass(model_of(SLIDE), "inertia_leak") == (
        "; 11.00 +/- 0.25 kg where the rig's file says 12.50"
    )
    assert known_mass(model_of(JOINT, None), "inertia_leak") == (
        "; 11.000 kg m^2 where the rig's file says 4.000"
    )
    assert known_mass(model_of(SLIDE), "sensor_offset") == ""
    assert known_mass(model_of(Rig()), "inertia_leak") == ""
    assert known_mass(model_of(Rig(drive=Drive("linear", "force"))), "inertia_leak") == ""


def test_what_the_effects_of_a_drive_are_is_told_below_its_parameters() -> None:
    """Each in a paragraph; nothing of a rig that is no drive, or of no effects."""
    model = model_of(SLIDE)
    lines = effect_lines(model)
    assert lines[:2] == ["", "What these effects are here"]
    said = " ".join(" ".join(lines[2:]).split())
    masses = summary_of(find_effect("inertia_leak"), LINEAR) + known_mass(model, "inertia_leak")
    assert said == f"inertia_leak: {masses} sensor_offset: {summary_of(OFFSET, LINEAR)}"
    assert lines[2].startswith("    inertia_leak: the mass")
    assert effect_lines(model_of(Rig())) == []
    values = {"F_c_n": ParameterValue(5.0), "F_v_n_s_m": ParameterValue(20.0)}
    assert effect_lines(Model(SLIDE, "coulomb", parameters=values)) == []


LEVEL = Level(0.025, 20, 0.00125, imperfection=0.0, worth=0.0)


def test_the_level_says_what_was_asked_and_nothing_else() -> None:
    """One clause each: blocks, recordings' own, worth, decoys; none where there is none."""
    first = (
        "noise makes a name in at most 2.5 % of such campaigns: of 20 candidates one must gain "
        f"{LEVEL.critical:.1f} in twice the log likelihood"
    )
    assert level_words(LEVEL) == first
    assert "of 1 candidate one must" in level_words(replace(LEVEL, candidates=1))
    assert level_words(replace(LEVEL, blocks=40)) == (
        f"{first}, by the residual itself, 40 blocks of it turned at random"
    )
    allowed = LEVEL.white + 100.0
    assert level_words(replace(LEVEL, imperfection=100.0)) == (
        f"{first}; with what recordings do to a record at least {allowed:.0f}"
    )
    assert level_words(replace(LEVEL, worth=1234.0)) == (
        f"{first}; to be worth a name it must gain 1234"
    )
    both = replace(LEVEL, imperfection=100.0, worth=allowed)
    assert "worth a name" not in level_words(both)
    assert "worth a name" in level_words(replace(both, worth=allowed + 1.0))
    assert "worth a name" not in level_words(replace(LEVEL, worth=LEVEL.critical))


def test_decoys_are_told_with_the_rate_that_they_allow() -> None:
    """In percent to two digits, all of it where it is nearly all."""
    said = level_words(replace(LEVEL, decoys=50, decoys_named=3))
    assert said.endswith(
        "; of 50 campaigns of decoys, candidates in the wrong place along these runs, 3 would have "
        f"made a name (false names below {100.0 * rate_below(3, 50):.2g} %)"
    )
    assert "false names below 100 %" in level_words(replace(LEVEL, decoys=2, decoys_named=2))


POWER = (
    Power("sensor_offset", "b_n", "N", 2.0, 3.0, False, 0.0123, 2.0, ("wear_in",)),
    Power("sensor_lag", "tau_s", "s", None, None, False, None, None, ()),
)


@pytest.mark.parametrize("not_tried", [{}, {"wear_in": "nothing wears", "backlash": "no way"}])
def test_planned_runs_say_what_they_would_show(not_tried: dict[str, str]) -> None:
    """Runs, model, noise; a line an effect; the level; what they cannot show."""
    model = model_of(Rig())
    planned = cast(Any, SimpleNamespace(runs=("a", "b"), model=model, noise_n=0.1, power=POWER,
                                        level=LEVEL, not_tried=not_tried))  # fmt: skip
    lines = planned_report(planned).splitlines()
    assert lines[:4] == [
        "2 runs beside coulomb + inertia_leak + sensor_offset, noise of 0.100 N",
        "",
        "What such runs show, in 80 of 100 campaigns",
        "    effect         found from  of friction  alone from  else it could be",
    ]
    assert lines[3:6] == power_lines(POWER, model)
    assert lines[4:6] == [
        "    sensor_offset  b_n 2.00 N        1.2 %        same  wear_in",
        "    sensor_lag     never",
    ]
    assert lines[6].startswith("    (noise makes a name")
    said = " ".join(planned_report(planned).split())
    assert f"sensor_lag never ({level_words(LEVEL)})" in said
    tail = ["", "Not asked for: these runs cannot show", "    wear_in: nothing wears",
            "    backlash: no way"]  # fmt: skip
    assert (lines[-4:] == tail) == bool(not_tried)
    plan = cast(Any, SimpleNamespace(runs=(SimpleNamespace(name="slow"),), words=("a sine",),
                                     planned=planned))  # fmt: skip
    assert plan_report(plan).splitlines() == [
        "Record, those that tell most first",
        "",
        "    run   motion",
        "    slow  a sine",
        "",
        *lines,
    ]


def test_every_effect_has_words_for_a_drive() -> None:
    """None of them speaks of a cell or a journal."""
    for page in jbf.effects().values():
        for said in (LINEAR, ROTARY):
            if "coulomb" not in page.refused:
                words = f"{summary_of(page, said)} {limits_of(page, said)}"
                assert "the cell" not in words, page.name
                assert "the journal" not in words, page.name
