"""Draw the figure of docs/why/reproduction.md: `.venv/bin/python docs/reproduction.py`.

The figure shows Stribeck curves for the four parameter sets of Cohn (1998), and loops of reversing
motion under 104 N with both time scales of the film.
"""

from __future__ import annotations

from pathlib import Path

import jbf
import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

IMAGES = Path(__file__).resolve().parent / "images"
TABLES = {"4.2": (0.06, 7.5e5), "4.3": (0.05, 6.25e5), "4.4": (0.05, 6.25e5), "4.5": (0.05, 4.5e5)}
"""U_tr (m/s) and K0 of Tables 4.2 to 4.5 of Cohn (1998); f_m and gamma are the same for all."""
FREQUENCIES_RAD_S = (0.1, 0.5, 2.0)
AMPLITUDE_M_S = 0.127
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7")


def model(table: str, clock: str = "journal") -> jbf.Model:
    """Return the model of the bearing with the parameters of a table of Cohn (1998)."""
    u_tr, k0 = TABLES[table]
    values = {"f_m": 0.26, "gamma": 33.0, "U_tr_m_s": u_tr, "K0": k0}
    return jbf.Model(jbf.Rig.thesis(table), clock=clock, parameters=values)


def loop(
    of: jbf.Model, frequency_rad_s: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return speed and friction coefficient over the second period of a sinusoidal speed."""
    period_s = 2.0 * np.pi / frequency_rad_s
    time_s = np.linspace(0.0, 2.0 * period_s, 4001)
    speed = AMPLITUDE_M_S * np.sin(frequency_rad_s * time_s)
    path_m = AMPLITUDE_M_S / frequency_rad_s * (1.0 - np.cos(frequency_rad_s * time_s))
    run = jbf.Run.from_arrays(time_s, speed, angle_rad=path_m / 0.0127)
    return speed[2000:], of.predict(run)[2000:] / 104.0


def main() -> None:
    """Draw and write the figure."""
    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    steady, journal, thesis = figure.subplots(1, 3)
    speeds = np.geomspace(1e-4, 0.2646, 200)
    for colour, table in zip(COLOURS, TABLES, strict=True):
        fitted = model(table)
        load = fitted.rig.load.normal_n if fitted.rig.load else None
        assert load is not None
        steady.plot(
            speeds, fitted.steady_friction(speeds) / load, color=colour, label=f"Table {table}"
        )
    steady.set(
        xlabel="speed (m/s)", ylabel="friction coefficient", title="Steady: the Stribeck curve"
    )
    steady.legend(frameon=False)
    for ax, clock in ((journal, "journal"), (thesis, "thesis")):
        for colour, frequency in zip(COLOURS, FREQUENCIES_RAD_S, strict=False):
            ax.plot(
                *loop(model("4.2", clock), frequency),
                color=colour,
                lw=1.0,
                label=f"{frequency:g} rad/s",
            )
        ax.set(xlabel="speed (m/s)", title=f"Two-way, 104 N, {clock} clock")
        ax.legend(frameon=False)
    figure.savefig(IMAGES / "reproduction.png", dpi=110)


if __name__ == "__main__":
    main()
