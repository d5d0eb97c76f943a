"""Results as columns of equal length, for data frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from jbf.comparison.comparison import Comparison
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.models.catalogue import parameters_of
from jbf.models.parameter_units import unit_of
from jbf.models.parameter_value import ParameterValue
from jbf.records.quantities import OF_BEARING, Quantities

Columns = dict[str, Any]


def parameter_columns(
    law: str,
    effects: tuple[str, ...],
    parameters: Mapping[str, ParameterValue],
    quantities: Quantities = OF_BEARING,
) -> Columns:
    """Return one row per parameter: name, value, stderr, unit, held flag, note."""
    pages = parameters_of(law, effects)
    return {
        "parameter": list(parameters),
        "value": [p.value for p in parameters.values()],
        "stderr": [np.nan if p.stderr is None else p.stderr for p in parameters.values()],
        "unit": [
            unit_of(name, pages[name], law, quantities) if name in pages else ""
            for name in parameters
        ],
        "held": [p.held for p in parameters.values()],
        "note": [p.note or "" for p in parameters.values()],
    }


def fit_columns(fit: Fit) -> Columns:
    """Return one row per parameter of a fit."""
    model = fit.model
    return parameter_columns(model.law, model.effects, fit.parameters, model.rig.quantities)


def trajectory_columns(fit: TrajectoryFit) -> Columns:
    """Return one row per parameter of a trajectory fit."""
    return parameter_columns("journal", (), fit.parameters)


def comparison_columns(comparison: Comparison) -> Columns:
    """Return one row per sample of all concatenated runs.

    The columns are the record, the motion, the model, and a flag for samples that count.
    """
    prepared = comparison.campaign.prepared
    joined: dict[str, Sequence[Any]] = {
        "time_s": [p.run.time_s for p in prepared],
        "velocity_m_s": [p.motion.velocity for p in prepared],
        "friction_n": [p.friction for p in prepared],
        "model_n": comparison.predictions,
        "residual_n": comparison.residuals,
        "counts": comparison.samples.counted,
    }
    run = [p.run.name for p in prepared for _ in range(len(p.run))]
    return {"run": run} | {name: np.concatenate(parts) for name, parts in joined.items()}


def diagnosis_columns(diagnosis: Diagnosis) -> Columns:
    """Return one row per step of the ledger."""
    steps = diagnosis.steps
    return {
        "effects": [" + ".join(s.effects) for s in steps],
        "rms": [s.rms for s in steps],
        "held_out_rms": [s.held_out_rms for s in steps],
        "noise_rms": [s.noise_rms for s in steps],
    }
