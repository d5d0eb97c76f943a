"""Rate of right diagnoses of simulated servo drives: `python benches/servo_diagnoses.py`.

The motions are those of closed loops, recorded by the loggers of `simulator/servosim`, which shares
no code with the library. A drive has no hidden effect, one, two, or one that no catalogue contains.
Three runs are diagnosed, and two further runs of the same drive are predicted.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import jbf
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

import servosim
from servo_study import runs_of
from servosim.hidden import EFFECTS, UNKNOWN

KINDS = ("none", "single", "pair", "unknown")
FITTED, PREDICTED = 3, 2


@dataclass(frozen=True)
class Task:
    """A campaign to be simulated and diagnosed."""

    kind: str
    seed: int
    law: str
    hidden: tuple[str, ...] = ()


@dataclass(frozen=True)
class Answer:
    """Assessed diagnosis of a campaign.

    Attributes
    ----------
    judged
        `right`, `tied`, `false name`, `unexplained`, `missed` or `not reported`.
    machine
        Whether exactly the terms of the drive itself (inertia, weight, offset) were found.
    ratio
        Held-out RMS relative to that of a fit with the true terms.
    """

    task: Task
    drawn: str
    judged: str
    machine: bool
    verdict: str
    law: str
    named: tuple[str, ...]
    residual_structure: tuple[str, ...]
    ratio: float
    cpu_s: float


def tasks(kinds: list[str], seeds: range, law: str) -> Iterator[Task]:
    """Generate one campaign of each kind per seed."""
    for seed in seeds:
        random = np.random.default_rng([seed, 5])
        single = str(random.choice(sorted(EFFECTS)))
        pair = tuple(sorted(random.choice(sorted(EFFECTS), 2, replace=False).tolist()))
        hidden = {
            "none": (),
            "single": (single,),
            "pair": pair,
            "unknown": (str(random.choice(sorted(UNKNOWN))),),
        }
        yield from (Task(kind, seed, law, hidden[kind]) for kind in kinds)


def answer(task: Task) -> Answer:
    """Simulate and diagnose a campaign; an exception becomes the result `error`."""
    try:
        return diagnosed(task)
    except Exception as error:
        words = f"{type(error).__name__}: {error}"[:200]
        return Answer(task, words, "error", False, "error", task.law, (), (), float("nan"), 0.0)


def diagnosed(task: Task) -> Answer:
    """Simulate a campaign, diagnose it and assess the result."""
    campaign = servosim.simulate(task.seed, task.hidden, FITTED + PREDICTED)
    drawn = campaign.drawn
    plant, logger = drawn.plant, drawn.logger
    rig, runs = runs_of(campaign)
    begun = time.process_time()
    diagnosis = jbf.diagnose(rig, runs[:FITTED], law=task.law)
    took = time.process_time() - begun
    machine = {"inertia"}
    if plant.gravity:
        machine.add("gravity" if plant.swings else "sensor_offset")
    true = {*machine, *(name for name in task.hidden if name in EFFECTS)}
    terms = jbf.fit(rig, runs[:FITTED], sorted(true), law="coulomb")
    errors = [jbf.compare(m, runs[FITTED:]).rms for m in (diagnosis.model, terms.model)]
    words = (
        f"{drawn.kind} {logger.rate_hz:.0f} Hz {logger.stamps} {logger.speed} {logger.force} "
        f"late {logger.speed_late:+.2f} {logger.force_late:+.2f}"
    )
    return Answer(
        task,
        words,
        judged(task, true, diagnosis),
        {*diagnosis.machine} == machine,
        diagnosis.verdict,
        diagnosis.model.law,
        (*diagnosis.machine, *diagnosis.effects),
        tuple(f"{r.axis} {r.share:.2g} ({r.where[:60]})" for r in diagnosis.residual_structure),
        errors[0] / errors[1],
        took,
    )


def judged(task: Task, true: set[str], diagnosis: jbf.Diagnosis) -> str:
    """Assess a diagnosis against the simulated effects `true`.

    The result is one of the columns of `table`.
    """
    if task.kind == "unknown":
        return "right" if diagnosis.verdict == "unexplained" else "not reported"
    named = {*diagnosis.machine, *diagnosis.effects}
    if named == true:
        right = ("missing", "ambiguous") if task.hidden else ("adequate",)
        return "right" if diagnosis.verdict in right else "unexplained"
    could = {other for names in diagnosis.alternatives.values() for other in names}
    if diagnosis.verdict == "ambiguous" and len(named) == len(true) and true <= named | could:
        return "tied"
    return "false name" if named - true else "missed"


def table(answers: list[Answer]) -> Iterator[str]:
    """Generate a table with one row per kind of campaign, and the processor time of a diagnosis."""
    columns = ("right", "tied", "false name", "unexplained", "missed", "not reported", "error")
    head = ("hidden", "campaigns", *columns, "machine right", "held-out ratio, median", "worst")
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    for kind in KINDS:
        of_kind = [a for a in answers if a.task.kind == kind]
        if of_kind:
            counts = Counter(a.judged for a in of_kind)
            numbers = " | ".join(str(counts[c]) for c in columns)
            ratios = [a.ratio for a in of_kind if np.isfinite(a.ratio)] or [float("nan")]
            yield (
                f"| {kind} | {len(of_kind)} | {numbers} | {sum(a.machine for a in of_kind)} "
                f"| {np.median(ratios):.3f} | {max(ratios):.3f} |"
            )
    cpu = [a.cpu_s for a in answers]
    yield f"processor time of a diagnosis: {np.mean(cpu):.0f} s, at most {max(cpu):.0f} s"


def line(a: Answer) -> str:
    """Format the result of one campaign as a line."""
    hidden = "+".join(a.task.hidden) or "nothing"
    return (
        f"{a.task.seed} {a.judged}: {hidden} -> {a.verdict} {'+'.join(a.named)} ({a.law}) "
        f"x{a.ratio:.3f} {a.cpu_s:.0f} s [{a.drawn}] {'; '.join(a.residual_structure)}"
    )


def main() -> None:
    """Read the arguments, run the study and print it."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--kinds", default=",".join(KINDS), help=f"of {', '.join(KINDS)}")
    parser.add_argument("--first", type=int, default=1, help="first seed (default 1)")
    parser.add_argument("--count", type=int, default=5, help="seeds (default 5)")
    parser.add_argument("--law", default="coulomb", help="base law (default coulomb), or auto")
    parser.add_argument("--jobs", type=int, default=1, help="processes (default 1)")
    parser.add_argument("--json", type=Path, help="write all answers to this file")
    options = parser.parse_args()
    plan = tasks(
        options.kinds.split(","), range(options.first, options.first + options.count), options.law
    )
    answers = []
    with ProcessPoolExecutor(options.jobs) as pool:
        for result in pool.map(answer, plan):
            answers.append(result)
            print(line(result), flush=True)
    print("\n".join(table(answers)))
    if options.json is not None:
        options.json.write_text(json.dumps([asdict(a) for a in answers], indent=1))


if __name__ == "__main__":
    main()
