"""Campaigns of the independent simulator in the format of jbf: the only link between the two."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "simulator"))

import rigsim
from jbf.models.catalogue import find_parameter, parameters_of
from rigsim.warmth import REFERENCE_C


def simulated(
    seed: int, effects: tuple[str, ...] = (), **options: Any
) -> tuple[jbf.Rig, list[jbf.Run], dict[str, Any]]:
    """Simulate a campaign and return the rig, its runs and the true values.

    `options` are those of `rigsim.simulate_campaign`.
    """
    records, truth = rigsim.simulate_campaign(seed, effects, **options)
    rig = rig_of(truth["base"]["load_n"])
    if any(r.temperature_c is not None for r in records.values()):
        # The viscosity applies at a temperature, which is known if there is a thermometer.
        assert rig.lubricant is not None
        oil = replace(rig.lubricant, temperature_c=REFERENCE_C)
        rig = replace(rig, lubricant=oil)
    return rig, runs_of(records), truth


def runs_of(records: dict[str, rigsim.Record]) -> list[jbf.Run]:
    """Convert simulated records to runs."""
    return [
        jbf.Run.from_arrays(
            r.time_s,
            r.velocity,
            r.friction,
            angle_rad=r.angle_rad,
            load_n=r.load_n,
            temperature_c=r.temperature_c,
            name=name,
        )
        for name, r in records.items()
    ]


def rig_of(load_n: float) -> jbf.Rig:
    """Return the rig of the simulator for a load drawn by it, N."""
    return jbf.Rig.thesis("4.2" if load_n == 104.0 else "4.3")


def errors_in_sigma(
    fit: jbf.Fit, base: Mapping[str, float], effects: Mapping[str, Mapping[str, float]]
) -> dict[str, float]:
    """Return estimate minus true value in standard errors, by parameter.

    A parameter for which the fit gives no interval has NaN.
    """
    pages = parameters_of("journal", tuple(effects))
    values = {"f_m": base["f_m"], "U_tr_m_s": base["U_tr"], "K0": base["K0"]}
    values["gamma"] = base["gamma"]
    for effect, parameters in effects.items():
        values |= {find_parameter(f"{effect}.{name}", pages): v for name, v in parameters.items()}
    errors = {}
    for name, value in values.items():
        estimate, period = fit.parameters[name], pages[name].period
        off = estimate.value - value
        if period is not None:
            off -= period * round(off / period)
        errors[name] = off / estimate.stderr if estimate.stderr else math.nan
    return errors
