"""Campaigns like the one at hand: its motions recorded again by a model, with noise like its own.

The noise is what the model left, its signs turned at random block by block (the wild bootstrap: Wu
1986; of blocks: Shao 2010): size, tails and memory stay, and so do the places where it is large.
What the recording did to one run and not to another (a late channel, a zero of its own) is not made
again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.blocks import blocks_of
from jbf.estimation.bootstrap import read_again
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import effective_share
from jbf.estimation.noise_at import noise_at
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.models.model import Model
from jbf.records.run import Run

Array = npt.NDArray[np.float64]


def recorded_by(model: Model, runs: Sequence[Run], hidden: Sequence[str], draw: int) -> list[Run]:
    """The runs as they would be recorded once more, were the model right, or right without its
    effects."""
    campaign = Campaign.prepare(model.rig, runs)
    problem = Problem(campaign, model.law, model.clock, model.effects)
    values = np.array([model.parameters[name].value for name in problem.names])
    samples = problem.samples_at(values)
    solution = problem.solution(values, samples, noise_at(problem, samples, values))
    less = Problem(campaign, model.law, model.clock, hidden)
    friction = less.predict(np.array([model.parameters[name].value for name in less.names]))
    random = np.random.default_rng([draw, len(hidden)])
    errors = _errors(solution, campaign, random)
    return [
        read_again(p, f + e, random)
        for p, f, e in zip(campaign.prepared, friction, errors, strict=True)
    ]


def _errors(solution: Solution, campaign: Campaign, random: np.random.Generator) -> list[Array]:
    """The noise of other campaigns, N, one array a run: innovations with other signs."""
    # Where a sample does not count its innovation is nobody's: it is drawn from those that do.
    plain = replace(
        solution.samples, weight=tuple(c.astype(float) for c in solution.samples.counted)
    )
    innovations = plain.plain_innovations(solution.residuals, solution.noise)
    counted = np.concatenate([e[c] for e, c in zip(innovations, plain.counted, strict=True)])
    starts = blocks_of(
        replace(plain, weight=tuple(np.ones(len(e)) for e in innovations)),
        effective_share(solution),
    )
    lengths = np.diff(np.append(starts, sum(map(len, innovations))))
    signs = np.repeat(random.choice([-1.0, 1.0], len(starts)), lengths)
    ends = np.cumsum([len(e) for e in innovations])[:-1].astype(np.intp)
    found = []
    for e, sign, at, p in zip(
        innovations, np.split(signs, ends), plain.counted, campaign.prepared, strict=True
    ):
        # Where a sample does not count its innovation is nobody's: it is drawn from those that do.
        filled = np.where(at, e, random.choice(counted, len(e)))
        found.append(solution.noise.coloured(sign * filled, p.step_s))
    return found
