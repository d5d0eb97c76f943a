"""Changes of a model for a plot: the contribution of an effect, and other parameter values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.models.catalogue import effects as catalogue
from jbf.models.model import Model
from jbf.records.run import Run
from jbf.workbench.series import listed
from jbf.workbench.session import Session
from jbf.workbench.thinning import stretch_of, thinned
from jbf.workbench.views import series_of_run

Array = npt.NDArray[np.float64]


def contribution(base: Model, effect: str, run: Run) -> Array:
    """Friction that an effect of typical strength adds to a model, shape (samples,)."""
    richer = Model(base.rig, base.law, [*base.effects, effect], _usual(base, effect), base.clock)
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
    columns = {"edited_n": predicted}
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

    The contribution is that at the typical strength. The factor is determined by least squares.
    """
    run = session.on_bench().run(name)
    run_series = series_of_run(session, number, name)
    base = session.model(number)
    if effect in base.effects or effect not in catalogue():
        raise InputError(problem=f"{effect} is in the model already, or unknown", remedy="choose")
    added = np.interp(run_series.time_s, run.time_s, contribution(base, effect, run))
    residual = run_series.residual_n
    if residual is None:
        raise InputError(problem="this model has not been compared yet", remedy="wait a moment")
    ok = np.isfinite(residual) & np.isfinite(added)
    square = float(added[ok] @ added[ok])
    scale = float(residual[ok] @ added[ok]) / square if square > 0 else 0.0
    stretch = stretch_of(run_series.time_s, span, pixels)
    reduced = thinned(
        run_series.time_s, {"residual_n": residual, "signature_n": scale * added}, stretch
    )
    return {"times_usual": scale, **{k: listed(v, 11 if k == "time_s" else 6)
                                     for k, v in reduced.items()}}  # fmt: skip


def _usual(base: Model, effect: str) -> dict[str, float]:
    """Parameter values of a model with an additional effect of typical strength."""
    values = {name: p.value for name, p in base.parameters.items()}
    page = catalogue()[effect]
    return {**values, **{f"{effect}.{p.name}": p.starts[0] for p in page.parameters}}
