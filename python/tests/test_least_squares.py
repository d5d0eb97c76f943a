"""Values, errors and correlations of fits that are linear, against a textbook's least squares.

Seber & Lee, Linear Regression Analysis (2003), ch. 3: `beta = (X'X)^-1 X'y`, its covariance
`s^2 (X'X)^-1`, `s^2` the sum of squares over `n - k`.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from by_hand import Array, Friction, coulomb, there_and_back
from jbf import Fit, Model, ParameterValue, Rig, Run, bootstrap, fit

NOISE_N = 0.2
TERMS: dict[str, Friction] = {
    "F_c_n": lambda t, v, a: np.sign(v),
    "F_v_n_s_m": lambda t, v, a: v,
    "sensor_offset.b_n": lambda t, v, a: np.ones_like(v),
    "sensor_drift.d_n_s": lambda t, v, a: t,
    "inertia_leak.m_e_kg": lambda t, v, a: a,
}
"""Parameter to what it multiplies: time, speed, acceleration."""
EFFECTS = ["sensor_offset", "sensor_drift", "inertia_leak"]


def friction(t: Array, v: Array, a: Array) -> Array:
    """Every term at once."""
    return coulomb(t, v, a) - 0.5 + 0.04 * t + 3.0 * a


def textbook(runs: list[Run]) -> tuple[Array, Array, Array]:
    """Values, standard errors and correlations."""
    rows = []
    for run, rate, way in zip(runs, (2.0, 3.0), (1.0, -1.0), strict=True):
        a = way * 0.05 * rate * np.cos(rate * run.time_s)
        rows.append(np.stack([f(run.time_s, run.velocity_m_s, a) for f in TERMS.values()], 1))
    x = np.concatenate(rows)
    y = np.concatenate([run.friction_n for run in runs if run.friction_n is not None])
    inverse = np.linalg.inv(x.T @ x)
    values = inverse @ x.T @ y
    left = y - x @ values
    covariance = inverse * (left @ left) / (len(y) - x.shape[1])
    sd = np.sqrt(np.diag(covariance))
    return values, sd, covariance / np.outer(sd, sd)


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    return there_and_back(friction, noise_n=NOISE_N, seed=3)


@pytest.fixture(scope="module")
def fitted(runs: list[Run]) -> Fit:
    # These motions do not show how dry friction grows at rest.
    return fit(Rig(), runs, EFFECTS, law="coulomb", fixed={"F_s": 6.0})


def test_values_and_errors_are_the_textbooks(fitted: Fit, runs: list[Run]) -> None:
    values, errors, _ = textbook(runs)
    for name, value, error in zip(TERMS, values, errors, strict=True):
        found = fitted.parameters[name]
        # The acceleration is estimated from the speed.
        assert found.value == pytest.approx(value, abs=0.1 * error), name
        assert found.stderr == pytest.approx(error, rel=0.01), name
    assert fitted.rms_n == pytest.approx(NOISE_N, rel=0.07)
    assert fitted.samples == 1002


def test_correlations_are_the_textbooks_under_their_names(fitted: Fit, runs: list[Run]) -> None:
    _, _, table = textbook(runs)
    wanted = list(TERMS)
    there = [n for n, p in fitted.parameters.items() if p.note != "held fixed"]
    assert sorted(there) == sorted(wanted)
    order = [wanted.index(name) for name in there]
    np.testing.assert_allclose(fitted.correlations, table[np.ix_(order, order)], atol=0.005)
    said = [x for x in fitted.report().splitlines() if x.startswith("    C(")]
    for line in said:
        (first, second), value = (
            line.split("(")[1].split(")")[0].split(", "),
            float(line.rpartition("=")[2]),
        )
        assert value == pytest.approx(table[wanted.index(first), wanted.index(second)], abs=0.005)
    strong = np.abs(np.triu(table, 1)) > 0.3
    assert len(said) == strong.sum() > 1


def test_the_report_says_the_textbooks_errors(fitted: Fit, runs: list[Run]) -> None:
    values, errors, _ = textbook(runs)
    lines = {line.split()[0]: line for line in fitted.report().splitlines() if "+/-" in line}
    assert set(lines) == set(TERMS)
    for name, value, error in zip(TERMS, values, errors, strict=True):
        _, said, _, said_error = lines[name].split()[:4]
        # Two digits of the error are shown.
        assert float(said_error) == pytest.approx(error, rel=0.06), name
        assert float(said) == pytest.approx(value, abs=0.08 * error), name


def test_a_model_file_keeps_the_errors(fitted: Fit, tmp_path: Path) -> None:
    fitted.model.save(tmp_path / "m.toml")
    again = Model.load(tmp_path / "m.toml").parameters
    for name, found in fitted.parameters.items():
        there = again[name]
        assert isinstance(there, ParameterValue)
        assert there.stderr == found.stderr
        assert there.value == found.value


def test_errors_cover_the_truth_as_often_as_they_say() -> None:
    truth = np.array([5.0, 20.0, -0.5, 0.04, 3.0])
    off = []
    for seed in range(10, 50):
        again = there_and_back(friction, noise_n=NOISE_N, seed=seed)
        found = fit(Rig(), again, EFFECTS, law="coulomb", fixed={"F_s": 6.0}).parameters
        errors = np.array([found[n].stderr for n in TERMS], dtype=float)
        off.append((np.array([found[n].value for n in TERMS]) - truth) / errors)
    # 200 deviations, some of them correlated: their spread is known to 7 %.
    assert np.std(np.array(off)) == pytest.approx(1.0, abs=0.2)


def test_the_bootstrap_finds_the_textbooks_errors(fitted: Fit, runs: list[Run]) -> None:
    _, errors, _ = textbook(runs)
    # A bootstrap says no less than the fit: one that claims little lets it speak for itself.
    small = {
        n: p if p.stderr is None else replace(p, stderr=1e-3 * p.stderr)
        for n, p in fitted.parameters.items()
    }
    repeats = 160
    found = bootstrap(replace(fitted, parameters=small), runs, repeats=repeats, seed=7)
    ratios = []
    for name, error in zip(TERMS, errors, strict=True):
        said = found.fit.parameters[name].stderr
        assert said is not None
        # The half width of the middle 68 % of R answers is known to 0.96/sqrt(R): 8 %.
        assert said == pytest.approx(error, rel=0.25), name
        assert found.fit.model.parameters[name] == found.fit.parameters[name]
        assert found.values[name].shape == (repeats,)
        assert np.std(found.values[name]) == pytest.approx(error, rel=0.2), name
        ratios.append(said / error)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.15)


def test_the_bootstrap_says_no_less_than_the_fit(fitted: Fit, runs: list[Run]) -> None:
    large = {
        n: p if p.stderr is None else replace(p, stderr=10.0 * p.stderr)
        for n, p in fitted.parameters.items()
    }
    found = bootstrap(replace(fitted, parameters=large), runs, repeats=19).fit.parameters
    assert all(found[n].stderr == large[n].stderr for n in TERMS)
