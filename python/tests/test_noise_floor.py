"""The noise of a record by its rests and its repetitions, worked by hand to the last digit."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.noise_floor import most_noise, noise_floor
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.estimation.noise_floor"]


def sine(count: int, period: int) -> Array:
    """A motion that comes again after so many samples."""
    found: Array = np.sin(2.0 * np.pi * np.arange(count) / period)
    return found


def seen(*runs: Any) -> float | None:
    return most_noise(runs, samples_of(runs))


@pytest.mark.parametrize(
    ("white", "at_rest", "floor"),
    [
        (1.0, None, 1.0),
        (1.0, 0.5, 1.0),
        # As much more as 4 % is no clear excess, as much as three times is no noise.
        (1.0, 1.04, 1.0),
        (1.0, 1.041, 1.041),
        (1.0, 2.999, 2.999),
        (1.0, 3.0, 1.0),
        (1.0, 5.0, 1.0),
        (0.0, 1.0, 0.0),
    ],
)
def test_what_is_seen_is_the_floor_where_it_is_clearly_larger(
    white: float, at_rest: float | None, floor: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_white", lambda prepared, samples: white)
    monkeypatch.setattr(module, "_seen", lambda prepared, samples: at_rest)
    runs = [record(0.02 * np.arange(10))]
    assert noise_floor(runs, samples_of(runs)) == floor
    most = None if at_rest is None else max(at_rest, white)
    assert most_noise(runs, samples_of(runs)) == most


def test_rests_are_pooled_about_their_own_lines() -> None:
    """Of rests of 81 and 401 samples a quarter is left out; of what stays, 61 and 301, the squares
    about their lines are divided by what two parameters leave."""
    random = np.random.default_rng(1)
    force, resting = np.zeros(600), np.zeros(600)
    whole, count = 0.0, 0
    for first, length in ((20, 81), (150, 401)):
        resting[first : first + length] = 1.0
        # Slow enough that third differences see next to nothing.
        slow = np.cumsum(np.cumsum(random.standard_normal(length))) / length
        force[first : first + length] = slow
        part = slow[length // 4 :]
        place = np.arange(len(part))
        off = part - np.polyval(np.polyfit(place, part, 1), place)
        whole += float(off @ off) / (len(part) - 2) * len(part)
        count += len(part)
    assert count == 362
    run = record(0.02 * np.arange(600), friction=force, resting=resting)
    run.motion.velocity_m_s = np.linspace(0.1, 0.2, 600)
    assert seen(run) == pytest.approx(np.sqrt(whole / count), rel=1e-9)
    # A run with too few pairs a period apart has no say.
    assert seen(run, again(99, 120, [1.0] * 3, 33)) == seen(run)


def again(pairs: int, period: int, sizes: list[float], length: int) -> Any:
    """A run in which so many pairs of samples lie a period apart, behind the half of one that is
    left out; in each block of them the second is off by one size, up and down by turns."""
    begin = period // 2
    n = begin + period + pairs
    # Half of each block up, half down: its median is nothing, and it has next to no third
    # differences.
    side = np.sign(0.5 * (length - 1) - np.arange(length))
    off = np.concatenate([size * side for size in sizes])
    force = np.zeros(n)
    force[begin + period : begin + period + len(off)] = np.sqrt(2.0) * off
    return record(0.02 * np.arange(n), velocity=sine(n, period), friction=force)


def test_a_repetition_is_told_by_the_median_of_twelve_blocks() -> None:
    """1 N to 12 N: between 6 and 7, as a normal's median has it; half of them may do anything."""
    sizes = [float(k) for k in range(1, 13)]
    mixed = sizes[::2] + sizes[1::2]
    assert seen(again(1200, 1300, mixed, 100)) == pytest.approx(6.5 / 0.6745, rel=1e-9)
    wild = [*sizes[:7], *(1e3 * size for size in sizes[7:])]
    assert seen(again(1200, 1300, wild, 100)) == pytest.approx(6.5 / 0.6745, rel=1e-9)


def test_of_few_pairs_blocks_are_twenty_five_long() -> None:
    """Eight of 1 N to 8 N in each of two runs: between 4 and 5. What is left, a pair less than one
    more, is in none."""
    sizes = [2.0, 8.0, 1.0, 7.0, 3.0, 5.0, 4.0, 6.0]
    run = again(224, 240, sizes, 25)
    assert seen(run, run) == pytest.approx(4.5 / 0.6745, rel=1e-9)


@pytest.mark.parametrize(("runs", "pairs", "known"), [(4, 99, False), (3, 100, True)])
def test_a_hundred_pairs_of_a_run_and_three_hundred_in_all_tell_it(
    runs: int, pairs: int, known: bool
) -> None:
    every = [again(pairs, 120, [1.0] * 3, 33) for _ in range(runs)]
    assert (seen(*every) is not None) == known
