"""Fits of candidates that are gone on from, questioned and left out again, of made-up gains."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf.diagnosis.candidates import Candidates, Fitted
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.left_out import LeftOut

module = sys.modules["jbf.diagnosis.candidates"]


def near(gain: float, effects: tuple[str, ...] = (), rms_n: float = 1.0, value: float = 0.0) -> Any:
    """A solution that gains so much."""
    return SimpleNamespace(gain=gain, effects=effects, rms_n=rms_n, values=np.array([value]))


def posed(**more: Any) -> Any:
    """A problem of one parameter."""
    return SimpleNamespace(
        names=["F_c_n"],
        open=[0],
        samples_at=lambda start: "samples",
        solution=lambda start, samples, noise, converged: near(0.0, value=float(start[0])),
        **more,
    )


class Made(Candidates):
    """Candidates whose fits are told."""

    def __init__(self, solutions: dict[tuple[str, ...], Any]) -> None:
        self.policy, self.before = DEFAULT, None
        self._fitted = {
            frozenset(effects): Fitted(posed(), "converged", found)
            for effects, found in solutions.items()
        }


@pytest.fixture(autouse=True)
def _gains(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "likelihood_gain", lambda a, b: a.gain - b.gain)


# ---- from a richer model -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("gain", "rms_n", "taken"),
    [
        (10.1, 1.0, True),
        (10.0, 1.0, False),
        (9.9, 1.0, False),
        (99.0, DEFAULT.leader_rms - 0.001, True),
        (99.0, DEFAULT.leader_rms, True),
        # Likelier, and far off.
        (99.0, DEFAULT.leader_rms + 0.001, False),
    ],
)
def test_a_way_from_a_richer_model_is_taken_where_it_gains_and_is_not_astray(
    gain: float, rms_n: float, taken: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[float] = []
    there = near(gain, rms_n=rms_n)

    def settle(problem: Any, start: Any, samples: Any) -> Any:
        assert samples == "samples"
        asked.append(float(start.values[0]))
        return there

    monkeypatch.setattr(module, "settle", settle)
    one = near(10.0)
    one.noise = None
    made = Made({(): one, ("a",): near(50.0, ("a",), value=7.0)})
    found: Any = made.refit_from((), ("a",))
    assert found is (there if taken else one)
    assert made.converge(()) is found
    assert asked == [7.0]


# ---- peaks -------------------------------------------------------------------------------------


def searched(
    monkeypatch: pytest.MonkeyPatch,
    effects: tuple[str, ...],
    *,
    higher: float,
    fresh: float,
    end: float,
) -> tuple[float, list[str]]:
    """What is gained after peaks were looked for, from 10: near by, and as if nothing had been
    found before."""
    said: list[str] = []

    def peaks(problem: Any, start: Any) -> Any:
        said.append(f"peaks {start.gain:g}")
        return near(higher if start.gain == 10.0 else end)

    def approach(problem: Any, seeds: Any, evaluations: int) -> Any:
        said.append("fresh")
        return near(fresh)

    monkeypatch.setattr(module, "search_peaks", peaks)
    monkeypatch.setattr(module, "approach", approach)
    monkeypatch.setattr(module, "settle", lambda problem, start: start)
    made = Made({effects: near(10.0, effects)})
    found: Any = made.search_peaks(effects)
    gain = float(found.gain)
    assert made.search_peaks(effects) is found
    return gain, said


@pytest.mark.parametrize(
    ("fresh", "end", "found", "said"),
    [
        # Not much lower than what was found: its own peaks are looked for,
        (20.0 - DEFAULT.contender + 0.1, 30.0, 30.0, 3),
        (20.0 - DEFAULT.contender + 0.1, 20.0, 20.0, 3),
        # or it is left.
        (20.0 - DEFAULT.contender, 30.0, 20.0, 2),
    ],
)
def test_effects_together_are_looked_at_as_if_nothing_had_been_found(
    fresh: float, end: float, found: float, said: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    many = ("drive_compliance", "sensor_offset")
    gain, told = searched(monkeypatch, many, higher=20.0, fresh=fresh, end=end)
    assert (gain, len(told)) == (found, said)
    # One alone is not, nor are some of one peak each.
    for effects in (("drive_compliance",), ("sensor_offset", "sensor_drift"), ()):
        gain, told = searched(monkeypatch, effects, higher=20.0, fresh=fresh, end=end)
        assert (gain, told) == (20.0, ["peaks 10"])


# ---- left out ----------------------------------------------------------------------------------


def part(*runs: int) -> LeftOut:
    none = tuple(np.zeros(1) for _ in runs)
    return LeftOut(runs, tuple(n > 0.0 for n in none), np.ones(1, dtype=bool), none)


def test_runs_are_left_out_once_and_halves_where_they_are_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said: list[Any] = []

    def left_out(problem: Any, solution: Any) -> list[LeftOut]:
        said.append("whole")
        return [part(0, 2), part(1)]

    def halves(problem: Any, solution: Any, run: int) -> list[LeftOut]:
        said.append(run)
        return [part(run), part(run)]

    monkeypatch.setattr(module, "left_out", left_out)
    monkeypatch.setattr(module, "halves_left_out", halves)
    made = Made({("a",): near(0.0, ("a",))})
    assert [p.runs for p in made.left_out(("a",))] == [(0, 2), (1,)]
    assert [p.runs for p in made.left_out(("a",), [1])] == [(0, 2), (1,), (1,)]
    assert [p.runs for p in made.left_out(("a",), [0, 1])] == [(2,), (0,), (0,), (1,), (1,)]
    assert said == ["whole", 1, 0]


# ---- where a fit begins ------------------------------------------------------------------------


def begun(
    monkeypatch: pytest.MonkeyPatch, base: Any | None, *, known: dict[str, float] | None = None
) -> tuple[list[Any], bool, Any]:
    """Seeds of a fit beside a smaller model, whether each is followed, and one start more."""
    asked: list[Any] = []

    class Way:
        def __init__(self, problem: Any, seeds: Any, *, each: bool, stepped: Any) -> None:
            asked.extend([seeds, each, stepped])

    monkeypatch.setattr(module, "Approach", Way)
    made: Any = Made({})
    made._least_square = lambda solution: 7.0
    made._values_of = lambda solution: {"F_c_n": 5.0, "sensor_offset.b_n": 2.0}
    if known is not None:
        made.before = SimpleNamespace(values_of=lambda effects: known)
    fitted = Fitted(posed(), stepped=np.array([3.0]))
    made._way(fitted, ("sensor_offset",), base)
    assert fitted.least == 7.0
    seeds, each, stepped = asked
    return seeds, each, float(stepped[0])


def test_a_fit_begins_where_a_smaller_model_is_and_where_its_effects_are(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    law, own = {"F_c_n": 5.0, "sensor_offset.b_n": 2.0}, {"sensor_offset.b_n": 2.0}
    assert begun(monkeypatch, None) == ([{}], False, 3.0)
    assert begun(monkeypatch, near(0.0, ("sensor_offset",))) == ([law, own], False, 3.0)
    # Of an effect with many peaks the one it had to climb is no start.
    assert begun(monkeypatch, near(0.0, ("drive_compliance",))) == ([law, {}], True, 3.0)
    before = {"F_c_n": 9.0}
    assert begun(monkeypatch, near(0.0, ("sensor_offset",)), known=before) == ([before], False, 3.0)
    assert begun(monkeypatch, None, known=before) == ([before], False, 3.0)
