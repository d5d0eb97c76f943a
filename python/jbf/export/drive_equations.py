"""Effects of the drive: the motion of the driven side from that of the encoder.

The syntax is that of `equations`.
Each function changes `motion` to the motion of the driven side at the end of a step, and
`state.direction` to the direction of the friction there, a number from -1 to 1. The acceleration
remains that of the drive, whose force contains the inertia.
"""

from __future__ import annotations

from jbf import _core
from jbf.export.memory_equations import Memory

FUNCTIONS = f'''
def drive_compliance_at(before: real, now: real, share: real) -> real:
    """Resistance at a share of a step after the last one, extrapolated linearly."""
    return max(now + (now - before) * share, 0.0)


def drive_compliance_direction(speed: real, pull: real, hold: real) -> real:
    """Direction of the friction; at rest that of the force `pull`, zero if it sticks."""
    if not speed == 0.0:
        return sign(speed)
    if abs(pull) > hold:
        return sign(pull)
    return 0.0


def drive_compliance_step(state: Out[State], motion: Out[Motion], dt_s: real):
    """Spring and damper between the encoder and the inertia of the driven side."""
    whole = min(dt_s / state.spring_step_s, 1.0)
    half = 0.5 * whole
    hold = drive_compliance_at(state.spring_level0, state.spring_level1, half)
    slope = drive_compliance_at(state.spring_slope0, state.spring_slope1, half)
    longest = {_core.DRIVE_COMPLIANCE_LONGEST_INNER_STEP!r} * sqrt(
        drive_compliance_J / drive_compliance_k)
    needed = ceil(dt_s / longest)
    steps = min(max(needed, 1.0), {_core.DRIVE_COMPLIANCE_MOST_INNER_STEPS!r})
    count: int = int(steps)
    h = dt_s * (1.0 / steps)
    inertia = drive_compliance_J * 2.0 / h
    inverse_drag = 1.0 / (inertia + drive_compliance_k * (h * 0.5) + drive_compliance_c + slope)
    change = motion.velocity - state.encoder_speed
    first = drive_compliance_c * state.encoder_speed
    linear = (drive_compliance_k * (motion.position - state.encoder_place)
              + drive_compliance_c * change)
    bend = drive_compliance_k * (change * dt_s)
    origin = state.driven_place - state.encoder_place
    ahead = origin
    speed_change = 0.0
    direction = 0.0
    for k in range(0, count):
        share = (real(k) + 0.5) * (1.0 / steps)
        pushed = first + linear * share - bend * (0.5 * share * (1.0 - share))
        pull = pushed - drive_compliance_k * ahead
        before = state.driven_speed
        direction = drive_compliance_direction(before, pull, hold)
        speed = (inertia * before + pull - hold * direction) * inverse_drag
        after = speed + speed - before
        speed_change = 0.0
        if not direction == 0.0 and after * direction >= 0.0:
            ahead += speed * h
            speed_change = after - before
            state.driven_speed = after
        elif not direction == 0.0:
            speed_change = -before
            state.driven_speed = 0.0
            if needed > steps or drive_compliance_c * h > drive_compliance_J:
                if speed * direction > 0.0:
                    ahead += speed * h
            else:
                stopping = before / (before - after)
                remaining = h - stopping * h
                ahead += before * (stopping * h * 0.5)
                direction = drive_compliance_direction(0.0, pull, hold)
                if not direction == 0.0 and remaining > 0.0:
                    drag = drive_compliance_J * 2.0 / remaining
                    drag = (drag + drive_compliance_k * (remaining * 0.5) + drive_compliance_c
                            + slope)
                    speed = (pull - hold * direction) / drag
                    ahead += speed * remaining
                    state.driven_speed = speed + speed
    if not ahead == origin:
        state.driven_place = state.encoder_place + ahead
    torque = (drive_compliance_k * (motion.position - state.driven_place)
              + drive_compliance_c * (motion.velocity - state.driven_speed))
    level = drive_compliance_at(state.spring_level0, state.spring_level1, whole)
    slope = drive_compliance_at(state.spring_slope0, state.spring_slope1, whole)
    if direction == 0.0:
        friction = min(max(torque, -level), level)
        if level > 0.0:
            direction = friction / level
    else:
        friction = level * direction + slope * state.driven_speed
    driven = (torque - friction) / drive_compliance_J
    if needed > steps or drive_compliance_c * h > drive_compliance_J:
        driven = speed_change / h
    state.encoder_place = motion.position
    state.encoder_speed = motion.velocity
    state.direction = direction
    motion.velocity = state.driven_speed
    state.spring_inertia = drive_compliance_J * (driven - motion.acceleration)
    motion.position = state.driven_place


def drive_compliance_resist(state: Out[State], level: real, slope: real, dt_s: real):
    """Store the resistance of the driven side at the end of a step, zero long at the start."""
    if dt_s > 0.0:
        state.spring_level0 = state.spring_level1
        state.spring_slope0 = state.spring_slope1
    else:
        state.spring_level0 = level
        state.spring_slope0 = slope
    state.spring_step_s = max(dt_s, {_core.DRIVE_COMPLIANCE_SHORTEST_STEP_S!r})
    state.spring_level1 = level
    state.spring_slope1 = slope


def backlash_along(state: Out[State], way: real) -> real:
    """Move the drive in the gap; return the share of its motion that the driven side follows."""
    ahead = sign(way)
    flank = ahead * (backlash_gap * 0.5)
    if not state.gap_begun and not way == 0.0:
        state.gap_begun = True
        state.gap_closed = ahead
        state.gap_place = flank
        state.gap_first = flank
    if way == 0.0 or state.gap_closed == ahead:
        return 1.0
    reached = state.gap_place + way
    beyond = (reached - flank) / way
    if beyond >= 0.0:
        state.gap_closed = ahead
        state.gap_place = flank
    else:
        state.gap_closed = 0.0
        state.gap_place = reached
    # Half a step early, so that the middle of the ramp is where the flank closes.
    early = min(backlash_gap, abs(way)) * 0.5 / abs(way)
    return min(max(beyond + early, 0.0), 1.0)


def backlash_step(state: Out[State], motion: Out[Motion], dt_s: real):
    """Backlash in the drive: the driven side rests while the drive crosses the gap."""
    v0 = state.gap_speed
    v1 = motion.velocity
    state.gap_speed = v1
    half_s = 0.5 * dt_s
    if v0 * v1 < 0.0:
        share = v0 / (v0 - v1)
        driven = backlash_along(state, v0 * share * half_s)
        driven = backlash_along(state, v1 * (1.0 - share) * half_s)
    else:
        driven = backlash_along(state, (v0 + v1) * half_s)
    if v1 == 0.0 and not state.direction == 0.0:
        if state.gap_closed == sign(state.direction):
            driven = 1.0
        else:
            driven = 0.0
    motion.velocity = v1 * driven
    motion.position = motion.position - (state.gap_place - state.gap_first)
    state.direction = state.direction * driven
'''
"""Functions of the drive effects: `EFFECT_step`."""

DRIVE: dict[str, Memory] = {
    "drive_compliance": Memory(
        {
            "driven_place": "real",
            "driven_speed": "real",
            "encoder_place": "real",
            "encoder_speed": "real",
            "spring_level0": "real",
            "spring_level1": "real",
            "spring_slope0": "real",
            "spring_slope1": "real",
            "spring_step_s": "real",
            "spring_inertia": "real",
        },
        start="""
driven_place = position
driven_speed = v
encoder_place = position
encoder_speed = v
spring_inertia = 0.0
""",
        advance="",
    ),
    "backlash": Memory(
        {
            "gap_place": "real",
            "gap_first": "real",
            "gap_speed": "real",
            "gap_closed": "real",
            "gap_begun": "bool",
        },
        start="""
gap_place = 0.0
gap_first = 0.0
gap_speed = v
gap_closed = 0.0
gap_begun = False
""",
        advance="",
    ),
}
"""States of the drive effects by name, in the order of the chain."""

INERTIA_WITH_SPRING = """
inertial = inertia_m_e * acceleration + spring_inertia
extra += inertial
transmitted += inertial
"""
"""The effect `inertia` of a drive with `drive_compliance`."""

RESIST = """
viscous = 0.0
if not v == 0.0:
    viscous = max(smooth / v, 0.0)
drive_compliance_resist(state, jump + drag, viscous, dt_s)
"""
"""Reports the resistance of the driven side to a compliant drive."""

DIRECTION = """
if dt_s <= 0.0:
    state.direction = sign(v)
direction = state.direction
"""
"""Direction of the friction of a driven side."""
