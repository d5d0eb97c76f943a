"""How large the noise is, sample by sample: with the force, by run, and how heavy its tails are."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.diagnosis.policy import Policy
from jbf.estimation.problem import Problem
from jbf.estimation.robust import robust_size
from jbf.estimation.solution import Solution
from jbf.records.findings.finding import Finding

Array = npt.NDArray[np.float64]

FORCE_BINS = 6
HUBER = 2.5
"""Innovations beyond so many of their standard deviations count less (Huber 1964)."""
LEAST = 200
"""Samples of a bin whose size can be told."""
ERROR = 1.9
"""Relative standard error of a size from the median of third differences, times the square root of
the samples: 1.17 of a median of independent ones (Rousseeuw & Croux 1993); these share readings.
"""


def _white(residual: Array) -> Array:
    """The white noise of a residual, sample by sample, from its third differences."""
    third = np.diff(residual, 3) / np.sqrt(20.0)
    found: Array = np.pad(third, (1, len(residual) - len(third) - 1), mode="edge")
    return found


def noise_sizes(
    problem: Problem, solution: Solution, policy: Policy
) -> tuple[list[Array], list[Finding]]:
    """A weight for the size of the noise at each sample, 0 to 1, and whether it is uneven."""
    samples = solution.samples
    # The white part alone: what a model leaves is smooth, and no noise.
    e = [_white(r) for r in solution.residuals]
    force = [np.abs(f) for f in problem.predict(solution.values)]
    flat_e, flat_f = samples.flat(e), samples.flat(force)
    usual = robust_size(flat_e)
    ones = [np.ones(len(f)) for f in force]
    if usual <= 0.0 or len(flat_e) < LEAST * FORCE_BINS:
        return ones, []
    edges = np.quantile(flat_f, np.linspace(0.0, 1.0, FORCE_BINS + 1))
    middle = 0.5 * (edges[1:] + edges[:-1])
    which = np.clip(np.searchsorted(edges, flat_f) - 1, 0, FORCE_BINS - 1)
    counts = np.bincount(which, minlength=FORCE_BINS)
    # Many forces may be the same, where a shaft rests.
    full = np.flatnonzero(counts)
    counts, middle = counts[full], middle[full]
    by_force = np.array([robust_size(flat_e[which == k]) for k in full])
    findings = []
    shares = ones
    if _uneven(by_force, counts, policy):
        # A line through the squares: noise of the cell, and noise that goes with the force.
        slope, level = np.polyfit(middle**2, by_force**2, 1)
        if (
            slope > 0.0
            and level + slope * middle[-1] ** 2 > policy.uneven_noise**2 * by_force.min() ** 2
        ):
            least = max(level, 0.25 * by_force.min() ** 2)
            sd = [np.sqrt(least + slope * f**2) for f in force]
            low = min(float(s.min()) for s in sd)
            shares = [low / s for s in sd]
            share = float(np.sqrt(slope))
            words = f"the noise grows with the force, by {100.0 * share:.2g} % of it"
            names = ", ".join(samples.runs)
            findings.append(
                Finding("noise_with_force", "friction_n", names, share, "1", "weighed", words)
            )
    told = samples.innovations(solution.residuals, solution.noise)
    white, whole = (
        np.array(
            [robust_size((x * s)[c]) for x, s, c in zip(v, shares, samples.counted, strict=True)]
        )
        for v in (e, told)
    )
    # Equal readings of a coarse converter have no noise among them, and its rounding between them.
    rounding = np.array([p.converter_step_n for p in problem.campaign.prepared]) / np.sqrt(12.0)
    white, whole = np.maximum(white, rounding), np.maximum(whole, rounding)
    sampled = np.array([int(c.sum()) for c in samples.counted])
    some = (sampled > LEAST) & (white > 0.0) & (whole > 0.0)
    # A smooth channel has no white noise, a wrong model more than noise: both must say so.
    if some.any() and all(_uneven(x[some], sampled[some], policy) for x in (white, whole)):
        by_run = np.ones(len(some))
        by_run[some] = np.maximum(*(x[some].min() / x[some] for x in (white, whole)))
        shares = [w * share for w, share in zip(shares, by_run.tolist(), strict=True)]
        ratio = float(by_run.max() / by_run.min())
        words = f"the noise differs by run, up to {ratio:.2g} times"
        names = ", ".join(samples.runs)
        findings.append(Finding("noise_by_run", "friction_n", names, ratio, "1", "weighed", words))
    return shares, findings


def robust_weights(
    solution: Solution, sizes: list[Array], heavy: float
) -> tuple[list[Array], list[Finding]]:
    """A weight against heavy tails for each sample, 0 to 1, and whether there are any."""
    samples = solution.samples
    e = [
        x * s
        for x, s in zip(samples.innovations(solution.residuals, solution.noise), sizes, strict=True)
    ]
    flat = samples.flat(e)
    sigma = robust_size(flat)
    ones = [np.ones(len(x)) for x in e]
    if sigma <= 0.0 or not len(flat):
        return ones, []
    beyond = float(np.mean(np.abs(flat) > 4.0 * sigma))
    if beyond < max(heavy * 2.0 * special.ndtr(-4.0), 5.0 / len(flat)):
        return ones, []
    # A weight on the residual whose square is Huber's on the square.
    weights = [np.sqrt(np.minimum(1.0, HUBER * sigma / np.maximum(np.abs(x), 1e-300))) for x in e]
    words = f"{100.0 * beyond:.2g} % of the noise is beyond four of its standard deviations"
    names = ", ".join(samples.runs)
    finding = Finding("heavy_tails", "friction_n", names, beyond, "1", "weighed", words)
    return weights, [finding]


def _uneven(sizes: Array, counts: npt.NDArray[np.int_], policy: Policy) -> bool:
    """Whether sizes of noise differ by a ratio that matters, and by more than chance."""
    if float(sizes.min()) <= 0.0 or sizes.max() <= policy.uneven_noise * sizes.min():
        return False
    error = ERROR / np.sqrt(counts)
    logs = np.log(sizes)
    middle = float(np.sum(logs / error**2) / np.sum(1.0 / error**2))
    square = float(np.sum(((logs - middle) / error) ** 2))
    return bool(special.chdtrc(len(sizes) - 1, square) < policy.deviation_chance)
