"""Tones in time and waves along the path, put into white noise: found, named and sized as made."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.ripples import IN_MOST_CHANCE, _in_most
from jbf.diagnosis.tones import find_tones
from jbf.estimation.campaign import Campaign

SIGMA_N = 0.3
LOOSE = replace(DEFAULT, tone_share=0.0)


@pytest.fixture(scope="module")
def campaign(rig: Rig, runs: list[Run]) -> Campaign:
    return Campaign.prepare(rig, runs)


def said_of_tones(campaign: Campaign, tones: dict[int, tuple[float, float]]) -> str:
    """What is said of tones (Hz, N) in some of the runs."""
    random = np.random.default_rng(8)
    residuals = []
    for i, p in enumerate(campaign.prepared):
        frequency, amplitude = tones.get(i, (1.0, 0.0))
        wave = amplitude * np.sin(2.0 * np.pi * frequency * p.run.time_s + i)
        residuals.append(wave + random.normal(0.0, SIGMA_N, len(p.run)))
    found = find_tones(campaign.prepared, campaign.samples, residuals, residuals, LOOSE)
    if found:
        # The share of the mean square that the tones have: half the square of each amplitude.
        power = sum(0.5 * a**2 * len(campaign.prepared[i].run) for i, (_, a) in tones.items())
        total = power + SIGMA_N**2 * sum(len(p.run) for p in campaign.prepared)
        assert found[0].share == pytest.approx(power / total, rel=0.06)
    return found[0].where if found else ""


def test_a_tone_of_all_runs_and_of_some(campaign: Campaign) -> None:
    names = [p.run.name for p in campaign.prepared]
    assert said_of_tones(campaign, {}) == ""
    every = said_of_tones(campaign, dict.fromkeys(range(3), (5.3, 2.0)))
    assert every == "a 5.30 Hz tone, amplitude 2 N, in all runs"
    two = said_of_tones(campaign, {0: (5.3, 2.0), 2: (5.3, 2.0)})
    assert two == f"a 5.30 Hz tone, amplitude 2 N, in {names[0]}, {names[2]}"


def test_tones_of_their_own_have_their_own_words(campaign: Campaign) -> None:
    said = said_of_tones(campaign, {0: (5.3, 2.0), 1: (9.1, 1.0)})
    names = [p.run.name for p in campaign.prepared]
    told = re.findall(r"([\d.]+) Hz of ([\d.]+) N in ([\w.]+)", said)
    assert [name for *_, name in told] == names[:2]
    # A sine's amplitude is known to sigma sqrt(2 / n), 0.012 N.
    found = [(float(frequency), float(amplitude)) for frequency, amplitude, _ in told]
    assert np.array(found) == pytest.approx(np.array([[5.3, 2.0], [9.1, 1.0]]), abs=0.04)


def test_a_wave_along_the_path_is_in_most_runs_or_it_is_chance(campaign: Campaign) -> None:
    """Of white noise twice the power of a line over the level is chi-square with two degrees."""
    samples, pitch = campaign.samples, 0.002
    ways = [np.asarray(p.motion.angle_rad) * 0.0127 for p in campaign.prepared]

    def seen(amplitudes: tuple[float, ...], seed: int) -> bool:
        random = np.random.default_rng(seed)
        noise = [
            random.normal(0.0, 1.0, len(way)) + a * np.cos(2.0 * np.pi * way / pitch)
            for way, a in zip(ways, amplitudes, strict=True)
        ]
        return _in_most(ways, noise, samples, pitch)

    assert all(seen((0.4, 0.4, 0.4), seed) for seed in range(20))
    # The one run that has it is not asked.
    assert sum(seen((0.8, 0.0, 0.0), seed) for seed in range(40)) <= 1
    by_chance = sum(seen((0.0, 0.0, 0.0), seed) for seed in range(1500))
    assert by_chance <= 1500 * IN_MOST_CHANCE + 3.0 * (1500 * IN_MOST_CHANCE) ** 0.5
