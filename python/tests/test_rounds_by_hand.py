"""What rounds leave unsaid or ask for, films that are too fast, robust weights and fits: by made-up
answers."""

from __future__ import annotations

import sys
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import fit_by_hand
from jbf import InputError, Rig
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.ledger import Step
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.rounds import (
    Selected,
    _differ_more,
    _one_more,
    _refused,
    _says_as_much,
    select,
    step,
)
from jbf.estimation.film_rate import ANY_STEPS, MOST_STEPS, check_film
from jbf.estimation.noise import WHITE
from jbf.estimation.solution import Solution
from jbf.estimation.weighting import BETTER, NO_WORSE, SHARPER, _better
from made_of import record, samples_of
from made_up import MadeUp, sets

Array = npt.NDArray[np.float64]
rounds = sys.modules["jbf.diagnosis.rounds"]
films = sys.modules["jbf.estimation.film_rate"]
N = 200
PREPARED = [record(0.02 * np.arange(N))]
SAMPLES = samples_of(PREPARED)


def left(size: float) -> Solution:
    """A solution that leaves so much, RMS."""
    residual = size * np.where(np.arange(N) % 2, 1.0, -1.0)
    samples = replace(SAMPLES)
    return Solution((), np.zeros(1), [residual], [np.zeros((N, 1))], WHITE, 0.0, True, "", samples)


def candidates(**solutions: float) -> Any:
    """Models, each of the letters of its name, that leave so much."""
    known = {tuple(name.strip("_")): left(size) for name, size in solutions.items()}
    return SimpleNamespace(
        converge=known.__getitem__,
        left_out_rms=lambda effects: 7.0,
        campaign=SimpleNamespace(rig=Rig(), samples=SAMPLES),
        policy=DEFAULT,
        fitted=lambda present: SimpleNamespace(problem=None),
    )


# ---- rounds ------------------------------------------------------------------------------------


def test_a_leader_in_hand_is_said() -> None:
    found = _one_more(candidates(ab=2.0, abc=1.0), ("a", "b"), "c")
    assert found.axis == "effects"
    assert found.where == (
        "c would bring 2 N down to 1 N beside 2 effects, and no more are searched for"
    )
    assert found.share == pytest.approx(0.75)
    assert _one_more(candidates(ab=1.0, abc=2.0), ("a", "b"), "c").share == 0.0


def test_a_line_of_the_ledger_has_the_errors_of_its_model() -> None:
    found = step(candidates(a=2.0), ("a",), 0.5, ())
    assert (found.effects, found.noise_n, found.trials) == (("a",), 0.5, ())
    assert (found.rms_n, found.holdout_rms_n) == pytest.approx((2.0, 7.0))


@pytest.mark.parametrize(
    ("before", "effect", "apart", "most", "as_much"),
    [
        # As little as the deviations leave, and no more: twice 1 N is 2 N.
        (2.0, 2.0, 1.0, 2.0, True),
        (9.0, 2.001, 1.0, 2.0, False),
        # Of 4 - 2.25 N^2 that they explain 0.0609 times as much may be left.
        (2.0, np.sqrt(2.25 + 0.106), 1.5, 1.03, True),
        (2.0, np.sqrt(2.25 + 0.107), 1.5, 1.03, False),
        # Where they explain nothing, nothing may.
        (1.0, 1.19, 1.2, 1.03, True),
        (1.0, 1.2, 1.2, 1.03, True),
        (1.0, 1.21, 1.2, 1.03, False),
    ],
)
def test_an_effect_says_as_much_as_the_deviations_of_the_runs(
    before: float, effect: float, apart: float, most: float, as_much: bool
) -> None:
    assert _says_as_much(before, effect, apart, most) == as_much


def test_the_ledger_goes_on_from_all_but_its_last_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """That model is looked at once more, as the samples are seen now."""
    monkeypatch.setattr(rounds, "settled_again", lambda problem, solution: None)
    monkeypatch.setattr(rounds, "_differ_more", lambda candidates, present, found: None)
    made = MadeUp(["sensor_offset", "sensor_lag"], sets({"": 0.0, "sensor_lag": 300.0}))
    lines = [Step(("sensor_lag",), x, x, 0.5) for x in (11.0, 12.0, 13.0)]
    start = Selected(("sensor_lag",), lines)
    found = select(cast(Candidates, made), 0.5, start)
    assert found.present == ("sensor_lag",)
    assert found.steps[:2] == lines[:2]
    assert [s.effects for s in found.steps[2:]] == [("sensor_lag",)]
    assert found.steps[2].rms_n < 11.0
    # From the law alone there is nothing to go on from.
    alone = select(cast(Candidates, made), 0.5, Selected((), lines))
    assert [s.effects for s in alone.steps] == [(), ("sensor_lag",)]


def refused(monkeypatch: pytest.MonkeyPatch, evidence: float = 1e3, **more: float) -> list[Any]:
    """What is refused beside a model that leaves 1 N, of fitted ones with one effect more."""
    asked = candidates(_=1.0)
    asked.one_more = lambda present: {
        name: SimpleNamespace(found=lambda size=size: left(size)) for name, size in more.items()
    }

    def alone(c: Any, richer: Any, simpler: Any, *, anywhere: bool) -> float:
        assert anywhere
        return evidence

    monkeypatch.setattr(rounds, "evidence_alone", alone)
    return [(r.where, r.share) for r in _refused(asked, ())]


@pytest.mark.parametrize(("part", "told"), [(0.999, True), (1.001, False)])
def test_what_helps_where_it_was_fitted_alone_is_told(
    part: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a hundredth of the RMS, and by more than weak evidence."""
    size = part * DEFAULT.refused_rms
    found = refused(monkeypatch, x=size)
    assert bool(found) == told
    if told:
        assert found == [
            (
                f"x fits 1 N down to {size:.3g} N but predicts runs left out no better",
                pytest.approx(1.0 - size**2),
            )
        ]


def test_of_several_the_one_that_leaves_least(monkeypatch: pytest.MonkeyPatch) -> None:
    ((words, share),) = refused(monkeypatch, x=0.9, y=0.5, z=0.7)
    assert words.startswith("y fits 1 N down to 0.5 N")
    assert share == pytest.approx(0.75)
    assert refused(monkeypatch) == []
    # As much as is asked for is not less.
    half = replace(DEFAULT, refused_rms=0.5)
    monkeypatch.setattr(sys.modules[__name__], "DEFAULT", half)
    assert refused(monkeypatch, x=0.5) == []
    assert len(refused(monkeypatch, x=0.49)) == 1
    for more, told in ((0.01, True), (0.0, False)):
        assert bool(refused(monkeypatch, DEFAULT.weak + more, x=0.25)) == told


@pytest.mark.parametrize(
    ("leader", "leaves", "there"),
    [
        (None, 9.0, True),
        ("c", DEFAULT.no_worse + 0.01, True),
        ("c", DEFAULT.no_worse - 0.01, False),
    ],
)
def test_runs_that_differ_go_before_an_effect_that_leaves_more(
    leader: str | None, leaves: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The deviation must gain more than a price and than any effect has evidence."""
    asked: list[float] = []
    samples = SimpleNamespace(without_deviations=lambda r, noise: r)
    allowed: Any = SimpleNamespace(samples=samples)

    def deviation(problem: Any, solution: Any, given: Any, policy: Any, least: float) -> Any:
        asked.append(least)
        return "deviation"

    monkeypatch.setattr(rounds, "price_of", lambda c, parameters: 30.0 * parameters)
    monkeypatch.setattr(rounds, "deviation", deviation)
    monkeypatch.setattr(rounds, "allowing_for", lambda campaign, found: allowed)
    trials = [SimpleNamespace(evidence=e) for e in (-5.0, 12.0, 40.0)]
    found: Any = SimpleNamespace(leader=leader, trials=trials)
    # Beside what the deviations leave, the law alone leaves far more.
    monkeypatch.setattr(
        rounds, "_says_as_much", lambda b, effect, apart, most: effect <= most * apart
    )
    made = candidates(ab=1.0, abc=leaves)
    assert (_differ_more(made, ("a", "b"), found) is allowed) == there
    assert asked == [70.0]
    found.trials = trials[:1]
    _differ_more(made, ("a", "b"), found)
    assert asked[1] == 30.0
    monkeypatch.setattr(rounds, "deviation", lambda *told: None)
    assert _differ_more(made, ("a", "b"), found) is None


# ---- films -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rate_1_s", "lasts_s", "count", "refused"),
    [
        # Two hundred steps from sample to sample,
        (9.9e3, 200.0, 10_000, False),
        (1.01e4, 200.0, 10_000, True),
        # or a hundred thousand in all.
        (4.9e3, 20.0, 100, False),
        (5.1e3, 20.0, 100, True),
    ],
)
def test_a_film_may_take_so_many_steps(
    rate_1_s: float, lasts_s: float, count: int, refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In each of two runs; the slowest of all starts counts."""
    assert (MOST_STEPS, ANY_STEPS) == (200.0, 1e5)
    prepared = [record(np.linspace(0.0, 0.5 * lasts_s, count // 2), name=n) for n in "ab"]
    for p in prepared:
        p.run.path = None
    rates = {1.0: 3.0 * rate_1_s, 2.0: rate_1_s}
    problem = SimpleNamespace(
        names=("f_m",),
        chain=SimpleNamespace(film_rate_1_s=lambda start, motions: rates[start]),
        starts=lambda known: [1.0, 2.0],
    )
    monkeypatch.setattr(films, "Problem", lambda *told: problem)
    campaign: Any = SimpleNamespace(prepared=prepared, motions=[])
    if refused:
        with pytest.raises(InputError, match="cannot be identified from these runs"):
            check_film(campaign, "journal", "journal")
    else:
        check_film(campaign, "journal", "journal")
    # A law without a film is never too fast.
    check_film(campaign, "coulomb", "journal")
    known: list[Any] = []

    def starts(seed: Any) -> list[float]:
        known.append(seed)
        return [2.0]

    problem.starts = starts
    try:
        check_film(campaign, "journal", "journal", {"f_m": 0.25, "other": 3.0})
    except InputError:
        assert refused
    assert known == [{"f_m": 0.25}]


# ---- weights and fits --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("square", "middle", "better"),
    [
        (BETTER - 0.001, 9.0, True),
        (BETTER + 0.001, 1.0, False),
        # No worse in its squares, and sharper in its middle.
        (NO_WORSE - 0.001, SHARPER - 0.001, True),
        (NO_WORSE + 0.001, SHARPER - 0.001, False),
        (NO_WORSE - 0.001, SHARPER + 0.001, False),
    ],
)
def test_left_out_residuals_are_smaller_in_their_squares_or_their_middle(
    square: float, middle: float, better: bool
) -> None:
    """Most of them as large as the middle, a few that make up the square."""
    assert (BETTER, NO_WORSE, SHARPER) == (0.97, 1.02, 0.8)
    for unit in (1e-3, 1e3):
        before = unit * np.concatenate((np.ones(99), [100.0]))
        after = unit * np.concatenate((np.full(99, middle), [1.0]))
        whole = square**2 * float(np.sum((before / unit) ** 2)) - 99.0 * middle**2
        after[-1] = unit * np.sqrt(whole)
        assert _better(after, before) == better


def test_a_fit_says_its_numbers_and_holds_as_many_correlations_as_it_tells() -> None:
    found = fit_by_hand(("sensor_offset",), doubtful=("F_c_n",))
    told = found.to_dict()
    assert {
        k: told[k] for k in ("law", "effects", "rms_n", "samples", "converged", "doubtful")
    } == {
        "law": "coulomb",
        "effects": ["sensor_offset"],
        "rms_n": 0.525,
        "samples": 1001,
        "converged": True,
        "doubtful": ["F_c_n"],
    }
    assert told["message"] == found.message
    assert told["findings"] == [f.to_dict() for f in found.findings]
    assert list(told["parameters"]) == list(found.parameters)
    with pytest.raises(ValueError, match="for 3 parameters not held"):
        replace(found, correlations=np.eye(2))
