"""Held-out errors of a model at samples where the sign of the speed is known."""

from __future__ import annotations

import jbf
import numpy as np

SLOWEST_M_S = 5e-4


def held_out(model: jbf.Model, runs: list[jbf.Run]) -> dict[str, float]:
    """Return RMS (`rms_n`) and mean absolute error (`mae_n`) of a model over the runs, N."""
    errors = []
    for run in runs:
        assert run.friction is not None
        kept = np.abs(run.velocity) >= SLOWEST_M_S
        errors.append((run.friction - model.predict(run))[kept])
    all_ = np.concatenate(errors)
    return {"rms": float(np.sqrt(np.mean(all_**2))), "mae_n": float(np.mean(np.abs(all_)))}
