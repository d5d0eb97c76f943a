"""Candidates in the wrong place: what they gain in noise, in structure, and shift by shift."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from jbf import Rig, diagnose
from jbf.diagnosis.decoys import DRAWS, decoy_gains, rate_below
from jbf.diagnosis.level import Directions, Level, with_decoys
from jbf.diagnosis.policy import DEFAULT
from jbf.reporting.power_text import level_words
from scipy import stats

N = 4000
ENDS = np.array([1000, 2500])
TIME = 0.02 * np.arange(N)


def directions(ways: Array, innovations: Array, counted: float = 1.0) -> Directions:
    ways = np.linalg.qr(ways)[0]
    return Directions(ways, innovations, np.full(ways.shape[1], counted), np.arange(0, N, 50), ENDS)


@pytest.mark.parametrize("k", [1, 3])
def test_in_white_noise_decoys_gain_what_chance_does(k: int) -> None:
    random = np.random.default_rng(k)
    gains = []
    for _ in range(20):
        one = directions(random.standard_normal((N, k)), random.standard_normal(N))
        gains.append(decoy_gains([one])[0])
    whole = np.concatenate(gains)
    assert np.mean(whole) == pytest.approx(k, rel=0.1)
    assert np.mean(whole > stats.chi2.isf(0.05, k)) == pytest.approx(0.05, abs=0.015)


def test_a_decoy_is_the_candidate_shifted_along_each_run() -> None:
    random = np.random.default_rng(4)
    way, noise = random.standard_normal((N, 1)), random.standard_normal(N)
    one = directions(way, noise, counted=0.5)
    possible = []
    for w, e in zip(np.split(one.ways[:, 0], ENDS), np.split(noise, ENDS), strict=True):
        possible.append(np.array([np.roll(w, shift) @ e for shift in range(len(w))]))
    gains = decoy_gains([one])[0]
    assert len(gains) == DRAWS
    draws = np.random.default_rng(DRAWS)
    scores = sum(p[draws.integers(0, len(p), DRAWS)] for p in possible)
    np.testing.assert_allclose(gains, 0.5 * np.asarray(scores) ** 2, rtol=1e-9)


def test_what_remains_in_a_residual_makes_decoys_gain() -> None:
    random = np.random.default_rng(5)
    hum = np.sqrt(2.0) * np.sin(2.0 * np.pi * 3.1 * TIME)
    noise = random.standard_normal(N)
    level = Level.shared(DEFAULT, 10, N, 1.0)
    way = np.cos(2.0 * np.pi * 3.1 * TIME)[:, None]
    quiet = with_decoys(level, [directions(way, noise)], N)
    assert (quiet.decoys, quiet.decoys_named) == (DRAWS, 0)
    loud = with_decoys(level, [directions(way, noise + 0.3 * hum)], N)
    assert loud.decoys_named > 0.2 * DRAWS
    assert f"{loud.decoys_named} would have made a name" in level_words(loud)


def test_without_candidates_that_show_there_are_no_decoys() -> None:
    level = Level.shared(DEFAULT, 10, N, 1.0)
    assert with_decoys(level, [], N) == level
    assert "decoy" not in level_words(level)


def test_the_largest_rate_that_so_few_allow() -> None:
    # None of n: the rate at which none happens in one of twenty.
    assert rate_below(0, 200) == pytest.approx(1.0 - 0.05 ** (1.0 / 200.0))
    assert stats.binom.cdf(3, 200, rate_below(3, 200)) == pytest.approx(0.05)


def test_a_diagnosis_says_what_decoys_made_of_its_residual() -> None:
    found = diagnose(Rig(), four_runs(coulomb, noise_n=0.1), law="coulomb")
    assert found.verdict == "adequate"
    assert found.level.decoys == DRAWS
    assert found.level.decoys_named == 0
    assert found.to_dict()["level"]["decoys"] == DRAWS
    assert "false names below 1.5 %" in " ".join(found.summary().split())


def test_a_run_without_samples_has_no_part_and_stops_no_other() -> None:
    random = np.random.default_rng(6)
    one = directions(random.standard_normal((N, 1)), random.standard_normal(N))
    whole = Directions(one.ways, one.innovations, one.counted, one.blocks, np.array([1500]))
    first = Directions(one.ways, one.innovations, one.counted, one.blocks, np.array([0, 1500]))
    middle = Directions(one.ways, one.innovations, one.counted, one.blocks, np.array([1500, 1500]))
    (plain,) = decoy_gains([whole])
    for empty in (first, middle):
        (found,) = decoy_gains([empty])
        np.testing.assert_array_equal(found, plain)
