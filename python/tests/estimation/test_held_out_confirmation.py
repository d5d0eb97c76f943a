"""Confirmation of an effect by held-out runs, in linear models whose fits are regressions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array
from jbf.diagnosis.confirmation import Confirmation
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.left_out import LeftOut
from jbf.estimation.noise import WHITE
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution

COUNT, RUNS = 400, 5
EVERY = np.ones(COUNT, dtype=bool)
SAMPLES = Samples(tuple("abcde"), (0.02,) * RUNS, (EVERY,) * RUNS, (np.ones(COUNT),) * RUNS)
WEAK = DEFAULT.weak
Linear = tuple[list[Array], list[Array], list[Array]]
"""Derivatives by the parameters of the law and of the effect, and noise; one array for each run."""


def fitted(design: Sequence[Array], force: Sequence[Array]) -> tuple[Solution, list[LeftOut]]:
    """Least squares of all runs, and without each run."""

    def values(runs: Sequence[int]) -> Array:
        x = np.concatenate([design[i] for i in runs])
        y = np.concatenate([force[i] for i in runs])
        return np.asarray(np.linalg.lstsq(x, y, rcond=None)[0])

    every = values(range(RUNS))
    residuals = [y - x @ every for x, y in zip(design, force, strict=True)]
    solution = Solution((), every, residuals, list(design), WHITE, 0.0, True, "", SAMPLES)
    determined = np.ones(len(every), dtype=bool)
    parts = []
    for i in range(RUNS):
        rest = values([k for k in range(RUNS) if k != i])
        parts.append(LeftOut((i,), (EVERY,), determined, (force[i] - design[i] @ rest,)))
    return solution, parts


def confirmation(
    law: Sequence[Array], own: Sequence[Array], force: Sequence[Array]
) -> Confirmation:
    """An effect with derivatives `own` added to a law."""
    simpler, held_out = fitted(law, force)
    both = [np.column_stack(columns) for columns in zip(law, own, strict=True)]
    richer, richer_held_out = fitted(both, force)
    return Confirmation.of(simpler, richer, held_out, richer_held_out)


def linear(seed: int, times: int) -> list[Linear]:
    """Laws of two parameters, the second of which only the first run determines well."""
    random = np.random.default_rng(seed)
    made = []
    for _ in range(times):
        own = [random.standard_normal(COUNT) for _ in range(RUNS)]
        law = [random.standard_normal((COUNT, 2)) for _ in range(RUNS)]
        for i in range(RUNS):
            law[i][:, 1] *= 1.0 if i == 0 else 0.02
            law[i][:, 1] += 0.004 * own[i] if i else 0.0
        made.append((law, own, [random.standard_normal(COUNT) for _ in range(RUNS)]))
    return made


def effect(size: float, own: Sequence[Array], noise: Sequence[Array]) -> list[Array]:
    """The force of an effect of the same size in all runs."""
    return [e + size * o for e, o in zip(noise, own, strict=True)]


def test_effect_is_confirmed_even_if_one_run_is_needed_to_determine_the_law() -> None:
    confirmed = better = 0
    for law, own, noise in linear(11, 60):
        found = confirmation(law, own, effect(0.13, own, noise))
        confirmed += found.confirms(WEAK, np.inf, DEFAULT)
        better += found.after_n < found.before_n
    assert confirmed >= 54
    # The held-out RMS does not decrease in many of them.
    assert better < 50


def test_effect_in_one_run_only_is_not_confirmed() -> None:
    refused = 0
    for law, own, noise in linear(12, 60):
        force = [e + 0.5 * (i == 0) * o for i, (e, o) in enumerate(zip(noise, own, strict=True))]
        refused += not confirmation(law, own, force).confirms(WEAK, np.inf, DEFAULT)
    assert refused >= 57


def test_density_share_of_an_effect_equal_in_all_runs_follows_from_its_noncentrality() -> None:
    """Expected: (z - 1) / (z + 1) with the noncentrality z = size^2 n."""
    shares = []
    for law, own, noise in linear(13, 60):
        found = confirmation([x[:, :1] for x in law], own, effect(0.13, own, noise))
        shares.append(found.density)
    z = 0.13**2 * COUNT * RUNS
    assert np.mean(shares) == pytest.approx((z - 1.0) / (z + 1.0), abs=0.02)


def test_confirmation_reports_held_out_rms_and_the_share_of_improved_runs() -> None:
    law, own, noise = linear(14, 1)[0]
    force = effect(0.1, own, noise)
    found = confirmation(law, own, force)
    simpler = fitted(law, force)[1]
    richer = fitted([np.column_stack(c) for c in zip(law, own, strict=True)], force)[1]
    squares = np.array(
        [[np.mean(p.residuals[0] ** 2) for p in parts] for parts in (simpler, richer)]
    )
    assert found.before_n == pytest.approx(np.sqrt(squares[0].mean()), rel=1e-12)
    assert found.after_n == pytest.approx(np.sqrt(squares[1].mean()), rel=1e-12)
    assert found.better == np.mean(squares[1] < squares[0])


def test_models_are_compared_at_the_samples_that_count_in_both() -> None:
    law, own, noise = linear(15, 1)[0]
    wild = [np.where(np.arange(COUNT) < 20, 30.0, 0.0) + e for e in noise]
    fewer = replace(SAMPLES, counted=(np.arange(COUNT) >= 20,) * RUNS)
    simpler, held_out = fitted(law, wild)
    richer, richer_held_out = fitted([np.column_stack(c) for c in zip(law, own, strict=True)], wild)
    less = Confirmation.of(simpler, replace(richer, samples=fewer), held_out, richer_held_out)
    every = Confirmation.of(simpler, richer, held_out, richer_held_out)
    assert less.before_n < 0.7 * every.before_n
    assert less.after_n == pytest.approx(less.before_n, rel=0.15)
