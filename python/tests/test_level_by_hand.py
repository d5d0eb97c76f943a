"""The level of the tests worked by hand: prices, directions, turned signs and decoys."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import LAW, coulomb, four_runs
from jbf import Rig
from jbf.diagnosis.decoys import DRAWS as DECOYS
from jbf.diagnosis.level import DRAWS, Directions, Level, calibrated, score_test, with_decoys
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import likelihood_gain
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from scipy import stats

Array = npt.NDArray[np.float64]
OPEN = Level(false_alarms=0.01, candidates=1, chance=1.0)
"""A level that lets everything pass until it is calibrated."""


# ---- prices ------------------------------------------------------------------------------------


def test_a_level_is_shared_among_the_candidates() -> None:
    policy = replace(DEFAULT, false_alarms=0.02, indifference=0.05, imperfection=7.0)
    level = Level.shared(policy, 8, 1000.0, 4.0)
    assert (level.false_alarms, level.candidates, level.blocks) == (0.02, 8, 0)
    assert level.chance == 0.0025
    assert level.imperfection == 7.0
    # A twentieth of the residual, squared, in each of 1000 samples.
    assert level.worth == pytest.approx(2.5)
    # Or so many newtons of its 4 N.
    newtons = replace(policy, indifference_n=1.0)
    assert Level.shared(newtons, 8, 1000.0, 4.0).worth == pytest.approx(1000.0 / 16.0)
    assert Level.shared(newtons, 8, 1000.0, 40.0).worth == pytest.approx(2.5)
    assert Level.shared(policy, 0, 1000.0, 4.0).chance == 0.02


def test_a_gain_must_exceed_what_noise_recordings_and_indifference_ask() -> None:
    level = Level(0.02, 8, 1e-4, imperfection=5.0, worth=3.0)
    assert level.critical == pytest.approx(stats.chi2.isf(1e-4, 1))
    assert level.white == pytest.approx(stats.chi2.isf(0.0025, 1))
    assert level.critical > level.white + 5.0
    assert level.price(1, 100) == level.critical
    assert replace(level, imperfection=9.0).price(1, 100) == level.white + 9.0
    assert replace(level, worth=50.0).price(1, 100) == 50.0
    # Each parameter beyond the first what Schwarz asks.
    assert level.price(3, 100) == pytest.approx(level.critical + 2.0 * np.log(100.0))
    assert level.price(0, 100) == level.critical
    assert level.price(3, 0) == level.critical
    told = level.to_dict()
    assert (told["critical"], told["white"], told["chance"]) == (level.critical, level.white, 1e-4)
    assert replace(level, candidates=0).white == pytest.approx(stats.chi2.isf(0.02, 1))


def test_a_level_alone_asks_for_what_noise_gains() -> None:
    """Nine in ten times that is less than a tenth: nothing else is asked for."""
    level = Level(0.9, 1, 0.9)
    assert level.price(1, 100) == pytest.approx(stats.chi2.isf(0.9, 1))
    assert (level.blocks, level.decoys, level.decoys_named) == (0, 0, 0)


def test_forty_draws_are_beyond_a_level_of_one_in_a_hundred() -> None:
    assert DRAWS * DEFAULT.false_alarms == 40.0


# ---- directions --------------------------------------------------------------------------------


def samples_of(*counts: int) -> Samples:
    masks = tuple(np.ones(n, dtype=bool) for n in counts)
    names = tuple(f"{i}" for i in range(len(counts)))
    return Samples(names, (0.02,) * len(counts), masks, tuple(m.astype(float) for m in masks))


def test_an_effect_shows_where_the_law_cannot_follow() -> None:
    """Of the columns of an effect what lies across the law's; one that the law has is none."""
    n = 600
    random = np.random.default_rng(1)
    law = random.standard_normal((n, 2))
    across = np.linalg.qr(np.column_stack([law, random.standard_normal((n, 2))]))[0][:, 2:]
    own = np.column_stack([5.0 * across[:, 0] + law[:, 0], law @ [2.0, -1.0], 1e-3 * across[:, 1]])
    e = 3.0 * random.standard_normal(n)
    for unit in (1e-6, 1e6):
        found = Directions.of(
            e, unit * own, np.column_stack([law, np.zeros(n)]), samples_of(400, 200), 1.0
        )
        assert found.ways.shape == (n, 2)
        assert found.ways.T @ found.ways == pytest.approx(np.eye(2), abs=1e-9)
        assert np.abs(found.ways.T @ across) == pytest.approx(np.eye(2), abs=1e-6)
    assert found.innovations == pytest.approx(e / np.sqrt(np.mean(e**2)))
    assert found.ends.tolist() == [400]
    assert found.blocks.tolist() == [*range(0, 400, 50), *range(400, 600, 50)]
    # Of white noise a score counts in full, and as little as a sample is worth.
    assert found.counted == pytest.approx([1.0, 1.0])
    less = Directions.of(e, own, law, samples_of(400, 200), 0.25)
    assert less.counted == pytest.approx([0.25, 0.25])


def test_runs_end_where_their_samples_of_some_weight_do() -> None:
    """Of 400 samples a hundred have none: they have no rows."""
    whole = samples_of(400, 200)
    first = whole.weight[0].copy()
    first[50:150] = 0.0
    some = replace(whole, weight=(first, whole.weight[1]))
    random = np.random.default_rng(4)
    e, own = random.standard_normal(500), random.standard_normal((500, 1))
    assert Directions.of(e, own, np.ones((500, 1)), some, 1.0).ends.tolist() == [300]


def test_a_score_where_the_noise_is_larger_counts_for_less() -> None:
    """A direction of some windows in which the noise is five times as large."""
    n = 8000
    here = np.arange(n) % 400 < 40
    e = np.where(here, 5.0, 1.0) * np.random.default_rng(2).standard_normal(n)
    found = Directions.of(e, here[:, None].astype(float), np.ones((n, 1)), samples_of(n), 1.0)
    assert found.counted[0] == pytest.approx(np.mean(e**2) / 25.0, rel=0.5)


def made(way: Array, e: Array, blocks: list[int], counted: float = 1.0) -> Directions:
    ways = way if way.ndim == 2 else way[:, None]
    share = np.full(ways.shape[1], counted)
    return Directions(ways, e, share, np.array(blocks), np.array([], dtype=np.intp))


def test_scores_are_summed_block_by_block() -> None:
    way = np.column_stack([np.arange(6.0), np.ones(6)])
    e = np.array([1.0, 2.0, 0.0, -1.0, 3.0, 1.0])
    found = made(way, e, [0, 2, 5], 0.25).by_block(e, np.array([0, 2, 5]))
    # 0 1 + 1 2; 2 0 - 3 + 4 3; 5: half of each, the root of a quarter.
    assert found == pytest.approx(0.5 * np.array([[2.0, 3.0], [9.0, 2.0], [5.0, 1.0]]))


# ---- turned signs ------------------------------------------------------------------------------


def halves(n: int, e: float = 1.0) -> Array:
    """Residuals of two blocks that cancel."""
    return np.concatenate((np.full(n // 2, e), np.full(n // 2, -e)))


@pytest.mark.parametrize(("n", "counted"), [(4, 1.0), (100, 1.0), (100, 0.25)])
def test_two_blocks_that_cancel_add_up_once_one_is_turned(n: int, counted: float) -> None:
    """Each scores sqrt(n) / 2: turned, together sqrt(n), in half of the draws."""
    one = made(np.full(n, n**-0.5), 7.0 * halves(n), [0, n // 2], counted)
    found = calibrated(OPEN, [one])
    assert found.chance == pytest.approx(stats.chi2.sf(counted * n, 1), rel=1e-3)
    assert found.blocks == 2
    assert (found.false_alarms, found.candidates) == (0.01, 1)
    # A level that is lower already stays.
    low = replace(OPEN, chance=1e-80)
    assert calibrated(low, [one]).chance == 1e-80


def test_what_a_candidate_explains_is_taken_away_first() -> None:
    way = np.full(100, 0.1)
    one = made(way, halves(100) + 3.0, [0, 50])
    assert calibrated(OPEN, [one]).chance == pytest.approx(stats.chi2.sf(100.0, 1), rel=1e-3)
    # Candidates whose directions are one are no more than one.
    again = calibrated(replace(OPEN, candidates=2), [one, one])
    assert again.chance == pytest.approx(stats.chi2.sf(100.0, 1), rel=1e-3)


@pytest.mark.parametrize(("allowed", "gain"), [(0.10, 16.0), (0.15, 4.0), (0.6, 4.0), (0.7, 0.0)])
def test_so_many_of_the_draws_may_have_a_name(allowed: float, gain: float) -> None:
    """Four scores of one each add up to 4 in an eighth of all draws, to 2 in one half, else to
    nothing."""
    way = np.full(16, 0.25)
    e = np.repeat([1.0, 1.0, -1.0, -1.0], 4)
    level = replace(OPEN, false_alarms=allowed)
    found = calibrated(level, [made(way, e, [0, 4, 8, 12])])
    assert found.chance == pytest.approx(stats.chi2.sf(gain, 1), rel=1e-3)
    assert found.blocks == 4
    assert DRAWS >= 1000


def test_candidates_that_say_nothing_keep_their_share() -> None:
    """Beside one that scores 2 of probability 0.0455 another says nothing, and may have as much:
    that is more than is allowed. Half of the least is."""
    one = made(np.full(4, 0.5), halves(4), [0, 2])
    nothing = made(np.zeros((4, 0)), halves(4), [0, 2])
    p = stats.chi2.sf(4.0, 1)
    assert calibrated(OPEN, [one, nothing]).chance == pytest.approx(p, rel=1e-3)
    two = replace(OPEN, candidates=2)
    assert calibrated(two, [one, nothing]).chance == pytest.approx(0.5 * p, rel=1e-3)
    # Where there is room for both it stays.
    wide = replace(two, false_alarms=0.06)
    assert calibrated(wide, [one, nothing]).chance == pytest.approx(p, rel=1e-3)
    assert calibrated(OPEN, [nothing]) is OPEN
    assert calibrated(OPEN, []) is OPEN


def test_more_that_are_told_than_candidates_leave_none_silent() -> None:
    """Four scores of one each, as above, of two directions that are one."""
    one = made(np.full(16, 0.25), np.repeat([1.0, 1.0, -1.0, -1.0], 4), [0, 4, 8, 12])
    found = calibrated(replace(OPEN, false_alarms=0.10), [one, one])
    assert found.chance == pytest.approx(stats.chi2.sf(16.0, 1), rel=1e-3)


def test_a_candidate_of_two_parameters_is_judged_by_both() -> None:
    """Two directions that score as one does: a chi-square of two degrees."""
    ways = np.zeros((8, 2))
    ways[:4, 0] = ways[4:, 1] = 0.5
    e = np.concatenate((halves(4), halves(4)))
    found = calibrated(replace(OPEN, false_alarms=0.2), [made(ways, e, [0, 2, 4, 6])])
    # Both add up in a quarter of all draws.
    assert found.chance == pytest.approx(stats.chi2.sf(8.0, 2), rel=1e-3)


def test_the_fewest_blocks_are_turned() -> None:
    coarse = made(np.full(16, 0.25), halves(16), [0, 8])
    fine = made(np.full(16, 0.25), halves(16), [0, 4, 8, 12])
    assert calibrated(OPEN, [fine, coarse]).blocks == 2


# ---- decoys ------------------------------------------------------------------------------------


def test_decoys_have_names_where_they_gain_more_than_the_price() -> None:
    way, random = np.full(64, 0.125), np.random.default_rng(3)
    ends = np.array([], dtype=np.intp)
    loud = Directions(way[:, None], np.full(64, 2.0), np.ones(1), np.array([0]), ends)
    # Wherever it is shifted the score is 16, its square 256.
    for price, named in ((255.9, DECOYS), (256.1, 0)):
        found = with_decoys(replace(OPEN, worth=price), [loud], 100)
        assert (found.decoys, found.decoys_named) == (DECOYS, named)
    # Of no noise nothing is gained, and that is no more than nothing.
    silent = replace(loud, innovations=np.zeros(64))
    free = Level(1.0, 1, 1.0)
    assert with_decoys(free, [silent], 100).decoys_named == 0
    # Any one of them is a name; a parameter more costs what Schwarz asks.
    dear = replace(loud, ways=np.column_stack([way, np.zeros(64)]), counted=np.ones(2))
    level = replace(OPEN, worth=256.1 - np.log(100.0))
    assert with_decoys(level, [dear], 100).decoys_named == 0
    assert with_decoys(level, [dear, loud], 100).decoys_named == DECOYS
    noisy = replace(loud, innovations=random.standard_normal(64))
    assert with_decoys(replace(OPEN, worth=5.0), [noisy], 100).decoys_named in (0, DECOYS)
    nothing = replace(loud, ways=np.zeros((64, 0)))
    assert with_decoys(level, [nothing], 100) is level


# ---- score tests -------------------------------------------------------------------------------


def solved(effects: tuple[str, ...], offset: float) -> tuple[Problem, Solution, Array]:
    """Coulomb's law and a zero that is off, fitted from where they are; and that start."""
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + offset, noise_n=0.1)
    problem = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", effects, {"F_s_n": 6.0})
    known = {"F_s_n": 6.0, **LAW, "sensor_offset.b_n": 0.0}
    start = problem.starts({n: known[n] for n in problem.names})[0]
    near = problem.solution(start, problem.samples_at(start), WHITE, False)
    return problem, settle(problem, near), start


def test_a_score_promises_what_a_fit_of_the_effect_gains() -> None:
    """A zero that is off adds a constant: one step goes all the way."""
    bare, near, _ = solved((), 0.03)
    # What is missing had passed for colour.
    cost = near.samples.cost(near.residuals, WHITE)
    near = replace(near, noise=WHITE, cost=cost)
    problem, fitted, _ = solved(("sensor_offset",), 0.03)
    null = dict(zip(bare.names, near.values.tolist(), strict=True)) | {"sensor_offset.b_n": 0.0}
    start = np.array([null[name] for name in problem.names])
    gain, shown, there = score_test(problem, [start], near, ("sensor_offset",))
    real = likelihood_gain(fitted, near)
    assert real > 50.0
    assert gain == pytest.approx(real, rel=0.1)
    place = problem.names.index("sensor_offset.b_n")
    assert there[place] == pytest.approx(fitted.values[place], rel=0.1)
    assert shown.ways.shape == (len(shown.innovations), 1)
    # The score in that direction is what is promised, to second order.
    score = float(shown.ways[:, 0] @ shown.innovations)
    assert score**2 == pytest.approx(gain, rel=0.1)
    # At the null the rest of the model is as it was: wherever a start has it, the step is one.
    off = start.copy()
    off[problem.names.index("F_c_n")] *= 1.2
    for starts in ([start, off], [off, start]):
        assert score_test(problem, starts, near, ("sensor_offset",))[0] == pytest.approx(gain)


def test_a_score_is_of_the_samples_that_the_smaller_model_leaves() -> None:
    """Of half of them half of the gain; of many runs directions of some, and the gain of all."""
    bare, near, _ = solved((), 0.03)
    problem, _, start = solved(("sensor_offset",), 0.03)
    null = dict(zip(bare.names, near.values.tolist(), strict=True)) | {"sensor_offset.b_n": 0.0}
    start = np.array([null[name] for name in problem.names])
    near = replace(near, noise=WHITE)
    whole, every, _ = score_test(problem, [start], near, ("sensor_offset",))
    halves = near.samples.halves()
    gains = []
    for half in halves:
        gain, shown, _ = score_test(
            problem, [start], replace(near, samples=half), ("sensor_offset",)
        )
        assert len(shown.innovations) == half.count
        gains.append(gain)
    assert max(gains) < whole
    assert len(every.innovations) == near.samples.count
    few = Problem(
        problem.campaign.only([0, 1]), "coulomb", "journal", ("sensor_offset",), {"F_s_n": 6.0}
    )
    vars(problem)["thinned"] = few
    gain, some, there = score_test(problem, [start], near, ("sensor_offset",))
    assert gain == pytest.approx(whole)
    assert len(some.innovations) == few.campaign.samples.count
    assert some.ways.shape == (len(some.innovations), 1)
    assert len(there) == len(problem.names)


def test_of_several_starts_the_one_that_promises_most_is_stepped_from(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of two that promise as much the first."""
    bare, near, _ = solved((), 0.03)
    problem, _, _ = solved(("sensor_offset",), 0.03)
    null = dict(zip(bare.names, near.values.tolist(), strict=True)) | {"sensor_offset.b_n": 0.0}
    place = problem.names.index("F_c_n")
    starts = [np.array([null[name] for name in problem.names]) for _ in range(4)]
    for k, start in enumerate(starts):
        start[place] *= 1.0 + 0.1 * k
    added = ("sensor_offset",)
    alone = [score_test(problem, [start], near, added)[2] for start in starts]
    assert len({float(there[place]) for there in alone}) == 4
    promised = iter([3.0, 7.0, 5.0, 7.0])
    level = sys.modules["jbf.diagnosis.level"]
    monkeypatch.setattr(level, "promised_gain", lambda *told: next(promised))
    gain, _, there = score_test(problem, starts, near, added)
    assert gain == 7.0
    assert there == pytest.approx(alone[1])
