"""Make the pictures of README and docs: `.venv/bin/python docs/pictures.py`."""

from __future__ import annotations

from pathlib import Path

import jbf
from matplotlib.figure import Figure

HERE = Path(__file__).resolve().parent
DEMO = Path(jbf.__file__).parent / "data" / "demo" / "hidden"


def main() -> None:
    """The README's picture: the error falling, and friction against speed before and after."""
    rig, runs = jbf.read_rig(DEMO / "rig.toml"), jbf.read_runs(DEMO)
    diagnosis = jbf.diagnose(rig, runs)
    figure = Figure(figsize=(10.0, 7.0), layout="constrained")
    diagnosis.plot(figure.subplots(2, 2).ravel())
    figure.savefig(HERE / "images" / "error_falling.png", dpi=110)


if __name__ == "__main__":
    main()
