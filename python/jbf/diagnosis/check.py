"""How often a diagnosis is right on this very rig: campaigns like the one at hand, diagnosed whole.

The fitted model records the same motions again (`estimation.wild_bootstrap`), so often with the
effects that were found and so often without them, as if nothing were hidden; each is diagnosed as
the measured ones were.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass
from typing import Any

from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.recipe import diagnose
from jbf.errors import InputError, JbfError
from jbf.estimation.wild_bootstrap import recorded_by
from jbf.models.model import Model
from jbf.records.arguments import check_callable, list_of_runs, of_kind, whole_number
from jbf.records.run import Run
from jbf.results import Result

Names = tuple[str, ...]
Progress = Callable[[str, int, int], None]

SURE = 0.95
"""Of an interval of a rate (Clopper & Pearson 1934)."""


@dataclass(frozen=True)
class Answer:
    """What the diagnosis of one campaign said.

    Attributes
    ----------
    hidden
        The effects that were in it.
    draw
        Which of the draws it is.
    verdict, effects
        Of the diagnosis, with the terms of its machine; `failed` where it ended with an error.
    alternatives
        What could stand in the place of each named effect.
    """

    hidden: Names
    draw: int
    verdict: str
    effects: Names
    alternatives: Mapping[str, Names]

    @property
    def right(self) -> bool:
        """All that was hidden was named, and nothing else."""
        return set(self.effects) == set(self.hidden) and self.verdict != "failed"

    @property
    def false(self) -> bool:
        """A name that was not hidden, not even as an alternative to one that was."""
        could = [{name, *self.alternatives.get(name, ())} for name in self.effects]
        return any(not names & set(self.hidden) for names in could)

    def to_dict(self) -> dict[str, Any]:
        """For JSON: `answer_of` reads it."""
        return {
            "hidden": list(self.hidden),
            "draw": self.draw,
            "verdict": self.verdict,
            "effects": list(self.effects),
            "alternatives": {k: list(v) for k, v in self.alternatives.items()},
        }


def answer_of(told: Mapping[str, Any]) -> Answer:
    """What `Answer.to_dict` said."""
    others = {k: tuple(v) for k, v in told["alternatives"].items()}
    return Answer(
        tuple(told["hidden"]), int(told["draw"]), told["verdict"], tuple(told["effects"]), others
    )


@dataclass(frozen=True)
class Rate:
    """How often something came true of so many campaigns.

    Attributes
    ----------
    what
        In words.
    count, campaigns
        So often, of so many.
    low, high
        Interval that holds the rate in 95 of 100 cases.
    """

    what: str
    count: int
    campaigns: int
    low: float
    high: float

    @classmethod
    def of(cls, what: str, told: Sequence[bool]) -> Rate:
        """From what came true and what did not."""
        from scipy import stats  # most of a second to import

        found = stats.binomtest(sum(told), len(told)).proportion_ci(SURE, method="exact")
        return cls(what, sum(told), len(told), float(found.low), float(found.high))

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return dict(vars(self))


@dataclass(frozen=True, repr=False)
class Check(Result):
    """How often the diagnosis of campaigns like this one is right.

    Attributes
    ----------
    model
        What recorded them.
    answers
        One a campaign.
    """

    model: Model
    answers: tuple[Answer, ...]

    @property
    def rates(self) -> tuple[Rate, ...]:
        """Rates, those with nothing hidden first."""
        found: list[Rate] = []
        for hidden in sorted({a.hidden for a in self.answers}, key=len):
            own = [a for a in self.answers if a.hidden == hidden]
            said = f"{' + '.join(hidden) or 'nothing'} hidden"
            told = {
                "a false name": [a.false for a in own],
                "unexplained": [a.verdict == "unexplained" for a in own],
            }
            if hidden:
                named = [set(hidden) <= set(a.effects) for a in own]
                told = {"named": named, "named, and nothing else": [a.right for a in own]} | told
            else:
                told = {"adequate": [a.verdict == "adequate" for a in own]} | told
            found += [Rate.of(f"{said}: {what}", those) for what, those in told.items()]
        return tuple(found)

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "law": self.model.law,
            "effects": list(self.model.effects),
            "rates": [r.to_dict() for r in self.rates],
            "answers": [a.to_dict() for a in self.answers],
        }


@dataclass(frozen=True)
class _Task:
    """A campaign to be recorded again, and diagnosed."""

    model: Model
    runs: tuple[Run, ...]
    hidden: Names
    draw: int
    policy: Policy


def check(
    model: Model,
    runs: Iterable[Run],
    *,
    campaigns: int = 200,
    policy: Policy = DEFAULT,
    executor: Executor | None = None,
    progress: Progress | None = None,
    done: Sequence[Answer] = (),
    keep: Callable[[Answer], None] | None = None,
) -> Check:
    """Diagnose campaigns like the one at hand, with and without the effects that were found.

    Takes as long as so many diagnoses, twice where the model has effects.

    Parameters
    ----------
    model
        What `fit` or `diagnose` made of the runs.
    runs
        The runs that it was made of, with friction.
    campaigns
        How many with the effects, and how many without.
    policy
        The numbers of the diagnoses.
    executor
        Any `concurrent.futures` executor, a Dask client's `get_executor()` included; one campaign
        after the other where not given. Left open.
    progress
        Called with a message, and how many of how many campaigns are done.
    done
        Answers of an earlier check of the same model and runs, which are not sought again.
    keep
        Called with each new answer, as soon as it is there.

    Raises
    ------
    InputError
        No campaign is asked for, or the runs cannot be prepared.
    """
    of_kind(model, Model, "model", "give a jbf.Model")
    check_callable(progress, "progress")
    if whole_number(campaigns, "campaigns") < 1:
        raise InputError(problem=f"{campaigns} campaigns tell no rate", mend="ask for one or more")
    every = tuple(list_of_runs(runs))
    answers = list(done)
    known = {(a.hidden, a.draw) for a in answers}
    hidden = dict.fromkeys([(), tuple(model.effects)])
    tasks = [
        _Task(model, every, effects, draw, policy)
        for draw in range(campaigns)
        for effects in hidden
        if (effects, draw) not in known
    ]
    total = len(tasks) + len(answers)
    for found in _answered(tasks, executor):
        answers.append(found)
        if keep is not None:
            keep(found)
        if progress is not None:
            progress("diagnosing campaigns like this one", len(answers), total)
    answers.sort(key=lambda a: (len(a.hidden), a.draw))
    return Check(model, tuple(answers))


def identity(model: Model, runs: Iterable[Run], policy: Policy = DEFAULT) -> str:
    """A name of a model, its runs and the numbers of a diagnosis: answers to others are no help."""
    digest = hashlib.sha256(model.to_toml().encode())
    digest.update(repr(policy).encode())
    for run in runs:
        digest.update(run.to_csv().encode())
    return digest.hexdigest()[:16]


def _answered(tasks: Sequence[_Task], executor: Executor | None) -> Iterator[Answer]:
    if executor is None:
        yield from map(_answer, tasks)
        return
    running = [executor.submit(_answer, task) for task in tasks]
    for future in as_completed(running):
        yield future.result()


def _answer(task: _Task) -> Answer:
    """The diagnosis of one campaign."""
    try:
        again = recorded_by(task.model, task.runs, task.hidden, task.draw)
        found = diagnose(
            task.model.rig, again, law=task.model.law, clock=task.model.clock, policy=task.policy
        )
    except JbfError:
        return Answer(task.hidden, task.draw, "failed", (), {})
    named = (*found.machine, *found.effects)
    return Answer(task.hidden, task.draw, found.verdict, named, found.alternatives)
