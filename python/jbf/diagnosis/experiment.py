"""Proposal of a run that discriminates between models with equal fits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.excitations import Limits
from jbf.diagnosis.separation import SIMULATED, Rival, filled_limits, motions
from jbf.models.catalogue import find_effect
from jbf.records.run import PathLike, Run

Names = tuple[str, ...]


@dataclass(frozen=True)
class Experiment:
    """A run to record next.

    Attributes
    ----------
    words
        What to record and why, in one sentence.
    run
        The motion to play: time, speed, angle or position, load; without friction.
    separation_n
        RMS difference between the rival models in this run after a new fit, N.
    separation_sigma
        `separation_n` in units of the noise.
    evidence
        Expected value of twice the log-likelihood ratio between the rival models.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> noise = 0.2 * np.random.default_rng(0).standard_normal(len(t))
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v + noise)
    >>> diagnosis = jbf.diagnose(jbf.Rig(), [run], law="coulomb")
    >>> diagnosis.experiment.run.duration_s > 10.0
    True
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
    candidates: Candidates, rivals: Sequence[Sequence[Names]], limits: Limits | None = None
) -> Experiment | str:
    """Propose the run that best discriminates between rival models, or return the reason for none.

    Parameters
    ----------
    candidates
        The fits of the present runs.
    rivals
        Groups of models, each a tuple of effects; all models of a group fit equally well.
    limits
        Limits of the rig.
    """
    every = [effects for group in rivals for effects in group]
    strange = {c for effects in every for e in effects for c in find_effect(e).columns} - SIMULATED
    if strange:
        return f"no run can be proposed: nobody knows what {', '.join(sorted(strange))} would be"
    limits, step_s = filled_limits(candidates, limits)
    models = {}
    for effects in every:
        candidates.converge(effects)
        models[effects] = Rival(candidates.fitted(effects))
    best, chosen = 0.0, None
    for excitation, run, motion in motions(candidates, limits, step_s):
        seen = {effects: model.at(motion) for effects, model in models.items()}
        # The least separated pair determines whether the run discriminates between the models.
        least = min(
            models[b].separation(seen[b], seen[a], step_s)
            for group in rivals
            for a in group
            for b in group
            if a != b
        )
        if least > best:
            best, chosen = least, (excitation, run)
    names = _names(rivals)
    if chosen is None or best < candidates.policy.experiments.min_evidence:
        return (
            f"{names} predict the same friction in every motion within the limits, once each is "
            "fitted: no such run would part them"
        )
    excitation, run = chosen
    sigma = float(np.sqrt(best / len(run)))
    noise_rms = max(model.noise_rms for model in models.values())
    unit = candidates.campaign.rig.quantities.force
    words = (
        f"record {excitation.words} for {limits.duration_s:g} s: there {names} differ by "
        f"{sigma * noise_rms:.2g} {unit} RMS after a new fit, {sigma:.2g} times the noise"
    )
    return Experiment(words, run, sigma * noise_rms, sigma, best)


def _names(rivals: Sequence[Sequence[Names]]) -> str:
    groups = []
    for group in rivals:
        shared = set.intersection(*(set(effects) for effects in group))
        own = [" + ".join(e for e in effects if e not in shared) for effects in group]
        groups.append(" and ".join(name or "nothing more" for name in own))
    return "; ".join(groups)
