"""Simulate drives, slides and joints with dry and viscous friction under varying load.

Effects can be added to the friction. Forces are closed forms of the true motion; the records
contain encoder counts and noise. `jbf` is never imported here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from .catalogue import Spread
from .instrument import BENT, through_cell
from .warmth import REFERENCE_C, Kind, Warmth, draw_warmth, read_by, thinner

Vector = npt.NDArray[np.float64]

AXIS_EFFECTS: dict[str, dict[str, Spread]] = {
    "dry_load_dependence": {"mu": Spread(0.01, 0.03, "-", 1.0)},
    "viscous_load_dependence": {"c": Spread(0.06, 0.2, "s/m", 1.0)},
    "zero_load_dependence": {"k": Spread(0.006, 0.02, "-", 1.0, signed=True)},
    "viscous_thinning": {"w": Spread(5.0, 20.0, "s/m", 1.0)},
    "viscous_asymmetry": {"b": Spread(6.0, 15.0, "N s/m", 1.0, signed=True)},
    "dry_asymmetry": {"a": Spread(0.06, 0.15, "-", 1.0, signed=True)},
    "stribeck_asymmetry": {
        "c": Spread(0.5, 1.5, "N", 1.0, signed=True),
        "v_s": Spread(0.01, 0.04, "m/s"),
        "n": Spread(1.0, 2.0, "-"),
    },
    "torque_proportional": {"mu": Spread(0.08, 0.2, "-", 1.0)},
    "gravity": {"G": Spread(0.8, 4.0, "N", 1.0), "theta_0": Spread(0.0, 2.0 * math.pi, "rad")},
    "cogging": {
        "A": Spread(0.3, 1.0, "N", 1.0),
        "pitch": Spread(0.004, 0.04, "m"),
        "phase": Spread(0.0, 2.0 * math.pi, "rad"),
    },
    "pitch_ripple": {
        "a": Spread(0.05, 0.2, "-", 1.0),
        "pitch": Spread(0.004, 0.04, "m"),
        "phase": Spread(0.0, 2.0 * math.pi, "rad"),
    },
    "cogging_2": {
        "A": Spread(0.2, 0.6, "N", 1.0),
        "pitch": Spread(0.004, 0.04, "m"),
        "phase": Spread(0.0, 2.0 * math.pi, "rad"),
    },
    "pitch_ripple_2": {
        "a": Spread(0.05, 0.12, "-", 1.0),
        "pitch": Spread(0.004, 0.04, "m"),
        "phase": Spread(0.0, 2.0 * math.pi, "rad"),
    },
    "stroke_dependence": {
        "a_1": Spread(0.04, 0.2, "-", 1.0, signed=True),
        "a_2": Spread(0.04, 0.2, "-", 1.0, signed=True),
        "a_3": Spread(0.01, 0.05, "-", 1.0, signed=True),
        "a_4": Spread(0.01, 0.05, "-", 1.0, signed=True),
        "a_5": Spread(0.01, 0.05, "-", 1.0, signed=True),
        "a_6": Spread(0.01, 0.03, "-", 1.0, signed=True),
        "x_0": Spread(0.0, 0.03, "m", signed=True),
        "h": Spread(0.2, 0.4, "m"),
    },
    "warm_up": {"a": Spread(0.08, 0.25, "-", 1.0), "tau": Spread(6.0, 20.0, "s")},
    "sensor_offset": {"b": Spread(0.3, 0.8, "N", 1.0, signed=True)},
    "sensor_hysteresis": {"w": Spread(0.3, 0.9, "N", 1.0)},
    "sensor_nonlinearity": {"c": Spread(0.8e-3, 1.6e-3, "1/N^2", 1.0, signed=True)},
    "inertia": {"m_e": Spread(3.0, 8.0, "kg", 1.0)},
    "dry_temperature_dependence": {"a": Spread(0.006, 0.015, "1/K", 1.0, signed=True)},
    "viscous_temperature_dependence": {"B": Spread(400.0, 1000.0, "K", 1.0)},
    "spring": {"k": Spread(10.0, 30.0, "N/m", 1.0, signed=True)},
}
"""Ranges of the parameters at strength 1, at which an effect is several times as large as noise."""
OF_TEMPERATURE = ("dry_temperature_dependence", "viscous_temperature_dependence")
"""Effects that can be observed only if the temperature varies."""

STEP_S = 0.01
RUN_S = 40.0
ARM_M = 1.0
"""Radius of a joint, m; with one metre, its angle (rad) equals the path (m)."""
COUNTS_PER_M = 2.0e4
LOADS_N = (60.0, 100.0, 160.0)


@dataclass(frozen=True)
class AxisRun:
    """Recorded run of a drive.

    The fields are time (s), angle (rad) or position (m), speed (m/s), force (N), load (N), and the
    temperature (C) if there is a thermometer.
    """

    name: str
    time_s: Vector
    path: Vector
    velocity: Vector
    force_n: Vector
    load_n: Vector
    temperature_c: Vector | None = None


def draw_axis(name: str, rng: np.random.Generator, strength: float = 1.0) -> dict[str, float]:
    """Draw random parameters of an effect on an axis."""
    return {key: spread.draw(rng, strength) for key, spread in AXIS_EFFECTS[name].items()}


def axis_campaign(
    seed: int,
    effects: tuple[str, ...] = (),
    *,
    strength: float = 1.0,
    runs: int = 6,
    swing: float = 1.0,
    temperature: Kind | None = None,
    thermometer: str = "fine",
    run_s: float = RUN_S,
    step_s: float = STEP_S,
) -> tuple[list[AxisRun], dict[str, object]]:
    """Simulate the runs of one drive, each under one of three loads, and return the true values.

    `swing` scales the motion: with a factor of 8 it is that of a joint, one or two radians to
    either side. The temperature varies if an effect requires this, or as specified by
    `temperature`.
    """
    rng = np.random.default_rng([seed, 77])
    hidden = {name: draw_axis(name, rng, strength) for name in effects}
    law = {"F_c": float(rng.uniform(3.0, 9.0)), "F_v": float(rng.uniform(15.0, 60.0))}
    noise_n = float(rng.uniform(0.15, 0.35))
    if temperature is None and set(effects) & set(OF_TEMPERATURE):
        temperature = "wandering"
    records = []
    # A separate random stream: the other draws do not depend on the thermometer.
    air = np.random.default_rng([seed, 78])
    for i in range(runs):
        warmth = None if temperature is None else draw_warmth(temperature, i, run_s, air)
        record = _run(i, np.arange(0.0, run_s, step_s), law, hidden, noise_n, rng, swing, warmth)
        if record.temperature_c is not None:
            celsius = read_by(thermometer, record.time_s, record.temperature_c, air)
            record = replace(record, temperature_c=celsius)
        records.append(record)
    return records, {"law": law, "effects": hidden, "noise_n": noise_n}


def _run(
    i: int,
    time: Vector,
    law: dict[str, float],
    hidden: dict[str, dict[str, float]],
    noise_n: float,
    rng: np.random.Generator,
    swing: float,
    warmth: Warmth | None,
) -> AxisRun:
    rates = 2.0 * math.pi * rng.uniform(0.05, 0.6, 3)
    sizes, phases = swing * rng.uniform(0.03, 0.09, 3), rng.uniform(0.0, 2.0 * math.pi, 3)
    waves = rates[:, None] * time + phases[:, None]
    speed = sizes @ np.sin(waves)
    acceleration = (sizes * rates) @ np.cos(waves)
    path = -(sizes / rates) @ np.cos(waves)
    load = np.full(len(time), LOADS_N[i % len(LOADS_N)])
    celsius = None if warmth is None else warmth.along(time)
    force = _force(law, hidden, speed, acceleration, path, load, time, celsius)
    return AxisRun(
        name=f"{i}_load_{load[0]:g}",
        time_s=time,
        path=np.round(path * COUNTS_PER_M) / COUNTS_PER_M,
        velocity=speed + 2e-4 * rng.standard_normal(len(time)),
        force_n=force + noise_n * rng.standard_normal(len(time)),
        load_n=load,
        temperature_c=celsius,
    )


def _force(
    law: dict[str, float],
    hidden: dict[str, dict[str, float]],
    v: Vector,
    a: Vector,
    path: Vector,
    load: Vector,
    time: Vector,
    celsius: Vector | None,
) -> Vector:
    """Force that the drive must apply for the given motion, load and temperature, N."""

    def of(effect: str, key: str) -> float:
        return hidden.get(effect, {}).get(key, 0.0)

    tau_s = hidden.get("warm_up", {}).get("tau", 1.0)
    level = law["F_c"] + of("dry_load_dependence", "mu") * load
    ahead = np.where(v > 0.0, 1.0, -1.0)
    level = level * (1.0 + of("dry_asymmetry", "a") * ahead) + ahead * _peak(hidden, v)
    level = level * _along_the_stroke(hidden, path)
    slope = law["F_v"] + of("viscous_load_dependence", "c") * load
    slope = slope + of("viscous_asymmetry", "b") * ahead
    if celsius is not None:
        level = level * (1.0 + of("dry_temperature_dependence", "a") * (celsius - REFERENCE_C))
        b_k = of("viscous_temperature_dependence", "B")
        slope = slope * np.array([thinner(b_k, c) for c in celsius.tolist()])
    # Springs in series: the straight line, and the level that limits it.
    slope = 1.0 / (1.0 / slope + of("viscous_thinning", "w") * np.abs(v) / slope)
    hangs = of("gravity", "theta_0")
    weight = of("gravity", "G") * np.sin(path / ARM_M - hangs)
    carried = weight + of("spring", "k") * path + of("inertia", "m_e") * a
    push = of("zero_load_dependence", "k") * load + of("sensor_offset", "b")
    # A gear requires more than the carried force when it drives, and returns less when driven back.
    lost = of("torque_proportional", "mu") * np.where(carried * v > 0.0, carried, -carried)
    cold = 1.0 + of("warm_up", "a") * np.exp2(-time / (math.log(2.0) * tau_s))
    place = np.ones(len(path))
    for effect in ("pitch_ripple", "pitch_ripple_2"):
        place = place * (1.0 + of(effect, "a") * _wave(hidden, effect, path, 0.25))
    for effect in ("cogging", "cogging_2"):
        push = push + of(effect, "A") * _wave(hidden, effect, path, 0.0)
    sliding = (np.sign(v) * level + slope * v) * cold * place
    force: Vector = sliding + carried + lost + push
    if any(effect in hidden for effect in BENT):
        # The zero offset arises in the amplifier, after the cell.
        zero = of("sensor_offset", "b")
        force = through_cell(force - zero, hidden) + zero
    return force


def _peak(hidden: dict[str, dict[str, float]], v: Vector) -> Vector:
    """Difference of low-speed friction in positive motion from the mean of both directions, N."""
    values = hidden.get("stribeck_asymmetry", {"c": 0.0, "v_s": 1.0, "n": 1.0})
    excess: Vector = values["c"] * np.power(math.e, -((np.abs(v) / values["v_s"]) ** values["n"]))
    return excess


def _along_the_stroke(hidden: dict[str, dict[str, float]], path: Vector) -> Vector:
    """Dry friction at each position relative to its mean along the stroke.

    The waves over the stroke are Chebyshev polynomials of the cosine of the phase of the first
    wave.
    """
    values = hidden.get("stroke_dependence")
    if values is None:
        return np.ones(len(path))
    share = np.clip((path - values["x_0"]) / values["h"], -1.0, 1.0)
    # From the upper end down: cos(k t), t from 0 to pi; the sign alternates for odd k.
    sizes = [
        0.0,
        values["a_1"],
        -values["a_2"],
        -values["a_3"],
        values["a_4"],
        values["a_5"],
        -values["a_6"],
    ]
    level: Vector = 1.0 + np.polynomial.chebyshev.chebval(
        np.cos(0.5 * math.pi * (1.0 - share)), sizes
    )
    return level


def _wave(hidden: dict[str, dict[str, float]], effect: str, path: Vector, ahead: float) -> Vector:
    """Sine over the pitch of an effect, `ahead` periods ahead of the position.

    The `phase` parameter of the effect is a lag.
    """
    values = hidden.get(effect, {"pitch": 1.0, "phase": 0.0})
    turns = path / values["pitch"] - values["phase"] / (2.0 * math.pi) + ahead
    wave: Vector = np.imag(np.exp(2j * math.pi * turns))
    return wave
