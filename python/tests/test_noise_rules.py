"""The description of noise against the textbook's ARMA(1,1) process, and what holds it down.

Box & Jenkins, Time Series Analysis (1970), ch. 3.4: of `r_t = phi r_t-1 + e_t - theta e_t-1` the
variance is `(1 + theta^2 - 2 phi theta) / (1 - phi^2)` times that of `e`, the autocovariance at one
step `(1 - phi theta)(phi - theta) / (1 - phi^2)` times it.
"""

from __future__ import annotations

from dataclasses import FrozenInstanceError

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import coulomb, one_way
from jbf import Rig, fit
from jbf.estimation.noise import WHITE, Noise, _changes, estimate_noise, innovation_cost
from scipy import optimize, signal

Array = npt.NDArray[np.float64]
STEP_S = 0.02


def autoregressive(seed: int, phi: float, sd: float, n: int) -> Array:
    """A first-order process of standard deviation `sd`."""
    kicks = np.random.default_rng(seed).normal(0.0, sd * np.sqrt(1.0 - phi**2), n)
    found: Array = signal.lfilter([1.0], [1.0, -phi], kicks)
    return found


@pytest.mark.parametrize("memory_s", [0.05, 0.2, 0.6])
@pytest.mark.parametrize("colour", [0.01, 0.2, 0.9])
def test_the_coloured_share_is_the_textbooks(memory_s: float, colour: float) -> None:
    phi = float(np.exp(-STEP_S / memory_s))
    theta = phi * (1.0 - colour)
    whole = 1.0 + theta**2 - 2.0 * phi * theta
    # The coloured part alone has correlation phi from step to step, the white part none.
    share = (1.0 - phi * theta) * (phi - theta) / (phi * whole)
    noise = Noise(memory_s, colour)
    assert noise.coloured_share(STEP_S) == pytest.approx(share, rel=1e-9)
    assert noise.with_share(share, STEP_S).colour == pytest.approx(colour, rel=1e-6)
    assert noise.with_share(share, STEP_S).memory_s == memory_s


def test_shares_at_the_ends() -> None:
    assert (WHITE.memory_s, WHITE.colour, WHITE.white) == (0.0, 0.0, True)
    assert WHITE.coloured_share(STEP_S) == 0.0
    for nothing in (Noise(0.0, 0.5), Noise(0.2, 0.0)):
        assert nothing.white
        assert nothing.coloured_share(STEP_S) == 0.0
    assert Noise(0.2, 1.0).coloured_share(STEP_S) == 1.0
    assert Noise(0.2, 0.5).with_share(0.0, STEP_S) == WHITE


def test_a_description_is_a_value() -> None:
    assert Noise(0.2, 0.5) == Noise(0.2, 0.5) != Noise(0.2, 0.4)
    with pytest.raises(FrozenInstanceError):
        WHITE.colour = 0.5  # type: ignore[misc]


def test_noise_made_of_innovations_gives_them_back() -> None:
    noise = Noise(0.2, 0.3)
    kicks = np.random.default_rng(1).standard_normal((500, 2))
    made = noise.coloured(kicks, STEP_S)
    np.testing.assert_allclose(noise.innovations(made, STEP_S), kicks, atol=1e-12)
    phi = np.exp(-STEP_S / 0.2)
    by_hand = phi * made[:-1] + kicks[1:] - phi * 0.7 * kicks[:-1]
    np.testing.assert_allclose(made[1:], by_hand, atol=1e-12)


def test_the_cost_is_twice_the_log_likelihood_but_for_a_constant() -> None:
    random = np.random.default_rng(2)
    runs = [random.normal(0.0, s, n) for s, n in ((0.5, 300), (1.0, 200))]
    masks = [np.ones(300, bool), random.random(200) < 0.7]
    count = sum(int(m.sum()) for m in masks)
    square = sum(float(np.sum(r[m] ** 2)) for r, m in zip(runs, masks, strict=True)) / count
    # At the variance that is likeliest: n log(square) + n + n log(2 pi).
    sd = np.sqrt(square)
    twice = sum(
        float(np.sum((r[m] / sd) ** 2 + 2.0 * np.log(sd))) for r, m in zip(runs, masks, strict=True)
    )
    assert innovation_cost(WHITE, runs, [STEP_S, STEP_S], masks) == pytest.approx(twice - count)


def test_colour_is_held_to_the_most_that_noise_can_be() -> None:
    n = 6000
    # 0.5 N of white noise, and 1 N as smooth as the error of a wrong model.
    smooth = autoregressive(3, float(np.exp(-STEP_S / 0.4)), 1.0, n)
    r = smooth + np.random.default_rng(4).normal(0.0, 0.5, n)
    every = [np.ones(n, bool)]
    free = estimate_noise([r], [STEP_S], every)
    assert free.coloured_share(STEP_S) == pytest.approx(0.8, abs=0.06)
    # What comes again says that the noise, colour and all, is 0.6 N: 0.36 N^2 of 1.25.
    held = estimate_noise([r], [STEP_S], every, 0.6)
    assert held.coloured_share(STEP_S) == pytest.approx(0.36 / np.mean(r**2), rel=1e-6)
    assert held.memory_s == free.memory_s
    assert estimate_noise([r], [STEP_S], every, 5.0) == free


def test_a_little_colour_does_not_earn_its_parameters() -> None:
    n, kept = 2000, 0
    for seed in range(10):
        slow = autoregressive(seed, 0.9, 0.05, n)
        r = slow + np.random.default_rng(100 + seed).normal(0.0, 0.5, n)
        kept += estimate_noise([r], [STEP_S], [np.ones(n, bool)]) == WHITE
    assert kept == 10


def test_an_error_that_comes_again_is_not_forgiven_as_colour() -> None:
    # A mass that the law knows nothing of, swung once a second: smooth, and no noise.
    def heavy(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + 1.5 * a

    runs = [
        one_way(name, heavy, way=way, rate=2.0 * np.pi, noise_n=0.1, seed=seed)
        for name, way, seed in (("there", 1.0, 1), ("back", -1.0, 2))
    ]
    fitted = fit(Rig(), runs, law="coulomb")
    assert fitted.rms_n > 2.0 * 0.1
    # What comes again says that the noise is 0.1 N: so much of the square at most is coloured.
    most = 0.1**2 / fitted.rms_n**2
    assert fitted.noise.coloured_share(STEP_S) < 1.2 * most
    assert fitted.noise.coloured_share(STEP_S) == pytest.approx(most, rel=0.2)


def test_of_a_memory_of_a_step_or_less_two_steps_are_told() -> None:
    """A shorter one is none to follow: of the shortest step, where runs are read unevenly."""
    kicks = autoregressive(5, 0.4, 1.0, 8000)
    every = [np.ones(8000, bool)]
    found = estimate_noise([kicks], [STEP_S], every)
    assert 2.0 * STEP_S < found.memory_s < 2.2 * STEP_S
    seldom = autoregressive(6, 0.05, 1.0, 8000)
    both = estimate_noise([kicks, seldom], [STEP_S, 3.0 * STEP_S], 2 * every)
    assert 2.0 * STEP_S < both.memory_s < 2.2 * STEP_S


@pytest.mark.parametrize(("step_s", "longest_s"), [(0.02, 0.6), (0.2, 0.8), (0.3, 1.2)])
def test_a_longer_memory_than_noise_has_is_told_as_the_longest(
    step_s: float, longest_s: float
) -> None:
    """0.6 s, and four steps where that is less; what wanders for ten times as long is no noise."""
    slow = autoregressive(6, float(np.exp(-0.1 * step_s / longest_s)), 1.0, 4000)
    r = slow + np.random.default_rng(7).normal(0.0, 0.3, 4000)
    found = estimate_noise([r], [step_s], [np.ones(4000, bool)])
    assert 0.9 * longest_s < found.memory_s < 1.0001 * longest_s


def test_colour_must_gain_twenty_in_twice_the_log_likelihood() -> None:
    """Of noise that has little of it, wherever between first guesses its best description lies."""
    n = 3000
    every = [np.ones(n, bool)]
    grid = [Noise(m, c) for m in np.geomspace(0.045, 0.59, 8) for c in np.geomspace(4e-3, 0.3, 12)]
    told = {True: 0, False: 0}
    for seed in range(24):
        white = np.random.default_rng(100 + seed).normal(0.0, 0.4, n)
        r = [autoregressive(seed, 0.85, 0.095, n) + white]
        least = min(innovation_cost(noise, r, [STEP_S], every) for noise in grid)
        gain = innovation_cost(WHITE, r, [STEP_S], every) - least
        # The grid's best is no more than a little off the best.
        if abs(gain - 20.0) > 1.5:
            assert estimate_noise(r, [STEP_S], every).white == (gain < 20.0)
            told[gain < 20.0] += 1
    assert min(told.values()) > 5


@pytest.mark.parametrize(
    ("size", "seed", "earned"),
    [(0.1, 17, True), (0.1, 3, True), (0.095, 16, False), (0.11, 0, False)],
)
def test_a_gain_of_a_little_more_than_twenty_is_earned(
    size: float, seed: int, earned: bool
) -> None:
    """The best of all memories and colours is sought here by a simplex (Nelder & Mead 1965)."""
    n = 3000
    every = [np.ones(n, bool)]
    white = np.random.default_rng(100 + seed).normal(0.0, 0.4, n)
    r = [autoregressive(seed, 0.85, size, n) + white]

    def cost(x: Array) -> float:
        memory_s, colour = np.exp(x).tolist()
        if not (2.0 * STEP_S <= memory_s <= 0.6 and colour < 1.0):
            return np.inf
        return innovation_cost(Noise(memory_s, colour), r, [STEP_S], every)

    starts = [
        np.log([m, c]) for m in np.geomspace(0.05, 0.5, 6) for c in np.geomspace(0.01, 0.2, 6)
    ]
    best = optimize.minimize(cost, min(starts, key=cost), method="Nelder-Mead")
    gain = innovation_cost(WHITE, r, [STEP_S], every) - float(best.fun)
    assert 19.0 < gain < 21.0
    assert (gain > 20.0) == earned
    assert estimate_noise(r, [STEP_S], every).white != earned


def test_runs_steps_and_masks_go_in_step() -> None:
    r, every = autoregressive(8, 0.9, 1.0, 500), np.ones(500, bool)
    noise = Noise(0.2, 0.5)
    for runs, steps, masks in (
        ([r], [STEP_S] * 2, [every] * 2),
        ([r] * 2, [STEP_S], [every] * 2),
        ([r] * 2, [STEP_S] * 2, [every]),
    ):
        with pytest.raises(ValueError, match="zip"):
            innovation_cost(noise, runs, steps, masks)
        with pytest.raises(ValueError, match="zip"):
            _changes(noise, runs, steps, masks)
