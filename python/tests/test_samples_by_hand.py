"""Samples and what is made of them, in small numbers: sizes, weights, parts and rows."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.rows import GROUP, MOST_SEARCHED, every_so_many, groups_of, triangular
from jbf.estimation.samples import Samples, least_weights

Array = npt.NDArray[np.float64]

COUNTED = (np.array([True, True, False, True]), np.array([True, False, True]))
WEIGHT = (np.array([1.0, 0.5, 0.0, 1.0]), np.array([1.0, 0.25, 1.0]))
SAMPLES = Samples(("a", "b"), (0.02, 0.1), COUNTED, WEIGHT)
VALUES = [np.array([1.0, 2.0, 3.0, 4.0]), np.array([5.0, 6.0, 7.0])]
COLOURED = Noise(0.1, 0.5)


def test_those_that_count_stand_in_a_row() -> None:
    assert SAMPLES.count == 5
    assert SAMPLES.flat(VALUES).tolist() == [1.0, 2.0, 4.0, 5.0, 7.0]
    assert SAMPLES.rms(VALUES) == pytest.approx(np.sqrt((1 + 4 + 16 + 25 + 49) / 5.0))
    # Of a square each weighs its weight: 1 + 1 + 16 + 25 + 2.25 + 49.
    assert SAMPLES.square(VALUES) == pytest.approx(94.25)
    nothing = SAMPLES.within([np.zeros(4, dtype=bool), np.zeros(3, dtype=bool)])
    assert (nothing.count, nothing.rms(VALUES), nothing.square(VALUES)) == (0, 0.0, 0.0)
    assert nothing.cost(VALUES, WHITE) == 0.0


def test_samples_are_one_where_they_are_the_same_and_stay_what_they_are() -> None:
    assert replace(SAMPLES) != SAMPLES
    assert {SAMPLES: 1}[SAMPLES] == 1
    with pytest.raises(FrozenInstanceError):
        SAMPLES.runs = ()  # type: ignore[misc]


def test_parts_keep_what_belongs_together() -> None:
    level = tuple(0.5 * np.ones(len(w)) for w in WEIGHT)
    between = BetweenRuns(("zero",), (np.ones((4, 1)), 2.0 * np.ones((3, 1))), 0.7)
    whole = replace(SAMPLES, level=level, between=between)
    one = whole.only([1])
    assert (one.runs, one.steps_s) == (("b",), (0.1,))
    assert one.counted[0] is COUNTED[1]
    assert one.weight[0] is WEIGHT[1]
    assert one.level is not None
    assert one.level[0] is level[1]
    assert one.between is not None
    assert one.between.directions == (between.directions[1],)
    assert (one.between.names, one.between.sigma_n) == (("zero",), 0.7)
    assert SAMPLES.only([0]).between is None
    assert SAMPLES.only([0]).level is None
    turned = SAMPLES.only([1, 0])
    assert turned.runs == ("b", "a")


def test_halves_part_each_run_in_its_middle() -> None:
    first, second = SAMPLES.halves()
    assert [c.tolist() for c in first.counted] == [[True, True, False, False], [True, False, False]]
    assert [w.tolist() for w in first.weight] == [[1.0, 0.5, 0.0, 0.0], [1.0, 0.0, 0.0]]
    assert [c.tolist() for c in second.counted] == [[False] * 3 + [True], [False, False, True]]
    assert [w.tolist() for w in second.weight] == [[0.0, 0.0, 0.0, 1.0], [0.0, 0.25, 1.0]]


def test_weights_are_multiplied_and_levels_remembered() -> None:
    level = [np.full(4, 0.5), np.full(3, 0.8)]
    robust = [np.full(4, 0.1), np.full(3, 1.0)]
    once = SAMPLES.weighed(level, robust, None)
    assert [w.tolist() for w in once.weight] == [
        pytest.approx([0.05, 0.025, 0.0, 0.05]),
        pytest.approx([0.8, 0.2, 0.8]),
    ]
    assert once.level is not None
    assert [x.tolist() for x in once.level] == [[0.5] * 4, [0.8] * 3]
    again = once.weighed(level, robust, None)
    assert again.level is not None
    assert again.level[1] == pytest.approx(np.full(3, 0.64))
    assert again.weight[0][0] == pytest.approx(0.0025)
    assert again.counted is SAMPLES.counted


def test_a_test_gives_no_weight_to_what_does_not_count() -> None:
    assert [w.tolist() for w in SAMPLES.tested().weight] == [[1.0, 0.5, 0.0, 1.0], [1.0, 0.0, 1.0]]
    assert SAMPLES.tested().counted is SAMPLES.counted


def innovations(values: Array, step_s: float, noise: Noise) -> Array:
    """`e_t = r_t - phi r_t-1 + phi (1 - colour) e_t-1`, one after the other."""
    phi = np.exp(-step_s / noise.memory_s)
    e = np.zeros(len(values))
    for k, value in enumerate(values.tolist()):
        past = (values[k - 1], e[k - 1]) if k else (0.0, 0.0)
        e[k] = value - phi * past[0] + phi * (1.0 - noise.colour) * past[1]
    return e


def test_rows_are_innovations_of_what_has_weight() -> None:
    slopes = [np.stack([v, v**2], axis=1) for v in VALUES]
    r, j = SAMPLES.stacked(VALUES, slopes, COLOURED)
    wanted, columns = [], []
    for v, w, step, slope in zip(VALUES, WEIGHT, SAMPLES.steps_s, slopes, strict=True):
        keep = w > 0.0
        wanted.append(innovations(v * w, step, COLOURED)[keep])
        columns.append(
            np.stack([innovations(slope[:, k] * w, step, COLOURED)[keep] for k in (0, 1)], axis=1)
        )
    assert r == pytest.approx(np.concatenate(wanted))
    assert j == pytest.approx(np.concatenate(columns))
    second, _ = SAMPLES.stacked(VALUES, slopes, COLOURED, [1])
    assert second == pytest.approx(wanted[1])
    # Minus twice the log likelihood: of six innovations.
    count = len(r)
    assert count == 6
    assert SAMPLES.cost(VALUES, COLOURED) == pytest.approx(count * np.log(float(r @ r) / count))


def test_innovations_for_tests_are_of_what_counts() -> None:
    """By the weight of each, by the level of the noise alone, and with what has weight but does
    not count."""
    level = (np.full(4, 0.5), np.full(3, 0.25))
    samples = replace(SAMPLES, level=level)
    for found, weights in (
        (
            samples.innovations(VALUES, COLOURED),
            [c * w for c, w in zip(COUNTED, WEIGHT, strict=True)],
        ),
        (
            samples.plain_innovations(VALUES, COLOURED),
            [c * s for c, s in zip(COUNTED, level, strict=True)],
        ),
    ):
        for e, v, w, c, step in zip(found, VALUES, weights, COUNTED, SAMPLES.steps_s, strict=True):
            assert e == pytest.approx(innovations(v * w, step, COLOURED) * c)
    whole = samples.weighted_innovations(VALUES, COLOURED)
    for e, v, w, step in zip(whole, VALUES, WEIGHT, SAMPLES.steps_s, strict=True):
        assert e == pytest.approx(innovations(v * w, step, COLOURED) * (w > 0.0))
    plain = SAMPLES.plain_innovations(VALUES, WHITE)
    assert [e.tolist() for e in plain] == [[1.0, 2.0, 0.0, 4.0], [5.0, 0.0, 7.0]]


def test_deviations_of_runs_are_shrunk_and_taken_off() -> None:
    """A zero of one deviation is 2 N; of three readings at 3 N over a noise of 1 N it is
    sum / (n + 1 / 4): 36 / 13 of 3 N."""
    every = np.ones(3, dtype=bool)
    between = BetweenRuns(("zero",), (np.full((3, 1), 2.0),), 1.0)
    samples = Samples(("a",), (0.02,), (every,), (np.ones(3),), between)
    (left,) = samples.without_deviations([np.full(3, 3.0)], WHITE)
    assert left == pytest.approx(np.full(3, 3.0 - 36.0 / 13.0))
    assert SAMPLES.without_deviations(VALUES, WHITE) == VALUES
    # One direction of size sqrt(12): whitened it is 1 / sqrt(13) of itself.
    r, _ = samples.stacked([np.full(3, 3.0)], [np.zeros((3, 0))], WHITE)
    assert r == pytest.approx(np.full(3, 3.0 / np.sqrt(13.0)))
    assert samples.cost([np.full(3, 3.0)], WHITE) == pytest.approx(3.0 * np.log(9.0 / 13.0))
    assert samples.within([~every]).cost([np.full(3, 3.0)], WHITE) == 0.0
    # Of a single one, 2 N as usual beside 1 N: a fifth of its square.
    first = samples.within([np.arange(3) == 0])
    assert first.cost([np.full(3, 3.0)], WHITE) == pytest.approx(np.log(9.0 / 5.0))
    assert between.log_determinant([np.ones(3)], (0.02,), WHITE) == pytest.approx(np.log(13.0))


def test_two_models_share_the_smaller_weight() -> None:
    other = replace(
        SAMPLES,
        counted=(np.array([False, True, True, True]), COUNTED[1]),
        weight=(np.array([0.2, 1.0, 1.0, 1.0]), np.array([1.0, 0.1, 0.5])),
    )
    assert least_weights(SAMPLES, SAMPLES) is SAMPLES
    for shared in (least_weights(SAMPLES, other), least_weights(other, SAMPLES)):
        assert [c.tolist() for c in shared.counted] == [
            [False, True, False, True],
            [True, False, True],
        ]
        assert [w.tolist() for w in shared.weight] == [[0.2, 0.5, 0.0, 1.0], [1.0, 0.1, 0.5]]


@pytest.mark.parametrize("fewer", [[VALUES[0]], [*VALUES, VALUES[0]]])
def test_runs_and_their_samples_go_in_step(fewer: list[Array]) -> None:
    """One too few or too many is a fault, and is not dropped in silence."""
    masks = [np.ones(len(v), dtype=bool) for v in fewer]
    ones = [np.ones(len(c)) for c in COUNTED]
    broken = [
        lambda: SAMPLES.within(masks),
        lambda: SAMPLES.weighed(fewer, ones, None),
        lambda: SAMPLES.weighed(ones, fewer, None),
        lambda: replace(SAMPLES, level=tuple(fewer)).weighed(ones, ones, None),
        lambda: replace(SAMPLES, weight=tuple(fewer)).tested(),
        lambda: SAMPLES.flat(fewer),
        lambda: SAMPLES.rms(fewer),
        lambda: SAMPLES.square(fewer),
        lambda: SAMPLES.cost(fewer, WHITE),
        lambda: SAMPLES.weighted_innovations(fewer, WHITE),
        lambda: SAMPLES.innovations(fewer, WHITE),
        lambda: SAMPLES.plain_innovations(fewer, WHITE),
        lambda: least_weights(SAMPLES, replace(SAMPLES, weight=tuple(fewer))),
        lambda: least_weights(SAMPLES, replace(SAMPLES, counted=tuple(masks))),
    ]
    for call in broken:
        with pytest.raises(ValueError, match="zip"):
            call()


# ---- rows --------------------------------------------------------------------------------------


def test_runs_are_held_in_groups_of_so_many_numbers() -> None:
    third = GROUP // 30
    assert groups_of([third] * 7, 10) == [[0, 1, 2], [3, 4, 5], [6]]
    # A run that is more than a group is one by itself.
    assert groups_of([3 * GROUP, 1, 1], 1) == [[0], [1, 2]]
    assert groups_of([GROUP // 2, GROUP // 2, 1], 1) == [[0, 1], [2]]
    assert groups_of([], 3) == []


def test_of_very_many_samples_some_runs_are_searched() -> None:
    """With twice as many as a search takes every fourth run, by name."""
    names = [f"{k:02d}" for k in range(20)]
    length = 2 * MOST_SEARCHED // 20
    assert every_so_many([length] * 20, names) == [0, 4, 8, 12, 16]
    assert every_so_many([length] * 20, names[::-1]) == [3, 7, 11, 15, 19]
    # Half of 400,000 are as many as it takes, and so are all of them; of one more there are two
    # for each, and a bit.
    assert every_so_many([20_000] * 20, names) == list(range(20))
    assert every_so_many([20_000] * 19 + [20_001], names) == [0, 3, 6, 9, 12, 15, 18]
    # Of a quarter more than it takes every third, two and a half being none.
    assert every_so_many([5 * length // 8] * 20, names) == [0, 3, 6, 9, 12, 15, 18]
    # No more than a search takes: all of them; and so where runs are few.
    assert every_so_many([length // 2] * 20, names) == list(range(20))
    assert every_so_many([10 * length] * 2, names[:2]) == [0, 1]
    assert every_so_many([20 * length // 7] * 7, names[:7]) == list(range(7))
    assert every_so_many([20 * length // 8] * 8, names[:8]) == [0, 4]


def test_few_rows_say_the_same() -> None:
    random = np.random.default_rng(1)
    r, j = random.standard_normal(50), random.standard_normal((50, 3))
    few, slopes = triangular(r, j)
    assert slopes.shape == (4, 3)
    assert slopes.T @ slopes == pytest.approx(j.T @ j)
    assert slopes.T @ few == pytest.approx(j.T @ r)
    assert few @ few == pytest.approx(r @ r)
