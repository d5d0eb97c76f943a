"""The noise floor and the description of coloured noise, on noise that is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from campaigns import campaign
from jbf import Rig, Run
from jbf._core import first_order_filter
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE, Noise, estimate_noise, innovation_cost
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.replicates import period_samples

Array = npt.NDArray[np.float64]
STEP_S = 0.02


def coloured(seed: int, white: float, colour: float, memory_s: float, n: int = 8000) -> Array:
    """White noise plus a first-order process of correlation time `memory_s`."""
    random = np.random.default_rng(seed)
    phi = np.exp(-STEP_S / memory_s)
    kicks = random.normal(0.0, colour * np.sqrt(1.0 - phi**2), n)
    slow = np.zeros(n)
    for i in range(1, n):
        slow[i] = phi * slow[i - 1] + kicks[i]
    return slow + random.normal(0.0, white, n)


def _correlation(e: Array, lag: int) -> float:
    return float(np.corrcoef(e[lag:], e[:-lag])[0, 1])


def test_white_noise_stays_white() -> None:
    for seed in range(20):
        r = coloured(seed, 0.4, 0.0, 0.2, 4000)
        assert estimate_noise([r], [STEP_S], [np.ones(len(r), bool)]) == WHITE


def test_innovations_of_coloured_noise_are_white() -> None:
    r = coloured(1, 0.4, 0.3, 0.2)
    assert _correlation(r, 3) > 0.15
    noise = estimate_noise([r], [STEP_S], [np.ones(len(r), bool)])
    assert 0.08 < noise.memory_s < 0.5
    e = noise.innovations(r, STEP_S)
    for lag in (1, 2, 3, 5, 10):
        assert abs(_correlation(e, lag)) < 0.04


def test_white_innovations_are_the_values() -> None:
    r = np.arange(5.0)
    assert Noise().innovations(r, STEP_S) is r


@pytest.mark.parametrize(("is_coloured", "whole"), [(False, 1.0), (True, np.sqrt(1.25))])
def test_the_floor_of_a_record(is_coloured: bool, whole: float) -> None:
    ratios = []
    for seed in (3, 4, 5):
        rig, runs, truth = campaign(seed, coloured=is_coloured)
        prepared = Campaign.prepare(rig, runs)
        floor = noise_floor(prepared.prepared, prepared.samples)
        ratios.append(floor / truth["noise_n"])
    assert np.mean(ratios) == pytest.approx(whole, rel=0.06)


@pytest.mark.parametrize("over_noise", [1.0, 2.0, 4.0])
def test_the_floor_of_readings_in_steps_counts_what_steps_leave(over_noise: float) -> None:
    """The error of an even share of a step is the noise's, too (Widrow 1956); of coarse steps most
    third differences are zero, and the rest whole ones."""
    for seed in (6, 7):
        rig, runs, truth = campaign(seed)
        step = over_noise * truth["noise_n"]
        coarse = [replace(run, friction_n=step * np.round(run.friction_n / step)) for run in runs]
        prepared = Campaign.prepare(rig, coarse)
        whole = np.hypot(truth["noise_n"], step / np.sqrt(12.0))
        floor = noise_floor(prepared.prepared, prepared.samples)
        assert floor == pytest.approx(whole, rel=0.15)


def test_steps_far_above_the_noise_are_the_floor() -> None:
    """Nearly all third differences are zero."""
    t = 0.02 * np.arange(6000)
    v = 0.1 * np.sin(0.05 * t)
    force = 150.0 * v + 0.02 * np.random.default_rng(3).standard_normal(len(t))
    run = Run.from_arrays(t, v, 2.0 * np.round(force / 2.0), position_m=np.cumsum(v) * 0.02)
    prepared = Campaign.prepare(Rig(), [run])
    assert np.mean(np.diff(run.friction_n) == 0.0) > 0.9
    floor = noise_floor(prepared.prepared, prepared.samples)
    assert floor == pytest.approx(2.0 / np.sqrt(12.0), rel=1e-3)


def test_the_period_of_a_repeated_motion() -> None:
    t = np.arange(0.0, 32.0, STEP_S)
    v = 0.127 * np.sin(t) + np.random.default_rng(0).normal(0.0, 1e-4, len(t))
    assert period_samples(v) == pytest.approx(2.0 * np.pi / STEP_S, abs=2)
    assert period_samples(np.linspace(0.0, 1.0, 500)) is None
    assert period_samples(np.full(500, 0.1)) is None


@pytest.mark.parametrize("seed", range(6))
def test_no_other_description_fits_better(seed: int) -> None:
    random = np.random.default_rng(seed)
    white, colour = random.uniform(0.1, 0.5, 2)
    memory_s = float(np.exp(random.uniform(np.log(0.08), np.log(0.4))))
    runs = [coloured(10 * seed + k, white, colour, memory_s, 3000) for k in range(2)]
    masks = [random.random(len(r)) > 0.1 for r in runs]
    steps = [STEP_S, STEP_S]

    def cost(noise: Noise) -> float:
        return innovation_cost(noise, runs, steps, masks)

    found = cost(estimate_noise(runs, steps, masks))
    grid = [Noise(m, c) for m in np.geomspace(0.04, 0.6, 25) for c in np.linspace(0.01, 0.99, 50)]
    assert found < min(map(cost, grid)) + 0.1


@pytest.mark.parametrize("shape", [(400,), (400, 3), (0,), (5, 0)])
def test_the_filter_is_scipys(shape: tuple[int, ...]) -> None:
    from scipy import signal

    values = np.random.default_rng(3).standard_normal(shape)
    found = first_order_filter((1.0, -0.9), -0.45, values)
    assert found.shape == shape
    if values.size:
        assert np.array_equal(found, signal.lfilter([1.0, -0.9], [1.0, -0.45], values, axis=0))
    # A view is filtered as it is seen.
    turned = np.asfortranarray(values)[::-1]
    if values.size:
        assert np.array_equal(
            first_order_filter((0.0, 2.0), 0.3, turned),
            signal.lfilter([0.0, 2.0], [1.0, 0.3], turned, axis=0),
        )


def test_a_cube_is_refused() -> None:
    with pytest.raises(ValueError, match="3 axes"):
        first_order_filter((1.0, 0.0), 0.0, np.zeros((2, 2, 2)))
