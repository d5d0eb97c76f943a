"""Generation of the motions that a rig can make, among which the next experiment is chosen."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign
from jbf.models.catalogue import find_effect
from jbf.models.chain import core_load_n, core_motion
from jbf.models.driven import Driven
from jbf.models.user_effects import COLUMNS_OF_EVERY_RUN
from jbf.records.motion.known import known_motion
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.records.run_requirements import run_on

COLUMNS = {*COLUMNS_OF_EVERY_RUN, "angle_rad", "position_m"}
"""Names of the columns that a proposed run can contain."""
MOST_SAMPLES = 6000
"""Largest number of samples of a proposed run. It enters no verdict."""
RATES_RAD_S = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Angular frequencies of sinusoidal motions, rad/s. It enters no verdict."""
SHARES = (1.0, 0.3, 0.1, 0.02)
"""Amplitudes of sinusoidal motions, as shares of the largest speed. It enters no verdict."""
STOP_SHARES = (0.4, 1.0)
"""Amplitudes of stop-and-go motions, as shares of the largest speed. It enters no verdict."""
REST_S = 8.0
"""Duration of a rest of a stop-and-go motion, s. It enters no verdict."""
USUAL_RATE_RAD_S = 2.0
"""Angular frequency of the sine that defines a default acceleration. It enters no verdict."""
REACH = 0.98
"""Share of the travel limit that a motion may cover; the rest is a margin for sampling errors."""
MOST = 1e6
"""Upper limit of any speed, acceleration or load of a rig, SI units. It only limits the input."""
LONGEST_S = 86400.0
"""Longest run that is planned, s. It only limits the input."""


@dataclass(frozen=True)
class Limits:
    """Limits of speed, load, temperature and travel of a rig; None: taken from the recorded runs.

    Attributes
    ----------
    velocity, acceleration
        Largest surface speed and acceleration, m/s and m/s^2 (rad/s and rad/s^2 for a rotary
        drive). From the runs: the largest values recorded, and at least the acceleration of a sine
        of the largest speed at 2 rad/s.
    duration_s
        Duration of the run, s.
    load_n
        Smallest and largest load on a bearing, N; the same value twice for a fixed load. From the
        runs: the recorded loads.
    temperature_c
        Lowest and highest temperature at which to record, C. From the runs: the recorded
        temperatures, where they differ.
    travel
        Largest distance between two positions of a run, in m (rad for a rotary drive). Motions
        start near the lower end, in the positive direction. From the runs: the largest distance
        recorded.

    Raises
    ------
    InputError
        A limit is not positive, or a lower limit exceeds the upper one.

    Examples
    --------
    >>> jbf.Limits(velocity=0.2, duration_s=30.0).duration_s
    30.0
    """

    velocity: float | None = None
    acceleration: float | None = None
    duration_s: float = 60.0
    load_n: tuple[float, float] | None = None
    temperature_c: tuple[float, float] | None = None
    travel: float | None = None

    def __post_init__(self) -> None:
        named = {name: getattr(self, name) for name in ("velocity", "acceleration", "travel")}
        named["duration_s"] = self.duration_s
        pairs = [(name, value) for name, value in named.items() if value is not None]
        pairs += [("load_n", value) for value in self.load_n or ()]
        checks = [
            (
                self.duration_s > LONGEST_S,
                f"duration_s = {self.duration_s:g} exceeds one day",
                f"use at most {LONGEST_S:g}",
            )
        ]
        for name, value in pairs:
            positive = np.isfinite(value) and value > 0.0
            checks.append((not positive, f"{name} = {value:g}", "must be above zero"))
            plausible = f"{name} = {value:g} is not plausible"
            checks.append((value > MOST, plausible, "give it in SI units"))
        load = self.load_n or (0.0, 0.0)
        words = f"load_n = {load[0]:g} to {load[1]:g}"
        checks.append((load[0] > load[1], words, "give the smaller load first"))
        low, high = self.temperature_c or (0.0, 0.0)
        ordered = np.isfinite([low, high]).all() and low <= high
        words = f"temperature_c = {low:g} to {high:g}"
        checks.append((not ordered, words, "give two temperatures, the lower first"))
        for bad, text, remedy in checks:
            if bad:
                raise InputError(problem=f"the limit {text}", remedy=remedy)

    def filled(self, campaign: Campaign) -> Limits:
        """Return the limits with each None replaced by the value of the recorded runs."""
        motions = [p.motion for p in campaign.prepared]
        top = self.velocity or max(float(np.max(np.abs(m.velocity))) for m in motions)
        recorded = max(float(np.quantile(np.abs(m.acceleration), 0.999)) for m in motions)
        acceleration = self.acceleration or max(recorded, USUAL_RATE_RAD_S * top)
        loads = [p.run.load_n for p in campaign.prepared if p.run.load_n is not None]
        load = self.load_n
        if load is None and campaign.has_loads and loads:
            middles = [float(np.median(values)) for values in loads]
            load = min(middles), max(middles)
        celsius = self.temperature_c
        least_k = campaign.settings.conditions.min_temperature_difference_k
        recorded_c = campaign.temperature_range_c
        if celsius is None and recorded_c is not None and recorded_c[1] - recorded_c[0] >= least_k:
            celsius = recorded_c
        travel = self.travel or campaign.travel
        return Limits(top, acceleration, self.duration_s, load, celsius, travel)


@dataclass(frozen=True)
class Excitation:
    """A motion that the rig can execute.

    Attributes
    ----------
    words
        Description of the motion.
    velocity
        Speed at equal time steps, m/s.
    load_n
        Load, N; None for the usual load.
    temperature_c
        Temperature, C; None if the temperature is not varied.
    """

    words: str
    velocity: Array
    load_n: float | None
    temperature_c: float | None = None


def excitations(limits: Limits, step_s: float, speed_unit: str = "m/s") -> Iterator[Excitation]:
    """Generate motions within the limits of a rig at a sampling interval, s; each begins at rest.

    Only the travel among the limits may be None; the path is then unlimited. The descriptions
    contain the unit of the speed.
    """
    loads = (None,) if limits.load_n is None else tuple(dict.fromkeys(limits.load_n))
    temperatures = (
        (None,) if limits.temperature_c is None else tuple(dict.fromkeys(limits.temperature_c))
    )
    top, acceleration = limits.velocity, limits.acceleration
    assert top is not None
    assert acceleration is not None
    travel = np.inf if limits.travel is None else limits.travel
    time = np.arange(0.0, limits.duration_s, step_s)
    seen = set()
    for words, velocity in _motions(time, top, acceleration, REACH * travel, speed_unit):
        if np.max(np.abs(np.diff(velocity)), initial=0.0) > 1.01 * acceleration * step_s:
            continue
        # A short travel limits the speed of several motions to the same value.
        if words in seen or not _within(path_of(velocity, step_s), travel):
            continue
        seen.add(words)
        for load, celsius in itertools.product(loads, temperatures):
            under = "" if load is None else f" under {load:.4g} N"
            at = "" if celsius is None else f", the machine constantly at {celsius:.3g} C,"
            yield Excitation(words + under + at, velocity, load, celsius)


def path_of(velocity: Array, step_s: float) -> Array:
    """Distance from the start of a motion, integrated from its speed at equal time steps."""
    mean = 0.5 * (velocity[1:] + velocity[:-1])
    path: Array = np.concatenate(([0.0], np.cumsum(mean * step_s)))
    return path


def _within(path: Array, travel: float) -> bool:
    """Whether a path that starts near the lower end of the travel stays within it."""
    return bool(np.ptp(path) <= travel and np.min(path) >= (REACH - 1.0) * travel)


def _motions(
    t: Array, top: float, acceleration: float, reach: float, unit: str
) -> Iterator[tuple[str, Array]]:
    """Generate motions over the time `t`, s, as pairs of description and velocity.

    `top` is the largest speed, and `unit` its unit in the descriptions. `reach` is the largest
    distance to cover; the speed is reduced to comply with it where that is possible.
    """
    duration = float(t[-1]) if len(t) else 0.0
    # The start lasts long enough that its acceleration is at most half of the limit.
    start = np.clip(t * 0.5 * acceleration / top, 0.0, 1.0)
    for share in SHARES:
        for w in RATES_RAD_S:
            if w * duration > 4.0 * np.pi:
                speed = _sine_speed(share * top, w, reach)
                yield _sine(speed, w, unit), speed * np.sin(w * t)
    for w in RATES_RAD_S:
        if w * duration > 4.0 * np.pi:
            name = f"a one-way sine from {0.1 * top:.3g} to {top:.3g} {unit} at {w:g} rad/s"
            yield name, top * start * (0.55 + 0.45 * np.sin(w * t))
    for share in (1.0, 0.3):
        yield f"a run at a constant {share * top:.3g} {unit}", share * top * start
        if share * top * duration > reach:
            speed = min(share * top, 0.5 * np.sqrt(reach * acceleration))
            ramp = 2.0 * speed / acceleration
            name = f"strokes at a constant {speed:.3g} {unit}, both directions"
            yield name, _strokes(t, speed, ramp, reach / speed - ramp, 0.0)
    for share in STOP_SHARES:
        speed = _stop_speed(share * top, acceleration, reach)
        yield _stops(speed, unit), _stop_and_go(t, speed, acceleration, reach)[0]
    yield from _mixed(t, top, acceleration, reach, unit)


def _sine(speed: float, w: float, unit: str) -> str:
    """Describe a sinusoidal motion of given speed amplitude and angular frequency."""
    return f"a two-way sine of {speed:.3g} {unit} at {w:g} rad/s"


def _sine_speed(speed: float, w: float, reach: float) -> float:
    """Speed amplitude, at most `speed`, of a sine of angular frequency `w` that covers `reach`."""
    return min(speed, 0.5 * reach * w)


def _stops(speed: float, unit: str) -> str:
    """Describe a stop-and-go motion of given speed."""
    return f"stop and go to {speed:.3g} {unit}, both directions, with rests of {REST_S:g} s"


def _stop_speed(speed: float, acceleration: float, reach: float) -> float:
    """Speed, at most `speed`, of a stop-and-go motion whose ramps cover at most half of `reach`."""
    return min(speed, 0.5 * reach, float(np.sqrt(0.5 * reach * acceleration / 1.05)))


def _stop_and_go(t: Array, speed: float, acceleration: float, reach: float) -> tuple[Array, float]:
    """Velocity of a stop-and-go motion, and the duration of a forward and a backward stroke, s."""
    ramp = max(1.0, 1.05 * speed / acceleration)
    hold = min(3.0, reach / speed - ramp)
    return _strokes(t, speed, ramp, hold, REST_S), 2.0 * (2.0 * ramp + hold + REST_S)


def _strokes(t: Array, speed: float, ramp: float, hold: float, rest: float) -> Array:
    """Velocity of strokes in alternating directions with a rest before each; durations in s."""
    cycle = 2.0 * ramp + hold + rest
    phase = np.mod(t, cycle)
    height = np.clip(np.minimum(phase - rest, cycle - phase) / ramp, 0.0, 1.0)
    velocity: Array = speed * height * np.where(np.mod(t, 2.0 * cycle) < cycle, 1.0, -1.0)
    return velocity


def _mixed(
    t: Array, top: float, acceleration: float, reach: float, unit: str
) -> Iterator[tuple[str, Array]]:
    """Generate sequences of stop and go, a fast sine, and a fast sine of small stroke.

    Each item is a description and a velocity. Each part ends at rest, where the next part begins.
    """
    duration = float(t[-1]) if len(t) else 0.0
    # The highest rates that the acceleration limit allows.
    rates = {
        s: max((w for w in RATES_RAD_S if s * top * w <= acceleration), default=0.0) for s in SHARES
    }
    for share in STOP_SHARES:
        stop_speed = _stop_speed(share * top, acceleration, reach)
        first, after_s = _stop_and_go(t, stop_speed, acceleration, reach)
        for short in SHARES[1:]:
            # If the full amplitude is within the acceleration limit, so are smaller amplitudes.
            if not rates[1.0]:
                continue
            # Half of the remaining time, in whole half-waves.
            half_s = 0.5 * (duration - after_s)
            waves = np.floor(half_s * rates[1.0] / np.pi)
            if waves < 2.0:
                continue
            then_s = after_s + waves * np.pi / rates[1.0]
            fast, small = (_sine_speed(s * top, rates[s], reach) for s in (1.0, short))
            velocity = np.where(t < after_s, first, fast * np.sin(rates[1.0] * (t - after_s)))
            # After an odd number of half-waves, the motion is at the far end and turns back.
            last = (-1.0) ** waves * small * np.sin(rates[short] * (t - then_s))
            sines = (_sine(fast, rates[1.0], unit), _sine(small, rates[short], unit))
            parts = (_stops(stop_speed, unit), *sines)
            yield ", then ".join(parts), np.where(t < then_s, velocity, last)


def runs_to_play(
    rig: Rig, limits: Limits, step_s: float, *, linear: bool
) -> Iterator[tuple[Excitation, Run, Driven]]:
    """Generate every motion within the limits, with its run and the input of a model.

    The limits are those of the rig, without None; `step_s` is the sampling interval, s. The runs of
    a slide (`linear`) have positions in place of angles.
    """
    for excitation in excitations(limits, step_s, rig.quantities.speed):
        run = run_from_motion(rig, excitation, step_s, linear=linear)
        yield excitation, run, core_motion(rig, run, known_motion(run, rig.radius_m))


def run_from_motion(rig: Rig, excitation: Excitation, step_s: float, *, linear: bool) -> Run:
    """Convert a motion to a run, with positions of a slide (`linear`) or angles of a shaft."""
    velocity = excitation.velocity
    time = np.arange(len(velocity)) * step_s
    path = path_of(velocity, step_s)
    bearing = rig.bearing
    radius = 1.0 if bearing is None else bearing.radius_m
    load_n = excitation.load_n or core_load_n(rig)
    load = None if load_n is None else np.full(len(time), load_n)
    temperature = excitation.temperature_c
    celsius = None if temperature is None else np.full(len(time), temperature)
    run = Run.from_arrays(
        time,
        velocity,
        angle_rad=None if linear else path / radius,
        position_m=path if linear else None,
        load_n=load,
        temperature_c=celsius,
        name="next",
    )
    return run_on(rig, run)


def missing_columns(effects: Iterable[str]) -> set[str]:
    """Columns that the given effects require and that a proposed run cannot contain."""
    return {column for name in effects for column in find_effect(name).columns} - COLUMNS
