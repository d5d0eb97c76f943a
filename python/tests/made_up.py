"""Models of made-up likelihoods, for the rules of selection: no run, no fit, gains as told."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
from jbf import Rig
from jbf.diagnosis.confirmation import Confirmation
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.reached import Reached
from jbf.estimation.noise import WHITE
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from scipy import stats

N = 1000
BARE_N = 2.0
"""RMS of the bare law."""
LAW = 3
"""Parameters of the law; each effect brings one more."""
SAMPLES = Samples(("run",), (0.02,), (np.ones(N, bool),), (np.ones(N),))
Set = frozenset[str]


def solution(effects: Iterable[str], gain: float, smooth: int = 1, slope: float = 0.0) -> Solution:
    """A residual of 2 N less what gains so much in twice the log likelihood.

    Parameters
    ----------
    smooth
        Samples between changes of its sign: 1 is as independent as can be.
    slope
        Share of the residual that a next step would take away.
    """
    sign = np.where(np.arange(N) // smooth % 2, 1.0, -1.0)
    residual = BARE_N * float(np.exp(-gain / (2.0 * N))) * sign
    effects = tuple(effects)
    jacobian = np.zeros((N, LAW + len(effects)))
    jacobian[: round(slope * N), 0] = residual[: round(slope * N)]
    cost = SAMPLES.cost([residual], WHITE)
    values = np.zeros(LAW + len(effects))
    return Solution(effects, values, [residual], [jacobian], WHITE, cost, True, "", SAMPLES)


@dataclass
class MadeUp:
    """In place of the candidates of a campaign.

    Attributes
    ----------
    gains
        Gain over the bare law by set of effects; of a set that is not there the best of its
        parts.
    ranked
        The same where a model has only been ranked.
    scores
        What a score test promises; plenty where nothing is said.
    promised
        What a first look promises, of those that have not been ranked; without end where nothing is
        said.
    peaks
        Gain once the other peaks were searched.
    from_richer
        Gain once it was fitted from a richer model, too.
    left_out
        RMS over runs left out, N; that of the fit where nothing is said.
    better
        Share of the runs left out that a candidate predicts better; all or none where nothing is
        said.
    nulls
        Sets of which each effect is left at its null.
    asked
        What was called with which set.
    reached
        How far a search has come.
    """

    names: list[str]
    gains: dict[Set, float]
    ranked: Mapping[Set, float] = field(default_factory=dict)
    scores: Mapping[Set, float] = field(default_factory=dict)
    promised: Mapping[Set, float] = field(default_factory=dict)
    peaks: Mapping[Set, float] = field(default_factory=dict)
    from_richer: Mapping[Set, float] = field(default_factory=dict)
    left_out: Mapping[Set, float] = field(default_factory=dict)
    better: float | None = None
    slopes: Mapping[Set, float] = field(default_factory=dict)
    nulls: Collection[Set] = ()
    smooth: int = 1
    policy: Policy = DEFAULT
    asked: list[tuple[str, Set]] = field(default_factory=list)
    reached: Reached = field(default_factory=Reached)
    campaign: Any = field(
        default_factory=lambda: SimpleNamespace(
            samples=SAMPLES, steps_rms_n=lambda rms_n: 0.0, rig=Rig()
        )
    )

    def _gain(self, effects: Iterable[str]) -> float:
        here = frozenset(effects)
        return self.gains.get(here, max((g for s, g in self.gains.items() if s <= here), default=0))

    def _note(self, what: str, effects: Iterable[str]) -> Set:
        here = frozenset(effects)
        self.asked.append((what, here))
        return here

    def score_test(self, effects: Sequence[str], near: Solution) -> float:
        return self.scores.get(self._note("score", effects), 1e6)

    def score_all(self, sets: Sequence[Sequence[str]], near: Solution) -> None:
        for effects in sets:
            self.score_test(effects, near)

    def rank_all(self, sets: Sequence[Sequence[str]], near: Solution) -> None:
        for effects in sets:
            self.rank(effects, near)

    def look_all(self, sets: Sequence[Sequence[str]], near: Solution) -> None:
        for effects in sets:
            self.look(effects, near)

    def look(self, effects: Sequence[str], near: Solution) -> Any:
        here = self._note("look", effects)
        gain = self.ranked.get(here, self._gain(effects))
        promised = np.inf if ("rank", here) in self.asked else self.promised.get(here, np.inf)
        seen = solution(effects, gain, self.smooth)
        return SimpleNamespace(found=lambda: seen, promised=promised)

    def rank(self, effects: Sequence[str], near: Solution | None = None) -> Solution:
        here = self._note("rank", effects)
        gain = self.ranked.get(here, self._gain(effects))
        return solution(effects, gain, self.smooth, self.slopes.get(here, 0.0))

    def converge(self, effects: Sequence[str], near: Solution | None = None) -> Solution:
        self._note("converge", effects)
        return solution(effects, self._gain(effects), self.smooth)

    def search_peaks(self, effects: Sequence[str]) -> Solution:
        here = self._note("peaks", effects)
        self.gains[here] = self.peaks.get(here, self._gain(effects))
        return self.converge(effects)

    def refit_from(self, effects: Sequence[str], richer: Sequence[str]) -> Solution:
        here = self._note("refit", effects)
        self.gains[here] = self.from_richer.get(here, self._gain(effects))
        return self.converge(effects)

    def idle(self, solution: Solution) -> tuple[str, ...]:
        return solution.effects if frozenset(solution.effects) in self.nulls else ()

    def left_out_rms(self, effects: Sequence[str]) -> float:
        here = frozenset(effects)
        return self.left_out.get(here, self.converge(effects).rms_n)

    def confirmation(self, present: Sequence[str], name: str) -> Confirmation:
        before, after = (self.left_out_rms(effects) for effects in (present, (*present, name)))
        fit = [self.converge(effects).rms_n for effects in (present, (*present, name))]
        share = (before**2 - after**2) / (fit[0] ** 2 - fit[1] ** 2)
        better = float(after < before) if self.better is None else self.better
        return Confirmation(before, after, better, share)

    def fitted(self, effects: Iterable[str]) -> Any:
        names = [""] * (LAW + len(frozenset(effects)))
        # None of them makes a film.
        problem = SimpleNamespace(names=names, open=range(len(names)), effects=(), law="coulomb")
        return SimpleNamespace(problem=problem)

    def one_more(self, effects: Iterable[str]) -> dict[str, Any]:
        here = frozenset(effects)
        return {
            name: SimpleNamespace(found=lambda s=s: solution(s, self.gains[s], self.smooth))
            for s in self.gains
            for name in s - here
            if len(s) == len(here) + 1 and here < s
        }

    @property
    def level(self) -> Level:
        return Level.shared(self.policy, len(self.names), N, BARE_N)

    def calibrate(self, present: Sequence[str]) -> None:
        self.asked.append(("calibrate", frozenset(present)))

    def tell(self, message: str, done: int, total: int) -> None:
        pass


def price(parameters: int, candidates: int) -> float:
    """What a gain of so many parameters must exceed: one in a hundred shared among candidates, 22
    for what recordings do, and log n for each parameter beyond the first."""
    return float(stats.chi2.isf(0.01 / candidates, 1) + 22.0 + (parameters - 1) * np.log(N))


def sets(gains: Mapping[str, float]) -> dict[Set, float]:
    """`{"a b": 3.0}` as a set of two effects and its gain."""
    return {frozenset(words.split()): gain for words, gain in gains.items()}
