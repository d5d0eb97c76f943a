"""Which delays are looked at, and what is made of their likelihood: one that is known."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf import Rig
from jbf.estimation.exact_delay import COARSE, FINE, ExactDelay, _Scan, exact_delay
from jbf.models.catalogue import parameters_of
from jbf.models.late_reading import TAU
from made_of import record, samples_of

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


@pytest.mark.parametrize(
    ("names", "opened"), [(["F_c_n", "F_v_n_s_m"], [0, 1]), (["F_c_n", TAU], [0])]
)
def test_of_a_delay_that_is_not_open_nothing_is_told(names: list[str], opened: list[int]) -> None:
    problem: Any = SimpleNamespace(names=names, open=opened, campaign=None)
    none: Any = None
    assert exact_delay(problem, none, none, np.zeros(2)) is None


# ---- the likelihood ----------------------------------------------------------------------------


def test_others_follow_along_the_valley_and_a_zero_of_a_runs_own_is_no_delay() -> None:
    """By their covariance over the delay's variance; of what never moved, not at all."""
    pages = parameters_of("coulomb", ("time_delay",))
    names = list(pages)
    k = names.index(TAU)
    count = len(names)
    correlation = np.full((count, count), 0.5)
    correlation[0, k] = np.nan
    moved = np.arange(count) != 1
    sd, scale = 1.0 + np.arange(count), np.full(count, 3.0)
    spread: Any = SimpleNamespace(correlation=correlation, sd=sd, scale=scale, moved=moved)
    runs = [record(STEP_S * np.arange(50), name=name, friction=np.full(50, 4.0)) for name in "ab"]
    samples = SimpleNamespace(**vars(samples_of(runs)))
    samples.without_deviations = lambda residuals, noise: [r - 1.5 for r in residuals]
    samples.rms = lambda residuals: float(residuals[0][0])
    solution: Any = SimpleNamespace(samples=samples, residuals=[np.full(50, 2.0)] * 2, noise=None)
    problem: Any = SimpleNamespace(
        campaign=SimpleNamespace(rig=Rig(), prepared=runs),
        law="coulomb",
        clock="journal",
        effects=("time_delay",),
        names=names,
    )
    scan = _Scan.of(problem, solution, spread, np.zeros(count), k)
    wanted = 0.5 * sd / sd[k] / 3.0
    wanted[[0, 1]] = 0.0
    assert scan.way.tolist() == wanted.tolist()
    assert [f.tolist() for f in scan.friction_n] == [[2.5] * 50] * 2
    assert scan.noise_n == 0.5


@pytest.mark.parametrize("over", [0.0, 0.9e-3, 1.2e-3, 0.4, 0.6, 0.9985, 0.9991, 1.0])
def test_a_sample_is_a_mixture_within_three_and_a_half_deviations_of_its_instant(
    over: float,
) -> None:
    """Where one side is less likely than that it is the other's, and counts for its share; read
    2 N off the one and 3 N off the other in a noise of 1 N."""
    far = 0.5 * np.exp(-0.5 * 3.5**2)
    assert 0.9e-3 < far < 1.2e-3
    reading = SimpleNamespace(
        before_n=np.array([3.0]), after_n=np.array([2.0]), over=np.array([over]), mean_n=np.ones(1)
    )
    asked: list[Any] = []

    def read(values: Array, run: Any, time: Array, motion: Any, sd_s: float) -> Any:
        asked.append((run, time, sd_s))
        return reading

    run = record(np.zeros(1), name="a")
    run.motion_as_read = ("instants", "motion")
    run.examined = SimpleNamespace(usable=np.ones(1, dtype=bool))
    problem: Any = SimpleNamespace(
        campaign=SimpleNamespace(prepared=[run]),
        encode=lambda values: values,
        decode=lambda x, base: x.copy(),
    )
    chain: Any = SimpleNamespace(tau=0, read=read)
    scan = _Scan(problem, chain, [np.array([5.0])], np.zeros(1), np.zeros(1), 1.0, 0.25)
    if min(over, 1.0 - over) > far:
        wanted = -2.0 * np.log((1.0 - over) * np.exp(-2.0) + over * np.exp(-4.5))
    else:
        wanted = 0.25 * (9.0 if over > 0.5 else 4.0)
    assert scan.cost(0.01) == pytest.approx(wanted)
    assert asked == [(run.run, "instants", 0.0)]
    # A reading that tells nothing says nothing.
    run.examined.usable[0] = False
    assert scan.cost(0.01) == 0.0
