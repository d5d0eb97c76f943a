"""Change of the predicted friction by an effect, as a function of the effect's strength.

The unexplained part of a change is the part that the parameters of the model without the effect
cannot reproduce, in units of the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array, Names
from jbf.diagnosis.candidates import Candidates
from jbf.estimation.likelihood import effective_share
from jbf.estimation.noise import estimate_noise
from jbf.estimation.problem import Problem
from jbf.estimation.samples import common_samples
from jbf.estimation.variance import significant_inflation
from jbf.models.catalogue import Parameter

STRENGTH_RATIO = 2.0 ** (1.0 / 3.0)
"""Ratio of the strengths at which changes of the friction are computed.

Between them a change is taken as proportional to the strength; where it is not, its error is that
of a change of the strength by at most 12 %. It is a numerical resolution and enters no verdict.
"""
CACHED_SAMPLES = 100_000
"""Number of samples, over all strengths of an effect, whose changes are kept for further use.

At least one change is kept. It limits the memory only.
"""
DRAWS = 12
"""Number of white-noise draws from which the discount factors of a gain are computed."""


@dataclass(frozen=True)
class Strength:
    """A model with one additional effect, parametrised by the strength; 1 is the typical strength.

    Attributes
    ----------
    name
        Name of the effect.
    problem
        The model with the effect.
    usual
        Parameter values at the typical strength of the catalogue.
    which, page
        Index and description of the parameter that represents the strength.
    sizes
        Indices of this parameter and of all others of the effect that have a null.
    """

    name: str
    problem: Problem
    usual: Array
    which: int
    page: Parameter
    sizes: tuple[int, ...]

    def values(self, times: float) -> Array:
        """Parameter values at `times` the typical strength, clipped to their bounds."""
        values, pages = self.usual.copy(), list(self.problem.parameters.values())
        for i in self.sizes:
            null, page = pages[i].null, pages[i]
            assert null is not None
            infinite = not np.isfinite(null)
            value = values[i] / times if infinite else null + times * (values[i] - null)
            values[i] = np.clip(value, page.lower, page.upper)
        return np.asarray(values)

    def attained(self, times: float) -> float:
        """Strength at `times` the typical strength; it differs from `times` at a bound."""
        value, usual, null = self.values(times)[self.which], self.usual[self.which], self.page.null
        assert null is not None
        if not np.isfinite(null):
            return float(usual / value)
        return float((value - null) / (usual - null))


@dataclass
class _AtStrength:
    """Change of the friction by an effect of one strength.

    Attributes
    ----------
    change, shares
        Change, in the unit of the force, and relative sample weights (None if they do not change),
        one array per run.
    slopes
        Derivatives with respect to the parameters of the effect, one (n, k) array per run; None
        until needed.
    """

    change: list[Array]
    shares: list[Array] | None
    slopes: list[Array] | None = None


class PresentRuns:
    """Recorded runs and their fitted model, to which effects of given strength are added.

    The methods return the changes of the friction by an effect, and the parts of these changes that
    the model cannot reproduce.
    """

    def __init__(self, candidates: Candidates, present: Names) -> None:
        self.base = candidates.converge(present)
        problem = candidates.fitted(present).problem
        self.problem = problem.thinned
        thinned = self.problem is not problem
        samples = self.base.samples.only(problem.searched) if thinned else self.base.samples
        solution = self.problem.solution(self.base.values, samples, self.base.noise)
        self.samples, self.noise = samples, solution.noise
        self.solution = solution
        r, self.slopes = solution.stacked()
        # Scale to the number of samples of all runs, including those that a search omits.
        more = self.base.samples.count / max(samples.count, 1)
        level = float(r @ r) / max(len(r), 1) / max(effective_share(solution), 1e-3)
        self.scale = np.sqrt(more / max(level, 1e-300))
        self.prediction = self.problem.predict(self.base.values)
        size = np.linalg.norm(self.slopes, axis=0)
        normalised = self.slopes[:, size > 0.0] / size[size > 0.0]
        self.tangent: Array = np.asarray(np.linalg.qr(normalised)[0])
        self.friction = self.samples.rms(self.prediction)
        # The last computed changes, by effect and exponent of `STRENGTH_RATIO`.
        self._computed: dict[str, dict[int, _AtStrength]] = {}
        self._most_cached = max(CACHED_SAMPLES // max(sum(len(f) for f in self.prediction), 1), 1)

    def change(self, model: Strength, times: float) -> list[Array]:
        """Change of the friction by an effect, one array per run; zero at excluded samples.

        It is scaled from the nearest strength at which it is computed.
        """
        exponent, at_nearest = self._nearest(model, times)
        factor = model.attained(times) / model.attained(STRENGTH_RATIO**exponent)
        return [factor * change for change in at_nearest.change]

    def shares(self, model: Strength, times: float) -> list[Array] | None:
        """Sample weights with an effect relative to those without it, 0 to 1, one array per run.

        None if the effect does not change the weights. Effects that shift friction jumps change
        them.
        """
        return self._nearest(model, times)[1].shares

    def slopes_of(self, model: Strength, times: float) -> list[Array]:
        """Derivatives of the friction with respect to the parameters of an effect.

        The result has one (n, k) array per run. Samples are scaled by their weights (`shares`).
        """
        exponent, at_nearest = self._nearest(model, times)
        if at_nearest.slopes is None:
            problem = model.problem.thinned
            by = [i for i in problem.open if problem.names[i].startswith(f"{model.name}.")]
            _, slopes = problem.linearise(model.values(STRENGTH_RATIO**exponent), by=by)
            if at_nearest.shares is not None:
                slopes = [j * s[:, None] for j, s in zip(slopes, at_nearest.shares, strict=True)]
            at_nearest.slopes = slopes
        return at_nearest.slopes

    def _nearest(self, model: Strength, times: float) -> tuple[int, _AtStrength]:
        """Result at the computed strength nearest to `times`, and its exponent."""
        exponent = round(float(np.log(times) / np.log(STRENGTH_RATIO)))
        computed = self._computed.setdefault(model.name, {})
        if exponent not in computed:
            if len(computed) >= self._most_cached:
                del computed[next(iter(computed))]
            computed[exponent] = self._changed(model, STRENGTH_RATIO**exponent)
        return exponent, computed[exponent]

    def _changed(self, model: Strength, times: float) -> _AtStrength:
        """Change of the friction by an effect at a strength, and the relative sample weights."""
        problem = model.problem.thinned
        values = model.values(times)
        residuals, prepared = problem.residuals(values), problem.campaign.prepared
        gaps = [
            p.friction - r - f for p, r, f in zip(prepared, residuals, self.prediction, strict=True)
        ]
        samples = common_samples(problem.samples_at(values, residuals), self.samples)
        if samples is self.samples:
            return _AtStrength(gaps, None)
        shares = [
            np.divide(a, b, out=np.zeros_like(a), where=b > 0.0)
            for a, b in zip(samples.weight, self.samples.weight, strict=True)
        ]
        changes = [gap * share for gap, share in zip(gaps, shares, strict=True)]
        return _AtStrength(changes, shares)

    def unexplained(self, changes: Sequence[Array]) -> Array:
        """Part of friction changes that the model cannot reproduce, in units of the noise.

        The changes are in the unit of the force, one (n,) or (n, k) array per run.
        """
        columns = [c if c.ndim == 2 else c[:, None] for c in changes]
        empty = [np.zeros(len(c)) for c in columns]
        _, white = self.samples.stacked(empty, columns, self.noise)
        part: Array = self.scale * (white - self.tangent @ (self.tangent.T @ white))
        return part

    def share_after_noise_refit(self, changes: Sequence[Array]) -> float:
        """Share of the gain of a change that remains after the noise model is refitted, 0 to 1.

        A refitted noise model describes a part of a smooth change as coloured noise.
        """
        empty = [np.zeros((len(c), 0)) for c in changes]
        change, _ = self.samples.stacked(changes, empty, self.noise)
        residual, _ = self.samples.stacked(self.solution.residuals, empty, self.noise)
        step, *_ = np.linalg.lstsq(self.slopes, change, rcond=1e-10)
        unexplained = change - self.slopes @ step
        square = float(unexplained @ unexplained)
        if square <= 0.0:
            return 1.0
        # Remove the component of the change that these residuals contain by chance.
        chance = float(residual @ unexplained) / square
        parts = [c - j @ step for c, j in zip(changes, self.solution.jacobian, strict=True)]
        noise = [r - chance * c for r, c in zip(self.solution.residuals, parts, strict=True)]
        changed = [r + c for r, c in zip(noise, parts, strict=True)]
        masked = [r * c for r, c in zip(changed, self.samples.counted, strict=True)]
        samples, most = self.samples, self.problem.campaign.most_noise_n
        settings = samples.settings.noise
        refitted = estimate_noise(masked, samples.steps_s, samples.counted, most, settings)
        before = samples.cost(noise, self.noise)
        gain, remaining = (
            samples.cost(changed, model) - before for model in (self.noise, refitted)
        )
        return float(np.clip(remaining / max(gain, 1e-300), 0.02, 1.0))

    def discounts(self, change: Array) -> tuple[float, ...]:
        """Factors by which an estimated long-run variance reduces a gain, one per white-noise draw.

        The gain is that of a change of the friction along `change`. The factors vary between draws
        because the long-run variance is an estimate. Its lower limit is the variance of white
        noise.
        """
        counts = [int(np.count_nonzero(w > 0.0)) for w in self.samples.weight]
        ends = np.cumsum(counts)[:-1]
        changes = np.split(change, ends)
        random, settings = np.random.default_rng(DRAWS), self.samples.settings.variance
        return tuple(
            1.0
            / significant_inflation(changes, np.split(noise, ends), self.samples.steps_s, settings)
            for noise in random.standard_normal((DRAWS, len(change)))
        )


def at_usual_strength(candidates: Candidates, present: Names, name: str) -> tuple[Problem, Array]:
    """Return the model with one additional effect, and its parameters at the typical strength."""
    candidates.converge(present)
    base = candidates.fitted(present).named_values()
    problem = candidates.fitted((*present, name)).problem
    return problem, next(iter(problem.starts({**base, **problem.fixed})))


def strength_of(candidates: Candidates, present: Names, name: str) -> Strength | None:
    """Return the model parametrised by an effect's strength; None for an effect without a null."""
    problem, usual = at_usual_strength(candidates, present, name)
    pages = list(problem.parameters.values())
    sizes = tuple(
        i
        for i, (full, page) in enumerate(problem.parameters.items())
        if full.startswith(f"{name}.") and page.null is not None and full not in problem.fixed
    )
    return Strength(name, problem, usual, sizes[0], pages[sizes[0]], sizes) if sizes else None
