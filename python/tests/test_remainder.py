"""Tests of what remains: residuals of known make, put in place of a solution's own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from campaigns import campaign
from jbf import diagnose
from jbf.diagnosis.bursts import find_bursts
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.remainder import find_remainder
from jbf.diagnosis.replicates import find_replicates
from jbf.diagnosis.tones import find_tones
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import approach, settle
from jbf.estimation.noise import Noise
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from scipy import signal

Array = npt.NDArray[np.float64]
SIGMA_N = 0.3
LOOSE = replace(DEFAULT, tone_share=0.0)


@cache
def _solved() -> tuple[Problem, Solution]:
    rig, runs, _ = campaign(7)
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", ())
    return problem, settle(problem, approach(problem, [{}], 8))


def _with(
    make: Callable[[np.random.Generator, int], Array], seed: int, noise: Noise | None = None
) -> tuple[Problem, Solution]:
    problem, solution = _solved()
    random = np.random.default_rng(seed)
    residuals = [make(random, i) for i in range(len(solution.residuals))]
    return problem, replace(solution, residuals=residuals, noise=noise or Noise())


def _white(random: np.random.Generator, run: int) -> Array:
    return random.normal(0.0, SIGMA_N, len(_solved()[1].residuals[run]))


def _replicates(problem: Problem, solution: Solution) -> list[Remainder]:
    return find_replicates(problem.campaign.prepared, solution, DEFAULT)


def _phase(run: int) -> Array:
    prepared = _solved()[0].campaign.prepared[run]
    return 6.0 * prepared.motion.velocity_m_s / np.ptp(prepared.motion.velocity_m_s)


@pytest.mark.parametrize("seed", range(5))
def test_white_noise_has_no_structure(seed: int) -> None:
    assert find_remainder(*_with(_white, seed)) == ()


@pytest.mark.parametrize("seed", range(3))
def test_coloured_noise_does_not_come_again(seed: int) -> None:
    """Slow noise of half the white's size and 0.2 s: long, but not tied to the motion."""

    def coloured(random: np.random.Generator, run: int) -> Array:
        white = _white(random, run)
        keep = np.exp(-_solved()[0].campaign.prepared[run].step_s / 0.2)
        slow = np.zeros_like(white)
        kicks = random.normal(0.0, 0.5 * SIGMA_N * np.sqrt(1.0 - keep**2), len(white))
        for k in range(1, len(slow)):
            slow[k] = keep * slow[k - 1] + kicks[k]
        return white + slow

    # What the noise model finds of it: about a fifth of the mean square, remembered 0.2 s.
    assert _replicates(*_with(coloured, seed, Noise(0.2, 0.5))) == []


@pytest.mark.parametrize("seed", [0, 1, 17])
def test_noise_that_remembers_a_period_does_not_come_again(seed: int) -> None:
    """Slow noise of 4 s, longer than a noise is described by: as like itself half a period ago."""

    def slow(random: np.random.Generator, run: int) -> Array:
        white = _white(random, run)
        keep = np.exp(-_solved()[0].campaign.prepared[run].step_s / 4.0)
        kicks = random.normal(0.0, SIGMA_N * np.sqrt(1.0 - keep**2), len(white))
        return white + np.asarray(signal.lfilter([1.0], [1.0, -keep], kicks))

    assert _replicates(*_with(slow, seed)) == []


def test_an_error_that_comes_with_each_period_is_told_with_its_share() -> None:
    size_n = 0.4 * SIGMA_N

    def with_wave(random: np.random.Generator, run: int) -> Array:
        wave = np.sign(np.sin(5.0 * _phase(run)))
        return _white(random, run) + size_n * wave

    problem, solution = _with(with_wave, 3)
    (found,) = _replicates(problem, solution)
    assert found in find_remainder(problem, solution)
    assert found.axis == "period"
    assert found.share == pytest.approx(0.4**2 / (1.0 + 0.4**2), rel=0.25)
    assert "two_way_1" in found.where


def test_bursts_are_told_with_their_times_and_two_outliers_are_not() -> None:
    problem, solution = _with(_white, 4)
    prepared, samples = problem.campaign.prepared, solution.samples
    innovations = [r.copy() for r in solution.residuals]
    assert find_bursts(prepared, samples, innovations, innovations, DEFAULT) == []

    time = problem.campaign.prepared[0].run.time_s
    at = [int(np.searchsorted(time, t)) for t in (11.0, 23.0, 37.0, 44.0)]
    for k in at[:2]:
        innovations[0][k] += 12.0 * SIGMA_N
    assert find_bursts(prepared, samples, innovations, innovations, DEFAULT) == []

    for k in at:
        innovations[0][k : k + 3] += 9.0 * SIGMA_N
    (found,) = find_bursts(prepared, samples, innovations, innovations, DEFAULT)
    assert found.axis == "time"
    assert found.where.startswith("4 bursts")
    assert "11.0 s in two_way_0.25" in found.where
    assert found in find_remainder(problem, replace(solution, residuals=innovations))


def test_what_remains_is_told_in_newtons_of_the_residual() -> None:
    """Of 2 N against the motion the innovations of a noise with memory hold but a tenth: they find
    it, and the words say 2 N."""
    noise = Noise(0.2, 0.9)

    def misfit(random: np.random.Generator, run: int) -> Array:
        prepared = _solved()[0].campaign.prepared[run]
        slow = noise.coloured(0.3 * _white(random, run), prepared.step_s)
        return slow + 2.0 * np.sign(prepared.motion.velocity_m_s)

    problem, solution = _with(misfit, 6, noise)
    samples = solution.samples
    left = samples.flat(samples.innovations(solution.residuals, noise))
    assert np.sqrt(np.mean(left**2)) < 0.5
    told = {r.axis: r.where for r in find_remainder(problem, solution)}
    words = "record above the model by 2 N in the direction of motion; most "
    assert words in told["direction"]
    # The first +2 N, the second -2 N, or the other way round.
    sizes = [
        abs(float(part.split(" N at ")[0]))
        for part in told["direction"].split("most ")[1].split("; ")
    ]
    assert sizes == pytest.approx([2.0, 2.0], abs=0.15)


def test_a_burst_is_as_large_as_its_residual() -> None:
    problem, solution = _with(_white, 4)
    innovations = [r.copy() for r in solution.residuals]
    time = problem.campaign.prepared[0].run.time_s
    k = int(np.searchsorted(time, 23.0))
    innovations[0][k : k + 8] += 9.0 * SIGMA_N
    residuals = [e.copy() for e in innovations]
    residuals[0][k + 5] = -40.0
    (found,) = find_bursts(
        problem.campaign.prepared, solution.samples, innovations, residuals, DEFAULT
    )
    assert found.where == f"1 burst, of 40 N: at {time[k + 5]:.1f} s in two_way_0.25"


@pytest.mark.slow
def test_what_fits_but_does_not_predict_is_no_adequate_model() -> None:
    """The level of the friction differs from run to run: nothing in a catalogue foretells it."""
    rig, runs, _ = campaign(21, foreign=("level_step",), strength=1.5)
    found = diagnose(rig, runs)
    assert found.verdict == "unexplained"
    assert found.effects == ()


def test_a_cell_that_is_not_straight_shows_along_the_force() -> None:
    def bent(random: np.random.Generator, run: int) -> Array:
        problem, solution = _solved()
        force = problem.predict(solution.values)[run]
        return _white(random, run) + 0.25 * SIGMA_N * np.sin(6.0 * force / np.max(np.abs(force)))

    found = find_remainder(*_with(bent, 5))
    assert "force" in {r.axis for r in found}


def test_a_tone_is_seen_where_chance_would_not_show_it() -> None:
    """Of white noise a line of the spectrum is exponential; a tone of amplitude A adds
    A^2 n / (4 sigma^2) to it (Fisher 1929)."""
    problem, solution = _solved()
    samples, prepared = solution.samples, problem.campaign.prepared
    n, run = len(samples.counted[1]), 1
    assert samples.counted[run].mean() > 0.95
    # A whole number of turns: the tone falls on one line.
    frequency = round(4.7 * n * samples.steps_s[run]) / (n * samples.steps_s[run])
    lines = n / 2.0 - 8.0
    least = float(np.sqrt(4.0 * np.log(lines / DEFAULT.tone_chance) / n))
    seen = {}
    for part in (0.75, 1.3):
        seen[part] = 0
        for seed in range(25):
            e = [_white(np.random.default_rng(100 * seed + i), i) for i in range(len(prepared))]
            tone = np.sin(2.0 * np.pi * frequency * prepared[run].run.time_s + seed)
            e[run] = e[run] + part * least * SIGMA_N * tone
            seen[part] += bool(find_tones(prepared, samples, e, e, LOOSE))
    assert seen[0.75] <= 4
    assert seen[1.3] >= 21
