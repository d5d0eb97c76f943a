"""From a measurement to a better loop: diagnose, save the model, compensate with it.

A rig whose bearings rub 30 % harder one way than the other is measured, and its records diagnosed.
Then two compensators run on the simulated bench that has this friction: one carries the bare film
model as fitted, one the model with the effect that the diagnosis added.

    python examples/diagnose_then_compensate.py [FOLDER]

writes model.toml and bare.toml, the same that `jbf diagnose` and `jbf fit` write.
"""

from __future__ import annotations

import sys
from pathlib import Path

import jbf
import numpy as np
from jbf import control

HIDDEN = {"direction_asymmetry.a": 0.3}
TASKS = {
    name: control.TASKS[name] for name in ("position sine", "velocity sine", "velocity triangle")
}


def measure(truth: jbf.Model, rng: np.random.Generator) -> list[jbf.Run]:
    """Four records at 50 samples/s with 1.5 % of noise on friction: what a rig would give."""
    runs = []
    for i, (frequency, middle) in enumerate([(0.1, 0.0), (0.25, 0.0), (1.0, 0.0), (0.25, 0.03)]):
        time_s = np.arange(0.0, min(4.0 * np.pi / frequency, 40.0), 0.02)
        speed = middle + 0.1 * np.sin(frequency * time_s)
        way = middle * time_s + 0.1 / frequency * (1.0 - np.cos(frequency * time_s))
        name, radius = f"run{i + 1}", 0.0127
        clean = truth.predict(jbf.Run.from_arrays(time_s, speed, angle_rad=way / radius, name=name))
        noisy = clean + rng.normal(0.0, 0.015 * np.max(np.abs(clean)), len(clean))
        seen = speed + rng.normal(0.0, 1e-4, len(speed))
        runs.append(jbf.Run.from_arrays(time_s, seen, noisy, angle_rad=way / radius, name=name))
    return runs


def main(folder: Path) -> dict[str, float]:
    """Print the errors; the gain, error without over error with the effect, by task."""
    rig = jbf.Rig.thesis("4.2")
    truth = jbf.Model(rig, effects=["direction_asymmetry"], parameters=HIDDEN)
    runs = measure(truth, np.random.default_rng(7))

    diagnosis = jbf.diagnose(rig, runs)
    diagnosis.model.save(folder / "model.toml")
    jbf.fit(rig, runs).model.save(folder / "bare.toml")
    print(f"diagnosis: {diagnosis.verdict} {', '.join(diagnosis.effects)}")

    gains = {}
    print(f"{'true RMS error':<20}{'none':>10}{'bare':>10}{'diagnosed':>11}{'gain':>7}")
    for name, task in TASKS.items():
        errors = [control.run(truth, "none", task).true_rms]
        for file in ("bare.toml", "model.toml"):
            model = jbf.Model.load(folder / file)
            settings = control.tune(model)
            loop = control.run(truth, "observed", task, carried=model, settings=settings)
            errors.append(loop.true_rms)
        none, bare, diagnosed = errors
        gains[name] = bare / diagnosed
        print(f"{name:<20}{none:>10.3g}{bare:>10.3g}{diagnosed:>11.3g}{gains[name]:>7.2f}")
    return gains


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
