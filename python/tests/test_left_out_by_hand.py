"""What was left out of a fit, and whether that confirms one: rules and ratios in small numbers."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Parameter
from jbf.diagnosis.confirmation import Confirmation, left_out_confirms
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.left_out import (
    INSENSITIVE,
    MOST_FITS,
    LeftOut,
    _at,
    _groups,
    _held,
    _known,
    _straight,
    _Told,
    _unknown,
    errors_by_run,
    left_out,
    only_witnesses,
)
from jbf.estimation.noise import WHITE
from jbf.estimation.solution import Solution
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
N = 6
EVERY = np.ones(N, dtype=bool)
FIRST = np.arange(N) < 3
TOLD = np.ones(1, dtype=bool)


def solution(
    jacobian: list[Array], residuals: list[Array] | None = None, counted: list[Array] | None = None
) -> Solution:
    prepared = [record(0.02 * np.arange(len(j)), name="abcdef"[i]) for i, j in enumerate(jacobian)]
    left = [np.zeros(len(j)) for j in jacobian] if residuals is None else residuals
    values = np.ones(jacobian[0].shape[1])
    return Solution((), values, left, jacobian, WHITE, 0.0, True, "", samples_of(prepared, counted))


# ---- parts -------------------------------------------------------------------------------------


def test_runs_that_have_part_are_taken_out() -> None:
    parts = tuple(np.full(N, float(k)) for k in range(3))
    whole = LeftOut((4, 1, 7), (EVERY, FIRST, ~FIRST), TOLD, parts)
    some = whole.without((4, 9))
    assert some.runs == (1, 7)
    assert some.left[0] is FIRST
    assert [float(r[0]) for r in some.residuals] == [1.0, 2.0]
    assert some.told is TOLD
    assert whole.without(()).runs == (4, 1, 7)


def test_errors_are_of_what_was_left_out_and_counts() -> None:
    """Halves of one run take turns; each sample's error is of the fit that did not know it."""
    counted = [np.array([1, 1, 1, 1, 1, 0]), np.array([0, 1, 1, 1, 1, 1])]
    there = solution([np.zeros((N, 1))] * 2, counted=counted)
    up, down = np.arange(N, dtype=float), -np.arange(N, dtype=float)
    parts = [
        LeftOut((1,), (FIRST,), TOLD, (up,)),
        LeftOut((0,), (EVERY,), TOLD, (10.0 + up,)),
        LeftOut((1,), (~FIRST,), TOLD, (down,)),
    ]
    found = errors_by_run(there, parts)
    assert {i: e.tolist() for i, e in found.items()} == {
        0: [10.0, 11.0, 12.0, 13.0, 14.0],
        1: [1.0, 2.0, -3.0, -4.0, -5.0],
    }
    assert list(found) == [0, 1]
    fewer = errors_by_run(there, parts, counted=[FIRST, FIRST])
    assert [len(e) for e in fewer.values()] == [3, 3]
    # Where nothing is known to deviate, apart is the same.
    apart = errors_by_run(there, parts, apart=True)
    assert {i: e.tolist() for i, e in apart.items()} == {i: e.tolist() for i, e in found.items()}


def test_of_many_runs_twelve_groups_are_left_out() -> None:
    """Neighbours by name are not together, in whatever order runs are given."""
    assert MOST_FITS == 12
    assert _groups(["b", "a", "c"]) == [[1], [0], [2]]
    names = [f"{k:02d}" for k in range(26)]
    groups = _groups(names)
    assert len(groups) == 12
    assert groups[0] == [0, 12, 24]
    assert groups[1] == [1, 13, 25]
    assert groups[11] == [11, 23]
    turned = _groups(names[::-1])
    assert [sorted(25 - k for k in g) for g in turned] == groups


# ---- who knows what ----------------------------------------------------------------------------


def test_runs_say_nothing_of_what_they_hold_a_ten_thousandth_of() -> None:
    known = np.array([[1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    rest = np.array([0.9 * INSENSITIVE, 2.1 * INSENSITIVE, 0.0])
    assert INSENSITIVE == 1e-4
    assert _unknown(np.array([[2.0]]), np.array([2.0 * INSENSITIVE])).tolist() == [False]
    assert _unknown(known, rest).tolist() == [True, False, False]
    assert _unknown(known, np.array([1.1 * INSENSITIVE, 1.9 * INSENSITIVE, 0.0])).tolist() == [
        False,
        True,
        False,
    ]


def test_what_counts_is_known() -> None:
    jacobian = [np.column_stack([np.arange(4.0), np.ones(4)]), np.full((3, 2), 2.0)]
    there = solution(jacobian, counted=[np.array([1, 1, 1, 0]), np.array([1, 0, 1])])
    assert _known(there).tolist() == [[5.0, 3.0], [8.0, 8.0]]


def test_a_run_that_alone_knows_a_parameter_is_its_witness() -> None:
    own = np.column_stack([np.ones(N), np.zeros(N)])
    both = np.ones((N, 2))
    problem: Any = SimpleNamespace(campaign=SimpleNamespace(prepared=[0, 1, 2]))
    assert only_witnesses(problem, solution([own, both, own])) == {1}
    assert only_witnesses(problem, solution([both, both, own])) == frozenset()
    little = both * [1.0, 0.009]
    assert only_witnesses(problem, solution([own, both, little])) == {1}
    assert only_witnesses(problem, solution([own, both, both * [1.0, 0.011]])) == frozenset()
    one: Any = SimpleNamespace(campaign=SimpleNamespace(prepared=[0]))
    assert only_witnesses(one, solution([both])) == frozenset()


def test_what_nobody_knows_is_held_at_its_null_or_where_a_search_starts() -> None:
    pages = {
        "F_c_n": Parameter("F_c_n", starts=(4.0, 9.0)),
        "one.b_n": Parameter("b_n", null=0.0, starts=(0.3,)),
        "one.sigma": Parameter("sigma", null=np.inf, starts=(3e3,)),
        "F_v": Parameter("F_v", starts=(1.0,)),
    }
    problem: Any = SimpleNamespace(open=[0, 1, 2], names=tuple(pages), parameters=pages)
    held = _held(problem, np.array([True, True, True]))
    assert held == {"F_c_n": 4.0, "one.b_n": 0.0, "one.sigma": 3e3}
    assert _held(problem, np.array([False, True, False])) == {"one.b_n": 0.0}
    assert _held(problem, np.zeros(3, dtype=bool)) == {}
    there: Any = SimpleNamespace(values=np.array([7.0, 8.0, 9.0, 10.0]))
    assert _at(problem, there, {"one.b_n": 0.0}).tolist() == [7.0, 0.0, 9.0, 10.0]


def test_a_step_to_the_rest_is_that_of_least_squares() -> None:
    """And as long, in units of what noise makes of steps, as its share of the square says."""
    random = np.random.default_rng(1)
    jacobian = [random.standard_normal((40, 2)) for _ in range(3)]
    residuals = [random.standard_normal(40) + j @ [0.5, -0.2] for j in jacobian]
    problem: Any = SimpleNamespace(campaign=SimpleNamespace(prepared=[0, 1, 2]))
    told = _Told.of(problem, solution(jacobian, residuals))
    assert told.innovations == [40, 40, 40]
    step, square = told.step([0, 2])
    j, r = np.concatenate([jacobian[0], jacobian[2]]), np.concatenate([residuals[0], residuals[2]])
    wanted = np.linalg.lstsq(j, r, rcond=None)[0]
    assert step == pytest.approx(wanted)
    assert square == pytest.approx(float(np.sum((j @ wanted) ** 2)) * 80.0 / float(r @ r))


@pytest.mark.parametrize(
    ("off", "moved", "size", "straight"),
    [
        # A twentieth of what it moves,
        (0.0495, 1.0, 1e-9, True),
        (0.0505, 1.0, 1e-9, False),
        # or of a hundredth of the residual.
        (4.95e-4, 1e-9, 1.0, True),
        (5.05e-4, 1e-9, 1.0, False),
        (5.0e-4, 0.01, 1.0, True),
    ],
)
def test_a_step_is_straight_where_predictions_follow_their_derivatives(
    off: float, moved: float, size: float, straight: bool
) -> None:
    here = size * np.where(np.arange(N) % 2, 1.0, -1.0)
    there = solution([np.zeros((N, 1)), np.full((N, 1), moved)], [np.zeros(N), here])
    after = here - moved + off
    assert _straight(there, np.ones(1), [1], [after]) == straight


# ---- whether it confirms -----------------------------------------------------------------------

W, G = DEFAULT.weak, DEFAULT.least_left_out_gain


@pytest.mark.parametrize(
    ("evidence", "density", "share", "better", "times", "confirms"),
    [
        # Weak evidence asks for half of the gain in the predictive density, and for that alone.
        (W, G + 0.01, -1.0, 0.0, 1.0, True),
        (W, G, 1.0, 1.0, 1.0, False),
        (0.1, G - 0.01, 1.0, 1.0, 0.5, False),
        # Strong evidence for any gain,
        (W + 0.1, -9.0, 1e-9, 0.0, 1.0, True),
        (W + 0.1, 9.0, 0.0, 0.0, 1.0, False),
        # or for one in most of the runs;
        (W + 0.1, -9.0, -1.0, DEFAULT.least_better_runs, 1.0, True),
        (W + 0.1, -9.0, -1.0, DEFAULT.least_better_runs - 0.01, 1.0, False),
        # neither where what is left out is predicted far worse.
        (W, 1.0, 1.0, 1.0, DEFAULT.left_out_worse, True),
        (W, 1.0, 1.0, 1.0, DEFAULT.left_out_worse + 0.01, False),
        (1e9, 1.0, 1.0, 1.0, DEFAULT.left_out_worse + 0.01, False),
    ],
)
def test_what_was_left_out_confirms(
    evidence: float, density: float, share: float, better: float, times: float, confirms: bool
) -> None:
    assert left_out_confirms(evidence, density, share, better, DEFAULT, times) == confirms


def test_a_gain_of_what_was_left_out_is_a_share_of_that_in_the_fit() -> None:
    """Only its sign decides; the ratio is of what is left with it to what is left without."""
    strong = DEFAULT.weak + 1.0
    assert Confirmation(2.0, 1.999, 0.0, 0.0).confirms(strong, 1.0, DEFAULT)
    assert not Confirmation(2.0, 2.001, 0.0, 0.0).confirms(strong, 1.0, DEFAULT)
    most = 2.0 * DEFAULT.left_out_worse
    assert Confirmation(2.0, most - 1e-3, 1.0, 1.0).confirms(strong, 1.0, DEFAULT)
    assert not Confirmation(2.0, most + 1e-3, 1.0, 1.0).confirms(strong, 1.0, DEFAULT)


def test_what_was_left_out_is_said() -> None:
    plain = Confirmation(2.0, 1.23456, 0.5, 0.257)
    assert plain.said("N") == "left-out runs 1.235 N"
    assert plain.lacking("N m") == "left-out runs 1.235 N m, 26% of the gain in their log density"
    one = Confirmation(2.0, 1.5, 0.5, 0.2, ("a",))
    assert one.said("N") == "left-out runs and halves of a 1.5 N"
    three = Confirmation(2.0, 1.5, 0.5, 0.2, ("a", "b", "c"))
    assert three.said("N") == "left-out runs and halves of a and 2 more 1.5 N"


def test_halves_of_a_single_run_take_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of seven samples the first three predict the last four, and the other way round."""
    asked: list[Any] = []

    def search(problem: Any, kept: Any, values: Any, noise: Any, evaluations: int) -> Any:
        asked.append(kept.counted[0].tolist())
        return SimpleNamespace(values=np.array([float(len(asked))]))

    monkeypatch.setattr(sys.modules["jbf.estimation.left_out"], "search", search)
    problem: Any = SimpleNamespace(
        campaign=SimpleNamespace(prepared=[0]),
        residuals=lambda values: [np.full(7, values[0])],
    )
    first = [True] * 3 + [False] * 4
    last = [not x for x in first]
    parts = left_out(problem, solution([np.ones((7, 1))]))
    assert asked == [first, last]
    assert [part.left[0].tolist() for part in parts] == [last, first]
    assert [float(part.residuals[0][0]) for part in parts] == [1.0, 2.0]
    assert [part.runs for part in parts] == [(0,), (0,)]
