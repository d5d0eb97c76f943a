"""Which law predicts best, by left-out errors that are made up."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import InputError, Rig
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.which_law import (
    LAW_SHARE,
    STRETCHES,
    LawTried,
    _within,
    allowed,
    compared,
    followed,
    left_out,
    simpler_law,
    which_law,
)
from jbf.errors import Unfinished
from jbf.estimation.work import Work

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.diagnosis.which_law"]
N = 4000


def swings(size: float, n: int = N) -> list[Array]:
    """Errors of two runs, all of one size."""
    return list(np.split(size * np.where(np.arange(n) % 2, 1.0, -1.0), 2))


def waves(rms: float, share: float, n: int = N) -> list[Array]:
    """Errors whose mean square is larger and smaller by a share in every other stretch."""
    part = (np.arange(n) // (n // STRETCHES)) % 2
    size = rms * np.sqrt(np.where(part, 1.0 + share, 1.0 - share))
    return list(np.split(size * np.where(np.arange(n) % 2, 1.0, -1.0), 2))


def tried(**left: list[Array]) -> dict[str, LawTried]:
    names = list(left)
    return {
        t.law: t for t in compared(names, [len(n) for n in names], list(left.values()), DEFAULT)
    }


# ---- compared ----------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_laws_come_by_what_they_leave_the_best_first(unit: float) -> None:
    found = tried(ab=swings(2.0 * unit), c=swings(unit), def_=swings(3.0 * unit))
    assert list(found) == ["c", "ab", "def_"]
    assert [t.left_out_rms_n for t in found.values()] == pytest.approx([unit, 2 * unit, 3 * unit])
    assert [t.parameters for t in found.values()] == [1, 2, 4]
    assert [t.tied for t in found.values()] == [True, False, False]
    assert found["c"].to_dict() == {
        "law": "c",
        "parameters": 1,
        "left_out_rms_n": found["c"].left_out_rms_n,
        "tied": True,
    }


@pytest.mark.parametrize(("part", "same"), [(0.98, True), (1.02, False)])
def test_laws_within_half_a_hundredth_are_the_same(part: float, same: bool) -> None:
    """However surely the one is better."""
    more = np.sqrt(1.0 + part * (DEFAULT.law_same**2 - 1.0))
    for unit in (1e-3, 1e3):
        assert tried(a=swings(unit), b=swings(unit * more))["b"].tied == same


@pytest.mark.parametrize(("part", "same"), [(0.98, True), (1.02, False)])
def test_laws_that_differ_by_no_more_than_their_stretches_are_tied(part: float, same: bool) -> None:
    """Forty stretches whose squares stray by s: their mean by s over sqrt(40), twice that is
    chance."""
    assert STRETCHES == 40
    share = 0.5
    mean = 1.0 + part * DEFAULT.law_tie * share / np.sqrt(STRETCHES)
    for unit in (1e-3, 1e3):
        # About its mean the second strays by `share` in squares of the first.
        other = waves(unit * np.sqrt(mean), share / mean)
        assert tried(a=swings(unit), b=other)["b"].tied == same


def test_samples_that_count_for_every_law_are_compared() -> None:
    a, b = swings(1.0), swings(2.0)
    a[0][:500], b[1][500:] = np.nan, np.nan
    found = tried(a=a, b=b)
    assert [t.left_out_rms_n for t in found.values()] == pytest.approx([1.0, 2.0])
    # What one leaves there where the other says nothing is nothing.
    wild = swings(2.0)
    wild[0][:500] = 1e6
    assert tried(a=a, b=wild)["b"].left_out_rms_n == pytest.approx(2.0)
    few = tried(a=swings(1.0, 10), b=swings(2.0, 10))
    assert not few["b"].tied


# ---- laws that a rig allows --------------------------------------------------------------------


def test_laws_are_those_that_a_rig_has_all_for() -> None:
    assert "coulomb" in allowed(Rig())
    assert "journal" not in allowed(Rig())
    assert {"coulomb", "journal"} <= set(allowed(Rig.thesis()))


def test_a_film_that_is_too_fast_is_refused_with_its_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def film(campaign: Any, name: str, clock: str) -> None:
        if name == "coulomb":
            raise InputError(problem="too fast", mend="wait")

    monkeypatch.setattr(module, "check_film", film)
    campaign: Any = SimpleNamespace(rig=Rig())
    found, refused = followed(campaign, "journal")
    assert refused == {"law coulomb": "too fast"}
    assert found == [name for name in allowed(Rig()) if name != "coulomb"]


def asked(
    monkeypatch: pytest.MonkeyPatch, left: dict[str, list[Array] | None]
) -> tuple[Any, list[tuple[str, int, int]]]:
    told: list[tuple[str, int, int]] = []
    monkeypatch.setattr(module, "followed", lambda c, clock: (list(left), {"law x": "no film"}))
    monkeypatch.setattr(module, "_within", lambda c, name, clock: left[name])
    campaign: Any = SimpleNamespace(work=Work(7.0), named="here")
    found = which_law(campaign, "journal", DEFAULT, lambda *said: told.append(said))
    return found, told


def test_of_tied_laws_the_simplest_is_taken_first(monkeypatch: pytest.MonkeyPatch) -> None:
    left: dict[str, list[Array] | None] = {
        "lugre": swings(1.0),
        "coulomb": swings(1.004),
        "stribeck": swings(2.0),
        "journal": None,
    }
    (laws, refused), told = asked(monkeypatch, left)
    assert [t.law for t in laws] == ["coulomb", "lugre", "stribeck"]
    assert [t.tied for t in laws] == [True, True, False]
    late = "takes too long to follow along these records"
    assert refused == {"law x": "no film", "law journal": late}
    assert told == [(f"trying the law {name}", i, 4) for i, name in enumerate(left)]
    apart = {**left, "coulomb": swings(1.5)}
    assert [t.law for t in asked(monkeypatch, apart)[0][0]] == ["lugre", "coulomb", "stribeck"]


def test_where_no_law_can_be_followed_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(Unfinished):
        asked(monkeypatch, {"journal": None})


# ---- a law in place of effects -----------------------------------------------------------------


def mended(
    monkeypatch: pytest.MonkeyPatch,
    laws: dict[str, tuple[int, float]],
    *,
    own: tuple[int, float] = (6, 1.0),
    effects: tuple[str, ...] = ("sensor_offset", "backlash"),
    fitted: dict[str, float] | None = None,
    late: str = "",
) -> LawTried | None:
    """The law that does as well as one called `own` with effects; each has so many parameters, and
    leaves so much (where it is fitted, too, but where that is told)."""
    asked_for: list[tuple[str, tuple[str, ...]]] = []

    class Made:
        def __init__(self, campaign: Any, law: str, clock: Any, policy: Any) -> None:
            self.law, self.policy, self.campaign = law, policy, campaign
            if law != "own":
                assert campaign.work.most == LAW_SHARE * 8.0

        def fitted(self, effects: tuple[str, ...]) -> Any:
            count = own[0] if self.law == "own" else laws[self.law][0]
            return SimpleNamespace(problem=SimpleNamespace(open=range(count)))

        def converge(self, effects: tuple[str, ...]) -> Any:
            if self.law == late:
                raise Unfinished(steps=1.0)
            asked_for.append((self.law, effects))
            size = own[1] if self.law == "own" else laws[self.law][1]
            return SimpleNamespace(rms_n=(fitted or {}).get(self.law, size))

    def errors(candidates: Any, effects: tuple[str, ...]) -> list[Array]:
        return swings(own[1] if candidates.law == "own" else laws[candidates.law][1])

    monkeypatch.setattr(module, "Candidates", Made)
    monkeypatch.setattr(module, "left_out", errors)
    monkeypatch.setattr(module, "followed", lambda c, clock: (["own", *laws], {}))

    def replaced(whole: Any, work: Any) -> Any:
        return SimpleNamespace(work=work)

    monkeypatch.setattr(module, "replace", replaced)
    campaign: Any = SimpleNamespace(work=Work(8.0))
    candidates: Any = Made.__new__(Made)
    candidates.law, candidates.policy, candidates.campaign = "own", DEFAULT, campaign
    found = simpler_law(candidates, effects, "journal")
    # What is no friction stays beside another law.
    kept = tuple(e for e in effects if e == "sensor_offset")
    assert all(given == (effects if law == "own" else kept) for law, given in asked_for)
    return found


def test_a_law_that_predicts_as_well_with_fewer_parameters_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert LAW_SHARE == 0.25
    found = mended(monkeypatch, {"other": (5, 1.004), "worse": (2, 2.0)})
    assert found is not None
    assert (found.law, found.parameters) == ("other", 5)
    assert mended(monkeypatch, {"other": (5, 1.2)}) is None
    assert mended(monkeypatch, {}) is None
    # One that has too many does not keep the next from being looked at.
    after = mended(monkeypatch, {"large": (9, 0.5), "other": (5, 1.0)})
    assert after is not None
    assert after.law == "other"
    # Of several the simplest.
    two = mended(monkeypatch, {"other": (5, 1.0), "simple": (3, 1.003)})
    assert two is not None
    assert two.law == "simple"


@pytest.mark.parametrize(
    ("count", "left", "told"),
    [(6, 0.999, True), (6, 1.0, True), (6, 1.001, False), (7, 0.5, False), (5, 1.001, True)],
)
def test_a_law_of_as_many_parameters_must_leave_no_more(
    count: int, left: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert (mended(monkeypatch, {"other": (count, left)}) is not None) == told


def test_a_law_that_is_far_off_or_too_dear_is_no_law(monkeypatch: pytest.MonkeyPatch) -> None:
    laws = {"other": (5, 1.0)}
    far = DEFAULT.leader_rms
    for size, told in ((0.99 * far, True), (1.01 * far, False)):
        found = mended(monkeypatch, laws, fitted={"own": 1.0, "other": size})
        assert (found is not None) == told
    assert mended(monkeypatch, laws, late="other") is None
    beside = {**laws, "last": (4, 1.0)}
    after = mended(monkeypatch, beside, late="other")
    assert after is not None
    assert after.law == "last"


# ---- errors of runs left out -------------------------------------------------------------------


def test_errors_stand_at_the_samples_that_count(monkeypatch: pytest.MonkeyPatch) -> None:
    """And none at the others."""
    counted = [np.array([True, False, True]), np.array([False, True])]
    errors = [np.array([1.0, 2.0]), np.array([3.0])]
    monkeypatch.setattr(module, "left_out_by_run", lambda problem, solution: errors)
    candidates: Any = SimpleNamespace(
        converge=lambda effects: SimpleNamespace(samples=SimpleNamespace(counted=counted)),
        fitted=lambda effects: SimpleNamespace(problem=None),
    )
    first, second = left_out(candidates, ())
    assert first == pytest.approx([1.0, np.nan, 2.0], nan_ok=True)
    assert second == pytest.approx([np.nan, 3.0], nan_ok=True)
    # A run without errors of its own is not left out without a word.
    errors.pop()
    with pytest.raises(ValueError, match="zip"):
        left_out(candidates, ())


@pytest.mark.parametrize("ends", [True, False])
def test_a_law_has_a_part_of_the_work(ends: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside those that are no friction and that these runs could show; where that is not enough
    there are no errors."""
    asked: list[Any] = []

    def errors(candidates: Any, effects: tuple[str, ...]) -> str:
        asked.append((candidates.campaign, candidates.law, effects))
        if ends:
            raise Unfinished(steps=7.0)
        return "errors"

    monkeypatch.setattr(module, "replace", lambda campaign, work: ("part", work))
    monkeypatch.setattr(
        module, "settled_campaign", lambda campaign, law, clock: ("settled", campaign)
    )
    monkeypatch.setattr(
        module,
        "Candidates",
        lambda campaign, law, clock: SimpleNamespace(
            campaign=campaign, law=law, names=["gravity", "sensor_lag", "sensor_offset"]
        ),
    )
    monkeypatch.setattr(module, "left_out", errors)
    campaign: Any = SimpleNamespace(work=SimpleNamespace(part=lambda share: share))
    found: Any = _within(campaign, "dahl", "thesis")
    assert found == (None if ends else "errors")
    assert asked == [(("settled", ("part", 0.25)), "dahl", ("sensor_offset", "gravity"))]
