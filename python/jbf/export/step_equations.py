"""The step of a model from one instant to the next, in the syntax of `equations`."""

from __future__ import annotations

STEP = '''
def act(state: Out[State], motion: Motion, dt_s: real):
    """Force at a motion that is reached after dt_s; zero at the start."""
    v = motion.velocity
    if dt_s > 0.0:
        advance_memory()
    else:
        start_of_memory()
    direction_of_motion()
    drag = 0.0
    extra = 0.0
    transmitted = 0.0
    friction_of_law()
    contact()
    other()
    transmission()
    level = jump
    force_of_contact()
    state.force = bent + smooth + drag * direction + extra
    state.level = level
    state.velocity = v
    jump_of_force()
    resistance()


def towards(place: Out[Motion], before: Motion, after: Motion, fraction: real):
    """Motion between two instants with linear speed."""
    dt_s = real(after.time_s - before.time_s)
    bend = (after.velocity - before.velocity) * dt_s
    sag = 0.5 * fraction * (1.0 - fraction)
    place.time_s = before.time_s + (after.time_s - before.time_s) * time(fraction)
    place.velocity = line(before.velocity, after.velocity, fraction)
    place.acceleration = line(before.acceleration, after.acceleration, fraction)
    place.position = line(before.position, after.position, fraction) - sag * bend
    place.weight_offset = line(before.weight_offset, after.weight_offset, fraction)
    place.load = line(before.load, after.load, fraction)
    place.temperature = line(before.temperature, after.temperature, fraction)


def line(before: real, after: real, fraction: real) -> real:
    return before + (after - before) * fraction


def between(state: Out[State], before: Motion, after: Motion, sample_s: real):
    """Inner steps from one instant to another without a reversal between them."""
    dt_s = real(after.time_s - before.time_s)
    steps = inner_steps()
    count: int = int(steps)
    place: Motion
    for k in range(1, count + 1):
        towards(place, before, after, real(k) / steps)
        drive()
        act(state, place, dt_s / steps)


def usable(motion: Motion) -> bool:
    return (finite(motion.time_s) and finite(motion.velocity) and finite(motion.acceleration)
            and finite(motion.position) and finite(motion.weight_offset) and finite(motion.load)
            and finite(motion.temperature))


def start(state: Out[State], motion: Motion) -> real:
    """Set the state at the start of a motion and return the force there."""
    state.motion = motion
    state.velocity = 0.0
    state.level = 0.0
    act(state, motion, 0.0)
    return state.force


def step(state: Out[State], motion: Motion) -> real:
    """Advance the state to a later instant and return the force that resists the motion there."""
    before: Motion = state.motion
    sample_s = real(motion.time_s - before.time_s)
    if not usable(motion) or not sample_s >= 1e-12:
        return state.force
    # Friction jumps at a reversal, so a step ends there.
    if before.velocity * motion.velocity < 0.0:
        zero: Motion
        towards(zero, before, motion, before.velocity / (before.velocity - motion.velocity))
        zero.velocity = 0.0
        if real(motion.time_s - zero.time_s) >= 1e-12:
            between(state, before, zero, sample_s)
            before = zero
    between(state, before, motion, sample_s)
    state.motion = motion
    return state.force
'''
"""Functions of a step. A call of an undefined function without arguments is replaced by equations
of the model."""

BRISTLES = """
if dt_s > 0.0:
    leg: Leg
    legs()
else:
    start_of_bristles()
force_of_bristles()
"""
"""Force of a contact with bristles."""

ONE_LEG = """
leg.direction = sign(state.velocity + v)
leg.distance = abs(state.velocity + v) * (0.5 * dt_s)
leg.level0 = state.level
leg.level1 = level
bend()
"""
"""Motion of the bristles in a step without a reversal."""

LEGS = """
if state.velocity * v < 0.0:
    share = state.velocity / (state.velocity - v)
    leg.direction = sign(state.velocity)
    leg.distance = abs(state.velocity) * share * (0.5 * dt_s)
    leg.level0 = state.level
    leg.level1 = state.level + (level - state.level) * share
    bend()
    leg.direction = sign(v)
    leg.distance = abs(v) * (1.0 - share) * (0.5 * dt_s)
    leg.level0 = leg.level1
    leg.level1 = level
    bend()
else:
    one_leg()
"""
"""Motion of the bristles in a step of a driven side, which can reverse."""

RIGID = "bent = level * direction"
"""Force of a contact without bristles."""

SLOPES = '''
def slopes(state: Out[State], motion: Motion) -> real:
    """Assign the time derivatives of the bristles, and return the force that resists the motion."""
    v = motion.velocity
    direction = sign(v)
    drag = 0.0
    extra = 0.0
    transmitted = 0.0
    friction_of_law()
    contact()
    other()
    transmission()
    level = jump
    slope_of_bristles()
    force_of_bristles()
    rates()
    return bent + smooth + drag * direction + extra


def settled(state: Out[State], motion: Motion):
    """Assign the bristles at the start of a motion."""
    v = motion.velocity
    transmitted = 0.0
    friction_of_law()
    contact()
    other()
    transmission()
    level = jump
    start_of_bristles()
'''
"""Differential equation of the bristles, for a solver."""
