"""Constancy of the parameters between runs: the score test against regressions, and simulations."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import Friction, coulomb, four_runs
from campaigns import campaign as simulated
from jbf import Rig, Run
from jbf.diagnosis.constancy import Disagreement, disagreement, find_disagreement, own_step
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import minimum
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from scipy import signal, stats
from slides import VALUES, slides, solution_with, white_noise

Array = npt.NDArray[np.float64]
N = 400
ALTERNATING = np.where(np.arange(N) % 2, 1.0, -1.0)
"""Noise of variance one that is hardly correlated with any smooth direction."""
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
    """Gain of separate parameters for each run over common ones, and squares explained by run."""
    sigma = [float(np.sqrt(np.mean(r**2))) for r in residuals]
    own = [explained(design, r / s) for r, s in zip(residuals, sigma, strict=True)]
    stacked = np.concatenate([r / s for r, s in zip(residuals, sigma, strict=True)])
    common = explained(np.concatenate([design / s for s in sigma]), stacked)
    return sum(own) - common, own


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_disagreement_of_runs_is_the_gain_of_separate_regressions(unit: float) -> None:
    sizes = ((0.5, 0.3), (-0.5, 0.0), (0.2, -0.4), (0.0, 0.1))
    residuals = [unit * (ALTERNATING + a + b * RAMP) for a, b in sizes]
    found = disagreement(*solution_with(one_way(4), residuals))
    gain, own = by_regression(residuals, np.column_stack([LEVEL, RAMP]))
    assert found.gain == pytest.approx(gain)
    # Two directions in each of four runs, less the two parameters that they share.
    assert found.degrees == 6
    assert found.by_run == pytest.approx(dict(zip("abcd", [0.5 * g for g in own], strict=True)))
    assert list(found.by_run.values()) == sorted(found.by_run.values(), reverse=True)


def test_common_change_of_parameters_is_not_disagreement() -> None:
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
def test_disagreement_of_an_effect_excludes_what_the_law_explains(
    term: str, disagrees: bool
) -> None:
    """The sign of the velocity is the law's direction, a constant that of the sensor's offset."""
    sign = np.where(np.arange(N) < N // 2, 1.0, -1.0)
    campaign = slides([sign * SPEED] * 3)
    problem = Problem(campaign, "coulomb", "journal", ("sensor_offset",))
    values = np.array([VALUES.get(name, 0.0) for name in problem.names])
    direction = LEVEL if term == "effect" else sign
    residuals = [ALTERNATING + a * direction for a in (0.5, -0.5, 0.2)]
    solution = problem.solution(values, campaign.samples, solution_with(campaign, [])[1].noise)
    solution = replace(solution, residuals=residuals)
    found = disagreement(problem, solution, "sensor_offset")
    assert found.degrees == 2
    assert (found.gain > 40.0) == disagrees
    assert disagreement(problem, solution).gain > 40.0


@pytest.mark.parametrize(("deviates", "disagrees"), [("F_c_n", False), ("zero", True)])
def test_parameter_with_a_random_effect_between_runs_is_not_tested(
    deviates: str, disagrees: bool
) -> None:
    """The random effects are so small here that they do not change the whitening."""
    residuals = [ALTERNATING + a for a in (0.5, -0.5, 0.2)]
    directions = tuple(np.full((N, 1), 1e-12) for _ in residuals)
    between = BetweenRuns((deviates,), directions, 1.0)
    samples = replace(one_way(3).samples, between=between)
    found = disagreement(*solution_with(one_way(3), residuals, samples=samples))
    assert (found.gain > 50.0) == disagrees


@pytest.mark.parametrize(
    ("deviates", "disagrees"), [("gamma", False), ("U_tr_m_s", False), ("zero", True)]
)
@pytest.mark.parametrize("direction", ["gamma", "U_tr_m_s"])
def test_random_effect_of_the_viscosity_covers_both_of_its_parameters(
    direction: str, deviates: str, disagrees: bool, rig: Rig, runs: list[Run]
) -> None:
    campaign = Campaign.prepare(rig, runs)
    problem = Problem(campaign, "journal", "journal", ())
    values = {"f_m": 0.26, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
    noise = solution_with(one_way(1), [])[1].noise
    solution = problem.solution(
        np.array([values[name] for name in problem.names]), campaign.samples, noise
    )
    place = [problem.names[i] for i in problem.open].index(direction)
    residuals = [
        e + way * 0.3 * j[:, place] / np.std(j[:, place])
        for e, j, way in zip(
            white_noise(campaign, 1), solution.jacobian, (1.0, -1.0, 1.0), strict=True
        )
    ]
    tiny = tuple(np.full((len(e), 1), 1e-12) for e in residuals)
    samples = replace(campaign.samples, between=BetweenRuns((deviates,), tiny, 1.0))
    changed = replace(solution, residuals=residuals, samples=samples)
    assert disagreement(problem, changed).beyond_chance() == disagrees


def test_effect_with_many_likelihood_peaks_is_not_tested(rig: Rig, runs: list[Run]) -> None:
    """The runs of a resonant drive may be fitted at different peaks of the likelihood."""
    campaign = Campaign.prepare(rig, runs)
    problem = Problem(campaign, "journal", "journal", ("drive_compliance",))
    noise = solution_with(one_way(1), [])[1].noise
    solution = problem.solution(problem.starts({})[0], campaign.samples, noise)
    found = disagreement(problem, replace(solution, residuals=white_noise(campaign, 1)))
    law = len(Problem(campaign, "journal", "journal", ()).open)
    assert law < len(problem.open)
    assert 0 < found.degrees <= law * (len(runs) - 1)


def test_disagreement_is_significant_only_above_a_ratio_and_the_chi_square_quantile() -> None:
    ratio, chance = DEFAULT.constancy_ratio, DEFAULT.constancy_chance
    assert not Disagreement(ratio * 400, 400, {}).beyond_chance()
    assert Disagreement(ratio * 400 + 1.0, 400, {}).beyond_chance()
    quantile = float(stats.chi2.isf(chance, 3))
    assert quantile > ratio * 3
    assert not Disagreement(0.99 * quantile, 3, {}).beyond_chance()
    assert Disagreement(1.01 * quantile, 3, {}).beyond_chance()
    assert not Disagreement(1e9, 0, {}).beyond_chance()
    easy = replace(DEFAULT, constancy_chance=0.5, constancy_ratio=1.0)
    assert Disagreement(3.5, 3, {}).beyond_chance(easy)


def test_disagreement_in_white_noise_follows_chi_square() -> None:
    """The sum over ten campaigns is within four standard deviations of the mean."""
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
        problem, solution = solution_with(campaign, slow)
        assert not disagreement(problem, solution).beyond_chance()
        gain = by_regression(slow, np.column_stack([LEVEL] * 8).T.reshape(-1, 1))[0]
        assert gain > DEFAULT.constancy_ratio * 3


def solved(other: Friction, noise_n: float) -> tuple[Problem, Solution]:
    """Four runs with Coulomb friction, the last with another friction, and their common fit."""
    runs = [*four_runs(coulomb, noise_n=noise_n)[:3], four_runs(other, noise_n=noise_n)[3]]
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", ())
    return problem, minimum(problem, [{}])


@pytest.mark.parametrize(("more", "words"), [(1.0, "higher"), (-1.0, "lower")])
def test_run_that_deviates_is_reported_with_its_relative_change(more: float, words: str) -> None:
    """To first order in the logarithm: dry friction of 6 N or 4 N, and the common fit."""
    problem, solution = solved(lambda t, v, a: coulomb(t, v, a) + more * np.sign(v), 1e-6)
    common = dict(zip(problem.names, solution.values, strict=True))["F_c_n"]
    change = re.match(rf"F_c_n (\S+) % {words}", own_step(problem, solution, "d"))
    assert change is not None
    expected = 100.0 * abs(np.expm1((5.0 + more) / common - 1.0))
    assert float(change[1]) == pytest.approx(expected, abs=0.051)


@pytest.mark.parametrize(("more", "words"), [(8.0, "higher"), (-8.0, "lower")])
def test_parameter_that_may_be_negative_is_reported_with_its_absolute_change(
    more: float, words: str
) -> None:
    """Viscous friction of 8 N s/m more in one of four runs: 6 more than in the common fit."""
    problem, solution = solved(lambda t, v, a: coulomb(t, v, a) + more * v, 0.05)
    (found,) = find_disagreement(problem, solution, DEFAULT)
    change = re.search(rf"run d asks for F_v_n_s_m (\S+) N s/m {words}", found.where)
    assert change is not None
    assert float(change[1]) == pytest.approx(6.0, rel=0.25)


@pytest.mark.parametrize(("step", "size"), [(2.99, "%"), (3.01, "large"), (-3.01, "small")])
def test_change_over_twentyfold_is_reported_as_many_times(step: float, size: str) -> None:
    """The dry friction of 5 N is searched in its logarithm."""
    orthogonal = ALTERNATING - np.mean(ALTERNATING)
    residuals = [orthogonal + step * 5.0 * LEVEL, orthogonal]
    words = own_step(*solution_with(one_way(2), residuals), "a")
    assert words.startswith("F_c_n")
    assert size in words
    assert ("many times" in words) == (size != "%")


def test_disagreement_is_reported_with_its_share_and_runs_in_order_of_size() -> None:
    residuals = [ALTERNATING + a for a in (0.6, 1.5, 0.02, -0.6, -1.0)]
    problem, solution = solution_with(one_way(5), residuals)
    (found,) = find_disagreement(problem, solution, DEFAULT)
    statistic = disagreement(problem, solution)
    assert found.axis == "parameters"
    assert found.share == pytest.approx((statistic.gain - statistic.degrees) / (5 * N))
    assert list(statistic.by_run)[:2] == ["b", "e"]
    assert "run b asks for" in found.where
    assert re.search(r"next: e, [ad]\)", found.where)
    agreeing = [ALTERNATING + a for a in (0.02, 0.0, 0.01, 0.0, 0.03)]
    assert find_disagreement(*solution_with(one_way(5), agreeing), DEFAULT) == []


def test_runs_of_one_machine_agree_even_if_common_parameters_are_five_percent_off() -> None:
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
@pytest.mark.parametrize("effects", [(), ("sensor_lag",), ("wear_in",), ("drive_compliance",)])
def test_simulated_runs_of_one_bearing_agree(effects: tuple[str, ...], coloured: bool) -> None:
    rig, runs, _ = simulated(
        34 if effects == ("drive_compliance",) else 11, effects, coloured=coloured
    )
    problem, solution = fitted(rig, runs, effects)
    found = disagreement(problem, solution)
    assert not found.beyond_chance()
    assert 0 < found.degrees <= (len(runs) - 1) * len(solution.values)
    assert find_disagreement(problem, solution, DEFAULT) == []


def test_simulated_run_with_eight_percent_more_gain_is_named() -> None:
    rig, runs, _ = simulated(11)
    assert runs[2].friction_n is not None
    changed = replace(runs[2], friction_n=1.08 * runs[2].friction_n)
    problem, solution = fitted(rig, [*runs[:2], changed, *runs[3:]])
    assert disagreement(problem, solution).beyond_chance()
    (found,) = find_disagreement(problem, solution, DEFAULT)
    assert f"run {runs[2].name} asks for" in found.where
