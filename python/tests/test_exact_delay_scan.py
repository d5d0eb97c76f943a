"""Which delays are looked at, and what is made of their likelihood: one that is known."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.exact_delay import COARSE, FINE, ExactDelay, exact_delay
from jbf.models.late_reading import TAU

module = sys.modules["jbf.estimation.exact_delay"]
STEP_S = 0.02


class Scan:
    """A likelihood of a delay; which delays it was asked for."""

    def __init__(self, cost: Callable[[float], float]) -> None:
        self.asked: list[float] = []
        self._cost = cost

    def cost(self, delay_s: float) -> float:
        self.asked.append(float(delay_s))
        return self._cost(float(delay_s))

    def along(self, delay_s: float) -> Array:
        return np.array([7.0, delay_s])

    def residuals(self, values: Array, sd_s: float) -> list[Array]:
        return [np.array([values[1], sd_s])]


def told(
    monkeypatch: pytest.MonkeyPatch, scan: Scan, tau_s: float, sd_s: float
) -> ExactDelay | None:
    def of(problem: Any, solution: Any, spread: Any, values: Array, k: int) -> Scan:
        assert (float(values[1]), k) == (tau_s, 0)
        return scan

    monkeypatch.setattr(module, "_Scan", SimpleNamespace(of=of))
    runs = [SimpleNamespace(step_s=s) for s in (0.5 * STEP_S, STEP_S, 9.0 * STEP_S)]
    problem: Any = SimpleNamespace(
        names=["F_c_n", TAU], open=[1], campaign=SimpleNamespace(prepared=runs)
    )
    spread: Any = SimpleNamespace(moved=np.array([True]), error=lambda k: sd_s)
    solution: Any = None
    return exact_delay(problem, solution, spread, np.array([7.0, tau_s]))


def normal(mean_s: float, sd_s: float) -> Scan:
    return Scan(lambda delay_s: ((delay_s - mean_s) / sd_s) ** 2)


@pytest.mark.parametrize("at", [-2.0, 0.0, 0.4, 1.7])
@pytest.mark.parametrize("sd_s", [1e-3, 4e-3])
def test_of_a_normal_likelihood_mean_and_deviation_are_told(
    at: float, sd_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Though the search had it elsewhere; what the steps of the scan leave is added."""
    tau_s = 0.05
    mean_s = tau_s + at * sd_s
    found = told(monkeypatch, normal(mean_s, sd_s), tau_s, sd_s)
    assert found is not None
    gap = 10.0 * sd_s / 30.0
    assert found.values.tolist() == [7.0, pytest.approx(mean_s, abs=0.02 * sd_s)]
    assert found.sd_s == pytest.approx(np.hypot(sd_s, gap / 17.0 / np.sqrt(12.0)), rel=0.02)
    assert found.residuals[0].tolist() == [found.values[1], found.sd_s]


def test_a_likelihood_that_is_sharper_than_the_scan_is_as_wide_as_its_steps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """All of it at one delay: the deviation of a place anywhere within a seventeenth of a step."""
    tau_s, sd_s = 0.05, 2e-3
    found = told(monkeypatch, normal(tau_s, 1e-9), tau_s, sd_s)
    assert found is not None
    assert found.values[1] == pytest.approx(tau_s, abs=1e-12)
    assert found.sd_s == pytest.approx(10.0 * sd_s / 30.0 / 17.0 / np.sqrt(12.0), rel=1e-6)


@pytest.mark.parametrize(
    ("tau_s", "sd_s", "reach_s"),
    [
        (0.05, 2e-3, 10e-3),
        # A fifth of a usual step at least.
        (0.05, 1e-5, 0.2 * STEP_S),
        (0.05, 0.0008, 0.2 * STEP_S),
        (0.05, 0.00081, 4.05e-3),
        # No delay is less than nothing.
        (4e-3, 2e-3, 10e-3),
        (5.0 / 512.0, 1.0 / 512.0, 5.0 / 512.0),
    ],
)
def test_five_deviations_either_way_are_scanned_and_finer_round_the_best(
    tau_s: float, sd_s: float, reach_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    scan = normal(tau_s - 0.62 * reach_s, 0.1 * reach_s)
    assert told(monkeypatch, scan, tau_s, sd_s) is not None
    assert (COARSE, FINE) == (31, 17)
    coarse = tau_s + np.linspace(-reach_s, reach_s, 31)
    coarse = coarse[coarse > 0.0]
    assert scan.asked[: len(coarse)] == pytest.approx(coarse)
    best = coarse[np.argmin(np.abs(coarse - (tau_s - 0.62 * reach_s)))]
    gap = reach_s / 15.0
    # Eight to either side, without the neighbours and the best itself.
    finer = best + gap * np.delete(np.arange(-7, 8), 7) / 8.0
    assert scan.asked[len(coarse) :] == pytest.approx(finer[finer > 0.0])


def test_beside_no_delay_only_later_ones_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    scan = normal(0.0, 1e-4)
    found = told(monkeypatch, scan, 1.5e-3, 2e-3)
    assert found is not None
    assert min(scan.asked) > 0.0
    assert 0.0 < found.values[1] < 5e-4
