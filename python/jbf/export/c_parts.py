"""Fragments of C for the laws and effects that the target `c` supports.

The core (`crates/jbf-core`) defines the physics. Each fragment has the operations of the core in
the same order, and the tests compare the compiled code with the core along reference motions. A
law or an effect without a fragment is refused.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CLaw:
    """Fragments of a law.

    Attributes
    ----------
    friction
        Assigns `sliding.jump` and `sliding.smooth` at the velocity `v`.
    bend
        Assigns `bent`, the force of the bristle, in a step; empty for a law without a bristle.
        `start` assigns it at the start of a run.
    helpers
        Functions that `bend` calls; `{p}` is the prefix.
    states
        Number of values in the state of the bristle.
    longest_step_s
        Longest inner step, s, as in the core (`longest_step_s` of the law or effect); zero for a
        law without memory.
    """

    friction: str
    bend: str = ""
    start: str = ""
    helpers: str = ""
    states: int = 0
    longest_step_s: float = 0.0


VISCOUS = "sliding.smooth = F_v * v;"

BRISTLE = """\
/* Relaxation of y towards a target that moves linearly from x0 to x1. */
static {p}_real {p}_relax({p}_real y, {p}_real x0, {p}_real x1, {p}_real ratio) {
  const {p}_real gain = -{EXPM1}(-ratio);
  if (ratio < R(1.0)) {
    const {p}_real lead = (ratio < R(1e-3))
        ? ratio * (R(0.5) - ratio * (R(0.16666666666666666) - ratio * R(0.041666666666666664)))
        : R(1.0) - gain / ratio;
    return y + (x0 - y) * gain + (x1 - x0) * lead;
  }
  return x1 - (x1 - x0) * (gain / ratio) + (y - x0) * (R(1.0) - gain);
}

/* Force of a bristle after sliding a distance in one direction. */
static {p}_real {p}_bent({p}_real force, const {p}_leg *leg, {p}_real stiffness) {
  {p}_real mean;
  if (leg->distance <= R(0.0)) {
    return force;
  }
  mean = {p}_max((leg->level0 + leg->level1) * R(0.5), R(1e-9));
  return {p}_relax(force, leg->level0 * leg->direction, leg->level1 * leg->direction,
                   stiffness * leg->distance / mean);
}
"""

LUGRE = (
    BRISTLE
    + """
static {p}_real {p}_damping({p}_real force, {p}_real v, {p}_real level) {
  const {p}_real share = v / v_d;
  const {p}_real rate = v - {FABS}(v) * force / {p}_max(level, R(1e-9));
  return sigma_1 * {EXP}(-share * share) * rate;
}
"""
)

DAHL = """
static {p}_real {p}_decay({p}_real u, {p}_real ratio) {
  {p}_real m, x, y, power;
  if (u < R(1e-12)) {
    return u;
  }
  m = R(1.0) - exponent;
  y = ratio * {POW}(u, -m);
  x = m * y;
  if (x >= R(1.0)) {
    return R(0.0);
  }
  if ({FABS}(x) < R(1e-3)) {
    power = y * (R(1.0) + x * (R(0.5) + x * (R(0.3333333333333333) + x * (R(0.25) + x * R(0.2)))));
  } else {
    power = -{LOG}(R(1.0) - x) / m;
  }
  return u * {EXP}(-power);
}

static {p}_real {p}_slide({p}_real force, const {p}_leg *leg) {
  {p}_real mean, ratio, lacking, left, gain, change;
  if (leg->distance <= R(0.0)) {
    return force;
  }
  mean = {p}_max((leg->level0 + leg->level1) * R(0.5), R(1e-9));
  ratio = sigma_0 * leg->distance / mean;
  if (ratio <= R(0.0)) {
    return force;
  }
  lacking = R(1.0) - leg->direction * force / mean;
  left = {p}_sign(lacking) * {p}_decay({FABS}(lacking), ratio);
  gain = -{EXPM1}(-ratio);
  change = leg->level1 - leg->level0;
  return leg->direction * (mean * (R(1.0) - left)
                           + change * (R(0.5) * (R(2.0) - gain) - gain / ratio));
}
"""

ELASTO_PLASTIC = (
    BRISTLE
    + """
static {p}_real {p}_slide({p}_real force, const {p}_leg *leg) {
  const {p}_real direction = leg->direction;
  const {p}_real plastic = sigma_0 / (R(1.0) - breakaway);
  const {p}_real gap = breakaway * leg->level0 - direction * force;
  {p}_real rise, closing, share;
  {p}_leg beyond;
  if (gap <= R(0.0)) {
    return {p}_bent(force, leg, plastic);
  }
  rise = sigma_0 * leg->distance;
  closing = rise - breakaway * (leg->level1 - leg->level0);
  if (closing <= gap) {
    return force + direction * rise;
  }
  share = gap / closing;
  beyond.direction = direction;
  beyond.distance = leg->distance * (R(1.0) - share);
  beyond.level0 = leg->level0 + (leg->level1 - leg->level0) * share;
  beyond.level1 = leg->level1;
  return {p}_bent(direction * breakaway * beyond.level0, &beyond, plastic);
}
"""
)

_SLIDE = "state->bristle[0] = {p}_slide(state->bristle[0], &leg); bent = state->bristle[0];"
_FULLY_BENT = "state->bristle[0] = magnitude * {p}_sign(v); bent = state->bristle[0];"

LAWS: dict[str, CLaw] = {
    "coulomb": CLaw(
        "sliding.jump = (state->resting && (v == R(0.0))) ? F_s : F_c; " + VISCOUS,
    ),
    "stribeck": CLaw(
        "const {p}_real still = {EXP}(-{POW}({FABS}(v) / v_s, delta));\n"
        "  sliding.jump = F_c * (R(1.0) - still) + F_s * still; " + VISCOUS,
    ),
    "lugre": CLaw(
        "const {p}_real pace = v / v_s;\n"
        "  const {p}_real still = {EXP}(-pace * pace);\n"
        "  sliding.jump = F_c * (R(1.0) - still) + F_s * still; " + VISCOUS,
        "state->bristle[0] = {p}_bent(state->bristle[0], &leg, sigma_0);\n"
        "    bent = state->bristle[0] + {p}_damping(state->bristle[0], v, magnitude);",
        "state->bristle[0] = magnitude * {p}_sign(v);\n"
        "    bent = state->bristle[0] + {p}_damping(state->bristle[0], v, magnitude);",
        LUGRE,
        1,
        0.002,
    ),
    "dahl": CLaw("sliding.jump = F_c; " + VISCOUS, _SLIDE, _FULLY_BENT, DAHL, 1, 0.02),
    "elasto_plastic": CLaw(
        "sliding.jump = F_c; " + VISCOUS, _SLIDE, _FULLY_BENT, ELASTO_PLASTIC, 1, 0.02
    ),
    "maxwell_slip": CLaw(
        "sliding.jump = F_c; " + VISCOUS,
        """\
const {p}_real displacement = leg.direction * leg.distance;
    const {p}_real level = {p}_max(leg.level1, R(0.0));
    int i;
    bent = R(0.0);
    for (i = 0; i < 16; i++) {
      const {p}_real most = spring_share[i] * level;
      {p}_real force = state->bristle[i] + spring_stiffness[i] * displacement;
      if (force > most) {
        force = most;
      } else if (force < -most) {
        force = -most;
      }
      state->bristle[i] = force;
      bent += force;
    }""",
        """\
int i;
    bent = R(0.0);
    for (i = 0; i < 16; i++) {
      state->bristle[i] = spring_share[i] * magnitude * {p}_sign(v);
      bent += state->bristle[i];
    }""",
        "",
        16,
        0.02,
    ),
}
"""Laws by name; `F_c` and the like are constants."""

PRESLIDING = CLaw(
    "",
    "state->bristle[0] = {p}_bent(state->bristle[0], &leg, presliding_sigma);\n"
    "    bent = state->bristle[0];",
    _FULLY_BENT,
    BRISTLE,
    1,
    0.01,
)
"""The effect `presliding` as a bristle of a law without one."""

_RIPPLE = """\
{{ const {{p}}_real periods = motion->position * (R(1.0) / {e}_pitch);
    const {{p}}_real turns = periods - {{ROUND}}(periods);
    const {{p}}_real angle = turns * R(6.283185307179586) - {e}_phase_rad;
    const {{p}}_real factor = R(1.0) + {e}_a * {{COS}}(angle);
    sliding.jump *= factor; sliding.smooth *= factor; }}"""

CONTACT: dict[str, str] = {
    "stribeck_excess": (
        "sliding.jump += stribeck_excess_a * {EXP}(-{POW}({FABS}(v) * (R(1.0) / "
        "stribeck_excess_v_s), stribeck_excess_n));"
    ),
    "dry_load_dependence": (
        "sliding.jump = {p}_max(sliding.jump + dry_load_dependence_mu * motion->load, R(0.0));"
    ),
    "viscous_load_dependence": ("sliding.smooth += viscous_load_dependence_c * motion->load * v;"),
    "viscous_asymmetry": "sliding.smooth += viscous_asymmetry_b * {FABS}(v);",
    "dry_temperature_dependence": (
        "sliding.jump *= {p}_max(R(1.0) + dry_temperature_dependence_a_1_k * "
        "(motion->temperature - dry_temperature_dependence_T_0_c), R(0.0));"
    ),
    "viscous_thinning": (
        "sliding.smooth = sliding.smooth / (R(1.0) + {FABS}(v) * viscous_thinning_w);"
    ),
    "dry_asymmetry": "sliding.jump *= R(1.0) + dry_asymmetry_a * {p}_sign(v);",
    "stribeck_asymmetry": (
        "sliding.jump = {p}_max(sliding.jump + stribeck_asymmetry_c * {EXP}(-{POW}({FABS}(v) * "
        "(R(1.0) / stribeck_asymmetry_v_s), stribeck_asymmetry_n)) * {p}_sign(v), R(0.0));"
    ),
    "direction_asymmetry": (
        "sliding.jump *= R(1.0) + direction_asymmetry_a * {p}_sign(v);\n"
        "  sliding.smooth *= R(1.0) + direction_asymmetry_a * {p}_sign(v);"
    ),
    "position_ripple": (
        "{ const {p}_real phase = position_ripple_theta_0_rad;\n"
        "    const {p}_real wave = {COS}(motion->position) * {COS}(phase)\n"
        "                          + {SIN}(motion->position) * {SIN}(phase);\n"
        "    const {p}_real factor = R(1.0) + position_ripple_a * wave;\n"
        "    sliding.jump *= factor; sliding.smooth *= factor; }"
    ),
    "pitch_ripple": _RIPPLE.format(e="pitch_ripple"),
    "pitch_ripple_2": _RIPPLE.format(e="pitch_ripple_2"),
}
"""Effects of the contact by name, in the order of the chain."""

_COGGING = """\
{{ const {{p}}_real periods = motion->position * (R(1.0) / {e}_pitch);
    const {{p}}_real turns = periods - {{ROUND}}(periods);
    other.smooth += {e}_A * {{SIN}}(turns * R(6.283185307179586) - {e}_phase_rad); }}"""

OTHER: dict[str, str] = {
    "coulomb_drag": "other.jump += coulomb_drag_F_d;",
    "quadratic_drag": "other.smooth += quadratic_drag_c * v * {FABS}(v);",
    "inertia": (
        "other.smooth += inertia_m_e * motion->acceleration;\n"
        "  transmitted += inertia_m_e * motion->acceleration;"
    ),
    "zero_load_dependence": "other.smooth += zero_load_dependence_k * motion->load;",
    "gravity": (
        "{ const {p}_real theta = motion->position + motion->weight_offset;\n"
        "    const {p}_real weight = gravity_G * ({SIN}(theta) * {COS}(gravity_theta_0_rad)\n"
        "                                - {COS}(theta) * {SIN}(gravity_theta_0_rad));\n"
        "    other.smooth += weight; transmitted += weight; }"
    ),
    "cogging": _COGGING.format(e="cogging"),
    "cogging_2": _COGGING.format(e="cogging_2"),
}
"""Effects next to the contact by name, in the order of the chain."""

TRANSMISSION = {
    "torque_proportional": "sliding.jump += torque_proportional_mu * {FABS}(transmitted);"
}
"""Effects of the transmitted force by name."""
