"""Random effects between runs: offset, gain and drift that differ from run to run."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import Array, assert_recovered, coulomb
from jbf import Drive, Rig, Run, diagnose
from jbf.diagnosis.terms.proposal import Proposal, is_accepted
from jbf.diagnosis.terms.random_effects import random_effect
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE
from jbf.estimation.posterior_motions import aligned
from jbf.estimation.problem import Problem
from jbf.estimation.random_effects import RandomEffects
from jbf.estimation.solution import Solution
from jbf.records.findings.finding import Finding
from known_motions import quantised
from linear_campaigns import fit_from_truth, reversing_runs
from term_models import model_of

NOISE_N = 0.1
Extra = Callable[[int, Array, Array], Array]
"""Additional force from the number of the run, time (s) and friction (N)."""


def fitted(extra: Extra, *, runs: int = 6) -> tuple[Problem, Solution]:
    """Coulomb's law fitted to reversing runs; their motion does not determine F_s."""
    records = reversing_runs(
        lambda i, t, f, random: f + NOISE_N * random.standard_normal(len(t)) + extra(i, t, f),
        runs=runs,
    )
    return fit_from_truth(Campaign.prepare(Rig(), records))


def clearest(problem: Problem, solution: Solution) -> Any:
    """Accepted random effect, or None."""
    model = model_of(problem, solution)
    proposal = random_effect(model)
    return proposal if is_accepted(proposal, model) else None


def finding(proposal: Proposal) -> Finding:
    """Finding of the random effect."""
    return proposal.campaign.more_findings[-1]


def deviates(sd: float) -> Array:
    """Six values with mean zero and the given standard deviation."""
    raw = np.array([0.4, -1.3, 0.9, -0.2, 1.5, -1.1])
    return np.asarray(sd * (raw - raw.mean()) / raw.std(ddof=1))


def constant(values: Sequence[float] | Array) -> Extra:
    return lambda i, t, f: np.full(len(t), values[i])


SHAPES: dict[str, Callable[[Array, Array], Array]] = {
    "level_by_run": lambda t, f: np.ones(len(t)),
    "gain_by_run": lambda t, f: f,
    "drift_by_run": lambda t, f: t - np.mean(t),
}


@pytest.mark.parametrize(
    ("kind", "unit", "size", "tolerance"),
    [
        ("level_by_run", "N", 0.15, 0.1),
        ("gain_by_run", "1", 0.05, 0.15),
        ("drift_by_run", "N/s", 0.03, 0.15),
    ],
)
def test_standard_deviation_between_runs_is_estimated_with_its_unit(
    kind: str, unit: str, size: float, tolerance: float
) -> None:
    values = deviates(size)
    problem, solution = fitted(lambda i, t, f: values[i] * SHAPES[kind](t, f))
    found = clearest(problem, solution)
    assert (finding(found).kind, finding(found).unit) == (kind, unit)
    assert finding(found).size == pytest.approx(size, rel=tolerance)
    if kind != "drift_by_run":
        friction = problem.predict(solution.values)
        for column, f in zip(found.campaign.samples.between.directions, friction, strict=True):
            expected = finding(found).size * SHAPES[kind](f, f)
            np.testing.assert_allclose(column[:, 0], expected, rtol=1e-9)


def test_offsets_of_runs_are_recovered_as_conditional_means_of_a_random_effect() -> None:
    offsets_n = deviates(0.15)
    problem, solution = fitted(constant(offsets_n))
    found = clearest(problem, solution)
    assert found.campaign.samples.between.names == ("zero",)
    without = found.campaign.samples.without_deviations(solution.residuals, WHITE)
    estimates = [float(np.mean(r - w)) for r, w in zip(solution.residuals, without, strict=True)]
    np.testing.assert_allclose(estimates, offsets_n, atol=0.03)


def test_random_offset_and_gain_are_estimated_in_successive_searches() -> None:
    offsets_n, gains = deviates(0.3), deviates(0.03)[::-1]
    problem, solution = fitted(lambda i, t, f: gains[i] * f + offsets_n[i])
    once = clearest(problem, solution).campaign
    both = clearest(*fit_from_truth(once)).campaign
    sizes = {f.kind: f.size for f in both.more_findings}
    assert sizes["level_by_run"] == pytest.approx(0.3, rel=0.15)
    assert sizes["gain_by_run"] == pytest.approx(0.03, rel=0.3)
    between = both.samples.between
    assert between is not None
    assert set(between.names) == {"zero", "gain"}
    assert all(direction.shape[1] == 2 for direction in between.directions)
    assert clearest(*fit_from_truth(both)) is None


def test_gain_of_a_random_effect_is_reduced_by_the_log_determinant() -> None:
    problem, solution = fitted(constant((0.5, -0.3, 0.1, -0.4)), runs=4)
    samples = problem.campaign.samples
    found = clearest(problem, solution)
    centred = [e - np.mean(e[c]) for e, c in zip(solution.residuals, samples.counted, strict=True)]
    gain = samples.cost(solution.residuals, solution.noise) - samples.cost(centred, WHITE)
    volume = found.campaign.samples.log_determinant_between(WHITE)
    assert volume > 0.0
    assert found.gain == pytest.approx(gain - volume, rel=0.02)


@pytest.mark.parametrize("offsets_n", [(0.5, -0.3, 0.1, -0.4), (-2.8, -1.3, -1.9, -2.4)])
def test_noise_within_runs_excludes_differences_between_runs(offsets_n: Sequence[float]) -> None:
    found = clearest(*fitted(constant(offsets_n), runs=4))
    assert found.campaign.samples.between.sigma_n == pytest.approx(NOISE_N, rel=0.35)


@pytest.mark.parametrize("offsets_n", [(0.2, 0.2, 0.2, 0.2), (0.0, 0.5)])
def test_random_effect_requires_three_runs_that_differ(offsets_n: tuple[float, ...]) -> None:
    assert clearest(*fitted(constant(offsets_n), runs=len(offsets_n))) is None


def _four_runs(mass_kg: float, offsets_n: tuple[float, ...]) -> list[Run]:
    """Faster reversing runs with an inertia and a separate offset for each run."""
    random, runs = np.random.default_rng(11), []
    t = np.arange(0.0, 20.0, 0.02)
    for i, offset_n in enumerate(offsets_n):
        rate = 2.0 + 0.3 * i
        v = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + i)
        a = 0.12 * rate * np.cos(rate * t) + 0.0309 * rate * np.cos(0.618 * rate * t + i)
        force = coulomb(t, v, a) + mass_kg * a + offset_n + NOISE_N * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, force, name=f"run {i}"))
    return runs


def test_offset_and_drift_are_proposed_together_if_neither_has_evidence_alone() -> None:
    """A fast drift from the start of a run also changes its mean."""
    rates_n_s = deviates(3.0)
    problem, solution = fitted(lambda i, t, f: rates_n_s[i] * t)
    found = clearest(problem, solution)
    sizes = {f.kind: f.size for f in found.campaign.more_findings}
    assert set(sizes) == {"level_by_run", "drift_by_run"}
    assert sizes["drift_by_run"] == pytest.approx(3.0, rel=0.05)


@pytest.mark.parametrize("margin_s", [0.0, 0.3])
def test_random_effects_belong_to_the_readings_that_a_shift_keeps(margin_s: float) -> None:
    problem, _ = fitted(constant(deviates(0.1)))
    campaign = problem.campaign
    first, *others = campaign.prepared
    missing = np.where(np.arange(len(first.run)) == 100, np.nan, first.readings_n)
    first = replace(first, run=replace(first.run, friction=missing))
    campaign = replace(campaign, prepared=(first, *others))
    readings = tuple(p.readings_n[:, None] for p in campaign.prepared)
    between = RandomEffects(("zero",), readings, NOISE_N)
    campaign = replace(campaign, samples=replace(campaign.samples, between=between))
    delays_s = np.array([0.1, -0.1, 0.0, 0.25, -0.25, 0.02])
    after = aligned(campaign, delays_s, margin_s)
    for p, before, direction in zip(
        after.prepared, campaign.prepared, after.samples.between.directions, strict=True
    ):
        np.testing.assert_array_equal(direction[:, 0], p.readings_n)
        assert margin_s == 0.0 or len(direction) < len(before.readings_n)


def test_effect_and_offsets_that_differ_by_run_are_identified_together() -> None:
    offsets_n = (0.5, -0.3, 0.1, -0.4)
    found = diagnose(Rig(), _four_runs(2.0, offsets_n), law="coulomb")
    assert found.effects == ("inertia",)
    sizes = {f.kind: f.size for f in found.findings}
    assert sizes["level_by_run"] == pytest.approx(np.std(offsets_n, ddof=1), rel=0.2)
    assert_recovered(found.fit.parameters["inertia.m_e"], 2.0)


@pytest.mark.parametrize(
    ("kind", "deviations"),
    [
        ("level_by_run", [0.0, 0.3, -0.25, 0.1, -0.1, 0.4]),
        ("gain_by_run", [0.0, 0.06, -0.07, 0.02, -0.04, 0.08]),
    ],
)
def test_deviation_of_a_run_is_found_next_to_errors_of_the_motion(
    kind: str, deviations: list[float]
) -> None:
    """A position in counts: the errors of the acceleration are estimated as well."""
    random, runs = np.random.default_rng(12), []
    t = np.arange(0.0, 12.0, 0.005)
    for i, deviation in enumerate(deviations):
        rate = 2.0 + 0.4 * i
        x = 0.5 * np.sin(rate * t) + 0.2 * np.sin(1.618 * rate * t + i)
        v = 0.5 * rate * np.cos(rate * t) + 0.3236 * rate * np.cos(1.618 * rate * t + i)
        a = -0.5 * rate**2 * np.sin(rate * t)
        a -= 0.5236 * rate**2 * np.sin(1.618 * rate * t + i)
        force = 3.0 * np.sign(v) + 2.0 * v + 0.6 * a
        force += deviation * SHAPES[kind](t, force)
        force += 0.06 * random.standard_normal(len(t))
        counted = quantised(x, 5e-4)
        runs.append(Run.from_arrays(t, None, force, position_m=counted, name=f"run {i}"))
    found = diagnose(Rig(drive=Drive("linear", "force")), runs, law="coulomb")
    assert (found.verdict, found.effects) == ("adequate", ())
    assert found.after.samples.motion is not None
    assert "due to differences between the runs" in " ".join(found.summary().split())
    # A deviation of the runs is not taken for a delay of the force.
    assert not [f for f in found.findings if f.kind == "late_channel"]
    (size,) = (f.size for f in found.findings if f.kind == kind)
    assert size == pytest.approx(np.std(deviations, ddof=1), rel=0.2)
    assert_recovered(found.fit.parameters["F_v"], 2.0, share=0.001)
    assert_recovered(found.fit.parameters["inertia.m_e"], 0.6, share=0.001)
