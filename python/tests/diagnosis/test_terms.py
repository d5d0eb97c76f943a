"""Terms of the observation model: gains against likelihoods by SciPy, and acceptance."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from jbf import Rig
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.rounds import select
from jbf.diagnosis.terms import TERMS, Leader, best_term_update
from jbf.diagnosis.terms.noise_variance import heavy_tails, variance_by_run
from jbf.diagnosis.terms.proposal import Model, Proposal, is_accepted, price_of_term
from jbf.diagnosis.terms.random_effects import random_effect, without_random_effect
from jbf.errors import Unfinished
from jbf.estimation.approach import approach
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from linear_campaigns import coulomb_candidates, fit_from_truth, linear_runs, reversing_runs
from scipy import stats
from term_models import model_of

NOISE_N = 0.1
Draw = Callable[[int, int, np.random.Generator], Array]
"""Noise, N, from the number of the run, the number of samples and a random generator."""


def model(draw: Draw, *, seed: int = 0) -> Model:
    """Coulomb friction with the given noise, and its fit."""
    runs = reversing_runs(lambda i, t, f, random: f + draw(i, len(t), random), seed=seed)
    return model_of(*fit_from_truth(Campaign.prepare(Rig(), runs)))


def white(i: int, n: int, random: np.random.Generator) -> Array:
    return NOISE_N * random.standard_normal(n)


def residuals(fitted: Model) -> list[Array]:
    """Residuals at the counted samples, one array for each run."""
    solution = fitted.solution
    return [r[c] for r, c in zip(solution.residuals, solution.samples.counted, strict=True)]


def proposed(proposal: Proposal | None) -> Proposal:
    assert proposal is not None
    return proposal


def test_threshold_of_a_term_shares_the_error_probability_among_ten_kinds() -> None:
    for parameters in (1, 5):
        expected = stats.chi2.isf(DEFAULT.terms.chance / 10.0, parameters)
        assert price_of_term(DEFAULT, parameters) == pytest.approx(expected)


def test_gain_of_variances_by_run_is_that_of_normal_likelihoods() -> None:
    fitted = model(lambda i, n, random: (1.0 + i) * white(i, n, random))
    fitted = replace(fitted, solution=replace(fitted.solution, noise=WHITE))
    own = residuals(fitted)
    every = np.concatenate(own)
    by_run = sum(float(np.sum(stats.norm.logpdf(r, scale=np.std(r)))) for r in own)
    pooled = float(np.sum(stats.norm.logpdf(every, scale=np.std(every))))
    # The variances are robust estimates from differences.
    assert proposed(variance_by_run(fitted)).gain == pytest.approx(
        2.0 * (by_run - pooled), rel=0.05
    )


@pytest.mark.parametrize("unit", [pytest.param(1.0, marks=pytest.mark.extended), 1e3])
def test_gain_of_variances_is_invariant_to_units_with_an_effect_that_moves_jumps(
    unit: float,
) -> None:
    """The effect excludes samples next to reversals."""
    gains = []
    for factor in (1.0, unit):
        runs = reversing_runs(
            lambda i, t, f, random, k=factor: k * (f + (1.0 + i) * white(i, len(t), random))
        )
        law = {"F_s": 6.0 * factor}
        problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", ("time_delay",), law)
        near = approach(problem, [[{}]], 20)
        gains.append(proposed(variance_by_run(model_of(problem, settle(problem, near)))).gain)
    assert gains[1] == pytest.approx(gains[0], rel=1e-3)


def test_random_effect_is_removed_if_the_runs_do_not_have_it() -> None:
    fitted = model(lambda i, n, random: white(i, n, random) + 0.3 * (-1.0) ** i)
    found = proposed(random_effect(fitted))
    between = found.campaign.samples.between
    assert between is not None
    problem, solution = fit_from_truth(found.campaign)
    assert without_random_effect(model_of(problem, solution)) is None
    # The campaign has a gain by run in addition, which the runs do not have.
    force = problem.predict(solution.values)
    directions = tuple(
        np.column_stack([d, 0.3 * f]) for d, f in zip(between.directions, force, strict=True)
    )
    both = replace(between, names=(*between.names, "gain"), directions=directions)
    samples = replace(found.campaign.samples, between=both)
    campaign = replace(found.campaign, samples=samples)
    simpler = without_random_effect(model_of(*fit_from_truth(campaign)))
    assert simpler is not None
    assert simpler.samples.between is not None
    assert simpler.samples.between.names == ("zero",)
    assert [f.kind for f in simpler.more_findings] == ["level_by_run"]


def test_gain_of_heavy_tails_is_that_of_the_student_distribution() -> None:
    fitted = model(lambda i, n, random: NOISE_N * random.standard_t(4.0, n))
    every = np.concatenate(residuals(fitted))
    freedom, _, scale = stats.t.fit(every, floc=0.0)
    student = float(np.sum(stats.t.logpdf(every, freedom, scale=scale)))
    normal = float(np.sum(stats.norm.logpdf(every, scale=np.sqrt(np.mean(every**2)))))
    gain = proposed(heavy_tails(fitted)).gain
    assert gain == pytest.approx(2.0 * (student - normal), rel=0.02)


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.extended) for seed in range(1, 5))]
)
def test_no_term_is_accepted_in_white_noise(seed: int) -> None:
    fitted = model(white, seed=seed)
    assert [term.__name__ for term in TERMS if is_accepted(term(fitted), fitted)] == []


def test_term_is_not_accepted_if_held_out_runs_are_predicted_worse() -> None:
    """A fit with an error equal to the noise in every run has 1.4 times the held-out error."""
    fitted = model(white)
    found = replace(
        proposed(variance_by_run(model(lambda i, n, random: (1.0 + i) * white(i, n, random)))),
        problem=fitted.problem,
        solution=fitted.solution,
        gain=1e3,
    )
    assert is_accepted(found, fitted)
    off = fitted.solution.values + np.array([NOISE_N, 0.0, 0.0])
    held = {name: float(value) for name, value in zip(fitted.problem.names, off, strict=True)}
    problem, _ = fit_from_truth(fitted.campaign)
    problem = type(problem)(problem.campaign, problem.law, problem.clock, (), held)
    worse = problem.solution(off, fitted.solution.samples, WHITE)
    assert not is_accepted(replace(found, problem=problem, solution=worse), fitted)


def test_random_effect_is_added_only_if_it_has_more_evidence_than_the_leading_effect() -> None:
    candidates = coulomb_candidates(
        reversing_runs(lambda i, t, f, random: f + white(i, len(t), random) + 0.3 * (-1.0) ** i)
    )
    fit = candidates.fitted(()).problem, candidates.converge(())
    evidence = proposed(random_effect(model_of(*fit))).evidence
    assert best_term_update(candidates, (), Leader("viscous_asymmetry", 1.01 * evidence)) is None
    update = best_term_update(candidates, (), Leader("viscous_asymmetry", 0.99 * evidence))
    assert update is not None
    assert [f.kind for f in update[0].more_findings] == ["level_by_run"]


@pytest.mark.parametrize(("shift", "kinds"), [(0, []), (1, ["gain_by_run"])])
def test_random_effect_is_not_added_if_the_load_predicts_the_gain_of_other_runs(
    shift: int, kinds: list[str]
) -> None:
    """The friction of a run is proportional to its load, or to that of the run before."""
    gains = np.array([0.7, 0.8, 1.3, 1.2, 0.6, 0.75, 1.35, 1.25])
    loads_n = 100.0 * np.roll(gains, shift)
    records = reversing_runs(
        lambda i, t, f, random: gains[i] * f + white(i, len(t), random), runs=8
    )
    records = [replace(run, load_n=np.full(len(run), loads_n[i])) for i, run in enumerate(records)]
    leader = Leader("dry_load_dependence", 1.0)
    update = best_term_update(coulomb_candidates(records), (), leader)
    found = [] if update is None else update.campaign.more_findings
    assert [finding.kind for finding in found] == kinds


def test_variance_by_run_does_not_compete_with_an_effect() -> None:
    candidates = coulomb_candidates(
        reversing_runs(lambda i, t, f, random: f + (1.0 + i) * white(i, len(t), random))
    )
    assert best_term_update(candidates, (), Leader("viscous_asymmetry", 0.0)) is None
    update = best_term_update(candidates, ())
    assert update is not None
    assert [f.kind for f in update[0].more_findings] == ["noise_by_run"]


def test_selection_that_exceeds_its_budget_ends_with_the_last_reviewed_model() -> None:
    whole = coulomb_candidates(linear_runs("offset and drag"))
    whole.campaign.work.renew()
    present = select(whole).present
    assert len(present) == 2
    limited = coulomb_candidates(linear_runs("offset and drag"))
    limited.campaign.work.renew(0.5 * whole.campaign.work.taken)
    ended = select(limited)
    assert set(ended.present) < set(present)
    assert [r.axis for r in ended.remainders] == ["search"]
    assert ended.not_tried
    limited = coulomb_candidates(linear_runs("offset and drag"))
    limited.campaign.work.renew(1e-3 * whole.campaign.work.taken)
    with pytest.raises(Unfinished):
        select(limited)
