"""Campaigns as recorded by a logger, and clean runs of the same rig."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ..campaign import rig_toml
from ..catalogue import check
from ..designs import Design, draw_design, draw_effects, draw_film_start
from ..excitation import Plan, campaign, held_out
from ..lubricant import Parameters
from ..record import Record
from ..seeds import stream
from ..simulate import under_load
from .catalogue import OFF_GRID, chosen
from .draft import Artefact, Signals, Sizes
from .logger import logged, sizes_of

Runs = dict[str, Record]
NEED_PEAK = {"saturation", "noise_with_force"}


def _signals(design: Design, effects: Parameters, plan: Plan, seed: int) -> Signals:
    rng = stream(seed, "start", plan.motion.name)
    base = under_load(design.base, round(plan.load_share * design.base.load_n, 1), effects)
    angle = float(rng.uniform(0.0, 2.0 * math.pi))
    film = None
    if plan.begins_s > 0.0:
        film = draw_film_start(base, plan.motion.pieces[0].speed(0.0), rng)
    return Signals(base, effects, plan.motion, plan.begins_s, angle, film)


def recorded(
    seed: int,
    effects: Sequence[str] = (),
    artefacts: Sequence[str] = (OFF_GRID,),
    artefact_strength: str = "usual",
    strength: float = 1.0,
    *,
    for_held_out: bool = False,
) -> tuple[Runs, dict[str, Any]]:
    """Simulate the runs of a campaign with a logger; return records by name and true values.

    Parameters
    ----------
    seed
        Seed of rig, motions, noise, effects and artefacts, each with its own random stream.
    effects
        Names from the catalogue of effects; their parameters are drawn at `strength`.
    artefacts
        Recording artefacts: names of `ARTEFACTS`, or `off_grid` for no artefact.
    artefact_strength
        `mild`, `usual` or `severe`.
    for_held_out
        Whether to simulate other motions, recorded without artefacts.
    """
    design = draw_design(seed)
    names = tuple(effects)
    hidden = check(draw_effects(names, design.base, seed, strength))
    done_by = [] if for_held_out else chosen(tuple(artefacts))
    sizes = sizes_of(done_by, artefact_strength, seed)
    plans = (held_out if for_held_out else campaign)(design, names, seed)
    records: Runs = {}
    peak_n = design.base.f_m * design.base.load_n
    if NEED_PEAK & set(sizes):
        peak_n = _peak([_signals(design, hidden, plan, seed) for plan in plans])
    recording: list[dict[str, Any]] = []
    over_noise = dict.fromkeys(hidden, 0.0)
    for plan in plans:
        signals = _signals(design, hidden, plan, seed)
        does = [(a, sizes[a.name]) for a in done_by]
        record, done = _logged(signals, plan, design, peak_n, does, seed)
        records[plan.motion.name] = record
        recording += done
        for name in hidden:
            rest = {other: values for other, values in hidden.items() if other != name}
            bare = _signals(design, rest, plan, seed)
            over_noise[name] = max(over_noise[name], _gap(signals, bare, record) / design.noise_n)
    truth = {
        "effects": hidden,
        "artefacts": list(artefacts),
        "strength": artefact_strength,
        "recording": recording,
        "base": asdict(design.base),
        "noise_n": design.noise_n,
        "rate_hz": design.rate_hz,
        "seed": seed,
        "effect_to_noise": over_noise,
    }
    return records, truth


def _peak(runs: Sequence[Signals]) -> float:
    """99.5 % quantile of the absolute force over the runs of a campaign, N."""
    coarse = [s.force(np.arange(0.0, s.motion.duration_s - s.begins_s, 0.05)) for s in runs]
    return float(np.quantile(np.abs(np.concatenate(coarse)), 0.995))


def _logged(
    signals: Signals,
    plan: Plan,
    design: Design,
    peak_n: float,
    artefacts: list[tuple[Artefact, Sizes]],
    seed: int,
) -> tuple[Record, list[dict[str, Any]]]:
    return logged(
        signals,
        plan.length_s,
        design.rate_hz,
        design.noise_n,
        peak_n,
        design.counts_per_rad,
        artefacts,
        seed,
        plan.motion.name,
    )


def _gap(signals: Signals, bare: Signals, record: Record) -> float:
    """RMS of the change of the force by an effect in a run, N, a measure of its visibility."""
    times = record.time_s
    return float(np.sqrt(np.mean((signals.force(times) - bare.force(times)) ** 2)))


def write_recorded(
    folder: str | Path,
    held_out_folder: str | Path,
    seed: int,
    effects: Sequence[str] = (),
    artefacts: Sequence[str] = (OFF_GRID,),
    artefact_strength: str = "usual",
) -> dict[str, Any]:
    """Write a campaign and its held-out runs; return the true values.

    The file of the true values is next to the first folder.
    """
    records, truth = recorded(seed, effects, artefacts, artefact_strength)
    others, _ = recorded(seed, effects, for_held_out=True)
    design = draw_design(seed)
    for place, runs in ((Path(folder), records), (Path(held_out_folder), others)):
        place.mkdir(parents=True, exist_ok=True)
        rig = rig_toml(design.base.bearing, design.base.load_n)
        (place / "rig.toml").write_text(rig, encoding="utf-8")
        for name, record in runs.items():
            record.write(place / f"{name}.csv")
    text = json.dumps(truth, indent=1)
    (Path(folder).parent / f"{Path(folder).name}.json").write_text(text + "\n", encoding="utf-8")
    return truth
