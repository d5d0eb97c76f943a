"""Campaigns drawn from a seed: a drive, its motions and its logger."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from servosim.controllers import KINDS, Demand, control_of
from servosim.hidden import EFFECTS, UNKNOWN, Scale, Together
from servosim.logger import FORCES, SPEEDS, STAMPS, Logger, Recorded, record
from servosim.plant import Plant, run

Record = Recorded
RUNS = 3
RATES_HZ = (100.0, 200.0, 250.0, 500.0, 1000.0)


@dataclass(frozen=True)
class Drawn:
    """Drive, kind of motion, logger and durations, drawn from a seed.

    Attributes
    ----------
    rotary
        True: angles and torques. False: positions and forces.
    kind
        Kind of motion of all runs.
    plant, logger
        The drive and its logger.
    tick_s
        Period of the controller, s.
    duration_s
        Duration of each run, s.
    """

    rotary: bool
    kind: str
    plant: Plant
    logger: Logger
    demand: Demand
    tick_s: float
    duration_s: float


@dataclass(frozen=True)
class Campaign:
    """Simulated campaign: the drive with its logger, and the records of its runs."""

    drawn: Drawn
    records: list[Recorded]

    def truth(self) -> dict[str, Any]:
        """Return the drawn quantities and the hidden effects as numbers and strings, for JSON."""
        hidden = {part.name: asdict(part) for part in self.drawn.plant.hidden.parts}
        return {**asdict(self.drawn), "hidden": hidden}


def draw(seed: int, hidden: Sequence[str] = ()) -> Drawn:
    """Draw a drive, a kind of motion and a logger; hidden effects use a separate random stream."""
    random = np.random.default_rng([seed, 1])
    rotary = bool(random.random() < 0.6)
    kind = KINDS[int(random.integers(len(KINDS)))]
    top = float(np.exp(random.uniform(np.log(1.0), np.log(10.0)))) if rotary else 0.0
    top = top or float(np.exp(random.uniform(np.log(0.05), np.log(0.5))))
    ramp = top * random.uniform(4.0, 12.0)
    inertia = float(np.exp(random.uniform(np.log(1e-2), np.log(2.0))))
    inertia *= 1.0 if rotary else 20.0
    effort = inertia * ramp
    coulomb = effort * random.uniform(0.2, 1.0)
    viscous = coulomb / top * random.uniform(0.2, 1.0)
    heavy = random.random() < 0.5
    gravity = effort * random.uniform(0.3, 1.0) if heavy else 0.0
    sizes = np.random.default_rng([seed, 3])
    scale = Scale(coulomb, viscous, top, 0.5 * top)
    known = {**EFFECTS, **UNKNOWN}
    together = Together(tuple(known[name].draw(scale, sizes) for name in sorted(hidden)))
    if "torque_proportional" in hidden and not heavy:
        gravity = effort * sizes.uniform(0.3, 1.0)
    plant = Plant(inertia, coulomb, viscous, gravity, rotary, together)
    limit = (coulomb + viscous * top + gravity + effort) * random.uniform(1.1, 2.0)
    rate = float(random.choice(RATES_HZ))
    stamps = STAMPS[int(random.integers(len(STAMPS)))]
    if stamps == "millis":
        rate = min(rate, 250.0) / 1.03
    share = random.uniform(0.02, 0.25)
    count = 2.0 * np.pi / float(random.choice([2000, 4096, 8192, 20000, 65536]))
    if not rotary:
        count = float(random.choice([1e-7, 1e-6, 5e-6]))
    scale = coulomb + viscous * top + effort
    logger = Logger(
        rate,
        stamps,
        share,
        SPEEDS[int(random.integers(len(SPEEDS)))],
        random.uniform(0.5e-3, 4e-3),
        top * random.uniform(0.002, 0.02),
        random.uniform(-1.0, 1.0) if random.random() < 0.3 else 0.0,
        random.uniform(0.0, 1.0) if random.random() < 0.3 else 0.0,
        count,
        "sensor" if kind == "hand" else FORCES[int(random.integers(len(FORCES)))],
        scale * random.uniform(0.005, 0.02),
        scale / float(random.choice([256, 1024, 4096])),
    )
    tick = float(random.choice([0.25e-3, 0.5e-3, 1e-3]))
    return Drawn(
        rotary, kind, plant, logger, Demand(top, ramp, limit), tick, random.uniform(6.0, 12.0)
    )


def simulate(seed: int, hidden: Sequence[str] = (), runs: int = RUNS) -> Campaign:
    """Simulate the campaign of a seed, with effects of `servosim.hidden` in its drive."""
    drawn = draw(seed, hidden)
    records = []
    for k in range(runs):
        random = np.random.default_rng([seed, 2, k])
        ticks = int(drawn.duration_s / drawn.tick_s)
        start = random.uniform(-0.5, 0.5) if drawn.rotary else 0.0
        control = control_of(
            drawn.kind, drawn.plant, drawn.demand, drawn.tick_s, ticks, start, random
        )
        run_rng = np.random.default_rng([seed, 4, k])
        motion = run(drawn.plant, control, drawn.tick_s, ticks, start, run_rng)
        records.append(record(drawn.logger, motion, drawn.tick_s, random))
    return Campaign(drawn, records)


def write(campaign: Campaign, folder: Path) -> None:
    """Write `rig.toml` and one CSV per run to a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    rotary = campaign.drawn.rotary
    motion, friction = ("rotary", "torque") if rotary else ("linear", "force")
    (folder / "rig.toml").write_text(f'[drive]\nmotion = "{motion}"\nfriction = "{friction}"\n')
    names = ["time_s", "angle_rad" if rotary else "position_m"]
    names += ["velocity_rad_s" if rotary else "velocity_m_s"]
    names += ["torque_n_m" if rotary else "friction_n"]
    for k, r in enumerate(campaign.records):
        columns = [r.time_s, r.position, r.velocity, r.force]
        kept = [(n, c) for n, c in zip(names, columns, strict=True) if c is not None]
        np.savetxt(
            folder / f"run_{k}.csv",
            np.column_stack([c for _, c in kept]),
            delimiter=",",
            header=",".join(n for n, _ in kept),
            comments="",
            fmt="%.9g",
        )
