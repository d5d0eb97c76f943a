"""Noise of other campaigns, by turning signs, and the stroke of a campaign: in small numbers."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.solution import Solution
from jbf.estimation.stroke import BEYOND, SHORTEST_M, stroke
from jbf.estimation.wild_bootstrap import _errors
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
N = 400


def made(
    residuals: list[Array], counted: list[npt.NDArray[Any]], noise: Noise = WHITE
) -> tuple[Solution, Any]:
    """A solution whose samples have little weight: their noise is as large as it is."""
    prepared = [record(0.02 * np.arange(len(r)), name="abc"[i]) for i, r in enumerate(residuals)]
    weight = [np.where(c, 0.25, 0.0) for c in counted]
    samples = samples_of(prepared, counted, weight)
    jacobian = [np.zeros((len(r), 1)) for r in residuals]
    found = Solution((), np.zeros(1), residuals, jacobian, noise, 0.0, True, "", samples)
    campaign: Any = SimpleNamespace(prepared=prepared)
    return found, campaign


def test_what_counts_keeps_its_size_and_signs_turn_block_by_block() -> None:
    """Blocks of a second, of fifty samples; none spans two runs."""
    residuals = [np.random.default_rng(i).standard_normal(N + 25 * i) for i in range(2)]
    solution, campaign = made(residuals, [np.ones(len(r), dtype=bool) for r in residuals])
    turned = set()
    for seed in range(6):
        errors = _errors(solution, campaign, np.random.default_rng(seed))
        for e, r in zip(errors, residuals, strict=True):
            assert np.abs(e) == pytest.approx(np.abs(r))
            signs = np.sign(e * r)
            for k in range(0, len(r), 50):
                assert np.ptp(signs[k : k + 50]) == 0.0
            turned.add(tuple(signs[::50].tolist()))
    assert len(turned) > 6
    again = _errors(solution, campaign, np.random.default_rng(5))
    assert np.array_equal(again[1], errors[1])


def test_what_does_not_count_is_drawn_from_what_does() -> None:
    size = np.arange(1.0, N + 1.0)
    counted = size > 100.0
    solution, campaign = made([np.where(counted, size, 1e6)], [counted])
    (errors,) = _errors(solution, campaign, np.random.default_rng(1))
    assert np.abs(errors[counted]) == pytest.approx(size[counted])
    assert set(np.abs(errors[~counted])) <= set(size[counted])
    assert len(set(np.abs(errors[~counted]))) > 50


def test_noise_that_remembers_does_so_again() -> None:
    noise = Noise(0.2, 0.5)
    kicks = np.random.default_rng(2).standard_normal(N)
    solution, campaign = made([noise.coloured(kicks, 0.02)], [np.ones(N, dtype=bool)], noise)
    (errors,) = _errors(solution, campaign, np.random.default_rng(3))
    assert np.abs(noise.innovations(errors, 0.02)) == pytest.approx(np.abs(kicks), abs=1e-9)


# ---- the stroke --------------------------------------------------------------------------------


def moved(places: list[Array], radius_m: float | None = None) -> Any:
    prepared = [
        record(0.02 * np.arange(len(x)), name="abc"[i], way=x) for i, x in enumerate(places)
    ]
    bearing = None if radius_m is None else SimpleNamespace(radius_m=radius_m)
    return SimpleNamespace(
        prepared=prepared, samples=samples_of(prepared), rig=SimpleNamespace(bearing=bearing)
    )


def test_a_stroke_goes_from_the_lowest_place_to_the_highest_and_a_little_beyond() -> None:
    assert (BEYOND, SHORTEST_M) == (0.1, 1e-9)
    places = [np.linspace(-0.1, 0.2, 50), np.linspace(0.0, 0.5, 50)]
    low, high = stroke(moved(places))
    more = max(BEYOND * 0.6, SHORTEST_M)
    assert (low, high) == pytest.approx((-0.1 - more, 0.5 + more))
    shaft = stroke(moved(places, radius_m=0.05))
    small = max(BEYOND * 0.03, SHORTEST_M)
    assert shaft == pytest.approx((-0.005 - small, 0.025 + small))
    still = stroke(moved([np.full(50, 0.3)]))
    assert still == pytest.approx((0.3 - SHORTEST_M, 0.3 + SHORTEST_M))
    nothing = moved(places)
    nothing.samples = samples_of(nothing.prepared, [np.zeros(50)] * 2)
    assert stroke(nothing) == (-SHORTEST_M, SHORTEST_M)
