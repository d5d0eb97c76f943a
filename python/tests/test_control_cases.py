"""Which plants a compensator is tried on and under which load; what is computed once is kept."""

from __future__ import annotations

import importlib
from types import SimpleNamespace
from typing import Any

import pytest
from jbf.control import TASKS, THESIS_BENCH, NoCompensation, thesis_model
from jbf.control.thesis_tables import Tables

robustness, assumptions, tuning = (
    importlib.import_module(f"jbf.control.{name}")
    for name in ("robustness", "assumptions", "tuning")
)


def test_each_plant_runs_under_its_own_load(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: set[tuple[float, float]] = set()

    def noted(plant: Any, *_: Any, load_n: float, **__: Any) -> SimpleNamespace:
        seen.add((plant.rig.lubricant.viscosity_pa_s, load_n))
        return SimpleNamespace(true_rms=1.0)

    monkeypatch.setattr(robustness, "run", noted)
    model = thesis_model()
    assert model.rig.load is not None
    assert model.rig.lubricant is not None
    row = {"velocity sine": TASKS["velocity sine"]}
    robustness.robustness(model, scheme=NoCompensation(), tasks=row)
    oil, usual = model.rig.lubricant.viscosity_pa_s, model.rig.load.normal_n
    assert {(oil, share * usual) for share in (0.5, 1.0, 2.0)} <= seen
    assert {(share * oil, usual) for share in (0.5, 2.0)} <= seen


def test_assumptions_are_told_from_the_first_to_the_last(monkeypatch: pytest.MonkeyPatch) -> None:
    base = Tables({}, thesis_model(), THESIS_BENCH)
    monkeypatch.setattr(assumptions, "tables", lambda *_, **__: base)
    monkeypatch.setattr(assumptions, "fit_friction", lambda *_, **__: (base.model, base.bench))
    told: list[tuple[str, int, int]] = []
    found = list(assumptions.assumptions(base, lambda *said: told.append(said)))
    assert told == [("other assumptions", k + 1, len(found)) for k in range(len(found))]


def test_a_level_of_friction_is_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def level(model: Any) -> float:
        asked.append(1.0)
        return 1.0

    monkeypatch.setattr(tuning, "_friction_level_n", level)
    monkeypatch.setattr(tuning, "_levels_n", {})
    for _ in range(3):
        for elastic in ("belt", "contact"):
            tuning.friction_level_v(thesis_model(elastic=elastic))
    assert len(asked) == 2
