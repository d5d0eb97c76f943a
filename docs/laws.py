"""Draw each base law for docs/laws.md: `.venv/bin/python docs/laws.py`.

A picture shows friction against speed and against position for a sine of 1 rad/s, and the steady
friction.
"""

from __future__ import annotations

from pathlib import Path

import jbf
import numpy as np
from jbf.models.catalogue import laws
from matplotlib.figure import Figure

IMAGES = Path(__file__).resolve().parent / "images" / "laws"
VALUES = {
    "journal": {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0},
    "journal_full": {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0},
    "coulomb": {"F_c": 5.0, "F_s": 5.0, "F_v": 20.0},
    "stribeck": {"F_c": 5.0, "F_s": 8.0, "v_s": 0.01, "delta": 1.0, "F_v": 20.0},
    "seven_parameter": {"F_c": 5.0, "F_v": 20.0, "k_t": 1e4},
    "dahl": {"F_c": 5.0, "sigma_0": 1e3, "F_v": 20.0},
    "lugre": {"F_c": 5.0, "F_s": 8.0, "v_s": 0.01, "sigma_0": 2e3, "F_v": 20.0},
    "maxwell_slip": {"F_c": 5.0, "sigma_0": 1e3, "F_v": 20.0},
    "elasto_plastic": {"F_c": 5.0, "sigma_0": 1e3, "F_v": 20.0},
    "rate_and_state": {"F_0": 5.0, "a": 0.2, "b": 0.5, "D_c": 0.01, "F_v": 20.0},
}
"""Parameters of each law in its picture.

Parameters without an entry have the first starting value of the catalogue. The bristles are
compliant, so that their deflection is visible.
"""
SPEED_M_S = 0.05
LINE, STEADY = "#0072B2", "0.45"


def figure_of(law: str) -> Figure:
    """Plot the friction of a law against speed and position."""
    bearing = "journal" in law
    time_s = np.linspace(0.0, 4.0 * np.pi, 6001)
    speed = SPEED_M_S * np.sin(time_s)
    path_m = SPEED_M_S * (1.0 - np.cos(time_s))
    rig = jbf.Rig.thesis() if bearing else jbf.Rig()
    place = {"angle_rad": path_m / 0.0127} if bearing else {"position_m": path_m}
    model = jbf.Model(rig, law=law, parameters=VALUES[law])
    force = model.predict(jbf.Run.from_arrays(time_s, speed, **place))
    late = time_s >= 2.0 * np.pi
    figure = Figure(figsize=(8.0, 2.8), layout="constrained")
    plane, along = figure.subplots(1, 2, sharey=True)
    slow = np.linspace(1e-5, SPEED_M_S, 200)
    for side in (1.0, -1.0):
        label = "steady" if side > 0 else None
        steady = side * model.steady_friction(slow)
        plane.plot(side * slow, steady, color=STEADY, ls="--", lw=1.2, label=label)
    plane.plot(speed[late], force[late], color=LINE, lw=1.2, label="a sine of 1 rad/s")
    plane.set(xlabel="speed (m/s)", ylabel="friction (N)", title=law)
    plane.legend(frameon=False, fontsize=8)
    along.plot(1e3 * path_m[late], force[late], color=LINE, lw=1.2)
    along.set(xlabel="place (mm)")
    return figure


def main() -> None:
    """Write one picture per law to docs/images."""
    IMAGES.mkdir(exist_ok=True)
    for law in laws():
        figure_of(law).savefig(IMAGES / f"{law}.png", dpi=80)


if __name__ == "__main__":
    main()
