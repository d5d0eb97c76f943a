"""Friction levels of strokes, against an analysis of variance."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from jbf.diagnosis import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure.constancy import find_stroke_levels
from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out_comparison import stroke_of
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from scipy import signal, stats
from slides import VALUES, Array, friction_of, numbers_in, slides, solution_with, white_noise

FRICTION_N = 7.0
"""Coulomb friction of the slides at 0.1 m/s."""


def square_wave(lengths: list[int]) -> Array:
    """Forward and backward strokes at 0.1 m/s with the given numbers of samples."""
    return np.concatenate([np.full(n, 0.1 * (-1.0) ** k) for k, n in enumerate(lengths)])


@cache
def strokes(*lengths: int) -> Campaign:
    return slides([square_wave(list(lengths))])


@cache
def sines() -> Campaign:
    """Strokes with different friction, which also varies within each stroke."""
    t = 0.02 * np.arange(1500)
    envelope = 1.0 + 0.6 * np.sin(0.23 * t)
    return slides([0.1 * envelope * np.sin(w * t) for w in (1.1, 1.7)])


def levels_in(campaign: Campaign, residuals: list[Array], **policy: float) -> list[Remainder]:
    problem, solution = solution_with(campaign, residuals)
    return find_stroke_levels(problem, solution, DEFAULT.with_values(policy))


def level_residuals(shares: list[float], wobble: float, each: int = 40) -> list[Array]:
    """Residuals of a square wave whose strokes have these shares more friction.

    The second half of each stroke has `wobble` more than the first, or less, in turn.
    """
    friction = FRICTION_N * np.sign(square_wave([each] * len(shares)))
    half = np.where(np.arange(len(friction)) % each < each // 2, -0.5, 0.5)
    turn = np.repeat([(-1.0) ** k for k in range(len(shares))], each)
    return [friction * (np.repeat(shares, each) + wobble * half * turn)]


def anova(campaign: Campaign, residuals: list[Array]) -> tuple[float, float, int]:
    """F ratio, share of the mean square and degrees of freedom between strokes."""
    between, within, degrees = 0.0, 0.0, 0
    friction, counted = friction_of(campaign), campaign.samples.counted
    for p, f, r, c in zip(campaign.prepared, friction, residuals, counted, strict=True):
        stroke = np.cumsum(np.diff(np.sign(p.motion.velocity[c]), prepend=0.0) != 0.0)
        rows = [np.flatnonzero(c)[stroke == k] for k in np.unique(stroke)]
        halves = [np.array_split(at, 2) for at in rows if len(at) >= 16]
        weight = np.array([[f[h] @ f[h] for h in pair] for pair in halves])
        level = np.array([[f[h] @ r[h] / (f[h] @ f[h]) for h in pair] for pair in halves])
        stroke_mean = np.average(level, axis=1, weights=weight)
        between += float(np.cov(stroke_mean, aweights=weight.sum(1), ddof=0) * weight.sum())
        precision = 1.0 / (1.0 / weight[:, 0] + 1.0 / weight[:, 1])
        within += float(
            np.cov(level[:, 1] - level[:, 0], aweights=precision, ddof=0) * precision.sum()
        )
        degrees += len(halves) - 1
    square = sum(float(r[c] @ r[c]) for r, c in zip(residuals, counted, strict=True))
    return between / within, (between - within) / square, degrees


def with_levels(campaign: Campaign, share: float, seed: int, memory: float = 0.0) -> list[Array]:
    """White noise of 0.3 N and a random relative friction level for each stroke."""
    random = np.random.default_rng(seed)
    residuals, noise = [], white_noise(campaign, seed, 0.3)
    for p, f, e in zip(campaign.prepared, friction_of(campaign), noise, strict=True):
        stroke = stroke_of(p)
        level = share * random.standard_normal(int(stroke.max()) + 1)
        coloured = signal.lfilter([1.0], [1.0, -memory], e)
        residuals.append(np.where(stroke >= 0, f * level[stroke], 0.0) + coloured)
    return residuals


def test_strokes_end_where_the_motion_reverses() -> None:
    assert stroke_of(strokes(30, 20, 40).prepared[0]).tolist() == [0] * 30 + [1] * 20 + [2] * 40
    for p in sines().prepared:
        stroke = stroke_of(p)
        for k in range(int(stroke.max()) + 1):
            signs = np.sign(p.motion.velocity[stroke == k])
            assert np.all(signs == (-1.0) ** k * np.sign(p.motion.velocity[stroke == 0][0]))


def test_sample_at_rest_belongs_to_no_stroke_and_does_not_end_one() -> None:
    v = np.concatenate([np.full(60, x) for x in (0.0, 0.1, 0.0, 0.1, -0.1, 0.0)])
    p = slides([v]).prepared[0]
    stroke = stroke_of(p)
    assert np.all(stroke[p.motion.resting] == -1)
    assert p.motion.resting[[30, 150, 330]].all()
    assert stroke[[90, 210, 270]].tolist() == [0, 0, 1]


def test_stroke_levels_agree_with_a_weighted_analysis_of_variance() -> None:
    """With a varying friction the weight of a level is the sum of squares of the friction."""
    campaign = sines()
    residuals = with_levels(campaign, 0.08, 1)
    ratio, share, degrees = anova(campaign, residuals)
    (found,) = levels_in(campaign, residuals)
    assert found.share == pytest.approx(share)
    assert f"(F = {round(ratio)})" in found.where
    chance = float(stats.f.sf(ratio, degrees, degrees))
    for part in (0.99, 1.01):
        significant = levels_in(campaign, residuals, **{"constancy.chance": part * chance})
        assert bool(significant) == (part > 1.0)
        assert bool(levels_in(campaign, residuals, **{"patterns.min_share": part * share})) == (
            part < 1.0
        )


def test_standard_deviation_of_stroke_levels_is_recovered() -> None:
    campaign = sines()
    sizes: list[float] = []
    for seed in range(10):
        (found,) = levels_in(campaign, with_levels(campaign, 0.08, seed))
        sizes.extend(numbers_in(r"by ([\d.]+) % RMS", found.where))
    assert np.mean(sizes) == pytest.approx(8.0, rel=0.15)


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_no_stroke_levels_are_reported_in_white_or_coloured_noise(memory: float) -> None:
    campaign = sines()
    for seed in range(10):
        assert levels_in(campaign, with_levels(campaign, 0.0, seed, memory)) == []


def test_errors_that_depend_on_run_or_speed_are_not_stroke_levels() -> None:
    t = 0.02 * np.arange(1500)
    campaign = slides([0.1 * np.sin(w * t) for w in (1.1, 1.7)])
    friction = friction_of(campaign)
    by_run = [0.0 * friction[0], 0.05 * friction[1]]
    velocities = [p.motion.velocity for p in campaign.prepared]
    by_speed = [20.0 * np.sin(30.0 * v) * np.abs(v) for v in velocities]
    for seed in range(5):
        noise = with_levels(campaign, 0.0, seed)
        for errors in (by_run, by_speed):
            residuals = [e + error for e, error in zip(noise, errors, strict=True)]
            assert levels_in(campaign, residuals) == []


def test_inertia_that_differs_between_strokes_is_not_a_friction_level() -> None:
    """An inertial force larger than the friction, with 8 % more or less in each stroke."""
    campaign, mass_kg = sines(), 400.0
    problem = Problem(campaign, "coulomb", "journal", ("inertia",))
    values = {**VALUES, "inertia.m_e": mass_kg}
    solution = problem.solution(
        np.array([values[name] for name in problem.names]), campaign.samples, WHITE
    )
    random, residuals = np.random.default_rng(5), []
    for p, noise in zip(campaign.prepared, white_noise(campaign, 5, 0.1), strict=True):
        stroke = stroke_of(p)
        change = 0.08 * random.standard_normal(int(stroke.max()) + 1)
        inertia = mass_kg * p.motion.acceleration * np.where(stroke >= 0, change[stroke], 0.0)
        residuals.append(noise + inertia)
    assert find_stroke_levels(problem, replace(solution, residuals=residuals), DEFAULT) == []


@pytest.mark.parametrize(
    ("shares", "each", "found"),
    [
        ([0.1, -0.1], 40, 0),
        ([0.1, -0.1, 0.1], 15, 0),
        ([0.1, -0.1, 0.1], 16, 1),
        ([0.0] * 6, 40, 0),
    ],
)
def test_stroke_levels_require_three_strokes_of_sixteen_samples(
    shares: list[float], each: int, found: int
) -> None:
    campaign = strokes(*[each] * len(shares))
    residuals = level_residuals(shares, 1e-6 if any(shares) else 0.0, each)
    assert len(levels_in(campaign, residuals, **{"constancy.chance": 0.5})) == found


def test_stroke_levels_are_detected_in_a_campaign_with_short_strokes_and_short_runs() -> None:
    campaign = slides([square_wave([10, 40, 40, 40]), square_wave([40, 40])])
    level = np.repeat([0.0, 0.1, -0.1, 0.1], [10, 40, 40, 40]) + 1e-6 * (np.arange(130) % 7)
    first, second = friction_of(campaign)
    residuals = [first * level, second * np.repeat([0.1, -0.1], 40)]
    assert len(levels_in(campaign, residuals, **{"constancy.chance": 0.5})) == 1
