"""Draw the pictures of README and of docs/pictures.md: `.venv/bin/python docs/pictures.py`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import jbf
import jbf.plot
import matplotlib
from jbf import control
from jbf.plot.style import one_axes
from matplotlib.axes import Axes
from matplotlib.figure import Figure

HERE = Path(__file__).resolve().parent
DEMO = Path(jbf.__file__).parent / "data" / "demo" / "hidden"
SMALL = (6.4, 3.6)


def main() -> None:
    """Draw the picture of the README, and one for each function of `jbf.plot`."""
    rig, runs = jbf.read_rig(DEMO / "rig.toml"), jbf.read_runs(DEMO)
    diagnosis = jbf.diagnose(rig, runs)
    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    diagnosis.plot(list(figure.subplots(2, 2).ravel()))
    figure.savefig(HERE / "images" / "error_falling.png", dpi=110)
    folder = HERE / "images" / "plot"
    folder.mkdir(exist_ok=True)
    for name, draw in each(diagnosis).items():
        # A fixed salt for the identifiers makes the file reproducible.
        with matplotlib.rc_context({"svg.hashsalt": name}):
            jbf.plot.save(draw(one_axes(None, SMALL)), folder / f"{name}.svg")


def each(diagnosis: jbf.Diagnosis) -> dict[str, Callable[[Axes], Axes]]:
    """Return the functions that draw a diagnosis with each function of `jbf.plot`, by name."""
    before, after = diagnosis.before, diagnosis.after
    loop = control.run(None, "observed", control.TASKS["velocity sine"])
    plot = jbf.plot
    return {
        "ledger": lambda ax: plot.ledger(diagnosis, ax=ax),
        "ranking": lambda ax: plot.ranking(diagnosis, ax=ax),
        "power": lambda ax: plot.power(diagnosis, ax=ax),
        "parameters": lambda ax: plot.parameters(diagnosis.fit, ax=ax),
        "loops": lambda ax: plot.loops(after, "stop_and_go", ax=ax),
        "stribeck": lambda ax: plot.stribeck(after, ax=ax),
        "friction_map": lambda ax: plot.friction_map(after, ax=ax),
        "record_and_model": lambda ax: plot.record_and_model(before, "two_way_1.0", ax=ax),
        "residual_in_time": lambda ax: plot.residual_in_time(before, "two_way_1.0", ax=ax),
        "residual_along": lambda ax: plot.residual_along(before, "velocity", ax=ax),
        "residual_map": lambda ax: plot.residual_map(before, "time", "run", ax=ax),
        "residuals_in_a_row": lambda ax: plot.residuals_in_a_row(diagnosis.fit, ax=ax),
        "spectrum": lambda ax: plot.spectrum(before, "two_way_1.0", ax=ax),
        "control_trace": lambda ax: plot.control_trace(loop, "error", ax=ax),
    }


if __name__ == "__main__":
    main()
