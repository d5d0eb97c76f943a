"""What the plots ask for: stretches of runs, the plane, maps over all runs, a signature."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError
from jbf.models.catalogue import effects as catalogue
from jbf.models.model import Model
from jbf.workbench.density import Density, Size, density
from jbf.workbench.plane import within
from jbf.workbench.series import Seen, as_modelled, as_read, drawn, listed
from jbf.workbench.session import Session
from jbf.workbench.thinning import Stretch, ranges_of, thinned

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Box = tuple[float, float, float, float]
MAP_SPEEDS = 24


def seen(session: Session, number: int | None) -> dict[str, Seen]:
    """Every run by name: as a model saw it, or as it was read."""
    found = {run.name: as_read(run) for run in session.on_bench().runs}
    files = None if number is None else session.records(number)
    for name, file in (files or {}).items():
        found[name] = as_modelled(file)
    return found


def one(session: Session, number: int | None, name: str) -> Seen:
    """One run of them."""
    session.on_bench().run(name)
    return seen(session, number)[name]


def series(
    session: Session, number: int | None, name: str, span: tuple[float | None, float | None],
    pixels: int,
) -> dict[str, Any]:  # fmt: skip
    """A stretch of a run; where another model is put beside, its prediction, too."""
    whole = one(session, number, name)
    found = drawn(whole, *span, pixels)
    beside = session.models.beside
    if beside is not None and beside != number:
        other = one(session, beside, name)
        if other.model_n is not None and len(other.time_s) == len(whole.time_s):
            stretch = Stretch.between(
                whole.time_s, float(span[0] or whole.time_s[0]),
                float(whole.time_s[-1] if span[1] is None else span[1]), pixels,
            )  # fmt: skip
            found["beside_n"] = listed(thinned(whole.time_s, {"y": other.model_n}, stretch)["y"])
    return found


def plane(session: Session, number: int | None, names: list[str], size: Size) -> dict[str, Any]:
    """Friction against speed of some runs: where samples lie, and what the model says."""
    return _density(session, number, names, size).to_dict()


def _density(session: Session, number: int | None, names: list[str], size: Size) -> Density:
    return density(tuple(run for name, run in seen(session, number).items() if name in names), size)


def selected(run: Seen, name: str, selection: Mapping[str, Any]) -> Mask:
    """The samples of a run that a selection holds: a stretch of a run, or a box of the plane."""
    if "box" in selection:
        box: Box = tuple(map(float, selection["box"]))  # type: ignore[assignment]
        friction = run.friction_n
        if friction is None:
            return np.zeros(len(run.time_s), dtype=bool)
        return within(run.velocity_m_s, friction, box)
    if selection.get("run") != name:
        return np.zeros(len(run.time_s), dtype=bool)
    first, last = sorted((float(selection["from_s"]), float(selection["to_s"])))
    stretch: Mask = (run.time_s >= first) & (run.time_s <= last)
    return stretch


def brushed(
    session: Session, number: int | None, selection: Mapping[str, Any], names: list[str],
    size: Size,
) -> dict[str, Any]:  # fmt: skip
    """A selection everywhere: its stretches of each run, how the residual is there, and where its
    samples lie in the plane of some runs."""
    stretches: dict[str, list[tuple[float, float]]] = {}
    residuals, samples, masks = [], 0, {}
    for name, run in seen(session, number).items():
        mask = masks[run] = selected(run, name, selection)
        ranges, count = ranges_of(mask), int(np.count_nonzero(mask))
        samples += count
        if count:
            stretches[name] = [(float(run.time_s[a]), float(run.time_s[b - 1])) for a, b in ranges]
        residual = run.residual_n
        if residual is not None:
            residuals.append(residual[mask])
    there = np.concatenate(residuals) if residuals else np.empty(0)
    there = there[np.isfinite(there)]
    return {
        "samples": samples,
        "stretches_s": stretches,
        "rms_n": float(np.sqrt(np.mean(there**2))) if len(there) else None,
        "mean_n": float(np.mean(there)) if len(there) else None,
        "selected": _density(session, number, names, size).layer_of(masks),
    }


def map_of_runs(session: Session, number: int) -> dict[str, Any]:
    """The mean of record minus prediction over runs and speeds: a row a run, a column a speed."""
    runs = {n: s for n, s in seen(session, number).items() if s.residual_n is not None}
    if not runs:
        raise InputError(problem="this model has not been compared yet", mend="wait a moment")
    most = max(float(np.nanmax(np.abs(s.velocity_m_s))) for s in runs.values())
    # Finer round standstill, where friction changes most.
    half = most * np.linspace(0.0, 1.0, MAP_SPEEDS // 2 + 1) ** 2
    edges = np.concatenate([-half[:0:-1], half])
    rows = []
    for run in runs.values():
        residual = run.residual_n
        assert residual is not None
        ok = np.isfinite(residual)
        place = np.clip(np.digitize(run.velocity_m_s[ok], edges) - 1, 0, len(edges) - 2)
        counts = np.bincount(place, minlength=len(edges) - 1)
        sums = np.bincount(place, weights=residual[ok], minlength=len(edges) - 1)
        rows.append(listed(np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)))
    return {"runs": list(runs), "edges_m_s": edges.tolist(), "mean_n": rows}


def signature(
    session: Session, number: int, effect: str, name: str,
    span: tuple[float | None, float | None], pixels: int,
) -> dict[str, Any]:  # fmt: skip
    """What an effect at the catalogue's usual strength would add to a run, scaled so that it comes
    nearest to the residual."""
    run = session.on_bench().run(name)
    known = one(session, number, name)
    base = session.model(number)
    if effect in base.effects or effect not in catalogue():
        raise InputError(problem=f"{effect} is in the model already, or unknown", mend="choose")
    richer = Model(base.rig, base.law, [*base.effects, effect], _usual(base, effect), base.clock)
    added = richer.predict(run) - base.predict(run)
    added = np.interp(known.time_s, run.time_s, added)
    residual = known.residual_n
    if residual is None:
        raise InputError(problem="this model has not been compared yet", mend="wait a moment")
    ok = np.isfinite(residual) & np.isfinite(added)
    square = float(added[ok] @ added[ok])
    scale = float(residual[ok] @ added[ok]) / square if square > 0 else 0.0
    stretch = Stretch.between(
        known.time_s,
        float(known.time_s[0] if span[0] is None else span[0]),
        float(known.time_s[-1] if span[1] is None else span[1]),
        pixels,
    )
    shown = thinned(known.time_s, {"residual_n": residual, "signature_n": scale * added}, stretch)
    return {"times_usual": scale, **{k: listed(v, 11 if k == "time_s" else 6)
                                     for k, v in shown.items()}}  # fmt: skip


def _usual(base: Model, effect: str) -> dict[str, float]:
    values = {name: p.value for name, p in base.parameters.items()}
    page = catalogue()[effect]
    return {**values, **{f"{effect}.{p.name}": p.starts[0] for p in page.parameters}}
