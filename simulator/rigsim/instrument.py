"""Load cell: nonlinearity and play before its filter, zero offset and drift after it.

The filter of a linear cell is a state of the chain. Play in the force path depends on the history
of the force. With play or a nonlinear characteristic, the force is therefore computed on a grid
finer than the samples, passed through the cell, and filtered and delayed on that grid.
"""

from __future__ import annotations

import numpy as np

from .lubricant import Parameters
from .record import Vector

BENT = ("sensor_hysteresis", "sensor_nonlinearity")
"""Effects on the force before the filter of the load cell."""
FILTERS = ("sensor_lag", "time_delay")
FINER = 5
"""Number of instants of the finer grid per sample."""
BESIDE_S = 1e-6
"""Distance of additional grid points before and after an instant at which the force may jump, s."""


def read_out(force: Vector, times: Vector, effects: Parameters) -> Vector:
    """Return the force (N) with `sensor_offset` and `sensor_drift`, at times from run start (s)."""
    offset = effects.get("sensor_offset", {}).get("b", 0.0)
    drift = effects.get("sensor_drift", {}).get("d", 0.0)
    return force + offset + drift * times


def finer(times: Vector, jumps: Vector) -> Vector:
    """Return the instants of the finer grid (s), including those next to jumps."""
    where = np.arange(FINER * (len(times) - 1) + 1) / FINER
    between = np.interp(where, np.arange(len(times)), times)
    instants = np.concatenate([between, times, jumps - BESIDE_S, jumps + BESIDE_S])
    return np.unique(np.clip(instants, times[0], times[-1]))


def through_cell(force: Vector, effects: Parameters) -> Vector:
    """Return the force (N) in the load cell, after play in the force path and nonlinearity."""
    play = effects.get("sensor_hysteresis", {}).get("w", 0.0)
    cubic = effects.get("sensor_nonlinearity", {}).get("c", 0.0)
    seen = force - _kept_back(force, play) if play > 0.0 else force
    if cubic < 0.0:  # the reading never decreases with the force
        turning = float(np.sqrt(-1.0 / (3.0 * cubic)))
        seen = np.clip(seen, -turning, turning)
    return np.polynomial.polynomial.polyval(seen, [0.0, 1.0, 0.0, cubic])


def _kept_back(force: Vector, play: float) -> Vector:
    """Part of a force (N) that a spring with a slider carries, which slips at `play` (N).

    The spring is relaxed at first.
    """
    borne, out = 0.0, np.zeros(len(force))
    for i, more in enumerate(np.diff(force).tolist(), start=1):
        borne = float(np.clip(borne + more, -play, play))
        out[i] = borne
    return out


def filtered(force: Vector, times: Vector, effects: Parameters) -> Vector:
    """Return the force (N) after filter and delay; it is linear between the instants.

    The filter starts in its steady state.
    """
    tau = effects.get("sensor_lag", {}).get("tau", 0.0)
    if tau > 0.0:
        shown, out = float(force[0]), [float(force[0])]
        for i, step in enumerate(np.diff(times).tolist(), start=1):
            slope = float(force[i] - force[i - 1]) / step
            # On a ramp the filter lags by tau times the slope, once its initial transient has
            # decayed.
            trailing = shown - float(force[i - 1]) + tau * slope
            shown = float(force[i]) - tau * slope + trailing * float(np.exp(-step / tau))
            out.append(shown)
        force = np.array(out)
    late = effects.get("time_delay", {}).get("tau", 0.0)
    return np.interp(times - late, times, force) if late > 0.0 else force
