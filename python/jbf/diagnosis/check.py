"""Simulation study of the diagnosis on the user's rig: complete diagnoses of similar campaigns.

The fitted model simulates records of the same motions (`estimation.bootstrap`): a number of
campaigns with the effects of the model, and the same number without them. The machine terms of a
drive are in all of them. Each campaign is diagnosed like the measured one.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass
from functools import partial
from typing import Any

from jbf.arrays import Names
from jbf.diagnosis.candidates import Progress
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.recipe import diagnose
from jbf.diagnosis.review import machine_of
from jbf.errors import InputError, JbfError
from jbf.estimation.bootstrap import simulated_runs
from jbf.models.model import Model
from jbf.records.arguments import check_callable, checked_integer, list_of_runs, of_kind
from jbf.records.run import Run
from jbf.results import Result

SURE = 0.95
"""Confidence level of the interval of a rate (Clopper & Pearson 1934), not used in a verdict."""


@dataclass(frozen=True)
class Answer:
    """Result of the diagnosis of one simulated campaign.

    Attributes
    ----------
    hidden
        The effects in the simulation.
    draw
        Index of the random draw.
    verdict, effects
        Verdict and effects of the diagnosis, including the machine terms; the verdict is `failed`
        if the diagnosis raised an error.
    alternatives
        Effects with which each named effect is confounded.
    """

    hidden: Names
    draw: int
    verdict: str
    effects: Names
    alternatives: Mapping[str, Names]

    @property
    def right(self) -> bool:
        """Whether the diagnosis named exactly the effects in the simulation."""
        return set(self.effects) == set(self.hidden) and self.verdict != "failed"

    @property
    def false(self) -> bool:
        """Whether a named effect was not simulated, and no effect confounded with it either."""
        groups = [{name, *self.alternatives.get(name, ())} for name in self.effects]
        return any(not names & set(self.hidden) for names in groups)

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict, from which `answer_of` creates the result again."""
        return {
            "hidden": list(self.hidden),
            "draw": self.draw,
            "verdict": self.verdict,
            "effects": list(self.effects),
            "alternatives": {k: list(v) for k, v in self.alternatives.items()},
        }


def answer_of(table: Mapping[str, Any]) -> Answer:
    """Create the result of one simulated campaign from the output of `Answer.to_dict`."""
    others = {k: tuple(v) for k, v in table["alternatives"].items()}
    hidden, effects = tuple(table["hidden"]), tuple(table["effects"])
    return Answer(hidden, int(table["draw"]), table["verdict"], effects, others)


@dataclass(frozen=True)
class Rate:
    """Frequency of an outcome among simulated campaigns, with its confidence interval.

    Attributes
    ----------
    what
        Description of the outcome.
    count, campaigns
        Number of campaigns with the outcome, and of all campaigns.
    low, high
        Limits of the 95 % confidence interval of the rate.
    """

    what: str
    count: int
    campaigns: int
    low: float
    high: float

    @classmethod
    def of(cls, what: str, outcomes: Sequence[bool]) -> Rate:
        """Compute the frequency of True outcomes and its confidence interval."""
        from scipy import stats  # most of a second to import

        count, campaigns = sum(outcomes), len(outcomes)
        interval = stats.binomtest(count, campaigns).proportion_ci(SURE, method="exact")
        return cls(what, count, campaigns, float(interval.low), float(interval.high))

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return dict(vars(self))


@dataclass(frozen=True, repr=False)
class Check(Result):
    """Rates of correct and false results of the diagnosis in campaigns like this one.

    Attributes
    ----------
    model
        Model that generated the campaigns.
    answers
        Results, one per campaign.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> study = jbf.check(model, [run], campaigns=1)
    >>> [answer.verdict for answer in study.answers]
    ['adequate']
    """

    model: Model
    answers: tuple[Answer, ...]

    @property
    def rates(self) -> tuple[Rate, ...]:
        """Frequencies of correct and false results, first in campaigns without hidden effects."""
        rates: list[Rate] = []
        machine = machine_of(self.model.rig, self.model.effects)
        for simulated in sorted({a.hidden for a in self.answers}, key=len):
            answers = [a for a in self.answers if a.hidden == simulated]
            hidden = [name for name in simulated if name not in machine]
            if hidden:
                outcomes = {
                    "named": [set(hidden) <= set(a.effects) for a in answers],
                    "named, and nothing else": [a.right for a in answers],
                }
            else:
                outcomes = {"adequate": [a.verdict == "adequate" for a in answers]}
            outcomes["a false name"] = [a.false for a in answers]
            outcomes["unexplained"] = [a.verdict == "unexplained" for a in answers]
            condition = f"{' + '.join(hidden) or 'nothing'} hidden"
            rates += [Rate.of(f"{condition}: {what}", those) for what, those in outcomes.items()]
        return tuple(rates)

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        return {
            "law": self.model.law,
            "effects": list(self.model.effects),
            "rates": [r.to_dict() for r in self.rates],
            "answers": [a.to_dict() for a in self.answers],
        }


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
    """Diagnose simulated campaigns like the present one, with and without the model's effects.

    It takes `campaigns` diagnoses, or twice that number if the model has effects. The inertia,
    weight and offset of a drive are in all campaigns.

    Parameters
    ----------
    model
        Result of `fit` or `diagnose` for the runs.
    runs
        The runs that the model was fitted to, with friction.
    campaigns
        Number of campaigns with the effects, and number without them.
    policy
        Thresholds of the diagnoses.
    executor
        Any `concurrent.futures` executor, a Dask client's `get_executor()` included; not shut down.
        Without one, campaigns are processed sequentially.
    progress
        Called with a message, the number of finished campaigns and the total number.
    done
        Results of an earlier check of the same model and runs, which are not repeated.
    keep
        Called with each new result as soon as it is available.

    Returns
    -------
    Check
        Rates of each outcome, with confidence intervals.

    Raises
    ------
    InputError
        The number of campaigns is not positive, or the runs cannot be prepared.

    Notes
    -----
    The intervals are those of Clopper & Pearson (1934) for a binomial proportion.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> study = jbf.check(model, [run], campaigns=1)
    >>> study.rates[0].campaigns
    1
    """
    of_kind(model, Model, "model", "give a jbf.Model")
    check_callable(progress, "progress")
    if checked_integer(campaigns, "campaigns") < 1:
        raise InputError(
            problem=f"{campaigns} campaigns determine no rate", remedy="use at least one"
        )
    every = tuple(list_of_runs(runs))
    answers = list(done)
    finished = {(a.hidden, a.draw) for a in answers}
    hidden = dict.fromkeys([machine_of(model.rig, model.effects), tuple(model.effects)])
    tasks = [
        partial(_answer, model, every, effects, draw, policy)
        for draw in range(campaigns)
        for effects in hidden
        if (effects, draw) not in finished
    ]
    total = len(tasks) + len(answers)
    for answer in _answered(tasks, executor):
        answers.append(answer)
        if keep is not None:
            keep(answer)
        if progress is not None:
            progress("diagnosing simulated campaigns", len(answers), total)
    answers.sort(key=lambda a: (len(a.hidden), a.draw))
    return Check(model, tuple(answers))


def identity(model: Model, runs: Iterable[Run], policy: Policy = DEFAULT) -> str:
    """Hash of a model, its runs and the policy; only results with equal hashes may be combined."""
    digest = hashlib.sha256(model.to_toml().encode())
    digest.update(repr(policy).encode())
    for run in runs:
        digest.update(run.to_csv().encode())
    return digest.hexdigest()[:16]


def _answered(tasks: Sequence[Callable[[], Answer]], executor: Executor | None) -> Iterator[Answer]:
    """Simulate and diagnose campaigns, and return each result as soon as it is available."""
    if executor is None:
        yield from (task() for task in tasks)
        return
    for future in as_completed([executor.submit(task) for task in tasks]):
        yield future.result()


def _answer(
    model: Model, runs: tuple[Run, ...], hidden: Names, draw: int, policy: Policy
) -> Answer:
    """Simulate one campaign with the effects `hidden`, and diagnose it."""
    try:
        again = simulated_runs(model, runs, hidden, draw)
        diagnosis = diagnose(model.rig, again, law=model.law, clock=model.clock, policy=policy)
    except JbfError:
        return Answer(hidden, draw, "failed", (), {})
    named = (*diagnosis.machine, *diagnosis.effects)
    return Answer(hidden, draw, diagnosis.verdict, named, diagnosis.alternatives)
