"""Writer of a simulated campaign as the files that a user would have."""

from __future__ import annotations

from pathlib import Path

from case import Case
from plan import Task
from rigsim.recording import write_recorded


def written(task: Task, folder: Path) -> Case:
    """Simulate and write the campaign of a task and its held-out runs; return the case."""
    name = task.key.replace("/", "_")
    runs, held_out = folder / "cases" / name, folder / "heldout" / name
    strength = "usual" if task.strength == "-" else task.strength
    truth = write_recorded(runs, held_out, task.seed, task.effects, task.artefacts, strength)
    shows = truth["effect_to_noise"]
    return Case(
        task.key,
        task.effects,
        task.artefacts,
        task.strength,
        truth["noise_n"],
        str(runs),
        str(held_out),
        min(shows.values(), default=0.0),
    )
