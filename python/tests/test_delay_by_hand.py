"""The delay that jumps tell, its likelihood sample by sample, and where there is none to tell."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import LAW, Array
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.exact_delay import (
    CLIPPED,
    LEAST_STEPS,
    ExactDelay,
    _Scan,
    exact_delay,
)
from jbf.estimation.likelihood import independent_share
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.spread import Spread, spread
from jbf.models.late_reading import TAU

STEP_S, TAU_S, NOISE_N = 0.02, 0.0471, 0.2
Solved = tuple[Problem, Solution, Spread]


def late(noise_n: float = NOISE_N) -> list[Run]:
    """Coulomb's friction as it was so long before, in two runs that turn round often."""
    random, runs = np.random.default_rng(3), []
    time = np.arange(0.0, 12.0, STEP_S)
    for i in range(2):

        def speed(t: Array, rate: float = 2.1 + 0.7 * i) -> Array:
            v: Array = 0.12 * np.sin(rate * t + 0.3) + 0.05 * np.sin(1.618 * rate * t)
            return v

        v = speed(time - TAU_S)
        force = LAW["F_c_n"] * np.sign(v) + LAW["F_v_n_s_m"] * v
        force = force + noise_n * random.standard_normal(len(time))
        noisy = speed(time) + 1e-4 * random.standard_normal(len(time))
        runs.append(Run.from_arrays(time, noisy, force, name=f"{i}"))
    return runs


def solved(fixed: dict[str, float]) -> Solved:
    known = {**LAW, "F_s_n": 5.0, TAU: 0.045}
    problem = Problem(Campaign.prepare(Rig(), late()), "coulomb", "journal", ("time_delay",), fixed)
    start = problem.starts({n: known[n] for n in problem.names})[0]
    near = settle(problem, problem.solution(start, problem.samples_at(start), WHITE, False))
    return problem, near, spread(problem, near)


@pytest.fixture(scope="module")
def found() -> Solved:
    return solved({"F_s_n": 5.0})


def told(found: Solved, *, values: Array | None = None, **more: Any) -> ExactDelay | None:
    problem, solution, known = found
    return exact_delay(
        problem,
        solution,
        replace(known, **more),
        solution.values if values is None else values,
    )


def test_the_jumps_tell_it_to_a_share_of_a_sample(found: Solved) -> None:
    exact = told(found)
    assert exact is not None
    which = found[0].names.index(TAU)
    assert abs(exact.values[which] - TAU_S) < 4.0 * exact.sd_s
    assert 0.0 < exact.sd_s < 0.06 * STEP_S
    left = np.concatenate(exact.residuals)
    # Of all samples but those before the force of the first one is known.
    assert np.sqrt(np.mean(left**2)) == pytest.approx(NOISE_N, rel=0.1)


def test_where_there_is_no_delay_that_is_open_none_is_told(found: Solved) -> None:
    problem, solution, known = found
    which = problem.names.index(TAU)
    k = problem.open.index(which)
    still = known.moved.copy()
    still[k] = False
    assert told(found, moved=still) is None
    endless = known.sd.copy()
    endless[k] = np.inf
    assert told(found, sd=endless) is None
    assert LEAST_STEPS == 0.05
    for steps, there in ((0.98 * LEAST_STEPS, False), (1.02 * LEAST_STEPS, True)):
        values = solution.values.copy()
        values[which] = steps * STEP_S
        assert (told(found, values=values) is not None) == there
    least = solution.values.copy()
    step_s = float(np.median([p.step_s for p in problem.campaign.prepared]))
    least[which] = LEAST_STEPS * step_s
    assert told(found, values=least) is not None
    held = solved({"F_s_n": 5.0, TAU: TAU_S})
    assert told(held) is None
    bare = Problem(problem.campaign, "coulomb", "journal", (), {"F_s_n": 5.0})
    start = bare.starts({**LAW, "F_s_n": 5.0})[0]
    near = bare.solution(start, bare.samples_at(start), WHITE, False)
    assert told((bare, near, spread(bare, near))) is None


def test_others_follow_the_delay_along_their_correlation(found: Solved) -> None:
    """By their covariance with it over its variance, each in the search's variable."""
    problem, solution, known = found
    which = problem.names.index(TAU)
    k = problem.open.index(which)
    scan = _Scan.of(problem, solution, known, solution.values, k)
    assert scan.along(float(solution.values[which])) == pytest.approx(solution.values)
    more = 1e-3
    moved = scan.along(float(solution.values[which]) + more)
    assert moved[which] == pytest.approx(solution.values[which] + more)
    change = problem.encode(moved) - problem.encode(solution.values)
    covariance = known.correlation * np.outer(known.sd, known.sd)
    own = problem.encode(np.where(np.arange(len(moved)) == which, moved, solution.values))
    step = (own - problem.encode(solution.values))[k]
    wanted = covariance[:, k] / covariance[k, k] * step
    others = [i for i in range(len(change)) if i != k]
    assert change[others] == pytest.approx(wanted[others], rel=0.05, abs=1e-12)


def test_the_likelihood_is_that_of_each_sample(found: Solved) -> None:
    """Far from a jump a square that is clipped; near one the mixture of both sides."""
    problem, solution, known = found
    k = problem.open.index(problem.names.index(TAU))
    scan = _Scan.of(problem, solution, known, solution.values, k)
    share = independent_share(
        [r * c for r, c in zip(solution.residuals, solution.samples.counted, strict=True)],
        solution.samples.steps_s,
    )
    assert CLIPPED == 5.0
    assert scan.share == pytest.approx(min(share, 1.0))
    assert scan.noise_n == pytest.approx(solution.rms_n)
    for delay in (TAU_S, TAU_S + 0.3 * STEP_S):
        total = 0.0
        for p in problem.campaign.prepared:
            reading = scan.chain.read(scan.along(delay), p.run, *p.motion_as_read, 0.0)
            for f, before, after, over, usable in zip(
                p.friction_n.tolist(),
                reading.before_n.tolist(),
                reading.after_n.tolist(),
                reading.over.tolist(),
                p.examined.usable.tolist(),
                strict=True,
            ):
                if not usable:
                    continue
                low, high = (
                    min(((f - x) / scan.noise_n) ** 2, CLIPPED**2) for x in (before, after)
                )
                if min(over, 1.0 - over) > 0.5 * np.exp(-0.5 * 3.5**2):
                    mixed = (1.0 - over) * np.exp(-0.5 * low) + over * np.exp(-0.5 * high)
                    total += -2.0 * np.log(mixed)
                else:
                    total += scan.share * (high if over > 0.5 else low)
        assert scan.cost(delay) == pytest.approx(total, rel=1e-9)
    assert scan.cost(TAU_S) < min(scan.cost(TAU_S - 0.01), scan.cost(TAU_S + 0.01)) - 10.0


def test_residuals_are_off_what_is_expected(found: Solved) -> None:
    problem, solution, known = found
    k = problem.open.index(problem.names.index(TAU))
    scan = _Scan.of(problem, solution, known, solution.values, k)
    for sd_s in (0.0, 5e-3):
        for r, p in zip(
            scan.residuals(solution.values, sd_s), problem.campaign.prepared, strict=True
        ):
            reading = scan.chain.read(solution.values, p.run, *p.motion_as_read, sd_s)
            assert r == pytest.approx(p.friction_n - reading.mean_n)
