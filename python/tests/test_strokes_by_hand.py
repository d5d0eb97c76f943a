"""Strokes of made-up motions and their halves: sums by hand."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.strokes import LEAST_SAMPLES, LEAST_STROKES, find_stroke_levels, stroke_of
from jbf.estimation.noise import WHITE
from made_of import record, samples_of
from scipy import stats

Array = npt.NDArray[np.float64]


def strokes(lengths: list[int], name: str = "a") -> Any:
    """A run of strokes to and fro."""
    v = np.concatenate([np.full(n, 0.1 * (-1.0) ** k) for k, n in enumerate(lengths)])
    return record(0.02 * np.arange(len(v)), name=name, velocity=v)


def test_a_stroke_ends_where_the_motion_turns_round() -> None:
    assert stroke_of(strokes([3, 2, 4])).tolist() == [0, 0, 0, 1, 1, 2, 2, 2, 2]
    v = np.array([0.0, 0.1, 0.1, 0.0, 0.1, -0.1, 0.0, -0.1, 0.2])
    rests = record(0.02 * np.arange(9), velocity=v, resting=v == 0.0)
    # A rest between two ways that are one parts no strokes.
    assert stroke_of(rests).tolist() == [-1, 0, 0, -1, 0, 1, -1, 1, 2]
    still = record(0.02 * np.arange(4), velocity=np.zeros(4), resting=np.ones(4))
    assert stroke_of(still).tolist() == [-1] * 4


def test_what_is_not_known_to_move_is_in_no_stroke() -> None:
    """Beside a reversal, and at rest, though the encoder knows which way it lies."""
    run = strokes([3, 3])
    run.motion.sign_known = np.array([1, 1, 0, 0, 1, 1], dtype=bool)
    assert stroke_of(run).tolist() == [0, 0, -1, -1, 1, 1]
    run.motion.resting = np.array([0, 1, 0, 0, 0, 0], dtype=bool)
    assert stroke_of(run).tolist() == [0, -1, -1, -1, 1, 1]


def told(
    prepared: list[Any], residuals: list[Array], friction: list[Array], **policy: Any
) -> list[Remainder]:
    problem: Any = SimpleNamespace(
        predict=lambda values: friction, campaign=SimpleNamespace(prepared=prepared)
    )
    solution: Any = SimpleNamespace(
        values=None, residuals=residuals, noise=WHITE, samples=samples_of(prepared)
    )
    return find_stroke_levels(problem, solution, replace(DEFAULT, **policy))


def levels(shares: list[float], wobble: float, size: float = 5.0, each: int = 40) -> Any:
    """Strokes whose friction is higher by these shares, and in their second halves by `wobble`
    more and less, in turn."""
    run = strokes([each] * len(shares))
    friction = size * np.sign(run.motion.velocity_m_s)
    more = np.repeat(shares, each)
    half = np.where(np.arange(len(more)) % each < each // 2, -0.5, 0.5)
    turns = np.repeat([(-1.0) ** k for k in range(len(shares))], each)
    return [run], [friction * (more + wobble * half * turns)], [friction]


@pytest.mark.parametrize("size", [1e-3, 5.0, 1e3])
def test_levels_between_strokes_are_held_against_halves_within(size: float) -> None:
    """Six strokes of 40 samples each: the squares between them are 40 F^2 times those of the
    levels, within a quarter of that times those of the halves' distances."""
    shares, wobble = [0.1, -0.1, 0.08, -0.12, 0.09, -0.05], 0.002
    (found,) = told(*levels(shares, wobble, size))
    between = 40.0 * float(np.sum((np.array(shares) - np.mean(shares)) ** 2))
    within = 10.0 * 6.0 * wobble**2
    ratio = between / within
    square = 40.0 * float(np.sum(np.square(shares))) + 240.0 * (0.5 * wobble) ** 2
    assert found.axis == "stroke"
    assert found.share == pytest.approx((between - within) / square)
    words = re.search(r"by ([\d.]+) % from stroke to stroke \((\d+) times", found.where)
    assert words is not None
    spread = 100.0 * np.sqrt((between - within) / 240.0)
    assert float(words[1]) == pytest.approx(spread, rel=0.05)
    assert int(words[2]) == round(ratio)


@pytest.mark.parametrize(("part", "there"), [(0.97, False), (1.03, True)])
def test_a_ratio_is_beyond_fishers_f(part: float, there: bool) -> None:
    """Of five and five degrees of freedom."""
    shares = np.array([0.1, -0.1, 0.08, -0.12, 0.09, -0.05])
    least = stats.f.isf(DEFAULT.constancy_chance, 5, 5)
    between = 40.0 * float(np.sum((shares - np.mean(shares)) ** 2))
    wobble = float(np.sqrt(between / (60.0 * part * least)))
    assert bool(told(*levels(shares.tolist(), wobble))) == there


def test_levels_have_a_share_that_matters() -> None:
    (found,) = told(*levels([0.1, -0.1, 0.1, -0.1], 0.0001))
    given = levels([0.1, -0.1, 0.1, -0.1], 0.0001)
    run, residual, friction = given
    # Beside what no stroke knows: three times as large, and alike in all of them.
    loud = [residual[0] + 3.0 * np.where(np.arange(160) % 2, 1.0, -1.0)]
    (less,) = told(run, loud, friction)
    assert less.share < found.share
    for part, there in ((0.95, True), (1.0, True), (1.05, False)):
        assert bool(told(run, loud, friction, pattern_share=part * less.share)) == there


def test_few_or_short_strokes_tell_nothing() -> None:
    assert (LEAST_STROKES, LEAST_SAMPLES) == (3, 8)
    assert told(*levels([0.1, -0.1], 1e-6)) == []
    loose: dict[str, Any] = {"constancy_chance": 0.5}
    assert told(*levels([0.1, -0.1, 0.1], 1e-6, each=15), **loose) == []
    assert len(told(*levels([0.1, -0.1, 0.1], 1e-6, each=16), **loose)) == 1
    # A short stroke does not keep the longer ones from being looked at.
    run = strokes([10, 40, 40, 40])
    friction = 5.0 * np.sign(run.motion.velocity_m_s)
    level = np.repeat([0.0, 0.1, -0.1, 0.1], [10, 40, 40, 40])
    level = level + 1e-6 * (np.arange(130) % 7)
    assert len(told([run], [friction * level], [friction], **loose)) == 1
    # A run of few does not keep the next from being looked at.
    one, two = levels([0.1, -0.1], 1e-6), levels([0.1, -0.1, 0.1, -0.12], 1e-6)
    both = [[*a, *b] for a, b in zip(one, two, strict=True)]
    assert len(told(both[0], both[1], both[2], **loose)) == 1
    assert told(*levels([0.0] * 6, 0.0)) == []


def test_where_the_friction_is_larger_a_level_counts_for_more() -> None:
    """Halves of strokes whose friction differs: each level is known to one over the root of the
    squares there, and so are their distances."""
    sizes = np.array([[1.0, 2.0], [3.0, 1.0], [2.0, 2.0], [1.0, 4.0], [2.0, 1.0]])
    levels = np.array([0.1, -0.1, 0.12, -0.06, 0.02])
    apart = np.array([0.004, -0.002, 0.001, 0.003, -0.005])
    run = strokes([20] * 5)
    way = np.sign(run.motion.velocity_m_s)
    friction = way * np.repeat(sizes.ravel(), 10)
    off = np.stack([levels - 0.5 * apart, levels + 0.5 * apart], axis=1)
    left = [friction * np.repeat(off.ravel(), 10)]
    (found,) = told([run], left, [friction], constancy_chance=0.5)
    weight = 10.0 * sizes**2
    of_stroke = weight.sum(axis=1)
    level = (weight * off).sum(axis=1) / of_stroke
    between = np.sum(of_stroke * (level - np.average(level, weights=of_stroke)) ** 2)
    known = 1.0 / (1.0 / weight[:, 0] + 1.0 / weight[:, 1])
    within = np.sum(known * (apart - np.average(apart, weights=known)) ** 2)
    assert found.share == pytest.approx((between - within) / np.sum(weight * off**2))
