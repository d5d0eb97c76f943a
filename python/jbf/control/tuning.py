"""Tuning of the observed compensator from a fitted model, without trial and error.

All settings follow from four quantities: the step of the loop, the encoder's resolution, and the
model's friction at rest and at the start of sliding.
"""

from __future__ import annotations

import math
from collections.abc import Hashable

import numpy as np

from jbf.control.bench import THESIS_BENCH, Bench, check_rotary
from jbf.control.settings import Settings
from jbf.errors import InputError
from jbf.models.model import Model, the_model
from jbf.records.run import Run

_SHARE_OF_SAMPLING = 0.12
"""Bandwidth of the observer times the step of the loop.

The delay of half a step is then 3.4 deg of phase.
"""

_MOTOR_SHARE = 0.1
"""Tolerance for errors of the motor model, as a share of the largest voltage."""

LAW_RAD_S = math.sqrt(200.0)
"""Natural frequency of the position control law, whose poles are at -10 +- 10i, rad/s."""

_MOST_LEVELS = 256

_NOISE_SHARE = 0.01
"""Share of the friction level that noise may cause in the output."""


def friction_level_v(model: Model, bench: Bench = THESIS_BENCH) -> float:
    """Largest friction of a model in slow motion, effects included, as a voltage, V."""
    values = {n: p.value for n, p in model.parameters.items()}
    key = (model.rig, model.law, model.effects, model.clock, tuple(values.items()))
    if key not in _levels_n:
        if len(_levels_n) >= _MOST_LEVELS:
            _levels_n.clear()
        _levels_n[key] = _friction_level_n(model)
    return _levels_n[key] * bench.volts_per_n


_levels_n: dict[Hashable, float] = {}
"""Cache of friction levels, because a prediction costs more than a run of the loop."""


def _friction_level_n(model: Model) -> float:
    radius_m = 1.0 if model.rig.bearing is None else model.rig.bearing.radius_m
    # Slightly more than one cycle of forward and backward motion over 17 mm. A position ripple is
    # evaluated within this range.
    time_s = np.arange(0.0, 11.0, 0.02)
    rate, top_m_s = 0.6, 0.005
    velocity = top_m_s * np.sin(rate * time_s)
    path_m = top_m_s / rate * (1.0 - np.cos(rate * time_s))
    turns = model.rig.bearing is not None or model.rig.quantities.motion == "rotary"
    run = Run(
        "slow motion",
        time_s,
        velocity,
        angle_rad=path_m / radius_m if turns else None,
        position_m=None if turns else path_m,
    )
    return float(np.max(np.abs(model.predict(run))))


def tune(model: Model, bench: Bench = THESIS_BENCH) -> Settings:
    """Compute the settings of the observed compensator for a model on a bench.

    Parameters
    ----------
    model
        The fitted model.
    bench
        Bench whose a, b, volts per newton, encoder and step are used.

    Raises
    ------
    InputError
        The model is of a linear drive, or its friction exceeds the drive's voltage.
    """
    check_rotary(the_model(model))
    level_v = friction_level_v(model, bench)
    if not 0.0 < level_v < bench.limit_v:
        raise InputError(
            problem=(
                f"the model's friction is {level_v:.3g} V, the limit of the drive "
                f"{bench.limit_v:g} V"
            ),
            remedy="correct --volts-per-n",
        )
    count_rad = 1.0 / bench.counts_per_rad
    noise_rad = count_rad * math.sqrt(1.0 / 12.0 + bench.encoder_noise_counts**2)
    # The noise of the estimate is noise_rad w sqrt(w dt). A gain of one V s/rad converts it to the
    # output.
    quiet = (_NOISE_SHARE * level_v / (noise_rad * math.sqrt(bench.dt_s))) ** (2.0 / 3.0)
    bandwidth = min(_SHARE_OF_SAMPLING / bench.dt_s, quiet)
    speed_noise = noise_rad * bandwidth * math.sqrt(bandwidth * bench.dt_s)
    return Settings(
        bandwidth_rad_s=bandwidth,
        learning_1_s=bandwidth / 30.0,
        # Friction may be zero or twice that of the model. Other disturbances may be of the same
        # size, and the motor may deviate from its data sheet.
        level_limit_v=level_v,
        rest_limit_v=level_v + _MOTOR_SHARE * bench.limit_v,
        slow_rad_s=max(5.0 * speed_noise, 2.0 * count_rad * bandwidth),
        # Do not reduce the loop gain if the encoder resolution is too low for a higher gain.
        loop_rad_s=max(bandwidth / 2.0, LAW_RAD_S),
        breakaway=1.0,
        moving_v=min(2.5 * level_v, bench.limit_v),
        patience_s=50.0 * bench.dt_s,
    )
