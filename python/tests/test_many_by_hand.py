"""Many campaigns: what is kept of each, and names of rival models; no campaign is diagnosed."""

from __future__ import annotations

import sys
from concurrent.futures import Executor, Future
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from jbf import InputError, Rig
from jbf.diagnosis.experiment import _names, propose
from jbf.diagnosis.many import _diagnosed, _lost, diagnose_many
from jbf.errors import JbfError

module = sys.modules["jbf.diagnosis.many"]
proposing = sys.modules["jbf.diagnosis.experiment"]


class Backwards(Executor):
    """Does the work at once; one of a name is lost."""

    def submit(self, work: Any, /, *given: Any, **named: Any) -> Future[Any]:
        future: Future[Any] = Future()
        if given[0] == "dies":
            future.set_exception(RuntimeError("out of memory"))
        else:
            future.set_result(work(*given, **named))
        return future


@pytest.fixture(autouse=True)
def _read(monkeypatch: pytest.MonkeyPatch) -> None:
    """A campaign of a name is diagnosed as that."""

    def diagnosed(given: Any, options: Any) -> Any:
        return InputError(problem=f"{given} {sorted(options)}", mend="nothing")

    monkeypatch.setattr(module, "_diagnosed", diagnosed)


@pytest.mark.parametrize("executor", [None, Backwards()])
def test_each_campaign_is_kept_in_the_order_given(executor: Executor | None) -> None:
    said: list[tuple[str, int, int]] = []
    found = diagnose_many(
        {"b": Path("one"), "a": Path("two")},
        executor=executor,
        progress=lambda *words: said.append(words),
        law="coulomb",
    )
    assert list(found) == ["b", "a"]
    assert [str(x).split(";")[0] for x in found.values()] == ["one ['law']", "two ['law']"]
    assert sorted(done for _, done, _ in said) == [1, 2]
    assert {total for *_, total in said} == {2}
    assert {words.split(":")[0] for words, *_ in said} == {"a", "b"}
    assert diagnose_many({}, executor=executor) == {}


def test_a_worker_that_dies_loses_its_own_campaign() -> None:
    given: Any = {"a": "dies", "b": "lives"}
    found = diagnose_many(given, executor=Backwards())
    assert str(found["a"]) == "the work was lost: RuntimeError: out of memory"
    assert isinstance(found["a"], JbfError)
    assert "lives" in str(found["b"])
    assert str(_lost(KeyError())) == "the work was lost: KeyError"


@pytest.mark.parametrize(
    ("given", "options", "said"),
    [
        ({}, {"lwa": "coulomb"}, "lwa"),
        ({}, {"law": "coulom"}, "coulom"),
        ({}, {"clock": "x"}, "x"),
        ([], {}, "campaigns is a list"),
        ({}, {"progress": 3}, "progress"),
    ],
)
def test_what_is_wrong_for_all_is_said_at_once(given: Any, options: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        diagnose_many(given, **options)
    assert diagnose_many({}, law="auto") == {}


def test_a_campaign_is_a_rig_and_its_runs() -> None:
    wrong: Any = (Rig(), [], [])
    found = _diagnosed(wrong, {})
    assert isinstance(found, InputError)
    assert "a campaign is 3 things" in str(found)
    gone = _diagnosed(Path("there is no such folder"), {})
    assert isinstance(gone, JbfError)


# ---- the next experiment -----------------------------------------------------------------------


def test_rivals_are_named_by_what_they_do_not_share() -> None:
    group = [("a", "b"), ("a", "c", "d"), ("a",)]
    assert _names([group]) == "b and c + d and nothing more"
    assert _names([[("a",), ("b",)], [("c", "a"), ("c", "d")]]) == "a and b; a and d"


def rivals(monkeypatch: pytest.MonkeyPatch, apart: dict[str, dict[tuple[str, str], float]]) -> Any:
    """Candidates whose models are so far apart in each of some motions, in squares of noise."""
    run = [0.0] * 100
    excitations = [SimpleNamespace(words=f"a {name}") for name in apart]
    monkeypatch.setattr(
        proposing, "filled_limits", lambda c, limits: (SimpleNamespace(duration_s=30.0), 0.02)
    )
    monkeypatch.setattr(
        proposing, "motions", lambda c, limits, step: [(e, run, e.words[2:]) for e in excitations]
    )

    def rival(fitted: str) -> Any:
        def separation(own: Any, truth: Any, step_s: float) -> float:
            motion, a = own
            return apart[motion][a, truth[1]]

        noise = {"sensor_offset": 0.5}.get(fitted, 0.2)
        return SimpleNamespace(
            at=lambda motion: (motion, fitted), separation=separation, noise_n=noise
        )

    monkeypatch.setattr(proposing, "Rival", rival)
    return SimpleNamespace(
        converge=lambda effects: None,
        fitted=lambda effects: effects[0],
        policy=SimpleNamespace(least_separation=25.0),
        campaign=SimpleNamespace(rig=Rig()),
    )


A, B = "sensor_offset", "coulomb_drag"


def both(there: float, back: float) -> dict[tuple[str, str], float]:
    return {(A, B): there, (B, A): back}


def test_the_run_that_parts_the_least_apart_is_proposed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of the two may be the truth: what is told of the worse case counts."""
    candidates = rivals(
        monkeypatch,
        {"sine": both(900.0, 30.0), "stop": both(100.0, 64.0), "ramp": both(63.0, 64.0)},
    )
    found = propose(candidates, [[(A,), (B,)]])
    assert not isinstance(found, str)
    assert found.evidence == 64.0
    # Of a hundred samples 0.8 of the noise, which is 0.5 N of the two.
    assert found.separation_sigma == pytest.approx(0.8)
    assert found.separation_n == pytest.approx(0.4)
    assert found.words == (
        f"record a stop for 30 s: there {A} and {B} differ by 0.4 N RMS after a new fit, "
        "0.8 times the noise"
    )
    assert len(found.run) == 100


@pytest.mark.parametrize(("most", "told"), [(24.9, False), (25.0, True)])
def test_what_parts_no_two_is_not_proposed(
    most: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = propose(rivals(monkeypatch, {"sine": both(most, 99.0)}), [[(A,), (B,)]])
    assert isinstance(found, str) != told
    if not told:
        assert str(found).startswith(f"{A} and {B} predict the same friction in every motion")
    # Of two that part them as far the first.
    two = propose(
        rivals(monkeypatch, {"sine": both(64.0, 64.0), "stop": both(64.0, 99.0)}), [[(A,), (B,)]]
    )
    assert not isinstance(two, str)
    assert two.words.startswith("record a sine")
    nothing = propose(rivals(monkeypatch, {"sine": both(0.0, 0.0)}), [[(A,), (B,)]])
    assert "no such run would part them" in str(nothing)


def test_columns_that_nobody_knows_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    page = SimpleNamespace(columns=("pressure_pa", "time_s", "angle_rad"))
    monkeypatch.setattr(proposing, "find_effect", lambda name: page)
    found = propose(rivals(monkeypatch, {"sine": both(99.0, 99.0)}), [[(A,), (B,)]])
    assert found == "no run can be proposed: nobody knows what pressure_pa would be"
