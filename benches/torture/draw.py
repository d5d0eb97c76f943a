"""Random rigs and campaigns with unrealistic properties, from independent formulas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import jbf
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Random = np.random.Generator

KINDS = ("friction", "friction", "friction", "noise", "zeros", "constant", "own model")
"""Kinds of the force in a case; most are friction, as in real recordings."""


@dataclass(frozen=True)
class Case:
    """Campaign with unrealistic properties, and its known noise.

    Attributes
    ----------
    noise_rms
        Standard deviation of the part that no model can explain, N. nan if unknown: for noise
        alone, and for a speed that jumps at every sample, which no machine has.
    """

    words: str
    rig: jbf.Rig
    runs: list[jbf.Run]
    law: str
    noise_rms: float


def _sine(t: Array, top: float, random: Random) -> Array:
    return np.asarray(top * np.sin(_turns(t, random) * t))


def _one_way(t: Array, top: float, random: Random) -> Array:
    return np.asarray(top * (0.55 + 0.45 * np.sin(_turns(t, random) * t)))


def _constant(t: Array, top: float, _random: Random) -> Array:
    return np.full(len(t), top)


def _at_rest(t: Array, _top: float, _random: Random) -> Array:
    return np.zeros(len(t))


def _jumps(t: Array, top: float, random: Random) -> Array:
    return np.asarray(top * random.choice([-1.0, -0.3, 0.0, 0.3, 1.0], len(t)))


def _wander(t: Array, top: float, random: Random) -> Array:
    path = np.cumsum(random.standard_normal(len(t)))
    return np.asarray(top * path / max(float(np.max(np.abs(path))), 1e-12))


def _strokes(t: Array, top: float, random: Random) -> Array:
    return np.asarray(top * np.clip(3.0 * np.sin(_turns(t, random) * t), -1.0, 1.0))


def _turns(t: Array, random: Random) -> float:
    """Return an angular frequency with several periods in the record, rad/s."""
    return float(2.0 * np.pi * random.uniform(0.5, 12.0) / max(t[-1], 1e-12))


MOTIONS: dict[str, Callable[[Array, float, Random], Array]] = {
    "sine": _sine,
    "one way": _one_way,
    "constant speed": _constant,
    "at rest": _at_rest,
    "jumps": _jumps,
    "random walk": _wander,
    "strokes": _strokes,
}


def friction(v: Array, top: float, force_n: float, random: Random) -> Array:
    """Return Coulomb friction, Stribeck peak and viscous friction at `v`, in random proportions."""
    dry, peak, viscous = random.dirichlet([1.0, 1.0, 1.0])
    slow = top * 10.0 ** random.uniform(-2.0, 0.0)
    level = dry + peak * np.exp(-((v / slow) ** 2))
    return np.asarray(force_n * (np.sign(v) * level + viscous * v / top))


def _rig(random: Random, force_n: float) -> jbf.Rig:
    """Draw a rig with a bearing for about the force `force_n`, or a rig without a bearing."""
    if random.random() < 0.5:
        return jbf.Rig()
    radius = 10.0 ** random.uniform(-3.0, 0.0)
    bearing = jbf.Bearing(
        radius_m=radius,
        length_m=radius * 10.0 ** random.uniform(-0.5, 0.7),
        clearance_m=radius * 10.0 ** random.uniform(-3.5, -1.5),
        mass_kg=10.0 ** random.uniform(-2.0, 2.0),
        count=int(random.integers(1, 5)),
    )
    oil = jbf.Lubricant(viscosity_pa_s=10.0 ** random.uniform(-4.0, 1.0))
    return jbf.Rig(bearing, oil, jbf.Load(normal_n=force_n * 10.0 ** random.uniform(-1.0, 2.0)))


def draw(seed: int) -> Case:
    """Draw the case of a seed."""
    random = np.random.default_rng(seed)
    force_n, top = 10.0 ** random.uniform(-3.0, 3.0, 2) * (10.0, 0.1)
    step_s = 10.0 ** random.uniform(-4.0, 0.0)
    rig = _rig(random, force_n)
    with_film = rig.bearing is not None and random.random() < 0.5
    law = "journal" if with_film else str(random.choice(["auto", "stribeck", "coulomb", "lugre"]))
    kind = str(random.choice(KINDS))
    share = float(random.choice([0.0, 0.003, 0.02, 0.3]))
    motions = random.choice(list(MOTIONS), int(random.integers(1, 5)))
    numbers: list[float] = random.dirichlet(np.ones(3)).tolist()
    shape = int(random.integers(2**31))
    runs = []
    for number, motion in enumerate(motions):
        samples = int(10.0 ** random.uniform(1.0, 3.3))
        t = step_s * np.arange(samples)
        v = MOTIONS[str(motion)](t, top, random)
        rng = np.random.default_rng(shape)
        force = {
            "friction": lambda v=v, rng=rng: friction(v, top, force_n, rng),
            "noise": lambda v=v: np.zeros(len(v)),
            "zeros": lambda v=v: np.zeros(len(v)),
            "constant": lambda v=v: np.full(len(v), force_n),
            "own model": lambda v=v: force_n * (np.sign(v) * numbers[0] + numbers[1] * v / top),
        }[kind]()
        noise = force_n * (1.0 if kind == "noise" else 0.0 if kind == "zeros" else share)
        force = force + noise * random.standard_normal(samples)
        path = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * step_s)])
        radius = None if rig.bearing is None else rig.bearing.radius_m
        place = {"position_m": path} if radius is None else {"angle_rad": path / radius}
        runs.append(
            jbf.Run.from_arrays(t, v, force, name=f"run{number}", **(place if shape % 2 else {}))
        )
    known = (
        np.nan
        if kind in ("noise", "zeros") or {*motions} & {"jumps", "random walk"}
        else share * force_n
    )
    moved = ", ".join(f"{m} ({len(r)})" for m, r in zip(motions, runs, strict=True))
    scales = f"{force_n:.1e} N, {top:.1e} m/s, {step_s:.1e} s"
    return Case(f"{kind}, {share:g} noise, {law}; {moved}; {scales}", rig, runs, law, known)
