"""Tests of what remains, on noise with so much structure in it: the amplitude at which each begins
to speak is where one number of the policy lets it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from by_hand import Array, coulomb, four_runs, one_way
from jbf import Rig
from jbf.diagnosis import Policy
from jbf.diagnosis.deviations import deviation
from jbf.diagnosis.remainder import find_patterns
from jbf.diagnosis.replicates import find_replicates
from jbf.diagnosis.second_look import second_look
from jbf.diagnosis.tones import find_tones
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem


@cache
def linear() -> Problem:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    return Problem(campaign, "coulomb", "journal", ())


@dataclass(frozen=True)
class Gate:
    """A test of noise with so much structure in it, and numbers for which it is less strict."""

    finds: Callable[[Policy, float], bool]
    loose: float
    strict: float


@cache
def noise(seed: int, n: int) -> Array:
    found: Array = np.random.default_rng(seed).standard_normal(n)
    return found


def along(axis: str) -> Callable[[Policy, float], bool]:
    """A mean that differs along one axis alone: by run, or from one speed to the next."""

    def finds(policy: Policy, size: float) -> bool:
        problem = linear()
        residuals = []
        for i, p in enumerate(problem.campaign.prepared):
            speeds = np.floor(np.abs(p.motion.velocity_m_s) / 0.008).astype(int)
            kind = np.full(len(speeds), i) if axis == "run" else speeds
            residuals.append(noise(i, len(speeds)) + size * np.where(kind % 2, 1.0, -1.0))
        values = problem.starts({})[0]
        near = problem.solution(values, problem.campaign.samples, WHITE)
        found = find_patterns(
            problem, replace(near, residuals=residuals), residuals, residuals, policy
        )
        return axis in [f.axis for f in found]

    return finds


def tone(others: float) -> Callable[[Policy, float], bool]:
    """A tone in the first run; noise so many times as large in the others."""
    campaign = linear().campaign

    def finds(policy: Policy, size: float) -> bool:
        e = [noise(i, 501) * (others if i else 1.0) for i in range(4)]
        e[0] = e[0] + size * np.sin(2.0 * np.pi * 6.3 * campaign.prepared[0].run.time_s)
        return bool(find_tones(campaign.prepared, campaign.samples, e, e, policy))

    return finds


def repeated(duration_s: float) -> Callable[[Policy, float], bool]:
    """An error that comes again with each period of one second."""

    @cache
    def solved() -> tuple[Problem, Any]:
        run = one_way("long", coulomb, rate=2.0 * np.pi, duration_s=duration_s, noise_n=0.1)
        problem = Problem(Campaign.prepare(Rig(), [run]), "coulomb", "journal", ())
        near = problem.solution(problem.starts({})[0], problem.campaign.samples, WHITE)
        return problem, near

    def finds(policy: Policy, size: float) -> bool:
        problem, near = solved()
        prepared = problem.campaign.prepared
        t = prepared[0].run.time_s
        r = noise(7, len(t)) + size * np.sign(np.sin(2.0 * np.pi * (t + 0.003)))
        return bool(find_replicates(prepared, replace(near, residuals=[r]), policy))

    return finds


def looked_at(problem: Problem, residuals: list[Array], policy: Policy) -> set[str]:
    """Kinds of finding that a second look makes of residuals."""
    near = problem.solution(problem.starts({})[0], problem.campaign.samples, WHITE)
    seen = second_look(problem, replace(near, residuals=residuals), policy)
    return {f.kind for f in seen.campaign.more_findings}


def of_runs(kind: str) -> Callable[[Policy, float], bool]:
    """Noise that is larger in every other run, or runs that have a zero of their own."""

    def finds(policy: Policy, size: float) -> bool:
        e = [noise(i, 501) for i in range(4)]
        if kind == "noise_by_run":
            e = [x * (1.0 + size * (i % 2)) for i, x in enumerate(e)]
            return kind in looked_at(linear(), e, policy)
        e = [x + size * (i % 2) for i, x in enumerate(e)]
        problem = linear()
        samples = problem.campaign.samples
        near = problem.solution(problem.starts({})[0], samples, WHITE)
        found = deviation(problem, replace(near, residuals=e), samples, policy)
        return found is not None and found.finding.kind == kind

    return finds


GATES: dict[str, Gate] = {
    # Four bins of many samples: the share decides. Two dozen: their chance does.
    "pattern_share": Gate(along("run"), 0.009, 0.011),
    "pattern_sigma": Gate(along("velocity"), 5.5, 6.5),
    "tone_chance": Gate(tone(1.0), 1e-6, 1e-8),
    "tone_share": Gate(tone(6.0), 0.0075, 0.0085),
    "replicate_sigma": Gate(repeated(20.0), 4.5, 5.5),
    "replicate_share": Gate(repeated(800.0), 0.029, 0.031),
    "deviation_chance": Gate(of_runs("level_by_run"), 2e-4, 5e-5),
}
