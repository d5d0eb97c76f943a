"""Names of effects, parameters and options from before version 0.1.0, accepted as aliases.

Files and arguments with an old name are accepted with a warning that states the current name.
"""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping

EFFECTS = {"inertia_leak": "inertia", "wear_in": "running_in"}

PARAMETERS = {
    "F_c_n": "F_c",
    "F_s_n": "F_s",
    "F_s_inf_n": "F_s_inf",
    "F_v_n_s_m": "F_v",
    "v_s_m_s": "v_s",
    "v_d_m_s": "v_d",
    "k_t_n_m": "k_t",
    "sigma_0_n_m": "sigma_0",
    "sigma_1_n_s_m": "sigma_1",
    "backlash.gap_rad": "backlash.gap",
    "cogging.A_n": "cogging.A",
    "cogging.pitch_m": "cogging.pitch",
    "cogging_2.A_n": "cogging_2.A",
    "cogging_2.pitch_m": "cogging_2.pitch",
    "coulomb_drag.F_d_n": "coulomb_drag.F_d",
    "drive_compliance.J_kg_m2": "drive_compliance.J",
    "drive_compliance.c_n_m_s_rad": "drive_compliance.c",
    "drive_compliance.k_n_m_rad": "drive_compliance.k",
    "dwell_stiction.s_0_m": "dwell_stiction.s_0",
    "gravity.G_n": "gravity.G",
    "inertia.m_e_kg": "inertia.m_e",
    "pitch_ripple.pitch_m": "pitch_ripple.pitch",
    "pitch_ripple_2.pitch_m": "pitch_ripple_2.pitch",
    "presliding.sigma_1_m": "presliding.sigma",
    "quadratic_drag.c_n_s2_m2": "quadratic_drag.c",
    "running_in.s_0_m": "running_in.s_0",
    "sensor_drift.d_n_s": "sensor_drift.d",
    "sensor_hysteresis.w_n": "sensor_hysteresis.w",
    "sensor_nonlinearity.c_1_n2": "sensor_nonlinearity.c",
    "sensor_offset.b_n": "sensor_offset.b",
    "stribeck_asymmetry.c_n": "stribeck_asymmetry.c",
    "stribeck_asymmetry.v_s_m_s": "stribeck_asymmetry.v_s",
    "stribeck_excess.v_s_m_s": "stribeck_excess.v_s",
    "stroke_dependence.h_m": "stroke_dependence.h",
    "stroke_dependence.x_0_m": "stroke_dependence.x_0",
    "viscous_asymmetry.b_n_s_m": "viscous_asymmetry.b",
    "viscous_load_dependence.c_s_m": "viscous_load_dependence.c",
    "viscous_thinning.w_s_m": "viscous_thinning.w",
}
"""Current names of parameters by old name; those of effects are dotted."""

OPTIONS = {
    "--clean-recording": "--no-artefact-margin",
    "--false-alarms": "--false-alarm-rate",
    "--indifference-n": "--min-effect",
    "--loads-n": "--loads",
    "--max-acceleration-m-s2": "--max-acceleration",
    "--max-velocity-m-s": "--max-velocity",
    "--noise-n": "--noise",
}
"""Current names of command-line options by old name."""


def current_effect(name: str, names: Collection[str] = ()) -> str:
    """Current name of an effect; an unknown name is returned unchanged."""
    return _current(name, EFFECTS, names)


def current_parameter(name: str, names: Collection[str] = ()) -> str:
    """Current dotted name of a parameter; an unknown name is returned unchanged."""
    if name in names:
        return name
    effect, dot, short = name.rpartition(".")
    return _current(f"{EFFECTS.get(effect, effect)}{dot}{short}", PARAMETERS, names, name)


def current_option(word: str) -> str:
    """Replace an old option name in a word of the command line, also in `OLD=VALUE`."""
    option, equals, value = word.partition("=")
    return _current(option, OPTIONS, ()) + equals + value


def _current(
    name: str, table: Mapping[str, str], names: Collection[str], written: str | None = None
) -> str:
    old = written or name
    new = table.get(name, name)
    if old in names or new == old or (names and new not in names):
        return old
    # A FutureWarning is meant for users and is shown by default.
    warnings.warn(f'"{old}" is now called "{new}"', FutureWarning, stacklevel=3)
    return new
