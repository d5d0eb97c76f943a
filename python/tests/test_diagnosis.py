"""The diagnosis on campaigns of the independent simulator."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import campaign
from jbf import Diagnosis, Rig, Run, diagnose
from jbf import effects as catalogue
from jbf.diagnosis import Policy

LATER = ("backlash", "time_delay", "load_dependence")
"""Last, so that the seeds of the others stay what they were."""
OF_BEARINGS = [name for name, page in catalogue().items() if "journal" not in page.refused]
EFFECTS = (*(e for e in OF_BEARINGS if e not in LATER), *LATER)
QUICK = (
    "drive_compliance",
    "thermal_thinning",
    "film_memory",
    "stribeck_excess",
    "position_ripple",
    "presliding",
    "coulomb_drag",
    "sensor_lag",
    "time_delay",
)
ALL = [e if e in QUICK else pytest.param(e, marks=pytest.mark.slow) for e in EFFECTS]


@pytest.mark.parametrize("name", ALL)
def test_one_hidden_effect_is_named(name: str) -> None:
    loads = {"two_way_0.25": 0.7, "stop_and_go": 0.7, "two_way_2": 1.35}
    own = {"loads": tuple(loads.items())} if name == "load_dependence" else {}
    rig, runs, truth = campaign(EFFECTS.index(name) + 30, (name,), **own)
    d = diagnose(rig, runs)
    assert d.verdict == "missing"
    assert d.effects == (name,)
    assert d.alternatives == {name: ()}
    # The error falls to the noise, on runs left out too.
    assert d.steps[0].rms_n > d.steps[-1].rms_n
    assert d.steps[0].holdout_rms_n > d.steps[-1].holdout_rms_n
    assert d.steps[-1].rms_n < 1.03 * truth["noise_n"]
    # One run alone has rests, so nothing foretells what a rest does there.
    if name != "dwell_stiction":
        assert d.steps[-1].holdout_rms_n < 1.06 * truth["noise_n"]
    assert d.steps[-1].noise_n == pytest.approx(truth["noise_n"], rel=0.08)


@pytest.mark.parametrize("coloured", [False, True])
def test_nothing_hidden_is_adequate(coloured: bool) -> None:
    rig, runs, _ = campaign(7, coloured=coloured)
    d = diagnose(rig, runs)
    assert d.verdict == "adequate"
    assert d.effects == ()
    assert d.unexplained == ()
    assert len(d.steps) == 1
    assert {t.effect for t in d.steps[0].trials} == set(EFFECTS) - {
        "load_dependence",
        "vogel_viscosity",
    }
    assert "one load" in d.not_tried["load_dependence"]
    assert "load_dependence" in d.summary()


def test_two_hidden_effects_are_both_named() -> None:
    rig, runs, truth = campaign(11, ("coulomb_drag", "position_ripple"))
    d = diagnose(rig, runs)
    assert set(d.effects) == {"coulomb_drag", "position_ripple"}
    assert d.verdict == "missing"
    assert [s.effects for s in d.steps] == [(), d.effects[:1], d.effects]
    assert d.steps[-1].holdout_rms_n < 1.05 * truth["noise_n"]


@pytest.mark.slow
def test_a_drive_that_rings_does_not_hide_what_is_beside_it() -> None:
    rig, runs, truth = campaign(202, ("drive_compliance", "time_delay"))
    d = diagnose(rig, runs)
    assert d.effects == ("drive_compliance", "time_delay"), d.summary()
    assert d.verdict == "missing"
    assert d.steps[-1].rms_n < 1.05 * truth["noise_n"]


def test_a_tone_is_described_and_nothing_is_named() -> None:
    rig, runs, truth = campaign(13, foreign=("hum",))
    d = diagnose(rig, runs)
    assert d.verdict == "unexplained"
    assert d.effects == ()
    tone = [r for r in d.unexplained if r.axis == "frequency"]
    hertz = next(v for k, v in truth["foreign"]["hum"].items() if "hz" in k or k == "f")
    assert tone
    assert f"{hertz:.2f} Hz"[:3] in tone[0].where


def test_runs_do_not_depend_on_their_order() -> None:
    rig, runs, _ = campaign(34, ("coulomb_drag",))
    forward, backward = diagnose(rig, runs), diagnose(rig, runs[::-1])
    assert forward.effects == backward.effects
    a, b = forward.model.values, backward.model.values
    np.testing.assert_allclose(a, b, rtol=1e-3)


def test_records_without_an_angle_leave_out_what_needs_one() -> None:
    rig, runs, _ = campaign(34, ("coulomb_drag",))
    d = diagnose(rig, [_without_angle(r) for r in runs])
    assert d.effects == ("coulomb_drag",)
    tried = {t.effect for t in d.steps[0].trials}
    assert tried == set(EFFECTS) - {
        "position_ripple",
        "drive_compliance",
        "load_dependence",
        "vogel_viscosity",
    }


def test_one_run_alone_is_enough_to_speak() -> None:
    rig, runs, _ = campaign(34, ("coulomb_drag",))
    d = diagnose(rig, runs[:1])
    assert d.verdict in ("missing", "ambiguous")
    named = set(d.effects) | {a for others in d.alternatives.values() for a in others}
    assert "coulomb_drag" in named


def test_the_dictionary_keeps_the_contract() -> None:
    d = _some_diagnosis()
    found = d.to_dict()
    assert {
        "verdict",
        "effects",
        "alternatives",
        "steps",
        "failures",
        "unexplained",
        "next_experiment",
        "parameters",
    } <= set(found)
    assert found["steps"][0]["effects"] == []
    assert {"effects", "rms_n", "holdout_rms_n", "noise_n"} <= set(found["steps"][-1])
    assert {"axis", "where", "share"} <= set(found["failures"][0])
    assert found["parameters"]["f_m"]["stderr"] > 0.0
    assert Policy().tie > 0.0


def _some_diagnosis() -> Diagnosis:
    rig, runs, _ = campaign(34, ("coulomb_drag",))
    return diagnose(rig, runs)


def _without_angle(run: Run) -> Run:
    return Run.from_arrays(
        run.time_s, run.velocity_m_s, run.friction_n, load_n=run.load_n, name=run.name
    )


def test_a_rig_without_a_bearing_is_refused() -> None:
    _, runs, _ = campaign(34, ("coulomb_drag",))
    with pytest.raises(ValueError, match="no \\[bearing\\]"):
        diagnose(Rig(), runs)
