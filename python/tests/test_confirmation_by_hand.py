"""What runs left out say of a candidate, by their errors as told; and its words."""

from __future__ import annotations

import sys
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.diagnosis.confirmation import Confirmation, left_out_confirms
from jbf.diagnosis.policy import DEFAULT

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.diagnosis.confirmation"]
STRONG = DEFAULT.weak + 1.0


def of(
    monkeypatch: pytest.MonkeyPatch, before: dict[int, Array], after: dict[int, Array]
) -> Confirmation:
    """Of errors by run without a candidate and with it, at the samples that both count."""

    def errors(solution: Any, left: Any, *, apart: bool, counted: Any) -> dict[int, Array]:
        assert apart
        assert (left, counted) == (f"left out of {solution.name}", "counted in both")
        return before if solution.name == "simpler" else after

    monkeypatch.setattr(module, "errors_by_run", errors)
    monkeypatch.setattr(
        module,
        "least_weights",
        lambda one, other: SimpleNamespace(counted=f"counted in {'both' if one != other else one}"),
    )
    monkeypatch.setattr(module, "_density_share", lambda *told: 0.7)
    simpler: Any = SimpleNamespace(name="simpler", samples="all")
    richer: Any = SimpleNamespace(name="richer", samples="few")
    left: Any = "left out of simpler"
    richer_left: Any = "left out of richer"
    return Confirmation.of(simpler, richer, left, richer_left, ("c",))


def test_runs_count_by_their_samples_and_each_once_for_how_many_are_better(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two of three are better; just as good is not, and a run of which nothing counts is none."""
    before = {0: np.full(4, 2.0), 1: np.full(12, 1.0), 2: np.full(4, 3.0), 3: np.zeros(0)}
    after = {0: np.full(4, -1.0), 1: np.full(12, 0.5), 2: np.full(4, -3.0), 3: np.zeros(0)}
    found = of(monkeypatch, before, after)
    assert found.before_n == pytest.approx(np.sqrt((4 * 4.0 + 12 * 1.0 + 4 * 9.0) / 20.0))
    assert found.after_n == pytest.approx(np.sqrt((4 * 1.0 + 12 * 0.25 + 4 * 9.0) / 20.0))
    assert found.better == pytest.approx(2.0 / 3.0)
    assert (found.density, found.halved) == (0.7, ("c",))


def test_where_nothing_counts_nothing_is_better(monkeypatch: pytest.MonkeyPatch) -> None:
    found = of(monkeypatch, {0: np.zeros(0)}, {0: np.zeros(0)})
    assert (found.before_n, found.after_n, found.better) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("before", "after", "confirmed"),
    [
        (0.6, 0.5, True),
        (1.5, 1.6, False),
        (1.0, 1.2, False),
        (1.0, 1.0, False),
        # Of nothing that was left any error is worse.
        (0.0, 1e-9, False),
    ],
)
def test_strong_evidence_is_confirmed_by_any_gain(
    before: float, after: float, confirmed: bool
) -> None:
    """In mean square, whatever it gained where it was fitted."""
    found = Confirmation(before, after, 0.5, 0.0)
    for gained in (1e-6, 1.0, 100.0):
        assert found.confirms(STRONG, gained, DEFAULT) == confirmed
    assert found.confirms(STRONG, 0.0, DEFAULT) == confirmed


@pytest.mark.parametrize(
    ("evidence", "density", "gained", "better", "times", "confirmed"),
    [
        # Weak evidence, up to its limit, by more than half of the density alone.
        (DEFAULT.weak, 0.5, 1.0, 1.0, 1.0, False),
        (DEFAULT.weak, 0.51, -1.0, 0.0, 1.0, True),
        (DEFAULT.weak + 0.1, 0.51, -1.0, 0.0, 1.0, False),
        # Strong evidence by any gain, or in two of three runs.
        (STRONG, 0.0, 1e-9, 0.0, 1.0, True),
        (STRONG, 0.0, 0.0, 0.65, 1.0, False),
        (STRONG, 0.0, 0.0, DEFAULT.least_better_runs, 1.0, True),
        # Errors that are a quarter larger may be, and no more.
        (STRONG, 0.0, 1.0, 1.0, DEFAULT.left_out_worse, True),
        (STRONG, 0.0, 1.0, 1.0, DEFAULT.left_out_worse + 0.01, False),
        (DEFAULT.weak, 0.9, 1.0, 1.0, DEFAULT.left_out_worse + 0.01, False),
    ],
)
def test_what_runs_left_out_must_confirm(
    evidence: float, density: float, gained: float, better: float, times: float, confirmed: bool
) -> None:
    assert left_out_confirms(evidence, density, gained, better, DEFAULT, times) == confirmed


def test_words_name_the_first_of_the_halved_runs() -> None:
    whole = Confirmation(2.0, 1.23456, 1.0, 0.4567)
    assert whole.said("N") == "left-out runs 1.235 N"
    assert whole.lacking("N m") == "left-out runs 1.235 N m, 46% of the gain in their log density"
    one = replace(whole, halved=("a",))
    assert one.said("N") == "left-out runs and halves of a 1.235 N"
    three = replace(whole, halved=("a", "b", "c"))
    assert three.said("N") == "left-out runs and halves of a and 2 more 1.235 N"
