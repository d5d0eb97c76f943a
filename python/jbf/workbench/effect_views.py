"""Changes of a model for a plot: the contribution of an effect, and other parameter values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.models.catalogue import effects as catalogue
from jbf.models.model import Model
from jbf.records.run import Run
from jbf.workbench.series import listed
from jbf.workbench.session import Session
from jbf.workbench.thinning import stretch_of, thinned
from jbf.workbench.views import series_of_run


def contribution(base: Model, effect: str, values: Mapping[str, float], run: Run) -> Array:
    """Friction that an effect adds to a model, shape (samples,).

    Parameters
    ----------
    base, effect
        The model, and the name of the effect.
    values
        Parameters of the effect by dotted name; those of other effects are ignored.
    run
        Run whose motion is used.
    """
    added = {key: value for key, value in values.items() if key.split(".")[0] == effect}
    present = {key: p.value for key, p in base.parameters.items()}
    effects = [*base.effects, effect]
    richer = Model(base.rig, base.law, effects, {**present, **added}, base.clock)
    difference: Array = richer.predict(run) - base.predict(run)
    return difference


def edited(
    session: Session, number: int, values: Mapping[str, float], name: str,
    span: tuple[float | None, float | None], pixels: int,
) -> dict[str, Any]:  # fmt: skip
    """Prediction for a run with changed parameter values, and its RMS error in that run.

    Raises
    ------
    InputError
        A name is unknown, or a value is outside its bounds.
    """
    run, run_series = session.on_bench().run(name), series_of_run(session, number, name)
    base = session.model(number)
    present = {key: p.value for key, p in base.parameters.items()}
    unknown = next((key for key in values if key not in present), None)
    if unknown is not None:
        raise InputError(key=unknown, problem="is not a parameter", remedy=f"choose {[*present]}")
    changed = Model(base.rig, base.law, base.effects, {**present, **values}, base.clock)
    predicted = np.interp(run_series.time_s, run.time_s, changed.predict(run))
    columns = {"edited": predicted}
    for key in ("friction_n", "model_n"):
        if key in run_series.columns():
            columns[key] = run_series.columns()[key]
    rms = None
    if run_series.friction is not None and run_series.counted is not None:
        used = (run_series.counted > 0) & np.isfinite(predicted)
        rms = float(np.sqrt(np.mean((run_series.friction - predicted)[used] ** 2)))
    reduced = thinned(run_series.time_s, columns, stretch_of(run_series.time_s, span, pixels))
    return {"rms": rms, **{k: listed(v, 11 if k == "time_s" else 6) for k, v in reduced.items()}}


def signature(
    session: Session, number: int, effect: str, name: str,
    span: tuple[float | None, float | None], pixels: int,
) -> dict[str, Any]:  # fmt: skip
    """Contribution of an effect to the friction of a run, scaled to the residual.

    The contribution is that at the typical strength, with the starting values of a fit to these
    runs. The factor is determined by least squares.

    Raises
    ------
    InputError
        The model has the effect, its law does not permit it, or the model was not compared yet.
    """
    run = session.on_bench().run(name)
    run_series = series_of_run(session, number, name)
    base = session.model(number)
    if effect in base.effects or effect not in catalogue():
        problem, remedy = f"{effect} is in the model already, or unknown", "select another effect"
        raise InputError(problem=problem, remedy=remedy)
    residual, values = run_series.residual_n, session.typical_values(number)
    if residual is None or values is None:
        raise InputError(problem="this model has not been compared yet", remedy="wait a moment")
    added = np.interp(run_series.time_s, run.time_s, contribution(base, effect, values, run))
    ok = np.isfinite(residual) & np.isfinite(added)
    square = float(added[ok] @ added[ok])
    scale = float(residual[ok] @ added[ok]) / square if square > 0 else 0.0
    stretch = stretch_of(run_series.time_s, span, pixels)
    reduced = thinned(
        run_series.time_s, {"residual_n": residual, "contribution": scale * added}, stretch
    )
    return {"times_usual": scale, **{k: listed(v, 11 if k == "time_s" else 6)
                                     for k, v in reduced.items()}}  # fmt: skip
