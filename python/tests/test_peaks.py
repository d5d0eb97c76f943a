"""Likelihoods with many peaks: the others are seen, and climbed."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from campaigns import campaign
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.minimum import approach, minimum, search_peaks, settle
from jbf.estimation.peaks import other_peaks
from jbf.estimation.problem import Problem
from jbf.models.catalogue import find_effect


def test_the_best_of_the_other_minima_are_found() -> None:
    def square(values: npt.NDArray[np.float64]) -> float:
        x = float(np.log(values[1] / 2e-3))
        return x**2 + 1.0 - float(np.cos(12.0 * x))

    # Minima lie near 2e-3 exp(k pi/6); the search stands on k = 2.
    here = np.array([7.0, 2e-3 * np.exp(np.pi / 3.0)])
    found = other_peaks(square, here, 1, 1e-6, 1e2)
    places = [np.log(v[1] / 2e-3) * 6.0 / np.pi for v in found]
    assert places == pytest.approx([0.0, -1.0], abs=0.1) or places == pytest.approx(
        [0.0, 1.0], abs=0.1
    )
    assert all(v[0] == 7.0 for v in found)
    # Bounds are kept.
    assert all(v[1] > 2.2e-3 for v in other_peaks(square, here, 1, 2.2e-3, 1e2))


def test_a_drive_that_rings_is_found_from_a_wrong_frequency() -> None:
    rig, runs, truth = campaign(8, ("drive_compliance",))
    assert find_effect("drive_compliance").peaks == "J_kg_m2"
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", ("drive_compliance",))
    right = truth["effects"]["drive_compliance"]["J"]
    start = {"drive_compliance.J_kg_m2": 5.0 * right}
    stuck = settle(problem, approach(problem, [start], 60))
    found = search_peaks(problem, stuck)
    which = problem.names.index("drive_compliance.J_kg_m2")
    assert problem.square(found.values) < problem.square(stuck.values)
    # As high as the peak that a search from the truth climbs: within one standard error.
    true = minimum(problem, [{"drive_compliance.J_kg_m2": right}])
    assert likelihood_gain(true, found) < 1.0
    assert abs(found.values[which] / right - 1.0) < 0.2
    assert abs(stuck.values[which] / right - 1.0) > 0.5
