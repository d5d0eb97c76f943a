"""Fitting problem of a law with effects: predictions and Jacobian in the search variables.

The search variable of a scale parameter is its logarithm, so that the parameter remains positive
and a step changes it by a factor.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from copy import copy
from functools import cached_property

import numpy as np

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.estimation.bounds import Bounds, bounded_pages
from jbf.estimation.campaign import Campaign
from jbf.estimation.least_squares import MOST_HELD, OnDemand, memory_groups, select_runs, triangular
from jbf.estimation.noise import Noise
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Lines, Solution
from jbf.estimation.starting_values import with_starts
from jbf.estimation.uncertain_samples import (
    active_effects,
    has_unknown_start,
    initial_memories,
    moves_jumps,
    samples_near_jumps,
    spreads_jumps,
    time_constant,
    transient_masks,
)
from jbf.models.catalogue import (
    Parameter,
    find_law,
    find_parameter,
    in_chain_order,
    parameters_of,
)
from jbf.models.chain import chain
from jbf.models.vocabulary import Clock
from jbf.records.arguments import by_name
from jbf.records.toml_file import number

SLOPES_COST = 2.0
"""Computing cost of a prediction with derivatives, relative to one without derivatives."""
BOUNDLESS = 1e50
"""Derivatives above this are treated as diverged, since a search squares them."""


class Best:
    """Parameter values with the smallest sum of squares so far, if a search is stopped."""

    def __init__(self) -> None:
        self.values: Array | None = None
        self.square = np.inf

    def update(self, values: Array, square: float) -> None:
        """Store values if their sum of squares is the smallest so far."""
        if square < self.square:
            self.values, self.square = values, square


class Problem:
    """Fitting problem for a campaign: the parameters of a law and its effects, some held fixed."""

    def __init__(
        self,
        campaign: Campaign,
        law: str,
        clock: Clock,
        effects: Sequence[str],
        fixed: Mapping[str, float] | None = None,
        bounds: Bounds | None = None,
    ) -> None:
        self.campaign = campaign
        self.best = Best()
        self.law, self.clock = law, clock
        self.effects = in_chain_order(effects)
        self.chain = chain(campaign.rig, law, clock, self.effects)
        pages = with_starts(
            parameters_of(law, self.effects), campaign, not find_law(law).needs_bearing
        )
        self.bounds: Bounds = {n: pair for n, pair in (bounds or {}).items() if n in pages}
        self.parameters = bounded_pages(pages, self.bounds)
        self.names = list(self.parameters)
        stated = {name: page.starts[0] for name, page in self.parameters.items() if page.stated}
        self.fixed = stated | dict(fixed or {})
        self.open = [i for i, name in enumerate(self.names) if name not in self.fixed]
        self.log = np.array([p.log for p in self.parameters.values()])
        self.lower = np.array([p.lower for p in self.parameters.values()])
        self.upper = np.array([p.upper for p in self.parameters.values()])

    # ---- search variables -------------------------------------------------------------------

    def encode(self, values: Array) -> Array:
        """Convert parameter values to search variables."""
        inside = np.clip(values, self.lower, self.upper)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.where(self.log, np.log(inside), inside)[self.open])

    def decode(self, x: Array, base: Array) -> Array:
        """Convert search variables to parameter values; fixed parameters are taken from `base`."""
        values: Array = base.copy()
        log = self.log[self.open]
        decoded = x.copy()
        # The search may evaluate far outside the bounds before it is limited.
        decoded[log] = np.exp(np.minimum(x[log], 700.0))
        # Rounding errors of a logarithm and its inverse may exceed the bounds.
        values[self.open] = np.clip(decoded, self.lower[self.open], self.upper[self.open])
        return values

    def wrapped(self, values: Array) -> Array:
        """Return parameter values with angles wrapped into the interval (-period/2, period/2]."""
        values = values.copy()
        for i, page in enumerate(self.parameters.values()):
            if page.period is not None:
                values[i] -= page.period * np.round(values[i] / page.period)
        return values

    def values_by_name(self, values: Array) -> dict[str, float]:
        """Return parameter values by name."""
        return dict(zip(self.names, values.tolist(), strict=True))

    def starts(self, seed: Mapping[str, float]) -> list[Array]:
        """All combinations of starting values of the parameters for which `seed` has no value."""
        choices = [
            (seed[name],) if name in seed else page.starts for name, page in self.parameters.items()
        ]
        return [np.array(values, dtype=float) for values in itertools.product(*choices)]

    # ---- predictions ------------------------------------------------------------------------

    def predict(self, values: Array, selection: Sequence[int] | None = None) -> list[Array]:
        """Predicted friction, N, one array per run; `selection` has the indices of the runs."""
        motions = [p.core for p in self._runs(selection)]
        self.campaign.work.take(self.chain.inner_steps(values, motions))
        return self.chain.predict(values, motions)

    def residuals(self, values: Array, selection: Sequence[int] | None = None) -> list[Array]:
        """Record minus prediction, N, one array per run; `selection` has indices of runs."""
        runs = self._runs(selection)
        return [p.friction - f for f, p in zip(self.predict(values, selection), runs, strict=True)]

    def linearise(
        self,
        values: Array,
        selection: Sequence[int] | None = None,
        by: Sequence[int] | None = None,
    ) -> Lines:
        """Residuals, N, and Jacobian of the prediction in the search variables, one array per run.

        `selection` has the indices of the runs, and `by` those of the parameters.
        """
        runs, by = self._runs(selection), self.open if by is None else by
        scale = np.where(self.log, values, 1.0)[by]
        motions = [p.core for p in runs]
        self.campaign.work.take(SLOPES_COST * self.chain.inner_steps(values, motions))
        rows = self.chain.jacobian(values, motions, by)
        residuals = [p.friction - f for (f, _), p in zip(rows, runs, strict=True)]
        return residuals, [bounded(j, scale) for _, j in rows]

    def gauss_newton_rows(
        self, values: Array, samples: Samples, noise: Noise
    ) -> tuple[Array, Array, int]:
        """Innovations and their Jacobian in triangular form, and the number of innovations.

        The triangular form (`triangular`) has fewer rows and the same inner products.
        """
        r, j, count = [], [], 0
        lengths = [len(p.friction) for p in self.campaign.prepared]
        for group in memory_groups(lengths, len(self.open)):
            part = samples if len(group) == len(lengths) else samples.only(group)
            innovations, slopes = part.stacked(*self.linearise(values, group), noise)
            reduced_r, reduced_j = triangular(innovations, slopes)
            r.append(reduced_r)
            j.append(reduced_j)
            count += len(innovations)
        return np.concatenate(r), np.concatenate(j), count

    @property
    def fits_in_memory(self) -> bool:
        """Whether the Jacobian at all samples fits into the memory limit."""
        samples = sum(len(p.friction) for p in self.campaign.prepared)
        return samples * len(self.open) <= MOST_HELD

    @cached_property
    def searched(self) -> list[int]:
        """Indices of the runs that a search uses (`select_runs`)."""
        runs = self.campaign.prepared
        return select_runs([len(p.friction) for p in runs], [p.run.name for p in runs])

    @cached_property
    def thinned(self) -> Problem:
        """Problem restricted to the runs in `searched`."""
        selection = self.searched
        if len(selection) == len(self.campaign.prepared):
            return self
        return self.with_campaign(self.campaign.only(selection))

    @property
    def score_test_problem(self) -> Problem:
        """Problem whose samples score tests use: this one, or `thinned` if memory is limited."""
        return self if self.fits_in_memory else self.thinned

    def with_campaign(self, campaign: Campaign) -> Problem:
        """Return the problem for another campaign, with the same bounds and starting values."""
        problem = copy(self)
        problem.campaign = campaign
        for cached in ("searched", "thinned"):
            vars(problem).pop(cached, None)
        return problem

    def restricted(self, campaign: Campaign, fixed: Mapping[str, float]) -> Problem:
        """Return the problem for another campaign, with further parameters fixed.

        Bounds and starting values are those of this problem. The values in `fixed` must be those of
        the starting point of a search.
        """
        problem = self.with_campaign(campaign)
        problem.best, problem.fixed = Best(), {**self.fixed, **fixed}
        problem.open = [i for i, name in enumerate(self.names) if name not in problem.fixed]
        return problem

    def _runs(self, selection: Sequence[int] | None) -> Sequence[Prepared]:
        """Prepared runs with the indices in `selection`; all if it is None."""
        runs = self.campaign.prepared
        return runs if selection is None else [runs[i] for i in selection]

    def square(self, values: Array, samples: Samples | None = None) -> float:
        """Sum of squares of weighted residuals, N^2; over the campaign's samples by default."""
        samples = self.campaign.samples if samples is None else samples
        return samples.square(self.residuals(values))

    def samples_at(self, values: Array, residuals: Sequence[Array] | None = None) -> Samples:
        """Samples with the weights that the model implies at these parameter values.

        `residuals` are those at these values, N, if they are known.
        """
        samples = self.campaign.samples
        effects = active_effects(self.effects, self.parameters, values)
        unknown_start = has_unknown_start(effects)
        if not (moves_jumps(effects) or spreads_jumps(effects) or unknown_start):
            return samples
        prepared = self.campaign.prepared
        residuals = self.residuals(values) if residuals is None else residuals
        predicted = [p.friction - r for p, r in zip(prepared, residuals, strict=True)]
        if unknown_start:
            transients = self.transient_samples(values, samples.rms(residuals))
            samples = samples.within([~mask for mask in transients])
        spread_s = time_constant(effects, self.parameters, values)
        return samples_near_jumps(samples, prepared, predicted, effects, spread_s)

    def transient_samples(self, values: Array, noise_rms: float) -> list[Mask]:
        """Mask of the samples that depend on the initial state of their run, one mask per run.

        The parameter values are those of an approximate fit; `noise_rms` is the noise on the
        friction, N.
        """
        prepared, settings = self.campaign.prepared, self.campaign.settings.transient
        masks = [np.zeros(len(p.run), dtype=bool) for p in prepared]
        for memory in initial_memories(self.law, self.effects, settings):
            found = transient_masks(self.chain, values, prepared, memory, noise_rms, settings)
            masks = [mask | more for mask, more in zip(masks, found, strict=True)]
        return masks

    def solution(
        self,
        values: Array,
        samples: Samples,
        noise: Noise,
        converged: bool = True,
        message: str = "",
        lines: Lines | None = None,
    ) -> Solution:
        """Compute the solution object for given parameter values and samples.

        It is computed from `lines`, the result of :meth:`linearise`, if it is given.
        """
        residuals: Sequence[Array]
        jacobian: Sequence[Array]
        count = len(self.campaign.prepared)
        if lines is not None:
            residuals, jacobian = lines
        elif self.fits_in_memory:
            residuals, jacobian = self.linearise(values)
        else:
            residuals = OnDemand(lambda i: self.residuals(values, [i])[0], count)
            jacobian = OnDemand(lambda i: self.linearise(values, [i])[1][0], count)
        return Solution(
            self.effects, values, residuals, jacobian, noise, converged, message, samples
        )


def bounded(jacobian: Array, scale: Array) -> Array:
    """Scale a Jacobian to the search variables, and set columns that have diverged to zero.

    Derivatives may diverge if the integration step is too coarse for extreme parameters. The search
    rejects such parameters because of their large residuals.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        derivatives: Array = jacobian * scale
        largest = max(np.max(derivatives, initial=0.0), -np.min(derivatives, initial=0.0))
        if largest < BOUNDLESS:
            return derivatives
    return np.where(np.abs(derivatives) < BOUNDLESS, derivatives, 0.0)


def named_values(
    values: Mapping[str, float] | None, pages: Mapping[str, Parameter]
) -> dict[str, float]:
    """Resolve parameter names to full names and check the values against their bounds."""
    named = {}
    given = {} if values is None else by_name(values, "parameters")
    for name, anything in given.items():
        full = find_parameter(name, pages)
        page, value = pages[full], number(anything, full)
        if not (page.lower <= value <= page.upper or value == page.null):
            raise InputError(
                problem=f"{full} = {value} is out of range",
                remedy=f"choose from {page.lower:g} to {page.upper:g}",
            )
        named[full] = value
    return named
