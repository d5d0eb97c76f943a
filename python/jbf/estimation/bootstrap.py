"""The errors of a fit by fitting again: the parametric bootstrap (Efron, Annals of Statistics 7,
1979).

A fit takes its standard errors from the curvature of the likelihood: right where predictions are
nearly straight in the parameters and the noise is the friction's own. Of a drive that rings neither
holds: its likelihood has peak beside peak, and what the record of the motion gets wrong it
amplifies. Here the fitted model records the same runs many times, with noise on friction, speed and
angle as the records have it; each is fitted as the measured ones were, and the answers scatter as
they do.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.determined import undetermined
from jbf.estimation.fit import Fit
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import Noise
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem, named_values
from jbf.models.catalogue import Parameter
from jbf.models.parameter_value import ParameterValue
from jbf.records.arguments import check_callable, of_kind, whole_number
from jbf.records.motion.roughness import encoder_step
from jbf.records.run import Run
from jbf.results import Result
from jbf.threads import one_blas_thread

Array = npt.NDArray[np.float64]

LEAST_REPEATS = 19
"""The middle 68 % of fewer answers are too few to tell a width."""
MOST_REPEATS = 100_000
"""More would take for ever, and tell nothing more."""


@dataclass(frozen=True, repr=False)
class Bootstrap(Result):
    """Answers of repeated fits.

    Attributes
    ----------
    fit
        The fit with each standard error half as wide as what holds the middle 68 % of the answers,
        and no smaller than the fit's own; what is larger than its parameter leaves that held.
    values
        Parameter name to the answers, shape (repeats,).
    """

    fit: Fit
    values: dict[str, Array]

    def to_dict(self) -> dict[str, Any]:
        """For JSON: the fit, and every answer."""
        return {**self.fit.to_dict(), "answers": {n: v.tolist() for n, v in self.values.items()}}


def check_repeats(repeats: int, name: str = "repeats") -> None:
    """An InputError where so few tell no error."""
    if whole_number(repeats, name) < LEAST_REPEATS:
        raise InputError(
            problem=f"{name} {repeats} is too few to tell an error",
            mend=f"ask for {LEAST_REPEATS} or more; 40 tell it better",
        )
    if repeats > MOST_REPEATS:
        raise InputError(
            problem=f"{name} {repeats} is too many", mend=f"ask for {MOST_REPEATS} or less"
        )


@one_blas_thread
def bootstrap(
    fitted: Fit,
    runs: Sequence[Run],
    *,
    repeats: int = 40,
    seed: int = 0,
    start: Mapping[str, float] | None = None,
    progress: Callable[[str, int, int], None] | None = None,
) -> Bootstrap:
    """Fit simulated records of the same runs, and take the errors from how the answers scatter.

    Takes `repeats` times as long as the fit.

    Parameters
    ----------
    fitted
        What :func:`jbf.fit` made of `runs`.
    repeats
        How often. An error from 19 answers is known to a quarter, from 40 to a fifth.
    seed
        The same seed gives the same answers.
    start
        What :func:`jbf.fit` was started from, if it was.
    progress
        Called with a message, fits done and fits in all.

    Raises
    ------
    InputError
        Fewer than 19 repeats, or runs that cannot be prepared.
    """
    check_repeats(repeats)
    whole_number(seed, "seed")
    check_callable(progress, "progress")
    of_kind(fitted, Fit, "the fit", "give what jbf.fit made of these runs")
    model = fitted.model
    campaign = Campaign.prepare(model.rig, runs)
    truth = {name: p.value for name, p in fitted.parameters.items()}
    held = {name: truth[name] for name in fitted.fixed}
    problem = Problem(campaign, model.law, model.clock, model.effects, held)
    random = np.random.default_rng(seed)
    predictions = problem.predict(np.array([truth[name] for name in problem.names]))
    sigmas = innovation_sizes(fitted, campaign)
    answers = []
    for k in range(repeats):
        if progress is not None:
            progress("fitting again", k, repeats)
        again = [
            recorded_again(p, f, fitted.noise, sigma, random)
            for p, f, sigma in zip(campaign.prepared, predictions, sigmas, strict=True)
        ]
        other = Problem(
            Campaign.prepare(model.rig, again), model.law, model.clock, model.effects, held
        )
        answers.append(minimum(other, [named_values(start, problem.parameters)]).values)
    values = dict(zip(problem.names, np.array(answers).T, strict=True))
    parameters = {
        name: with_error(p, values[name], problem.parameters[name])
        for name, p in fitted.parameters.items()
    }
    model = replace(model, parameters=parameters, fit={**model.fit, "bootstrap": repeats})
    told = [name for name, p in fitted.parameters.items() if not p.held]
    kept = [k for k, name in enumerate(told) if not parameters[name].held]
    among = fitted.correlations[kept][:, kept]
    fit = replace(fitted, model=model, parameters=parameters, correlations=among, doubtful=())
    return Bootstrap(fit, values)


def innovation_sizes(fitted: Fit, campaign: Campaign) -> list[float]:
    """Standard deviation of the innovations of each run, N; of all together where a run has few
    samples."""
    samples = campaign.samples
    whole = samples.innovations(fitted.residuals, fitted.noise)
    pieces = [e[counted] for e, counted in zip(whole, samples.counted, strict=True)]
    usual = float(np.sqrt(np.mean(np.concatenate(pieces) ** 2)))
    return [float(np.sqrt(np.mean(e**2))) if len(e) >= 100 else usual for e in pieces]


def recorded_again(
    prepared: Prepared, friction_n: Array, noise: Noise, sigma_n: float, random: np.random.Generator
) -> Run:
    """The run as its instruments would show it once more, were the prediction right."""
    error = noise.coloured(random.normal(0.0, sigma_n, len(prepared.run)), prepared.step_s)
    return read_again(prepared, friction_n + error, random)


def read_again(prepared: Prepared, friction_n: Array, random: np.random.Generator) -> Run:
    """The run with this reading of its friction, and its motion as its instruments would show it
    once more.

    A column that is not believed tells nothing, and stays as it was: to be left aside again. So
    does a force whose sign nobody knows: the motion read once more may know it, and a model that
    took it for the other one had recorded a bad sample there.
    """
    run, motion = prepared.run, prepared.motion
    n = len(run)
    read = prepared.friction_n
    friction = np.where(np.isfinite(read) & motion.sign_known, friction_n, read)
    # The recorded errors of the speed with other signs: as large as they were, where they were.
    off = (run.velocity_m_s - motion.velocity_m_s) * random.choice([-1.0, 1.0], n)
    moving = ~motion.resting
    velocity = np.where(moving, motion.velocity_m_s + off, run.velocity_m_s)
    if "velocity_m_s" in motion.aside:
        velocity = run.velocity_m_s
    angle, position = run.angle_rad, run.position_m
    if angle is not None and "angle_rad" not in motion.aside:
        angle = _path_again(np.unwrap(angle), motion.angle_rad, moving, random)
    if position is not None and "position_m" not in motion.aside:
        arm = prepared.rig.bearing.radius_m if prepared.rig.bearing is not None else 1.0
        position = _path_again(position, motion.angle_rad * arm, moving, random)
    return replace(
        run, velocity_m_s=velocity, friction_n=friction, angle_rad=angle, position_m=position
    )


def _path_again(
    recorded: Array, true: Array, moving: npt.NDArray[np.bool_], random: np.random.Generator
) -> Array:
    """A path read off an encoder whose lines lie elsewhere; off a scale without lines, with its
    errors turned round."""
    off = recorded - true
    step = encoder_step(recorded[moving])
    if step > 0.0:
        phase = random.uniform(0.0, step)
        again = np.round((true - phase) / step) * step + phase
    else:
        again = true + off * random.choice([-1.0, 1.0], len(true))
    read: Array = np.where(moving, again, recorded)
    return read


def with_error(value: ParameterValue, answers: Array, page: Parameter) -> ParameterValue:
    """The value with the error that its answers show."""
    if value.stderr is None:
        return value
    off = answers - value.value
    if page.period is not None:
        off -= page.period * np.round(off / page.period)
    # Of the middle of the answers: those that ended on a far peak would make it any size.
    low, high = np.quantile(off, [0.15866, 0.84134])
    # No estimate is surer than the curvature has it (Cramer 1946, ch. 32), and few answers may lie
    # closer together than they should.
    error = max(float(0.5 * (high - low)), value.stderr)
    note = undetermined(page, value.value, error)
    return replace(value, stderr=None if note else error, note=note, held=note is not None)
