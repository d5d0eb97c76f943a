"""Fit a law and named effects to runs, with exact derivatives from the core."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.estimation.jumps import at_work, without_jumps
from jbf.estimation.noise import WHITE, Noise, estimate_noise, innovation_cost
from jbf.estimation.peaks import other_peaks
from jbf.estimation.starts import with_starts
from jbf.models.catalogue import (
    Parameter,
    check_applies,
    find_effect,
    find_parameter,
    in_chain_order,
    parameters_of,
)
from jbf.models.chain import chain, check_rig
from jbf.models.model import Model
from jbf.models.parameter_value import ParameterValue
from jbf.models.requirements import require_record
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.threads import one_blas_thread

Array = npt.NDArray[np.float64]

MAX_EVALUATIONS = 60
BOUNDLESS = 1e100
"""A derivative beyond this has grown without bound."""
MOST_FORGIVEN = 2.0
"""A fit weighted by the colour of its noise may have so many times the plain fit's RMS."""
TRIAL_EVALUATIONS = 6
"""Steps given to each starting point before the best goes on alone."""
FOLLOWED = 2
"""How many of the starting points are given them."""


@dataclass(frozen=True)
class Solution:
    """Where a search ended: what the diagnosis works with.

    Attributes
    ----------
    values
        Parameter values, shape (k,).
    residuals
        Prediction minus record, N, one array a run.
    jacobian
        Derivative of the prediction with respect to each search variable, one (n, k) a run.
    cost
        `n log(mean square innovation)` over trusted samples.
    campaign
        The runs with the samples that it trusts: fewer than the problem's where an effect moves
        the instants of jumps.
    """

    effects: tuple[str, ...]
    values: Array
    residuals: list[Array]
    jacobian: list[Array]
    noise: Noise
    cost: float
    converged: bool
    message: str
    campaign: Campaign

    @property
    def free(self) -> int:
        """Number of parameters."""
        return len(self.values)


class Problem:
    """A campaign, a law and effects: predictions and derivatives in the search's variables.

    The search walks in the logarithm of parameters that are scales, so that a step is a
    proportion and no step can change a sign.
    """

    def __init__(
        self,
        campaign: Campaign,
        law: str,
        clock: str,
        effects: Sequence[str],
        fixed: Mapping[str, float] | None = None,
    ) -> None:
        self.campaign = campaign
        self.law, self.clock = law, clock
        self.effects = in_chain_order(effects)
        self.chain = chain(campaign.rig, law, clock, self.effects)
        self.parameters: dict[str, Parameter] = with_starts(
            parameters_of(law, self.effects), campaign
        )
        self.names = list(self.parameters)
        self.fixed = dict(fixed or {})
        self.open = [i for i, name in enumerate(self.names) if name not in self.fixed]
        pages = list(self.parameters.values())
        self.log = np.array([p.log for p in pages])
        self.lower = np.array([p.lower for p in pages])
        self.upper = np.array([p.upper for p in pages])

    def encode(self, values: Array) -> Array:
        """Parameter values to search variables."""
        inside = np.clip(values, self.lower, self.upper)
        with np.errstate(divide="ignore", invalid="ignore"):
            search: Array = np.where(self.log, np.log(inside), inside)[self.open]
        return search

    def decode(self, x: Array, base: Array) -> Array:
        """Search variables to parameter values; fixed ones from `base`."""
        values: Array = base.copy()
        log = self.log[self.open]
        there = x.copy()
        # The search may look far outside before it is called back.
        there[log] = np.exp(np.minimum(x[log], 700.0))
        # A logarithm and back may land a rounding error outside.
        values[self.open] = np.clip(there, self.lower[self.open], self.upper[self.open])
        return values

    def predict(self, values: Array) -> list[Array]:
        """Predictions, N, one array a run."""
        return self.chain.predict(values, self.campaign.motions)

    def residuals(self, values: Array) -> list[Array]:
        """Prediction minus record, N."""
        return [
            f - p.friction_n
            for f, p in zip(self.predict(values), self.campaign.prepared, strict=True)
        ]

    def square(self, values: Array) -> float:
        """Sum of squares of weighted residuals, N^2."""
        return sum(
            float(np.sum((r * p.weight) ** 2))
            for r, p in zip(self.residuals(values), self.campaign.prepared, strict=True)
        )

    def linearise(self, values: Array) -> tuple[list[Array], list[Array]]:
        """Residuals and their derivatives with respect to the search variables."""
        scale = np.where(self.log, values, 1.0)[self.open]
        rows = self.chain.jacobian(values, self.campaign.motions, self.open)
        residuals = [
            f - p.friction_n for (f, _), p in zip(rows, self.campaign.prepared, strict=True)
        ]
        return residuals, [_scaled(j, scale) for _, j in rows]

    def stacked(
        self,
        residuals: list[Array],
        jacobian: list[Array],
        noise: Noise,
        which: Sequence[int] | None = None,
    ) -> tuple[Array, Array]:
        """One residual vector and matrix of innovations over trusted samples (of some runs)."""
        r, j = [], []
        for i in range(len(residuals)) if which is None else which:
            res, jac, p = residuals[i], jacobian[i], self.campaign.prepared[i]
            # An untrusted sample is a gap: a zero there drives nothing.
            keep = p.weight > 0.0
            r.append(noise.innovations(res * p.weight, p.step_s)[keep])
            j.append(noise.innovations(jac * p.weight[:, None], p.step_s)[keep])
        return np.concatenate(r), np.concatenate(j)

    def innovation_cost(self, residuals: list[Array], noise: Noise) -> float:
        """`n log(mean square innovation)` of residuals over trusted samples."""
        prepared = self.campaign.prepared
        masked = [r * p.weight for r, p in zip(residuals, prepared, strict=True)]
        return innovation_cost(
            noise, masked, [p.step_s for p in prepared], [p.weight > 0.0 for p in prepared]
        )

    def estimate_noise(self, residuals: list[Array]) -> Noise:
        """The noise description that fits these residuals."""
        prepared = self.campaign.prepared
        masked = [r * p.trusted for r, p in zip(residuals, prepared, strict=True)]
        steps, trusted = [p.step_s for p in prepared], [p.trusted for p in prepared]
        return estimate_noise(masked, steps, trusted, self.campaign.most_noise_n)

    def search(self, start: Array, noise: Noise, evaluations: int) -> tuple[Array, bool, str]:
        """Least squares on innovations from one start."""
        memory: dict[bytes, tuple[Array, Array]] = {}

        def evaluate(x: Array) -> tuple[Array, Array]:
            key = x.tobytes()
            if key not in memory:
                memory.clear()
                memory[key] = self.stacked(*self.linearise(self.decode(x, start)), noise)
            return memory[key]

        def residual(x: Array) -> Array:
            return evaluate(x)[0]

        def slopes(x: Array) -> Array:
            return evaluate(x)[1]

        low, high = self.encode(self.lower), self.encode(self.upper)
        x0 = self.encode(start)
        margin = 1e-9 * np.maximum(np.abs(high - low), 1.0)
        margin = np.minimum(margin, 0.25 * (high - low))
        found = optimize.least_squares(
            residual,
            np.clip(x0, low + margin, high - margin),
            jac=slopes,
            bounds=(low, high),
            method="dogbox",
            x_scale="jac",
            # A hundredth of a unit of chi-square is far below what any verdict turns on.
            xtol=1e-7,
            ftol=1e-6,
            gtol=1e-12,
            max_nfev=evaluations,
        )
        return self.decode(found.x, start), bool(found.status > 0), str(found.message)

    def starts(self, seed: Mapping[str, float]) -> list[Array]:
        """Every combination of starting values for what `seed` lacks."""
        choices = [
            (seed[name],) if name in seed else page.starts for name, page in self.parameters.items()
        ]
        return [np.array(values, dtype=float) for values in itertools.product(*choices)]

    def approach(
        self,
        seeds: Sequence[Mapping[str, float]],
        evaluations: int,
        least: float = np.inf,
        *,
        each: bool = False,
    ) -> Solution:
        """Search from the best of all starting points, as if the noise were white.

        Parameters
        ----------
        seeds
            Known values by name; starting values fill each one up.
        evaluations
            Where to stop; enough to rank candidates, or to converge.
        least
            A sum of squares, N^2, that the first steps must come below: a search that leads nowhere
            is not followed.
        each
            Follow the best of each seed, not the best of all.
        """
        groups = [self.starts({**seed, **self.fixed}) for seed in seeds]
        if each:
            groups = [[min(group, key=self.square)] for group in groups]
        starts = sorted(itertools.chain.from_iterable(groups), key=self.square)
        best = starts[0]
        if len(starts) > 1:
            short = [self.search(s, WHITE, TRIAL_EVALUATIONS)[0] for s in starts[:FOLLOWED]]
            best = min(short, key=self.square)
        values, converged, message = best, False, "not followed"
        if len(starts) == 1 or self.square(best) < least:
            values, converged, message = self.search(best, WHITE, evaluations)
        sure = self.without_doubt(values)
        noise = sure.estimate_noise(sure.residuals(values))
        return sure.solution(self._wrapped(values), noise, converged, message)

    def without_doubt(self, values: Array) -> Problem:
        """The problem with the weights that the model at these values leaves to the samples."""
        effects = at_work(self.effects, self.parameters, values)
        sure = without_jumps(self.campaign, effects, self.predict(values))
        return self if sure is self.campaign else self.on(sure)

    def on(self, campaign: Campaign) -> Problem:
        """The same problem on other samples."""
        other = copy(self)
        other.campaign = campaign
        return other

    def settle(self, near: Solution) -> Solution:
        """Converge from a solution, with the colour of its noise."""
        values, noise = near.values, near.noise
        converged, message = near.converged, near.message
        doubted = near.campaign is not self.campaign
        if not near.converged:
            values, converged, message = self.search(values, WHITE, MAX_EVALUATIONS)
            noise = self.estimate_noise(self.residuals(values))
        if doubted:
            # With jumps at full weight the search found its way; with little it finds the place.
            sure = self.without_doubt(values)
            return sure.settle(sure.solution(values, noise, False, message))
        if noise.colour > 0.0:
            again = self.search(values, noise, MAX_EVALUATIONS)
            # A wrong law leaves a residual that no noise is. Taken for its colour, nearly all of
            # it is forgiven, and the parameters may go anywhere.
            if self.square(again[0]) <= MOST_FORGIVEN**2 * self.square(values):
                values, converged, message = again
                noise = self.estimate_noise(self.residuals(values))
        return self.solution(self._wrapped(values), noise, converged, message)

    def solve(self, seeds: Sequence[Mapping[str, float]]) -> Solution:
        """Approach, settle and look around."""
        return self.look_around(self.settle(self.approach(seeds, MAX_EVALUATIONS)))

    def look_around(self, near: Solution) -> Solution:
        """The highest peak near a solution, where an effect makes many."""
        for effect in self.effects:
            peak = find_effect(effect).peaks
            name = f"{effect}.{peak}"
            if peak is None or name in self.fixed:
                continue
            which = self.names.index(name)
            sure = self.on(near.campaign)
            starts = other_peaks(
                sure.square, near.values, which, self.lower[which], self.upper[which]
            )
            ends = [sure.search(s, near.noise, TRIAL_EVALUATIONS)[0] for s in starts]
            best = min(ends, key=sure.square, default=near.values)
            if sure.square(best) < sure.square(near.values):
                near = self.settle(sure.solution(best, near.noise, False))
        return near

    def solution(
        self, values: Array, noise: Noise, converged: bool = True, message: str = ""
    ) -> Solution:
        """The solution at given values."""
        residuals, jacobian = self.linearise(values)
        cost = self.innovation_cost(residuals, noise)
        return Solution(
            self.effects,
            values,
            residuals,
            jacobian,
            noise,
            cost,
            converged,
            message,
            self.campaign,
        )

    def _wrapped(self, values: Array) -> Array:
        """Angles brought back into (-period/2, period/2]."""
        values = values.copy()
        for i, page in enumerate(self.parameters.values()):
            if page.period is not None:
                values[i] -= page.period * np.round(values[i] / page.period)
        return values

    def errors(self, solution: Solution) -> tuple[list[ParameterValue], Array]:
        """Values with standard errors, and the correlations, shape (k, k).

        Where an error cannot be had, the note says why.
        """
        r, j = self.stacked(solution.residuals, solution.jacobian, solution.noise)
        free = j.shape[1]
        variance = float(r @ r) / max(len(r) - free, 1)
        size = np.linalg.norm(j, axis=0)
        felt = size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300)
        covariance = np.full((free, free), np.nan)
        if felt.any():
            unit = j[:, felt] / size[felt]
            inverse = np.linalg.pinv(unit.T @ unit, rcond=1e-13, hermitian=True)
            index = np.flatnonzero(felt)
            covariance[np.ix_(index, index)] = variance * inverse / np.outer(size[felt], size[felt])
            singular = np.linalg.cond(unit.T @ unit) > 1e12
        else:
            singular = True
        sd = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore", divide="ignore"):
            correlation = covariance / np.outer(sd, sd)
        pages = list(self.parameters.values())
        results = []
        for i, (value, page) in enumerate(zip(solution.values, pages, strict=True)):
            if i not in self.open:
                results.append(ParameterValue(float(value), None, "held fixed"))
                continue
            k = self.open.index(i)
            note = self._doubt(page, float(value), bool(felt[k]), bool(singular))
            error = None if note else float(sd[k] * (abs(value) if page.log else 1.0))
            results.append(ParameterValue(float(value), error, note))
        return results, correlation

    @staticmethod
    def _doubt(page: Parameter, value: float, felt: bool, singular: bool) -> str | None:
        """Why a standard error means nothing, if so."""
        if not felt:
            return "never moved: these runs do not depend on it"
        scale = np.log if page.log else float
        width = scale(page.upper) - scale(page.lower)
        for side, bound, wish in (("lower", page.lower, "less"), ("upper", page.upper, "more")):
            if abs(scale(value) - scale(bound)) < 1e-6 * width:
                return f"at its {side} bound {bound:g}: the runs ask for {wish}"
        if singular:
            return "not separately known: another parameter does the same in these runs"
        return None


def _scaled(jacobian: Array, scale: Array) -> Array:
    """Derivatives by the search's variables; none where a step too coarse for wild parameters let
    them grow without bound, so that the search turns back by its residuals."""
    with np.errstate(over="ignore", invalid="ignore"):
        found: Array = jacobian * scale
        if np.max(np.abs(found), initial=0.0) < BOUNDLESS:
            return found
    return np.where(np.abs(found) < BOUNDLESS, found, 0.0)


@dataclass(frozen=True)
class Fit:
    """A fitted model and what the fit says of itself.

    Attributes
    ----------
    model
        The fitted model.
    parameters
        Dotted name to value with standard error, or the reason why there is none.
    correlations
        Shape (k, k), in the order of the `parameters` that were not held fixed.
    rms_n
        Root mean square of the residual over trusted samples, N.
    residuals
        Prediction minus record, N, one array a run.
    doubtful
        Names of the parameters whose standard error is no error, because the likelihood is no
        parabola so far out: :func:`jbf.bootstrap` finds theirs.
    """

    model: Model
    parameters: dict[str, ParameterValue]
    correlations: Array
    rms_n: float
    noise: Noise
    samples: int
    residuals: list[Array]
    converged: bool
    message: str
    doubtful: tuple[str, ...] = ()

    def report(self) -> str:
        """Statistics, parameters with errors, and the strongest correlations, as text."""
        from jbf.reporting.text import fit_report

        return fit_report(self)


def check_effects(campaign: Campaign, effects: Iterable[str]) -> None:
    """An InputError where a run lacks a column that one of the effects needs."""
    effects = list(effects)
    for p in campaign.prepared:
        require_record(campaign.rig, p.run, effects)
    for name in effects:
        reason = campaign.lacking(find_effect(name))
        if reason is not None:
            raise InputError(
                problem=f"the effect {name} cannot be found in these runs: {reason}",
                mend="leave it out, or add runs under other loads",
            )


def root_mean_square(residuals: Sequence[Array], campaign: Campaign) -> float:
    """RMS over the trusted samples of a campaign, N."""
    total = sum(
        float(np.sum(r[p.trusted] ** 2)) for r, p in zip(residuals, campaign.prepared, strict=True)
    )
    return float(np.sqrt(total / max(campaign.samples, 1)))


def finish(problem: Problem, solution: Solution) -> Fit:
    """A solution with its errors, as a model."""
    problem = problem.on(solution.campaign)
    values, correlation = problem.errors(solution)
    named = dict(zip(problem.names, values, strict=True))
    campaign = problem.campaign
    rms = root_mean_square(solution.residuals, campaign)
    model = Model(
        campaign.rig,
        problem.law,
        problem.effects,
        named,
        problem.clock,
        {
            "runs": ", ".join(p.run.name for p in campaign.prepared),
            "samples": campaign.samples,
            "rms_n": rms,
        },
    )
    return Fit(
        model=model,
        parameters=named,
        correlations=correlation,
        rms_n=rms,
        noise=solution.noise,
        samples=campaign.samples,
        residuals=solution.residuals,
        converged=solution.converged,
        message=solution.message,
    )


@one_blas_thread
def fit(
    rig: Rig,
    runs: Sequence[Run],
    effects: Sequence[str] = (),
    *,
    law: str = "journal",
    clock: str = "journal",
    start: Mapping[str, float] | None = None,
    fixed: Mapping[str, float] | None = None,
) -> Fit:
    """Fit the base law, with named effects, to runs.

    Least squares over all samples at which the sign of the motion is known, with exact
    derivatives, bounds from the catalogue, starting values from the catalogue or, for a law in
    newtons, from the data; weighted by the colour of the
    noise where the residual shows one.

    Parameters
    ----------
    rig
        Bearing, lubricant and load; `Rig()` will do for a law in newtons.
    runs
        Recorded runs with friction.
    effects
        Names of effects to fit beside the law.
    law, clock
        Base law and its clock.
    start, fixed
        Values by parameter name to start from, or to hold.

    Raises
    ------
    InputError
        An unknown name, a missing column, or runs in which nothing moves.
    """
    chosen = in_chain_order(effects)
    check_rig(rig, law)
    check_applies(law, chosen)
    campaign = Campaign.prepare(rig, runs)
    check_effects(campaign, chosen)
    known = parameters_of(law, chosen)
    held = named_values(fixed, known)
    problem = Problem(campaign, law, clock, chosen, held)
    solution = problem.solve([named_values(start, known)])
    fitted = finish(problem, solution)
    from jbf.estimation.curvature import doubtful  # which knows problems and solutions

    errors = [p.stderr for p in fitted.parameters.values()]
    sure = problem.on(solution.campaign)
    return replace(fitted, doubtful=doubtful(sure, solution, errors, fitted.correlations))


def named_values(
    values: Mapping[str, float] | None, known: Mapping[str, Parameter]
) -> dict[str, float]:
    """Full names and checked bounds."""
    found = {}
    for name, value in (values or {}).items():
        full = find_parameter(name, known)
        page = known[full]
        if not (page.lower <= value <= page.upper or value == page.null):
            raise InputError(
                problem=f"{full} = {value} is out of range",
                mend=f"choose from {page.lower:g} to {page.upper:g}",
            )
        found[full] = float(value)
    return found
