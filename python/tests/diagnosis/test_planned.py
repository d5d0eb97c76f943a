"""Simulated records of planned runs, and the power of a diagnosis of them."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import LAW
from jbf import InputError, Model, Rig, Run, planned_power
from jbf.diagnosis.planned import as_recorded
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.power import non_centrality
from jbf.records.toml_file import MOST

STEP_S = 0.02
TIME_S = STEP_S * np.arange(600.0)
VELOCITY_M_S = 0.1 * np.sin(TIME_S)
MODEL = Model(Rig(), "coulomb", parameters={**LAW, "F_s_n": 5.0})


def motion(name: str, rate: float = 1.0) -> Run:
    return Run.from_arrays(TIME_S, 0.1 * np.sin(rate * TIME_S), name=name)


@pytest.mark.parametrize("noise_n", [0.01, 0.5])
def test_planned_runs_have_the_friction_of_the_model_and_white_noise(noise_n: float) -> None:
    """Friction that a planned run already has is ignored."""
    other = Run.from_arrays(TIME_S, VELOCITY_M_S, 7.0 * VELOCITY_M_S, name="b")
    campaign = as_recorded(MODEL, [motion("a"), other], noise_n, DEFAULT).campaign
    clean = MODEL.predict_many([motion("a"), motion("a")])
    noise = [p.friction_n - f for p, f in zip(campaign.prepared, clean, strict=True)]
    assert [float(np.std(e)) for e in noise] == pytest.approx([noise_n] * 2, rel=0.1)
    assert abs(np.corrcoef(noise[0], noise[1])[0, 1]) < 0.15
    assert abs(np.corrcoef(noise[0][1:], noise[0][:-1])[0, 1]) < 0.15
    again = as_recorded(MODEL, [motion("a"), other], noise_n, DEFAULT).campaign
    assert np.array_equal(again.prepared[0].friction_n, campaign.prepared[0].friction_n)


def test_sign_of_the_friction_is_unknown_next_to_a_planned_reversal() -> None:
    campaign = as_recorded(MODEL, [motion("a")], 0.1, DEFAULT).campaign
    v = campaign.prepared[0].motion.velocity_m_s
    turns = np.flatnonzero(np.diff(np.sign(v)) != 0.0)
    assert len(turns) > 2
    counted = campaign.samples.counted[0]
    assert not counted[turns].any()
    assert not counted[turns + 1].any()
    assert np.count_nonzero(~counted) <= 2 * len(turns) + 1


@pytest.mark.parametrize("noise_n", [0.0, -1.0, np.inf, 2.0 * MOST])
def test_noise_that_is_not_positive_or_exceeds_its_limit_is_rejected(noise_n: float) -> None:
    with pytest.raises(InputError, match="noise_n"):
        planned_power(MODEL, [motion("a")], noise_n=noise_n)


def test_plan_without_runs_is_rejected() -> None:
    with pytest.raises(InputError, match="no run was given"):
        planned_power(MODEL, [], noise_n=0.1)


def test_planned_power_of_a_mass_is_that_of_a_regression() -> None:
    noise_n, runs = 0.1, [motion("a", 4.0), motion("b", 6.0), motion("c", 8.0)]
    planned = planned_power(MODEL, runs, noise_n=noise_n)
    found = next(p for p in planned.power if p.effect == "inertia_leak")
    rows = []
    for run in runs:
        v = run.velocity_m_s
        turn = np.flatnonzero(np.diff(np.sign(v)) != 0.0)
        # The sign of the friction is unknown next to a reversal.
        known = ~np.isin(np.arange(len(v)), [*turn, *(turn + 1)])
        rows.append(np.column_stack([np.sign(v), v, np.gradient(v, TIME_S)])[known])
    design, a = np.split(np.concatenate(rows), [2], axis=1)
    left = np.linalg.norm(a - design @ np.linalg.lstsq(design, a, rcond=None)[0])
    price = planned.level.price(1, len(a))
    wanted = noise_n * np.sqrt(non_centrality(price, 1, 0.8))
    assert found.found_80 is not None
    assert found.found_80 * left == pytest.approx(wanted, rel=0.03)


def test_dictionary_of_planned_power_has_its_law_runs_level_and_results() -> None:
    planned = planned_power(MODEL, [motion("a"), motion("b", 1.7)], noise_n=0.2)
    table = planned.to_dict()
    assert (table["law"], table["effects"], table["noise_n"]) == ("coulomb", [], 0.2)
    assert table["runs"] == ["a", "b"]
    assert table["level"] == planned.level.to_dict()
    assert table["power"] == [p.to_dict() for p in planned.power]
    assert table["not_tried"] == planned.not_tried
    assert "position_ripple" not in {p.effect for p in planned.power}


def test_effects_of_the_model_are_not_tested_again() -> None:
    values = {**LAW, "F_s_n": 5.0, "inertia_leak.m_e_kg": 3.0}
    model = Model(Rig(), "coulomb", ["inertia_leak"], values)
    planned = planned_power(model, [motion("a"), motion("b", 1.7)], noise_n=0.1)
    assert planned.to_dict()["effects"] == ["inertia_leak"]
    assert "inertia_leak" not in {p.effect for p in planned.power}


def test_planned_friction_includes_the_effects_of_the_model() -> None:
    values = {**LAW, "F_s_n": 5.0, "inertia_leak.m_e_kg": 3.0}
    model = Model(Rig(), "coulomb", ["inertia_leak"], values)
    (run,) = as_recorded(model, [motion("a")], 1e-3, DEFAULT).campaign.prepared
    (without,) = as_recorded(MODEL, [motion("a")], 1e-3, DEFAULT).campaign.prepared
    inertial = run.friction_n - without.friction_n
    assert inertial == pytest.approx(0.3 * np.cos(TIME_S), abs=0.01)
