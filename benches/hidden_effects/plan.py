"""Plan of the simulated campaigns, each defined by a kind, a seed and its hidden effects."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from rigsim import BY_THERMOMETER, CATALOGUE, FOREIGN

KINDS = ("single", "none", "pair", "foreign", "poor", "tied")
STRENGTHS = (0.6, 1.0, 1.5)
SLOW = ("drive_compliance", "sensor_lag", "inertia", "film_memory", "presliding")
"""Effects that are hardly observable in slow sweeps."""
ALIKE = ("coulomb_drag", "sensor_offset", "direction_asymmetry", "quadratic_drag", "time_delay")
"""Effects that are observable in runs without reversal, but may not be distinguishable."""


@dataclass(frozen=True)
class Task:
    """A campaign to be simulated and diagnosed."""

    kind: str
    seed: int
    effects: tuple[str, ...] = ()
    foreign: tuple[str, ...] = ()
    strength: float = 1.0
    coloured: bool = False
    short: bool = False

    @property
    def campaign(self) -> str:
        """Name of the standard campaign of the simulator for this task."""
        if self.kind == "poor":
            return "slow"
        if self.kind == "tied":
            return "one_way"
        # Load dependence can be observed only under several loads.
        if "load_dependence" in self.effects:
            return "loads"
        return "short" if self.short else "full"

    @property
    def hidden(self) -> str:
        """Names of the hidden effects, joined by `+`; `-` if there are none."""
        return "+".join((*self.effects, *self.foreign)) or "-"

    @property
    def key(self) -> str:
        """Unique name of the task."""
        colour = "coloured" if self.coloured else "white"
        return f"{self.kind}/{self.hidden}/{self.strength:g}/{colour}/{self.seed}"


def _kind(kind: str, seed: int) -> Iterator[Task]:
    """Generate the tasks of one kind for a seed; strength and noise colour depend on the seed."""
    coloured = seed % 2 == 1
    strength = STRENGTHS[seed % len(STRENGTHS)]
    names = sorted(set(CATALOGUE) - set(BY_THERMOMETER))
    if kind == "single":
        for i, name in enumerate(names):
            strength = STRENGTHS[(seed + i) % len(STRENGTHS)]
            yield Task(kind, 1000 * seed + i, (name,), (), strength, (seed + i) % 2 == 1)
    elif kind == "none":
        for i in range(4):
            yield Task(kind, 1000 * seed + 100 + i, coloured=i % 2 == 1)
    elif kind == "pair":
        pairs = list(itertools.combinations(names, 2))
        chosen = np.random.default_rng(seed).choice(len(pairs), 8, replace=False)
        for i, number in enumerate(chosen):
            yield Task(kind, 1000 * seed + 200 + i, pairs[number], coloured=i % 2 == 1)
    elif kind == "foreign":
        for i, name in enumerate(sorted(FOREIGN)):
            yield Task(kind, 1000 * seed + 300 + i, (), (name,), strength, coloured)
    elif kind == "poor":
        for i, name in enumerate(SLOW):
            yield Task(kind, 1000 * seed + 400 + i, (name,), coloured=coloured)
    elif kind == "tied":
        for i, name in enumerate(ALIKE):
            yield Task(kind, 1000 * seed + 500 + i, (name,), (), strength, coloured)


def tasks(
    kinds: tuple[str, ...], seeds: int, first_seed: int = 1, *, short: bool = False
) -> list[Task]:
    """Return the tasks of some kinds in the order of their seeds.

    An early stop therefore leaves a fair sample.
    """
    rounds = range(first_seed, first_seed + seeds)
    campaigns = [task for seed in rounds for kind in kinds for task in _kind(kind, seed)]
    return [replace(task, short=short) for task in campaigns]
