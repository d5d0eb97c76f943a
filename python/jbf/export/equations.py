"""Equations of laws and effects for the targets without the core: C, Structured Text, Modelica.

The core (`crates/jbf-core`) defines the physics. Each text here has the operations of the core in
the same order, and the tests compare the exported forms with the core along reference motions. A
law or an effect without an entry is refused. The texts have the syntax of Python; `program`
completes them to functions, and a `Syntax` writes them in a language. Names:

- `v`, `position`, `acceleration`, `weight_offset`, `load`, `temperature`: the motion.
- `jump`, `smooth`: friction of the contact with the sign of the motion, and the rest of it.
- `drag`, `extra`, `transmitted`: the same of the effects next to the contact; transmitted force.
- `y[i]`, `level`, `bent`: forces of the bristles, the friction level, the force of all bristles.
- states of `memory_equations` by their names.
- parameters of a law by their names, parameters of an effect as `EFFECT_PARAMETER`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from jbf import _core
from jbf.models.catalogue import built_in
from jbf.models.chain import MAX_STEP_S

Value = float | tuple[float, ...]
"""Value of a constant."""


@dataclass(frozen=True)
class LawEquations:
    """Equations of a law.

    Attributes
    ----------
    friction
        Assigns `jump` and `smooth` at the velocity `v`.
    bend
        Moves the bristles along `leg`, an exact solution for a level that is linear in the
        distance; empty for a law without bristles.
    start
        Assigns the bristles at the start of a run.
    slope
        Assigns `slope[i]`, the time derivative of each bristle, for a solver of differential
        equations.
    force
        Assigns `bent`, from the bristles.
    continuous
        Whether the derivatives are continuous in bristles and speed.
    states
        Number of bristles.
    longest_step_s
        Longest inner step, s, as in the core; zero for a law without memory.
    steps_per_sample
        Number of inner steps of a sample that suffices; zero without such a number.
    constants
        Function that returns further constants by name, from the parameters of the law.
    """

    friction: str
    bend: str = ""
    start: str = "y[0] = level * sign(v)"
    slope: str = ""
    force: str = "bent = y[0]"
    continuous: bool = True
    states: int = 0
    longest_step_s: float = 0.0
    steps_per_sample: float = 0.0
    constants: Callable[[Mapping[str, float]], Mapping[str, Value]] = lambda _: {}


def _springs(parameters: Mapping[str, float]) -> Mapping[str, Value]:
    """Stiffnesses and force shares of the springs of `maxwell_slip`."""
    values = [1.0, *(parameters[name] for name in ("sigma_0", "exponent", "F_v"))]
    stiffness, share = zip(*_core.maxwell_slip_elements(values), strict=True)
    return {"spring_stiffness": stiffness, "spring_share": share}


def _logarithms(parameters: Mapping[str, float]) -> Mapping[str, Value]:
    """Logarithms of the slip distance and the reference speed of `rate_and_state`."""
    logarithms = {"log_slip": "D_c", "log_reference": "v_0"}
    return {name: math.log(parameters[of]) for name, of in logarithms.items()}


VISCOUS = "smooth = F_v * v"
_BRISTLE_SLOPE = "slope[0] = {k} * (v - abs(v) * y[0] / max(level, 1e-9))"

FUNCTIONS = '''
def sign(x: real) -> real:
    if x > 0.0:
        return 1.0
    if x < 0.0:
        return -1.0
    return 0.0


def relax(y: real, x0: real, x1: real, ratio: real) -> real:
    """Relaxation of y towards a target that moves linearly from x0 to x1."""
    gain = -expm1(-ratio)
    if ratio < 1.0:
        if ratio < 1e-3:
            lead = ratio * (0.5 - ratio * (0.16666666666666666 - ratio * 0.041666666666666664))
        else:
            lead = 1.0 - gain / ratio
        return y + (x0 - y) * gain + (x1 - x0) * lead
    return x1 - (x1 - x0) * (gain / ratio) + (y - x0) * (1.0 - gain)


def bent_along(force: real, leg: Leg, stiffness: real) -> real:
    """Force of a bristle after sliding a distance in one direction."""
    if leg.distance <= 0.0:
        return force
    mean = max((leg.level0 + leg.level1) * 0.5, 1e-9)
    return relax(force, leg.level0 * leg.direction, leg.level1 * leg.direction,
                 stiffness * leg.distance / mean)


def decay(u: real, ratio: real) -> real:
    if u < 1e-12:
        return u
    m = 1.0 - exponent
    w = ratio * u ** (-m)
    x = m * w
    if x >= 1.0:
        return 0.0
    if abs(x) < 1e-3:
        power = w * (1.0 + x * (0.5 + x * (0.3333333333333333 + x * (0.25 + x * 0.2))))
    else:
        power = -log(1.0 - x) / m
    return u * exp(-power)


def dahl_along(force: real, leg: Leg) -> real:
    """Force of the Dahl law after sliding a distance in one direction."""
    if leg.distance <= 0.0:
        return force
    mean = max((leg.level0 + leg.level1) * 0.5, 1e-9)
    ratio = sigma_0 * leg.distance / mean
    if ratio <= 0.0:
        return force
    lacking = 1.0 - leg.direction * force / mean
    remaining = sign(lacking) * decay(abs(lacking), ratio)
    gain = -expm1(-ratio)
    change = leg.level1 - leg.level0
    return leg.direction * (mean * (1.0 - remaining) + change * (0.5 * (2.0 - gain) - gain / ratio))


def elasto_plastic_along(force: real, leg: Leg) -> real:
    """Force of the elasto-plastic law after sliding a distance in one direction."""
    plastic = sigma_0 / (1.0 - breakaway)
    gap = breakaway * leg.level0 - leg.direction * force
    if gap <= 0.0:
        return bent_along(force, leg, plastic)
    rise = sigma_0 * leg.distance
    closing = rise - breakaway * (leg.level1 - leg.level0)
    if closing <= gap:
        return force + leg.direction * rise
    share = gap / closing
    beyond: Leg
    beyond.direction = leg.direction
    beyond.distance = leg.distance * (1.0 - share)
    beyond.level0 = leg.level0 + (leg.level1 - leg.level0) * share
    beyond.level1 = leg.level1
    return bent_along(leg.direction * breakaway * beyond.level0, beyond, plastic)
'''
"""Functions that the equations call."""

LAWS: dict[str, LawEquations] = {
    "coulomb": LawEquations(
        f"""
if resting and v == 0.0:
    jump = F_s
else:
    jump = F_c
{VISCOUS}
"""
    ),
    "stribeck": LawEquations(
        f"""
still = exp(-((abs(v) / v_s) ** delta))
jump = F_c * (1.0 - still) + F_s * still
{VISCOUS}
"""
    ),
    "lugre": LawEquations(
        f"""
pace = v / v_s
still = exp(-pace * pace)
jump = F_c * (1.0 - still) + F_s * still
{VISCOUS}
""",
        bend="y[0] = bent_along(y[0], leg, sigma_0)",
        slope=_BRISTLE_SLOPE.format(k="sigma_0"),
        force="""
share = v / v_d
rate = v - abs(v) * y[0] / max(level, 1e-9)
bent = y[0] + sigma_1 * exp(-share * share) * rate
""",
        states=1,
        longest_step_s=_core.LUGRE_LONGEST_STEP_S,
        steps_per_sample=_core.LUGRE_STEPS_PER_SAMPLE,
    ),
    "dahl": LawEquations(
        f"jump = F_c\n{VISCOUS}",
        bend="y[0] = dahl_along(y[0], leg)",
        slope="""
lacking = 1.0 - sign(v) * y[0] / max(level, 1e-9)
slope[0] = sigma_0 * v * sign(lacking) * abs(lacking) ** exponent
""",
        states=1,
        longest_step_s=MAX_STEP_S,
    ),
    "elasto_plastic": LawEquations(
        f"jump = F_c\n{VISCOUS}",
        bend="y[0] = elasto_plastic_along(y[0], leg)",
        slope="""
if sign(v) * y[0] < breakaway * level:
    slope[0] = sigma_0 * v
else:
    slope[0] = sigma_0 / (1.0 - breakaway) * (v - abs(v) * y[0] / max(level, 1e-9))
""",
        states=1,
        longest_step_s=MAX_STEP_S,
    ),
    "maxwell_slip": LawEquations(
        f"jump = F_c\n{VISCOUS}",
        bend="""
displacement = leg.direction * leg.distance
for i in range(16):
    most = spring_share[i] * max(leg.level1, 0.0)
    y[i] = y[i] + spring_stiffness[i] * displacement
    if y[i] > most:
        y[i] = most
    elif y[i] < -most:
        y[i] = -most
""",
        start="""
for i in range(16):
    y[i] = spring_share[i] * level * sign(v)
""",
        slope="""
for i in range(16):
    slope[i] = spring_stiffness[i] * v if sign(v) * y[i] < spring_share[i] * level else 0.0
""",
        force="bent = sum(y)",
        continuous=False,
        states=16,
        longest_step_s=MAX_STEP_S,
        constants=_springs,
    ),
    "seven_parameter": LawEquations(
        f"jump = F_c + grown * stribeck_share(late)\n{VISCOUS}",
        bend="""
spring_along(state, leg)
if v == 0.0:
    stick(state)
""",
        start="""
way = sign(v)
y[0] = level * way
""",
        continuous=False,
        states=1,
        longest_step_s=_core.SEVEN_PARAMETER_LONGEST_STEP_S,
        steps_per_sample=_core.SEVEN_PARAMETER_STEPS_PER_SAMPLE,
    ),
    "rate_and_state": LawEquations(
        f"""
if v == 0.0:
    log_speed = log_slip - log_age
else:
    log_speed = log(abs(v))
psi = F_0 + b * (log_age + log_reference - log_slip)
jump = psi + a * (log_speed - log_reference)
if jump <= a * {_core.RATE_AND_STATE_FAR_ABOVE_CREEP!r}:
    if a > 0.0:
        creep = exp(jump / a) * 0.5
        jump = a * log(creep + sqrt(creep * creep + 1.0))
    else:
        jump = 0.0
{VISCOUS}
""",
        longest_step_s=MAX_STEP_S,
        constants=_logarithms,
    ),
}
"""Laws by name."""

PRESLIDING = LawEquations(
    "",
    bend="y[0] = bent_along(y[0], leg, presliding_sigma)",
    slope=_BRISTLE_SLOPE.format(k="presliding_sigma"),
    states=1,
    longest_step_s=built_in()["presliding"].longest_step_s,
)
"""The effect `presliding` as a bristle of a law without one."""

_RIPPLE = """
periods = position * (1.0 / {e}_pitch)
turns = periods - round(periods)
factor = 1.0 + {e}_a * cos(turns * 6.283185307179586 - {e}_phase_rad)
jump *= factor
smooth *= factor
"""

CONTACT: dict[str, str] = {
    "running_in": ("jump *= 1.0 + running_in_a * exp(-(running_in_slid * (1.0 / running_in_s_0)))"),
    "dwell_stiction": """
if dwell_stiction_rest_s > 0.0:
    aged = 1.0 - exp(-((dwell_stiction_rest_s * (1.0 / dwell_stiction_t_0_s)) ** dwell_stiction_m))
    left = exp(-(dwell_stiction_slid * (1.0 / dwell_stiction_s_0)))
    jump += dwell_stiction_a * aged * left
""",
    "stribeck_excess": (
        "jump += stribeck_excess_a * exp(-((abs(v) * (1.0 / stribeck_excess_v_s)) ** "
        "stribeck_excess_n))"
    ),
    "dry_load_dependence": "jump = max(jump + dry_load_dependence_mu * load, 0.0)",
    "viscous_load_dependence": "smooth += viscous_load_dependence_c * load * v",
    "viscous_asymmetry": "smooth += viscous_asymmetry_b * abs(v)",
    "dry_temperature_dependence": (
        "jump *= max(1.0 + dry_temperature_dependence_a_1_k * "
        "(temperature - dry_temperature_dependence_T_0_c), 0.0)"
    ),
    "viscous_temperature_dependence": """
warmth = 1.0 / max(temperature - viscous_temperature_dependence_C_c, 20.0)
stated = 1.0 / max(viscous_temperature_dependence_T_0_c - viscous_temperature_dependence_C_c, 20.0)
warmth = viscous_temperature_dependence_B_k * (warmth - stated)
smooth *= exp(min(max(warmth, -7.0), 7.0))
""",
    "viscous_thinning": "smooth = smooth / (1.0 + abs(v) * viscous_thinning_w)",
    "dry_asymmetry": "jump *= 1.0 + dry_asymmetry_a * sign(v)",
    "stribeck_asymmetry": (
        "jump = max(jump + stribeck_asymmetry_c * exp(-((abs(v) * (1.0 / "
        "stribeck_asymmetry_v_s)) ** stribeck_asymmetry_n)) * sign(v), 0.0)"
    ),
    "direction_asymmetry": """
jump *= 1.0 + direction_asymmetry_a * sign(v)
smooth *= 1.0 + direction_asymmetry_a * sign(v)
""",
    "position_ripple": """
wave = (cos(position) * cos(position_ripple_theta_0_rad)
        + sin(position) * sin(position_ripple_theta_0_rad))
factor = 1.0 + position_ripple_a * wave
jump *= factor
smooth *= factor
""",
    "stroke_dependence": f"""
place = (position - stroke_dependence_x_0) * (1.0 / stroke_dependence_h)
sine = sin(min(max(place, -1.0), 1.0) * {math.pi / 2!r})
square = sine * sine
whole = 1.0 - 2.0 * square
third = sine * (3.0 - 4.0 * square)
twice = 2.0 * whole * whole - 1.0
fifth = 2.0 * whole * third - sine
sixth = whole * (2.0 * twice - 1.0)
linear = (1.0 + stroke_dependence_a_1 * sine + stroke_dependence_a_2 * whole
          + stroke_dependence_a_3 * third + stroke_dependence_a_4 * twice
          + stroke_dependence_a_5 * fifth + stroke_dependence_a_6 * sixth)
jump *= max(linear, 0.5) * (0.5 / max(1.0 - linear, 0.5))
""",
    "pitch_ripple": _RIPPLE.format(e="pitch_ripple"),
    "pitch_ripple_2": _RIPPLE.format(e="pitch_ripple_2"),
    "warm_up": """
factor = 1.0 + warm_up_a * exp(-(warm_up_elapsed_s * (1.0 / warm_up_tau_s)))
jump *= factor
smooth *= factor
""",
}
"""Effects of the contact by name, in the order of the chain."""

_COGGING = """
periods = position * (1.0 / {e}_pitch)
turns = periods - round(periods)
extra += {e}_A * sin(turns * 6.283185307179586 - {e}_phase_rad)
"""

OTHER: dict[str, str] = {
    "coulomb_drag": "drag += coulomb_drag_F_d",
    "quadratic_drag": "extra += quadratic_drag_c * v * abs(v)",
    "inertia": """
extra += inertia_m_e * acceleration
transmitted += inertia_m_e * acceleration
""",
    "zero_load_dependence": "extra += zero_load_dependence_k * load",
    "gravity": """
theta = position + weight_offset
weight = gravity_G * (sin(theta) * cos(gravity_theta_0_rad) - cos(theta) * sin(gravity_theta_0_rad))
extra += weight
transmitted += weight
""",
    "spring": "extra += spring_k * position\ntransmitted += spring_k * position",
    "cogging": _COGGING.format(e="cogging"),
    "cogging_2": _COGGING.format(e="cogging_2"),
}
"""Effects next to the contact by name, in the order of the chain."""

TRANSMISSION = {"torque_proportional": "jump += torque_proportional_mu * abs(transmitted)"}
"""Effects of the transmitted force by name."""
