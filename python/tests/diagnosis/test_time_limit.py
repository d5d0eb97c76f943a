"""Time limit of a diagnosis, with a clock that a progress callback moves.

The tests do not depend on the speed of the machine: a limit is reached at a chosen report, at once,
or never.
"""

import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from typing import Any

import jbf
import pytest
from jbf import Diagnosis, Rig, TimeLimit, Unfinished, diagnose
from linear_campaigns import linear_diagnosis, linear_runs

LIMIT_S = 30.0
REASON = "30 s"
AT_ONCE, NEVER = 1e-9, 1e9
HIDDEN = "offset and drag"


@dataclass
class Clock:
    """A clock that jumps at a report of the progress.

    Attributes
    ----------
    at
        Number of the report.
    jump_s
        Size of the jump, s.
    """

    at: int
    jump_s: float = 2.0 * LIMIT_S
    now_s: float = 0.0
    reports: int = 0

    def __call__(self) -> float:
        return self.now_s

    def progress(self, message: str, done: int, total: int) -> None:
        self.reports += 1
        if self.reports == self.at:
            self.now_s += self.jump_s


def limited(clock: Clock, law: str = "coulomb", hidden: str = HIDDEN) -> Diagnosis:
    limit = TimeLimit(LIMIT_S, clock)
    return diagnose(
        Rig(), linear_runs(hidden), law=law, progress=clock.progress, time_limit_s=limit
    )


@cache
def reports(law: str = "coulomb") -> int:
    """Number of progress reports of a complete diagnosis."""
    clock = Clock(0)
    limited(clock, law)
    return clock.reports


def comparable(diagnosis: Diagnosis) -> dict[str, Any]:
    return {**diagnosis.to_dict(), "elapsed_s": None}


def test_limit_that_is_not_reached_leaves_the_diagnosis_unchanged() -> None:
    answer = diagnose(Rig(), linear_runs(HIDDEN), law="coulomb", time_limit_s=NEVER)
    assert comparable(answer) == comparable(linear_diagnosis(HIDDEN))
    assert answer.unfinished == ()


def test_limit_reached_in_the_first_round_raises_unfinished_with_the_fitted_law() -> None:
    with pytest.raises(Unfinished) as ended:
        limited(Clock(1))
    assert ended.value.time_limit_s == LIMIT_S
    assert (ended.value.fit.model.law, ended.value.fit.model.effects) == ("coulomb", ())


@pytest.mark.parametrize(
    "share",
    [0.5, *(pytest.param(s, marks=pytest.mark.extended) for s in (0.6, 0.7, 0.8, 0.9, 1.0))],
)
def test_limit_reached_at_a_report_gives_the_best_model_and_what_was_not_tested(
    share: float,
) -> None:
    complete = linear_diagnosis(HIDDEN)
    answer = limited(Clock(round(share * reports())))
    assert set(answer.effects) <= set(complete.effects)
    assert answer.verdict in (complete.verdict, "unexplained")
    assert answer.unfinished
    assert all(REASON in answer.not_tried[name] for name in answer.unfinished)
    assert answer.to_dict()["not_tried"].keys() >= set(answer.unfinished)
    for text in (answer.summary(), answer.summary(full=True)):
        assert REASON in text
    if answer.verdict != complete.verdict:
        assert [r.axis for r in answer.residual_structure].count("search") == 1


@pytest.mark.extended
def test_later_limit_keeps_all_effects_of_an_earlier_one() -> None:
    answers = [limited(Clock(round(share * reports()))) for share in (0.55, 0.8)]
    assert set(answers[0].effects) <= set(answers[1].effects)
    assert answers[1].steps[-1].held_out_rms <= answers[0].steps[-1].held_out_rms


def test_limit_reached_at_once_reports_a_sufficient_limit() -> None:
    with pytest.raises(Unfinished) as ended:
        diagnose(Rig(), linear_runs(HIDDEN), law="coulomb", time_limit_s=AT_ONCE)
    error = ended.value
    assert "\n" not in str(error)
    assert error.sufficient_s is not None
    assert error.sufficient_s >= 1.0
    assert f"{error.sufficient_s:g} s" in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.time_limit_s) == (str(error), AT_ONCE)


def test_sufficient_limit_is_at_least_twice_the_one_that_did_not_suffice() -> None:
    clock = Clock(1, jump_s=1e6)
    with pytest.raises(Unfinished) as ended:
        diagnose(
            Rig(),
            linear_runs(HIDDEN),
            law="coulomb",
            progress=clock.progress,
            time_limit_s=TimeLimit(5e4, clock),
        )
    assert ended.value.sufficient_s == 1e5


def test_comparison_of_laws_leaves_time_for_the_diagnosis() -> None:
    answer = limited(Clock(3, jump_s=0.6 * LIMIT_S), "auto", "mass")
    not_tried = {name for name, reason in answer.not_tried.items() if REASON in reason}
    assert not_tried
    assert all(name.startswith("law ") for name in not_tried)
    assert answer.laws
    assert set(answer.unfinished) == not_tried


def test_laws_that_exceed_all_of_the_time_raise_unfinished() -> None:
    with pytest.raises(Unfinished):
        limited(Clock(1), "auto", "mass")


@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf"), "30", True])
@pytest.mark.parametrize("call", [diagnose, jbf.fit])
def test_limit_that_is_no_positive_number_raises_input_error(
    call: Callable[..., object], value: object
) -> None:
    with pytest.raises(jbf.InputError, match="time_limit_s") as error:
        call(Rig(), linear_runs("mass"), law="coulomb", time_limit_s=value)
    assert not isinstance(error.value, Unfinished)


def test_each_of_many_campaigns_has_its_own_limit() -> None:
    campaigns = {name: (Rig(), linear_runs("mass")) for name in ("a", "b")}
    with ThreadPoolExecutor(1) as executor:
        results = jbf.diagnose_many(
            campaigns, executor=executor, law="coulomb", time_limit_s=AT_ONCE
        )
    assert [type(result) for result in results.values()] == [Unfinished, Unfinished]
    with pytest.raises(jbf.InputError):
        jbf.diagnose_many(campaigns, law="coulomb", time_limit_s=-1.0)
