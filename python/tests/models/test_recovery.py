"""Confidence intervals of fits to records of the independent simulator cover the truth.

The shorter study uses eight repeats. Its limits fail by chance once in thousands of runs, and fail
nearly always for a bias of two standard errors or for errors wrong by a factor of two. The complete
study is `benches/recovery.py`.
"""

import numpy as np
import pytest
import recovery
import rigsim
from campaigns import SHORT
from jbf.models.catalogue import find_effect

REPEATS = 8

MULTIMODAL = [e for e in rigsim.CATALOGUE if find_effect(e).peaks]
"""Effects whose likelihood has several maxima; their intervals come from the bootstrap."""


def test_summary_of_standardised_errors_reports_bias_spread_and_coverage() -> None:
    z = np.random.default_rng(3).standard_normal(4000)
    good = recovery.Row.of([*z, float("nan")])
    assert good.none == 1
    assert 0.93 < good.covered < 0.97
    assert abs(good.bias) < 0.06
    assert 0.94 < good.spread < 1.06
    assert recovery.Row.of(list(z + 1.0)).covered < 0.86
    assert recovery.Row.of(list(2.0 * z)).spread > 1.9


@pytest.mark.extended
@pytest.mark.parametrize(
    "effect", ["coulomb_drag", "sensor_lag", "shear_thinning", "backlash", "vogel_viscosity"]
)
def test_standardised_errors_of_eight_fits_agree_with_a_standard_normal(effect: str) -> None:
    truth = recovery.make_truth(effect, 7, SHORT)
    errors = [recovery.errors_of(truth, (7, k), False) for k in range(REPEATS)]
    for name in errors[0]:
        z = np.array([row[name] for row in errors])
        assert np.isfinite(z).all(), name
        # The mean of eight errors has a standard deviation of 0.35, and their RMS is 0.4 to 1.7.
        assert abs(np.mean(z)) < 1.4, (name, z)
        assert np.sqrt(np.mean(z**2)) < 2.0, (name, z)
    assert np.sqrt(np.mean([z**2 for row in errors for z in row.values()])) > 0.4


@pytest.mark.extended
@pytest.mark.parametrize("effect", [None, *(e for e in rigsim.CATALOGUE if e not in MULTIMODAL)])
def test_at_least_39_of_48_confidence_intervals_cover_the_truth(effect: str | None) -> None:
    for name, z in recovery.study(effect, 48, 8, 1, False, 1).items():
        row = recovery.Row.of(z)
        # Fewer than 39 of 48 intervals of 95 % cover the truth in 1 of 5000 studies.
        assert row.covered * row.count >= 39, (name, row)
        assert row.none <= 5, (name, row)


@pytest.mark.extended
@pytest.mark.parametrize("effect", MULTIMODAL)
def test_at_least_12_of_16_bootstrap_intervals_cover_a_multimodal_effect(effect: str) -> None:
    for name, z in recovery.study(effect, 16, 8, 1, False, 1, 19).items():
        row = recovery.Row.of(z)
        # Fewer than 12 of 16 intervals of 95 % cover the truth in 1 of 1e5 studies.
        assert row.covered * row.count >= 12, (name, row)
