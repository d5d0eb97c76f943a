"""Separation of two models in a motion that is not yet recorded.

The wrong model is refitted to the old runs and the new one together. The separation is the part of
the difference that remains (T-optimality, Atkinson & Fedorov 1975; here to first order). The part
that its parameters can reproduce is not evidence.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.excitations import Excitation, Limits, excitations
from jbf.diagnosis.fitted import Fitted
from jbf.estimation.likelihood import unexplained_square
from jbf.estimation.problem import bounded
from jbf.models.chain import core_load_n, core_motion
from jbf.models.driven import Driven
from jbf.models.own_effects import ALWAYS
from jbf.records.motion.known import known_motion
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.records.run_requirements import run_on

Array = npt.NDArray[np.float64]

SIMULATED = {*ALWAYS, "angle_rad", "position_m"}
"""Columns that a proposed motion has."""
MOST_SAMPLES, LEAST_SAMPLES = 6000, 200
"""Largest and smallest number of samples of a proposed run. It enters no verdict."""
NO_NOISE_N = 1e-100
"""Positive lower limit of the noise, N, that avoids a division by zero.

It is a numerical tolerance.
"""


class Rival:
    """A fitted model and the information of the present runs about its parameters."""

    def __init__(self, fitted: Fitted) -> None:
        self.problem, self.solution = fitted.problem, fitted.current_solution()
        r, j = self.solution.stacked()
        self.noise_rms = float(np.sqrt(r @ r / max(len(r) - j.shape[1], 1)))
        self.known: Array = np.asarray(np.linalg.qr(j, mode="r"), dtype=np.float64)

    def at(self, motion: Driven) -> tuple[Array, Array]:
        """Friction, N, and its derivatives with respect to the search variables, under a motion."""
        values = self.solution.values
        ((friction, slopes),) = self.problem.chain.jacobian(values, [motion], self.problem.open)
        scale = np.where(self.problem.log, values, 1.0)[self.problem.open]
        return friction, bounded(slopes, scale)

    def separation(
        self, own: tuple[Array, Array], truth: tuple[Array, Array], step_s: float
    ) -> float:
        """Misfit of this model to the friction of another one after refitting, in noise variances.

        The refit uses the new motion and the old runs.
        """
        noise = self.solution.noise
        gap = noise.innovations(truth[0] - own[0], step_s)
        slopes = noise.innovations(own[1], step_s)
        design = np.concatenate([slopes, self.known])
        target = np.concatenate([gap, np.zeros(len(self.known))])
        return unexplained_square(design, target) / max(self.noise_rms, NO_NOISE_N) ** 2


def filled_limits(candidates: Candidates, limits: Limits | None) -> tuple[Limits, float]:
    """Complete the limits, and choose the sampling interval of a proposed run, s."""
    filled = (limits or Limits()).filled(candidates.campaign)
    step_s = float(np.median([p.step_s for p in candidates.campaign.prepared]))
    most_s = filled.duration_s / LEAST_SAMPLES
    return filled, max(min(step_s, most_s), filled.duration_s / MOST_SAMPLES)


def motions(
    candidates: Candidates, limits: Limits, step_s: float
) -> Iterator[tuple[Excitation, Run, Driven]]:
    """Generate every motion that the rig can make, as a run to play."""
    rig = candidates.campaign.rig
    linear = any(p.run.position_m is not None for p in candidates.campaign.prepared)
    for excitation in excitations(limits, step_s, rig.quantities.speed):
        run = run_from_motion(rig, excitation, step_s, linear=linear)
        yield excitation, run, core_motion(rig, run, known_motion(run, rig.radius_m))


def run_from_motion(rig: Rig, excitation: Excitation, step_s: float, *, linear: bool) -> Run:
    """Convert a motion to a run to play, with the position of a slide or the angle of a shaft."""
    velocity = excitation.velocity
    time = np.arange(len(velocity)) * step_s
    path = np.concatenate(([0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * step_s)))
    bearing = rig.bearing
    radius = 1.0 if bearing is None else bearing.radius_m
    place = {"position_m": path} if linear else {"angle_rad": path / radius}
    load_n = excitation.load_n or core_load_n(rig)
    load = None if load_n is None else np.full(len(time), load_n)
    warmth = excitation.temperature_c
    celsius = None if warmth is None else np.full(len(time), warmth)
    run = Run.from_arrays(time, velocity, load_n=load, temperature_c=celsius, name="next", **place)
    return run_on(rig, run)
