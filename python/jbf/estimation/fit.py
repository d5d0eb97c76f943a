"""Fit of a law and named effects to runs, with exact derivatives from the compiled core."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError, Stopped, Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.curvature import doubtful_errors
from jbf.estimation.estimates import Estimates
from jbf.estimation.exact_delay import exact_delay
from jbf.estimation.film_rate import check_film
from jbf.estimation.minimum import minimum, not_above_nested
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.noise_floor import noise_floor
from jbf.estimation.problem import Problem, named_values
from jbf.estimation.put_back import put_back
from jbf.estimation.refine import with_motion_errors
from jbf.estimation.solution import Solution
from jbf.estimation.spread import spread
from jbf.estimation.uncertainty import correlations, parameter_values
from jbf.estimation.weighting import best_weighting
from jbf.models.catalogue import check_applies, find_effect, in_chain_order, parameters_of
from jbf.models.chain import check_rig
from jbf.models.late_reading import TAU
from jbf.models.model import Model
from jbf.models.parameter_value import ParameterValue
from jbf.models.requirements import require_record
from jbf.models.vocabulary import Clock
from jbf.records.findings.finding import Finding
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.threads import one_blas_thread

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Fit(Estimates):
    """A fitted model with its statistics.

    Attributes
    ----------
    model
        The fitted model.
    parameters
        Dotted name to value with standard error. A parameter that is not identifiable is held, and
        its note states the reason.
    correlations
        Shape (k, k), in the order of the `parameters` that are not held.
    rms
        Root mean square of the residual over the samples that count, N.
    residuals
        Record minus prediction, N, one array a run.
    doubtful
        Names of the parameters whose standard error is not valid, because the likelihood is not a
        parabola at one standard error. :func:`jbf.bootstrap` computes their errors.
    fixed
        Names of the parameters that were not fitted.
    findings
        Recording artefacts of the runs, and how they were treated.
    noise_floor
        Standard deviation of the noise on the record, estimated from the record only, N; None if it
        cannot be estimated.
    """

    model: Model
    parameters: dict[str, ParameterValue]
    correlations: Array
    rms: float
    noise: Noise
    samples: int
    residuals: list[Array]
    converged: bool
    message: str
    doubtful: tuple[str, ...] = ()
    fixed: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    noise_floor: float | None = None

    def __post_init__(self) -> None:
        told = sum(not p.held for p in self.parameters.values())
        if self.correlations.shape != (told, told):
            shape = self.correlations.shape
            raise ValueError(f"correlations of shape {shape} for {told} parameters not held")

    def report(self) -> str:
        """Return `summary`: statistics, parameters with errors, and the strongest correlations."""
        return self.summary()

    def facts(self) -> Mapping[str, Any]:
        """Entries of `to_dict` in addition to the parameters."""
        return {
            "law": self.model.law,
            "effects": list(self.model.effects),
            "rms": self.rms,
            "noise_floor": self.noise_floor,
            "samples": self.samples,
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
                problem=f"the effect {name} cannot be found in these runs: {reason}",
                mend="leave it out, or add runs under other loads",
            )


def finish(problem: Problem, solution: Solution, start: Mapping[str, float] | None = None) -> Fit:
    """Return a solution with standard errors as a fit; `start` holds the user's starting values."""
    known = spread(problem, solution)
    found = put_back(problem, solution, known, start or {})
    delay = exact_delay(problem, solution, known, found.values)
    if delay is not None:
        found = replace(found, values=delay.values, residuals=delay.residuals)
    named = parameter_values(problem, found, known)
    if delay is not None and not named[TAU].held:
        named[TAU] = replace(named[TAU], stderr=delay.sd_s)
    campaign, samples = problem.campaign, solution.samples.count
    rms = solution.samples.rms(found.residuals)
    model = Model(
        campaign.rig,
        problem.law,
        problem.effects,
        named,
        problem.clock,
        {
            "runs": ", ".join(p.run.name for p in campaign.prepared),
            "samples": samples,
            "rms": rms,
        },
    )
    return Fit(
        model=model,
        parameters=named,
        correlations=correlations(problem, named, known),
        rms=rms,
        noise=solution.noise,
        samples=samples,
        residuals=list(found.residuals),
        converged=solution.converged,
        message=solution.message,
        fixed=tuple(name for name in problem.names if name in problem.fixed),
        findings=campaign.findings,
        noise_floor=noise_floor(campaign.prepared, solution.samples) or None,
    )


@one_blas_thread
def fit(
    rig: Rig,
    runs: Sequence[Run],
    effects: Sequence[str] = (),
    *,
    law: str = "journal",
    clock: Clock = "journal",
    start: Mapping[str, float] | None = None,
    fixed: Mapping[str, float] | None = None,
) -> Fit:
    """Fit the base law, with named effects, to runs.

    Least squares over all samples at which the sign of the motion is known, with exact derivatives.
    Bounds are taken from the catalogue; starting values from the catalogue or, for a law in
    newtons, from the data. Residuals are weighted by the coloured-noise model where the residual
    shows colour and plain least squares agrees. Huber's weights are used where they have the
    smaller held-out error.

    Parameters
    ----------
    rig
        Bearing, lubricant and load; `Rig()` is sufficient for a law in newtons.
    runs
        Recorded runs with friction.
    effects
        Names of effects to fit in addition to the law.
    law, clock
        Base law and its clock.
    start, fixed
        Values by parameter name to start from, or to hold.

    Raises
    ------
    InputError
        An unknown name, a missing column, runs without motion, or a film too fast for the runs.
    Stopped
        The fit was interrupted; the exception holds the best fit so far.
    Unfinished
        The fit exceeded its budget; the exception holds the best fit so far.
    """
    chosen = in_chain_order(effects)
    check_rig(rig, law)
    check_applies(law, chosen)
    campaign = Campaign.prepare(rig, runs)
    check_effects(campaign, chosen)
    known = parameters_of(law, chosen)
    problem = Problem(campaign, law, clock, chosen, named_values(fixed, known))
    given = named_values(start, known)
    check_film(campaign, law, clock, {**given, **problem.fixed})
    try:
        solution = not_above_nested(problem, minimum(problem, [given]))
        problem, solution = with_motion_errors(problem, solution)
        solution = best_weighting(problem, solution)
    except (KeyboardInterrupt, Unfinished) as stop:
        campaign.work.renew(math.inf)
        values = problem.best.values
        if values is None:
            raise
        samples = problem.samples_at(values)
        near = problem.solution(problem.wrapped(values), samples, WHITE, False, "interrupted")
        best = finish(problem, near, given)
        if isinstance(stop, Unfinished):
            raise Unfinished(steps=stop.steps, fit=best, file=campaign.named) from None
        raise Stopped(best) from None
    fitted = finish(problem, solution, given)
    return replace(fitted, doubtful=doubtful_errors(problem, solution, fitted.parameters))
