"""The run that would part models that fit equally well.

Each motion that the rig can make is simulated with the rival models. What counts is what is left
of their difference after the one that is wrong has been fitted again, to the old runs and the new
one together (T-optimality, Atkinson & Fedorov 1975; here to first order): parameters that make up
for a wrong effect must not be counted as evidence.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy import stats

from jbf import _core
from jbf.diagnosis.excitations import Excitation, Limits, excitations
from jbf.estimation.fit import Problem, Solution
from jbf.models.catalogue import find_effect
from jbf.models.chain import core_load_n, core_motion, imposed
from jbf.models.own_effects import ALWAYS
from jbf.records.run import PathLike, Run

if TYPE_CHECKING:
    from jbf.diagnosis.search import Search

Array = npt.NDArray[np.float64]

SIMULATED = {*ALWAYS, "angle_rad", "position_m"}
ENOUGH = 25.0
"""Expected evidence below which a run would hardly part anything."""
MOST_SAMPLES = 6000
STRENGTHS = (0.6, 1.0, 1.5)
"""What an effect may be of its usual strength."""


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
    limits, step_s = _filled(search, limits)
    models = {
        effects: _Model(search.problem(effects), search.solve(frozenset(effects)))
        for effects in every
    }
    best, chosen = 0.0, None
    for excitation, run, motion in _motions(search, limits, step_s):
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

    def __init__(self, problem: Problem, solution: Solution) -> None:
        self.problem, self.solution = problem, solution
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


def _filled(search: Search, limits: Limits | None) -> tuple[Limits, float]:
    """Limits without gaps, and the step of a run to be proposed, s."""
    filled = (limits or Limits()).filled(search.campaign)
    step_s = float(np.median([p.step_s for p in search.campaign.prepared]))
    return filled, max(step_s, filled.duration_s / MOST_SAMPLES)


def _motions(
    search: Search, limits: Limits, step_s: float
) -> Iterator[tuple[Excitation, Run, _core.Motion]]:
    rig = search.campaign.rig
    for excitation in excitations(limits, step_s):
        run = _run(search, excitation, step_s)
        yield excitation, run, core_motion(rig, run, imposed(rig, run))


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


def unseen(search: Search, present: tuple[str, ...]) -> tuple[str, ...]:
    """Candidates that could be at work at their usual strength and yet leave no evidence in these
    runs: what the law's own parameters can absorb, or the noise covers."""
    base = search.solve(frozenset(present))
    problem = search.problem(present).on(base.campaign)
    now = problem.predict(base.values)
    found = []
    for name in search.candidates:
        if name in present or set(find_effect(name).columns) - SIMULATED:
            continue
        richer, values = _with_usual(search, present, name)
        gaps = [a - b for a, b in zip(richer.predict(values), now, strict=True)]
        gap, slopes = problem.stacked(gaps, base.jacobian, base.noise)
        noise, _ = problem.stacked(base.residuals, base.jacobian, base.noise)
        size = np.linalg.norm(slopes, axis=0)
        design = slopes[:, size > 0.0] / size[size > 0.0]
        step, *_ = np.linalg.lstsq(design, gap, rcond=1e-10)
        left = gap - design @ step
        evidence = float(left @ left) / max(float(noise @ noise) / len(noise), 1e-300)
        if evidence < search.price(len(richer.names) - base.free):
            found.append(name)
    return tuple(found)


def propose_to_see(
    search: Search,
    present: tuple[str, ...],
    hidden: Sequence[str],
    limits: Limits | None = None,
) -> Experiment | str:
    """The run that would show most of what could hide in the runs at hand."""
    limits, step_s = _filled(search, limits)
    base = _Model(search.problem(present), search.solve(frozenset(present)))
    richer = {name: _with_usual(search, present, name) for name in hidden}
    prices = {
        name: search.price(len(problem.names) - base.solution.free)
        for name, (problem, _) in richer.items()
    }
    best: tuple[float, float] = (0.0, 0.0)
    chosen: tuple[Excitation, Run, dict[str, float]] | None = None
    for excitation, run, motion in _motions(search, limits, step_s):
        own = base.at(motion)
        shown = {
            name: base.evidence(own, (problem.chain.predict(values, [motion])[0], own[1]), step_s)
            for name, (problem, values) in richer.items()
        }
        chances = sum(_chance(shown[name], prices[name]) for name in hidden)
        rank = (round(chances, 2), sum(np.log1p(evidence) for evidence in shown.values()))
        if rank > best:
            best, chosen = rank, (excitation, run, shown)
    listed = ", ".join(hidden)
    clear = {}
    if chosen is not None:
        clear = {name: evidence for name, evidence in chosen[2].items() if evidence > 2.0 * ENOUGH}
    if chosen is None or not clear:
        return (
            f"these runs could not show {listed} at a usual strength, nor could any motion within "
            "the limits"
        )
    excitation, run, _ = chosen
    which = "them" if len(clear) == len(hidden) else ", ".join(clear)
    words = (
        f"these runs could not show {listed} at a usual strength: record {excitation.words} for "
        f"{limits.duration_s:g} s, which would show {which}"
    )
    usual = float(np.exp(np.mean(np.log(list(clear.values())))))
    sigma = float(np.sqrt(usual / len(run)))
    return Experiment(words, run, sigma * base.noise_n, sigma, usual)


def _chance(evidence: float, price: float) -> float:
    """How likely an effect is found that is worth so much evidence at its usual strength, and is
    anything from weak to strong."""
    return float(np.mean(stats.ncx2.sf(price, 1.0, np.array(STRENGTHS) ** 2 * evidence)))


def _with_usual(search: Search, present: tuple[str, ...], name: str) -> tuple[Problem, Array]:
    """A model with one effect more, at the first of its starting values."""
    base = dict(
        zip(
            search.problem(present).names,
            search.solve(frozenset(present)).values.tolist(),
            strict=True,
        )
    )
    problem = search.problem((*present, name))
    return problem, next(iter(problem.starts(base)))


def _names(rivals: Sequence[Sequence[tuple[str, ...]]]) -> str:
    groups = []
    for group in rivals:
        shared = set.intersection(*(set(effects) for effects in group))
        own = [" + ".join(e for e in effects if e not in shared) for effects in group]
        groups.append(" and ".join(name or "nothing more" for name in own))
    return "; ".join(groups)
