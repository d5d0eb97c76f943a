"""Bootstrap standard errors from fits to simulated recordings of the fitted runs.

Standard errors from the curvature of the likelihood are valid if predictions are nearly linear in
the parameters and the residual contains only the noise of the friction. Neither condition holds for
a drive with a resonance: its likelihood has many adjacent maxima, and the resonance amplifies
errors of the recorded motion.

Notes
-----
`bootstrap` is parametric (Efron 1979): the fitted model simulates the runs with Gaussian noise of
the estimated size on the friction, and errors of speed and position like the recorded ones.
`simulated_runs` is a wild bootstrap: its noise is the residual of the model with random signs by
block (Wu 1986; for blocks: Shao 2010). Size, tails and correlation time of the residual are kept,
as are the times at which it is large.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.errors import InputError, Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.fit import Fit
from jbf.estimation.generalised_least_squares import stages_of_fit
from jbf.estimation.identifiability import reason_not_identifiable
from jbf.estimation.likelihood import effective_share, noise_at
from jbf.estimation.noise import Noise
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem, named_values
from jbf.estimation.solution import Solution
from jbf.estimation.variance import blocks_of
from jbf.estimation.work import TimeLimit
from jbf.models.catalogue import Parameter
from jbf.models.driven_motion import driven_motion
from jbf.models.model import Model
from jbf.models.parameter_value import ParameterValue
from jbf.records.angles import continuous
from jbf.records.arguments import check_callable, checked_integer, of_kind
from jbf.records.motion.roughness import encoder_step
from jbf.records.run import Run
from jbf.results import Result
from jbf.threads import one_blas_thread

LEAST_REPEATS = 19
"""Minimum number of repeats: fewer do not determine the width of the central 68 %."""
MOST_REPEATS = 100_000
"""Maximum number of repeats; more take too long and add no information."""


@dataclass(frozen=True, repr=False)
class Bootstrap(Result):
    """Bootstrap standard errors, and the estimates from fits to simulated records.

    Attributes
    ----------
    fit
        The fit with new standard errors. Each is half the width of the central 68 % of the
        estimates, and at least the standard error of the fit itself. A parameter is held fixed if
        its error is too large for an estimate (`reason_not_identifiable`).
    values
        Parameter name to its estimates, shape (repeats,).

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> fit = jbf.fit(jbf.Rig(), [run], law="coulomb", fixed={"F_s": 6.0})
    >>> again = jbf.bootstrap(fit, [run], repeats=19)
    >>> again.fit.cov_type
    'bootstrap'
    """

    fit: Fit
    values: dict[str, Array]

    def to_dict(self) -> dict[str, Any]:
        """Return the fit and all estimates as a dictionary for JSON."""
        return {**self.fit.to_dict(), "answers": {n: v.tolist() for n, v in self.values.items()}}


def check_repeats(repeats: int, name: str = "repeats") -> None:
    """Raise an InputError if the number of repeats is too small or too large."""
    if checked_integer(repeats, name) < LEAST_REPEATS:
        raise InputError(
            problem=f"{name} {repeats} is too small for standard errors",
            remedy=f"use at least {LEAST_REPEATS}; 40 is more precise",
        )
    if repeats > MOST_REPEATS:
        raise InputError(
            problem=f"{name} {repeats} is too large", remedy=f"use at most {MOST_REPEATS}"
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
    time_limit_s: float | TimeLimit | None = None,
) -> Bootstrap:
    """Compute standard errors from the scatter of fits to simulated records of the same runs.

    The computing time is `repeats` times that of the fit.

    Parameters
    ----------
    fitted
        Result of :func:`jbf.fit` for `runs`.
    runs
        The runs that were fitted.
    repeats
        Number of simulated sets of runs. The relative uncertainty of a standard error is a quarter
        with 19 estimates, and a fifth with 40.
    seed
        Seed of the random numbers; equal seeds give equal results.
    start
        Starting values that were given to :func:`jbf.fit`, if any.
    progress
        Called with a message, the number of completed fits and the total number of fits.
    time_limit_s
        Duration after which the computation is aborted, s; None for no limit.

    Returns
    -------
    Bootstrap
        The fit with new standard errors, and the estimates.

    Raises
    ------
    InputError
        Fewer than 19 repeats, or runs that cannot be prepared.
    Unfinished
        A fit exceeded its budget, or the time limit was reached; the exception holds `fitted`.

    Notes
    -----
    The fitted model simulates the runs with the noise of the fit and of the instruments. Each
    simulated set is fitted as the measured one (Efron 1979). The standard error is half the width
    of the central 68 % of the estimates.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> fit = jbf.fit(jbf.Rig(), [run], law="coulomb", fixed={"F_s": 6.0})
    >>> again = jbf.bootstrap(fit, [run], repeats=19)
    >>> again.values["F_c"].shape
    (19,)
    """
    check_repeats(repeats)
    limit = TimeLimit.of(time_limit_s)
    checked_integer(seed, "seed")
    check_callable(progress, "progress")
    of_kind(fitted, Fit, "the fit", "give the result of jbf.fit for these runs")
    model = fitted.model
    campaign = Campaign.prepare(model.rig, runs)
    truth = {name: p.value for name, p in fitted.parameters.items()}
    held = {name: truth[name] for name in fitted.fixed}
    bounds = dict(fitted.bounds)
    problem = Problem(campaign, model.law, model.clock, model.effects, held, bounds)
    given = named_values(start, problem.parameters)
    random = np.random.default_rng(seed)
    if len(fitted.innovation_rms) != len(campaign.prepared):
        raise InputError(
            problem=f"the fit is not one to these {len(campaign.prepared)} runs",
            remedy="give the runs that were fitted",
        )
    # The prediction includes a common delay of the force; each fit estimates it again.
    predictions = _delayed_predictions(problem, model)
    estimates = []
    for k in range(repeats):
        if progress is not None:
            progress("fitting again", k, repeats)
        simulated = [
            simulated_recording(p, f, fitted.noise, sigma, random)
            for p, f, sigma in zip(
                campaign.prepared, predictions, fitted.innovation_rms, strict=True
            )
        ]
        try:
            again = Campaign.prepare(model.rig, simulated, time_limit=limit)
            refit = Problem(again, model.law, model.clock, model.effects, held, bounds)
            *_, (_, solution) = stages_of_fit(refit, given)
            estimates.append(solution.values)
        except Unfinished as stop:
            raise stop.with_fit(fitted, campaign.named) from None
    values = dict(zip(problem.names, np.array(estimates).T, strict=True))
    parameters = {
        name: with_error(p, values[name], problem.parameters[name])
        for name, p in fitted.parameters.items()
    }
    model = replace(model, parameters=parameters, fit={**model.fit, "bootstrap": repeats})
    estimated = [name for name, p in fitted.parameters.items() if not p.held]
    kept = [k for k, name in enumerate(estimated) if not parameters[name].held]
    fit = replace(
        fitted,
        model=model,
        parameters=parameters,
        correlations=fitted.correlations[kept][:, kept],
        doubtful=(),
        cov_type="bootstrap",
    )
    return Bootstrap(fit, values)


def _delayed_predictions(problem: Problem, model: Model) -> list[Array]:
    """Predict the friction of the prepared runs with the parameters and the delay of a model, N.

    The effects are those of the problem, a part of those of the model.
    """
    values = np.array([model.parameters[name].value for name in problem.names])
    if model.force_delay_s == 0.0:
        return problem.predict(values)
    motions = []
    for p in problem.campaign.prepared:
        instants, motion = p.motion_as_read
        read = np.clip(p.run.time_s - model.force_delay_s, instants[0], instants[-1])
        motions.append(driven_motion(p.rig, p.run, motion.at(instants, read)))
    return problem.chain.predict(values, motions)


def simulated_recording(
    prepared: Prepared, friction: Array, noise: Noise, sigma_n: float, random: np.random.Generator
) -> Run:
    """Simulate a recording of a run with the predicted friction and the noise of the model."""
    error = noise.coloured(random.normal(0.0, sigma_n, len(prepared.run)), prepared.step_s)
    return simulated_readings(prepared, friction + error, random)


def simulated_readings(prepared: Prepared, friction: Array, random: np.random.Generator) -> Run:
    """Simulate a recording of the motion by the instruments of a run, with the given friction.

    A column that the fit disregards is kept unchanged, so that it is disregarded again. The
    friction of a sample with an unknown sign of motion is also kept. The simulated motion may
    determine the sign, and a friction simulated with the opposite sign would be an outlier.
    """
    run, motion = prepared.run, prepared.motion
    n = len(run)
    recorded = prepared.friction
    friction = np.where(np.isfinite(recorded) & motion.sign_known, friction, recorded)
    # The recorded errors of the speed with random signs keep their sizes and positions.
    error = (run.velocity - motion.velocity) * random.choice([-1.0, 1.0], n)
    moving = ~motion.resting
    velocity = np.where(moving, motion.velocity + error, run.velocity)
    if "velocity_m_s" in motion.aside:
        velocity = run.velocity
    angle, position = run.angle_rad, run.position_m
    if angle is not None and "angle_rad" not in motion.aside:
        angle = _simulated_path(continuous(angle), motion.angle_rad, moving, random)
    if position is not None and "position_m" not in motion.aside:
        arm = prepared.rig.bearing.radius_m if prepared.rig.bearing is not None else 1.0
        position = _simulated_path(position, motion.angle_rad * arm, moving, random)
    return replace(run, velocity=velocity, friction=friction, angle_rad=angle, position_m=position)


def _simulated_path(
    recorded: Array, true: Array, moving: npt.NDArray[np.bool_], random: np.random.Generator
) -> Array:
    """Simulate a new reading of a recorded position or angle, with errors like the recorded ones.

    For an encoder, the true path is quantised with its lines shifted by a random phase. For a
    position without quantisation, the sign of the recorded errors is random.
    """
    step = encoder_step(recorded[moving])
    if step > 0.0:
        phase = random.uniform(0.0, step)
        simulated = np.round((true - phase) / step) * step + phase
    else:
        simulated = true + (recorded - true) * random.choice([-1.0, 1.0], len(true))
    return np.asarray(np.where(moving, simulated, recorded), dtype=np.float64)


def with_error(value: ParameterValue, estimates: Array, page: Parameter) -> ParameterValue:
    """Return a parameter value with the standard error of its bootstrap estimates."""
    if value.stderr is None:
        return value
    deviations = estimates - value.value
    if page.period is not None:
        deviations -= page.period * np.round(deviations / page.period)
    # Central 68 %: estimates that ended on a distant maximum would dominate a standard deviation.
    low, high = np.quantile(deviations, [0.15866, 0.84134])
    # The error from the curvature is a lower bound (Cramer 1946, ch. 32). The scatter of a small
    # number of estimates may be below it by chance.
    error = max(float(0.5 * (high - low)), value.stderr)
    note = reason_not_identifiable(page, value.value, error)
    return replace(value, stderr=None if note else error, note=note, held=note is not None)


def simulated_runs(
    model: Model, runs: Sequence[Run], hidden: Sequence[str], draw: int
) -> list[Run]:
    """Simulate new recordings of runs with a fitted model, or with some of its effects only.

    The friction contains the effects `hidden` of the model. The number `draw` of the simulation is
    the seed. The simulated force has the common delay of the fitted one.
    """
    campaign = Campaign.prepare(model.rig, runs)
    problem = Problem(campaign, model.law, model.clock, model.effects)
    values = np.array([model.parameters[name].value for name in problem.names])
    samples = problem.samples_at(values)
    solution = problem.solution(values, samples, noise_at(problem, samples, values))
    if model.force_delay_s != 0.0:
        predictions = _delayed_predictions(problem, model)
        residuals = [p.friction - f for p, f in zip(campaign.prepared, predictions, strict=True)]
        solution = replace(solution, residuals=residuals)
    reduced = Problem(campaign, model.law, model.clock, hidden)
    friction = _delayed_predictions(reduced, model)
    random = np.random.default_rng([draw, len(hidden)])
    errors = _sign_randomised(solution, campaign, random)
    return [
        simulated_readings(p, f + e, random)
        for p, f, e in zip(campaign.prepared, friction, errors, strict=True)
    ]


def _sign_randomised(
    solution: Solution, campaign: Campaign, random: np.random.Generator
) -> list[Array]:
    """Simulated noise, N, one array per run: innovations with random signs by block."""
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
    noise = []
    for e, sign, counts, p in zip(
        innovations, np.split(signs, ends), plain.counted, campaign.prepared, strict=True
    ):
        # The innovation of an excluded sample is undefined. It is drawn at random from
        # those of the included samples.
        filled = np.where(counts, e, random.choice(counted, len(e)))
        noise.append(solution.noise.coloured(sign * filled, p.step_s))
    return noise
