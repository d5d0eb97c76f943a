"""Twelve reference campaigns and their diagnoses, shared by all tests.

The campaigns cover every verdict, bearings and drives, direct simulation and simulated loggers.
`test_golden_diagnoses.py` compares each diagnosis with the truth of its campaign. A test that needs
any diagnosis, fit or report uses one of them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from campaigns import campaign
from jbf import Bearing, Diagnosis, Load, Lubricant, Rig, Run, diagnose
from rigruns import runs_of
from rigsim import AxisRun, axis_campaign
from rigsim.motions import sine
from rigsim.recording import recorded
from shared import shared

Simulated = tuple[Rig, list[Run], float]
"""A rig, its runs, and the standard deviation of their noise and rounding errors (N)."""


@dataclass(frozen=True)
class Golden:
    """A campaign, the law that it is diagnosed with, and the expected result.

    Attributes
    ----------
    simulate
        Creates the campaign.
    verdict, effects
        Expected result; the effects are those of the simulation.
    alternatives
        Effects expected to be as likely as the only effect.
    findings
        Kinds of data-quality findings that the simulated logger causes.
    law
        The base law; None for the rig's default.
    """

    simulate: Callable[[], Simulated]
    verdict: str
    effects: frozenset[str] = frozenset()
    alternatives: tuple[str, ...] = ()
    findings: frozenset[str] = frozenset()
    law: str | None = None


def _bearing(
    seed: int, *effects: str, foreign: tuple[str, ...] = (), one_direction: bool = False
) -> Simulated:
    if one_direction:
        motions = tuple(
            sine(f"one_way_{rate:g}", duration_s, 0.0595, rate, bias=0.0728)
            for rate, duration_s in ((0.25, 50.3), (1.0, 25.2))
        )
        rig, runs, truth = campaign(seed, effects, foreign=foreign, motions=motions)
    else:
        rig, runs, truth = campaign(seed, effects, foreign=foreign)
    return rig, runs, truth["noise_n"]


def axis_run(record: AxisRun, path: str) -> Run:
    """A simulated record as a run; `path` is `angle_rad` or `position_m`."""
    column: dict[str, Any] = {path: record.path}
    return Run.from_arrays(
        record.time_s,
        record.velocity,
        record.force_n,
        load_n=record.load_n,
        temperature_c=record.temperature_c,
        name=record.name,
        **column,
    )


def _drive(seed: int, path: str, *effects: str, swing: float = 1.0) -> Simulated:
    records, truth = axis_campaign(seed, effects, swing=swing, runs=3)
    noise_rms: Any = truth["noise_n"]
    return Rig(), [axis_run(record, path) for record in records], noise_rms


def _stribeck_slide() -> Simulated:
    """Three runs of a slide whose Stribeck curve is defined here, independently of jbf."""
    noise_rms, runs = 0.2, []
    for k, (amplitude, period_s) in enumerate([(0.02, 4.0), (0.1, 3.0), (0.05, 2.5)]):
        t = np.arange(0.0, 24.0, 0.01)
        v = amplitude * np.sin(2.0 * np.pi * t / period_s)
        friction = np.sign(v) * (6.0 + 5.0 * np.exp(-((v / 0.01) ** 2)) + 30.0 * np.abs(v))
        noise = noise_rms * np.random.default_rng(k).standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, friction + noise, name=f"run {k}"))
    return Rig(), runs, noise_rms


def _recorded(seed: int, artefact: str, *effects: str) -> Simulated:
    records, truth = recorded(seed, effects, (artefact,), "usual")
    dimensions = dict(truth["base"]["bearing"])
    lubricant = Lubricant(dimensions.pop("viscosity_pa_s"))
    rig = Rig(Bearing(**dimensions), lubricant, Load(truth["base"]["load_n"]))
    steps_n = [done["size"].get("step_n", 0.0) for done in truth["recording"]]
    rounding_n = max(steps_n, default=0.0) / np.sqrt(12.0)
    return rig, runs_of(records), float(np.hypot(truth["noise_n"], rounding_n))


GOLDEN = {
    "bearing_nothing_missing": Golden(lambda: _bearing(7), "adequate"),
    "bearing_coulomb_drag": Golden(
        lambda: _bearing(34, "coulomb_drag"), "missing", frozenset({"coulomb_drag"})
    ),
    "bearing_two_effects": Golden(
        lambda: _bearing(11, "coulomb_drag", "position_ripple"),
        "missing",
        frozenset({"coulomb_drag", "position_ripple"}),
    ),
    "bearing_one_direction": Golden(
        lambda: _bearing(65, "coulomb_drag", one_direction=True),
        "ambiguous",
        frozenset({"coulomb_drag"}),
        alternatives=("sensor_offset",),
    ),
    "bearing_hum": Golden(lambda: _bearing(13, foreign=("hum",)), "unexplained"),
    "slide_nothing_missing": Golden(lambda: _drive(13, "position_m"), "adequate", law="coulomb"),
    "slide_load_dependence": Golden(
        lambda: _drive(15, "position_m", "dry_load_dependence", "zero_load_dependence"),
        "missing",
        frozenset({"dry_load_dependence", "zero_load_dependence"}),
        law="coulomb",
    ),
    "joint_gravity": Golden(
        lambda: _drive(14, "angle_rad", "gravity", swing=8.0),
        "missing",
        frozenset({"gravity"}),
        law="coulomb",
    ),
    "slide_law_selection": Golden(_stribeck_slide, "adequate", law="auto"),
    "recorded_late_force": Golden(
        lambda: _recorded(1009, "skew"), "adequate", findings=frozenset({"late_channel"})
    ),
    "recorded_quantised_drag": Golden(
        lambda: _recorded(1004, "quantised", "coulomb_drag"),
        "missing",
        frozenset({"coulomb_drag"}),
        findings=frozenset({"steps"}),
    ),
    "recorded_gaps_lag": Golden(
        lambda: _recorded(1005, "gaps", "sensor_lag"),
        "missing",
        frozenset({"sensor_lag"}),
        findings=frozenset({"gaps"}),
    ),
}
"""The campaigns by name."""
EXTENDED = (
    "bearing_two_effects",
    "slide_nothing_missing",
    "slide_load_dependence",
    "recorded_late_force",
    "recorded_gaps_lag",
)
"""Campaigns whose diagnoses are computed in the extended suite only."""


@cache
def golden_campaign(name: str) -> Simulated:
    """Rig, runs and standard deviation of noise and rounding errors (N) of a reference campaign."""
    return GOLDEN[name].simulate()


@shared
def golden(name: str) -> Diagnosis:
    """The diagnosis of a reference campaign."""
    rig, runs, _ = golden_campaign(name)
    law = GOLDEN[name].law
    return diagnose(rig, runs) if law is None else diagnose(rig, runs, law=law)
