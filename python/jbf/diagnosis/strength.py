"""How an effect of some strength changes the friction of the runs at hand, and how much of that the
rest of the model cannot make up for, in units of the noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.candidates import Candidates
from jbf.estimation.likelihood import effective_share
from jbf.estimation.long_run import sure_inflation
from jbf.estimation.noise import estimate_noise
from jbf.estimation.problem import Problem
from jbf.estimation.samples import least_weights
from jbf.models.catalogue import Parameter

Array = npt.NDArray[np.float64]
Names = tuple[str, ...]

DRAWS = 12
"""Draws of white noise by which it is known how much a gain in some direction counts."""


@dataclass(frozen=True)
class Strength:
    """A model with one effect more, by how strong that is; 1 at its usual strength.

    Attributes
    ----------
    which, page
        The parameter by which the strength is told.
    sizes
        That one and the others of the effect that are a size, too: each has a null.
    """

    name: str
    problem: Problem
    usual: Array
    which: int
    page: Parameter
    sizes: tuple[int, ...]

    def values(self, times: float) -> Array:
        """Parameter values at so many times the usual strength, within bounds."""
        values, pages = self.usual.copy(), list(self.problem.parameters.values())
        for i in self.sizes:
            null, page = pages[i].null, pages[i]
            assert null is not None
            far = not np.isfinite(null)
            there = values[i] / times if far else null + times * (values[i] - null)
            values[i] = np.clip(there, page.lower, page.upper)
        return np.asarray(values)


class RunsAtHand:
    """The runs at hand under the model without the effect: what is left of a change of friction."""

    def __init__(self, candidates: Candidates, present: Names) -> None:
        self.base = candidates.converge(present)
        whole = candidates.fitted(present).problem
        self.problem = whole.thinned
        samples = self.problem.campaign.samples
        if self.problem is whole:
            samples = self.base.samples
        solution = self.problem.solution(self.base.values, samples, self.base.noise)
        self.samples, self.noise = samples, solution.noise
        self.solution = solution
        r, self.slopes = solution.stacked()
        # Every run of the campaign tells as much as those that stand for them here.
        more = self.base.samples.count / max(samples.count, 1)
        level = float(r @ r) / max(len(r), 1) / max(effective_share(solution), 1e-3)
        self.scale = np.sqrt(more / max(level, 1e-300))
        self.now = self.problem.predict(self.base.values)
        size = np.linalg.norm(self.slopes, axis=0)
        moved = self.slopes[:, size > 0.0] / size[size > 0.0]
        self.tangent: Array = np.asarray(np.linalg.qr(moved)[0])
        self.friction_n = self.samples.rms(self.now)
        # The last of each effect: at which strength, what it changes, and what samples count.
        self._last: dict[str, tuple[float, list[Array], list[Array] | None]] = {}

    def change(self, model: Strength, times: float) -> list[Array]:
        """What an effect changes, N, one array a run; where its model has no weight, nothing."""
        return self._at(model, times)[0]

    def shares(self, model: Strength, times: float) -> list[Array] | None:
        """By how much less than without it samples count with an effect that moves jumps, 0 to 1,
        one array a run; None where it leaves them as they are."""
        return self._at(model, times)[1]

    def _at(self, model: Strength, times: float) -> tuple[list[Array], list[Array] | None]:
        last = self._last.get(model.name)
        if last is None or last[0] != times:
            last = self._last[model.name] = (times, *self._changed(model, times))
        return last[1:]

    def _changed(self, model: Strength, times: float) -> tuple[list[Array], list[Array] | None]:
        problem = model.problem.thinned
        values = model.values(times)
        gaps = [a - b for a, b in zip(problem.predict(values), self.now, strict=True)]
        own = least_weights(problem.samples_at(values), self.samples)
        if own is self.samples:
            return gaps, None
        shares = [
            np.divide(a, b, out=np.zeros_like(a), where=b > 0.0)
            for a, b in zip(own.weight, self.samples.weight, strict=True)
        ]
        return [gap * share for gap, share in zip(gaps, shares, strict=True)], shares

    def shown(self, changes: Sequence[Array]) -> Array:
        """Of changes of the friction, one (n,) or (n, k) a run, what the model cannot make up for,
        in units of the noise."""
        columns = [c if c.ndim == 2 else c[:, None] for c in changes]
        empty = [np.zeros(len(c)) for c in columns]
        _, seen = self.samples.stacked(empty, columns, self.noise)
        left: Array = self.scale * (seen - self.tangent @ (self.tangent.T @ seen))
        return left

    def not_forgiven(self, changes: Sequence[Array]) -> float:
        """The share of what is seen of changes that is left once the noise is described anew, in
        which a smooth change passes for colour, 0 to 1."""
        empty = [np.zeros((len(c), 0)) for c in changes]
        seen, _ = self.samples.stacked(changes, empty, self.noise)
        own, _ = self.samples.stacked(self.solution.residuals, empty, self.noise)
        step, *_ = np.linalg.lstsq(self.slopes, seen, rcond=1e-10)
        left = seen - self.slopes @ step
        square = float(left @ left)
        if square <= 0.0:
            return 1.0
        # Apart from what these very residuals happen to have of it.
        chance = float(own @ left) / square
        way = [c - j @ step for c, j in zip(changes, self.solution.jacobian, strict=True)]
        noise = [r - chance * w for r, w in zip(self.solution.residuals, way, strict=True)]
        there = [r + w for r, w in zip(noise, way, strict=True)]
        masked = [r * c for r, c in zip(there, self.samples.counted, strict=True)]
        most = self.problem.campaign.most_noise_n
        again = estimate_noise(masked, self.samples.steps_s, self.samples.counted, most)
        before = self.samples.cost(noise, self.noise)
        gains = [
            self.samples.cost(there, description) - before for description in (self.noise, again)
        ]
        return float(np.clip(gains[1] / max(gains[0], 1e-300), 0.02, 1.0))

    def counts(self, change: Array) -> tuple[float, ...]:
        """By how much a gain in this direction may count, in noise as white as it can be: its
        long-run variance is itself estimated, and never taken for less than white noise's."""
        counts = [int(np.count_nonzero(w > 0.0)) for w in self.samples.weight]
        ends = np.cumsum(counts)[:-1]
        ways = np.split(change, ends)
        random = np.random.default_rng(DRAWS)
        return tuple(
            1.0 / sure_inflation(ways, np.split(noise, ends), self.samples.steps_s)
            for noise in random.standard_normal((DRAWS, len(change)))
        )


def strength_of(candidates: Candidates, present: Names, name: str) -> Strength | None:
    """A model as a function of an effect's strength; None of an effect without a null."""
    candidates.converge(present)
    base = candidates.fitted(present).named_values()
    problem = candidates.fitted((*present, name)).problem
    usual = next(iter(problem.starts({**base, **problem.fixed})))
    sizes = tuple(
        i
        for i, (full, page) in enumerate(problem.parameters.items())
        if full.startswith(f"{name}.") and page.null is not None and full not in problem.fixed
    )
    if not sizes:
        return None
    pages = list(problem.parameters.values())
    return Strength(name, problem, usual, sizes[0], pages[sizes[0]], sizes)
