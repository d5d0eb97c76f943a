"""Fit of a law and named effects to runs, with exact derivatives from the compiled core."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError, Stopped, Unfinished
from jbf.estimation.bounds import bounded_pages, checked_bounds
from jbf.estimation.campaign import Campaign
from jbf.estimation.delay_scan import exact_delay
from jbf.estimation.estimates import Estimates
from jbf.estimation.generalised_least_squares import stages_of_fit
from jbf.estimation.identifiability import correlations, parameter_values, reset_unidentified
from jbf.estimation.likelihood import log_likelihood
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.posterior_motions import delay_of_further_runs_s
from jbf.estimation.problem import Problem, named_values
from jbf.estimation.solution import Solution
from jbf.estimation.standard_errors import doubtful_errors, standard_errors
from jbf.estimation.transients import check_film_rate
from jbf.estimation.work import TimeLimit
from jbf.models.catalogue import (
    check_applies,
    find_effect,
    in_chain_order,
    parameters_of,
)
from jbf.models.chain import check_rig, default_law
from jbf.models.delayed_reading import TAU
from jbf.models.model import Model
from jbf.models.parameter_value import ParameterValue
from jbf.models.requirements import require_record
from jbf.models.vocabulary import Clock
from jbf.records.arguments import one_of
from jbf.records.findings.finding import Finding
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.records.weight_angle import weight_acts_over
from jbf.threads import one_blas_thread

CovType = Literal["model", "bootstrap"]
"""Method for the standard errors."""


@dataclass(frozen=True, repr=False)
class Fit(Estimates):
    """A fitted model with its statistics.

    Attributes
    ----------
    model
        The fitted model.
    parameters
        Dotted name to value with standard error. A parameter that is not identifiable is held
        fixed, and its note states the reason. `params` and `stderr` are its values and errors by
        name.
    correlations
        Correlations of the estimates, shape (k, k), in the order of `var_names`.
    rms
        Root mean square of the residual over the included samples, N.
    noise
        The estimated noise model: white noise with a first-order coloured part.
    innovation_rms
        Root mean square of the whitened residuals of each run, N. If the errors of the motion are
        estimated, it is that of the noise of the force.
    nobs
        Number n of included samples: those in motion with a known sign.
    residuals
        Record minus prediction, N, one array per run.
    loglik
        Log-likelihood at the estimates.
    converged, message
        Convergence flag and message of the search.
    doubtful
        Names of the parameters whose standard error is not valid, because the log likelihood is not
        quadratic up to one standard error. :func:`jbf.bootstrap` computes their errors.
    fixed
        Names of the parameters that were not fitted.
    findings
        Recording artefacts of the runs, and how they were treated.
    noise_floor
        Standard deviation of the noise on the record, estimated from the record only, N; None if it
        cannot be estimated.
    bounds
        Bounds that were given to the fit, by parameter name.
    cov_type
        Method of the standard errors: "model" or "bootstrap".

    Notes
    -----
    `loglik` is the Gaussian log-likelihood of the residuals whitened by the estimated noise model,
    with their variance at its maximum-likelihood value s^2: ``-2 loglik = n (log(2 pi s^2) + 1) +
    log det C``, where s^2 C is the covariance of the noise. The number of parameters k is that of
    the estimated ones (`var_names`), without parameters held fixed and those of the noise. ``aic =
    2 k - 2 loglik`` (Akaike 1974) and ``bic = k log(n) - 2 loglik`` (Schwarz 1978) compare fits to
    the same samples. Robust weights are treated as known.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 10.0, 0.02)
    >>> v = 0.1 * np.sin(2.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> fit = jbf.fit(jbf.Rig(), [run], law="coulomb", fixed={"F_s": 5.0})
    >>> fit.var_names
    ('F_c', 'F_v')
    >>> low, high = fit.conf_int()["F_c"]
    >>> low < 5.0 < high
    True
    >>> fit.covariance.shape
    (2, 2)
    """

    model: Model
    parameters: dict[str, ParameterValue]
    correlations: Array
    rms: float
    noise: Noise
    nobs: int
    residuals: list[Array]
    converged: bool
    message: str
    doubtful: tuple[str, ...] = ()
    fixed: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    noise_floor: float | None = None
    loglik: float = math.nan
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    innovation_rms: Sequence[float] = ()
    cov_type: CovType = "model"

    def __post_init__(self) -> None:
        count = len(self.var_names)
        if self.correlations.shape != (count, count):
            shape = self.correlations.shape
            raise ValueError(f"correlations of shape {shape} for {count} parameters not held")

    @property
    def covariance(self) -> Array:
        """Covariance matrix of the estimates, shape (k, k), in the order of `var_names`."""
        errors = np.array([self.stderr[name] for name in self.var_names])
        return self.correlations * np.outer(errors, errors)

    @property
    def aic(self) -> float:
        """Akaike's information criterion."""
        return 2.0 * len(self.var_names) - 2.0 * self.loglik

    @property
    def bic(self) -> float:
        """Bayesian information criterion."""
        return len(self.var_names) * math.log(self.nobs) - 2.0 * self.loglik

    def predict(self, run: Run) -> Array:
        """Predict the friction reading for the motion of a run, N, shape (n,).

        Raises
        ------
        InputError
            The run lacks a column that the model needs.
        """
        return self.model.predict(run)

    def report(self) -> str:
        """Return statistics, parameters with errors and the strongest correlations as text."""
        return self.summary()

    def _facts(self) -> Mapping[str, Any]:
        """Entries of `to_dict` in addition to the parameters."""
        return {
            "law": self.model.law,
            "effects": list(self.model.effects),
            "rms": self.rms,
            "noise_floor": self.noise_floor,
            "samples": self.nobs,
            "converged": self.converged,
            "message": self.message,
            "doubtful": list(self.doubtful),
            "findings": [f.to_dict() for f in self.findings],
        }


def check_effects(campaign: Campaign, effects: Iterable[str]) -> None:
    """Raise an InputError if the runs lack a column or condition that one of the effects needs."""
    effects = list(effects)
    for p in campaign.prepared:
        require_record(campaign.rig, p.run, effects)
    for name in effects:
        reason = campaign.missing_requirement(find_effect(name))
        if reason is not None:
            raise InputError(
                problem=f"the effect {name} is not identifiable in these runs: {reason}",
                remedy="omit it, or record the missing motion or data",
            )


def finish(problem: Problem, solution: Solution, start: Mapping[str, float] | None = None) -> Fit:
    """Create the fit with standard errors from a solution; `start` has the user's values."""
    errors = standard_errors(problem, solution)
    reset = reset_unidentified(problem, solution, errors, start or {})
    delay = exact_delay(problem, solution, errors, reset.values)
    if delay is not None:
        reset = replace(reset, values=delay.values, residuals=delay.residuals)
    named = parameter_values(problem, reset, errors)
    if delay is not None and not named[TAU].held:
        named[TAU] = replace(named[TAU], stderr=delay.sd_s)
    campaign, samples = problem.campaign, solution.samples.count
    rms = solution.samples.rms(reset.residuals)
    facts: dict[str, float | int | str] = {
        "runs": ", ".join(p.run.name for p in campaign.prepared),
        "samples": samples,
        "rms": rms,
    }
    if campaign.travel is not None:
        facts["travel"] = campaign.travel
    delay_s = delay_of_further_runs_s(campaign)
    if delay_s != 0.0:
        facts["force_delay_s"] = delay_s
    if "gravity" in problem.effects:
        facts["weight_acts_over"] = weight_acts_over(campaign.prepared[0].run)
    model = Model(
        campaign.rig,
        problem.law,
        problem.effects,
        named,
        problem.clock,
        facts,
    )
    return Fit(
        model=model,
        parameters=named,
        correlations=correlations(problem, named, errors),
        rms=rms,
        noise=solution.noise,
        nobs=samples,
        residuals=list(reset.residuals),
        converged=solution.converged,
        message=solution.message,
        fixed=tuple(name for name in problem.names if name in problem.fixed),
        findings=campaign.findings,
        noise_floor=noise_floor(campaign.prepared, solution.samples) or None,
        loglik=log_likelihood(replace(solution, values=reset.values, residuals=reset.residuals)),
        bounds=problem.bounds,
        innovation_rms=solution.innovation_rms(reset.residuals),
    )


@one_blas_thread
def fit(
    rig: Rig,
    runs: Sequence[Run],
    effects: Sequence[str] = (),
    *,
    law: str | None = None,
    clock: Clock = "journal",
    start: Mapping[str, float] | None = None,
    fixed: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    cov_type: CovType = "model",
    time_limit_s: float | TimeLimit | None = None,
) -> Fit:
    """Fit a base law, with named effects, to recorded runs by least squares.

    The squares are summed over all samples at which the sign of the motion is known, except those
    at the start of a run that depend on an unrecorded state of a contact, if these are few. The
    derivatives are exact.

    Parameters
    ----------
    rig
        Bearing, lubricant and load; `Rig()` is sufficient for a law in newtons.
    runs
        Recorded runs with friction.
    effects
        Names of effects to fit in addition to the law.
    law, clock
        Base law, and the definition of the time constant of its film (`journal` or `thesis`). The
        default law is `journal` for a bearing, otherwise `coulomb`.
    start, fixed
        Starting values, and values of parameters held fixed, by parameter name. Other starting
        values are those of the catalogue or, for a law in newtons, estimates from the data.
    bounds
        Pairs (low, high) by parameter name, within the bounds of the catalogue. A parameter that
        ends at a bound has no standard error.
    cov_type
        "model": standard errors from the curvature of the likelihood, increased by the long-run
        variance of the score where the noise model does not describe the residual. "bootstrap":
        from 40 fits of simulated records (:func:`jbf.bootstrap`), which take 40 times as long.
    time_limit_s
        Duration after which the fit is aborted, s; None for no limit.

    Returns
    -------
    Fit
        The estimates with their statistics.

    Raises
    ------
    InputError
        An unknown name, an empty interval of bounds, a missing column, runs without motion, or a
        film too fast for the runs.
    Stopped
        The fit was interrupted; the exception holds the best fit so far.
    Unfinished
        The fit exceeded its budget or the time limit; the exception holds the best fit so far.

    Notes
    -----
    The estimates minimise ``sum(e(y - f(p))^2)`` over the whitened residuals e. The noise is white
    plus a first-order coloured part if the residual is autocorrelated and the estimates hardly
    differ from those of ordinary least squares (`Fit.noise`). Huber's weights (Huber 1964) or those
    of Student's t (Lange et al. 1989) are used if they reduce the held-out error. The standard
    errors are those of Newey & West (1987) if the whitened residuals are correlated.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 10.0, 0.02)
    >>> v = 0.1 * np.sin(2.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> fit = jbf.fit(jbf.Rig(), [run], law="coulomb", bounds={"F_c": (1.0, 10.0)})
    >>> round(fit.params["F_c"], 1)
    5.0
    """
    law = default_law(rig) if law is None else law
    one_of(cov_type, get_args(CovType), "cov_type")
    limit = TimeLimit.of(time_limit_s)
    chosen = in_chain_order(effects)
    check_rig(rig, law)
    check_applies(law, chosen)
    campaign = Campaign.prepare(rig, runs, time_limit=limit)
    check_effects(campaign, chosen)
    pages = parameters_of(law, chosen)
    limits = checked_bounds(bounds, pages)
    pages = bounded_pages(pages, limits)
    problem = Problem(campaign, law, clock, chosen, named_values(fixed, pages), limits)
    given = named_values(start, pages)
    check_film_rate(campaign, law, clock, {**given, **problem.fixed})
    try:
        for stage in stages_of_fit(problem, given):
            problem, solution = stage
    except (KeyboardInterrupt, Unfinished) as stop:
        campaign.work.lift()
        values = problem.best.values
        if values is None:
            raise
        samples = problem.samples_at(values)
        near = problem.solution(problem.wrapped(values), samples, WHITE, False, "interrupted")
        best = finish(problem, near, given)
        if isinstance(stop, Unfinished):
            raise stop.with_fit(best, campaign.named) from None
        raise Stopped(best) from None
    with campaign.work.untimed():
        fitted = finish(problem, solution, given)
    try:
        doubtful = doubtful_errors(problem, solution, fitted.parameters)
    except Unfinished as stop:
        raise stop.with_fit(fitted, campaign.named) from None
    fitted = replace(fitted, doubtful=doubtful)
    if cov_type == "model":
        return fitted
    from jbf.estimation.bootstrap import bootstrap  # which imports this module

    return bootstrap(fitted, runs, start=start, time_limit_s=limit).fit
