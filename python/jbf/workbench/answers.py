"""Results of a model, a fit, a selection step and a diagnosis as JSON data for the page.

Data of the length of a record are written to files.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jbf.comparison.axes import all_axes
from jbf.comparison.comparison import Comparison
from jbf.comparison.over_speed import friction_over_speed, regimes
from jbf.diagnosis import Diagnosis, Step
from jbf.diagnosis.power import Power
from jbf.errors import JbfError
from jbf.estimation.fit import Fit
from jbf.estimation.starting_values import with_starts
from jbf.models.catalogue import (
    effects,
    find_law,
    parameters_of,
    reason_not_applicable,
    transition_speed,
)
from jbf.models.model import Model
from jbf.models.parameter_units import units_of
from jbf.models.parameter_value import ParameterValue
from jbf.reporting.effect_size import size_words
from jbf.reporting.tables import power_rows
from jbf.reporting.words import headline_and_rest, verdict_sentence
from jbf.workbench.marks import failure_marks

Answer = dict[str, Any]
TYPICAL = "typical_values.json"
"""File of `typical_values` in the folder of the records of a model."""


def of_model(comparison: Comparison) -> Answer:
    """Errors, parameters and residual patterns of a model, for the page."""
    model = comparison.model
    return {
        "law": model.law,
        "effects": list(model.effects),
        "model": model.to_toml(),
        "rms": comparison.rms,
        "held_out_rms": None,
        "noise_rms": comparison.noise_rms,
        "runs": [{"name": r.name, "rms": r.rms} for r in comparison.runs],
        "failures": failure_marks(comparison),
        "findings": [f.to_dict() for f in comparison.findings],
        "parameters": _parameters(model, model.parameters),
        "trials": None,
        "sizes": {name: f"{size_words(comparison, name)}." for name in model.effects},
        "stribeck": _stribeck(comparison),
        "regimes": _regimes(comparison),
    }


def _regimes(comparison: Comparison) -> list[Answer]:
    """Mean and RMS residual in each regime of the law, or in thirds of the speeds, for the page."""
    model = comparison.model
    u_tr = transition_speed(model.law, model.values.tolist())
    axes = all_axes(comparison.campaign, u_tr)
    axis = next((a for a in axes if a.axis in ("regime", "speed range")), None)
    if axis is None:
        return []
    rows = []
    runs = zip(
        comparison.campaign.prepared, comparison.predictions, comparison.samples.counted,
        axis.places, strict=True,
    )  # fmt: skip
    residual, places = zip(
        *(
            ((p.friction - predicted)[counted > 0], places[counted > 0])
            for p, predicted, counted, places in runs
        ),
        strict=True,
    )
    values, bins = np.concatenate(residual), np.concatenate(places)
    for number, name in enumerate(axis.labels):
        part = values[bins == number]
        if len(part):
            rms = float(np.sqrt(np.mean(part**2)))
            rows.append(
                {"name": name, "samples": len(part), "rms": rms, "mean": float(np.mean(part))}
            )
    return rows


def _stribeck(comparison: Comparison) -> Answer:
    """Friction over speed, for the page.

    The data are the means of record and model per direction (1.0 or -1.0), the steady curve, and
    the regimes.
    """
    branches = [
        {
            "direction": branch.way,
            "speed_m_s": branch.speed_m_s.tolist(),
            "measured_n": branch.measured_n.tolist(),
            "scatter_n": branch.scatter_n.tolist(),
            "modelled_n": branch.modelled_n.tolist(),
        }
        for branch in friction_over_speed(comparison)
    ]
    curves = {"directions": branches, "regimes_m_s": regimes(comparison.model)}
    return {**curves, "steady": _steady_curve(comparison)}


def _steady_curve(comparison: Comparison) -> Answer | None:
    """Steady friction of the law over the speeds of the runs; None without a steady curve.

    The data are speeds and friction in the units of the rig.
    """
    model = comparison.model
    motions = [p.motion.velocity for p in comparison.campaign.prepared]
    top_speed = max(float(np.nanmax(np.abs(v))) for v in motions)
    speeds = top_speed * np.geomspace(1e-4, 1.0, 120)
    try:
        force = model.steady_friction(speeds)
    except JbfError:
        return None
    return {"velocity_m_s": speeds.tolist(), "friction_n": np.asarray(force).tolist()}


def _parameters(model: Model, values: Mapping[str, ParameterValue]) -> Answer:
    """Parameters of a model with their units, bounds and meanings, for the page."""
    units = units_of(model.law, model.effects, model.rig.quantities)
    pages = parameters_of(model.law, model.effects)
    return {
        name: {
            **p.to_dict(),
            "unit": units[name],
            "lower": pages[name].lower,
            "upper": pages[name].upper,
            "meaning": pages[name].meaning,
        }
        for name, p in values.items()
    }


def of_fit(fit: Fit) -> Answer:
    """Parameters of a fit with their correlations, for the page."""
    estimated = [name for name, p in fit.parameters.items() if not p.held]
    return {
        "parameters": _parameters(fit.model, fit.parameters),
        "correlations": {"names": estimated, "matrix": np.round(fit.correlations, 3).tolist()},
        "doubtful": list(fit.doubtful),
        "converged": fit.converged,
    }


def of_step(step: Step) -> Answer:
    """Held-out error of a step of the ledger, and its candidates, for the page."""
    return {
        "held_out_rms": step.held_out_rms if math.isfinite(step.held_out_rms) else None,
        "trials": [{**t.to_dict(), "unconfirmed": t.unconfirmed} for t in step.trials],
    }


def of_power(power: Iterable[Power], model: Model) -> list[Answer]:
    """Detection limits of effects, worded as in the reports, for the page.

    The `meaning` is that of the parameter in which the limit is given; empty without a limit.
    """
    limits = list(power)
    rows = power_rows(limits, model.law, model.rig.quantities)
    names = ("effect", "detectable", "share", "distinguishable", "confounded_with")
    return [
        {**dict(zip(names, row, strict=True)), "hidden": p.hidden, "meaning": _meaning(p, model)}
        for p, row in zip(limits, rows, strict=True)
    ]


def _meaning(limit: Power, model: Model) -> str:
    if limit.detectable_80 is None or limit.always:
        return ""
    return parameters_of(model.law, (limit.effect,))[f"{limit.effect}.{limit.parameter}"].meaning


def of_diagnosis(diagnosis: Diagnosis) -> Answer:
    """Verdict, summary and proposed run of a diagnosis, for the page."""
    content = diagnosis.to_dict()
    next_run = diagnosis.experiment
    return {
        "headline": headline_and_rest(diagnosis)[0],
        "sentence": verdict_sentence(diagnosis, ""),
        "summary": diagnosis.summary(full=True),
        "next_run": None if next_run is None else next_run.run.to_csv(),
        **{
            key: content[key]
            for key in ("verdict", "effects", "alternatives", "weights", "steps",
                        "residual_structure", "next_experiment", "not_tried", "elapsed_s")
        },
    }  # fmt: skip


def typical_values(comparison: Comparison) -> dict[str, float]:
    """Values of the parameters of each further applicable effect at its typical strength.

    These are the first starting values of a fit, which depend on the runs.
    """
    model = comparison.model
    law = find_law(model.law)
    further = tuple(
        page.name
        for page in effects().values()
        if page.name not in model.effects and reason_not_applicable(page, model.law) is None
    )
    pages = parameters_of(model.law, further)
    added = {name: page for name, page in pages.items() if "." in name}
    starts = with_starts(added, comparison.campaign, not law.needs_bearing)
    return {name: float(page.starts[0]) for name, page in starts.items()}


def write_records(comparison: Comparison, folder: Path) -> Answer:
    """Write the records of a comparison, and the typical values of further effects, to a folder.

    The file of a run has its time, speed, friction, prediction, included samples and position.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / TYPICAL).write_text(json.dumps(typical_values(comparison)), encoding="utf-8")
    rows = zip(
        comparison.campaign.prepared,
        comparison.predictions,
        comparison.samples.counted,
        strict=True,
    )
    for number, (p, predicted, counted) in enumerate(rows):
        np.save(
            folder / f"{number}.npy",
            np.vstack(
                [
                    p.run.time_s,
                    p.motion.velocity,
                    p.friction,
                    predicted,
                    counted,
                    p.motion.angle_rad,
                ]
            ),
        )
    return {"record_names": [p.run.name for p in comparison.campaign.prepared]}
