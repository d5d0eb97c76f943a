"""Many campaigns: what is kept of each; no campaign is diagnosed."""

from __future__ import annotations

import sys
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

import pytest
from jbf import InputError, Rig
from jbf.diagnosis.many import _diagnosed, _lost, diagnose_many
from jbf.errors import JbfError

module = sys.modules["jbf.diagnosis.many"]


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
