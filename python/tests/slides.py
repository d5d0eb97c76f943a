"""Campaigns of slides with Coulomb friction, and solutions with given residuals.

Tests of residual structure replace only the residuals of a solution, so that sizes, shares and
significance are known in closed form.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from by_hand import LAW, coulomb
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

STEP_S = 0.02
SPEED_M_S = 0.1
VALUES = {**LAW, "F_s": LAW["F_c"]}
"""Dry friction, breakaway friction (N) and viscous friction (N s/m) of every slide."""


def numbers_in(pattern: str, text: str) -> tuple[float, ...]:
    """Numbers captured by the groups of a pattern in a text."""
    match = re.search(pattern, text)
    assert match is not None, text
    return tuple(map(float, match.groups()))


def slide(velocity: Array, name: str, *, step_s: float = STEP_S, noise_rms: float = 0.1) -> Run:
    """A recorded slide with the given velocity (m/s), Coulomb friction and white noise."""
    time_s = step_s * np.arange(len(velocity))
    noise = noise_rms * np.random.default_rng(ord(name[0])).standard_normal(len(velocity))
    return Run.from_arrays(time_s, velocity, coulomb(time_s, velocity, velocity) + noise, name=name)


def slides(
    velocities: Sequence[Array], *, rig: Rig | None = None, step_s: float = STEP_S
) -> Campaign:
    """A campaign of slides with the given velocities (m/s), named a, b, c, ..."""
    runs = [slide(v, "abcdefgh"[i], step_s=step_s) for i, v in enumerate(velocities)]
    return Campaign.prepare(Rig() if rig is None else rig, runs)


def steady_slides(*counts: int) -> Campaign:
    """Slides at constant speed with the given numbers of samples."""
    return slides([np.full(n, SPEED_M_S) for n in counts])


def solution_with(
    campaign: Campaign,
    residuals: Sequence[Array],
    *,
    noise: Noise = WHITE,
    samples: Samples | None = None,
) -> tuple[Problem, Solution]:
    """Coulomb's law at the true values, and a solution with the given residuals (N)."""
    problem = Problem(campaign, "coulomb", "journal", ())
    values = np.array([VALUES[name] for name in problem.names])
    solution = problem.solution(values, samples or campaign.samples, noise)
    return problem, replace(solution, residuals=list(residuals))


def friction_of(campaign: Campaign) -> list[Array]:
    """The friction (N) in each run by Coulomb's law at the true values."""
    problem, solution = solution_with(campaign, [])
    return problem.predict(solution.values)


def white_noise(campaign: Campaign, seed: int, sigma_n: float = 1.0) -> list[Array]:
    """White noise (N) for each run of a campaign."""
    random = np.random.default_rng(seed)
    return [sigma_n * random.standard_normal(len(p.run)) for p in campaign.prepared]
