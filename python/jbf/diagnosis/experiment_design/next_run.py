"""Proposal of the next run to record.

A proposed run either discriminates between models that fit equally well, or shows effects that are
not detectable in the present runs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array, Names
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.experiment_design.excitations import (
    MOST_SAMPLES,
    Excitation,
    Limits,
    missing_columns,
    runs_to_play,
)
from jbf.diagnosis.fit_state import Fitted
from jbf.diagnosis.power.detection_limits import Power
from jbf.diagnosis.power.distinction import detection_probability
from jbf.diagnosis.power.strength import at_usual_strength
from jbf.estimation.least_squares import unexplained_square
from jbf.models.catalogue import find_effect
from jbf.models.driven import Driven
from jbf.records.run import PathLike, Run

LEAST_SAMPLES = 200
"""Smallest number of samples of a proposed run. It enters no verdict."""
NO_NOISE = 1e-100
"""Positive lower limit of the noise that avoids a division by zero."""


@dataclass(frozen=True)
class Experiment:
    """Proposed run to record next, with the expected difference between the rival models.

    Attributes
    ----------
    words
        What to record and why, in one sentence.
    run
        The motion: time, speed, angle or position, load; without friction.
    separation_n
        RMS difference between the rival models in this run after a refit of their parameters, N.
    separation_sigma
        `separation_n` in standard deviations of the noise.
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
        """Write the proposed motion as a CSV file."""
        self.run.write_csv(path)


class Rival:
    """A model to discriminate from others, and the Fisher information of the present runs."""

    def __init__(self, fitted: Fitted) -> None:
        self.problem, self.solution = fitted.problem, fitted.current_solution()
        self.predict = fitted.predict
        r, j = self.solution.stacked()
        self.noise_rms = float(np.sqrt(r @ r / max(len(r) - j.shape[1], 1)))
        self.root_information: Array = np.asarray(np.linalg.qr(j, mode="r"), dtype=np.float64)

    def separation(self, prediction: tuple[Array, Array], truth: Array, step_s: float) -> float:
        """Sum of squared differences from another model after a refit, in noise variances.

        The refit uses the new motion and the present runs (T-optimality, Atkinson & Fedorov 1975;
        here to first order). The part of the difference that the parameters of this model can
        reproduce is excluded. `prediction` is the friction of this model under the new motion and
        its derivatives (`predict`), `truth` the friction of the other model, N, and `step_s` the
        sampling interval, s.
        """
        noise = self.solution.noise
        gap = noise.innovations(truth - prediction[0], step_s)
        slopes = noise.innovations(prediction[1], step_s)
        design = np.concatenate([slopes, self.root_information])
        target = np.concatenate([gap, np.zeros(len(self.root_information))])
        return unexplained_square(design, target) / max(self.noise_rms, NO_NOISE) ** 2


def filled_limits(candidates: Candidates, limits: Limits | None) -> tuple[Limits, float]:
    """Complete the limits of a rig from its runs, and return them with a sampling interval, s."""
    filled = (limits or Limits()).filled(candidates.campaign)
    step_s = float(np.median([p.step_s for p in candidates.campaign.prepared]))
    most_s = filled.duration_s / LEAST_SAMPLES
    return filled, max(min(step_s, most_s), filled.duration_s / MOST_SAMPLES)


def travel_words(given: Limits | None, filled: Limits, unit: str) -> str:
    """Describe the travel limit of a proposed run, and whether it was recorded or given."""
    if filled.travel is None:
        return ""
    recorded = "" if given is not None and given.travel is not None else "recorded "
    return f" within the {recorded}travel of {filled.travel:.3g} {unit}"


def motions(
    candidates: Candidates, limits: Limits, step_s: float
) -> Iterator[tuple[Excitation, Run, Driven]]:
    """Generate every motion within the limits, rotary or linear like the recorded runs."""
    linear = any(p.run.position_m is not None for p in candidates.campaign.prepared)
    return runs_to_play(candidates.campaign.rig, limits, step_s, linear=linear)


Rank = tuple[float, ...]


def _best_motion(
    candidates: Candidates, limits: Limits, step_s: float, rank: Callable[[Driven], Rank]
) -> tuple[Rank, Excitation, Run, Driven] | None:
    """Motion with the largest rank, the first of equal ones; None if all ranks are zero.

    Raise `Unfinished` at the time limit.
    """
    best: tuple[Rank, Excitation, Run, Driven] | None = None
    for excitation, run, motion in motions(candidates, limits, step_s):
        candidates.campaign.work.check()
        value = rank(motion)
        if value > ((0.0,) * len(value) if best is None else best[0]):
            best = value, excitation, run, motion
    return best


def propose(
    candidates: Candidates, rivals: Sequence[Sequence[Names]], limits: Limits | None = None
) -> Experiment | str:
    """Propose the run that best discriminates between rival models, or explain why none does.

    `rivals` are groups of models, each a tuple of effects; all models of a group fit equally well.
    The default limits are those of the runs.
    """
    every = [effects for group in rivals for effects in group]
    missing = missing_columns(name for effects in every for name in effects)
    if missing:
        return f"no run can be proposed: {', '.join(sorted(missing))} cannot be simulated"
    quantities = candidates.campaign.rig.quantities
    filled, step_s = filled_limits(candidates, limits)
    models = {}
    for effects in every:
        candidates.converge(effects)
        models[effects] = Rival(candidates.fitted(effects))

    def least_separation(motion: Driven) -> Rank:
        """Smallest separation within a group of rivals, for the ranking of a motion."""
        predictions = {effects: model.predict(motion) for effects, model in models.items()}
        # The least separated pair determines whether the run discriminates between the models.
        least = min(
            models[b].separation(predictions[b], predictions[a][0], step_s)
            for group in rivals
            for a in group
            for b in group
            if a != b
        )
        return (least,)

    best = _best_motion(candidates, filled, step_s, least_separation)
    names = _names(rivals)
    if best is None or best[0][0] < candidates.policy.experiments.min_evidence:
        return (
            f"no run can be proposed: {names} predict the same friction in every "
            "motion within the limits"
        )
    (evidence,), excitation, run, _ = best
    sigma = float(np.sqrt(evidence / len(run)))
    noise_rms = max(model.noise_rms for model in models.values())
    words = (
        f"record {excitation.words} for {filled.duration_s:g} s"
        f"{travel_words(limits, filled, quantities.length)}: there the predictions of {names} "
        f"differ by {sigma * noise_rms:.2g} {quantities.force} RMS after refitting, "
        f"{sigma:.2g} times the noise"
    )
    return Experiment(words, run, sigma * noise_rms, sigma, evidence)


def _names(rivals: Sequence[Sequence[Names]]) -> str:
    """Describe the groups of rival models by the effects in which they differ."""
    groups = []
    for group in rivals:
        shared = set.intersection(*(set(effects) for effects in group))
        differing = [" + ".join(e for e in effects if e not in shared) for effects in group]
        groups.append(" and ".join(name or "no further effect" for name in differing))
    return "; ".join(groups)


def undetectable_effects(candidates: Candidates, present: Names, powers: Iterable[Power]) -> Names:
    """Candidate effects whose typical strength is below the detection limit of the present runs.

    Each of these effects is small compared with the noise, can be reproduced by the parameters of
    the law, or affects excluded samples only.
    """
    hidden = {p.effect for p in powers if p.hidden}
    return tuple(
        name
        for name in candidates.names
        if name in hidden
        and not missing_columns([name])
        # Without a transmitted load, such an effect has no influence in any motion.
        and ("transmitted" not in find_effect(name).needs or _changes(candidates, present, name))
    )


def _changes(candidates: Candidates, present: Names, name: str) -> bool:
    """Whether an effect with the catalogue's typical strength changes the predicted friction."""
    without = candidates.fitted(present).problem.predict(candidates.converge(present).values)
    richer, values = at_usual_strength(candidates, present, name)
    with_it = richer.predict(values)
    return any(bool(np.any(a != b)) for a, b in zip(with_it, without, strict=True))


def propose_detection_run(
    candidates: Candidates, present: Names, hidden: Sequence[str], limits: Limits | None = None
) -> Experiment | str:
    """Propose the run that makes most of the presently undetectable effects `hidden` detectable.

    Returns the reason if no motion within the limits shows the effects.
    """
    filled, step_s = filled_limits(candidates, limits)
    candidates.converge(present)
    base = Rival(candidates.fitted(present))
    richer = {name: at_usual_strength(candidates, present, name) for name in hidden}
    prices = {
        name: candidates.price(len(problem.open) - base.solution.free)
        for name, (problem, _) in richer.items()
    }
    settings = candidates.policy.experiments
    squares = np.array(settings.strengths) ** 2

    def evidence_in(motion: Driven) -> dict[str, float]:
        """Non-centrality of each hidden effect, at its typical strength, in a motion."""
        prediction = base.predict(motion)
        return {
            name: base.separation(prediction, problem.chain.predict(values, [motion])[0], step_s)
            for name, (problem, values) in richer.items()
        }

    def expected_detections(motion: Driven) -> Rank:
        """Expected number of detected effects in a motion, and a total log evidence for ties."""
        evidence = evidence_in(motion)
        # The strength of an effect is unknown: average over several strengths.
        chances = (
            np.mean(detection_probability(prices[name], 1, squares * evidence[name]))
            for name in hidden
        )
        return round(float(sum(chances)), 2), float(sum(np.log1p(e) for e in evidence.values()))

    listed = ", ".join(hidden)
    best = _best_motion(candidates, filled, step_s, expected_detections)
    evidence = {} if best is None else evidence_in(best[3])
    clear = {name: e for name, e in evidence.items() if e > 2.0 * settings.min_evidence}
    if best is None or not clear:
        return (
            f"{listed}: not detectable at a typical strength, neither in these runs nor in another "
            "motion within the limits of speed, acceleration and travel"
        )
    _, excitation, run, _ = best
    which = "them" if len(clear) == len(hidden) else ", ".join(clear)
    words = (
        f"{listed}: not detectable in these runs at a typical strength; record "
        f"{excitation.words} for {filled.duration_s:g} s"
        f"{travel_words(limits, filled, candidates.campaign.rig.quantities.length)}, "
        f"which would show {which}"
    )
    mean = float(np.exp(np.mean(np.log(list(clear.values())))))
    sigma = float(np.sqrt(mean / len(run)))
    return Experiment(words, run, sigma * base.noise_rms, sigma, mean)
