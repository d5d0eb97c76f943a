"""Residual structure: reported kinds, their order and their sizes."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from campaigns import campaign as simulated
from jbf import Rig, diagnose
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure import find_patterns, find_residual_structure
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.random_effects import RandomEffects
from known_motions import quantised
from slides import Array, friction_of, numbers_in, slide, slides, solution_with, white_noise

N = 1500
TIME_S = 0.02 * np.arange(N)


RECORDED_M_S = [0.1 * np.sin(2.0 * np.pi * TIME_S / period + 0.1) for period in (5.0, 3.0)]


@cache
def sines() -> Campaign:
    """Two slides that reverse, with periods of 5 s and 3 s."""
    return slides(RECORDED_M_S)


VELOCITIES = [p.motion.velocity for p in sines().prepared]
FRICTION = friction_of(sines())
TONE = 0.6 * np.sin(2.0 * np.pi * 7.3 * TIME_S)


def stroke_levels() -> list[Array]:
    """Relative friction levels of the strokes, 0.15 RMS."""
    random = np.random.default_rng(1)
    strokes = [np.cumsum(np.diff(np.sign(v), prepend=0.0) != 0.0) for v in VELOCITIES]
    levels = [0.15 * random.standard_normal(int(k.max()) + 1)[k] for k in strokes]
    return [f * level for f, level in zip(FRICTION, levels, strict=True)]


def axes_of(residuals: list[Array]) -> dict[str, float]:
    """Shares of the residual structure by axis."""
    return {r.axis: r.share for r in find_residual_structure(*solution_with(sines(), residuals))}


@pytest.mark.parametrize("noise", [WHITE, Noise(0.2, 0.5)])
@pytest.mark.parametrize("seed", range(5))
def test_no_residual_structure_is_reported_for_noise_of_the_fitted_noise_model(
    seed: int, noise: Noise
) -> None:
    residuals = [noise.coloured(e, 0.02) for e in white_noise(sines(), seed)]
    assert find_residual_structure(*solution_with(sines(), residuals, noise=noise)) == ()


@pytest.mark.parametrize(
    ("axis", "structure"),
    [
        ("direction", [0.5 * np.sign(v) for v in VELOCITIES]),
        ("velocity", [0.6 * np.sin(60.0 * v) for v in VELOCITIES]),
        ("force", [0.6 * np.sign(np.sin(6.0 * np.abs(f))) for f in FRICTION]),
        ("run", [np.full(N, 0.4), np.full(N, -0.4)]),
        ("frequency", [TONE] * 2),
        ("time", [np.where(np.abs(TIME_S - 11.0) < 0.1, 9.0, 0.0), np.zeros(N)]),
        ("period", [0.5 * np.sign(np.sin(31.0 * v / 0.1)) for v in VELOCITIES]),
        ("parameters", [-0.8 * np.sign(VELOCITIES[0]), 0.8 * np.sign(VELOCITIES[1])]),
        ("stroke", stroke_levels()),
    ],
)
def test_each_kind_of_structure_is_detected_in_white_noise(
    axis: str, structure: list[Array]
) -> None:
    first, second = white_noise(sines(), 3)
    assert axis in axes_of([first + structure[0], second + structure[1]])


def test_kinds_of_residual_structure_are_ordered_by_their_share() -> None:
    noise = white_noise(sines(), 3)
    residuals = [e + np.sign(v) + TONE for e, v in zip(noise, VELOCITIES, strict=True)]
    shares = list(axes_of(residuals).values())
    assert len(shares) > 2
    assert shares == sorted(shares, reverse=True)


@pytest.mark.parametrize("size_n", [0.3, -0.3])
def test_residual_by_direction_is_reported_with_its_share_and_sign(size_n: float) -> None:
    noise = white_noise(sines(), 2)
    residuals = [e + size_n * np.sign(v) for e, v in zip(noise, VELOCITIES, strict=True)]
    problem, solution = solution_with(sines(), residuals)
    found = {f.axis: f for f in find_patterns(problem, solution, residuals, residuals, DEFAULT)}
    direction = found["direction"]
    assert direction.share == pytest.approx(0.3**2 / (1.0 + 0.3**2), rel=0.25)
    # The bins are backward and forward: the mean has the direction of motion where it is positive.
    assert direction.means_n == pytest.approx([-size_n, size_n], abs=0.1)
    for part, there in ((0.99, True), (1.01, False)):
        policy = DEFAULT.with_values({"patterns.min_share": part * direction.share})
        patterns = find_patterns(problem, solution, residuals, residuals, policy)
        assert ("direction" in {f.axis for f in patterns}) == there


def test_size_of_a_pattern_is_that_of_the_residual_and_not_of_the_innovations() -> None:
    """The innovations of correlated noise contain a tenth of a constant error of 2 N."""
    noise = Noise(0.2, 0.9)
    residuals = [
        noise.coloured(0.3 * e, 0.02) + 2.0 * np.sign(v)
        for e, v in zip(white_noise(sines(), 6), VELOCITIES, strict=True)
    ]
    problem, solution = solution_with(sines(), residuals, noise=noise)
    assert solution.samples.rms(solution.samples.innovations(solution.residuals, noise)) < 0.6
    where = {r.axis: r.where for r in find_residual_structure(problem, solution)}["direction"]
    (size,) = numbers_in(r"record above the model by ([\d.]+) N in the direction of motion", where)
    assert size == pytest.approx(2.0, abs=0.15)


def test_burst_is_detected_even_if_robust_weights_reduce_it() -> None:
    residuals = white_noise(sines(), 4)
    inside = np.abs(TIME_S - 11.0) < 0.1
    residuals[0] = residuals[0] + 9.0 * inside
    robust = [np.where(inside, 0.05, 1.0), np.ones(N)]
    samples = sines().samples.with_factors(robust, of_level=False)
    found = find_residual_structure(*solution_with(sines(), residuals, samples=samples))
    assert "time" in {r.axis for r in found}


def test_random_effect_in_the_model_is_not_residual_structure() -> None:
    """The random effect is also excluded from other shares: a tone has 0.18 of 1.18 N^2."""
    first, second = white_noise(sines(), 5)
    residuals = [first + TONE + 5.0, second + TONE - 5.0]
    assert "run" in axes_of(residuals)
    between = RandomEffects(("zero",), (np.full((N, 1), 10.0),) * 2, 1.0)
    samples = replace(sines().samples, between=between)
    (found,) = find_residual_structure(*solution_with(sines(), residuals, samples=samples))
    assert found.axis == "frequency"
    assert found.share == pytest.approx(0.18 / 1.18, rel=0.2)


@pytest.mark.parametrize(("part", "found"), [(0.9, False), (1.15, True)])
def test_structure_within_the_quantisation_is_not_reported(part: float, found: bool) -> None:
    exact = [slide(v, name, noise_rms=0.05) for v, name in zip(RECORDED_M_S, "ab", strict=True)]
    runs = [replace(run, friction=quantised(run.friction, 0.8)) for run in exact]
    campaign = Campaign.prepare(Rig(), runs)
    step_rms = campaign.steps_rms(0.05)
    assert 0.05 < step_rms < 0.8
    tone = part * step_rms * np.sqrt(2.0) * np.sin(2.0 * np.pi * 7.3 * TIME_S)
    residuals = [e + tone for e in white_noise(campaign, 1, 0.05)]
    problem, solution = solution_with(campaign, residuals)
    reported = {r.axis for r in find_residual_structure(problem, solution)}
    assert campaign.steps_rms(solution.rms) == pytest.approx(step_rms, rel=0.1)
    assert ("frequency" in reported) == found


@pytest.mark.extended
def test_verdict_is_unexplained_if_the_friction_level_steps_within_every_run() -> None:
    rig, runs, _ = simulated(21, foreign=("level_step",), strength=1.5)
    result = diagnose(rig, runs)
    assert (result.verdict, result.effects) == ("unexplained", ())
