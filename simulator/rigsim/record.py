"""One recorded run and its CSV file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Record:
    """Samples of one run; the fields have the order and units of the CSV file.

    `velocity` is in m/s and `friction` in N. `clean_friction_n` is the friction without noise, N.
    """

    time_s: Vector
    angle_rad: Vector
    velocity: Vector
    friction: Vector
    load_n: Vector
    clean_friction_n: Vector
    temperature_c: Vector | None = None

    def write(self, path: Path) -> None:
        """Write the run as CSV with the columns that jbf reads, without the clean friction."""
        columns = (
            self.time_s,
            self.angle_rad,
            self.velocity + 0.0,
            self.friction,
            self.load_n,
        )
        rows = ["time_s,angle_rad,velocity_m_s,friction_n,load_n"]
        for t, angle, v, force, load in zip(*(c.tolist() for c in columns), strict=True):
            rows.append(f"{t:.3f},{angle:.5f},{v:.6f},{force:.4f},{load:.1f}")
        if self.temperature_c is not None:
            warmth = ["temperature_c", *(f"{c:.2f}" for c in self.temperature_c.tolist())]
            rows = [f"{row},{celsius}" for row, celsius in zip(rows, warmth, strict=True)]
        path.write_text("\n".join(rows) + "\n", encoding="utf-8")
