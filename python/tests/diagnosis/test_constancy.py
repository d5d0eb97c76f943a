"""Constancy of the parameters between runs: score test against regressions, and simulations."""

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from by_hand import Friction, coulomb, four_runs
from campaigns import campaign as simulated
from conftest import LAW as JOURNAL_LAW
from jbf import Rig, Run
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure.constancy import (
    Disagreement,
    disagreement,
    find_disagreement,
    run_specific_step,
)
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.random_effects import RandomEffects
from jbf.estimation.solution import Solution
from scipy import signal, stats
from slides import VALUES, Array, numbers_in, slides, solution_with, white_noise

N = 400
ALTERNATING = np.where(np.arange(N) % 2, 1.0, -1.0)
"""Noise of variance one that is nearly uncorrelated with any smooth direction."""
LEVEL = np.ones(N)
RAMP = np.linspace(-1.0, 1.0, N)
SPEED = 0.1 + 0.05 * RAMP


@cache
def one_way(runs: int) -> Campaign:
    """Slides whose dry friction is a level and whose viscous friction is a ramp."""
    return slides([SPEED] * runs)


def explained(design: Array, target: Array) -> float:
    """Sum of squares that a regression explains."""
    fitted = design @ np.linalg.lstsq(design, target, rcond=None)[0]
    return float(fitted @ fitted)


def by_regression(residuals: Sequence[Array], design: Array) -> tuple[float, list[float]]:
    """Gain of separate parameters for each run over common ones, and explained squares by run."""
    sigma = [float(np.sqrt(np.mean(r**2))) for r in residuals]
    separate = [explained(design, r / s) for r, s in zip(residuals, sigma, strict=True)]
    stacked = np.concatenate([r / s for r, s in zip(residuals, sigma, strict=True)])
    common = explained(np.concatenate([design / s for s in sigma]), stacked)
    return sum(separate) - common, separate


@pytest.mark.parametrize(("deviation", "reported"), [(0.08, False), (0.12, True)])
def test_difference_between_runs_is_reported_from_one_percent_of_the_mean_square(
    deviation: float, reported: bool
) -> None:
    """The squares of the deviations are 0.6 and 1.4 % of the variance of the noise."""
    noise = np.tile(ALTERNATING, 25)
    campaign = slides([np.tile(SPEED, 25)] * 2)
    problem, solution = solution_with(campaign, [noise + deviation, noise - deviation])
    assert disagreement(problem, solution).beyond_chance()
    assert bool(find_disagreement(problem, solution, DEFAULT)) == reported


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_disagreement_of_runs_is_the_gain_of_separate_regressions(unit: float) -> None:
    sizes = ((0.5, 0.3), (-0.5, 0.0), (0.2, -0.4), (0.0, 0.1))
    residuals = [unit * (ALTERNATING + a + b * RAMP) for a, b in sizes]
    found = disagreement(*solution_with(one_way(4), residuals))
    gain, own = by_regression(residuals, np.column_stack([LEVEL, RAMP]))
    assert found.gain == pytest.approx(gain)
    # Two directions in each of four runs, minus the two common parameters.
    assert found.degrees == 6
    assert found.by_run == pytest.approx(dict(zip("abcd", [0.5 * g for g in own], strict=True)))
    assert list(found.by_run.values()) == sorted(found.by_run.values(), reverse=True)


def test_parameter_change_common_to_all_runs_is_not_disagreement() -> None:
    found = disagreement(*solution_with(one_way(4), [ALTERNATING + 0.5 + 0.3 * RAMP] * 4))
    assert found.gain == pytest.approx(0.0, abs=1e-6)
    assert found.degrees == 6


@pytest.mark.parametrize("run", [0, 1])
def test_single_run_or_run_of_two_samples_causes_no_disagreement(run: int) -> None:
    residuals = [ALTERNATING + 0.5, ALTERNATING - 0.5]
    alone = disagreement(*solution_with(one_way(1), residuals[:1]))
    assert (alone.gain, alone.degrees, list(alone.by_run)) == (0.0, 0, ["a"])
    # Two samples are explained by two parameters.
    masks = [np.ones(N, dtype=bool), np.ones(N, dtype=bool)]
    masks[run] = np.isin(np.arange(N), [0, N - 1])
    samples = one_way(2).samples.within(masks)
    found = disagreement(*solution_with(one_way(2), residuals, samples=samples))
    assert (found.gain, found.degrees, list(found.by_run)) == (0.0, 0, ["ba"[run]])


@pytest.mark.parametrize(("term", "disagrees"), [("effect", True), ("law", False)])
def test_disagreement_on_an_effect_excludes_the_disagreement_on_the_law(
    term: str, disagrees: bool
) -> None:
    """The law's direction is the sign of the velocity, that of the sensor offset a constant."""
    sign = np.where(np.arange(N) < N // 2, 1.0, -1.0)
    campaign = slides([sign * SPEED] * 3)
    problem = Problem(campaign, "coulomb", "journal", ("sensor_offset",))
    values = np.array([VALUES.get(name, 0.0) for name in problem.names])
    direction = LEVEL if term == "effect" else sign
    residuals = [ALTERNATING + a * direction for a in (0.5, -0.5, 0.2)]
    solution = replace(problem.solution(values, campaign.samples, WHITE), residuals=residuals)
    found = disagreement(problem, solution, "sensor_offset")
    assert found.degrees == 2
    assert (found.gain > 40.0) == disagrees
    assert disagreement(problem, solution).gain > 40.0


@pytest.mark.parametrize(("deviates", "disagrees"), [("F_c", False), ("zero", True)])
def test_parameter_with_a_random_effect_may_differ_by_run(deviates: str, disagrees: bool) -> None:
    """The random effects are too small to change the whitening."""
    residuals = [ALTERNATING + a for a in (0.5, -0.5, 0.2)]
    between = RandomEffects((deviates,), tuple(np.full((N, 1), 1e-12) for _ in residuals), 1.0)
    samples = replace(one_way(3).samples, between=between)
    found = disagreement(*solution_with(one_way(3), residuals, samples=samples))
    assert (found.gain > 50.0) == disagrees


@pytest.mark.parametrize("deviates", ["gamma", "U_tr_m_s", "zero"])
@pytest.mark.parametrize("direction", ["gamma", "U_tr_m_s"])
def test_random_effect_of_the_viscosity_covers_both_of_its_parameters(
    direction: str, deviates: str, rig: Rig, runs: list[Run]
) -> None:
    campaign = Campaign.prepare(rig, runs)
    problem = Problem(campaign, "journal", "journal", ())
    values = np.array([JOURNAL_LAW[name] for name in problem.names])
    solution = problem.solution(values, campaign.samples, WHITE)
    place = [problem.names[i] for i in problem.open].index(direction)
    columns = [j[:, place] for j in solution.jacobian]
    residuals = [
        e + sign * 0.3 * column / np.std(column)
        for e, column, sign in zip(white_noise(campaign, 1), columns, (1, -1, 1), strict=True)
    ]
    tiny = tuple(np.full((len(e), 1), 1e-12) for e in residuals)
    samples = replace(campaign.samples, between=RandomEffects((deviates,), tiny, 1.0))
    changed = replace(solution, residuals=residuals, samples=samples)
    assert disagreement(problem, changed).beyond_chance() == (deviates == "zero")


def test_parameters_of_an_effect_with_many_likelihood_maxima_may_differ_by_run(
    rig: Rig, runs: list[Run]
) -> None:
    """The runs of a drive with a resonance may be fitted at different likelihood maxima."""
    campaign = Campaign.prepare(rig, runs)
    problem = Problem(campaign, "journal", "journal", ("drive_compliance",))
    solution = problem.solution(problem.starts({})[0], campaign.samples, WHITE)
    found = disagreement(problem, replace(solution, residuals=white_noise(campaign, 1)))
    law = len(Problem(campaign, "journal", "journal", ()).open)
    assert law < len(problem.open)
    assert 0 < found.degrees <= law * (len(runs) - 1)


def test_disagreement_must_exceed_a_ratio_and_the_chi_square_quantile() -> None:
    ratio, chance = DEFAULT.constancy.min_ratio, DEFAULT.constancy.chance
    assert not Disagreement(ratio * 400, 400, {}).beyond_chance()
    assert Disagreement(ratio * 400 + 1.0, 400, {}).beyond_chance()
    quantile = float(stats.chi2.isf(chance, 3))
    assert quantile > ratio * 3
    for part, significant in ((0.99, False), (1.01, True)):
        assert Disagreement(part * quantile, 3, {}).beyond_chance() == significant
    assert not Disagreement(1e9, 0, {}).beyond_chance()
    easy = DEFAULT.with_values({"constancy.chance": 0.5, "constancy.min_ratio": 1.0})
    assert Disagreement(3.5, 3, {}).beyond_chance(easy)


def test_disagreement_in_white_noise_follows_chi_square() -> None:
    gain = degrees = 0.0
    for seed in range(10):
        found = disagreement(*solution_with(one_way(4), white_noise(one_way(4), seed)))
        gain, degrees = gain + found.gain, degrees + found.degrees
        assert not found.beyond_chance()
    # The long-run variance is at least that of white noise.
    assert -6.0 * np.sqrt(2.0 * degrees) < gain - degrees < 4.0 * np.sqrt(2.0 * degrees)


def test_correlated_noise_that_is_not_modelled_is_not_disagreement() -> None:
    keep = float(np.exp(-0.02 / 0.3))
    campaign = slides([np.resize(SPEED, 8 * N)] * 4)
    for seed in range(5):
        slow = [signal.lfilter([1.0], [1.0, -keep], e) for e in white_noise(campaign, seed)]
        assert not disagreement(*solution_with(campaign, slow)).beyond_chance()
        gain = by_regression(slow, np.column_stack([LEVEL] * 8).T.reshape(-1, 1))[0]
        assert gain > DEFAULT.constancy.min_ratio * 3


def solved(other: Friction, noise_rms: float) -> tuple[Problem, Solution]:
    """Four runs with Coulomb friction, the last with a different value, and their common fit."""
    runs = [*four_runs(coulomb, noise_rms=noise_rms)[:3], four_runs(other, noise_rms=noise_rms)[3]]
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", ())
    return problem, minimum(problem, [{}])


@pytest.mark.parametrize(("more", "words"), [(1.0, "higher"), (-1.0, "lower")])
def test_deviation_of_a_positive_parameter_is_reported_in_percent(more: float, words: str) -> None:
    """Estimates to first order in the logarithm: dry friction of 6 N or 4 N, and the common fit."""
    problem, solution = solved(lambda t, v, a: coulomb(t, v, a) + more * np.sign(v), 1e-6)
    common = dict(zip(problem.names, solution.values, strict=True))["F_c"]
    (change,) = numbers_in(rf"^F_c (\S+) % {words}", run_specific_step(problem, solution, "d"))
    expected = 100.0 * abs(np.expm1((5.0 + more) / common - 1.0))
    assert change == pytest.approx(expected, abs=0.051)


@pytest.mark.parametrize(("more", "words"), [(8.0, "higher"), (-8.0, "lower")])
def test_deviation_of_a_signed_parameter_is_reported_in_its_unit(more: float, words: str) -> None:
    """One of four runs has 8 N s/m more viscous friction, or 6 more than in the common fit."""
    problem, solution = solved(lambda t, v, a: coulomb(t, v, a) + more * v, 0.05)
    (found,) = find_disagreement(problem, solution, DEFAULT)
    (change,) = numbers_in(rf"run d fits best with F_v (\S+) N s/m {words}", found.where)
    assert change == pytest.approx(6.0, rel=0.25)


@pytest.mark.parametrize(("step", "size"), [(2.99, "%"), (3.01, "larger"), (-3.01, "smaller")])
def test_run_specific_parameter_change_above_twentyfold_is_reported_without_a_number(
    step: float, size: str
) -> None:
    """The search variable is the logarithm of the dry friction of 5 N."""
    orthogonal = ALTERNATING - np.mean(ALTERNATING)
    residuals = [orthogonal + step * 5.0 * LEVEL, orthogonal]
    words = run_specific_step(*solution_with(one_way(2), residuals), "a")
    assert words.startswith("F_c")
    assert size in words
    assert ("much" in words) == (size != "%")


def test_disagreement_is_reported_with_its_share_and_runs_in_order_of_size() -> None:
    residuals = [ALTERNATING + a for a in (0.6, 1.5, 0.02, -0.6, -1.0)]
    problem, solution = solution_with(one_way(5), residuals)
    (found,) = find_disagreement(problem, solution, DEFAULT)
    statistic = disagreement(problem, solution)
    assert found.axis == "parameters"
    assert found.share == pytest.approx((statistic.gain - statistic.degrees) / (5 * N))
    assert list(statistic.by_run)[:2] == ["b", "e"]
    assert "run b fits best with" in found.where
    assert re.search(r"next: e, [ad]\)", found.where)
    agreeing = [ALTERNATING + a for a in (0.02, 0.0, 0.01, 0.0, 0.03)]
    assert find_disagreement(*solution_with(one_way(5), agreeing), DEFAULT) == []


def test_no_disagreement_is_found_if_common_parameters_deviate_by_five_percent() -> None:
    problem, solution = solved(coulomb, 0.1)
    off = problem.solution(1.05 * solution.values, solution.samples, solution.noise)
    for at in (solution, off):
        found = disagreement(problem, at)
        assert found.degrees == 6
        assert abs(found.gain - found.degrees) < 5.0 * np.sqrt(2.0 * found.degrees)


def fitted(rig: Rig, runs: list[Run], effects: tuple[str, ...] = ()) -> tuple[Problem, Solution]:
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", effects)
    return problem, minimum(problem, [{}])


@pytest.mark.extended
@pytest.mark.parametrize("coloured", [False, True])
@pytest.mark.parametrize("effects", [(), ("sensor_lag",), ("running_in",), ("drive_compliance",)])
def test_no_disagreement_is_found_between_runs_simulated_with_equal_parameters(
    effects: tuple[str, ...], coloured: bool
) -> None:
    seed = 34 if effects == ("drive_compliance",) else 11
    rig, runs, _ = simulated(seed, effects, coloured=coloured)
    problem, solution = fitted(rig, runs, effects)
    assert 0 < disagreement(problem, solution).degrees <= (len(runs) - 1) * len(solution.values)
    assert find_disagreement(problem, solution, DEFAULT) == []


def test_run_with_an_eight_percent_larger_force_is_reported_as_deviating() -> None:
    rig, runs, _ = simulated(11)
    changed = replace(runs[2], friction=1.08 * np.asarray(runs[2].friction))
    (found,) = find_disagreement(*fitted(rig, [*runs[:2], changed, *runs[3:]]), DEFAULT)
    assert f"run {runs[2].name} fits best with" in found.where
