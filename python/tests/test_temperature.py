"""A recorded temperature: its thermometer's faults, what asks for it, and what follows it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import numpy.typing as npt
import pytest
from campaigns import campaign
from jbf import Model, Rig, Run, diagnose, fit
from jbf.diagnosis.excitations import Limits, excitations
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.models.catalogue import find_effect
from jbf.records.findings.slow_temperature import find_slow_temperature, recorded_temperature
from jbf.records.rig import Lubricant
from rigsim import axis_campaign

Array = npt.NDArray[np.float64]
TIME = 0.02 * np.arange(3000)
BODY = 20.0 + 12.0 * (1.0 - np.exp(-TIME / 25.0))
DRY, VISCOUS = "dry_temperature_dependence", "viscous_temperature_dependence"
COULOMB: dict[str, Any] = {"law": "coulomb"}


def a_run(celsius: Array | None, name: str = "run") -> Run:
    v = 0.1 * np.sin(0.5 * TIME)
    force = 6.0 * np.sign(v) + 40.0 * v + 0.2 * np.random.default_rng(3).standard_normal(len(TIME))
    return Run.from_arrays(TIME, v, force, temperature_c=celsius, name=name)


def told(celsius: Array) -> Array:
    found = recorded_temperature(a_run(celsius))
    assert found is not None
    return found


def drive(seed: int, *effects: str, **options: Any) -> list[Run]:
    return [
        Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.force_n,
            position_m=r.path,
            load_n=r.load_n,
            temperature_c=r.temperature_c,
            name=r.name,
        )
        for r in axis_campaign(seed, effects, **options)[0]
    ]


# ---- the thermometer ----------------------------------------------------------------------------


def test_a_good_thermometer_is_believed_to_the_bit() -> None:
    np.testing.assert_array_equal(told(BODY), BODY)
    assert find_slow_temperature(a_run(BODY)) == []


def test_degrees_once_a_second_are_a_smooth_temperature() -> None:
    coarse = np.round(np.interp(np.floor(TIME), TIME, BODY))
    assert np.max(np.abs(coarse - BODY)) > 0.5
    # A jump tells that half a degree was passed within the last second: in it the body warms by
    # half a degree at first, and hardly at last.
    off = np.abs(told(coarse) - BODY)
    assert np.max(off[50:-300]) < 0.5
    assert np.sqrt(np.mean(off[750:-300] ** 2)) < 0.2
    (held,) = find_slow_temperature(a_run(coarse))
    assert (held.kind, held.channel) == ("held_samples", "temperature_c")
    # Drawn once, there is nothing to draw again: a fit and a prediction see the same.
    np.testing.assert_array_equal(told(told(coarse)), told(coarse))


def test_a_noisy_temperature_is_averaged() -> None:
    noisy = BODY + 0.4 * np.random.default_rng(1).standard_normal(len(BODY))
    assert np.std((told(noisy) - BODY)[100:-100]) < 0.06
    (found,) = find_slow_temperature(a_run(noisy))
    assert (found.kind, found.unit) == ("noisy_temperature", "K")
    assert found.size == pytest.approx(0.4, rel=0.05)


def test_gaps_are_no_error_and_are_said() -> None:
    seldom = np.where(np.arange(len(BODY)) % 50 == 0, BODY, np.nan)
    run = a_run(seldom)
    assert run.temperature_c is not None
    assert np.max(np.abs(run.temperature_c - BODY)[:-50]) < 0.01
    (gap,) = run.reading
    assert (gap.kind, gap.channel, gap.size) == ("gaps", "temperature_c", pytest.approx(1.0))
    nothing = np.full(len(BODY), np.nan)
    with pytest.raises(InputError, match="temperature_c"):
        a_run(nothing)
    endless = np.where(np.arange(len(BODY)) == 7, np.inf, BODY)
    with pytest.raises(InputError, match="sample 7"):
        a_run(endless)


def test_empty_cells_of_a_file_are_gaps(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    rows = [f"{t},{0.1 * t},{2.0 + t},{20 + t if i % 5 == 0 else ''}" for i, t in ROWS]
    path.write_text("\n".join(["time_s,velocity_m_s,friction_n,temperature_c", *rows]))
    run = jbf.read_run(path)
    assert run.temperature_c is not None
    np.testing.assert_allclose(run.temperature_c[:16], 20.0 + run.time_s[:16])
    assert [f.kind for f in run.reading] == ["gaps"]
    path.write_text(path.read_text().replace(",20.0\n", ",warm\n"))
    with pytest.raises(InputError, match='"warm" is not a number'):
        jbf.read_run(path)
    path.write_text("\n".join(["time_s,velocity_m_s,friction_n,temperature_c", *EMPTY]))
    assert jbf.read_run(path).temperature_c is None


ROWS = [(i, 0.1 * i) for i in range(20)]
EMPTY = [f"{t},{0.1 * t},{2.0 + t}," for _, t in ROWS]


# ---- what asks for it ---------------------------------------------------------------------------


def why_not(*temperatures: Array | None) -> str | None:
    runs = [a_run(c, str(i)) for i, c in enumerate(temperatures)]
    # Two recordings, not one given twice.
    runs = [replace(r, friction_n=r.friction_n + 1e-3 * i) for i, r in enumerate(runs)]  # type: ignore[operator]
    return Campaign.prepare(Rig(), runs).lacking(find_effect(DRY))


def test_a_temperature_that_stays_is_not_tried() -> None:
    still = np.full(len(TIME), 24.0)
    assert why_not(None) == "not every run has the column temperature_c"
    assert why_not(BODY, None) == "not every run has the column temperature_c"
    words = why_not(still + 0.3 * np.sin(TIME), still)
    assert words is not None
    assert words.startswith("the temperature stays within 0.6 K")
    # A thermometer's noise is no temperature.
    noise = 0.8 * np.random.default_rng(5).standard_normal(len(TIME))
    assert why_not(still + noise) is not None
    assert why_not(BODY) is None
    assert why_not(still, still + 3.0) is None


def test_a_run_without_it_is_refused() -> None:
    model = Model(Rig(), effects=[DRY], **COULOMB)
    assert np.isfinite(model.predict(a_run(BODY))).all()
    with pytest.raises(InputError, match=f"temperature_c: is missing, and the effect {DRY}"):
        model.predict(a_run(None))
    with pytest.raises(InputError, match="temperature_c"):
        fit(Rig(), [a_run(None)], [DRY], **COULOMB)


def test_a_prediction_follows_the_thermometer() -> None:
    """The level and the slope of Coulomb's law, from closed forms of the temperature."""
    run = a_run(BODY)
    values = {"F_c_n": 6.0, "F_s_n": 6.0, "F_v_n_s_m": 40.0}
    own = {f"{DRY}.a": -0.01, f"{DRY}.T_0": 25.0, f"{VISCOUS}.B": 700.0, f"{VISCOUS}.T_0": 20.0}
    model = Model(Rig(), effects=[DRY, VISCOUS], parameters={**values, **own}, **COULOMB)
    law = Model(Rig(), parameters=values, **COULOMB)
    v = (law.predict(run) - 6.0 * np.sign(run.velocity_m_s)) / 40.0
    thin = np.exp(700.0 / (BODY + 95.0) - 700.0 / 115.0)
    expected = 6.0 * (1.0 - 0.01 * (BODY - 25.0)) * np.sign(v) + 40.0 * thin * v
    moving = np.abs(v) > 0.005
    np.testing.assert_allclose(model.predict(run)[moving], expected[moving], atol=1e-9)


# ---- the reference ------------------------------------------------------------------------------


def stated(rig: Rig, runs: list[Run], effect: str, law: str) -> dict[str, float]:
    problem = Problem(Campaign.prepare(rig, runs), law, "journal", (effect,))
    assert not {problem.names[i] for i in problem.open} & set(problem.fixed)
    return problem.fixed


def test_the_reference_is_the_lubricants_or_the_mean_on_record() -> None:
    runs = [a_run(BODY)]
    assert stated(Rig(), runs, DRY, "coulomb") == {f"{DRY}.T_0_c": round(float(np.mean(BODY)))}
    rig = replace(Rig.thesis(), lubricant=Lubricant(0.002, 40.0))
    fixed = stated(rig, runs, "vogel_viscosity", "journal")
    assert fixed == {"vogel_viscosity.C_c": -95.0, "vogel_viscosity.T_0_c": 40.0}


def test_a_lubricant_may_tell_its_temperature(tmp_path: Path) -> None:
    rig = replace(Rig.thesis(), lubricant=Lubricant(0.002, 40.0))
    rig.write(tmp_path / "rig.toml")
    assert jbf.read_rig(tmp_path / "rig.toml") == rig
    assert "temperature_c" not in Rig.thesis().to_mapping()["lubricant"]
    with pytest.raises(InputError, match="degrees Celsius"):
        Lubricant(0.002, 3e4)


def test_what_is_stated_is_said_to_be_and_costs_nothing() -> None:
    runs = drive(31, DRY)
    found = fit(Rig(), runs, [DRY], **COULOMB)
    held = found[f"{DRY}.T_0"]
    assert held.held
    assert held.stderr is None
    assert not found[f"{DRY}.a"].held
    other = fit(Rig(), runs, [DRY], fixed={f"{DRY}.T_0": 10.0}, **COULOMB)
    # Another reference is the same model in other words.
    assert other.rms_n == pytest.approx(found.rms_n, rel=1e-6)
    slope = found[f"{DRY}.a"].value
    there = slope / (1.0 + slope * (10.0 - held.value))
    assert other[f"{DRY}.a"].value == pytest.approx(there, rel=1e-3)


# ---- what follows it ----------------------------------------------------------------------------


@pytest.mark.slow
def test_two_at_once_are_found_together() -> None:
    found = diagnose(Rig(), drive(32, DRY, VISCOUS, thermometer="coarse"), **COULOMB)
    assert (found.verdict, set(found.effects)) == ("missing", {DRY, VISCOUS})
    assert "held_samples" in {f.kind for f in found.findings if f.channel == "temperature_c"}


@pytest.mark.parametrize("course", ["wandering", "warming", "days"])
def test_a_temperature_that_changes_nothing_is_not_named(course: str) -> None:
    found = diagnose(Rig(), drive(33, temperature=course), **COULOMB)
    assert (found.verdict, found.effects) == ("adequate", ())
    assert not {DRY, VISCOUS} & set(found.not_tried)


def dry_and_warming(step_s: float, seed: int = 1, *, from_warm: bool = False) -> list[Run]:
    """Slow strokes of a slide whose dry friction falls as it warms: each run alike from cold, and
    one more that begins warm."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, 40.0, step_s)
    runs = []
    for k in range(4 if from_warm else 3):
        v = (0.02 + 0.005 * k) * np.sin((0.9 + 0.2 * k) * time + k)
        cold = np.exp(-time / 12.0) if k < 3 else np.zeros(len(time))
        force = 6.0 * (1.0 + 0.25 * cold) * np.sign(v) + 0.2 * random.standard_normal(len(time))
        path = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(time))))
        celsius = 34.0 - 16.0 * cold
        run = Run.from_arrays(
            time, v, force, position_m=path, temperature_c=celsius, name=f"run_{k}"
        )
        runs.append(run)
    return runs


def test_a_temperature_that_goes_with_the_time_ties_openly() -> None:
    """Nothing in these runs tells warmth from time, but that the thermometer's course has no time
    to fit: one is named, the other beside it, never both."""
    found = diagnose(Rig(), dry_and_warming(0.08), **COULOMB)
    assert found.verdict == "ambiguous"
    (name,) = found.effects
    assert {name, *found.alternatives[name]} >= {"warm_up", DRY}
    assert found.next_experiment is not None
    assert "the machine at" in found.next_experiment
    # A run begun warm settles it.
    after = diagnose(Rig(), dry_and_warming(0.08, from_warm=True), **COULOMB)
    assert (after.verdict, after.effects) == ("missing", (DRY,))


def test_of_many_samples_the_course_of_the_thermometer_tells() -> None:
    """That friction falls in the thermometer's own time, to a few per cent, is evidence."""
    found = diagnose(Rig(), dry_and_warming(0.01), **COULOMB)
    assert (found.verdict, found.effects) == ("missing", (DRY,))


def test_without_the_column_it_is_not_named() -> None:
    runs = [replace(r, temperature_c=None) for r in drive(34, DRY, temperature="wandering")]
    found = diagnose(Rig(), runs, **COULOMB)
    assert DRY in found.not_tried
    assert found.verdict != "adequate"


def test_a_warm_bearing_is_named_by_its_thermometer() -> None:
    rig, runs, truth = campaign(71, ("vogel_viscosity",))
    found = diagnose(rig, runs)
    assert (found.verdict, found.effects) == ("missing", ("vogel_viscosity",))
    assert not any(found.alternatives.values())
    steep = found.model.parameters["vogel_viscosity.B_k"]
    assert steep.stderr is not None
    wanted = truth["effects"]["vogel_viscosity"]["B"]
    assert abs(steep.value - wanted) < 4.5 * steep.stderr + 0.02 * wanted


def test_the_next_run_may_be_warm_or_cold() -> None:
    runs = drive(35, temperature="days")
    prepared = Campaign.prepare(Rig(), runs)
    filled = Limits(duration_s=20.0).filled(prepared)
    assert filled.temperature_c == prepared.temperature_range_c
    seen = {e.temperature_c for e in excitations(filled, 0.02)}
    assert seen == set(filled.temperature_c or ())
    with pytest.raises(InputError, match="temperature_c"):
        Limits(temperature_c=(30.0, 20.0))
