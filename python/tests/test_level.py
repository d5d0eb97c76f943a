"""The level of the tests: what noise of any kind may gain so often and no oftener."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from jbf.diagnosis.level import Directions, Level, calibrated
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.blocks import blocks_of
from jbf.estimation.likelihood import independent_share
from jbf.estimation.samples import Samples
from scipy import signal, stats

N, STEP_S, RUNS, CANDIDATES = 2000, 0.02, 4, 8
SAMPLES = Samples(
    tuple(f"run {i}" for i in range(RUNS)),
    (STEP_S,) * RUNS,
    (np.ones(N, bool),) * RUNS,
    (np.ones(N),) * RUNS,
)
TIME = np.arange(RUNS * N) * STEP_S


def white(random: np.random.Generator) -> Array:
    return random.standard_normal(RUNS * N)


def heavy(random: np.random.Generator) -> Array:
    return random.standard_t(3.0, RUNS * N)


def slow(random: np.random.Generator) -> Array:
    """Of a memory of half a second."""
    kicks = random.standard_normal(RUNS * N)
    found: Array = signal.lfilter([1.0], [1.0, -float(np.exp(-STEP_S / 0.5))], kicks)
    return found


def with_force(random: np.random.Generator) -> Array:
    """Larger where the second and the third effect show."""
    return white(random) * (0.2 + np.sin(0.4 * TIME) ** 4)


def effects() -> list[Array]:
    """What candidates change: waves, steps and bumps, some of them alike."""
    waves = [np.sin((0.3 + 0.1 * k) * TIME + k) for k in range(CANDIDATES - 2)]
    return [*waves, np.sign(np.sin(0.4 * TIME)), np.exp(-(((TIME % 40.0) - 20.0) ** 2))]


def directions(noise: Array) -> list[Directions]:
    share = independent_share(np.split(noise, RUNS), SAMPLES.steps_s)
    law = np.stack([np.ones_like(TIME), np.cos(0.2 * TIME)], axis=1)
    return [Directions.of(noise, own[:, None], law, SAMPLES, share) for own in effects()]


def gains(told: list[Directions]) -> Array:
    """What each candidate gains, as evidence counts it."""
    return np.array([float(np.sum((d.ways.T @ d.innovations) ** 2 * d.counted)) for d in told])


def level() -> Level:
    return Level.shared(replace(DEFAULT, indifference=0.0), CANDIDATES, RUNS * N, 1.0)


def test_of_white_noise_the_level_is_shared_among_the_candidates() -> None:
    told = calibrated(level(), directions(white(np.random.default_rng(0))))
    assert 0.8 * 0.01 / CANDIDATES < told.chance <= 0.01 / CANDIDATES
    # A chi-square of one degree exceeds 10.45 with a probability of 0.01 / 8.
    assert 10.4 < told.critical < 10.9
    assert told.blocks == RUNS * N * STEP_S


@pytest.mark.parametrize("noise", [white, heavy, slow, with_force])
def test_noise_makes_a_name_no_oftener_than_the_level_says(
    noise: Callable[[np.random.Generator], Array],
) -> None:
    allowed, campaigns = 0.05, 120
    asked = replace(level(), false_alarms=allowed, chance=allowed / CANDIDATES)
    false = 0
    for seed in range(campaigns):
        told = directions(noise(np.random.default_rng(seed)))
        false += bool(np.max(gains(told)) > calibrated(asked, told).critical)
    # Not more than chance allows, 999 times of 1,000.
    assert false <= stats.binom.ppf(0.999, campaigns, allowed)


def test_noise_that_is_large_where_an_effect_shows_raises_the_level() -> None:
    # As if evidence took all gains for those of white noise.
    rises = []
    for seed in range(6):
        noise = white(np.random.default_rng(seed)) * (0.1 + 3.0 * effects()[-1])
        told = directions(noise)
        plain = [replace(d, counted=np.ones(1)) for d in told]
        rises.append(calibrated(level(), plain).critical / level().critical)
    assert 3.0 < np.median(rises) < 30.0


def test_what_a_candidate_could_explain_is_no_noise() -> None:
    noise = white(np.random.default_rng(1))
    there = noise + 5.0 * effects()[-1] + 3.0 * effects()[2]
    assert calibrated(level(), directions(there)).critical == pytest.approx(
        calibrated(level(), directions(noise)).critical, rel=0.02
    )


def test_two_candidates_that_are_one_ask_for_what_one_does() -> None:
    """What both explain is taken away once, and nothing is made of what neither does."""
    noise = white(np.random.default_rng(0)) * (0.1 + 3.0 * effects()[-1])
    told = [replace(one, counted=np.ones(1)) for one in directions(noise)[-1:]]
    alone, pair = (calibrated(level(), again) for again in (told, 2 * told))
    assert alone.critical > 1.5 * level().critical
    # A candidate without a direction fewer, which is next to nothing here.
    assert pair.critical == pytest.approx(alone.critical, rel=0.05)


def test_a_direction_is_what_the_law_cannot_make_up_for() -> None:
    law = np.stack([np.ones_like(TIME), np.cos(0.2 * TIME)], axis=1)
    noise = white(np.random.default_rng(3))
    own = (law @ [2.0, 3.0] + effects()[2])[:, None]
    found = Directions.of(noise, own, law, SAMPLES, 1.0).ways
    assert found.shape == own.shape
    np.testing.assert_allclose(found.T @ law, 0.0, atol=1e-9)
    np.testing.assert_allclose(found.T @ found, 1.0)
    # Of what the law does itself nothing is left.
    assert Directions.of(noise, law[:, :1], law, SAMPLES, 1.0).ways.shape[1] == 0


def test_signs_turn_from_second_to_second_and_within_runs() -> None:
    weight = np.ones(N)
    weight[:30] = 0.0
    starts = blocks_of(replace(SAMPLES, weight=(weight,) * RUNS), 1.0)
    lengths = np.diff(np.append(starts, RUNS * (N - 30)))
    assert set(lengths.tolist()) == {50, 20}
    # Of samples that remember a second each block holds four such.
    slow = blocks_of(SAMPLES, 1.0 / 100.0)
    assert set(np.diff(slow).tolist()) == {200}
    assert set(starts[:: len(starts) // RUNS].tolist()) == {k * (N - 30) for k in range(RUNS)}


def test_scores_of_several_models_go_together() -> None:
    """One was tested beside a model whose residual remembers longer: its blocks hold for all."""
    told = directions(white(np.random.default_rng(6)))
    longer = replace(told[1], blocks=blocks_of(SAMPLES, 1.0 / 100.0))
    assert calibrated(level(), [told[0], longer, *told[2:]]).blocks == len(longer.blocks)


def test_a_candidate_without_a_score_keeps_its_share() -> None:
    told = directions(white(np.random.default_rng(2)))
    some = calibrated(level(), told[:2])
    assert some.chance <= level().chance
    assert calibrated(level(), []) == level()


def test_a_long_recording_asks_for_more_than_chance() -> None:
    # 3 % of the noise in 100,000 samples: 90 in twice the log likelihood.
    assert Level.shared(DEFAULT, 20, 1e5, 0.5).price(1, 100_000) == pytest.approx(90.0)
    # A force of 20 mN beside noise of 0.5 N is 4 % of it.
    newtons = replace(DEFAULT, indifference=0.0, indifference_n=0.02)
    assert Level.shared(newtons, 20, 1e5, 0.5).price(1, 100_000) == pytest.approx(160.0)
    assert Level.shared(newtons, 20, 1e3, 0.5).price(1, 1000) == pytest.approx(
        float(stats.chi2.isf(0.01 / 20, 1)) + 22.0
    )


def test_what_the_residual_shows_counts_towards_what_recordings_do() -> None:
    told = Level.shared(DEFAULT, 20, 1e4, 1.0)
    white = told.critical
    assert told.white == white
    assert told.price(1, 10_000) == pytest.approx(white + DEFAULT.imperfection)
    # A residual that makes large gains asks for them, and not for the allowance besides.
    for critical in (white + 5.0, white + 60.0):
        rough = replace(told, chance=float(stats.chi2.sf(critical, 1)))
        asked = max(critical, white + DEFAULT.imperfection)
        assert rough.price(1, 10_000) == pytest.approx(asked)
        assert rough.to_dict()["white"] == white
