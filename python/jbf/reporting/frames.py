"""Results as columns of equal length, for data frames."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from jbf.comparison.comparison import Comparison
from jbf.comparison.model_comparison import ModelComparison
from jbf.diagnosis.check import Check
from jbf.diagnosis.experiment_design.plan import Plan
from jbf.diagnosis.power.planned_runs import PlannedPower
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.fit import Fit
from jbf.estimation.trajectory_fit import TrajectoryFit
from jbf.models.catalogue import parameters_of
from jbf.models.parameter_units import unit_of
from jbf.models.parameter_value import ParameterValue
from jbf.records.quantities import BEARING, Quantities

Columns = dict[str, Any]


def parameter_columns(
    law: str,
    effects: tuple[str, ...],
    parameters: Mapping[str, ParameterValue],
    quantities: Quantities = BEARING,
) -> Columns:
    """Table of parameters with one row each: name, value, stderr, unit, held flag, note."""
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
    """Table of the parameters of a fit, one row per parameter."""
    model = fit.model
    return parameter_columns(model.law, model.effects, fit.parameters, model.rig.quantities)


def trajectory_columns(fit: TrajectoryFit) -> Columns:
    """Table of the parameters of a trajectory fit, one row per parameter."""
    return parameter_columns("journal", (), fit.parameters)


def comparison_columns(comparison: Comparison) -> Columns:
    """Table of all samples of a comparison, one row per sample.

    The columns are the record, the motion, the model, and a flag for included samples.
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


def model_comparison_columns(compared: ModelComparison) -> Columns:
    """Table of compared models, one row per model, the best first."""
    return rows_as_columns(vars(m) for m in compared.models)


def power_columns(planned: PlannedPower) -> Columns:
    """Table of detection limits, one row per effect."""
    return rows_as_columns({**vars(p), "like": ", ".join(p.confounded_with)} for p in planned.power)


def plan_columns(plan: Plan) -> Columns:
    """Table of a plan, one row per run to record."""
    return {
        "run": [run.name for run in plan.runs],
        "motion": list(plan.words),
        "duration_s": [run.duration_s for run in plan.runs],
    }


def check_columns(check: Check) -> Columns:
    """Table of simulated success rates, one row per rate with its confidence interval."""
    return rows_as_columns(vars(rate) for rate in check.rates)


def rows_as_columns(rows: Iterable[Mapping[str, Any]]) -> Columns:
    """Convert rows with equal keys to columns by key."""
    several = list(rows)
    return {name: [row[name] for row in several] for name in (several[0] if several else ())}


def diagnosis_columns(diagnosis: Diagnosis) -> Columns:
    """Table of the ledger of a diagnosis, one row per step."""
    steps = diagnosis.steps
    return {
        "effects": [" + ".join(s.effects) for s in steps],
        "rms": [s.rms for s in steps],
        "held_out_rms": [s.held_out_rms for s in steps],
        "noise_rms": [s.noise_rms for s in steps],
    }
