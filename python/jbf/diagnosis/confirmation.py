"""Confirmation of a candidate effect by the prediction errors of held-out runs."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.arrays import Array, Names
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import Policy
from jbf.estimation.held_out import HeldOutPart, errors_by_run
from jbf.estimation.held_out_comparison import independent_units, mean_square, predictive_deviance
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import common_samples
from jbf.estimation.settings import HeldOutSettings
from jbf.estimation.solution import Solution


@dataclass(frozen=True)
class Confirmation:
    """Comparison of the held-out errors of a model with and without a candidate effect.

    Attributes
    ----------
    before_n, after_n
        Held-out RMS without and with the candidate, N.
    better
        Fraction of the runs with a smaller held-out RMS.
    density
        Gain in twice the held-out log predictive density, divided by the gain in twice the log
        likelihood of the fit.
    halved
        Runs of which two parts were held out in turn, in both fits: those that alone determine a
        parameter, or that are beyond the range of all others.
    units
        Number of independent units: runs, or strokes if the number of runs is small.
    chance
        p-value of the mean improvement of the units: one-sided t-test of the logarithms of the
        ratios of their mean squares; 1 with too few units.
    """

    before_n: float
    after_n: float
    better: float
    density: float
    halved: Names = ()
    units: int = 0
    chance: float = 1.0

    @classmethod
    def of(
        cls,
        simpler: Solution,
        richer: Solution,
        held_out: Sequence[HeldOutPart],
        richer_held_out: Sequence[HeldOutPart],
        halved: Names = (),
        prepared: Sequence[Prepared] = (),
    ) -> Confirmation:
        """Compare two fitted models, without and with the candidate, by their held-out predictions.

        `halved` has the names of the runs with held-out halves. The strokes of the runs `prepared`
        are the units if there are too few runs.
        """
        settings = simpler.samples.settings.held_out
        # Compare on common samples: a model may exclude those next to its jumps.
        counted = common_samples(simpler.samples, richer.samples).counted
        errors = [
            errors_by_run(simpler, held_out, deviations=False, counted=counted),
            errors_by_run(richer, richer_held_out, deviations=False, counted=counted),
        ]
        before_n, after_n = (
            _rms(np.concatenate(list(run_errors.values()))) for run_errors in errors
        )
        better = [
            _rms(errors[1][i]) < _rms(run_errors)
            for i, run_errors in errors[0].items()
            if len(run_errors)
        ]
        density = _density_share(simpler, richer, held_out, richer_held_out)
        ratios = _unit_ratios(errors[0], errors[1], prepared, counted, settings)
        return cls(
            before_n,
            after_n,
            float(np.mean(better or [False])),
            density,
            halved,
            len(ratios),
            _chance(ratios, settings.min_units),
        )

    def units_confirm(self, level: Level) -> bool:
        """Whether the held-out errors decrease significantly over the independent units.

        The p-value must be below `level.chance`, and the held-out mean square must decrease by at
        least the share `level.min_share`.
        """
        most = (1.0 - level.min_share) * self.before_n**2
        return self.chance < level.chance and self.after_n**2 < most

    def confirms(self, evidence: float, policy: Policy) -> bool:
        """Whether the held-out runs confirm a candidate.

        `evidence` is its gain in twice the log likelihood beyond the threshold. A predictive
        density that increases by a sufficient share of the gain confirms any candidate. The errors
        alone are not informative where the other runs cannot determine a parameter, for example
        where one run dominates the estimate of the parameters of the law. Where the evidence is
        strong, any gain in mean square suffices as well, or a better prediction of most of the
        runs. A candidate that increases the held-out RMS by more than
        `policy.held_out.max_rms_ratio` is never confirmed.
        """
        if self.after_n / max(self.before_n, 1e-300) > policy.held_out.max_rms_ratio:
            return False
        if self.density > policy.held_out.min_gain_share:
            return True
        predicts_better = (
            self.after_n < self.before_n or self.better >= policy.held_out.min_better_share
        )
        return evidence > policy.selection.weak_evidence and predicts_better

    def describe(self, unit: str) -> str:
        """Describe the held-out RMS with the candidate, for the ledger."""
        what = "runs" if not self.halved else f"runs and parts of {_listed(self.halved)}"
        return f"RMS of held-out {what} {self.after_n:.4g} {unit}"

    def describe_gain(self, unit: str) -> str:
        """Describe the held-out RMS and the confirmed share of the gain in log likelihood."""
        return f"{self.describe(unit)}, {self.density:.0%} of the gain in their log density"


def _unit_ratios(
    before: Mapping[int, Array],
    after: Mapping[int, Array],
    prepared: Sequence[Prepared],
    counted: Sequence[npt.NDArray[np.bool_]],
    settings: HeldOutSettings,
) -> Array:
    """Log ratios of held-out mean squares without and with a candidate, shape (units,)."""
    units = independent_units({i: counted[i] for i in before}, prepared, settings)
    squares = np.array(
        [(np.mean(before[i][rows] ** 2), np.mean(after[i][rows] ** 2)) for i, rows in units]
    ).reshape(-1, 2)
    squares = squares[(squares > 0.0).all(axis=1)]
    ratios: Array = np.log(squares[:, 0] / squares[:, 1])
    return ratios


def _chance(ratios: Array, min_units: int) -> float:
    """p-value of a positive mean log ratio (one-sided t-test); 1 below `min_units` ratios."""
    if len(ratios) < min_units:
        return 1.0
    error = float(np.std(ratios, ddof=1)) / np.sqrt(len(ratios))
    if error == 0.0:
        return 1.0
    return float(special.stdtr(len(ratios) - 1, -float(np.mean(ratios)) / error))


def _rms(errors: Array) -> float:
    """Root mean square of errors; zero without errors."""
    return float(np.sqrt(np.mean(errors**2))) if len(errors) else 0.0


def _density_share(
    simpler: Solution,
    richer: Solution,
    held_out: Sequence[HeldOutPart],
    richer_held_out: Sequence[HeldOutPart],
) -> float:
    """Gain in held-out log predictive density, divided by the gain in log likelihood of the fit.

    Both gains use the same samples and the same whitening.
    """
    samples, noise = common_samples(simpler.samples, richer.samples), richer.noise
    before, _ = mean_square(simpler, samples, noise)
    after, count = mean_square(richer, samples, noise)
    after = max(after, 1e-300)
    gained = predictive_deviance(simpler, held_out, samples, noise, after)
    gained -= predictive_deviance(richer, richer_held_out, samples, noise, after)
    return gained / max(count * (before - after) / after, 1e-300)


def _listed(names: Collection[str]) -> str:
    """First name of a list and the number of the others, as text."""
    first, *more = names
    return first if not more else f"{first} and {len(more)} more"
