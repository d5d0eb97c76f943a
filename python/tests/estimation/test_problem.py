"""Search variables, predictions, derivatives and rows of a fit, for a linear law."""

from functools import cache

import numpy as np
import pytest
from by_hand import coulomb, four_runs
from coulomb_problems import VALUES, coulomb_problem, values_of
from jbf import InputError, Parameter, Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.least_squares import LEAST_RUNS, SEARCHED, select_runs, triangular
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import BOUNDLESS, Problem, bounded, named_values

OFFSET = "sensor_offset.b"


@pytest.fixture(scope="module")
def problem() -> Problem:
    return coulomb_problem(four_runs(coulomb, noise_rms=0.1), ["sensor_offset"])


def test_encode_takes_logarithms_of_scales_and_drops_fixed_parameters() -> None:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_rms=0.1)[:2])
    problem = Problem(campaign, "stribeck", "journal", ["sensor_offset"], {"delta": 1.5})
    values = problem.starts({})[0]
    names = [n for n in problem.names if n != "delta"]
    free = [(problem.parameters[n], values[problem.names.index(n)]) for n in names]
    wanted = [np.log(value) if page.log else value for page, value in free]
    assert [problem.names[i] for i in problem.open] == names
    assert {problem.parameters[n].log for n in names} == {True, False}
    np.testing.assert_allclose(problem.encode(values), wanted)
    np.testing.assert_allclose(problem.decode(problem.encode(values), values), values)


def test_problem_with_more_fixed_parameters_keeps_bounds_and_has_its_own_best_values() -> None:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_rms=0.1))
    problem = Problem(campaign, "stribeck", "journal", ["sensor_offset"], {"delta": 1.5})
    # The bound of the breakaway force and the starting values depend on the runs.
    fixed = problem.restricted(campaign.only([0, 2]), {OFFSET: 0.3})
    free = {problem.names[i] for i in problem.open}
    assert {fixed.names[i] for i in fixed.open} == free - {OFFSET}
    assert fixed.fixed[OFFSET] == 0.3
    assert fixed.parameters == problem.parameters
    values = problem.starts({})[0]
    fixed.best.update(values, 1.0)
    assert problem.best.values is None
    assert len(fixed.residuals(values)) == 2


def test_decode_returns_fixed_parameters_of_the_base_and_clips_at_bounds(problem: Problem) -> None:
    values, base = values_of(problem), values_of(problem, F_s=9.0)
    x = problem.encode(values)
    back = problem.decode(x, base)
    held = problem.names.index("F_s")
    assert back[held] == base[held] == 9.0
    np.testing.assert_allclose(np.delete(back, held), np.delete(values, held))
    for far, bound in ((-1e9, problem.lower), (1e9, problem.upper)):
        out = problem.decode(np.full(len(x), far), values)
        np.testing.assert_array_equal(out[problem.open], bound[problem.open])
    far_values = np.full(len(values), 1e300)
    np.testing.assert_allclose(problem.encode(far_values), problem.encode(problem.upper))


def test_starts_combine_all_values_of_parameters_that_the_seed_lacks(problem: Problem) -> None:
    pages = problem.parameters
    starts = problem.starts({"F_s": 6.0, OFFSET: 0.125})
    free = [n for n in problem.names if n not in ("F_s", OFFSET)]
    assert len(starts) == np.prod([len(pages[n].starts) for n in free])
    assert len({tuple(s.tolist()) for s in starts}) == len(starts)
    assert {float(s[problem.names.index(OFFSET)]) for s in starts} == {0.125}
    assert [starts[0][problem.names.index(n)] for n in free] == [pages[n].starts[0] for n in free]


def test_angle_parameters_are_wrapped_into_one_period() -> None:
    problem = reversing(("cogging",))
    (phase,) = [i for i, p in enumerate(problem.parameters.values()) if p.period is not None]
    values = problem.starts({})[0]
    values[phase] = 1.0
    for turns in (-3, 0, 2):
        turned = values + 2.0 * np.pi * turns * np.eye(len(values))[phase]
        np.testing.assert_allclose(problem.wrapped(turned), values)


def test_named_values_are_accepted_within_their_bounds_or_at_their_null() -> None:
    pages = {"b": Parameter("b", lower=1.0, upper=5.0, null=0.0)}
    for value in (0.0, 1.0, 5.0):
        assert named_values({"b": value}, pages) == {"b": value}
    for wrong in (0.999, 5.001):
        with pytest.raises(InputError, match="out of range"):
            named_values({"b": wrong}, pages)


def test_residual_of_each_run_is_record_minus_prediction(problem: Problem) -> None:
    values = values_of(problem, F_c=5.2, **{OFFSET: 0.3})
    predictions, residuals = problem.predict(values), problem.residuals(values)
    for f, r, p in zip(predictions, residuals, problem.campaign.prepared, strict=True):
        v = p.motion.velocity
        np.testing.assert_allclose(f, 5.2 * np.sign(v) + 20.0 * v + 0.3)
        np.testing.assert_allclose(r, p.friction - f)
    for some, i in zip(problem.residuals(values, [2, 0]), (2, 0), strict=True):
        np.testing.assert_array_equal(some, residuals[i])
    wanted = problem.campaign.samples.square(residuals)
    assert problem.square(values) == pytest.approx(wanted)


def test_derivatives_are_those_of_the_prediction_by_the_search_variables(problem: Problem) -> None:
    values = values_of(problem)
    residuals, slopes = problem.linearise(values)
    names = [problem.names[i] for i in problem.open]
    for p, r, j in zip(problem.campaign.prepared, residuals, slopes, strict=True):
        v = p.motion.velocity
        columns = {"F_c": np.sign(v), "F_v": v, OFFSET: np.ones(len(v))}
        for k, name in enumerate(names):
            scale = VALUES[name] if problem.parameters[name].log else 1.0
            np.testing.assert_allclose(j[:, k], scale * columns[name], atol=1e-9)
        np.testing.assert_allclose(r, p.friction - coulomb(v, v, v) - values_of(problem)[-1])
    some, by = problem.linearise(values, [1], [problem.names.index("F_v")])
    np.testing.assert_array_equal(some[0], residuals[1])
    np.testing.assert_array_equal(by[0][:, 0], slopes[1][:, names.index("F_v")])


def test_derivatives_above_a_limit_or_undefined_are_replaced_by_zero() -> None:
    wild = np.array([[1.0, 2.0 * BOUNDLESS], [np.nan, -4.0]])
    assert bounded(wild, np.array([10.0, 0.5])).tolist() == [[10.0, 0.0], [0.0, -2.0]]
    assert bounded(np.array([[1.0, 2.0]]), np.array([1e200, 1.0])).tolist() == [[0.0, 2.0]]


@pytest.mark.parametrize("noise", [WHITE, Noise(0.1, 0.5)])
def test_gauss_newton_rows_have_inner_products_of_all_rows(problem: Problem, noise: Noise) -> None:
    values, samples = values_of(problem), problem.campaign.samples
    lines = problem.linearise(values)
    r, j = samples.stacked(*lines, noise)
    few, slopes, count = problem.gauss_newton_rows(values, samples, noise)
    assert count == len(r)
    assert few @ few == pytest.approx(r @ r)
    np.testing.assert_allclose(slopes.T @ few, j.T @ r, atol=1e-9)
    np.testing.assert_allclose(slopes.T @ slopes, j.T @ j, atol=1e-9)
    found = problem.solution(values, samples, noise)
    assert found.cost == pytest.approx(len(r) * np.log(float(r @ r) / len(r)))
    np.testing.assert_allclose(found.stacked()[0], r)
    assert found.free == 3
    assert found.rms == pytest.approx(samples.rms(lines[0]))


@cache
def reversing(effects: tuple[str, ...]) -> Problem:
    t = 0.01 * np.arange(3000)
    v = 0.1 * np.sin(1.3 * t)
    noise = 0.05 * np.random.default_rng(1).standard_normal(len(t))
    run = Run.from_arrays(t, v, coulomb(t, v, v) + noise, position_m=-0.1 / 1.3 * np.cos(1.3 * t))
    return Problem(Campaign.prepare(Rig(), [run]), "coulomb", "journal", effects)


@pytest.mark.parametrize("effect", ["time_delay", "backlash", "sensor_hysteresis"])
def test_samples_at_reversals_are_excluded_if_an_effect_moves_jumps(effect: str) -> None:
    problem = reversing((effect,))
    values = problem.starts({})[0]
    before, after = problem.campaign.samples, problem.samples_at(values)
    aside = before.counted[0] & ~after.counted[0]
    assert 5 <= np.count_nonzero(aside) < 0.2 * before.count
    assert np.all(after.weight[0] <= before.weight[0])
    known = problem.samples_at(values, problem.residuals(values))
    np.testing.assert_array_equal(known.counted[0], after.counted[0])
    # No sample is excluded if the effect is at its null or does not move jumps.
    pages = zip(values, problem.parameters.values(), strict=True)
    nulls = [value if page.null is None else page.null for value, page in pages]
    assert problem.samples_at(np.array(nulls)) is before
    offset = reversing(("sensor_offset",))
    assert offset.samples_at(offset.starts({})[0]) is offset.campaign.samples


def test_triangular_rows_preserve_all_inner_products() -> None:
    random = np.random.default_rng(1)
    r, j = random.standard_normal(500), random.standard_normal((500, 4))
    few_r, few_j = triangular(r, j)
    assert len(few_r) == 5
    assert few_r @ few_r == pytest.approx(r @ r)
    np.testing.assert_allclose(few_j.T @ few_j, j.T @ j)
    np.testing.assert_allclose(few_j.T @ few_r, j.T @ r)
    assert triangular(r[:0], j[:0])[1].shape == (0, 4)


def test_search_of_many_samples_uses_equidistant_runs_sorted_by_name() -> None:
    names = [f"{k:02d}" for k in range(20)]
    length = 4 * SEARCHED // 20
    assert select_runs([length] * 20, names) == [0, 4, 8, 12, 16]
    assert select_runs([length] * 20, names[::-1]) == [3, 7, 11, 15, 19]
    assert len(select_runs([100 * length] * 20, names)) == LEAST_RUNS
    for lengths in ([length // 4] * 20, [10 * length] * 2):
        assert select_runs(lengths, names[: len(lengths)]) == list(range(len(lengths)))


@pytest.mark.extended
def test_fit_of_a_million_samples_is_the_regression_over_all_of_them() -> None:
    t = 0.01 * np.arange(34_000)
    runs = []
    for k in range(30):
        v = (-1.0) ** k * (0.1 + 0.03 * np.sin((0.5 + 0.1 * k) * t) + 0.02 * np.sin(0.31 * t))
        noise = 0.1 * np.random.default_rng(k).standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, coulomb(t, v, v) + 0.3 + noise, name=f"{k:02}"))
    problem = coulomb_problem(runs, ["sensor_offset"])
    assert not problem.fits_in_memory
    assert len(problem.thinned.campaign.prepared) == 5
    found = minimum(problem, [{}])
    assert found.converged
    v = np.concatenate([p.motion.velocity for p in problem.campaign.prepared])
    f = np.concatenate([p.friction for p in problem.campaign.prepared])
    x = np.column_stack([np.sign(v), v, np.ones(len(v))])
    wanted, (square,), *_ = np.linalg.lstsq(x, f, rcond=None)
    at = [problem.names.index(n) for n in ("F_c", "F_v", "sensor_offset.b")]
    errors = np.sqrt(square / len(v) * np.diag(np.linalg.inv(x.T @ x)))
    assert np.all(np.abs(found.values[at] - wanted) < 0.05 * errors)
    assert found.rms == pytest.approx(np.sqrt(square / len(v)), rel=1e-6)
