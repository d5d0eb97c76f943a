"""How far a diagnosis has come, when it is stopped."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest
from jbf.diagnosis import reached as module
from jbf.diagnosis.reached import Reached
from jbf.estimation.work import Work


def test_nothing_is_reached_before_the_first_fit() -> None:
    assert Reached().fit() is None


def test_the_model_of_the_last_round_is(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    work = Work(10.0, 10.0)
    candidates = SimpleNamespace(
        campaign=SimpleNamespace(work=work),
        fitted=lambda effects: SimpleNamespace(problem=("problem", effects)),
        converge=lambda effects: ("solution", effects),
    )
    monkeypatch.setattr(module, "finish", lambda *given: asked.append(given) or "fit")
    reached = Reached(cast(Any, candidates), ("sensor_lag",))
    assert cast(Any, reached.fit()) == "fit"
    # What was used up before is no hindrance to its errors.
    work.take(1e9)
    assert asked == [(("problem", ("sensor_lag",)), ("solution", ("sensor_lag",)))]
