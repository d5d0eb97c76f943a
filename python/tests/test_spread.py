"""Errors of a fit against how far fits of many records of the same kind are off: noise as it is
described, and noise that is not."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb
from jbf import Rig, Run, fit
from jbf.estimation.long_run import between_runs

Noise = Callable[[Array, np.random.Generator], Array]
RUNS = 5
CAMPAIGNS = 12


def coloured(n: int, memory_s: float, random: np.random.Generator) -> Array:
    """First-order noise of unit variance."""
    share = np.exp(-0.02 / memory_s)
    e = np.sqrt(1.0 - share**2) * random.standard_normal(n)
    e[0] = random.standard_normal()
    for k in range(1, n):
        e[k] += share * e[k - 1]
    return e


def white(f: Array, random: np.random.Generator) -> Array:
    return 0.1 * random.standard_normal(len(f))


def zeros(f: Array, random: np.random.Generator) -> Array:
    """A zero of its own in each run."""
    return white(f, random) + 0.08 * random.standard_normal()


def two_colours(f: Array, random: np.random.Generator) -> Array:
    """No single memory describes it."""
    return 0.1 * coloured(len(f), 0.05, random) + 0.03 * coloured(len(f), 0.5, random)


def with_force(f: Array, random: np.random.Generator) -> Array:
    return (0.02 + 0.03 * np.abs(f)) * random.standard_normal(len(f))


def off(noise: Noise, seed: int) -> list[float]:
    """How many of its errors each parameter is off."""
    random, runs = np.random.default_rng(seed), []
    t = np.arange(0.0, 24.0, 0.02)
    for i in range(RUNS):
        rate = 1.0 + 0.17 * i
        v = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + i)
        f = coulomb(t, v, v)
        runs.append(Run.from_arrays(t, v, f + noise(f, random), name=f"run {i}"))
    found = fit(Rig(), runs, ["sensor_offset"], law="coulomb", fixed={"F_s_n": 6.0})
    truth = {**LAW, "sensor_offset.b_n": 0.0}
    told = {name: found.parameters[name] for name in truth}
    return [
        (told[n].value - truth[n]) / (told[n].stderr or 0.1 * abs(told[n].value)) for n in truth
    ]


@pytest.mark.parametrize("noise", [white, two_colours, with_force, zeros])
def test_parameters_are_as_far_off_as_their_errors_say(noise: Noise) -> None:
    z = np.array([off(noise, 100 + seed) for seed in range(CAMPAIGNS)])
    size = np.sqrt(np.mean(z**2, axis=0))
    # A mean of so many squares is a fifth off by chance; of few runs a spread is not known well.
    assert np.all(size < 2.0), size
    assert np.all(size > 0.4), size


def test_only_runs_that_scatter_beyond_chance_say_more_than_their_windows() -> None:
    random = np.random.default_rng(3)
    ones = [np.ones(400) for _ in range(6)]
    e = [random.standard_normal(400) for _ in ones]
    assert between_runs(ones, e, 1.0) == 0.0
    zero = np.array([0.5, -0.3, 0.1, -0.6, 0.4, -0.1])
    moved = [x + z for x, z in zip(e, zero, strict=True)]
    # By hand: the variance of six sums of 400 over that of white noise.
    sums = [float(np.sum(x)) for x in moved]
    own = np.mean(np.concatenate(moved) ** 2) * 2400.0
    found = between_runs(ones, moved, 1.0)
    assert found == pytest.approx(np.sum(np.square(sums)) * 6.0 / 5.0 / own)
    assert found > 20.0
    # What their windows know already is no scatter.
    assert between_runs(ones, moved, 1000.0) == 0.0
    assert between_runs(ones[:2], moved[:2], 1.0) == 0.0
