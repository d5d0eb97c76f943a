"""Statistics of a fit: intervals, covariance, likelihood, information criteria, bounds."""

import jbf
import numpy as np
import pytest
from by_hand import coulomb, one_way, there_and_back
from jbf import Fit, InputError, Rig, Run, fit
from scipy import stats

NOISE_N = 0.2


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    return there_and_back(coulomb, noise_rms=NOISE_N)


@pytest.fixture(scope="module")
def fitted(runs: list[Run]) -> Fit:
    """F = F_c sign(v) + F_v v with white noise: linear in both parameters."""
    return fit(Rig(), runs, law="coulomb", fixed={"F_s": 6.0})


def design(runs: list[Run]) -> tuple[np.ndarray, np.ndarray]:
    v = np.concatenate([run.velocity for run in runs])
    y = np.concatenate([np.asarray(run.friction) for run in runs])
    return np.column_stack([np.sign(v), v]), y


def test_interval_and_covariance_are_those_of_linear_least_squares(
    runs: list[Run], fitted: Fit
) -> None:
    x, y = design(runs)
    values, square, *_ = np.linalg.lstsq(x, y, rcond=None)
    covariance = square[0] / (len(y) - 2) * np.linalg.inv(x.T @ x)
    assert fitted.var_names == ("F_c", "F_v")
    np.testing.assert_allclose(fitted.covariance, covariance, rtol=0.02)
    errors = np.sqrt(np.diag(covariance))
    for level in (0.68, 0.95):
        half = stats.norm.ppf(0.5 + level / 2.0) * errors
        intervals = fitted.conf_int(level)
        for name, value, width in zip(fitted.var_names, values, half, strict=True):
            assert intervals[name] == pytest.approx((value - width, value + width), rel=2e-3)


def test_held_parameter_has_neither_error_nor_interval(fitted: Fit) -> None:
    assert fitted.params["F_s"] == 6.0
    assert np.isnan(fitted.stderr["F_s"])
    assert np.isnan(fitted.conf_int()["F_s"]).all()


@pytest.mark.parametrize("level", [0.0, 1.0, 95.0])
def test_interval_rejects_a_level_that_is_not_a_probability(fitted: Fit, level: float) -> None:
    with pytest.raises(InputError, match="level"):
        fitted.conf_int(level)


def test_likelihood_and_criteria_are_those_of_white_gaussian_noise(
    runs: list[Run], fitted: Fit
) -> None:
    residuals = np.concatenate(fitted.residuals)
    n, k = len(residuals), 2
    assert (fitted.nobs, fitted.noise.white) == (n, True)
    expected = np.sum(stats.norm.logpdf(residuals, scale=np.sqrt(np.mean(residuals**2))))
    assert fitted.loglik == pytest.approx(expected, rel=1e-9)
    assert fitted.aic == pytest.approx(2 * k - 2 * expected)
    assert fitted.bic == pytest.approx(k * np.log(n) - 2 * expected)


def test_each_estimated_parameter_adds_its_penalty_to_the_criteria(runs: list[Run]) -> None:
    fewer = fit(Rig(), runs, law="coulomb", fixed={"F_s": 6.0, "F_v": 20.0})
    assert len(fewer.var_names) == 1
    assert fewer.aic + 2.0 * fewer.loglik == pytest.approx(2.0)
    assert fewer.bic + 2.0 * fewer.loglik == pytest.approx(np.log(fewer.nobs))


def test_prediction_of_a_fit_is_that_of_its_model(runs: list[Run], fitted: Fit) -> None:
    values = fitted.params
    v = runs[0].velocity
    expected = values["F_c"] * np.sign(v) + values["F_v"] * v
    np.testing.assert_allclose(fitted.predict(runs[0]), expected, rtol=1e-6)
    recorded = np.asarray(runs[0].friction)
    np.testing.assert_allclose(fitted.residuals[0], recorded - fitted.predict(runs[0]), atol=1e-9)


def test_estimate_outside_bounds_ends_at_the_bound_without_an_error(runs: list[Run]) -> None:
    found = fit(Rig(), runs, law="coulomb", bounds={"F_c": (1.0, 4.0), "F_v": (0.0, 100.0)})
    assert found.params["F_c"] == pytest.approx(4.0)
    assert found.parameters["F_c"].held
    # The constrained minimum: viscous friction alone takes the rest.
    x, y = design(runs)
    slope = x[:, 1] @ (y - 4.0 * x[:, 0]) / (x[:, 1] @ x[:, 1])
    assert found.params["F_v"] == pytest.approx(slope, rel=0.02)
    assert found.bounds == {"F_c": (1.0, 4.0), "F_v": (0.0, 100.0)}


def test_bounds_that_contain_the_estimate_do_not_change_it(runs: list[Run], fitted: Fit) -> None:
    bounds = {"F_c": (4.0, 6.0), "F_v": (10.0, 30.0)}
    found = fit(Rig(), runs, law="coulomb", fixed={"F_s": 6.0}, bounds=bounds)
    for name in fitted.var_names:
        assert found.params[name] == pytest.approx(fitted.params[name], rel=1e-4)
        assert found.stderr[name] == pytest.approx(fitted.stderr[name], rel=1e-3)


def test_bounds_of_an_effect_apply_where_its_null_lies_outside() -> None:
    runs = [
        one_way("a", coulomb, noise_rms=0.1),
        one_way("b", coulomb, direction=-1.0, noise_rms=0.1),
    ]
    bounds = {"sensor_offset.b": (0.5, 2.0)}
    found = fit(Rig(), runs, ["sensor_offset"], law="coulomb", bounds=bounds)
    assert found.params["sensor_offset.b"] == pytest.approx(0.5)


@pytest.mark.parametrize(
    "bounds",
    [
        {"F_x": (0.0, 1.0)},
        {"F_c": (2.0, 1.0)},
        {"F_c": (1.0, 1.0)},
        {"F_c": 3.0},
        {"F_c": (float("nan"), 1.0)},
        {"F_c": (-5.0, -1.0)},
    ],
)
def test_invalid_bounds_are_rejected(runs: list[Run], bounds: dict) -> None:
    with pytest.raises(InputError, match="F_"):
        fit(Rig(), runs, law="coulomb", bounds=bounds)


def test_start_and_fixed_values_outside_the_bounds_are_rejected(runs: list[Run]) -> None:
    for arguments in ({"start": {"F_c": 5.0}}, {"fixed": {"F_c": 5.0}}):
        with pytest.raises(InputError, match="out of range"):
            fit(Rig(), runs, law="coulomb", bounds={"F_c": (1.0, 4.0)}, **arguments)


@pytest.mark.extended
def test_bootstrap_covariance_contains_the_scatter_of_repeated_fits(runs: list[Run]) -> None:
    found = fit(Rig(), runs, law="coulomb", fixed={"F_s": 6.0}, cov_type="bootstrap")
    again = jbf.bootstrap(fit(Rig(), runs, law="coulomb", fixed={"F_s": 6.0}), runs)
    assert found.cov_type == "bootstrap"
    assert found.stderr["F_c"] == again.fit.stderr["F_c"]
    np.testing.assert_allclose(
        np.sqrt(np.diag(found.covariance)), [found.stderr[name] for name in found.var_names]
    )


def test_unknown_covariance_type_is_rejected(runs: list[Run]) -> None:
    with pytest.raises(InputError, match="cov_type"):
        fit(Rig(), runs, law="coulomb", cov_type="HC3")  # type: ignore[arg-type]
