"""Tests for residual structure (lack of fit) that no effect of the catalogue explains.

This module tests for patterns along an axis and combines all tests. `periodic` tests for tones,
ripples over the travel, and errors that repeat with the motion. `bursts` tests for structure at
isolated instants, and `momentum` for disturbances that act for several samples. `constancy` tests
whether all runs have the same parameters, and all strokes the same friction level.

All tests but that of the momentum use innovations, the residuals whitened by the noise model, so
that coloured noise is not reported as structure. A pattern is reported if it is both significant
and large enough to be relevant. Sizes in newtons refer to the residual: record minus model.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from jbf.arrays import Array
from jbf.comparison.axes import all_axes, force_axis
from jbf.comparison.bins import Binned
from jbf.comparison.patterns import STRONG_SHARE, Failure, bin_means, pattern_along
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.residual_structure.bursts import find_bursts
from jbf.diagnosis.residual_structure.constancy import find_disagreement, find_stroke_levels
from jbf.diagnosis.residual_structure.momentum import find_disturbances
from jbf.diagnosis.residual_structure.periodic import find_replicates, find_ripples, find_tones
from jbf.estimation.generalised_least_squares import with_less_smoothing
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.estimation.uncertain_samples import timing_error_is_small
from jbf.models.catalogue import transition_speed


def find_residual_structure(
    problem: Problem, solution: Solution, policy: Policy = DEFAULT
) -> tuple[Remainder, ...]:
    """Test the residual of a solution for all kinds of structure, and return those found.

    The largest share of the mean square is first. Smoothing biases an estimated motion where the
    acceleration changes fast. The model is therefore refitted with a motion that is smoothed less,
    and a pattern or a tone that changes by more than `policy.motion.max_pattern_ratio` is not
    returned. A scale of the motion's errors above `policy.motion.max_scale` is returned.
    """
    prepared, samples = problem.campaign.prepared, solution.samples
    innovations = samples.innovations(solution.residuals, solution.noise)
    residuals = samples.without_deviations(solution.residuals, solution.noise)

    @cache
    def refitted() -> list[Array]:
        """Residuals of the model refitted with a motion that is smoothed less."""
        _, other = with_less_smoothing(problem, solution)
        return other.samples.without_deviations(other.residuals, other.noise)

    less_smoothed = None if samples.motion is None else refitted
    patterns = find_patterns(problem, solution, innovations, residuals, policy, less_smoothed)
    structure = [Remainder(f.axis, f.where, f.share) for f in patterns]
    structure += find_tones(prepared, samples, innovations, residuals, policy, less_smoothed)
    structure += find_ripples(problem.campaign, samples, innovations, residuals, policy)
    structure += find_replicates(prepared, solution, policy)
    plain = samples.plain_innovations(solution.residuals, solution.noise)
    # The timing error of a steep force lasts for several samples, as a burst does.
    certain = [
        timing_error_is_small(p, r, solution.rms)
        for p, r in zip(prepared, solution.residuals, strict=True)
    ]
    tested = samples.within(certain)
    structure += find_bursts(prepared, tested, plain, residuals, policy)
    structure += find_disturbances(prepared, tested, residuals, policy)
    structure += find_disagreement(problem, solution, policy)
    structure += find_stroke_levels(problem, solution, policy)
    # Coarse quantisation biases mean readings along any axis and in each run.
    steps_rms = problem.campaign.steps_rms(solution.rms)
    structure = [r for r in structure if np.sqrt(r.share) * solution.rms > steps_rms]
    if samples.motion is not None:
        least = policy.least_share(problem.campaign.motion_share)
        structure = [r for r in structure if r.share >= least]
        share = samples.motion.variance_share(samples.weight)
        # A small share does not determine the scale.
        relevant = share >= policy.motion.max_structure_share
        if relevant and samples.motion.scale > policy.motion.max_scale:
            where = (
                "the residual requires errors of the motion "
                f"{samples.motion.scale:.1f} times as large as those of its readings"
            )
            structure.append(Remainder("motion", where, share))
    return tuple(sorted(structure, key=lambda r: -r.share))


def find_patterns(
    problem: Problem,
    solution: Solution,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    policy: Policy,
    less_smoothed: Callable[[], Sequence[Array]] | None = None,
) -> list[Failure]:
    """Find axes along which the means of the innovations differ significantly and relevantly.

    Each pattern that is returned contains the means of the residuals (N) along its axis.
    `less_smoothed` returns the residuals with a motion that is smoothed less.
    """
    e = solution.samples.flat(innovations)
    size = float(np.sqrt(float(e @ e) / max(len(e), 1)))
    u_tr = transition_speed(problem.law, solution.values.tolist())
    # The force axis shows a nonlinear force sensor.
    unit = problem.campaign.rig.quantities.force
    force = force_axis(*_likeliest_forces(problem, solution), unit)
    share, sigma = policy.patterns.min_share, policy.patterns.min_sigma
    if solution.samples.motion is not None:
        share = max(share, policy.least_share(problem.campaign.motion_share))
    found: list[tuple[Binned, Failure]] = []
    for axis in (*all_axes(problem.campaign, u_tr), force):
        pattern = pattern_along(axis, solution.samples, innovations, size, share, sigma, residuals)
        if pattern is not None:
            found.append((axis, pattern))
    if not found or less_smoothed is None:
        return [pattern for _, pattern in found]
    other, most = less_smoothed(), policy.motion.max_pattern_ratio
    return [
        pattern
        for axis, pattern in found
        if 1.0 / most < _pattern_ratio(axis, solution.samples, innovations, residuals, other) < most
    ]


def _pattern_ratio(
    axis: Binned,
    samples: Samples,
    innovations: Sequence[Array],
    residuals: Sequence[Array],
    less_smoothed: Sequence[Array],
) -> float:
    """Mean ratio of the bin means with less smoothing to those of the residuals along an axis.

    The weight of a bin is the sum of squares of the innovations that its mean explains; weak bins
    are ignored. The ratio is zero if no bin remains.
    """
    means, counts = bin_means(axis, samples, innovations)
    before, after = (bin_means(axis, samples, r)[0] for r in (residuals, less_smoothed))
    weights = np.where(before != 0.0, counts * means**2, 0.0)
    ratios = np.divide(after, before, out=np.zeros_like(before), where=before != 0.0)
    strong = weights > STRONG_SHARE * float(np.sum(weights))
    return float(np.average(ratios[strong], weights=weights[strong])) if np.any(strong) else 0.0


def _likeliest_forces(problem: Problem, solution: Solution) -> tuple[list[Array], float]:
    """Estimate the force of each sample from model and record, and its median standard error.

    The estimate is the mean of both, weighted by precision. Its error is uncorrelated with the
    residual. In bins of the prediction alone, the errors of the motion would have a nonzero mean.
    Without errors of the motion, the estimate is the prediction.
    """
    predicted, samples = problem.predict(solution.values), solution.samples
    motion = samples.motion
    if motion is None or not problem.campaign.force_has_clock:
        return predicted, 0.0
    shares = [r / (1.0 + r) for r in map(motion.variance_ratio, range(len(predicted)))]
    forces = [
        np.where(counted, f + share * (p.friction - f), f)
        for f, share, p, counted in zip(
            predicted, shares, problem.campaign.prepared, samples.counted, strict=True
        )
    ]
    return forces, motion.noise * float(np.sqrt(np.median(samples.flat(shares))))
