"""Squares of residuals over a grid of lateness, beside a brute-force computation of them."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.lateness import CLIPPED, _drift, _on_time, _Place, _scans, _valley, instants_of
from jbf.estimation.likelihood import independent_share
from jbf.estimation.noise import WHITE
from made_of import record, samples_of

module = sys.modules["jbf.estimation.lateness"]
N, STEP_S = 240, 1.0 / 64.0
LATE_S = (3e-3, -2e-3)
GRID = np.arange(-5, 6) * 1e-3


def force(time: Array, run: int) -> Array:
    found: Array = 5.0 * np.sin((3.0 + run) * time) + 2.0 * np.cos(7.0 * time)
    return found


class Two:
    """Two runs whose readings are late, in noise with some wild samples; a law that knows their
    force."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, begins_s: float = 5.0) -> None:
        self.runs = []
        random = np.random.default_rng(1)
        for i, late in enumerate(LATE_S):
            time = begins_s + STEP_S * np.arange(N)
            noise = 0.02 * random.standard_normal(N)
            noise[[30, 90, 200]] += 4.0
            run = record(time, name="ab"[i], friction=force(time - late, i) + noise)
            run.motion.sign_known = np.ones(N, dtype=bool)
            run.motion.sign_known[[60, 61, 180 + 5 * i]] = False
            self.runs.append(run)
        counted = [p.motion.sign_known & (np.arange(N) != 120) for p in self.runs]
        weight = [np.where(np.arange(N) % 3 == 0, 0.5, 1.0) * c for c in counted]
        self.samples = samples_of(self.runs, counted, weight)
        monkeypatch.setattr(module, "fine_motion", lambda p: p)
        chain = SimpleNamespace(predict=self.predict)
        self.problem: Any = SimpleNamespace(
            campaign=SimpleNamespace(prepared=self.runs), chain=chain
        )

    def predict(self, values: Any, motions: Any) -> list[Array]:
        (p,) = motions
        return [force(instants_of(p), self.runs.index(p))]

    def lines(self, i: int, late: float) -> Array:
        """The law's force so late, drawn in lines between its instants."""
        p = self.runs[i]
        instants = instants_of(p)
        found: Array = np.interp(p.run.time_s - late, instants, force(instants, i))
        return found

    def solution(self, **more: Any) -> Any:
        residuals = [p.friction_n - self.lines(i, 0.0) for i, p in enumerate(self.runs)]
        given = {"residuals": residuals, "samples": self.samples, "noise": WHITE, "values": None}
        return SimpleNamespace(**{**given, **more})

    def slopes(self) -> list[Array]:
        found = []
        for i, p in enumerate(self.runs):
            instants = instants_of(p)
            slope = np.gradient(force(instants, i), instants)
            found.append(np.interp(p.run.time_s, instants, slope))
        return found


@pytest.mark.parametrize(("reach", "width"), [(0.0, -1), (5e-3, 1), (1.0 / 32.0, 2), (0.04, 3)])
def test_each_lateness_is_tried_on_the_same_samples(
    reach: float, width: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those that count and that no reversal comes nearer than the reach; residuals are weighed,
    told in deviations of the best lateness, and cut."""
    two = Two(monkeypatch)
    found = list(_scans(two.problem, two.solution(), GRID, reach))
    assert len(found) == 2
    left = _on_time(two.problem, two.solution(), two.slopes())
    share = independent_share(left, two.samples.steps_s)
    for i, (squares, time) in enumerate(found):
        unknown = np.flatnonzero(~two.runs[i].motion.sign_known)
        near = np.abs(np.arange(N)[:, None] - unknown[None, :]).min(axis=1)
        kept = two.samples.counted[i] & (near > width)
        e = np.array(
            [
                ((two.runs[i].friction_n - two.lines(i, late)) * two.samples.weight[i])[kept]
                for late in GRID
            ]
        )
        size = min(float(np.median(np.abs(row))) for row in e) / 0.6745
        assert squares == pytest.approx(share * np.minimum((e / size) ** 2, 3.5**2))
        assert squares.max() == pytest.approx(share * CLIPPED**2)
        assert time == pytest.approx((STEP_S * np.arange(N))[kept])
        # The least is where the readings are late by.
        assert GRID[np.argmin(squares.sum(axis=1))] == pytest.approx(LATE_S[i])


def test_a_zero_of_a_runs_own_is_no_lateness(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is known to differ from run to run is taken off the readings before they are asked."""
    two = Two(monkeypatch)
    usual = [s for s, _ in _scans(two.problem, two.solution(), GRID, 0.04)]
    for p, zero in zip(two.runs, (7.0, -4.0), strict=True):
        p.friction_n = p.friction_n + zero
    off = [s for s, _ in _scans(two.problem, two.solution(), GRID, 0.04)]
    assert not np.allclose(off[0], usual[0])
    known = SimpleNamespace(**vars(two.samples))
    known.without_deviations = lambda residuals, noise: [
        r - z for r, z in zip(residuals, (7.0, -4.0), strict=True)
    ]
    found = [s for s, _ in _scans(two.problem, two.solution(samples=known), GRID, 0.04)]
    for one, other in zip(found, usual, strict=True):
        assert one == pytest.approx(other, rel=1e-6)


def test_residuals_that_are_nothing_or_not_there_have_squares_of_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    two = Two(monkeypatch)
    for i, p in enumerate(two.runs):
        p.friction_n = two.lines(i, 0.0)
    # At one lateness more than half of the samples are met exactly: no size tells the others'.
    for squares, _ in _scans(two.problem, two.solution(), GRID, 0.04):
        assert not squares.any()
    none = samples_of(two.runs, [np.zeros(N)] * 2)
    for squares, time in _scans(two.problem, two.solution(samples=none), GRID, 0.04):
        assert squares.shape == (len(GRID), 0)
        assert time.shape == (0,)


@pytest.mark.parametrize("begins_s", [0.0, 1e3])
def test_what_a_lateness_makes_of_residuals_is_not_their_colour(
    begins_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To first order, in a lateness and its growth, by least squares over the samples that count;
    zero at the others."""
    two = Two(monkeypatch, begins_s)
    solution, slopes = two.solution(), two.slopes()
    found = _on_time(two.problem, solution, slopes)
    for left, r, slope, p, c in zip(
        found, solution.residuals, slopes, two.runs, two.samples.counted, strict=True
    ):
        assert not left[~c].any()
        x = np.stack([slope, slope * (p.run.time_s - begins_s)], axis=1)[c]
        wanted = r[c] - x @ np.linalg.lstsq(x, r[c], rcond=None)[0]
        assert left[c] == pytest.approx(wanted, abs=1e-9)
    # A lateness that grows is all of it, but for its second order.
    times = [p.run.time_s - begins_s for p in two.runs]
    late = [s * (2e-3 + 1e-4 * t) for s, t in zip(slopes, times, strict=True)]
    for left in _on_time(two.problem, two.solution(residuals=late), slopes):
        assert left == pytest.approx(np.zeros(N), abs=1e-9)


def test_a_sample_at_an_edge_belongs_to_the_part_behind_it() -> None:
    """181 samples are three parts of sixty, and one that is in none."""
    time = np.arange(181.0)
    asked: list[tuple[int, float]] = []

    def tell(grid: Array, costs: Array, count: int) -> _Place:
        asked.append((count, float(costs[0])))
        return _Place(0.0, np.inf)

    squares = np.tile(time, (3, 1))
    assert _drift(np.arange(3.0), squares, time, tell).variance == np.inf
    wanted = [(60, float(np.sum(np.arange(60 * k, 60 * k + 60)))) for k in range(3)]
    assert asked == wanted


def test_a_valley_of_any_depth_is_the_same() -> None:
    """Squares of ten thousand samples: a likelihood of e to the minus ten thousand."""
    grid = np.linspace(-0.04, 0.04, 41)
    bowl = 5e4 * (grid - 0.003) ** 2
    deep = _valley(grid, bowl + 1e4, 10000)
    assert deep.value == pytest.approx(_valley(grid, bowl, 10000).value, abs=1e-9)
    assert np.isfinite(deep.variance)
