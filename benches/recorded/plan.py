"""Plan of the simulated campaigns, each defined by a seed, hidden effects and artefacts.

A round has every artefact at each strength, and a dozen recordings with two or three artefacts.
Each of these occurs without, with one and with two hidden effects. Effects rotate, so that each
occurs about equally often.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from rigsim import BY_THERMOMETER, CATALOGUE
from rigsim.designs import draw_design
from rigsim.excitation import campaign
from rigsim.recording import ARTEFACTS, OFF_GRID, ONE_OF, STRENGTHS

KINDS = ("none", "single", "pair")
CLEAN = {"none": 4, "single": 12, "pair": 4}
"""Number of campaigns per round that are recorded without artefacts, by kind."""
COMBINATIONS = 12
A_ROUND = 1000
SHORT = (
    ((OFF_GRID,), ()),
    ((OFF_GRID,), ("coulomb_drag",)),
    (("quantised",), ()),
    (("spikes",), ()),
    (("spikes",), ("position_ripple",)),
    (("gaps",), ("sensor_lag",)),
    (("dropout",), ()),
    (("retared",), ("stribeck_excess",)),
    (("skew",), ()),
    (("heavy_tails",), ("presliding",)),
    (("coarse_velocity",), ()),
    (("noise_with_force",), ("thermal_thinning",)),
)
FEW_SAMPLES = 8000


@dataclass(frozen=True)
class Task:
    """A campaign to be simulated and diagnosed."""

    kind: str
    seed: int
    effects: tuple[str, ...]
    artefacts: tuple[str, ...]
    strength: str

    @property
    def key(self) -> str:
        """Unique name of the task."""
        hidden = "+".join(self.effects) or "nothing"
        return f"{'+'.join(self.artefacts)}/{self.strength}/{hidden}/{self.seed}"


def _recordings(rng: np.random.Generator) -> Iterator[tuple[str, tuple[str, ...], str]]:
    """Generate kind, artefacts and strength of each campaign of a round."""
    for kind in KINDS:
        for _ in range(CLEAN[kind]):
            yield kind, (OFF_GRID,), "-"
    for name, strength, kind in itertools.product(ARTEFACTS, STRENGTHS, KINDS):
        yield kind, (name,), strength
    names = list(ARTEFACTS)
    for i in range(COMBINATIONS):
        some: tuple[str, ...] = ()
        while not some or any(len(group & set(some)) > 1 for group in ONE_OF):
            some = tuple(rng.choice(names, 2 + i % 2, replace=False).tolist())
        for kind in KINDS:
            yield kind, some, STRENGTHS[i % len(STRENGTHS)]


def _round(number: int) -> list[Task]:
    rng = np.random.default_rng([number, 14])
    names = sorted(set(CATALOGUE) - set(BY_THERMOMETER))
    ones = itertools.cycle([(n,) for n in rng.permutation(names).tolist()])
    pairs = itertools.cycle(rng.permutation(list(itertools.combinations(names, 2))).tolist())
    planned = []
    for i, (kind, artefacts, strength) in enumerate(_recordings(rng)):
        hidden = {"none": (), "single": next(ones), "pair": tuple(next(pairs))}[kind]
        planned.append(Task(kind, A_ROUND * number + i, hidden, artefacts, strength))
    # Shuffled, so that an early stop leaves a fair sample.
    return [planned[k] for k in rng.permutation(len(planned))]


def tasks(
    kinds: tuple[str, ...], seeds: int, first_seed: int = 1, artefacts: tuple[str, ...] = ()
) -> list[Task]:
    """Return the tasks of some kinds, limited to recordings with the given artefacts, if any."""
    rounds = itertools.chain.from_iterable(_round(n) for n in range(first_seed, first_seed + seeds))
    return [
        task
        for task in rounds
        if task.kind in kinds and (not artefacts or set(task.artefacts) <= set(artefacts))
    ]


def _samples(seed: int, effects: tuple[str, ...]) -> float:
    design = draw_design(seed)
    return design.rate_hz * sum(plan.length_s for plan in campaign(design, effects, seed))


def short(first_seed: int = 1) -> list[Task]:
    """Return the tasks of a dozen small campaigns with few samples, from the first seed on."""
    seeds = itertools.count(A_ROUND * first_seed)
    planned = []
    for artefacts, effects in SHORT:
        strength = "-" if artefacts == (OFF_GRID,) else "usual"
        task = Task("single" if effects else "none", 0, effects, artefacts, strength)
        seed = next(s for s in seeds if _samples(s, effects) < FEW_SAMPLES)
        planned.append(replace(task, seed=seed))
    return planned
