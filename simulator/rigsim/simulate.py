"""Simulation of one run, from the commanded motion to the recorded samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .bearing import Base
from .catalogue import check
from .chain import Chain
from .drive import CompliantDrive
from .foreign import Foreign
from .instrument import BENT, FILTERS, filtered, finer, read_out, through_cell
from .lubricant import Parameters
from .motions import Motion
from .noise import Noise
from .record import Record, Vector
from .rigid import run_rigid
from .slack import behind_gap
from .warmth import Warmth


def commanded(motion: Motion, times: Vector) -> tuple[Vector, Vector]:
    """Return surface speed (m/s) and position (m) of a motion at `times` (s)."""
    speed, position = np.empty(len(times)), np.empty(len(times))
    ends = np.array([p.t1 for p in motion.pieces[:-1]])
    for i, k in enumerate(np.searchsorted(ends, times, side="right").tolist()):
        piece, t = motion.pieces[k], float(times[i])
        speed[i], position[i] = piece.speed(t), piece.position(t)
    speed[np.abs(speed) < 1e-12] = 0.0
    return speed, position


def under_load(base: Base, load_n: float, effects: Parameters) -> Base:
    """Return the rig `base` under another load (N), with the parameters that depend on the load."""
    p = effects.get("load_dependence", {"p": 0.0, "q": 0.0})
    share = load_n / base.load_n
    return replace(
        base, load_n=load_n, U_tr=base.U_tr * share ** p["p"], K0=base.K0 * share ** p["q"]
    )


def cell_force(
    base: Base,
    effects: Parameters,
    motion: Motion,
    times: Vector,
    start_angle_rad: float = 0.0,
    film_start: tuple[float, float] | None = None,
    warmth: Warmth | None = None,
) -> Vector:
    """Return the exact force (N) on the load cell at `times` (s, ascending), without offset, drift.

    A run with a `film_start` begins in motion, so the spring of a compliant drive is deflected.
    """
    if any(name in effects for name in BENT):
        # Nonlinearity and play act before the filter and the delay.
        plain = {k: v for k, v in effects.items() if k not in (*BENT, *FILTERS)}
        grid = finer(times, np.array([p.t1 for p in motion.pieces]))
        bare = cell_force(base, plain, motion, grid, start_angle_rad, film_start, warmth)
        return np.interp(times, grid, filtered(through_cell(bare, effects), grid, effects))
    radius = base.bearing.radius_m
    journal = motion
    if "backlash" in effects:
        journal = behind_gap(motion, effects["backlash"]["gap"], radius)
    # A delayed record shows the force of tau earlier; before tau it shows that of the start.
    seen = np.maximum(times - effects.get("time_delay", {}).get("tau", 0.0), 0.0)
    chain = Chain(base, effects, film_start, warmth)
    if "drive_compliance" in effects:
        drive = CompliantDrive(
            chain, effects["drive_compliance"], base.bearing.count, radius, start_angle_rad
        )
        return drive.run(journal, seen, under_way=film_start is not None)
    return run_rigid(chain, journal, seen, radius, start_angle_rad)


def simulate_run(
    base: Base,
    effects: Parameters,
    motion: Motion,
    *,
    start_angle_rad: float = 0.0,
    rate_hz: float = 50.0,
    load_n: float | None = None,
    foreign: Sequence[Foreign] = (),
    noise: Noise | None = None,
    rng: np.random.Generator | None = None,
    warmth: Warmth | None = None,
) -> Record:
    """Simulate and record `motion` on the rig `base` with effects of the catalogue and others.

    `effects` contains the parameters by name, and `foreign` effects that are in no catalogue.
    `load_n` is the load of this run, or None for that of `base`. Without `noise` the record is
    exact. Noise and some foreign effects need `rng`. A `warmth` is recorded without noise.
    """
    effects = check(effects)
    rng = rng if rng is not None else np.random.default_rng(0)
    times = np.arange(round(motion.duration_s * rate_hz) + 1) / rate_hz
    times = times[times <= motion.duration_s + 1e-9]
    if load_n is not None:
        base = under_load(base, load_n, effects)
    radius = base.bearing.radius_m
    force = cell_force(base, effects, motion, times, start_angle_rad, warmth=warmth)
    clean = read_out(force, times, effects)
    speed, position = commanded(motion, times)
    angle = start_angle_rad + position / radius
    for strange in foreign:
        clean = strange.apply(times, angle, speed, clean, rng)
    friction, velocity = clean, speed
    if noise is not None:
        friction = noise.friction(clean, 1.0 / rate_hz, rng)
        velocity = noise.velocity(speed, rng)
        angle = noise.angle(angle)
    load = np.full(len(times), base.load_n)
    celsius = None if warmth is None else warmth.along(times)
    return Record(times, angle, velocity, friction, load, clean, celsius)
