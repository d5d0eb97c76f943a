"""Parameters that are not identifiable: criterion, and the value at which they are held."""

import math
from collections.abc import Callable
from typing import Any

import jbf
import numpy as np
import pytest
from by_hand import LAW, coulomb, there_and_back
from jbf import Fit, Parameter, ParameterValue, Rig, fit
from jbf.estimation.bounds import bound_note
from jbf.estimation.campaign import Campaign
from jbf.estimation.fit import finish
from jbf.estimation.identifiability import (
    HELD,
    NO_EFFECT,
    NOT_DETERMINED,
    NOT_SEPARATE,
    at_null,
    idle_effects,
    reason_not_identifiable,
    reset_unidentified,
)
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.standard_errors import standard_errors

RUNS = there_and_back(coulomb, noise_rms=0.1)
"""Two runs at 0.05 to 0.15 m/s without rests or reversals."""


def notes_of(fitted: Fit) -> dict[str, str]:
    """Notes of the held parameters, after a check that the fit is consistent with them."""
    notes = {n: str(p.note) for n, p in fitted.parameters.items() if p.held}
    for name, p in fitted.parameters.items():
        assert (p.stderr is None) is (name in notes)
        assert fitted.model.parameters[name] == p
    free = len(fitted.parameters) - len(notes)
    assert fitted.correlations.shape == (free, free)
    np.testing.assert_allclose(np.diag(fitted.correlations), 1.0)
    for run, residual in zip(RUNS, fitted.residuals, strict=True):
        np.testing.assert_allclose(run.friction - fitted.model.predict(run), residual, atol=1e-9)
    return notes


def test_breakaway_force_without_influence_is_held_at_the_sliding_force() -> None:
    found = fit(Rig(), RUNS, law="coulomb")
    assert notes_of(found) == {"F_s": NOT_DETERMINED}
    assert found.parameters["F_s"].value == found.parameters["F_c"].value
    assert found.parameters["F_c"].value == pytest.approx(LAW["F_c"], abs=0.03)
    given = fit(Rig(), RUNS, law="coulomb", start={"F_s": 8.0})
    assert given.parameters["F_s"] == ParameterValue(8.0, None, NOT_DETERMINED, held=True)


def test_fixed_parameter_is_held_at_the_value_given_by_the_user() -> None:
    fixed = {"F_s": 6.0, "sensor_offset.b": 0.25}
    found = fit(Rig(), RUNS, ["sensor_offset"], law="coulomb", fixed=fixed)
    assert notes_of(found) == {"F_s": HELD, "sensor_offset.b": HELD}
    assert found.fixed == ("F_s", "sensor_offset.b")
    assert found.parameters["sensor_offset.b"].value == 0.25


def test_only_confounded_parameters_and_those_without_influence_are_held() -> None:
    found = fit(Rig(), RUNS, law="seven_parameter")
    notes = notes_of(found)
    # The last point of the search in its flat valley determines which of two notes is given.
    assert notes["v_s"] == NOT_SEPARATE or "exceeds its value" in notes["v_s"]
    assert notes["gamma_s"] == notes["k_t"] == NOT_DETERMINED
    friction = found.parameters["F_c"]
    assert abs(friction.value - LAW["F_c"]) < 3.0 * friction.stderr < 0.3


def test_viscous_coefficient_is_held_at_zero_if_friction_falls_with_speed() -> None:
    runs = there_and_back(lambda t, v, a: 5.0 * np.sign(v) - 0.5 * v, noise_rms=0.05)
    found = fit(Rig(), runs, law="coulomb", fixed={"F_s": 6.0}).parameters
    assert (found["F_v"].value, found["F_v"].held) == (0.0, True)
    assert "lower bound" in str(found["F_v"].note)
    # The other parameter is the mean friction in the direction of motion.
    mean = np.mean([r.friction * np.sign(r.velocity) for r in runs])
    assert found["F_c"].value == pytest.approx(mean, abs=8e-4)
    assert not found["F_c"].held


def test_asymmetry_estimate_is_its_upper_bound_if_the_true_value_is_larger() -> None:
    runs = there_and_back(lambda t, v, a: np.where(v > 0, 10.0, 0.0), noise_rms=0.05)
    fixed = {"F_c": 5.0, "F_s": 6.0, "F_v": 0.0}
    found = fit(Rig(), runs, ["direction_asymmetry"], law="coulomb", fixed=fixed)
    assert found["direction_asymmetry.a"].value == pytest.approx(0.95)
    assert "upper bound" in str(found["direction_asymmetry.a"].note)


@pytest.mark.parametrize(
    ("effect", "values", "put"),
    [
        ("presliding", {"sigma": 1e12}, {"sigma": math.inf}),
        ("quadratic_drag", {"c": 0.0}, {"c": 0.0}),
        # Parameters without a null move to their starting values: a slow speed of these runs.
        (
            "stribeck_excess",
            {"a": 0.0, "v_s": 2e-5, "n": 7.9},
            {"a": 0.0, "v_s": pytest.approx(0.0526, rel=1e-3), "n": 1.5},
        ),
    ],
)
def test_parameters_of_an_effect_at_its_null_are_held(effect: str, values: Any, put: Any) -> None:
    ended_at = {**LAW, "F_s": 6.0} | {f"{effect}.{n}": v for n, v in values.items()}
    problem = Problem(Campaign.prepare(Rig(), RUNS), "coulomb", "journal", [effect])
    here = np.array([ended_at[name] for name in problem.names])
    found = finish(problem, problem.solution(here, problem.samples_at(here), WHITE))
    wanted = {"F_s": NOT_DETERMINED} | {f"{effect}.{n}": NO_EFFECT for n in values}
    assert notes_of(found) == wanted
    assert {n: found.parameters[f"{effect}.{n}"].value for n in values} == put


Walled = Callable[[float, float, float], str]
WALL = [
    Parameter("F_c", "N", lower=0.0, upper=1e4, starts=(5.0,)),
    Parameter("p", lower=0.0, upper=1e4, starts=(4.0,)),
    Parameter("q", lower=1e-7, upper=1e3, starts=(0.01,), log=True),
]


@pytest.fixture
def walled(request: pytest.FixtureRequest) -> Walled:
    """A law that changes by a jump (N) where p or q is below a limit, and is constant elsewhere."""

    def law(jump_n: float, wall_p: float, wall_q: float) -> str:
        def walled_law(velocity, F_c, p, q):  # type: ignore[no-untyped-def]
            below = (np.real(p) < wall_p) | (np.real(q) < wall_q)
            return F_c * np.sign(velocity) + jump_n * below

        request.addfinalizer(lambda: jbf.forget_law("walled_law"))
        return jbf.register_law(walled_law, parameters=WALL).name

    return law


def moved_back(
    law: str, p: float, q: float, start: dict[str, float] | None = None
) -> tuple[float, float, dict[str, str]]:
    """Held values of p and q after a search that ended at p and q, and the notes."""
    problem = Problem(Campaign.prepare(Rig(), RUNS), law, "journal", ())
    here = np.array([5.0, p, q])
    solution = problem.solution(here, problem.campaign.samples, WHITE)
    solved = reset_unidentified(problem, solution, standard_errors(problem, solution), start or {})
    for a, b in zip(solved.residuals, problem.residuals(solved.values), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-12)
    return float(solved.values[1]), float(solved.values[2]), solved.notes


@pytest.mark.parametrize(
    ("wall_p", "wall_q", "there_p", "there_q"),
    [
        (0.0, 0.0, 4.0, 0.01),
        # Halving the distance from 900 to 4 reaches 452, a quarter of it 676, an eighth 788.
        (400.0, 0.0, 452.0, 0.01),
        (500.0, 0.0, 676.0, 0.01),
        (700.0, 0.0, 788.0, 0.01),
        (800.0, 0.0, 900.0, 0.01),
        # The move is from 100 to 0.01 in the logarithm.
        (0.0, 0.5, 4.0, 1.0),
        (0.0, 20.0, 4.0, 10.0**1.5),
    ],
)
def test_parameter_is_moved_towards_its_start_as_far_as_the_likelihood_permits(
    walled: Walled, wall_p: float, wall_q: float, there_p: float, there_q: float
) -> None:
    p, q, notes = moved_back(walled(1.0, wall_p, wall_q), 900.0, 100.0)
    assert (p, q) == pytest.approx((there_p, there_q))
    home = {"p": there_p == 4.0, "q": there_q == 0.01}
    assert {name: note == NOT_DETERMINED for name, note in notes.items()} == home


def test_parameter_without_influence_returns_to_the_start_value_of_the_user(walled: Walled) -> None:
    p, _, notes = moved_back(walled(1.0, 0.0, 0.0), 0.7, 1.0, {"p": 0.1})
    assert (p, notes["p"]) == (0.1, NOT_DETERMINED)


@pytest.mark.parametrize(("increase", "same"), [(0.08, True), (0.12, False)])
def test_parameter_is_reset_if_the_deviance_increases_by_at_most_0_1(
    walled: Walled, increase: float, same: bool
) -> None:
    residual = np.concatenate([r.friction - 5.0 * np.sign(r.velocity) for r in RUNS])
    # n log(mean (r - jump)^2 / mean r^2) = increase
    growth = np.mean(residual**2) * np.expm1(increase / len(residual))
    mean = np.mean(residual)
    jump = mean + np.sqrt(mean**2 + growth)
    p, _, _ = moved_back(walled(float(jump), 500.0, 0.0), 900.0, 1.0)
    assert (p == 4.0) == same


def test_likelihood_of_a_fit_is_that_of_its_residuals_after_a_reset(walled: Walled) -> None:
    residual = np.concatenate([r.friction - 5.0 * np.sign(r.velocity) for r in RUNS])
    jump = 2.0 * np.mean(residual) + 0.005 * np.std(residual)
    problem = Problem(Campaign.prepare(Rig(), RUNS), walled(jump, 500.0, 0.0), "journal", ())
    values = np.array([5.0, 900.0, 1.0])
    solution = problem.solution(values, problem.campaign.samples, WHITE)
    found = finish(problem, solution)
    assert found.params["p"] == 4.0
    after = np.concatenate(found.residuals)
    assert not np.allclose(after, np.concatenate(solution.residuals))
    n = len(after)
    gaussian = -0.5 * n * (np.log(2.0 * np.pi * np.mean(after**2)) + 1.0)
    assert found.loglik == pytest.approx(gaussian, abs=1e-6)


SCALE = Parameter("v_s", lower=1e-7, upper=1e3, starts=(0.01,), log=True)
PLAIN = Parameter("F_v", lower=0.0, upper=1e7, starts=(10.0,))
SIGNED = Parameter("b", lower=-1e5, upper=1e5, null=0.0, starts=(0.3,))
DRAG = Parameter("F_d", lower=0.0, upper=1e4, null=0.0, starts=(0.5,))
STIFF = Parameter("sigma", lower=1.0, upper=1e12, null=math.inf, starts=(3e3,), log=True)
FACTOR = Parameter("factor", lower=1e-3, upper=1e3, null=1.0, starts=(0.5,), log=True)
SHARE = Parameter("share", lower=0.0, upper=1.0, null=1.0, starts=(0.5,))


@pytest.mark.parametrize(
    ("page", "value", "error"),
    [
        (PLAIN, 0.003, 0.001),
        (PLAIN, 3.0, 3.0),
        (SCALE, 0.02, 0.019),
        # The estimate of a signed parameter may be zero within its error.
        (SIGNED, -0.01, 0.1),
        # The distance to the bound exceeds a millionth of the logarithmic width, which is 23.
        (SCALE, 1e-7 * math.exp(2.4e-5), 1e-12),
    ],
)
def test_parameter_is_determined_if_signed_or_not_smaller_than_its_error(
    page: Parameter, value: float, error: float
) -> None:
    assert reason_not_identifiable(page, value, error) is None


@pytest.mark.parametrize("error", [0.0, 3.0, math.nan])
@pytest.mark.parametrize(
    ("page", "value", "bound"),
    [
        (PLAIN, 0.0, "lower bound 0"),
        (PLAIN, 1e7, "upper bound 1e+07"),
        (SCALE, 1e-7 * math.exp(2.2e-5), "lower bound 1e-07"),
        (SCALE, 1e3, "upper bound 1000"),
        (SIGNED, -1e5, "lower bound -100000"),
    ],
)
def test_parameter_at_a_bound_is_not_determined_whatever_its_error(
    page: Parameter, value: float, bound: str, error: float
) -> None:
    note = reason_not_identifiable(page, value, error)
    assert bound in str(note)
    # The bound is reported even if the parameter is also confounded with another.
    assert reason_not_identifiable(page, value, error, separate=False) == note
    assert bound_note(page, value, error) == note


@pytest.mark.parametrize(("share", "at_bound"), [(1.0, True), (1.1, False)])
def test_parameter_bound_is_reached_within_1e_6_of_the_error(share: float, at_bound: bool) -> None:
    error = 2.0**20
    assert (bound_note(PLAIN, share * 1e-6 * error, error) is not None) == at_bound


@pytest.mark.parametrize(
    ("page", "value", "error", "largest"),
    [
        (PLAIN, 3.0, 4.0, 11.0),
        (PLAIN, 2e6, 3.9e6, 9.8e6),
        # Two errors reach the upper bound; the error of a logarithm does not define an interval
        # there.
        (PLAIN, 2e6, 4e6, None),
        (SCALE, 1e-4, 28.0, None),
        (SCALE, 1.0, math.inf, None),
    ],
)
def test_scale_below_its_error_is_reported_with_an_upper_limit_of_two_errors(
    page: Parameter, value: float, error: float, largest: float | None
) -> None:
    note = str(reason_not_identifiable(page, value, error))
    assert "exceeds its value" in note
    assert ("below" in note) == (largest is not None)
    assert largest is None or float(note.split()[-1]) == pytest.approx(largest, rel=0.05)


def test_parameter_without_influence_or_confounded_is_not_determined() -> None:
    assert reason_not_identifiable(SCALE, 1e-7, math.nan, sensitive=False) == NOT_DETERMINED
    assert reason_not_identifiable(PLAIN, 9.9, 0.1, separate=False) == NOT_SEPARATE


@pytest.mark.parametrize(
    ("page", "there", "elsewhere"),
    [
        (DRAG, (0.0, 1e-9), (0.01,)),
        # The bound adjacent to an infinite null.
        (STIFF, (1e12, math.inf), (1e11, 1.0)),
        # A null at the upper bound.
        (SHARE, (1.0, 1.0 - 1e-9), (0.5, 0.0)),
        # A null between the bounds does not stop a search; the last parameter is without a null.
        (SIGNED, (), (0.0,)),
        (FACTOR, (), (1.0,)),
        (PLAIN, (), (0.0,)),
    ],
)
def test_fitted_parameter_is_at_its_null_only_if_the_null_is_a_reached_bound(
    page: Parameter, there: tuple[float, ...], elsewhere: tuple[float, ...]
) -> None:
    assert all(at_null(page, value, 0.1) for value in there)
    assert not any(at_null(page, value, 0.1) for value in elsewhere)


def test_fixed_parameter_is_at_its_null_only_if_equal_to_the_null() -> None:
    assert at_null(SIGNED, 0.0, fixed=True)
    assert not at_null(DRAG, 1e-9, fixed=True)
    assert not at_null(PLAIN, 0.0, fixed=True)


def test_effect_is_idle_if_all_its_parameters_with_a_null_equal_the_null() -> None:
    pages = {
        "F_v": PLAIN,
        "one.F_d": DRAG,
        "one.v_s": SCALE,
        "two.F_d": DRAG,
        "two.b": SIGNED,
        "three.sigma": STIFF,
        "four.v_s": SCALE,
    }
    effects = ("one", "two", "three", "four")
    values = [0.0, 0.0, 5.0, 0.0, 0.0, 1e12, 1e-7]
    assert idle_effects(effects, pages, values) == ("one", "three")
    assert idle_effects(effects, pages, values, fixed=("two.b",)) == ("one", "two", "three")
    values[1] = 1e-9
    assert idle_effects(effects, pages, values) == ("three",)
    assert idle_effects(effects, pages, values, {"one.F_d": 0.1}) == ("one", "three")
