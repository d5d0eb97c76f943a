"""What motions are worth together, by matrices of one law's parameter and a few effects."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.plan import ENOUGH, MORE, _chosen, _effects, _least_worth, _told, _worth

Array = npt.NDArray[np.float64]
NONE = np.log(ENOUGH)
"""What `MORE` counts of an effect that is worth no more than enough."""


def told(*columns: list[float]) -> Array:
    """Of a motion whose derivatives and changes are these columns."""
    rows = np.array(columns).T
    found: Array = rows.T @ rows
    return found


def test_an_effect_counts_by_its_price_up_to_enough() -> None:
    """A law that knows nothing of it: log(1 + times), and a twentieth of the log beyond four."""
    assert (ENOUGH, MORE) == (4.0, 0.05)
    law = [1.0, 0.0, 0.0]
    for square, price in ((8.0, 4.0), (2.0, 1.0), (2e6, 1e6)):
        found = _worth(told(law, [0.0, np.sqrt(square), 0.0]), 1, np.array([price]))
        assert found == pytest.approx(np.log(3.0) + MORE * NONE)
    much = _worth(told(law, [0.0, np.sqrt(100.0), 0.0]), 1, np.array([5.0]))
    assert much == pytest.approx(np.log(5.0) + MORE * np.log(20.0))
    assert _worth(told(law, [0.0, 0.0, 0.0]), 1, np.array([5.0])) == pytest.approx(MORE * NONE)


def test_what_the_law_makes_up_for_is_worth_nothing() -> None:
    """Of a change (3, 4) a law along the first axis leaves 4."""
    found = _worth(told([2.0, 0.0], [3.0, 4.0]), 1, np.array([16.0]))
    assert found == pytest.approx(np.log(2.0) + MORE * NONE)
    assert _worth(told([2.0, 0.0], [3.0, 0.0]), 1, np.array([16.0])) == pytest.approx(MORE * NONE)
    # A law that these motions do not move takes nothing.
    whole = _worth(told([0.0, 0.0], [3.0, 4.0]), 1, np.array([25.0]))
    assert whole == pytest.approx(np.log(2.0) + MORE * NONE)


def test_an_effect_counts_apart_from_its_likest_rival() -> None:
    """Changes (0, 3, 4) and (0, 0, 5): of the first 9 stay, of the second 25 - 20^2 / 25; a third
    that shares less takes nothing more."""
    law, prices = [1.0, 0.0, 0.0, 0.0], np.array([9.0, 9.0, 1e9])
    found = _worth(
        told(law, [0.0, 3.0, 4.0, 0.0], [0.0, 0.0, 5.0, 0.0], [0.0, 0.1, 0.0, 1.0]), 1, prices
    )
    assert found == pytest.approx(2.0 * np.log(2.0) + 3.0 * MORE * NONE, abs=1e-6)
    # Two that are one are worth nothing, neither of them.
    alike = _worth(told(law, [0.0, 3.0, 4.0, 0.0], [0.0, 3.0, 4.0, 0.0]), 1, prices[:2])
    assert alike == pytest.approx(2.0 * MORE * NONE, abs=1e-9)


def test_without_its_best_motion_a_plan_is_worth_the_rest() -> None:
    small, large = told([1.0, 0.0], [0.0, 1.0]), told([1.0, 0.0], [0.0, 10.0])
    prices = np.array([50.0])
    without_large = _worth(2.0 * small, 1, prices)
    assert _least_worth([0, 1, 0], [small, large], 1, prices) == pytest.approx(without_large)
    # Of a motion that is there twice one stays.
    assert _least_worth([1, 1], [small, large], 1, prices) == pytest.approx(
        _worth(large, 1, prices)
    )


def test_motions_are_chosen_for_what_is_not_told_yet() -> None:
    """Two effects, two motions that each tell one of them, and one that tells little of both."""
    law = [1.0, 0.0, 0.0]
    one = told(law, [0.0, 3.0, 0.0], [0.0, 0.0, 0.0])
    other = told(law, [0.0, 0.0, 0.0], [0.0, 0.0, 2.9])
    both = told(law, [0.0, 0.5, 0.0], [0.0, 0.0, 0.5])
    prices = np.array([5.0, 5.0])
    chosen = _chosen([both, one, other], 1, prices, 4)
    assert len(chosen) == 4
    assert sorted(chosen) == [1, 1, 2, 2]
    assert _chosen([one, both], 1, prices, 0) == []
    # Of motions that are worth the same the first.
    assert _chosen([one, one], 1, prices, 1) == [0]


def test_what_was_chosen_is_not_chosen_for_once_more() -> None:
    """Squares of 3 and of 2.9 at a price of one: of a third motion log(1 + 4) is left to gain, from
    log 4 of the first or from log 3.9 of the second; twice the first would be worth less."""
    law = [1.0, 0.0, 0.0]
    one = told(law, [0.0, np.sqrt(3.0), 0.0], [0.0, 0.0, 0.0])
    other = told(law, [0.0, 0.0, 0.0], [0.0, 0.0, np.sqrt(2.9)])
    assert _chosen([one, other], 1, np.ones(2), 3) == [0, 1, 1]


def test_a_motion_tells_by_its_slopes_and_by_what_effects_change(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By the logarithm of the first parameter, 3, and by the second itself; in noises of 0.5 N, of
    samples that are worth a quarter each."""
    module = sys.modules["jbf.diagnosis.plan"]
    monkeypatch.setattr(module, "imposed", lambda rig, run: "imposed")
    monkeypatch.setattr(module, "core_motion", lambda rig, run, motion: (run, motion))
    monkeypatch.setattr(module, "effective_share", lambda solution: 0.25)
    friction = np.array([1.0, 2.0, 4.0])
    slopes = np.array([[1.0, 0.0], [0.0, 1.0], [2.0, 1.0]])

    def jacobian(values: Any, motions: Any, by: Any) -> Any:
        assert (values.tolist(), motions, by) == ([3.0, 5.0, 7.0], [("run", "imposed")], [0, 2])
        return [(friction, slopes)]

    problem = SimpleNamespace(
        chain=SimpleNamespace(jacobian=jacobian), log=np.array([True, True, False]), open=[0, 2]
    )
    fitted = SimpleNamespace(
        problem=problem, found=lambda: SimpleNamespace(values=np.array([3.0, 5.0, 7.0]))
    )
    candidates: Any = SimpleNamespace(fitted=lambda effects: fitted)
    model: Any = SimpleNamespace(rig=None, effects=())
    way = np.array([0.0, 6.0, 8.0])
    chain = SimpleNamespace(predict=lambda times, motions: [friction + times * way])
    effect: Any = SimpleNamespace(problem=SimpleNamespace(chain=chain), values=lambda times: times)
    run: Any = "run"
    rows = np.column_stack([3.0 * slopes[:, 0], slopes[:, 1], way])
    found = _told(candidates, model, [effect], run, 0.5)
    assert found == pytest.approx(rows.T @ rows * 0.25 / 0.5**2)


def test_effects_that_motions_could_show_are_those_of_known_columns(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And that are not in the model, and have a null; whichever comes first."""
    module = sys.modules["jbf.diagnosis.plan"]
    columns = {
        "there": (),
        "strange": ("pressure_pa",),
        "endless": (),
        "a": ("angle_rad",),
        "b": (),
    }
    monkeypatch.setattr(module, "find_effect", lambda name: SimpleNamespace(columns=columns[name]))
    monkeypatch.setattr(
        module, "strength_of", lambda c, present, name: None if name == "endless" else name
    )
    candidates: Any = SimpleNamespace(names=list(columns))
    model: Any = SimpleNamespace(effects=("there",))
    found: Any = _effects(candidates, model)
    assert found == ["a", "b"]
