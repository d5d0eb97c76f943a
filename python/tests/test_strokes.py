"""A level of its own for each stroke is found; noise, and errors alike in all strokes, are none."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from campaigns import campaign
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.strokes import find_stroke_levels, stroke_of
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import approach, settle
from jbf.estimation.noise import Noise
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from scipy import signal

Array = npt.NDArray[np.float64]
SIGMA_N = 0.3


@cache
def _solved() -> tuple[Problem, Solution, list[Array]]:
    rig, runs, _ = campaign(7)
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", ())
    solution = settle(problem, approach(problem, [{}], 8))
    return problem, solution, problem.predict(solution.values)


def _found(residuals: list[Array]) -> list[Remainder]:
    problem, solution, _ = _solved()
    other = replace(solution, residuals=residuals, noise=Noise())
    return find_stroke_levels(problem, other, DEFAULT)


def _noise(seed: int, memory: float = 0.0) -> list[Array]:
    random = np.random.default_rng(seed)
    return [
        signal.lfilter([SIGMA_N], [1.0, -memory], random.standard_normal(len(f)))
        for f in _solved()[2]
    ]


def _levels(share: float, seed: int) -> list[Array]:
    """What a level of its own for each stroke adds, N."""
    random = np.random.default_rng(seed)
    problem, _, friction = _solved()
    added = []
    for p, f in zip(problem.campaign.prepared, friction, strict=True):
        stroke = stroke_of(p)
        levels = share * random.standard_normal(int(stroke.max()) + 1)
        added.append(np.where(stroke >= 0, f * levels[stroke], 0.0))
    return added


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_noise_is_none(memory: float) -> None:
    for seed in range(10):
        assert _found(_noise(seed, memory)) == []


def test_each_stroke_its_own_level() -> None:
    for seed in range(5):
        (found,) = _found([n + a for n, a in zip(_noise(seed), _levels(0.08, seed), strict=True)])
        assert found.axis == "stroke"
        told = re.search(r"by ([\d.]+) % from stroke to stroke", found.where)
        assert told is not None
        assert float(told[1]) == pytest.approx(8.0, rel=0.5)
        assert 0.05 < found.share < 1.0


def test_the_ratio_is_fishers_f() -> None:
    """Between strokes of a run and between their halves, each with one degree less than strokes."""
    problem, _, friction = _solved()
    residuals = [n + a for n, a in zip(_noise(1), _levels(0.08, 1), strict=True)]
    between, within, free = 0.0, 0.0, 0
    for p, f, r in zip(problem.campaign.prepared, friction, residuals, strict=True):
        counted = problem.campaign.samples.counted[problem.campaign.prepared.index(p)]
        halves = []
        for k in range(int(stroke_of(p).max()) + 1):
            rows = np.flatnonzero((stroke_of(p) == k) & counted)
            if len(rows) >= 16:
                halves.append([(f[h] @ f[h], f[h] @ r[h]) for h in np.array_split(rows, 2)])
        if len(halves) < 3:
            continue
        w, pull = np.moveaxis(np.array(halves), 2, 0)
        slope = pull.sum(1) / w.sum(1)
        between += float(np.cov(slope, aweights=w.sum(1), ddof=0) * w.sum())
        apart, own = pull[:, 1] / w[:, 1] - pull[:, 0] / w[:, 0], w.prod(1) / w.sum(1)
        within += float(np.cov(apart, aweights=own, ddof=0) * own.sum())
        free += len(halves) - 1
    assert free < 60
    (found,) = _found(residuals)
    told = re.search(r"\((\d+) times as much as within one", found.where)
    assert told is not None
    assert int(told[1]) == round(between / within)
    share = (between - within) / sum(float(np.sum(r[c] ** 2)) for r, c in
        zip(residuals, problem.campaign.samples.counted, strict=True))  # fmt: skip
    assert found.share == pytest.approx(share)


def test_what_is_alike_in_all_strokes_is_none() -> None:
    problem, _, friction = _solved()
    for seed in range(5):
        noise = _noise(seed)
        by_run = [
            n + 0.05 * (i % 3) * f for i, (n, f) in enumerate(zip(noise, friction, strict=True))
        ]
        assert _found(by_run) == []
        by_speed = [
            n + 20.0 * np.sin(30.0 * p.motion.velocity_m_s) * np.abs(p.motion.velocity_m_s)
            for n, p in zip(noise, problem.campaign.prepared, strict=True)
        ]
        assert _found(by_speed) == []


def test_strokes_end_where_the_motion_turns_round() -> None:
    for p in _solved()[0].campaign.prepared:
        stroke = stroke_of(p)
        signs = [set(np.sign(p.motion.velocity_m_s[stroke == k])) for k in range(stroke.max() + 1)]
        assert all(len(s) == 1 for s in signs)
        assert all(a != b for a, b in itertools.pairwise(signs))
