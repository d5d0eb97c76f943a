"""Each way in which runs leave a parameter undetermined: it is held, and the model predicts what it
did."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb, there_and_back
from jbf import Fit, ParameterValue, Rig, Run, export, fit
from jbf.diagnosis.candidates import Candidates
from jbf.estimation.bootstrap import with_error
from jbf.estimation.campaign import Campaign
from jbf.estimation.determined import NEVER_MOVED, NO_EFFECT, NOT_SEPARATE
from jbf.estimation.fit import finish
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.models.catalogue import effects as catalogue

RUNS = there_and_back(coulomb, noise_n=0.1)
"""At 0.05 to 0.15 m/s, never at rest."""


def recorded(run: Run) -> Array:
    assert run.friction_n is not None
    return run.friction_n


def at(law: str, values: dict[str, float], effects: Sequence[str] = ()) -> Fit:
    """A fit that ended at these values."""
    problem = Problem(Campaign.prepare(Rig(), RUNS), law, "journal", effects)
    here = np.array([values[name] for name in problem.names])
    return finish(problem, problem.solution(here, problem.samples_at(here), WHITE))


def check(found: Fit, held: dict[str, str]) -> None:
    """These and no others are held, with these words; the model predicts what the fit says."""
    assert {n: p.note for n, p in found.parameters.items() if p.held} == held
    for name, p in found.parameters.items():
        assert (p.stderr is None) is (name in held)
        assert found.model.parameters[name] == p
    told = len(found.parameters) - len(held)
    assert found.correlations.shape == (told, told)
    np.testing.assert_allclose(np.diag(found.correlations), 1.0)
    for run, residual in zip(RUNS, found.residuals, strict=True):
        left = recorded(run) - found.model.predict(run)
        np.testing.assert_allclose(left, residual, atol=1e-9)


def test_what_nothing_depends_on_is_held_where_it_started() -> None:
    found = fit(Rig(), RUNS, law="coulomb")
    check(found, {"F_s_n": NEVER_MOVED})
    assert 5.0 < found.parameters["F_s_n"].value < 9.0
    assert found.parameters["F_c_n"].value == pytest.approx(LAW["F_c_n"], abs=0.03)
    # The user's start is as good a guess.
    own = fit(Rig(), RUNS, law="coulomb", start={"F_s": 8.0})
    assert own.parameters["F_s_n"] == ParameterValue(8.0, None, NEVER_MOVED, held=True)


def test_a_number_gone_wild_is_put_back_as_far_as_nothing_changes() -> None:
    wild = {"F_c_n": 5.0, "F_s_n": 9e6, "v_s_m_s": 1e-6, "delta": 2.0, "F_v_n_s_m": 20.0}
    found = at("stribeck", wild)
    flat = "flat here: these runs tell only that it is not "
    notes = {n: str(p.note) for n, p in found.parameters.items() if p.held}
    assert notes["F_s_n"] == NEVER_MOVED
    assert notes["v_s_m_s"].startswith(flat)
    check(found, notes)
    assert 5.0 < found.parameters["F_s_n"].value < 9.0
    # Its start would bend the curve at these speeds.
    assert 5e-6 < found.parameters["v_s_m_s"].value < 0.02
    assert found.parameters["F_v_n_s_m"].stderr is not None
    as_it_was = [recorded(r) - coulomb(r.time_s, r.velocity_m_s, r.time_s) for r in RUNS]
    gap = np.concatenate(found.residuals) - np.concatenate(as_it_was)
    assert np.sqrt(np.mean(gap**2)) < 1e-4 * found.rms_n


def test_a_stribeck_curve_of_fast_runs_alone() -> None:
    found = fit(Rig(), RUNS, law="stribeck")
    held = {n: str(p.note) for n, p in found.parameters.items() if p.held}
    assert set(held) == {"F_s_n", "v_s_m_s", "delta"}
    assert "larger than itself: these runs do not tell its size" in held["v_s_m_s"]
    check(found, held)
    line = next(x for x in found.report().splitlines() if "v_s_m_s" in x)
    assert "held at" in line
    assert "+/-" not in line
    assert "%" not in line


def test_what_another_does_too_is_held_and_the_rest_is_not() -> None:
    found = fit(Rig(), RUNS, law="seven_parameter")
    held = {n: str(p.note) for n, p in found.parameters.items() if p.held}
    # Where in its flat valley the search ends decides which of the two is said.
    assert held["v_s_m_s"] == NOT_SEPARATE or "larger than itself" in held["v_s_m_s"]
    assert held["gamma_s"] == held["k_t_n_m"] == NEVER_MOVED
    check(found, held)
    friction = found.parameters["F_c_n"]
    assert friction.stderr is not None
    assert abs(friction.value - LAW["F_c_n"]) < 3.0 * friction.stderr < 0.3


def test_a_lag_that_is_not_there_has_only_a_largest_size() -> None:
    found = fit(Rig(), RUNS, ["sensor_lag"], law="coulomb").parameters["sensor_lag.tau_s"]
    assert found.held
    assert "larger than itself: these runs tell only that it is below 0.0" in str(found.note)


def test_an_offset_of_nought_is_determined() -> None:
    found = fit(Rig(), RUNS, ["sensor_offset"], law="coulomb").parameters["sensor_offset.b_n"]
    assert not found.held
    assert found.stderr is not None
    assert abs(found.value) < 4.0 * found.stderr < 0.02


def test_presliding_where_nothing_turns_round_is_no_effect() -> None:
    found = fit(Rig(), RUNS, ["presliding"], law="coulomb")
    check(found, {"F_s_n": NEVER_MOVED, "presliding.sigma_1_m": NEVER_MOVED})
    assert found.parameters["presliding.sigma_1_m"].value == math.inf
    assert "presliding" not in export.rust(found.model)


@pytest.mark.parametrize(
    ("effect", "values", "put"),
    [
        ("presliding", {"sigma_1_m": 1e12}, {"sigma_1_m": math.inf}),
        ("quadratic_drag", {"c_n_s2_m2": 0.0}, {"c_n_s2_m2": 0.0}),
        (
            "stribeck_excess",
            {"a": 0.0, "v_s_m_s": 2e-5, "n": 7.9},
            # Where a fit would begin: at a slow speed of these runs.
            {"a": 0.0, "v_s_m_s": pytest.approx(0.0526, rel=1e-3), "n": 1.5},
        ),
    ],
)
def test_an_effect_at_its_null_is_no_effect(
    effect: str, values: dict[str, float], put: dict[str, float]
) -> None:
    law = {**LAW, "F_s_n": 6.0}
    found = at("coulomb", law | {f"{effect}.{n}": v for n, v in values.items()}, [effect])
    check(found, {"F_s_n": NEVER_MOVED} | {f"{effect}.{n}": NO_EFFECT for n in values})
    assert {n: found.parameters[f"{effect}.{n}"].value for n in values} == put
    assert found.to_dict()["parameters"][f"{effect}.{next(iter(put))}"]["note"] == NO_EFFECT
    assert f"({NO_EFFECT})" in found.report()


def test_candidates_know_which_effects_stand_at_their_null() -> None:
    candidates = Candidates(Campaign.prepare(Rig(), RUNS), "coulomb", "journal")
    problem = candidates.fitted(("quadratic_drag", "sensor_lag")).problem
    values = problem.starts({"quadratic_drag.c_n_s2_m2": 0.0})[0]
    there = problem.solution(values, problem.samples_at(values), WHITE)
    assert there.effects == tuple(e for e in catalogue() if e in ("quadratic_drag", "sensor_lag"))
    assert candidates.idle(there) == ("quadratic_drag",)


def test_fits_again_may_show_that_an_error_is_larger_than_its_parameter() -> None:
    page = catalogue()["sensor_lag"].parameters[0]
    answers = np.linspace(0.0, 0.4, 41)
    wide = with_error(ParameterValue(0.1, 0.02), answers, page)
    assert wide.held
    assert wide.stderr is None
    assert "below 0.37" in str(wide.note)
    narrow = with_error(ParameterValue(0.2, 0.02), answers, page)
    assert narrow.stderr == pytest.approx(0.1366, rel=0.01)
    assert not narrow.held


def test_correlations_of_other_parameters_are_refused() -> None:
    found = fit(Rig(), RUNS, law="coulomb")
    bare = {name: ParameterValue(p.value) for name, p in found.parameters.items()}
    with pytest.raises(ValueError, match=r"shape \(2, 2\) for 3 parameters"):
        Fit(**{**vars(found), "parameters": bare})


def test_rest_of_a_run_is_left_as_it_was() -> None:
    # A run with a rest: F_s acts there in no sample that counts.
    t = RUNS[0].time_s
    v = np.where(t < 5.0, RUNS[0].velocity_m_s, 0.0)
    run = Run.from_arrays(t, v, np.where(t < 5.0, recorded(RUNS[0]), 0.0), name="stops")
    assert fit(Rig(), [run], law="coulomb").parameters["F_s_n"].note == NEVER_MOVED
