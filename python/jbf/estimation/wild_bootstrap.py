"""Simulated campaigns with the recorded motions, a model's friction and noise like that recorded.

The noise is the residual of the model with random signs by block (wild bootstrap: Wu 1986; for
blocks: Shao 2010). Its size, tails and correlation time are kept, as are the times at which it is
large. Recording artefacts of a single run (a delayed channel, a zero of its own) are not simulated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.blocks import blocks_of
from jbf.estimation.bootstrap import simulated_readings
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import effective_share
from jbf.estimation.noise_at import noise_at
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.models.model import Model
from jbf.records.run import Run

Array = npt.NDArray[np.float64]


def recorded_by(model: Model, runs: Sequence[Run], hidden: Sequence[str], draw: int) -> list[Run]:
    """Simulate new recordings of the runs by a model, or by a model with only some of its effects.

    Parameters
    ----------
    hidden
        Effects of the model that the simulated friction contains.
    draw
        Number of the simulation, used as the seed.
    """
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
        simulated_readings(p, f + e, random)
        for p, f, e in zip(campaign.prepared, friction, errors, strict=True)
    ]


def _errors(solution: Solution, campaign: Campaign, random: np.random.Generator) -> list[Array]:
    """Simulated noise of the runs, N, one array a run: innovations with random signs."""
    # The innovation of a sample that does not count is meaningless; it is drawn from the others.
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
        # The innovation of a sample that does not count is meaningless; it is drawn from the
        # others.
        filled = np.where(at, e, random.choice(counted, len(e)))
        found.append(solution.noise.coloured(sign * filled, p.step_s))
    return found
