"""States of laws and effects that a step advances before the friction.

A law or an effect whose friction depends on the past has variables in the state of the model. Each
step advances them with the motion, and the friction reads them by their names. Bristles are not
among them: they bend under a friction that is known already. The syntax is that of `equations`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from jbf import _core

POINTS = _core.SEVEN_PARAMETER_DELAY_POINTS


@dataclass(frozen=True)
class Memory:
    """State of a law or an effect.

    Attributes
    ----------
    variables
        Types of the variables by name: `real`, `time`, `int`, `bool`, or `real[COUNT]`.
    start
        Assigns the variables at the start of a run, at the velocity `v`.
    advance
        Assigns the variables after a step of `dt_s`, in which the speed changes linearly from
        `state.velocity` to `v`.
    rates
        For a solver of differential equations: initial value and time derivative of a variable.
    fixed
        For a solver: value of a variable that has no derivative.
    """

    variables: Mapping[str, str]
    start: str
    advance: str
    rates: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    fixed: Mapping[str, str] = field(default_factory=dict)

    @property
    def solvable(self) -> bool:
        """Whether the state has a form for a solver of differential equations."""
        return bool(self.rates or self.fixed)


FUNCTIONS = f'''
def distance(state: State, v: real, dt_s: real) -> real:
    """Distance of a step in which the speed changes linearly."""
    before = state.velocity
    if before * v < 0.0:
        return 0.5 * dt_s * (before * before + v * v) / (abs(before) + abs(v))
    return 0.5 * dt_s * abs(before + v)


def append(state: Out[State], speed: real, dt_s: real):
    """Append a speed to those of the delay; steps that are too short share a point."""
    newest: int = state.past_newest
    if state.past_count > 1 and state.past_gap_s[newest] < tau_L_s / {POINTS - 4}.0:
        state.past_speed[newest] = speed
        state.past_gap_s[newest] += dt_s
    else:
        if state.past_count > 0:
            newest = newest + 1
            if newest == {POINTS}:
                newest = 0
        if state.past_count < {POINTS}:
            state.past_count = state.past_count + 1
        state.past_newest = newest
        state.past_speed[newest] = speed
        state.past_gap_s[newest] = dt_s


def delayed(state: State) -> real:
    """Speed at the time of the delay ago."""
    age = 0.0
    point: int = state.past_newest
    for i in range(1, state.past_count):
        older: int = point - 1
        if point == 0:
            older = {POINTS - 1}
        gap = state.past_gap_s[point]
        if age + gap > tau_L_s:
            share = (tau_L_s - age) / gap
            return (state.past_speed[point]
                    + (state.past_speed[older] - state.past_speed[point]) * share)
        age += gap
        point = older
    return state.past_speed[point]


def stribeck_share(speed: real) -> real:
    """Part of the Stribeck friction that remains at a speed."""
    pace = speed / v_s
    return 1.0 / (1.0 + pace * pace)


def stick(state: Out[State]):
    """Change the contact from sliding to sticking."""
    if not state.way == 0.0:
        state.way = 0.0
        state.arrival = state.grown * stribeck_share(state.late)
        state.stuck_s = 0.0


def spring_along(state: Out[State], leg: Leg):
    """Deflect the spring of a contact that sticks, until it slides."""
    if leg.direction == 0.0 or not leg.direction == state.way:
        stick(state)
    if state.way == 0.0:
        state.bristle[0] += k_t * leg.distance * leg.direction
        if not leg.direction == 0.0 and state.bristle[0] * leg.direction >= leg.level1:
            state.way = leg.direction
    if not state.way == 0.0:
        state.bristle[0] = leg.level1 * state.way


def limited_age(age_s: real) -> real:
    return min(max(age_s, {_core.RATE_AND_STATE_AGES_S[0]!r}), {_core.RATE_AND_STATE_AGES_S[1]!r})


def steady_age(speed: real) -> real:
    """Age of the contact in steady sliding; at rest that of the reference speed."""
    if speed > 0.0:
        return limited_age(D_c / speed)
    return limited_age(D_c / v_0)


def older_age(age_s: real, speed0: real, speed1: real, dt_s: real) -> real:
    """Age of the contact after a step in which the speed changes linearly."""
    p = min(speed0 * dt_s / D_c, {_core.RATE_AND_STATE_LONGEST!r})
    q = min(speed1 * dt_s / D_c, {_core.RATE_AND_STATE_LONGEST!r})
    root = sqrt((q + 3.0) * (q + 3.0) - 4.0 * (q - p))
    if q < 3.0:
        x = 2.0 * (q + q + p) / (root + 3.0 - q)
    else:
        x = (q - 3.0 + root) * 0.5
    if x < 1e-8:
        share = 1.0 - x * 0.5
    else:
        share = -expm1(-x) / x
    return limited_age(age_s * exp(-((p + q) * 0.5)) + dt_s * share)
'''
"""Functions that the equations of the states call."""

MEMORY: dict[str, Memory] = {
    "coulomb": Memory(
        {"resting": "bool"},
        start="resting = True",
        advance="resting = state.velocity == 0.0 and v == 0.0",
        fixed={"resting": "True"},
    ),
    "seven_parameter": Memory(
        {
            "way": "real",
            "arrival": "real",
            "grown": "real",
            "stuck_s": "real",
            "late": "real",
            "past_speed": f"real[{POINTS}]",
            "past_gap_s": f"real[{POINTS}]",
            "past_newest": "int",
            "past_count": "int",
        },
        start="""
way = 0.0
arrival = F_s_inf
grown = F_s_inf
stuck_s = 0.0
late = abs(v)
past_newest = 0
past_count = 0
append(state, late, 0.0)
""",
        advance="""
append(state, abs(v), dt_s)
late = delayed(state)
if way == 0.0:
    stuck_s += dt_s
    grown = arrival + (F_s_inf - arrival) * (stuck_s / (stuck_s + gamma_s))
""",
    ),
    "rate_and_state": Memory(
        {"age_s": "real", "log_age": "real"},
        start="""
age_s = steady_age(abs(v))
log_age = log(age_s)
""",
        advance="""
middle = abs(state.velocity + v) * 0.5
age_s = older_age(age_s, abs(state.velocity), middle, dt_s * 0.5)
age_s = older_age(age_s, middle, abs(v), dt_s * 0.5)
log_age = log(age_s)
""",
        rates={
            "log_age": (
                "log(D_c / (abs(v) if abs(v) > 0.0 else v_0))",
                "exp(-log_age) - abs(v) / D_c",
            )
        },
    ),
    "running_in": Memory(
        {"running_in_slid": "real"},
        start="running_in_slid = 0.0",
        advance="running_in_slid += distance(state, v, dt_s)",
        rates={"running_in_slid": ("0.0", "abs(v)")},
    ),
    "dwell_stiction": Memory(
        {
            "dwell_stiction_rests": "bool",
            "dwell_stiction_rest_s": "real",
            "dwell_stiction_slid": "real",
        },
        start="""
dwell_stiction_rests = v == 0.0
dwell_stiction_rest_s = 0.0
dwell_stiction_slid = 0.0
""",
        advance="""
if state.velocity == 0.0 and v == 0.0:
    if not dwell_stiction_rests:
        dwell_stiction_rest_s = 0.0
        dwell_stiction_slid = 0.0
        dwell_stiction_rests = True
    dwell_stiction_rest_s += dt_s
else:
    dwell_stiction_rests = False
    dwell_stiction_slid += distance(state, v, dt_s)
""",
    ),
    "warm_up": Memory(
        {"warm_up_start_s": "time", "warm_up_elapsed_s": "real"},
        start="""
warm_up_start_s = motion.time_s
warm_up_elapsed_s = 0.0
""",
        advance="warm_up_elapsed_s = real(motion.time_s - warm_up_start_s)",
        rates={"warm_up_elapsed_s": ("0.0", "1.0")},
    ),
}
"""States by the name of the law or the effect."""
