"""The level of the tests: what an effect must gain so that noise seldom makes a name.

One level holds for a campaign: in so many of a hundred of them with nothing hidden any of the
candidates may get a name. Shared among them (Bonferroni) it gives the probability at which a gain
is no chance. Where the campaign's own residual makes large gains more often than that, the
probability sinks until it does not: the residual's signs are turned block by block (a wild
bootstrap: Wu 1986; of blocks: Shao 2010), which keeps its size, its tails and its memory and takes
away whatever it has of an effect.

Recordings do to a record what no finding tells: to be named, an effect must gain so much more than
white noise makes it as simulated recordings with nothing hidden do; or, if that is more, what the
campaign's own residual makes it gain, in which what its recording did is seen already. And what is
so little that nobody would act on it gets no name, however sure it is: of a day of samples any
description of a machine is wrong.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.diagnosis.decoys import decoy_gains
from jbf.diagnosis.policy import Policy
from jbf.estimation.blocks import Places, blocks_of
from jbf.estimation.likelihood import effective_share, least_squares, promised_gain, score_gain
from jbf.estimation.long_run import sure_inflation
from jbf.estimation.problem import Problem
from jbf.estimation.rows import triangular
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]

DRAWS = 4000
"""Campaigns whose signs are drawn; forty of them are beyond a level of one in a hundred."""


@dataclass(frozen=True)
class Level:
    """What a gain in twice the log likelihood must exceed.

    Attributes
    ----------
    false_alarms
        Share of campaigns with nothing hidden in which noise may make a name.
    candidates
        Effects that are tried.
    chance
        Probability of a single candidate's gain at which that is kept.
    blocks
        Blocks of the residual whose signs were turned; none before there is a residual.
    imperfection
        What recordings may add to what white noise makes an effect gain.
    worth
        What an effect gains that is just worth a name.
    decoys, decoys_named
        Campaigns of candidates in the wrong place (`decoys`), and in how many of them one would
        have got a name.
    """

    false_alarms: float
    candidates: int
    chance: float
    blocks: int = 0
    imperfection: float = 0.0
    worth: float = 0.0
    decoys: int = 0
    decoys_named: int = 0

    @classmethod
    def shared(
        cls,
        policy: Policy,
        candidates: int,
        samples: float,
        noise_n: float,
        least_share: float = 0.0,
    ) -> Level:
        """The level shared among candidates, of noise as white as it can be.

        Parameters
        ----------
        samples
            Independent ones.
        noise_n
            RMS of the residual, N.
        least_share
            Smallest share of the mean square that an effect must explain.
        """
        least = max(policy.indifference, policy.indifference_n / max(noise_n, 1e-300))
        chance = policy.false_alarms / max(candidates, 1)
        worth = max(least**2, least_share) * samples
        return cls(policy.false_alarms, candidates, chance, 0, policy.imperfection, worth)

    @property
    def critical(self) -> float:
        """What noise makes one parameter gain with just that probability."""
        return _gained_by_noise(self.chance)

    @property
    def white(self) -> float:
        """The same of white noise: what the level alone asks, shared among the candidates."""
        return _gained_by_noise(self.false_alarms / max(self.candidates, 1))

    @property
    def significant(self) -> float:
        """Gain of one parameter that neither noise nor the recording makes."""
        return max(self.critical, self.white + self.imperfection)

    def price(self, parameters: int, samples: int) -> float:
        """What so many parameters must gain: each beyond the first what Schwarz (1978) asks."""
        more = max(parameters, 1) - 1
        return max(self.significant, self.worth) + more * float(np.log(max(samples, 1)))

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {**vars(self), "critical": self.critical, "white": self.white}


@cache
def _gained_by_noise(chance: float) -> float:
    """What noise makes one parameter gain, in twice the log likelihood, with that probability."""
    return float(special.chdtri(1, chance))


@dataclass(frozen=True, eq=False)
class Directions:
    """In which directions of the innovations an effect's own parameters show.

    Attributes
    ----------
    ways
        Orthonormal, and to what the model without the effect can do, shape (n, k).
    innovations
        Under that model, of unit variance, shape (n,).
    counted
        By how much less than in white noise the square of a score counts, shape (k,).
    blocks
        Where blocks of the rows begin.
    ends
        Where one run's rows end and the next one's begin.
    """

    ways: Array
    innovations: Array
    counted: Array
    blocks: Places
    ends: Places

    @classmethod
    def of(
        cls, innovations: Array, own: Array, law: Array, samples: Samples, share: float
    ) -> Directions:
        """From rows of a likelihood.

        Parameters
        ----------
        innovations
            Under the model without the effect, shape (n,).
        own, law
            Derivatives by the effect's parameters, (n, k), and by those of that model.
        share
            How many independent samples one is worth.
        """
        size = np.linalg.norm(law, axis=0)
        law = law[:, size > 0.0] / size[size > 0.0]
        step, *_ = np.linalg.lstsq(law, own, rcond=1e-10)
        left = own - law @ step
        length = np.linalg.norm(left, axis=0)
        told = length > 1e-8 * np.maximum(np.linalg.norm(own, axis=0), 1e-300)
        ways = np.linalg.qr(left[:, told] / length[told])[0]
        ends = _ends(samples)
        unit = innovations / np.sqrt(max(float(np.mean(innovations**2)), 1e-300))
        parts = np.split(unit, ends)
        more = [sure_inflation(np.split(way, ends), parts, samples.steps_s) for way in ways.T]
        counted = np.array([min(share, 1.0 / m) for m in more])
        return cls(ways, unit, counted, blocks_of(samples, share), ends)

    def by_block(self, innovations: Array, blocks: Places) -> Array:
        """What noise of a model that has all that any candidate could explain scores, block by
        block, shape (blocks, k); of unit variance in noise as the evidence takes it to be."""
        scores: Array = np.add.reduceat(self.ways * innovations[:, None], blocks, axis=0)
        return scores * np.sqrt(self.counted)


def _ends(samples: Samples) -> Places:
    """Where one run's samples end and the next one's begin, among those that have weight."""
    counts = [int(np.count_nonzero(w > 0.0)) for w in samples.weight]
    return np.asarray(np.cumsum(counts)[:-1], dtype=np.intp)


_known: WeakKeyDictionary[Solution, tuple[Array, Array]] = WeakKeyDictionary()


def _rows(near: Solution) -> tuple[Array, Array]:
    """Innovations of a solution and their derivatives, kept while every candidate is tested."""
    if near not in _known:
        _known[near] = near.stacked()
    return _known[near]


def score_test(
    problem: Problem, starts: Sequence[Array], near: Solution, added: Collection[str]
) -> tuple[float, Directions, Array]:
    """What the best of some starts, at each of which the model is a smaller one still, promises
    (`score_gain`), where the added effects show, and the values to which one step from there leads;
    of many long runs, in some."""
    few = problem.thinned
    # What a smaller model sets aside beside its jumps would seem to ask for anything.
    samples = near.samples if few is problem else few.campaign.samples
    mine = np.array([few.names[i].split(".")[0] in added for i in few.open], dtype=bool)
    # At the null the rest of the model is as it was, and so are its derivatives.
    known = few is problem and near.free == np.count_nonzero(~mine)
    best: tuple[float, Array, Array, Array] | None = None
    for start in starts:
        if known:
            own = [i for i, added_here in zip(few.open, mine, strict=True) if added_here]
            r, rest = _rows(near)
            _, ways = samples.stacked(*few.linearise(start, by=own), near.noise)
            j = np.empty((len(r), len(mine)))
            j[:, mine], j[:, ~mine] = ways, rest
        else:
            r, j = samples.stacked(*few.linearise(start), near.noise)
        gain = promised_gain(*triangular(r, j), len(r))
        if few is not problem:
            gain = score_gain(problem, start, near)
        if best is None or gain > best[0]:
            best = gain, r, j, start
    assert best is not None
    gain, r, j, start = best
    there = few.decode(few.encode(start) + least_squares(j, r), start)
    shown = Directions.of(r, j[:, mine], j[:, ~mine], samples, effective_share(near))
    return gain, shown, there


def _explained(ways: Array, target: Array) -> Array:
    """What columns of unit length, some of which may be one, explain of a target."""
    size, axes = np.linalg.eigh(ways.T @ ways)
    told = size > 1e-12 * size[-1]
    step = axes[:, told] @ ((axes[:, told].T @ (ways.T @ target)) / size[told])
    found: Array = ways @ step
    return found


def _on_the_same_samples(directions: list[Directions]) -> list[Directions]:
    """Those of the largest group of directions with the same number of samples.

    A candidate that sets samples aside cannot be tested against the residual of the others.
    """
    counts = Counter(len(d.ways) for d in directions)
    usual = max(counts, key=lambda count: (counts[count], count), default=0)
    return [d for d in directions if len(d.ways) == usual]


def calibrated(level: Level, directions: Sequence[Directions]) -> Level:
    """The level at which turned signs of the residual give no more names than it allows.

    Of the residual that is taken away first which any of the candidates could explain: that is
    what is asked for. Candidates that have no direction (one that moves the instants of jumps shows
    nothing at its null), or one on other samples, keep their share of the level.
    """
    told = _on_the_same_samples([d for d in directions if d.ways.size])
    if not told:
        return level
    every = np.column_stack([d.ways for d in told])
    noise = told[0].innovations - _explained(every, told[0].innovations)
    noise /= np.sqrt(max(float(np.mean(noise**2)), 1e-300))
    # Scores may have been tested beside models whose residuals remember more or less.
    blocks = min((d.blocks for d in told), key=len)
    random = np.random.default_rng(len(blocks))
    signs = random.integers(0, 2, (DRAWS, len(blocks)), dtype=np.int8).astype(np.float32)
    signs = 2.0 * signs - np.float32(1.0)
    # All at once: the signs are read from memory once.
    columns = np.column_stack([one.by_block(noise, blocks) for one in told])
    scores = (signs @ columns.astype(np.float32)).astype(np.float64)
    ends = np.cumsum([one.ways.shape[1] for one in told])
    least: Array = np.ones(DRAWS)
    for squares in np.split(scores**2, ends[:-1], axis=1):
        least = np.minimum(least, special.chdtrc(squares.shape[1], np.sum(squares, axis=1)))
    least.sort()
    silent = max(level.candidates - len(told), 0)
    # So many draws have a name, and those that say nothing may have one besides.
    false = np.arange(1, DRAWS + 1) / DRAWS + silent * least
    allowed = np.flatnonzero(false <= level.false_alarms)
    own = float(least[allowed[-1]]) if len(allowed) else float(0.5 * least[0])
    return replace(level, chance=min(level.chance, own), blocks=len(blocks))


def with_decoys(level: Level, directions: Sequence[Directions], samples: int) -> Level:
    """The level, and how often candidates in the wrong place would have got a name at it."""
    told = [d for d in directions if d.ways.size]
    if not told:
        return level
    gains = decoy_gains(told)
    prices = [level.price(d.ways.shape[1], samples) for d in told]
    named = np.any([g > price for g, price in zip(gains, prices, strict=True)], axis=0)
    return replace(level, decoys=len(named), decoys_named=int(np.sum(named)))
