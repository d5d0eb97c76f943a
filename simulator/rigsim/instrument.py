"""The load cell after its lag: zero offset and drift. The lag itself is a chain state."""

from __future__ import annotations

from .lubricant import Parameters
from .record import Vector


def read_out(force: Vector, times: Vector, effects: Parameters) -> Vector:
    """Force (N) with `sensor_offset` and `sensor_drift` added; time since run start (s)."""
    offset = effects.get("sensor_offset", {}).get("b", 0.0)
    drift = effects.get("sensor_drift", {}).get("d", 0.0)
    return force + offset + drift * times
