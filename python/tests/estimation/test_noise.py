"""White plus first-order coloured noise, and noise estimated from a record without a model.

At even steps the noise is an ARMA(1,1) process (Box & Jenkins, Time Series Analysis, 1970).
With `r_t = phi r_t-1 + e_t - theta e_t-1` the variance of r is `(1 + theta^2 - 2 phi theta) /
(1 - phi^2)` times that of e, its autocovariance at one step `(1 - phi theta)(phi - theta) /
(1 - phi^2)` times.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import Array, coulomb, four_runs, one_way
from campaigns import campaign
from coulomb_problems import STEP_S, arma_innovations, autoregressive, coulomb_problem, values_of
from jbf import Rig, Run, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import noise_at
from jbf.estimation.noise import WHITE, Noise, estimate_noise, innovation_cost
from jbf.estimation.noise_floor import noise_floor, noise_upper_bound
from jbf.estimation.random_effects import RandomEffects
from linear_campaigns import mass
from scipy import optimize, signal


def everywhere(n: int) -> npt.NDArray[np.bool_]:
    return np.ones(n, dtype=bool)


def white(seed: int, sd: float, n: int) -> Array:
    return np.random.default_rng(seed).normal(0.0, sd, n)


@pytest.mark.parametrize("shape", [(400,), (400, 3)])
def test_innovations_satisfy_the_arma_difference_equation(shape: tuple[int, ...]) -> None:
    noise = Noise(0.2, 0.3)
    values = np.random.default_rng(3).standard_normal(shape)
    found = noise.innovations(values, STEP_S)
    np.testing.assert_allclose(found, arma_innovations(values, STEP_S, noise), atol=1e-12)


def test_whitening_inverts_the_colouring_of_innovations() -> None:
    noise = Noise(0.2, 0.3)
    kicks = np.random.default_rng(1).standard_normal((500, 2))
    made = noise.coloured(kicks, STEP_S)
    np.testing.assert_allclose(noise.innovations(made, STEP_S), kicks, atol=1e-12)
    assert not np.allclose(made, kicks, atol=0.1)


@pytest.mark.parametrize("noise", [WHITE, Noise(0.0, 0.5), Noise(0.2, 0.0)])
def test_noise_without_memory_or_colour_is_white(noise: Noise) -> None:
    values = np.arange(5.0)
    assert (noise.white, noise.coloured_share(STEP_S)) == (True, 0.0)
    np.testing.assert_array_equal(noise.innovations(values, STEP_S), values)
    np.testing.assert_array_equal(noise.coloured(values, STEP_S), values)
    assert Noise(0.2, 0.5).with_share(0.0, STEP_S) == WHITE
    assert Noise(0.2, 1.0).coloured_share(STEP_S) == 1.0


@pytest.mark.parametrize("memory_s", [0.05, 0.2, 0.6])
@pytest.mark.parametrize("colour", [0.01, 0.2, 0.9])
def test_coloured_share_is_that_of_an_arma_process(memory_s: float, colour: float) -> None:
    phi = float(np.exp(-STEP_S / memory_s))
    theta = phi * (1.0 - colour)
    # Only the coloured part is correlated, with phi between adjacent steps.
    share = (1.0 - phi * theta) * (phi - theta) / (phi * (1.0 + theta**2 - 2.0 * phi * theta))
    noise = Noise(memory_s, colour)
    assert noise.coloured_share(STEP_S) == pytest.approx(share, rel=1e-9)
    again = noise.with_share(share, STEP_S)
    assert (again.memory_s, again.colour) == (memory_s, pytest.approx(colour, rel=1e-6))


@pytest.mark.parametrize("noise", [WHITE, Noise(0.15, 0.4)])
def test_innovation_cost_is_minus_twice_the_profile_log_likelihood(noise: Noise) -> None:
    steps = [STEP_S, 0.05]
    runs = [white(2, 0.5, 300), white(3, 1.0, 200)]
    masks = [everywhere(300), np.random.default_rng(4).random(200) < 0.7]
    parts = zip(runs, steps, masks, strict=True)
    e = np.concatenate([arma_innovations(r, step, noise)[m] for r, step, m in parts])
    sd = float(np.sqrt(np.mean(e**2)))
    minus_twice = float(np.sum((e / sd) ** 2 + 2.0 * np.log(sd)))
    assert innovation_cost(noise, runs, steps, masks) == pytest.approx(minus_twice - len(e))


@pytest.mark.parametrize("seed", range(6))
def test_noise_estimated_from_white_noise_is_white(seed: int) -> None:
    assert estimate_noise([white(seed, 0.4, 4000)], [STEP_S], [everywhere(4000)]) == WHITE


@pytest.mark.parametrize("seed", [0, 3])
def test_likelihood_of_the_noise_estimate_reaches_the_maximum_over_a_grid(seed: int) -> None:
    random = np.random.default_rng(seed)
    slow = [autoregressive(10 * seed + k, random.uniform(0.08, 0.4), 0.3, 3000) for k in (0, 1)]
    runs = [noise + white(k, 0.3, 3000) for k, noise in enumerate(slow)]
    masks, steps = [random.random(3000) > 0.1 for _ in runs], [STEP_S, 1.5 * STEP_S]

    def cost(noise: Noise) -> float:
        return innovation_cost(noise, runs, steps, masks)

    grid = [Noise(m, c) for m in np.geomspace(0.04, 0.6, 25) for c in np.linspace(0.01, 0.99, 50)]
    assert cost(estimate_noise(runs, steps, masks)) < min(map(cost, grid)) + 0.1


def test_estimated_memory_is_not_below_two_of_the_shortest_steps() -> None:
    fast = autoregressive(5, 0.022, 1.0, 8000)
    slower = autoregressive(6, 0.02, 1.0, 8000, 3.0 * STEP_S)
    found = estimate_noise([fast, slower], [STEP_S, 3.0 * STEP_S], [everywhere(8000)] * 2)
    assert 2.0 * STEP_S < found.memory_s < 2.2 * STEP_S


@pytest.mark.parametrize(("step_s", "longest_s"), [(0.02, 0.6), (0.2, 0.8)])
def test_estimated_memory_is_limited_to_600_ms_or_four_steps(
    step_s: float, longest_s: float
) -> None:
    slow = autoregressive(6, 10.0 * longest_s, 1.0, 4000, step_s) + white(7, 0.3, 4000)
    found = estimate_noise([slow], [step_s], [everywhere(4000)])
    assert 0.9 * longest_s < found.memory_s < 1.0001 * longest_s


@pytest.mark.parametrize(("sd", "seed"), [(0.1, 17), (0.1, 3), (0.095, 16), (0.11, 0)])
def test_coloured_noise_is_estimated_only_if_deviance_falls_by_twenty(sd: float, seed: int) -> None:
    """The gain is maximised by a simplex (Nelder & Mead 1965); these cases lie within 1 of 20."""
    kicks = np.random.default_rng(seed).normal(0.0, sd * np.sqrt(1.0 - 0.85**2), 3000)
    slow = np.asarray(signal.lfilter([1.0], [1.0, -0.85], kicks))
    residual, every = [slow + white(100 + seed, 0.4, 3000)], [everywhere(3000)]

    def cost(x: Array) -> float:
        memory_s, colour = np.exp(x).tolist()
        if not (2.0 * STEP_S <= memory_s <= 0.6 and colour < 1.0):
            return np.inf
        return innovation_cost(Noise(memory_s, colour), residual, [STEP_S], every)

    grid = [np.log([m, c]) for m in np.geomspace(0.05, 0.5, 5) for c in np.geomspace(0.01, 0.2, 5)]
    best = optimize.minimize(cost, min(grid, key=cost), method="Nelder-Mead")
    gain = innovation_cost(WHITE, residual, [STEP_S], every) - float(best.fun)
    assert 19.0 < gain < 21.0
    assert estimate_noise(residual, [STEP_S], every).white == (gain < 20.0)


def test_coloured_part_of_estimated_noise_is_limited_to_the_largest_noise() -> None:
    n, every = 6000, [everywhere(6000)]
    residual = autoregressive(3, 0.4, 1.0, n) + white(4, 0.5, n)
    free = estimate_noise([residual], [STEP_S], every)
    assert free.coloured_share(STEP_S) == pytest.approx(0.8, abs=0.06)
    limited = estimate_noise([residual], [STEP_S], every, 0.6)
    share = 0.36 / float(np.mean(residual**2))
    assert limited.coloured_share(STEP_S) == pytest.approx(share, rel=1e-6)
    assert limited.memory_s == free.memory_s
    assert estimate_noise([residual], [STEP_S], every, 5.0) == free


def test_periodic_model_error_is_not_taken_for_coloured_noise() -> None:
    """An unmodelled mass that oscillates once a second: repetitions reveal noise of 0.1 N."""
    options: dict[str, Any] = {"rate": 2.0 * np.pi, "noise_rms": 0.1}
    runs = [
        one_way("forth", mass(1.5), seed=1, **options),
        one_way("back", mass(1.5), direction=-1.0, seed=2, **options),
    ]
    fitted = fit(Rig(), runs, law="coulomb")
    assert fitted.rms > 0.2
    share = 0.1**2 / fitted.rms**2
    assert fitted.noise.coloured_share(STEP_S) == pytest.approx(share, rel=0.2)


def test_noise_of_a_model_is_estimated_from_included_samples() -> None:
    slow = [autoregressive(i, 0.2, 0.3, 501) for i in range(4)]
    plain = zip(four_runs(coulomb, noise_rms=0.1), slow, strict=True)
    runs = [replace(run, friction=run.friction + noise) for run, noise in plain]
    problem = coulomb_problem(runs)
    samples = problem.campaign.samples.within([np.arange(len(r)) > 150 for r in runs])
    values = values_of(problem)
    residuals = problem.residuals(values)
    kept = [np.where(c, r, 0.0) for r, c in zip(residuals, samples.counted, strict=True)]
    wanted = estimate_noise(kept, samples.steps_s, samples.counted)
    assert not wanted.white
    assert noise_at(problem, samples, values) == wanted
    # Given residuals are used, regardless of their values at samples that are not counted.
    wild = [np.where(c, r, 1e3) for r, c in zip(residuals, samples.counted, strict=True)]
    slopes = [np.zeros((len(r), 0)) for r in wild]
    assert noise_at(problem, samples, values, (wild, slopes)) == wanted


def test_random_effect_of_a_run_is_not_taken_for_coloured_noise() -> None:
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 0.5 * np.sign(v), noise_rms=0.1)
    problem = coulomb_problem(runs)
    samples, values = problem.campaign.samples, values_of(problem)
    assert not noise_at(problem, samples, values).white
    between = RandomEffects(("zero",), tuple(np.full((len(r), 1), 0.5) for r in runs), 0.1)
    assert noise_at(problem, replace(samples, between=between), values) == WHITE


def floor_of(rig: Rig, runs: list[Run]) -> float:
    prepared = Campaign.prepare(rig, runs)
    return noise_floor(prepared.prepared, prepared.samples)


def largest_of(*runs: Run) -> float | None:
    prepared = Campaign.prepare(Rig(), list(runs))
    return noise_upper_bound(prepared.prepared, prepared.samples)


def with_rests(noise: Array, name: str = "rests") -> Run:
    """Motion without a period in the first 400 samples, then a rest with the given noise."""
    n = 400 + len(noise)
    t = STEP_S * np.arange(n)
    v = np.where(t < 400 * STEP_S, 0.1 + 0.03 * np.sin(1.3 * t) + 0.02 * np.sin(0.7 * t**1.5), 0.0)
    # White noise of 0.05 N during motion.
    force = 3.0 + 20.0 * v + np.concatenate([white(1, 0.05, 400), noise])
    return Run.from_arrays(t, v, force, name=name)


@pytest.mark.parametrize(("coloured", "whole"), [(False, 1.0), (True, np.sqrt(1.25))])
def test_noise_floor_of_simulated_runs_is_their_noise_rms(coloured: bool, whole: float) -> None:
    """The coloured part has a quarter of the variance of the white part; repetitions reveal it."""
    simulated = (campaign(seed, coloured=coloured) for seed in (3, 4))
    ratios = [floor_of(rig, runs) / truth["noise_n"] for rig, runs, truth in simulated]
    assert np.mean(ratios) == pytest.approx(whole, rel=0.06)


@pytest.mark.parametrize("over_noise", [1.0, 2.0, 4.0])
def test_noise_floor_of_quantised_readings_includes_quantisation_error(over_noise: float) -> None:
    """The rounding error is uniform, with a variance of a twelfth of the squared step (Widrow
    1956)."""
    rig, runs, truth = campaign(6)
    step = over_noise * truth["noise_n"]
    coarse = [replace(run, friction=step * np.round(run.friction / step)) for run in runs]
    expected = np.hypot(truth["noise_n"], step / np.sqrt(12.0))
    assert floor_of(rig, coarse) == pytest.approx(expected, rel=0.15)


def test_largest_noise_at_rest_is_the_scatter_about_a_line_through_each_rest() -> None:
    """The first quarter of a rest may be a transient; the line has two parameters."""
    noises = [0.02 * np.arange(n) + autoregressive(n, 0.3, 0.2, n) for n in (250, 450)]
    runs = [with_rests(noise, f"{i}") for i, noise in enumerate(noises)]
    total = count = 0.0
    for p in Campaign.prepare(Rig(), runs).prepared:
        rest = np.flatnonzero(p.motion.resting)
        assert 240 < len(rest) == rest[-1] - rest[0] + 1
        part = p.friction[rest[len(rest) // 4 :]]
        place = np.arange(len(part))
        off = part - np.polyval(np.polyfit(place, part, 1), place)
        total += float(off @ off) / (len(part) - 2) * len(part)
        count += len(part)
    assert largest_of(*runs) == pytest.approx(np.sqrt(total / count), rel=1e-9)


@pytest.mark.parametrize(("length", "known"), [(360, False), (440, True)])
def test_largest_noise_requires_three_hundred_samples_at_rest(length: int, known: bool) -> None:
    """Three quarters of a rest are used."""
    assert (largest_of(with_rests(white(7, 0.05, length))) is not None) == known


@pytest.mark.parametrize(("times", "taken"), [(1.0, False), (2.0, True), (4.0, False)])
def test_coloured_noise_raises_the_noise_floor_only_to_a_limit(times: float, taken: bool) -> None:
    """A coloured part above three times the white one is not attributed to the instrument."""
    slow = autoregressive(2, 2.0, 0.05 * np.sqrt(times**2 - 1.0) + 1e-9, 8000)
    run = with_rests(slow + white(3, 0.05, 8000))
    found, largest = floor_of(Rig(), [run]), largest_of(run)
    assert largest == pytest.approx(0.05 * times, rel=0.2)
    assert found == pytest.approx(largest if taken else 0.05, rel=1e-12 if taken else 0.15)


def stop_and_go(seed: int, step_s: float, ripple_n: float, count_m: float) -> Run:
    """Strokes of 50 mm/s with rests, a ripple of 2 mm pitch, and white noise of 0.1 N."""
    t = step_s * np.arange(round(24.0 / step_s))
    phase, forward = np.mod(t, 1.2), np.mod(t, 2.4) < 1.2
    height = np.clip(np.minimum(phase - 0.5, 1.2 - phase) / 0.1, 0.0, 1.0)
    v = 0.05 * height * np.where(forward, 1.0, -1.0)
    x = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * step_s)))
    force = (5.0 + ripple_n * np.sin(2.0 * np.pi * x / 2e-3)) * np.sign(v) + 20.0 * v
    noisy = force + white(seed, 0.1, len(t))
    path = count_m * np.round(x / count_m)
    return Run.from_arrays(t, friction=noisy, position_m=path, name=f"{seed}")


@pytest.mark.parametrize(("step_s", "count_m"), [(0.002, 5e-6), (0.002, 1e-6), (0.008, 1e-6)])
@pytest.mark.parametrize("ripple_n", [0.0, 0.5])
def test_noise_floor_excludes_a_ripple_and_the_start_of_a_motion_after_a_rest(
    step_s: float, count_m: float, ripple_n: float
) -> None:
    """Five or 20 samples a ripple; a motion of less than a count is not visible to the encoder."""
    runs = [stop_and_go(seed, step_s, ripple_n, count_m) for seed in range(2)]
    assert floor_of(Rig(), runs) == pytest.approx(0.1, rel=0.05)


def repeated(noise: Array, period: int) -> Run:
    t = STEP_S * np.arange(len(noise))
    v = 0.1 + 0.05 * np.sin(2.0 * np.pi * np.arange(len(noise)) / period)
    return Run.from_arrays(t, v, 5.0 + 20.0 * v + noise, name="repeated")


def test_largest_noise_includes_coloured_noise_if_the_motion_repeats() -> None:
    noises = (autoregressive(s, 0.2, 0.3, 6000) + white(s, 0.1, 6000) for s in range(4))
    found = [largest_of(repeated(noise, 313)) for noise in noises]
    assert np.mean(np.array(found, dtype=float)) == pytest.approx(np.hypot(0.3, 0.1), rel=0.05)
