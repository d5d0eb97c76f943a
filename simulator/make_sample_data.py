"""Make the samples of the workbench: `python simulator/make_sample_data.py`.

A linear axis and a robot joint from the independent simulator, each with effects that the friction
law lacks, and a file with the true values.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from rigsim.axes import axis_campaign

OUT = Path(__file__).resolve().parents[1] / "python" / "jbf" / "data" / "samples"
SAMPLES = {
    "axis": (41, ("inertia", "cogging"), 1.0, ("position_m", "velocity_m_s", "friction_n")),
    "joint": (42, ("inertia", "gravity"), 8.0, ("angle_rad", "velocity_rad_s", "torque_n_m")),
}
"""Seed, hidden effects, scale of the motion and columns of each sample."""


def main() -> None:
    """Simulate and write both samples."""
    for name, (seed, effects, swing, columns) in SAMPLES.items():
        folder = OUT / name
        folder.mkdir(parents=True, exist_ok=True)
        records, truth = axis_campaign(seed, effects, runs=4, swing=swing, run_s=24.0, step_s=0.02)
        motion, friction = ("linear", "force") if name == "axis" else ("rotary", "torque")
        (folder / "rig.toml").write_text(f'[drive]\nmotion = "{motion}"\nfriction = "{friction}"\n')
        for number, r in enumerate(records, 1):
            rows = np.column_stack([r.time_s, r.path, r.velocity, r.force_n])
            np.savetxt(
                folder / f"run_{number}.csv", rows, ["%.2f", "%.5f", "%.5f", "%.4f"], ",",
                header=",".join(["time_s", *columns]), comments="",
            )  # fmt: skip
        (folder / "truth.json").write_text(json.dumps({**truth, "seed": seed}, indent=1) + "\n")


if __name__ == "__main__":
    main()
