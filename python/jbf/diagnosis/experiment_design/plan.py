"""Design of runs: motions of a rig that best show and discriminate possible missing effects.

The Fisher information on the parameters of the law, and on each effect at its typical strength, is
the sum over the runs. Runs are chosen one after the other (a greedy exact design: Atkinson, Donev &
Tobias 2007, ch. 12).

The criterion is the information on every effect, in multiples of its threshold. Information shared
with the law and with the most similar effect is excluded. The criterion without the most
informative run is also maximised, since a diagnosis requires confirmation by held-out runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from jbf.arrays import Array
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.experiment_design.excitations import (
    MOST_SAMPLES,
    USUAL_RATE_RAD_S,
    Limits,
    missing_columns,
    runs_to_play,
)
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.power.planned_runs import PlannedPower, as_recorded, planned_power
from jbf.diagnosis.power.strength import Strength, strength_of
from jbf.errors import InputError
from jbf.estimation.likelihood import effective_share
from jbf.models.driven import Driven
from jbf.models.model import Model
from jbf.records.arguments import of_kind
from jbf.records.motion.position import travel_of
from jbf.records.run import Run
from jbf.records.toml_file import number
from jbf.results import Result
from jbf.threads import one_blas_thread

ENOUGH, MORE = 4.0, 0.05
"""Information on an effect, in multiples of its threshold, that suffices; weight of any excess."""
LEAST_RUNS = 3
"""Smallest number of runs; fewer are not enough for a prediction of a held-out run."""
MOST_RUNS = 200
"""Largest number of runs; more are not practical, and each is simulated."""


@dataclass(frozen=True, repr=False)
class Plan(Result):
    """Planned runs to record, with their detection limits.

    Attributes
    ----------
    runs
        Motions, most informative first: time, speed, position or angle, load; without friction.
    words
        Description of each motion.
    planned
        Detection limits of effects in these runs.
    travel_limit
        Largest distance between two positions of a run, in m (rad for a rotary drive); None if it
        is not limited.
    travel_source
        `given` as a limit, or `recorded` in the runs of the model; None without a limit.

    Examples
    --------
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> limits = jbf.Limits(velocity=0.2, duration_s=4.0)
    >>> plan = jbf.plan(model, limits=limits, minutes=0.2, noise_rms=0.2, step_s=0.05)
    >>> [run.duration_s for run in plan.runs], len(plan.words)
    ([3.95, 3.95, 3.95], 3)
    """

    runs: tuple[Run, ...]
    words: tuple[str, ...]
    planned: PlannedPower
    travel_limit: float | None = None
    travel_source: Literal["given", "recorded"] | None = None

    @property
    def travel(self) -> float:
        """Largest distance between two positions of a planned run."""
        return max(travel_of(run, self.planned.model.rig.radius_m) for run in self.runs)

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-serialisable dict."""
        motions = [
            {"run": run.name, "motion": words}
            for run, words in zip(self.runs, self.words, strict=True)
        ]
        return {
            "plan": motions,
            "travel": self.travel,
            "travel_limit": self.travel_limit,
            "travel_source": self.travel_source,
            **self.planned.to_dict(),
        }


@one_blas_thread
def plan(
    model: Model,
    *,
    limits: Limits,
    minutes: float,
    noise_rms: float,
    step_s: float = 0.02,
    policy: Policy = DEFAULT,
) -> Plan:
    """Design the runs with the largest power for effects that a model may lack.

    Parameters
    ----------
    model
        Assumed model of the machine: from a fit, or a `Model` with values of a data sheet.
    limits
        Limits of the rig; its speed must be given, and `duration_s` is that of each run. The travel
        is by default that of the runs to which the model was fitted.
    minutes
        Total duration of all runs, min.
    noise_rms
        Standard deviation of the noise on the friction, N (for a rotary drive N m).
    step_s
        Sampling interval, s.
    policy
        Policy of the later diagnosis, with the thresholds from which an effect is named.

    Returns
    -------
    Plan
        Motions, most informative first, and their power.

    Raises
    ------
    InputError
        The speed is missing, a number is not positive, or the total duration is too short for
        three runs or too long.

    Examples
    --------
    >>> model = jbf.Model(jbf.Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})
    >>> limits = jbf.Limits(velocity=0.2, duration_s=4.0)
    >>> plan = jbf.plan(model, limits=limits, minutes=0.2, noise_rms=0.2, step_s=0.05)
    >>> len(plan.runs)
    3
    """
    of_kind(model, Model, "model", "give a jbf.Model")
    of_kind(limits, Limits, "limits", "give a jbf.Limits")
    for name, value in (("minutes", minutes), ("noise_rms", noise_rms), ("step_s", step_s)):
        if not (np.isfinite(number(value, name)) and value > 0.0):
            raise InputError(key=name, problem=f"{value:g} is not above zero", remedy="increase it")
    if limits.velocity is None:
        raise InputError(
            problem="the limit velocity_m_s is missing", remedy="give the highest speed of the rig"
        )
    if limits.acceleration is None:
        limits = replace(limits, acceleration=USUAL_RATE_RAD_S * limits.velocity)
    recorded = model.fit.get("travel")
    source: Literal["given", "recorded"] | None = None if limits.travel is None else "given"
    if source is None and isinstance(recorded, float) and recorded > 0.0:
        limits, source = replace(limits, travel=recorded), "recorded"
    count = int(min(60.0 * minutes / limits.duration_s, 2.0 * MOST_RUNS) + 1e-9)
    if count < LEAST_RUNS:
        raise InputError(
            key="minutes",
            problem=f"{minutes:g} allow only {count} runs of {limits.duration_s:g} s",
            remedy=f"allow time for at least {LEAST_RUNS} runs, or make them shorter",
        )
    if count > MOST_RUNS:
        raise InputError(
            key="minutes",
            problem=f"{minutes:g} allow more than {MOST_RUNS} runs of {limits.duration_s:g} s",
            remedy="allow less time, or make the runs longer",
        )
    step_s = max(step_s, limits.duration_s / MOST_SAMPLES)
    rig = model.rig
    linear = rig.bearing is None and (rig.drive is None or rig.drive.motion == "linear")
    motions = list(runs_to_play(rig, limits, step_s, linear=linear))
    # The effects are determined with some slow and fast motions at each load and temperature.
    few = motions[:: max(len(motions) // 7, 1)]
    named = [replace(run, name=f"{i}") for i, (_, run, _) in enumerate(few)]
    candidates = as_recorded(model, named, noise_rms, policy)
    effects = _effects(candidates, model)
    information = [
        _motion_information(candidates, model, effects, motion, noise_rms) for *_, motion in motions
    ]
    free = len(candidates.fitted(model.effects).problem.open)
    prices = np.array([candidates.price(max(len(e.problem.open) - free, 1)) for e in effects])
    chosen = _chosen(information, free, prices, count)
    runs = tuple(replace(motions[k][1], name=f"{i:02d}") for i, k in enumerate(chosen, 1))
    words = tuple(motions[k][0].words for k in chosen)
    power = planned_power(model, runs, noise_rms=noise_rms, policy=policy)
    return Plan(runs, words, power, limits.travel, source)


def _effects(candidates: Candidates, model: Model) -> list[Strength]:
    """Effects, not in the model, that at least one of the possible motions can show."""
    return [
        strength
        for name in candidates.names
        if name not in model.effects and not missing_columns([name])
        if (strength := strength_of(candidates, model.effects, name)) is not None
    ]


def _motion_information(
    candidates: Candidates,
    model: Model,
    effects: Sequence[Strength],
    motion: Driven,
    noise_rms: float,
) -> Array:
    """Fisher information of a motion, shape (p + e, p + e).

    The first p rows belong to the parameters of the law, the others to the e effects at their
    typical strength.
    """
    fitted = candidates.fitted(model.effects)
    friction, slopes = fitted.predict(motion)
    changes = [e.problem.chain.predict(e.values(1.0), [motion])[0] - friction for e in effects]
    rows = np.column_stack([slopes, *changes])
    # A sample of an autocorrelated residual contains less information.
    rows *= np.sqrt(effective_share(fitted.current_solution())) / noise_rms
    product: Array = rows.T @ rows
    return product


def _chosen(information: Sequence[Array], free: int, prices: Array, count: int) -> list[int]:
    """Choose `count` motions one by one, with repetitions, to maximise their joint criterion.

    `information` is the Fisher information of each motion; the criterion is `_design_criterion`,
    with its arguments. Returns the indices of the chosen motions.
    """
    chosen: list[int] = []

    def criterion(k: int) -> float:
        """Design criterion with motion k, plus that without the run whose removal costs most."""
        runs = [*chosen, k]
        total = np.sum([information[i] for i in runs], axis=0)
        without = min(_design_criterion(total - information[i], free, prices) for i in set(runs))
        return _design_criterion(total, free, prices) + without

    for _ in range(count):
        chosen.append(max(range(len(information)), key=criterion))
    return chosen


def _design_criterion(information: Array, free: int, prices: Array) -> float:
    """Design criterion of a set of motions: larger where each effect is more clearly detectable.

    The first `free` rows of the Fisher information, shape (free + e, free + e), belong to the law,
    the others to e effects with thresholds `prices`, shape (e,). The information on an effect, less
    the part shared with the law and with the most similar effect, is divided by its threshold. The
    criterion is the sum of ``log(1 + min(m, ENOUGH))`` over these multiples m, plus `MORE` times
    the logarithm of any excess.
    """
    of_law, of_effects = information[:free, :free], information[free:, free:]
    covariance = np.linalg.pinv(of_law, rcond=1e-10, hermitian=True)
    apart = of_effects - information[free:, :free] @ covariance @ information[:free, free:]
    size = np.maximum(np.diag(apart), 0.0)
    shared = apart**2 / np.maximum(size, 1e-300)[None, :]
    np.fill_diagonal(shared, 0.0)
    unshared = np.maximum(size - np.max(shared, axis=1, initial=0.0), 0.0)
    multiples = unshared / prices
    return float(
        np.sum(np.log1p(np.minimum(multiples, ENOUGH)))
        + MORE * np.sum(np.log(np.maximum(multiples, ENOUGH)))
    )
