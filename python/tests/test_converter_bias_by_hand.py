"""Turns of taking a bias off and fitting again, and readings whose bias is known: by hand."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.converter_bias import without_bias
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.converter import bias_n
from made_of import samples_of

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.diagnosis.converter_bias"]
N = 4000
STEP_N = 2.0
ZERO_N = 0.7


# ---- off and on until it stays -----------------------------------------------------------------


@pytest.mark.parametrize(("moves", "turns"), [(0, 0), (1, 1), (3, 3), (8, 8), (20, 8)])
def test_a_bias_is_taken_off_and_the_model_fitted_again_until_it_stays(
    moves: int, turns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Eight times at most, each a fit of a few steps from where the last one ended."""
    fits: list[Any] = []
    asked: list[int] = []

    def once(problem: Any, solution: Any, policy: Any) -> Any:
        turn = problem.turn
        asked.append(turn)
        assert solution.turn == turn
        return turn + 1 if turn < moves else None

    def made(campaign: int, law: str, clock: str, effects: Any, fixed: Any) -> Any:
        return SimpleNamespace(
            turn=campaign,
            law=law,
            clock=clock,
            effects=effects,
            fixed=fixed,
            samples_at=lambda values: ("samples", values),
            solution=lambda values, samples, noise, converged, message: SimpleNamespace(
                turn=campaign, values=values, noise=noise
            ),
        )

    def search(problem: Any, samples: Any, values: Any, noise: Any, evaluations: int) -> Any:
        fits.append((problem.turn, samples, values, noise, evaluations))
        return SimpleNamespace(values=f"v{problem.turn}", converged=True, message="")

    monkeypatch.setattr(module, "_once", once)
    monkeypatch.setattr(module, "Problem", made)
    monkeypatch.setattr(module, "search", search)
    given = made(0, "law", "clock", ("e",), {"F_s_n": 6.0})
    near: Any = SimpleNamespace(turn=0, values="v0", noise="noise")
    found: Any = without_bias(given, near, DEFAULT)
    assert found == (turns or None)
    # Once it stays nobody asks again.
    assert asked == list(range(min(turns + 1, 8)))
    assert fits == [(i + 1, ("samples", f"v{i}"), f"v{i}", "noise", 8) for i in range(turns)]


# ---- readings in steps -------------------------------------------------------------------------


@dataclass(frozen=True)
class Ready:
    """A run that is ready."""

    run: Any
    readings_n: Array
    friction_n: Array
    step_s: float = 0.02


@dataclass(frozen=True)
class Runs:
    """A campaign of such."""

    prepared: tuple[Ready, ...]
    findings: tuple[Any, ...]
    step_n: float = STEP_N


def forces(n: int = N) -> Array:
    """Over five steps of a converter, evenly."""
    return np.linspace(0.0, 10.0, n)


def read(noise: float, step_n: float = STEP_N) -> Array:
    """Mean readings beside so much noise, in steps: what a converter adds, no sample averages."""
    found: Array = forces() + bias_n(step_n, noise * step_n, forces() - ZERO_N)
    return found


def once(
    monkeypatch: pytest.MonkeyPatch, *readings: Array, stepped: str = "ab", **more: Any
) -> Any:
    """By a model that is right, of runs whose readings' steps do not begin at zero."""
    monkeypatch.setattr(module, "origin_n", lambda step, readings: ZERO_N)
    prepared = tuple(
        Ready(SimpleNamespace(name="ab"[i], time_s=np.arange(N)), r, r)
        for i, r in enumerate(readings)
    )
    told = [(name, STEP_N, "steps") for name in stepped] + [("b", 9.0, "gaps")]
    findings = tuple(SimpleNamespace(run=r, size=x, kind=k) for r, x, k in told)
    problem: Any = SimpleNamespace(campaign=Runs(prepared, findings, **more))
    solution: Any = SimpleNamespace(
        residuals=[r - forces() for r in readings], samples=samples_of(prepared)
    )
    return module._once(problem, solution, DEFAULT)


@pytest.mark.parametrize("noise", [0.1, 0.2, 0.3])
def test_readings_lose_the_bias_that_their_noise_leaves(
    noise: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """How much noise there is before the converter, the bias itself says."""
    found = once(monkeypatch, read(noise), read(noise))
    assert found is not None
    for p in found.prepared:
        assert p.friction_n == pytest.approx(forces(), abs=2e-3 * STEP_N)
        assert p.readings_n == pytest.approx(read(noise))


def test_a_run_without_steps_stays_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    found = once(monkeypatch, read(0.2), read(0.2), stepped="a")
    assert found is not None
    # What the other run reads, it reads: nothing is taken off.
    assert np.array_equal(found.prepared[1].friction_n, read(0.2))
    assert not np.array_equal(found.prepared[0].friction_n, read(0.2))
    assert once(monkeypatch, read(0.2), stepped="") is None


def test_what_moves_a_hundredth_of_a_step_is_off_already(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the steps of the campaign."""
    off = np.sqrt(np.mean((read(0.3) - forces()) ** 2))
    for part, there in ((1.02, False), (0.98, True)):
        step_n = part * off / DEFAULT.bias_moves
        assert (once(monkeypatch, read(0.3), stepped="a", step_n=step_n) is not None) == there


def test_beside_noise_of_most_of_a_step_there_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    assert once(monkeypatch, forces()) is None


def test_each_run_has_its_residual(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that is missing is not left out without a word."""
    run = Ready(SimpleNamespace(name="a", time_s=np.arange(N)), read(0.2), read(0.2))
    findings = (SimpleNamespace(run="a", size=STEP_N, kind="steps"),)
    problem: Any = SimpleNamespace(campaign=Runs((run, run), findings))
    solution: Any = SimpleNamespace(residuals=[np.zeros(N)], samples=samples_of([run]))
    with pytest.raises(ValueError, match="zip"):
        module._once(problem, solution, DEFAULT)
