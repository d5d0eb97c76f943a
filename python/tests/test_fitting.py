"""Fits to data of the independent simulator, and the derivatives they rest on."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
import pytest
from by_hand import there_and_back
from campaigns import SHORT, campaign
from jbf import InputError, Model, ParameterValue, Rig, Run, compare, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.models.catalogue import effects as catalogue

BASE = {"f_m": "f_m", "U_tr_m_s": "U_tr", "K0": "K0", "gamma": "gamma"}
LOADS = (("two_way_0.25", 0.7), ("stop_and_go", 0.7), ("two_way_2", 1.35))
"""Shares of the rig's load, for what only loads that differ can show."""


WEAK = ("thermal_thinning.tau_s", "dwell_stiction.t_0_s")
"""Times that these short runs tell to a factor only."""


def told_error(p: ParameterValue) -> float:
    """The error of a parameter, or what its note says of one that is larger than itself."""
    if not p.held:
        assert p.stderr is not None
        return p.stderr
    found = re.match(r"its error, (\S+), is larger than itself", p.note or "")
    assert found is not None, p
    return float(found[1])


ON_BEARINGS = [name for name, page in catalogue().items() if "journal" not in page.refused]
"""The others: test_drives."""


def hidden(name: str) -> tuple[Rig, list[Run], dict[str, Any]]:
    """A campaign with an effect in it; its seed stays the same when other effects come."""
    loads = LOADS if "loads" in catalogue()[name].needs else ()
    return campaign(crc32(name.encode()) % 1000, (name,), loads=loads)


def own(name: str, truth: dict[str, float]) -> dict[str, float]:
    """The truth under the catalogue's names, which are the simulator's with a unit."""
    found = {}
    for page in catalogue()[name].parameters:
        if page.stated:
            continue
        (short,) = (k for k in truth if page.name == k or page.name.startswith(f"{k}_"))
        found[f"{name}.{page.name}"] = truth[short]
    return found


@pytest.mark.parametrize("name", ON_BEARINGS)
def test_the_right_structure_recovers_the_truth(name: str) -> None:
    rig, runs, truth = hidden(name)
    found = fit(rig, runs, [name])
    assert found.converged
    assert found.rms_n == pytest.approx(truth["noise_n"], rel=0.06)
    wanted = {k: truth["base"][v] for k, v in BASE.items()}
    wanted |= own(name, truth["effects"][name])
    for parameter, value in wanted.items():
        p = found.parameters[parameter]
        error = p.stderr if parameter not in WEAK else told_error(p)
        assert error is not None, parameter
        # A drive's stick and slip amplify the encoder's steps, which no error bar knows.
        allowance = 0.05 if catalogue()[name].stage == "drive" else 0.01
        assert abs(p.value - value) < 4.5 * error + allowance * abs(value), parameter


def test_a_fit_keeps_what_is_fixed_and_takes_names_without_units() -> None:
    rig, runs, _ = campaign(34, ("coulomb_drag",))
    found = fit(rig, runs, ["coulomb_drag"], fixed={"gamma": 33.0, "coulomb_drag.F_d": 0.5})
    assert found.model.parameters["gamma"].value == 33.0
    assert found.parameters["coulomb_drag.F_d_n"].value == 0.5
    assert found.parameters["gamma"].stderr is None
    assert found.parameters["gamma"].note == "held fixed"
    assert found.parameters["gamma"].held
    assert found.fixed == ("gamma", "coulomb_drag.F_d_n")
    assert found.correlations.shape == (3, 3)


def test_a_parameter_at_its_bound_says_so(tmp_path: Path) -> None:
    # Friction that falls with speed asks for less than no viscous friction.
    runs = there_and_back(lambda t, v, a: 5.0 * np.sign(v) - 0.5 * v, noise_n=0.05)
    found = fit(Rig(), runs, law="coulomb", fixed={"F_s": 6.0})
    viscous = found.parameters["F_v_n_s_m"]
    assert viscous.value == 0.0
    assert viscous.stderr is None
    assert viscous.held
    assert viscous.note == "at its lower bound 0: the runs ask for less"
    # The other is the mean friction in the direction of motion, within half of its error.
    along = [run.friction_n * np.sign(run.velocity_m_s) for run in runs]
    assert found.parameters["F_c_n"].value == pytest.approx(np.mean(along), abs=8e-4)
    assert found.parameters["F_c_n"].stderr is not None
    found.model.save(tmp_path / "m.toml")
    assert Model.load(tmp_path / "m.toml").parameters["F_v_n_s_m"] == viscous


def test_a_parameter_at_its_upper_bound_says_so() -> None:
    # No friction at all on the way back.
    runs = there_and_back(lambda t, v, a: np.where(v > 0, 10.0, 0.0), noise_n=0.05)
    held = {"F_c": 5.0, "F_s": 6.0, "F_v": 0.0}
    found = fit(Rig(), runs, ["direction_asymmetry"], law="coulomb", fixed=held)
    part = found.parameters["direction_asymmetry.a"]
    assert part.value == pytest.approx(0.95)
    assert part.stderr is None
    assert part.note == "at its upper bound 0.95: the runs ask for more"


def test_a_parameter_that_the_runs_cannot_show_says_so() -> None:
    # Without any warming there is no time in which it cools.
    rig, runs, _ = campaign(7)
    found = fit(rig, runs, ["thermal_thinning"], fixed={"thermal_thinning.beta_q": 0.0})
    tau = found.parameters["thermal_thinning.tau_s"]
    assert tau.stderr is None
    assert tau.held
    assert tau.note == "at its null: no effect"
    assert found.parameters["gamma"].stderr is not None


@pytest.mark.parametrize("name", ON_BEARINGS)
def test_derivatives_match_differences(name: str) -> None:
    rig, runs, _ = hidden(name)
    # A run to and fro; where it does not show a parameter, the one with rests or another load.
    for shown in (runs[1:2], runs[4:5]):
        problem = Problem(Campaign.prepare(rig, shown), "journal", "journal", (name,))
        values = problem.starts({})[0]
        _, jacobian = problem.linearise(values)
        if np.all(np.any(jacobian[0] != 0.0, axis=0)):
            break
    pages = list(problem.parameters.values())
    for column, i in enumerate(problem.open):
        page = pages[i]
        h = 1e-5 * (values[i] if page.log else max(abs(values[i]), 1e-2))
        up, down = values.copy(), values.copy()
        up[i] += h
        down[i] -= h
        slope = (problem.predict(up)[0] - problem.predict(down)[0]) / (2.0 * h)
        slope *= values[i] if page.log else 1.0
        gap = jacobian[0][:, column] - slope
        # Kinks (stick, reversal) move between the two sides of a difference: judge the bulk.
        assert np.median(np.abs(gap)) < 1e-6 * np.max(np.abs(slope)), problem.names[i]
        assert np.quantile(np.abs(gap), 0.95) < 1e-3 * np.max(np.abs(slope)), problem.names[i]


def test_unknown_names_are_refused_in_one_line() -> None:
    rig, runs, _ = campaign(7)
    with pytest.raises(InputError, match="presliding"):
        fit(rig, runs, ["presliding_"])
    with pytest.raises(InputError, match="gama"):
        fit(rig, runs, fixed={"gama": 3.0})
    with pytest.raises(InputError, match="out of range"):
        fit(rig, runs, fixed={"gamma": -3.0})
    with pytest.raises(InputError, match="no run"):
        fit(rig, [])


def test_every_effect_of_the_catalogue_vanishes_at_its_null() -> None:
    rig, runs, _ = campaign(7)
    warm = 30.0 + 5.0 * np.sin(runs[1].time_s)
    runs = [runs[0], replace(runs[1], temperature_c=warm)]
    bare = Model(rig).predict(runs[1])
    level = Model(rig, "coulomb").predict(runs[1])
    for effect in catalogue().values():
        law, expected = ("journal", bare) if effect.name in ON_BEARINGS else ("coulomb", level)
        with_null = Model(rig, law, effects=[effect.name]).predict(runs[1])
        np.testing.assert_array_equal(expected, with_null, err_msg=effect.name)


def test_comparison_points_at_the_right_axis() -> None:
    for effects, axis in (
        (("coulomb_drag",), "velocity"),
        (("position_ripple",), "angle"),
        (("sensor_lag",), "distance since a reversal"),
    ):
        rig, runs, truth = campaign(61, effects)
        names = [f.axis for f in compare(fit(rig, runs).model, runs).failures]
        assert axis in names[:6], (effects, names)
    rig, runs, truth = campaign(7)
    clean = compare(fit(rig, runs).model, runs)
    assert clean.failures == ()
    assert clean.rms_n == pytest.approx(truth["noise_n"], rel=0.04)
    assert clean.noise_n == pytest.approx(truth["noise_n"], rel=0.05)
    assert len(clean.runs) == len(SHORT.motions)


def test_wild_parameters_cost_no_more_time_than_they_are_worth() -> None:
    rig, runs, _ = campaign(60)
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", ())
    upper = problem.parameters["U_tr_m_s"].upper
    top = max(float(np.max(np.abs(run.velocity_m_s))) for run in runs)
    assert upper == pytest.approx(5.0 * top, rel=0.02)
    # The corner of the bounds where a film is stiffest: steps are cut, numbers stay finite.
    values = np.array([10.0, upper, 1e9, 1e5])
    residuals, jacobian = problem.linearise(values)
    assert all(np.isfinite(r).all() for r in residuals)
    assert all(np.isfinite(j).all() for j in jacobian)
