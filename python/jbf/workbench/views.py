"""Data of the workbench's plots: time series, plane, map over all runs."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.workbench.density import Density, Size, density
from jbf.workbench.plane import within
from jbf.workbench.series import RunSeries, as_modelled, as_read, drawn, listed
from jbf.workbench.session import Session
from jbf.workbench.thinning import ranges_of, stretch_of, thinned

MAP_SPEEDS = 24


def series_by_run(session: Session, number: int | None) -> dict[str, RunSeries]:
    """Time series of every run by name, with the prediction of a model if available."""
    by_name = {run.name: as_read(run) for run in session.on_bench().runs}
    files = None if number is None else session.records(number)
    for name, file in (files or {}).items():
        by_name[name] = as_modelled(file)
    return by_name


def series_of_run(session: Session, number: int | None, name: str) -> RunSeries:
    """Time series of one run, with the prediction of a model if available."""
    session.on_bench().run(name)
    return series_by_run(session, number)[name]


def series(
    session: Session, number: int | None, name: str, span: tuple[float | None, float | None],
    pixels: int,
) -> dict[str, Any]:  # fmt: skip
    """Data of a section of a run for a plot, with the predictions of the compared models."""
    run = series_of_run(session, number, name)
    section = drawn(run, *span, pixels)
    section["others"] = [
        {"model": other, **curves}
        for other in session.models.compared
        if other != number and (curves := _curves_of(session, other, name, run, span, pixels))
    ]
    return section


def _curves_of(
    session: Session, number: int, name: str, run: RunSeries,
    span: tuple[float | None, float | None], pixels: int,
) -> dict[str, Any] | None:  # fmt: skip
    """Prediction and residual of a further model for a plot; None if it has no prediction."""
    other = series_of_run(session, number, name)
    if other.model_n is None or len(other.time_s) != len(run.time_s):
        return None
    columns = {"model_n": other.model_n}
    if other.residual_n is not None:
        columns["residual_n"] = other.residual_n
    reduced = thinned(run.time_s, columns, stretch_of(run.time_s, span, pixels))
    return {column: listed(reduced[column]) for column in columns}


def plane(
    session: Session, number: int | None, names: list[str], size: Size, axis: str = "speed"
) -> dict[str, Any]:
    """Data of the friction-speed or friction-position plane of some runs.

    The data are the density of samples and of the model, and the samples that a fit does not use.
    """
    return _density(session, number, names, size, axis).to_dict()


def _density(
    session: Session, number: int | None, names: list[str], size: Size, axis: str
) -> Density:
    shown = (run for name, run in series_by_run(session, number).items() if name in names)
    return density(tuple(shown), size, axis)


def masks_of(
    session: Session,
    number: int | None,
    selection: Mapping[str, Any],
    runs: Mapping[str, RunSeries],
) -> dict[str, Mask]:
    """Mask of the selected samples of each run, by name.

    A selection is one of three kinds: an interval of a run (`run`, `from_s`, `to_s`); a `box` of
    the plane in all runs or in one `run`; or the `mark` of a model's failure by its index. The box
    contains smallest and largest speed (or position, if `axis` is `position`) and force, with None
    for an open end.
    """
    if "mark" in selection:
        return _mask_of_bins(session, number, int(selection["mark"]), runs)
    only = selection.get("run")
    masks = {name: np.zeros(len(run.time_s), dtype=bool) for name, run in runs.items()}
    if "box" in selection:
        ends = zip(selection["box"], (-np.inf, np.inf, -np.inf, np.inf), strict=True)
        left, right, low, high = (open_ if end is None else float(end) for end, open_ in ends)
        for name, run in runs.items():
            across = run.across(str(selection.get("axis", "speed")))
            if run.friction is not None and across is not None and only in (None, name):
                box = (left, right, low, high)
                masks[name] = within(across, run.friction, box)
    elif only in masks:
        time = runs[only].time_s
        first, last = sorted((float(selection["from_s"]), float(selection["to_s"])))
        masks[only] = (time >= first) & (time <= last)
    return masks


def _mask_of_bins(
    session: Session, number: int | None, place: int, runs: Mapping[str, RunSeries]
) -> dict[str, Mask]:
    """Mask of the samples in the worst bin of a residual pattern, by run."""
    node = session.models.node(number)
    if not 0 <= place < len(node["failures"]):
        raise InputError(
            problem="the model has no such lack of fit", remedy="choose one of the list"
        )
    ranges = node["failures"][place]["ranges_s"]
    names = node["record_names"]
    masks = {name: np.zeros(len(run.time_s), dtype=bool) for name, run in runs.items()}
    for key, stretches in ranges.items():
        name = names[int(key)]
        if name not in masks:
            continue
        time = runs[name].time_s
        for first, last in stretches:
            # The ends are samples of the record, which are written and read exactly.
            begin, end = np.searchsorted(time, first), np.searchsorted(time, last, side="right")
            masks[name][begin:end] = True
    return masks


def brushed(
    session: Session, number: int | None, selection: Mapping[str, Any], names: list[str],
    size: Size, axis: str = "speed",
) -> dict[str, Any]:  # fmt: skip
    """Statistics and positions of selected samples, for all views.

    The result contains intervals and residual per run, speed range, cells in the map over runs, and
    density in the plane of some runs.
    """
    runs = series_by_run(session, number)
    masks = masks_of(session, number, selection, runs)
    edges = speed_edges(tuple(runs.values()))
    by_run: dict[str, dict[str, Any]] = {}
    residuals, cells, ends = [], [], []
    for row, (name, run) in enumerate(runs.items()):
        chosen = np.flatnonzero(masks[name])
        if not len(chosen):
            continue
        speed = run.velocity[chosen]
        ends += [float(np.nanmin(speed)), float(np.nanmax(speed))]
        cells += [(row, int(column)) for column in np.unique(_column(speed, edges))]
        residual = run.residual_n
        residual_values = np.empty(0) if residual is None else residual[chosen]
        residual_values = residual_values[np.isfinite(residual_values)]
        residuals.append(residual_values)
        stretches = [
            (float(run.time_s[a]), float(run.time_s[b - 1])) for a, b in ranges_of(masks[name])
        ]
        by_run[name] = {
            "samples": len(chosen),
            "rms": _rms(residual_values),
            "stretches_s": stretches,
        }
    residual_values = np.concatenate(residuals) if residuals else np.empty(0)
    return {
        "samples": sum(statistics["samples"] for statistics in by_run.values()),
        "by_run": by_run,
        "rms": _rms(residual_values),
        "mean_n": float(np.mean(residual_values)) if len(residual_values) else None,
        "speeds_m_s": [min(ends), max(ends)] if ends else None,
        "cells": cells,
        "selected": _density(session, number, names, size, axis).layer_of(
            {run: masks[name] for name, run in runs.items()}
        ),
    }


def _rms(values: Array) -> float | None:
    return float(np.sqrt(np.mean(values**2))) if len(values) else None


@lru_cache(maxsize=8)
def speed_edges(runs: tuple[RunSeries, ...]) -> Array:
    """Edges of the speed ranges (columns) of the map over runs, in the unit of speed of the rig.

    The ranges are narrower near standstill, where friction changes most.
    """
    top_speed = max((float(np.nanmax(np.abs(s.velocity))) for s in runs), default=0.0) or 1.0
    half = top_speed * np.linspace(0.0, 1.0, MAP_SPEEDS // 2 + 1) ** 2
    return np.concatenate([-half[:0:-1], half])


def _column(speed: Array, edges: Array) -> Array:
    return np.clip(np.digitize(speed, edges) - 1, 0, len(edges) - 2)


def map_of_runs(session: Session, number: int) -> dict[str, Any]:
    """Mean residual (record minus prediction), one row per run and one column per speed range."""
    runs = series_by_run(session, number)
    if all(run.residual_n is None for run in runs.values()):
        raise InputError(problem="this model has not been compared yet", remedy="wait a moment")
    edges = speed_edges(tuple(runs.values()))
    rows: list[list[float | None]] = []
    for run in runs.values():
        residual = run.residual_n
        if residual is None:
            # Excluded from the fit: an empty row, so that the rows match the runs everywhere.
            rows.append([None] * (len(edges) - 1))
            continue
        ok = np.isfinite(residual)
        place = _column(run.velocity[ok], edges)
        counts = np.bincount(place, minlength=len(edges) - 1)
        sums = np.bincount(place, weights=residual[ok], minlength=len(edges) - 1)
        rows.append(listed(np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)))
    return {"runs": list(runs), "edges_m_s": edges.tolist(), "mean_n": rows}
