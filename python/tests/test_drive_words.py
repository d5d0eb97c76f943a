"""One record told as a slide's and as a joint's: the same numbers, each in its own quantities."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf import Comparison, Diagnosis, Fit, Model, Rig, Run
from jbf.cli import main
from jbf.cli.diagnose_many import _table
from jbf.export.c import c
from jbf.export.rust import rust
from jbf.models.catalogue import find_parameter, laws, parameters_of
from jbf.models.parameter_units import bare_name, shown, unit_of
from jbf.records.drive import Drive
from jbf.records.findings.saturation import find_saturation
from jbf.records.quantities import LINEAR, OF_BEARING, ROTARY
from jbf.records.run import run_on
from jbf.reporting.comparison_plots import plot_run
from jbf.reporting.effect_words import limits_of, summary_of
from rigsim import AxisRun, axis_campaign

SLIDE = Rig(drive=Drive("linear", "force"))
JOINT = Rig(drive=Drive("rotary", "current", torque_constant_n_m_a=0.5, inertia_kg_m2=4.0))
HIDDEN = ("inertia_leak", "sensor_offset")
FOREIGN = re.compile(r"bearing|\bcell\b|journal|shaft|newton|surface speed", re.IGNORECASE)
BARE_N = re.compile(r"\bN\b(?! m)|(?<!N )\bm/s\b|\d m\b|\(m\)")
"""A unit that a rotary drive does not have."""


@cache
def records() -> tuple[AxisRun, ...]:
    return tuple(axis_campaign(21, HIDDEN)[0])


def runs_of(rig: Rig) -> list[Run]:
    place = "position_m" if rig is SLIDE else "angle_rad"
    return [
        Run.from_arrays(r.time_s, r.velocity_m_s, r.force_n, name=r.name, **{place: r.path})
        for r in records()
    ]


@cache
def fitted(rig: Rig, effects: tuple[str, ...] = HIDDEN) -> Fit:
    return jbf.fit(rig, runs_of(rig), effects, law="coulomb")


@cache
def diagnosed(rig: Rig) -> Diagnosis:
    return jbf.diagnose(rig, runs_of(rig), law="coulomb")


@cache
def compared(rig: Rig) -> Comparison:
    return jbf.compare(fitted(rig, ()).model, runs_of(rig))


def page_of(result: Diagnosis | Comparison | Fit, folder: Path) -> str:
    """The words of a page, without its pictures."""
    result.save_html(folder / "page.html")
    text = (folder / "page.html").read_text()
    return re.sub(r"<style.*?</style>|<[^>]*>", " ", text, flags=re.DOTALL)


def test_the_numbers_are_the_same() -> None:
    slide, joint = fitted(SLIDE), fitted(JOINT)
    assert slide.values == joint.values
    assert slide.rms_n == joint.rms_n
    slides, joints = diagnosed(SLIDE), diagnosed(JOINT)
    # In motion alone a zero is a dry asymmetry as well.
    assert (slides.verdict, set(slides.effects)) == ("ambiguous", set(HIDDEN))
    assert slides.alternatives == {"inertia_leak": (), "sensor_offset": ("dry_asymmetry",)}
    assert (joints.verdict, joints.effects) == (slides.verdict, slides.effects)
    assert [s.holdout_rms_n for s in joints.steps] == [s.holdout_rms_n for s in slides.steps]


def test_parameters_of_a_joint_have_its_names_and_units() -> None:
    lines = fitted(JOINT).report().partition("\n[[Correl")[0].partition("\nWhat")[0].splitlines()
    told = {line.split()[0]: line.split("  ")[-1].strip() for line in lines if "+/-" in line}
    assert told == {
        "F_c": "N m",
        "F_v": "N m s/rad",
        "inertia_leak.m_e": "kg m^2",
        "sensor_offset.b": "N m",
    }
    lines = fitted(SLIDE).report().splitlines()
    told = {line.split()[0]: line.split("  ")[-1].strip() for line in lines if "+/-" in line}
    assert told == {
        "F_c_n": "N",
        "F_v_n_s_m": "N s/m",
        "inertia_leak.m_e_kg": "kg",
        "sensor_offset.b_n": "N",
    }


@pytest.mark.parametrize("result", [fitted, diagnosed, compared])
@pytest.mark.parametrize("rig", [SLIDE, JOINT])
def test_no_word_of_bearings_is_said(result: object, rig: Rig, tmp_path: Path) -> None:
    found = result(rig)  # type: ignore[operator]
    said = [found.summary(), repr(found), found._repr_html_(), page_of(found, tmp_path)]
    for text in said:
        assert FOREIGN.search(text) is None
        if rig is JOINT:
            assert BARE_N.search(text) is None
            assert "N m" in text
        else:
            assert "N m" not in text


def test_what_a_zero_and_a_mass_are_here() -> None:
    said = " ".join(fitted(JOINT).report().split())
    assert "sensor_offset: the zero of the current sensor is off, or a constant torque" in said
    mass = fitted(JOINT)["inertia_leak.m_e"].value
    assert "inertia_leak: the inertia that the drive accelerates" in said
    assert re.search(rf"{mass:.2f}\d* \+/- \S+ kg m\^2 where the rig's file says 4\.000", said)
    said = " ".join(diagnosed(SLIDE).summary().split())
    assert "the zero of the force sensor is off, or a constant force is there (gravity" in said
    assert "inertia_leak: the mass that the drive accelerates" in said


def test_pictures_of_a_joint() -> None:
    before = compared(JOINT)
    first, means = before.plot()
    assert first.get_xlabel() == "Speed (rad/s)"
    assert first.get_ylabel() == "Friction torque (N m)"
    assert means.get_ylabel() == "Record minus model (N m)"
    top, bottom = plot_run(before)
    assert top.get_ylabel() == "Friction torque (N m)"
    assert bottom.get_ylabel() == "Record minus model (N m)"
    axes = [*before.plot(), top, bottom, *fitted(JOINT).plot(), *diagnosed(JOINT).plot()]
    for ax in axes:
        words = [ax.get_xlabel(), ax.get_ylabel(), ax.get_title(loc="left")]
        legend = ax.get_legend()
        words += [text.get_text() for text in legend.get_texts()] if legend else []
        words += [tick.get_text() for tick in (*ax.get_xticklabels(), *ax.get_yticklabels())]
        for word in words:
            assert FOREIGN.search(word) is None, word
            assert BARE_N.search(word) is None, word
    labels = [tick.get_text() for tick in fitted(JOINT).plot()[0].get_yticklabels()]
    assert any(label.startswith("F_v\n") and label.endswith("N m s/rad") for label in labels)


def test_pictures_of_a_slide() -> None:
    first = compared(SLIDE).plot()[0]
    assert (first.get_xlabel(), first.get_ylabel()) == ("Speed (m/s)", "Friction force (N)")
    # A rig without any section has no bearing either.
    plain = jbf.compare(Model(Rig(), law="coulomb"), runs_of(SLIDE)[:1]).plot()[0]
    assert (plain.get_xlabel(), plain.get_ylabel()) == ("Speed (m/s)", "Friction force (N)")


def test_pictures_of_a_bearing_stay() -> None:
    r = records()[0]
    run = Run.from_arrays(r.time_s, r.velocity_m_s, r.force_n, angle_rad=r.path / 0.0127)
    first = jbf.compare(Model(Rig.thesis()), [run]).plot()[0]
    assert first.get_xlabel() == "Surface speed (m/s)"
    assert first.get_ylabel() == "Friction of one bearing (N)"


def test_a_small_motor_is_no_other_case() -> None:
    """Millinewton metres and tens of radians a second: the same names, every number scaled."""
    torque, angle = 1.0 / 3000.0, 30.0
    runs = [
        Run.from_arrays(
            r.time_s,
            angle * r.velocity_m_s,
            torque * r.force_n,
            angle_rad=angle * r.path,
            name=r.name,
        )
        for r in records()
    ]
    large, small = diagnosed(JOINT), jbf.diagnose(JOINT, runs, law="coulomb")
    assert (small.verdict, small.effects) == (large.verdict, large.effects)
    scale = {"F_c": torque, "F_v": torque / angle, "inertia_leak.m_e": torque / angle}
    for name, factor in (scale | {"sensor_offset.b": torque}).items():
        was, now = large.fit[name], small.fit[name]
        assert now.value == pytest.approx(factor * was.value, rel=1e-4), name
        assert now.stderr == pytest.approx(factor * was.stderr, rel=0.02), name


def test_a_table_of_many_rigs_has_each_in_its_unit() -> None:
    mixed = _table({"a": diagnosed(JOINT), "b": diagnosed(SLIDE)})
    assert "held out (" not in mixed[0]
    assert mixed[1].endswith(" N m")
    assert mixed[2].endswith(" N")
    assert "held out (N m)" in _table({"a": diagnosed(JOINT)})[0]


def test_the_catalogue_beside_a_law_in_newtons_has_no_bearing(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["effects", "--law", "coulomb"]) == 0
    said = capsys.readouterr().out.partition("[not with")[0]
    assert "the zero of the force sensor is off" in " ".join(said.split())
    assert FOREIGN.search(said.replace("coupling or shaft", "")) is None
    for page in (page for page in jbf.effects().values() if "coulomb" not in page.refused):
        for quantities in (LINEAR, ROTARY):
            words = summary_of(page, quantities) + limits_of(page, quantities)
            assert FOREIGN.search(words.replace("coupling or shaft", "")) is None, page.name
    assert main(["effects", "--law", "journal"]) == 0
    assert "the load cell's zero is off" in " ".join(capsys.readouterr().out.split())


def test_an_export_says_what_turns() -> None:
    for export in (rust, c):
        assert "N m, rad, rad/s for N, m, m/s" in export(fitted(JOINT).model)
        assert "N m" not in export(fitted(SLIDE).model)


def test_json_keeps_its_keys_and_tells_the_units() -> None:
    told = diagnosed(JOINT).to_dict()
    assert told["units"] == {"force": "N m", "velocity": "rad/s", "length": "rad"}
    assert {"rms_n", "holdout_rms_n", "noise_n"} <= set(told["steps"][0])
    assert told["parameters"]["F_v_n_s_m"]["unit"] == "N m s/rad"
    assert compared(SLIDE).to_dict()["units"]["force"] == "N"
    # A rig without [drive] is told as ever.
    plain = jbf.compare(Model(Rig(), law="coulomb"), runs_of(SLIDE)[:1]).to_dict()
    assert "units" not in plain


def test_predictions_of_a_joint_are_torques(tmp_path: Path) -> None:
    fitted(JOINT).model.save(tmp_path / "model.toml")
    run_on(JOINT, runs_of(JOINT)[0]).write_csv(tmp_path / "run.csv")
    names = [str(tmp_path / name) for name in ("model.toml", "run.csv", "out.csv")]
    assert main(["predict", *names[:2], "--out", names[2]]) == 0
    assert (tmp_path / "out.csv").read_text().startswith("time_s,torque_n_m\n")
    assert "F_v_n_s_m is in N m s/rad" in (tmp_path / "model.toml").read_text()


def test_findings_have_the_unit_of_the_rig() -> None:
    run = runs_of(JOINT)[0]
    assert run.friction_n is not None
    clipped = replace(run, friction_n=np.clip(run.friction_n, -4.0, 4.0))
    (found,), _ = find_saturation(run_on(JOINT, clipped))
    assert found.unit == "N m"
    assert found.words.startswith("the torque stands at the end of its range, -4 N m and 4 N m")


def test_a_law_in_newtons_has_forces_where_a_coefficient_would_be() -> None:
    """Whatever the rig: it presses with one newton."""
    chosen = ("presliding", "stribeck_excess", "dwell_stiction")
    for quantities, force, stiffness in ((LINEAR, "N", "N/m"), (ROTARY, "N m", "N m/rad")):
        told = shown("coulomb", chosen, quantities)
        assert told["presliding.sigma_1_m"] == ("presliding.sigma", stiffness)
        assert told["stribeck_excess.a"][1] == told["dwell_stiction.a"][1] == force
    told = shown("journal", chosen, OF_BEARING)
    assert told["presliding.sigma_1_m"] == ("presliding.sigma_1_m", "1/m")
    assert told["stribeck_excess.a"][1] == ""
    assert shown("coulomb", chosen, Rig().quantities)["presliding.sigma_1_m"][1] == "N/m"


@pytest.mark.parametrize("law", [name for name, page in laws().items() if not page.needs_bearing])
def test_every_parameter_beside_a_law_in_newtons_has_a_unit_that_turns(law: str) -> None:
    effects = tuple(name for name, page in jbf.effects().items() if law not in page.refused)
    known = parameters_of(law, effects)
    for name, page in known.items():
        unit = unit_of(name, page, law, ROTARY)
        assert BARE_N.search(unit) is None, name
        assert unit not in ("m", "kg", "1/m", "s/m"), name
        # What is shown is what a person may type.
        assert find_parameter(bare_name(name, page), known) == name
        straight = unit_of(name, page, law, LINEAR)
        assert "N m" not in straight, name
        assert straight not in ("1/m", "kg m^2"), name
