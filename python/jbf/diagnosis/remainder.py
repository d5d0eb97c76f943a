"""Structure that nothing in the catalogue explains: patterns along an axis, tones, bursts, what
comes again with the motion, and runs that disagree on the parameters.

Everything is tested on innovations (the residual less what the noise's own memory foretells),
so that coloured noise is no structure. A pattern must be both beyond chance and large enough to
matter.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import signal

from jbf.comparison.axes import all_axes, force_axis
from jbf.comparison.comparison import Failure, _failure
from jbf.diagnosis.bursts import find_bursts
from jbf.diagnosis.constancy import find_disagreement
from jbf.diagnosis.repeats import find_repeats
from jbf.diagnosis.result import Remainder
from jbf.estimation.fit import Problem, Solution
from jbf.models.catalogue import transition_speed

Array = npt.NDArray[np.float64]

LEAST_SHARE = 0.008
"""A pattern that explains less of the residual's mean square than this is let pass."""
LEAST_SHARE_OF_FORCE = 0.003
"""Along the model's own force less will do: a law bends itself to hide what a cell that is not
straight does to it, and right models leave half of this at most."""
TONE_CHANCE = 1e-7
"""Probability that noise alone shows so high a spectral line in any run."""


def find_remainder(problem: Problem, solution: Solution) -> tuple[Remainder, ...]:
    """What remains in the residuals of a solution, strongest first."""
    problem = problem.on(solution.campaign)
    campaign = problem.campaign
    innovations = [
        problem_innovations(r, p.trusted, p.step_s, solution)
        for r, p in zip(solution.residuals, campaign.prepared, strict=True)
    ]
    found = [Remainder(f.axis, f.where, f.share) for f in _patterns(problem, solution, innovations)]
    found += _tones(problem, innovations, [-r for r in solution.residuals])
    found += find_repeats(problem, solution)
    found += find_bursts(problem, innovations)
    found += find_disagreement(problem, solution)
    return tuple(sorted(found, key=lambda r: -r.share))


def problem_innovations(
    residual: Array, trusted: npt.NDArray[np.bool_], step_s: float, solution: Solution
) -> Array:
    """Innovations of record minus prediction, zero where the sample says nothing."""
    return solution.noise.innovations(-residual * trusted, step_s) * trusted


def _patterns(problem: Problem, solution: Solution, innovations: list[Array]) -> list[Failure]:
    campaign = problem.campaign
    trusted = np.concatenate([p.trusted for p in campaign.prepared])
    e = np.concatenate(innovations)[trusted]
    total = float(e @ e)
    size = float(np.sqrt(total / max(len(e), 1)))
    u_tr = transition_speed(problem.law, solution.values.tolist())
    found = []
    force = force_axis(problem.predict(solution.values))
    for axis in (*all_axes(campaign, u_tr), force):
        failure = _failure(axis, e, trusted, total, size)
        least = LEAST_SHARE_OF_FORCE if axis is force else LEAST_SHARE
        if failure is not None and failure.share >= least:
            found.append(failure)
    return found


def _tones(problem: Problem, innovations: list[Array], residuals: list[Array]) -> list[Remainder]:
    """Spectral lines that stand out of the white spectrum of the innovations."""
    lines: list[tuple[float, float, str]] = []
    power = 0.0
    for p, e, r in zip(problem.campaign.prepared, innovations, residuals, strict=True):
        n = len(e)
        if n < 64:
            continue
        f, spectrum = signal.periodogram(e, 1.0 / p.step_s, window="boxcar", detrend="constant")
        # Slow structure belongs to the patterns; a line needs several turns within the run.
        band = f > 8.0 / p.run.duration_s
        if not band.any():
            continue
        level = float(np.median(spectrum[band]) / np.log(2.0))
        k = int(np.argmax(np.where(band, spectrum, 0.0)))
        if level <= 0.0 or spectrum[k] / level < -np.log(TONE_CHANCE / band.sum()):
            continue
        frequency, amplitude = _refine(p.run.time_s, r, p.trusted, float(f[k]), float(f[1]))
        lines.append((frequency, amplitude, p.run.name))
        power += 0.5 * amplitude**2 * n
    if not lines:
        return []
    total = sum(
        float(np.sum(r[p.trusted] ** 2))
        for r, p in zip(residuals, problem.campaign.prepared, strict=True)
    )
    middle = float(np.median([x[0] for x in lines]))
    same = [x for x in lines if abs(x[0] - middle) < 0.02 * middle + 0.02]
    share = power / max(total, 1e-300)
    if share < LEAST_SHARE:
        return []
    every = len(lines) == len(problem.campaign.prepared)
    scope = "in all runs" if every else "in " + ", ".join(x[2] for x in lines)
    if len(same) == len(lines):
        amplitude = float(np.median([x[1] for x in same]))
        where = f"a {middle:.2f} Hz tone, amplitude {amplitude:.2g} N, {scope}"
    else:
        where = "tones: " + ", ".join(f"{x[0]:.2f} Hz of {x[1]:.2g} N in {x[2]}" for x in lines)
    return [Remainder("frequency", where, min(share, 1.0))]


def _refine(
    time: Array, r: Array, trusted: npt.NDArray[np.bool_], near: float, width: float
) -> tuple[float, float]:
    """Frequency and amplitude of the sine that fits best near a spectral line."""
    grid = near + width * np.linspace(-1.0, 1.0, 41)
    t, y = time[trusted], r[trusted]
    best, amplitude, gain = near, 0.0, -1.0
    for f in grid:
        phase = 2.0 * np.pi * f * t
        pair = np.stack([np.cos(phase), np.sin(phase)], axis=1)
        c, *_ = np.linalg.lstsq(pair, y, rcond=None)
        now = float(np.sum((pair @ c) ** 2))
        if now > gain:
            best, amplitude, gain = float(f), float(np.hypot(*c)), now
    return best, amplitude
