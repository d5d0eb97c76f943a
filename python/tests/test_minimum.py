"""How a fit settles: with the colour of its noise and the samples beside jumps, of made-up
searches."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf.estimation.film_gaps import behind_gaps
from jbf.estimation.minimum import MAX_EVALUATIONS, MOST_FORGIVEN, minimum, settle
from jbf.estimation.noise import WHITE, Noise
from made_of import record

module = sys.modules["jbf.estimation.minimum"]
gaps = sys.modules["jbf.estimation.film_gaps"]
COLOURED = Noise(0.2, 0.5)


class Searches:
    """A problem whose square is told by its value; what was searched, from where."""

    def __init__(
        self,
        monkeypatch: pytest.MonkeyPatch,
        *,
        ends: tuple[float, ...] = (),
        noises: tuple[Noise, ...] = (WHITE,),
        left: str = "every",
    ) -> None:
        self.ends, self.noises, self.left = list(ends), list(noises), left
        self.asked: list[Any] = []
        self.campaign = SimpleNamespace(samples="every")
        monkeypatch.setattr(module, "search", self.search)
        monkeypatch.setattr(module, "noise_at", lambda problem, samples, values: self.noises.pop(0))

    def search(self, problem: Any, samples: Any, start: Any, noise: Noise, evaluations: int) -> Any:
        assert evaluations == MAX_EVALUATIONS
        self.asked.append((samples, float(start[0]), noise))
        return SimpleNamespace(values=np.array([self.ends.pop(0)]), converged=True, message="ended")

    def samples_at(self, values: Any) -> str:
        return self.left

    def square(self, values: Any, samples: Any) -> float:
        return float(values[0]) ** 2

    def wrapped(self, values: Any) -> Any:
        return values

    def solution(self, values: Any, samples: Any, noise: Any, converged: bool, message: str) -> Any:
        return near(float(values[0]), noise, converged, samples, message)


def near(
    value: float,
    noise: Noise = WHITE,
    converged: bool = True,
    samples: str = "every",
    message: str = "near",
) -> Any:
    return SimpleNamespace(
        values=np.array([value]), noise=noise, converged=converged, samples=samples, message=message
    )


def test_what_has_converged_in_white_noise_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    problem: Any = Searches(monkeypatch)
    found: Any = settle(problem, near(5.0))
    assert (float(found.values[0]), found.noise, found.samples) == (5.0, WHITE, "every")
    assert (found.converged, found.message) == (True, "near")
    assert problem.asked == []


def test_what_has_not_is_searched_on_as_if_noise_were_white(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem: Any = Searches(monkeypatch, ends=(3.0,))
    found: Any = settle(problem, near(5.0, COLOURED, converged=False))
    assert problem.asked == [("every", 5.0, WHITE)]
    assert (float(found.values[0]), found.message) == (3.0, "ended")


@pytest.mark.parametrize(("times", "taken"), [(1.0, True), (1.0199, True), (1.0201, False)])
def test_colour_may_lead_a_little_astray_and_no_further(
    times: float, taken: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To a fiftieth more in the RMS of the plain fit."""
    assert MOST_FORGIVEN == 1.02
    last = Noise(0.1, 0.25)
    just: Any = Searches(monkeypatch, ends=(1.02,), noises=(last,))
    assert settle(just, near(1.0, COLOURED)).noise == last
    problem: Any = Searches(monkeypatch, ends=(5.0 * times,), noises=(last,))
    found: Any = settle(problem, near(5.0, COLOURED))
    assert problem.asked == [("every", 5.0, COLOURED)]
    assert float(found.values[0]) == pytest.approx(5.0 * times if taken else 5.0)
    assert found.noise == (last if taken else COLOURED)


def test_samples_beside_jumps_are_weighed_anew_where_the_search_has_come(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """First all at full weight, then what the model leaves there."""
    problem: Any = Searches(monkeypatch, ends=(3.0, 2.0), noises=(WHITE, WHITE), left="few")
    found: Any = settle(problem, near(5.0, converged=False, samples="old"))
    assert problem.asked == [("every", 5.0, WHITE), ("few", 3.0, WHITE)]
    assert (float(found.values[0]), found.samples) == (2.0, "few")
    given: Any = Searches(monkeypatch, ends=(3.0,), noises=(WHITE,))
    there: Any = settle(given, near(5.0, converged=False, samples="mine"), "mine")  # type: ignore[arg-type]
    assert given.asked == [("mine", 5.0, WHITE)]
    assert there.samples == "mine"


@pytest.mark.parametrize(("law", "method"), [("coulomb", "trf"), ("journal", "")])
def test_laws_without_a_film_follow_their_starts_to_the_end(
    law: str, method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[dict[str, Any]] = []

    def approach(problem: Any, seeds: Any, evaluations: int, **named: Any) -> str:
        assert (seeds, evaluations) == (["seed"], MAX_EVALUATIONS)
        asked.append(named)
        return "near"

    monkeypatch.setattr(module, "approach", approach)
    monkeypatch.setattr(module, "settle", lambda problem, there: f"settled {there}")
    monkeypatch.setattr(module, "search_peaks", lambda problem, there: f"peak of {there}")
    problem: Any = SimpleNamespace(law=law)
    seeds: Any = ["seed"]
    found: Any = minimum(problem, seeds)
    assert found == "peak of settled near"
    more = {"steps": MAX_EVALUATIONS, "method": method} if method else {}
    assert asked == [{"followed": 6, **more}]


# ---- gaps of a film ----------------------------------------------------------------------------


def test_behind_a_gap_a_film_remembers_what_was_not_recorded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whether the speed changed as it began or as it ended: where either makes a difference."""
    time = np.array([0.0, 1.0, 2.0, 12.0, 13.0, 14.0, 15.0])
    broken, whole = record(time), record(np.arange(7.0))
    for p, core in ((broken, 0.0), (whole, 99.0)):
        p.core = core
    early = np.array([0.0, 0.0, 0.0, 5.0, 0.5, 0.0, 0.0])
    late = np.array([0.0, 0.0, 0.0, -2.0, 0.5, -1.5, 0.0])
    forces = {0.0: np.zeros(7), "early": early, "late": late}
    chain = SimpleNamespace(predict=lambda values, motions: [forces[m] for m in motions])
    monkeypatch.setattr(gaps, "_through", lambda p, late: "late" if late else "early")
    problem: Any = SimpleNamespace(
        campaign=SimpleNamespace(prepared=[whole, broken]), chain=chain, law="journal"
    )
    found = behind_gaps(problem, np.zeros(1), 1.0)
    assert [f.tolist() for f in found] == [[False] * 7, [False] * 3 + [True, False, True, False]]
    at_most = behind_gaps(problem, np.zeros(1), 2.0)
    assert at_most[1].tolist() == [False] * 3 + [True] + [False] * 3
    # As much as does not matter is none.
    just = behind_gaps(problem, np.zeros(1), 1.5)
    assert just[1].tolist() == [False] * 3 + [True] + [False] * 3
    problem.law = "coulomb"
    assert not any(f.any() for f in behind_gaps(problem, np.zeros(1), 1.0))
