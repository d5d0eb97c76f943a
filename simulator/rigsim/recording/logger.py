"""Conversion of one run from the exact signals to the columns of the file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from ..record import Record, Vector
from ..seeds import stream
from .draft import Artefact, Draft, Signals, Sizes, Stage

TACHOMETER_M_S = 1e-4


def logged(
    signals: Signals,
    length_s: float,
    rate_hz: float,
    noise_n: float,
    peak_n: float,
    counts_per_rad: float,
    artefacts: Iterable[tuple[Artefact, Sizes]],
    seed: int,
    run: str,
) -> tuple[Record, list[dict[str, Any]]]:
    """Record a run; return its record, and kind, channel, run and size of each artefact."""
    stamps = np.arange(int(length_s * rate_hz)) / rate_hz
    draft = Draft(signals, stamps, noise_n, peak_n, counts_per_rad)
    done: list[dict[str, Any]] = []
    here = list(artefacts)

    def meet(stage: Stage) -> None:
        for artefact, sizes in here:
            if artefact.stage == stage:
                size = artefact.apply(draft, sizes, stream(seed, run, artefact.name))
                done.append(
                    {"kind": artefact.name, "channel": artefact.channel, "run": run, "size": size}
                )

    meet("rig")
    draft.instants = draft.force_instants = draft.force_stamps = stamps
    meet("clock")
    # With a slow clock, rounding may reverse the order of two jittered instants.
    draft.force_instants = np.maximum.accumulate(draft.force_instants)
    draft.clean = draft.signals.force(draft.force_instants)
    draft.force = draft.clean
    meet("cell")
    _add_noise(draft, meet, seed, run)
    meet("converter")
    draft.force, draft.clean = _onto_stamps(draft, draft.force), _onto_stamps(draft, draft.clean)
    meet("transport")
    _measure_motion(draft, seed, run)
    meet("motion")
    draft.load = np.full(len(stamps), signals.base.load_n)
    meet("load")
    draft.rows = np.arange(len(stamps))
    meet("rows")
    columns = (draft.stamps, draft.angle, draft.speed, draft.force, draft.load, draft.clean)
    return Record(*(column[draft.rows] for column in columns)), done


def _add_noise(draft: Draft, meet: Callable[[Stage], None], seed: int, run: str) -> None:
    count = len(draft.force)
    draft.unit = stream(seed, run, "noise").standard_normal(count)
    draft.scale, draft.extra = np.full(count, draft.noise_n), np.zeros(count)
    meet("noise")
    draft.force = draft.force + draft.scale * draft.unit + draft.extra


def _onto_stamps(draft: Draft, force: Vector) -> Vector:
    """Map a force with its own sampling instants to the time stamps, by interpolation or hold."""
    if draft.force_stamps is draft.stamps:
        return force
    if not draft.held:
        return np.interp(draft.stamps, draft.force_stamps, force)
    last = np.searchsorted(draft.force_stamps, draft.stamps, side="right") - 1
    return force[np.maximum(last, 0)]


def _measure_motion(draft: Draft, seed: int, run: str) -> None:
    angle, speed = draft.signals.angle(draft.instants), draft.signals.speed(draft.instants)
    noise = TACHOMETER_M_S * stream(seed, run, "tachometer").standard_normal(len(speed))
    draft.speed = np.where(speed == 0.0, 0.0, speed + noise)
    draft.angle = np.round(angle * draft.counts_per_rad) / draft.counts_per_rad


def sizes_of(artefacts: Iterable[Artefact], strength: str, seed: int) -> Mapping[str, Sizes]:
    """Draw the sizes of artefacts for a campaign, by the name of the artefact."""
    return {a.name: a.draw(strength, stream(seed, "artefact", a.name, strength)) for a in artefacts}
