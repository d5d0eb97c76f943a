"""Rate of right diagnoses of simulated drives: `python benches/drives.py --seeds 4`.

The simulated drives have dry and viscous friction under three loads (`rigsim.axes`, which shares no
code with the library). The campaigns contain no effect, one effect of drives, two effects, an
effect that is in no catalogue, or a varying temperature with a thermometer. Six runs are diagnosed
and two more of the same drive are predicted.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import jbf
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

from rigsim import AXIS_EFFECTS, OF_TEMPERATURE, AxisRun, axis_campaign
from rigsim.foreign import FOREIGN, draw_foreign
from rigsim.warmth import Kind

KINDS = ("none", "single", "pair", "foreign", "temperature")
COMPANY = {
    "torque_proportional": ("gravity",),
    "cogging_2": ("cogging",),
    "pitch_ripple_2": ("pitch_ripple",),
}
"""Further effects without which an effect cannot be observed, with their parameters."""
SWING = 8.0
"""Ratio of the range of motion of a joint that carries its weight to that of a slide."""
WARM: tuple[tuple[tuple[str, ...], Kind], ...] = (
    ((), "wandering"),
    ((), "warming"),
    *(((name,), course) for name in OF_TEMPERATURE for course in ("wandering", "warming", "days")),
    (OF_TEMPERATURE, "wandering"),
    (("warm_up",), "wandering"),
)
"""Hidden effects and course of the temperature in campaigns with a thermometer."""
PULLEY_M = 0.05
"""Radius of the rotating part of a drive, m, for foreign effects that require an angle."""
FITTED, PREDICTED = 6, 2
NONE_A_ROUND, PAIRS_A_ROUND = 6, 8


@dataclass(frozen=True)
class Task:
    """A campaign to be simulated and diagnosed."""

    kind: str
    seed: int
    effects: tuple[str, ...] = ()
    foreign: str = ""
    temperature: Kind | None = None


@dataclass(frozen=True)
class Answer:
    """Result of the diagnosis of a campaign, with its assessment."""

    task: Task
    judged: str
    verdict: str
    named: tuple[str, ...]
    held_out: float
    cpu_s: float


def tasks(kinds: list[str], rounds: range) -> Iterator[Task]:
    """Generate the campaigns of several rounds, each with a different seed."""
    cold = [name for name in AXIS_EFFECTS if name not in OF_TEMPERATURE]
    singles = [tuple(sorted({name, *COMPANY.get(name, ())})) for name in cold]
    together = [
        tuple(sorted(pair))
        for pair in itertools.combinations(cold, 2)
        if not set(COMPANY) & set(pair)
    ]
    for number in rounds:
        rng = np.random.default_rng([number, 15])
        drawn = [together[i] for i in rng.choice(len(together), PAIRS_A_ROUND, replace=False)]
        plan = [Task("none", 0) for _ in range(NONE_A_ROUND)]
        plan += [Task("single", 0, effects) for effects in singles]
        plan += [Task("pair", 0, effects) for effects in drawn]
        # Cogging is in this catalogue.
        plan += [Task("foreign", 0, (), name) for name in FOREIGN if name != "cogging"]
        plan += [Task("temperature", 0, effects, "", course) for effects, course in WARM]
        for i, task in enumerate(plan):
            if task.kind in kinds:
                yield replace(task, seed=1000 * number + i)


def recorded(run: AxisRun, joint: bool) -> jbf.Run:
    """Convert a simulated run to a `jbf.Run`: a joint has an angle, a slide a position."""
    path = {"angle_rad" if joint else "position_m": run.path}
    made = jbf.Run.from_arrays(
        run.time_s,
        run.velocity,
        run.force_n,
        load_n=run.load_n,
        temperature_c=run.temperature_c,
        name=run.name,
        **path,
    )
    return replace(made, quantities=rig_of(joint).quantities)


def rig_of(joint: bool) -> jbf.Rig:
    """Return the rig of a joint (torque) or of a slide (force)."""
    return jbf.Rig(drive=jbf.Drive("rotary", "torque") if joint else jbf.Drive("linear", "force"))


def simulated(task: Task) -> tuple[jbf.Rig, list[jbf.Run], float]:
    """Simulate a campaign; return the rig, its runs, and the noise level, N or N m."""
    joint = "gravity" in task.effects or (task.seed % 2 == 0 and "spring" not in task.effects)
    swing = SWING if "torque_proportional" in task.effects else 1.0
    records, truth = axis_campaign(
        task.seed,
        task.effects,
        runs=FITTED + PREDICTED,
        swing=swing,
        temperature=task.temperature,
        thermometer="coarse" if task.seed % 2 else "fine",
    )
    if task.foreign:
        rng = np.random.default_rng([task.seed, 16])
        strange = draw_foreign(task.foreign, rng)
        records = [
            replace(
                r,
                force_n=strange.apply(r.time_s, r.path / PULLEY_M, r.velocity, r.force_n, rng),
            )
            for r in records
        ]
    return rig_of(joint), [recorded(r, joint) for r in records], float(str(truth["noise_n"]))


def answer(task: Task) -> Answer:
    """Simulate a campaign, diagnose it and assess the result."""
    rig, runs, noise_rms = simulated(task)
    begun = time.process_time()
    diagnosis = jbf.diagnose(rig, runs[:FITTED], law="coulomb")
    took = time.process_time() - begun
    held_out = jbf.compare(diagnosis.model, runs[FITTED:]).rms / noise_rms
    named = (*diagnosis.machine, *diagnosis.effects)
    return Answer(task, judged(task, diagnosis), diagnosis.verdict, named, held_out, took)


def judged(task: Task, diagnosis: jbf.Diagnosis) -> str:
    """Assess a diagnosis against the hidden effects of its campaign.

    The result is one of the outcomes in the columns of `table`.
    """
    if task.foreign:
        return "right" if diagnosis.verdict == "unexplained" else "not reported"
    named, true = {*diagnosis.machine, *diagnosis.effects}, set(task.effects)
    if named == true:
        right = {"adequate", "missing", "ambiguous"} if true else {"adequate"}
        return "right" if diagnosis.verdict in right else "unexplained"
    others = {name: {name, *more} for name, more in diagnosis.alternatives.items()}
    could = set().union(*others.values()) if others else set()
    if diagnosis.verdict == "ambiguous" and len(named) == len(true) and true <= could:
        return "tied"
    return "named falsely" if named - true else "missed"


def table(answers: list[Answer]) -> Iterator[str]:
    """Generate a table by kind of campaign, and a line for each campaign that is not right."""
    columns = ("right", "tied", "named falsely", "unexplained", "missed", "not reported")
    head = ("hidden", "campaigns", *columns, "held-out, median", "worst", "CPU s, worst")
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    for kind in KINDS:
        of_kind = [a for a in answers if a.task.kind == kind]
        if not of_kind:
            continue
        counts = Counter(a.judged for a in of_kind)
        held_out = [a.held_out for a in of_kind]
        numbers = " | ".join(str(counts[c]) for c in columns)
        yield (
            f"| {kind} | {len(of_kind)} | {numbers} | {np.median(held_out):.3f} | "
            f"{max(held_out):.3f} | {max(a.cpu_s for a in of_kind):.0f} |"
        )
    for a in answers:
        if a.judged != "right":
            hidden = "+".join(a.task.effects) or a.task.foreign or "nothing"
            yield f"{a.judged}: {hidden} ({a.task.seed}) -> {a.verdict} {'+'.join(a.named)}"


def main() -> int:
    """Run the study and print its table."""
    parser = argparse.ArgumentParser(prog="drives", description=__doc__.split("\n", 1)[0])
    parser.add_argument("--kinds", default=",".join(KINDS), help=f"of {', '.join(KINDS)}")
    parser.add_argument("--seeds", type=int, default=1, help="rounds of about 30 campaigns; 1")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="campaigns side by side")
    parser.add_argument("--least", type=float, metavar="SHARE", help="fail where fewer are right")
    options = parser.parse_args()
    rounds = range(options.first_seed, options.first_seed + options.seeds)
    plan = list(tasks(options.kinds.split(","), rounds))
    with ProcessPoolExecutor(options.jobs) as pool:
        answers = list(pool.map(answer, plan))
    print("\n".join(table(answers)))
    right = sum(a.judged in ("right", "tied") for a in answers) / max(len(answers), 1)
    return 1 if options.least is not None and right < options.least else 0


if __name__ == "__main__":
    sys.exit(main())
