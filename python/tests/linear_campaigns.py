"""Simulated campaigns of Coulomb friction, which is linear in every parameter.

The records come from closed forms written out here and in `by_hand`. `Textbook` computes fits,
errors and likelihood gains by linear least squares, independently of jbf.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from by_hand import LAW, Array, Friction, coulomb, four_runs, wandering
from jbf import Diagnosis, Rig, Run, diagnose, effects
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import settle
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from scipy import stats
from shared import shared

RECORDED_QUANTITIES = {"angle", "path", "position", "loads", "temperatures"}
CANDIDATES = sum(
    "coulomb" not in effect.refused and not RECORDED_QUANTITIES & set(effect.needs)
    for effect in effects().values()
)
"""Number of effects that apply to Coulomb's law and need no column in addition to the motion."""


def mass(kilograms: float) -> Friction:
    """Coulomb friction and the inertia of a mass."""
    return lambda t, v, a: coulomb(t, v, a) + kilograms * a


def lag(seconds: float) -> Friction:
    """Coulomb friction with a sensor lag to first order, where it is equivalent to a delay."""
    return lambda t, v, a: coulomb(t, v, a) - seconds * 20.0 * a


def offset_and_tone(offset_n: float, amplitude_n: float) -> Friction:
    """Coulomb friction, a sensor offset and a tone of 3 Hz."""
    return lambda t, v, a: coulomb(t, v, a) + offset_n + amplitude_n * np.sin(2.0 * np.pi * 3.0 * t)


def offset_and_drag(t: Array, v: Array, a: Array) -> Array:
    """Coulomb friction, a sensor offset of 0.5 N and a drag of 150 N s^2/m^2."""
    return coulomb(t, v, a) + 0.5 + 150.0 * v * np.abs(v)


HIDDEN: dict[str, tuple[Friction, float]] = {
    "nothing": (coulomb, 0.1),
    "weak mass": (mass(0.06), 0.1),
    "mass": (mass(0.2), 0.1),
    "offset and drag": (offset_and_drag, 0.1),
    "lag": (lag(0.005), 0.05),
    "offset and tone": (offset_and_tone(0.5, 0.46), 0.3),
}
"""Friction and standard deviation of its white noise (N) by the name of the campaign."""


def linear_runs(hidden: str) -> list[Run]:
    """Four runs of 10 s, each in one direction."""
    if hidden == "mass in one run":
        first = wandering("a", mass(3.2), direction=1.0, rate=12.0, noise_rms=0.1, seed=0)
        return [first, *four_runs(coulomb, noise_rms=0.1)[1:]]
    friction, noise_rms = HIDDEN[hidden]
    return four_runs(friction, noise_rms=noise_rms)


@shared
def linear_diagnosis(hidden: str) -> Diagnosis:
    """Diagnosis of one of the campaigns."""
    return diagnose(Rig(), linear_runs(hidden), law="coulomb")


def reversing_runs(
    change: Callable[[int, Array, Array, np.random.Generator], Array],
    *,
    runs: int = 6,
    duration_s: float = 30.0,
    seed: int = 0,
) -> list[Run]:
    """Runs that reverse at different times, so that an offset is separable from dry friction.

    Parameters
    ----------
    change
        Recorded force from the number of the run, time (s), friction (N) and random generator.
    """
    random = np.random.default_rng(seed)
    t = np.arange(0.0, duration_s, 0.02)
    records = []
    for i in range(runs):
        rate = 1.0 + 0.17 * i
        v = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + i)
        force = change(i, t, coulomb(t, v, v), random)
        records.append(Run.from_arrays(t, v, force, name=f"run {i}"))
    return records


def coulomb_run(t: Any, v: Any, seed: int, *, noise_rms: float = 0.1, **columns: Any) -> Run:
    """A run with Coulomb friction and white noise at these times and speeds, named by its seed."""
    noise = noise_rms * np.random.default_rng(seed).standard_normal(len(t))
    return Run.from_arrays(t, v, coulomb(t, v, v) + noise, name=f"{seed}", **columns)


def coulomb_candidates(runs: Sequence[Run], policy: Policy = DEFAULT) -> Candidates:
    """The candidate effects for Coulomb's law in these runs of a slide."""
    return Candidates(Campaign.prepare(Rig(), runs), "coulomb", "journal", policy)


def fit_from_truth(campaign: Campaign, *effects: str) -> tuple[Problem, Solution]:
    """Coulomb's law fitted from its true values and from a delay or sensor lag of 10 ms.

    F_s, which these motions do not determine, is fixed.
    """
    problem = Problem(campaign, "coulomb", "journal", effects, {"F_s": 6.0})
    known = {"F_s": 6.0, **LAW, "sensor_offset.b": 0.0}
    known |= {"time_delay.tau_s": 0.01, "sensor_lag.tau_s": 0.01}
    start = problem.starts({name: known[name] for name in problem.names})[0]
    near = problem.solution(start, problem.samples_at(start), WHITE, False)
    return problem, settle(problem, near)


class Textbook:
    """Linear least squares of the four runs on direction, speed and acceleration."""

    def __init__(self, runs: list[Run]) -> None:
        # The motions of `four_runs` do not depend on the friction.
        accelerations = four_runs(lambda t, v, a: a, noise_rms=0.0)
        self.x = [
            np.stack([np.sign(r.velocity), r.velocity, np.asarray(a.friction)], axis=1)
            for r, a in zip(runs, accelerations, strict=True)
        ]
        self.y = [np.asarray(run.friction) for run in runs]
        self.samples = sum(map(len, self.y))

    def square(self, columns: int, fitted: list[int], predicted: list[int]) -> float:
        """Sum of squared errors in `predicted` of a model fitted to the runs `fitted`."""
        x = np.concatenate([self.x[i][:, :columns] for i in fitted])
        y = np.concatenate([self.y[i] for i in fitted])
        values = np.linalg.lstsq(x, y, rcond=None)[0]
        errors = [self.y[i] - self.x[i][:, :columns] @ values for i in predicted]
        return float(sum(np.sum(e**2) for e in errors))

    def rms(self, columns: int) -> float:
        """RMS error of a fit to all runs (N)."""
        return float(np.sqrt(self.square(columns, [0, 1, 2, 3], [0, 1, 2, 3]) / self.samples))

    def held_out_rms(self, columns: int) -> float:
        """RMS error over runs that are predicted from the other three (N)."""
        square = sum(self.square(columns, [k for k in range(4) if k != i], [i]) for i in range(4))
        return float(np.sqrt(square / self.samples))

    def gain(self) -> float:
        """Twice the log-likelihood gain of the mass in white noise."""
        return float(2.0 * self.samples * np.log(self.rms(2) / self.rms(3)))


def threshold(parameters: int, samples: int) -> float:
    """Gain that an effect with this number of parameters must exceed under the default policy.

    The larger of two values, plus log n for each further parameter (Schwarz 1978): the chi-square
    quantile of a false-alarm rate of 1 % shared among the candidates (Bonferroni) plus the artefact
    margin of 22; and n times the square of the minimum effect size, 3 % of the residual.
    """
    least = max(float(stats.chi2.isf(0.01 / CANDIDATES, 1)) + 22.0, 0.03**2 * samples)
    return least + max(parameters - 1, 0) * float(np.log(samples))
