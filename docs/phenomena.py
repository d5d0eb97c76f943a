"""Draw the pictures of docs/phenomena.md: `.venv/bin/python docs/phenomena.py`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import jbf
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

IMAGES = Path(__file__).resolve().parent / "images" / "phenomena"
STRIBECK = {"F_c": 10.0, "F_s": 16.0, "v_s": 0.01, "delta": 1.0, "F_v": 60.0}
SOFT = {"drive_compliance.k": 4e3, "drive_compliance.c": 15.0}
SOFT |= {"drive_compliance.J": 3.0}
LUGRE = {"F_c": 10.0, "F_s": 16.0, "v_s": 0.004, "sigma_0": 2e5, "sigma_1": 150.0}
LUGRE |= {"v_d": 0.1, "F_v": 60.0}
BRISTLES = {"F_c": 10.0, "sigma_0": 2e5, "exponent": 0.5, "F_v": 0.0}
RIG = jbf.Rig()


def motion(time_s: np.ndarray, position_m: np.ndarray) -> jbf.Run:
    """Return a motion along a line as a run without friction."""
    speed = np.gradient(position_m, time_s)
    return jbf.Run.from_arrays(time_s, speed, position_m=position_m)


def stribeck(ax: Axes) -> None:
    """Draw a steady Stribeck curve, and its Coulomb and viscous friction."""
    v = np.linspace(1e-5, 0.1, 1000)
    law = jbf.Model(RIG, "stribeck", parameters=STRIBECK)
    ax.plot(1e3 * v, law.steady_friction(v), color="tab:red", label="Stribeck curve")
    level, viscous = STRIBECK["F_c"], STRIBECK["F_v"]
    ax.plot(1e3 * v, level + viscous * v, "--", color="0.4", label="Coulomb and viscous friction")
    ax.set(xlabel="speed, mm/s", ylabel="friction, N", ylim=(0.0, 18.0))


def breakaway(ax: Axes) -> None:
    """Draw friction against distance when a slide starts from rest."""
    t = np.linspace(0.0, 0.8, 8001)
    x = 0.5 * 0.01 * t**2
    law = jbf.Model(RIG, "lugre", parameters=LUGRE)
    ax.plot(1e3 * x, law.predict(motion(t, x)), color="tab:red", label="start from rest")
    ax.axhline(LUGRE["F_s"], color="0.4", linestyle=":", label="static friction $F_s$")
    ax.axhline(LUGRE["F_c"], color="0.4", linestyle="--", label="Coulomb friction $F_c$")
    ax.set(xlabel="distance, mm", ylabel="friction, N", ylim=(0.0, 18.0))


def stick_slip(ax: Axes) -> None:
    """Draw the force of a soft drive that moves slowly."""
    t = np.arange(0.0, 6.0, 0.002)
    law = jbf.Model(RIG, "stribeck", effects=["drive_compliance"], parameters=STRIBECK | SOFT)
    for speed, style in ((0.004, "-"), (0.08, "--")):
        force = law.predict(motion(t, speed * t))
        label = f"{1e3 * speed:.0f} mm/s"
        colour = "tab:red" if style == "-" else "0.4"
        later = t > 2.0
        ax.plot(t[later], force[later], style, color=colour, linewidth=1.0, label=label)
    ax.set(xlabel="time, s", ylabel="friction, N", ylim=(0.0, 18.0))


def presliding(ax: Axes) -> None:
    """Draw friction against position during reversals without and with sliding."""
    t = np.linspace(0.0, 4.0, 8001)
    law = jbf.Model(RIG, "maxwell_slip", parameters=BRISTLES)
    for half_um, colour in ((200.0, "0.4"), (60.0, "tab:blue"), (15.0, "tab:red")):
        x = 1e-6 * half_um * np.sin(2.0 * np.pi * t) * np.minimum(t, 1.0) ** 2
        kept = t > 2.0
        force = law.predict(motion(t, x))
        label = f"stroke of {2 * half_um:.0f} µm"
        ax.plot(1e6 * x[kept], force[kept], color=colour, linewidth=1.2, label=label)
    ax.set(xlabel="position, µm", ylabel="friction, N")


PICTURES: dict[str, Callable[[Axes], None]] = {
    "stribeck": stribeck,
    "breakaway": breakaway,
    "stick_slip": stick_slip,
    "presliding": presliding,
}


def main() -> None:
    """Draw all pictures."""
    IMAGES.mkdir(exist_ok=True)
    for name, draw in PICTURES.items():
        figure = Figure(figsize=(6.0, 3.4), layout="constrained")
        ax = figure.subplots()
        draw(ax)
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(frameon=False, fontsize="small")
        figure.savefig(IMAGES / f"{name}.png", dpi=90)


if __name__ == "__main__":
    main()
