"""The run that would part models that fit equally well.

Each motion that the rig can make is simulated with the rival models. What counts is what is left
of their difference after the one that is wrong has been fitted again, to the old runs and the new
one together (T-optimality, Atkinson & Fedorov 1975; here to first order): parameters that make up
for a wrong effect must not be counted as evidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.catalogue import find_effect
from jbf.diagnosis.excitations import Excitation, Limits, excitations
from jbf.fitting import Problem, Solution
from jbf.model import core_load_n, core_motion, imposed
from jbf.own_effects import ALWAYS
from jbf.record import PathLike, Run

if TYPE_CHECKING:
    from jbf.diagnosis.search import Search

Array = npt.NDArray[np.float64]

SIMULATED = {*ALWAYS, "angle_rad", "position_m"}
ENOUGH = 25.0
"""Expected evidence below which a run would hardly part anything."""
MOST_SAMPLES = 6000


@dataclass(frozen=True)
class Experiment:
    """A run to record next.

    Attributes
    ----------
    words
        What to record and why, in a sentence.
    run
        The motion to play: time, speed, angle or position, load; no friction.
    separation_n
        RMS by which the rival models differ there after a new fit, N.
    separation_sigma
        The same in units of the noise.
    evidence
        Twice the log likelihood ratio to be expected between them.
    """

    words: str
    run: Run
    separation_n: float
    separation_sigma: float
    evidence: float

    def write_csv(self, path: PathLike) -> None:
        """Write the motion to play."""
        self.run.write_csv(path)


def propose(
    search: Search,
    rivals: Sequence[Sequence[tuple[str, ...]]],
    limits: Limits | None = None,
) -> Experiment | str:
    """The run that best parts rival models, or the reason why there is none.

    Parameters
    ----------
    search
        The fits of the runs at hand.
    rivals
        Groups of models, each a tuple of effects; within a group all fit equally well.
    limits
        What the rig may be asked to do.
    """
    every = [effects for group in rivals for effects in group]
    strange = {c for effects in every for e in effects for c in find_effect(e).columns} - SIMULATED
    if strange:
        return f"no run can be proposed: nobody knows what {', '.join(sorted(strange))} would be"
    campaign = search.campaign
    limits = (limits or Limits()).filled(campaign)
    step_s = float(np.median([p.step_s for p in campaign.prepared]))
    step_s = max(step_s, limits.duration_s / MOST_SAMPLES)
    models = {effects: _Model(search, effects) for effects in every}
    best, chosen = 0.0, None
    for excitation in excitations(limits, step_s):
        run = _run(search, excitation, step_s)
        motion = core_motion(campaign.rig, run, imposed(campaign.rig, run))
        seen = {effects: model.at(motion) for effects, model in models.items()}
        # The least separated pair decides whether the run would settle it.
        least = min(
            models[b].evidence(seen[b], seen[a], step_s)
            for group in rivals
            for a in group
            for b in group
            if a != b
        )
        if least > best:
            best, chosen = least, (excitation, run)
    names = _names(rivals)
    if chosen is None or best < ENOUGH:
        return (
            f"{names} predict the same friction in every motion within the limits, once each is "
            "fitted: no such run would part them"
        )
    excitation, run = chosen
    sigma = float(np.sqrt(best / len(run)))
    noise_n = max(model.noise_n for model in models.values())
    words = (
        f"record {excitation.words} for {limits.duration_s:g} s: there {names} differ by "
        f"{sigma * noise_n:.2g} N RMS after a new fit, {sigma:.2g} times the noise"
    )
    return Experiment(words, run, sigma * noise_n, sigma, best)


class _Model:
    """A rival: its solution, and what the runs at hand already know of its parameters."""

    def __init__(self, search: Search, effects: tuple[str, ...]) -> None:
        self.problem: Problem = search.problem(effects)
        self.solution: Solution = search.solve(frozenset(effects))
        r, j = self.problem.on(self.solution.campaign).stacked(
            self.solution.residuals, self.solution.jacobian, self.solution.noise
        )
        self.noise_n = float(np.sqrt(r @ r / max(len(r) - j.shape[1], 1)))
        self.known: Array = np.asarray(np.linalg.qr(j, mode="r"), dtype=np.float64)

    def at(self, motion: _core.Motion) -> tuple[Array, Array]:
        """Friction, N, and its derivatives by the search's variables, under a motion."""
        values = self.solution.values
        ((friction, slopes),) = self.problem.chain.jacobian(values, [motion], self.problem.open)
        scale = np.where(self.problem.log, values, 1.0)[self.problem.open]
        return friction, slopes * scale

    def evidence(
        self, own: tuple[Array, Array], truth: tuple[Array, Array], step_s: float
    ) -> float:
        """What is left, in squares of the noise, of another model's friction when this one is
        fitted to it and to the old runs."""
        noise = self.solution.noise
        gap = noise.innovations(truth[0] - own[0], step_s)
        slopes = noise.innovations(own[1], step_s)
        design = np.concatenate([slopes, self.known])
        target = np.concatenate([gap, np.zeros(len(self.known))])
        size = np.linalg.norm(design, axis=0)
        design = design[:, size > 0.0] / size[size > 0.0]
        step, *_ = np.linalg.lstsq(design, target, rcond=1e-10)
        left = target - design @ step
        return float(left @ left) / max(self.noise_n, 1e-300) ** 2


def _run(search: Search, excitation: Excitation, step_s: float) -> Run:
    campaign = search.campaign
    velocity = excitation.velocity_m_s
    time = np.arange(len(velocity)) * step_s
    path = np.concatenate(([0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * step_s)))
    linear = any(p.run.position_m is not None for p in campaign.prepared)
    bearing = campaign.rig.bearing
    radius = 1.0 if bearing is None else bearing.radius_m
    place = {"position_m": path} if linear else {"angle_rad": path / radius}
    load_n = excitation.load_n or core_load_n(campaign.rig)
    load = None if load_n is None else np.full(len(time), load_n)
    return Run.from_arrays(time, velocity, load_n=load, name="next", **place)


def _names(rivals: Sequence[Sequence[tuple[str, ...]]]) -> str:
    groups = []
    for group in rivals:
        shared = set.intersection(*(set(effects) for effects in group))
        own = [" + ".join(e for e in effects if e not in shared) for effects in group]
        groups.append(" and ".join(name or "nothing more" for name in own))
    return "; ".join(groups)
