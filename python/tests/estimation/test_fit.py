"""Fits to simulated records, residuals, and campaigns of `benches/torture` that once failed."""

import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from runpy import run_path
from typing import Any
from zlib import crc32

import jbf
import numpy as np
import pytest
from by_hand import LAW, along, there_and_back
from campaigns import campaign
from jbf import InputError, Model, Rig, Run, compare, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem

EXTENDED = pytest.mark.extended
CATALOGUE = jbf.effects()
ON_BEARINGS = [name for name, page in CATALOGUE.items() if "journal" not in page.refused]
LAW_NAMES = {"f_m": "f_m", "U_tr_m_s": "U_tr", "K0": "K0", "gamma": "gamma"}
LOADS = (("two_way_0.25", 0.7), ("stop_and_go", 0.7), ("two_way_2", 1.35))
"""Shares of the rig's load by run, for effects that require different loads."""


def fast(names: list[str], chosen: tuple[str, ...]) -> list[Any]:
    """All names as test parameters; the selected ones run in the default suite."""
    return [n if n in chosen else pytest.param(n, marks=EXTENDED) for n in names]


@cache
def simulated(effect: str) -> tuple[Rig, list[Run], dict[str, Any]]:
    """A campaign with an effect; its seed is independent of the other effects."""
    loads = LOADS if "loads" in CATALOGUE[effect].needs else ()
    return campaign(crc32(effect.encode()) % 1000, (effect,), loads=loads)


def truth_of(effect: str, truth: dict[str, Any]) -> dict[str, float]:
    """True parameters by their names in jbf, which are those of the simulator with a unit."""
    true_values = {name: truth["base"][short] for name, short in LAW_NAMES.items()}
    of_effect = truth["effects"][effect]
    for page in CATALOGUE[effect].parameters:
        if not page.stated:
            (short,) = (k for k in of_effect if page.name == k or page.name.startswith(f"{k}_"))
            true_values[f"{effect}.{page.name}"] = of_effect[short]
    return true_values


@pytest.mark.parametrize(
    "effect", fast(ON_BEARINGS, ("coulomb_drag", "sensor_lag", "gravity", "zero_load_dependence"))
)
def test_fit_of_the_simulated_effect_recovers_its_parameters(effect: str) -> None:
    rig, runs, truth = simulated(effect)
    found = fit(rig, runs, [effect])
    assert found.converged
    assert found.rms == pytest.approx(truth["noise_n"], rel=0.06)
    of_effect = [p for name, p in found.parameters.items() if name.startswith(f"{effect}.")]
    assert not all(p.held for p in of_effect)
    for name, value in truth_of(effect, truth).items():
        p = found.parameters[name]
        if p.held and name.startswith(f"{effect}."):
            # These short runs do not determine it. The true value must be nearly as likely.
            at_truth = fit(rig, runs, [effect], fixed={name: value})
            assert 2.0 * (found.loglik - at_truth.loglik) < 4.5**2, name
            continue
        assert p.stderr is not None, name
        # Stick-slip of a drive amplifies the quantisation of the encoder, which no error includes.
        allowance = 0.05 if CATALOGUE[effect].stage == "drive" else 0.01
        assert abs(p.value - value) < 4.5 * p.stderr + allowance * abs(value), name


@pytest.mark.parametrize("effect", fast(ON_BEARINGS, ("presliding", "sensor_lag")))
def test_derivatives_with_an_effect_match_finite_differences(effect: str) -> None:
    rig, runs, _ = simulated(effect)
    # A reversing run, or a run with rests or another load if that does not determine a parameter.
    for shown in (runs[1:2], runs[4:5]):
        problem = Problem(Campaign.prepare(rig, shown), "journal", "journal", (effect,))
        values = problem.starts({})[0]
        _, (jacobian,) = problem.linearise(values)
        if np.all(np.any(jacobian != 0.0, axis=0)):
            break
    for column, i in enumerate(problem.open):
        log = problem.log[i]
        h = 1e-5 * (values[i] if log else max(abs(values[i]), 1e-2))
        step = h * np.eye(len(values))[i]
        up, down = (problem.predict(values + s * step)[0] for s in (1.0, -1.0))
        slope = (up - down) / (2.0 * h) * (values[i] if log else 1.0)
        gap = np.abs(jacobian[:, column] - slope)
        # Some differences span a discontinuity of the derivative (stick, reversal).
        assert np.median(gap) < 1e-6 * np.max(np.abs(slope)), problem.names[i]
        assert np.quantile(gap, 0.95) < 1e-3 * np.max(np.abs(slope)), problem.names[i]


def test_prediction_does_not_change_if_an_effect_is_at_its_null() -> None:
    rig, runs, _ = campaign(7)
    run = replace(runs[1], temperature_c=30.0 + 5.0 * np.sin(runs[1].time_s))
    bare = {law: Model(rig, law).predict(run) for law in ("journal", "coulomb")}
    for name in CATALOGUE:
        law = "journal" if name in ON_BEARINGS else "coulomb"
        found = Model(rig, law, effects=[name]).predict(run)
        np.testing.assert_array_equal(bare[law], found, err_msg=name)


def test_fit_rejects_unknown_names_values_out_of_range_and_unusable_runs() -> None:
    rig, runs, _ = campaign(7)
    loads: dict[str, Any] = {"effects": ["zero_load_dependence"], "law": "coulomb"}
    for reason, arguments, options in (
        ("presliding", (rig, runs, ["presliding_"]), {}),
        ("gama", (rig, runs), {"fixed": {"gama": 3.0}}),
        ("out of range", (rig, runs), {"start": {"gamma": -3.0}}),
        ("no run", (rig, []), {}),
        ("same load", (Rig(), there_and_back(along(0.0))), loads),
    ):
        with pytest.raises(InputError, match=reason):
            fit(*arguments, **options)


@pytest.mark.parametrize("more_n", [1.0, -1.0])
def test_residuals_are_record_minus_model_with_means_reported_by_direction(more_n: float) -> None:
    runs = there_and_back(along(more_n), noise_rms=0.05)
    fixed = {"F_c": LAW["F_c"], "F_v": LAW["F_v"]}
    fitted = fit(Rig(), runs, law="coulomb", fixed=fixed)
    compared = compare(fitted.model, runs)
    for run, own, other in zip(runs, fitted.residuals, compared.residuals, strict=True):
        left = np.asarray(run.friction) - fitted.model.predict(run)
        np.testing.assert_allclose(own, left, atol=1e-9)
        np.testing.assert_allclose(other, left, atol=1e-9)
        assert np.mean(left * np.sign(run.velocity)) == pytest.approx(more_n, abs=0.01)
    (direction,) = [f for f in compared.failures if f.axis == "direction"]
    assert direction.labels == ("v < 0", "v > 0")
    assert direction.means_n == pytest.approx([-more_n, more_n], abs=0.01)
    assert direction.counts.tolist() == [501, 501]
    assert direction.share == pytest.approx(1.0 / (1.0 + 0.05**2), abs=0.01)


TORTURE = Path(__file__).resolve().parents[3] / "benches" / "torture"
FAST = (940246,)
FAILURES = {
    76: "film that answers at 1e5 1/s: no end within 120 s",
    700059: "overflow in the quadratic of a search",
    800020: "delay longer than the run: division by zero samples",
    910015: "exact fit: division by a noise of zero",
    920034: "unbounded derivatives in a proposed run",
    940246: "overflow of squares far above the noise",
    940439: "RMS of a run without counted samples",
    940508: "no long-run variance of a direction far above the noise",
}


@pytest.fixture(scope="module")
def torture() -> dict[str, Any]:
    sys.path.insert(0, str(TORTURE))
    try:
        return run_path(str(TORTURE / "__main__.py"), run_name="torture")
    finally:
        sys.path.remove(str(TORTURE))


@pytest.mark.parametrize(
    "seed", [s if s in FAST else pytest.param(s, marks=pytest.mark.extended) for s in FAILURES]
)
def test_diagnosis_of_a_formerly_failing_campaign_is_complete_and_consistent(
    seed: int, torture: Any
) -> None:
    row = torture["tried"](seed, 120.0)
    assert row["said"], FAILURES[seed]
    assert row["wrong"] == [], FAILURES[seed]
