"""What is made of the lateness of runs: each by its own, one clock, all early, or nothing; of runs
whose squares over the grid are put together by hand."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.lateness import CLIPPED, FINE_S, RANGES, Lateness, instants_of, lateness
from made_of import record

module = sys.modules["jbf.estimation.lateness"]
N = 300
CHANCE = 1e-4


def told(
    monkeypatch: pytest.MonkeyPatch,
    late_s: Sequence[float],
    drift: float = 0.0,
    *,
    lasts_s: Sequence[float] = (20.0, 20.0, 20.0, 20.0),
    sd_s: float = 1e-4,
    look: int = 0,
    chance: float = CHANCE,
    at_jumps: bool = False,
) -> tuple[Lateness | None, Array, float]:
    """Runs that are late so in their middles, each known to `sd_s`; the grid that was asked for and
    its reach."""
    seen: list[Any] = []

    def scans(
        problem: Any, solution: Any, grid: Array, reach: float
    ) -> Iterator[tuple[Array, Array]]:
        seen.extend([grid, reach])
        for late, lasts in zip(late_s, lasts_s, strict=True):
            time = np.linspace(0.0, lasts, N)
            at = late + drift * (time - 0.5 * lasts)
            yield (grid[:, None] - at[None, :]) ** 2 / (sd_s**2 * N), time

    monkeypatch.setattr(module, "_scans", scans)
    runs = [record(np.linspace(0.0, lasts, N)) for lasts in lasts_s]
    problem: Any = SimpleNamespace(campaign=SimpleNamespace(prepared=runs))
    found = lateness(problem, SimpleNamespace(), look, chance, at_jumps)  # type: ignore[arg-type]
    return found, seen[0], seen[1]


def test_runs_that_differ_are_each_late_by_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    late = (4e-3, -2e-3, 9e-3, 1e-3)
    found, grid, reach = told(monkeypatch, late)
    assert found is not None
    assert found.late_s == pytest.approx(late, abs=1e-9)
    assert found.drift == 0.0
    assert found.spread_s == pytest.approx(np.std(late, ddof=1), rel=0.01)
    assert (reach, len(grid)) == (40e-3, 41)
    assert [grid[0], grid[-1]] == pytest.approx([-40e-3, 40e-3])


def test_a_run_that_does_not_tell_has_the_mean_of_those_that_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, *_ = told(monkeypatch, (4e-3, -2e-3, 0.2, 1e-3))
    assert found is not None
    assert found.late_s == pytest.approx((4e-3, -2e-3, 1e-3, 1e-3), abs=1e-9)


def test_once_they_were_shifted_a_finer_grid_is_asked_nearer_by(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    late = (4e-4, -2e-4, 9e-4, 1e-4)
    for look in (1, 2, 7):
        found, grid, reach = told(monkeypatch, late, look=look)
        assert found is not None
        assert found.late_s == pytest.approx(late, abs=1e-9)
        assert (reach, len(grid)) == (8e-3, 33)
    assert RANGES == ((40e-3, 2e-3), (8e-3, 0.5e-3))


def test_at_jumps_all_samples_are_asked_and_the_likelihood_says_where(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    late = (4e-3, -2e-3, 9e-3, 1e-3)
    found, _, reach = told(monkeypatch, late, at_jumps=True, sd_s=2e-3, chance=0.1)
    assert reach == 0.0
    assert found is not None
    assert found.late_s == pytest.approx(late, abs=1e-4)


@pytest.mark.parametrize(("late", "there"), [(5e-3, False), (0.0, False), (-5e-3, True)])
def test_what_all_share_is_the_recordings_where_it_is_early(
    late: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, *_ = told(monkeypatch, (late,) * 4)
    assert (found is not None) == there
    if found is not None:
        assert found.late_s == pytest.approx((late,) * 4, abs=1e-9)
        assert (found.drift, found.spread_s) == (0.0, 0.0)
    # Not where that may be chance.
    assert told(monkeypatch, (late,) * 4, sd_s=4e-3, chance=1e-9)[0] is None


@pytest.mark.parametrize("drift", [1e-3, -4e-4])
def test_what_grows_alike_is_one_clock(drift: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Started with each run: in its middle it is late by half of what it grows by."""
    lasts = (10.0, 20.0, 30.0, 20.0)
    found, *_ = told(monkeypatch, (1e-3,) * 4, drift, lasts_s=lasts)
    assert found is not None
    assert found.drift == pytest.approx(drift, rel=0.02)
    assert found.late_s == pytest.approx([0.5 * found.drift * t for t in lasts])
    assert found.spread_s == 0.0
    both, *_ = told(monkeypatch, (4e-3, -2e-3, 9e-3, 1e-3), drift)
    assert both is not None
    assert both.drift == pytest.approx(drift, rel=0.02)
    assert both.late_s == pytest.approx((4e-3, -2e-3, 9e-3, 1e-3), abs=1e-6)


def test_within_chance_nothing_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    late = (2e-4, -1e-4, 3e-4, 0.0)
    assert told(monkeypatch, late, sd_s=1e-3)[0] is None
    assert told(monkeypatch, (0.0,) * 4, 1e-5, sd_s=1e-3)[0] is None
    assert told(monkeypatch, (4e-3, -2e-3), lasts_s=(20.0, 20.0))[0] is None


@pytest.mark.parametrize(("step_s", "times"), [(0.019, 8), (2.4e-3, 1), (2.6e-3, 2), (1e-4, 1)])
def test_the_models_force_is_asked_for_at_close_instants(step_s: float, times: int) -> None:
    assert (FINE_S, CLIPPED) == (2.5e-3, 3.5)
    time = step_s * np.arange(11) + 3.0
    p: Any = record(time)
    found = instants_of(p)
    assert len(found) == 10 * times + 1
    assert found == pytest.approx(3.0 + step_s * np.arange(10 * times + 1) / times)


@pytest.mark.parametrize(("times", "there"), [(1.0, False), (1.0 + 1e-12, True)])
def test_beyond_chance_is_below_its_probability(
    times: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of runs that differ, of a drift of all, and of a force that is early in all."""
    chance = 0.25
    for differ, drift, early in (
        ((3e-3, chance), None, None),
        (None, (1e-3, chance), None),
        (None, None, (-2e-3, chance)),
    ):
        answers = [drift, early]
        monkeypatch.setattr(module, "_spread", lambda whole, differ=differ: differ)
        monkeypatch.setattr(module, "_common", lambda places, answers=answers: answers.pop(0))
        found, *_ = told(monkeypatch, (0.0,) * 4, chance=times * chance)
        assert (found is not None) == there
