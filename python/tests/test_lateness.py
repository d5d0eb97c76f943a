"""Forces that are late by times that are known: by run, by a clock that drifts, all alike, not at
all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from jbf.estimation.lateness import lateness
from jbf.estimation.noise import Noise
from late_runs import CHANCE, DELAY, DIFFER_S, LASTS_S, campaign, fitted, told


@pytest.mark.parametrize("seed", [0, 1])
def test_each_run_is_late_by_its_own_time(seed: int) -> None:
    problem, solution = fitted(campaign(DIFFER_S, seed=seed), DELAY)
    found = lateness(problem, solution, 0, CHANCE)
    assert found is not None
    assert found.drift == 0.0
    # The model has a part of it in common.
    common = dict(zip(problem.names, solution.values, strict=True))["time_delay.tau_s"]
    late = np.array(found.late_s) + common
    np.testing.assert_allclose(late, DIFFER_S, atol=0.6e-3)
    assert found.spread_s == pytest.approx(np.std(DIFFER_S, ddof=1), rel=0.15)


def test_a_law_without_a_delay_tells_it_as_well() -> None:
    late = (4e-3, -3e-3, -5e-3, 4e-3)
    found = told(late)
    assert found is not None
    np.testing.assert_allclose(found.late_s, late, atol=1e-3)


def test_coloured_residuals_tell_the_same() -> None:
    problem, solution = fitted(campaign((4e-3, -3e-3, -5e-3, 4e-3)))
    coloured = replace(solution, noise=Noise(0.1, 0.04))
    white, found = (lateness(problem, s, 0, CHANCE) for s in (solution, coloured))
    assert white is not None
    assert found is not None
    np.testing.assert_allclose(found.late_s, white.late_s, atol=2e-3)


@pytest.mark.parametrize("drift", [1e-3, 4e-4])
def test_a_clock_that_drifts(drift: float) -> None:
    # Started with each run: in its middle the force is late by half of what it is in the end.
    found = told((0.5 * drift * LASTS_S,) * 4, drift, DELAY)
    assert found is not None
    assert found.drift == pytest.approx(drift, rel=0.1)
    assert found.spread_s == 0.0
    np.testing.assert_allclose(found.late_s, 0.5 * drift * LASTS_S, rtol=0.1)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("late_s", "effects"),
    [(0.0, ()), (5e-3, ()), (25e-3, DELAY)],
    ids=["in time", "late alike", "with its effect"],
)
def test_a_delay_that_all_runs_share_is_none_of_the_recording(
    late_s: float, effects: tuple[str, ...], seed: int
) -> None:
    assert told((late_s,) * 4, effects=effects, seed=seed) is None


@pytest.mark.parametrize("seed", range(3))
def test_a_force_that_is_early_in_all_runs_is_the_recordings(seed: int) -> None:
    found = told((-6e-3,) * 4, seed=seed)
    assert found is not None
    assert (found.drift, found.spread_s) == (0.0, 0.0)
    np.testing.assert_allclose(found.late_s, -6e-3, atol=0.5e-3)


def test_of_two_runs_nobody_knows() -> None:
    assert told(DIFFER_S[:2]) is None


def test_the_samples_beside_reversals_tell_it_in_steps() -> None:
    found = lateness(*fitted(campaign(DIFFER_S)), 0, CHANCE, at_jumps=True)
    assert found is not None
    np.testing.assert_allclose(found.late_s, DIFFER_S, atol=2.2e-3)
    assert lateness(*fitted(campaign((0.0,) * 4)), 0, CHANCE, at_jumps=True) is None
