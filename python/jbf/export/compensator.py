"""Compensator in the exported C code: a model corrected by an observer, as in the core.

The equations are those of `jbf_core::compensator::observed` with the exported model as its model,
in the syntax of `equations`.
"""

from __future__ import annotations

import math
from dataclasses import MISSING, dataclass, fields

import numpy as np

from jbf.errors import InputError
from jbf.export.equations import Value
from jbf.records.run import PathLike
from jbf.records.toml_file import number, read_toml, refuse_unknown

ROOTS = ("compensator_start", "compensator_observe", "compensator_step", "compensator_doubts")
"""Functions that the user calls."""
LOST_RAD_S = 1e6
"""Speed above which the observer is considered divergent and restarts, as in the core."""
FINDING_OUT = 3.0
"""Time constants of the observer after which an inferred rotation without a count is doubted."""

EQUATIONS = f'''
def extra_force(motion: Motion) -> real:
    """Force of the effects next to the contact that does not jump."""
    v = motion.velocity
    extra = 0.0
    drag = 0.0
    transmitted = 0.0
    other()
    return extra


def sliding_smooth(state: State, motion: Motion) -> real:
    """Friction of the contact that does not jump."""
    v = motion.velocity
    friction_of_law()
    contact()
    return smooth


def steep_slope(c: Compensator, velocity: real) -> real:
    """Slope of the viscous friction if an explicit step would reverse the shaft, else zero."""
    place = max(abs(velocity), slow_rad_s)
    if velocity < 0.0:
        place = -place
    moving: Motion = c.model.motion
    still: Motion = c.model.motion
    moving.velocity = place
    still.velocity = 0.0
    viscous = sliding_smooth(c.model, moving) + extra_force(moving) - extra_force(still)
    slope = max(viscous * volts_per_force / place, 0.0)
    if observer_gain * slope > observer_keep:
        return slope
    return 0.0


def reaction(c: Out[Compensator]):
    """Friction of the model: the part with the sign of the motion, and the rest."""
    rest = c.model.force - c.model.jump * sign(c.model.velocity)
    c.jump = c.model.jump * volts_per_force
    c.smooth = rest * volts_per_force


def within(c: Out[Compensator]):
    """Limit the learned corrections."""
    c.level = min(max(c.level, -level_limit_v), level_limit_v)
    c.rest = min(max(c.rest, -rest_limit_v), rest_limit_v)


def begin(c: Out[Compensator], load: real, temperature: real):
    """Set model and observer to rest."""
    motion: Motion
    motion.time_s = time(0.0)
    motion.velocity = 0.0
    motion.acceleration = 0.0
    motion.position = 0.0
    motion.weight_offset = 0.0
    motion.load = load
    motion.temperature = temperature
    start(c.model, motion)
    reaction(c)
    c.steep = steep_slope(c, 0.0)
    c.velocity = 0.0
    c.slip = 0.0
    c.turned = 0.0
    c.friction = 0.0
    c.correction = 0.0
    c.forward = 0.0


def compensator_start(c: Out[Compensator], load: real, temperature: real):
    begin(c, load, temperature)
    c.level = start_level_v
    c.rest = start_rest_v
    within(c)


def compensator_observe(c: Out[Compensator], moved_rad: real, applied_v: real, blind: bool) -> real:
    v = c.velocity
    net = applied_v - c.smooth - c.rest
    keep = observer_keep
    gain = observer_gain
    if c.steep > 0.0 and (blind or (keep * v + gain * net) * v < 0.0):
        damping = damping_v_s_rad + c.steep
        keep = exp(-damping * input_rad_s_v)
        gain = (1.0 - keep) / damping
        net = net + c.steep * v
    push = keep * v + gain * net
    hold = gain * max(c.jump + c.level, 0.0)
    predicted = 0.0
    if push > hold:
        predicted = push - hold
    elif push < -hold:
        predicted = push + hold
    if not abs(predicted) <= {LOST_RAD_S!r}:
        predicted = 0.0
        begin(c, c.model.motion.load, c.model.motion.temperature)
        if not finite(c.level) or not finite(c.rest):
            c.level = start_level_v
            c.rest = start_rest_v
        within(c)
    if blind or not moved_rad == 0.0:
        c.turned = 0.0
    elif abs(predicted) > slow_rad_s:
        c.turned += predicted * loop_step_s
    if blind:
        c.velocity = predicted
        c.slip = 0.0
        return predicted
    ahead = (v + predicted) * (loop_step_s * 0.5)
    slip = c.slip + moved_rad - ahead
    c.slip = slip - correct_angle * slip
    c.velocity = predicted + correct_speed * slip
    c.rest += correct_rest * slip
    return c.velocity


def compensator_doubts(c: Compensator) -> bool:
    return abs(c.turned) > doubtful_rad


def compensator_step(c: Out[Compensator], loop: Loop) -> real:
    v = loop.velocity
    moving: bool = abs(v) > slow_rad_s
    if loop.may_learn and moving:
        share = learning * c.rest
        c.level += share * sign(v)
        c.rest += -share
    within(c)
    after: Motion = c.model.motion
    after.time_s = after.time_s + time(loop_step_s)
    after.acceleration = (v - after.velocity) / loop_step_s
    after.velocity = v
    after.position = loop.position
    after.load = loop.load
    after.temperature = loop.temperature
    step(c.model, after)
    reaction(c)
    if c.steep > 0.0 or abs(observer_gain * c.smooth) > observer_keep * abs(v):
        c.steep = steep_slope(c, v)
    wish = loop.reference - approach_1_s * loop.error
    asked = min(max(wish * inverse_slow, -1.0), 1.0)
    level = max(c.jump + c.level, 0.0)
    if moving and v * wish >= 0.0:
        signed_part = level * sign(v)
    else:
        signed_part = level * asked * breakaway_share
    c.friction = signed_part + c.smooth + c.rest
    c.forward = (speed_v_s_rad * loop.reference + acceleration_v_s2_rad * loop.reference_rate
                 - stiffer_v_rad * loop.error - stiffer_v_s_rad * (v - loop.reference))
    c.correction = c.level * sign(v) + c.rest
    return c.friction + c.forward
'''
"""Functions of the compensator; calls without arguments are those of `step_equations`."""


@dataclass(frozen=True)
class Compensator:
    """Settings of the compensator with a model that an observer corrects.

    They are those of `jbf_core::compensator::observed::Settings`; `jbf control tune` computes
    bandwidth, rates and limits from a model.

    Attributes
    ----------
    damping_1_s, input_rad_s2_v
        Parameters a and b of the drive, `v' = -a v + b (u - F)`.
    volts_per_force
        Voltage that corresponds to one force unit of the model, V/N or V/(N m).
    dt_s
        Time step of the control loop, s.
    bandwidth_rad_s
        Bandwidth of the observer, rad/s.
    slow_rad_s
        Speed below which the shaft counts as slow, rad/s.
    learning_1_s
        Rate at which a constant disturbance is attributed to friction, 1/s.
    level_limit_v, rest_limit_v
        Largest correction of the friction level, and largest other disturbance, V.
    approach_1_s
        Desired speed per position error, 1/s; zero in velocity control.
    breakaway
        Share of the friction level that is output while the shaft is slow.
    stiffer_v_rad, stiffer_v_s_rad
        Additional feedback of position and speed error, V/rad and V s/rad.
    law_forward_v_s_rad
        Gain of the control law from the reference speed to the output, V s/rad.
    level_v, rest_v
        Corrections that an earlier run learned, V.
    """

    damping_1_s: float
    input_rad_s2_v: float
    volts_per_force: float
    dt_s: float
    bandwidth_rad_s: float
    slow_rad_s: float
    learning_1_s: float = 0.0
    level_limit_v: float = 0.0
    rest_limit_v: float = 0.0
    approach_1_s: float = 0.0
    breakaway: float = 1.0
    stiffer_v_rad: float = 0.0
    stiffer_v_s_rad: float = 0.0
    law_forward_v_s_rad: float = 0.0
    level_v: float = 0.0
    rest_v: float = 0.0

    def __post_init__(self) -> None:
        positive = ("damping_1_s", "input_rad_s2_v", "dt_s", "bandwidth_rad_s", "slow_rad_s")
        limits = ("learning_1_s", "level_limit_v", "rest_limit_v", "approach_1_s", "breakaway")
        for field in fields(self):
            value = getattr(self, field.name)
            if not math.isfinite(value):
                raise _wrong(field.name, value, "finite")
            if field.name in (*positive, "volts_per_force") and value <= 0.0:
                raise _wrong(field.name, value, "positive")
            if field.name in limits and value < 0.0:
                raise _wrong(field.name, value, "zero or positive")
        if self.learning_1_s * self.dt_s >= 1.0:
            raise _wrong("learning_1_s", self.learning_1_s, "below 1/dt_s")

    @classmethod
    def load(cls, path: PathLike) -> Compensator:
        """Read settings from a TOML file whose keys are the names of the attributes.

        Raises
        ------
        InputError
            Names the file, the key and the correction.
        """
        content = read_toml(path)
        try:
            refuse_unknown(content, [field.name for field in fields(cls)])
            for field in fields(cls):
                if field.default is MISSING and field.name not in content:
                    raise InputError(key=field.name, problem="is missing", remedy="add it")
            return cls(**{name: number(value, name) for name, value in content.items()})
        except InputError as error:
            raise error.within(file=path) from None

    def constants(self) -> dict[str, Value]:
        """Constants of the equations by name."""
        a, b, dt_s = self.damping_1_s, self.input_rad_s2_v, self.dt_s
        fall = -math.expm1(-a * dt_s)
        keep, gain = 1.0 - fall, b / a * fall
        angle, speed, rest = observer_gains(
            keep, gain, dt_s, math.exp(-self.bandwidth_rad_s * dt_s)
        )
        wrong = (self.level_limit_v + self.rest_limit_v) * b / a + self.slow_rad_s
        return {
            "volts_per_force": self.volts_per_force,
            "observer_keep": keep,
            "observer_gain": gain,
            "damping_v_s_rad": a / b,
            "input_rad_s_v": b * dt_s,
            "correct_angle": angle,
            "correct_speed": speed,
            "correct_rest": rest,
            "learning": self.learning_1_s * dt_s,
            "level_limit_v": self.level_limit_v,
            "rest_limit_v": self.rest_limit_v,
            "slow_rad_s": self.slow_rad_s,
            "inverse_slow": 1.0 / self.slow_rad_s,
            "approach_1_s": self.approach_1_s,
            "breakaway_share": self.breakaway,
            "stiffer_v_rad": self.stiffer_v_rad,
            "stiffer_v_s_rad": self.stiffer_v_s_rad,
            "speed_v_s_rad": a / b - self.law_forward_v_s_rad,
            "acceleration_v_s2_rad": 1.0 / b,
            "doubtful_rad": FINDING_OUT * wrong / self.bandwidth_rad_s,
            "loop_step_s": dt_s,
            "start_level_v": self.level_v,
            "start_rest_v": self.rest_v,
        }


def _wrong(name: str, value: float, rule: str) -> InputError:
    problem = f"{value!r} must be {rule}"
    return InputError(key=name, problem=problem, remedy="correct the value")


def observer_gains(keep: float, gain: float, dt_s: float, p: float) -> tuple[float, float, float]:
    """Gains for angle, speed and disturbance by Ackermann's formula; two poles are at `p`.

    The third pole is at that of the plant (`keep`), or at `p` if that is faster.
    """
    half = 0.5 * dt_s
    a = np.array([[1.0, half * (1.0 + keep), -half * gain], [0.0, keep, -gain], [0.0, 0.0, 1.0]])
    observed = np.stack([np.linalg.matrix_power(a, k)[0] for k in (1, 2, 3)])
    unit = np.eye(3)
    placed = (a - p * unit) @ (a - p * unit) @ (a - min(p, keep) * unit)
    angle, speed, rest = placed @ np.linalg.solve(observed, unit[2])
    return float(angle), float(speed), float(rest)
