"""The compensators that users choose between, each with the numbers that its core part needs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from jbf.control.bench import THESIS_BENCH, THESIS_RIG, Bench, core_model, thesis_model
from jbf.control.settings import Settings
from jbf.control.task import Task
from jbf.control.tuning import friction_level_v, tune
from jbf.errors import InputError, did_you_mean
from jbf.models.chain import core_bearing, core_load_n
from jbf.models.model import Model
from jbf.models.vocabulary import Clock
from jbf.records.rig import Rig

POSITION_GAINS = (0.43764, -0.25164)
VELOCITY_GAINS = (1.0, 0.295)
"""k1 (V/rad), k2 (V s/rad) and g, C (V s/rad) of the thesis's control laws."""

OBSERVER_1_S = 15.0
"""Gain of the thesis's velocity observer."""

_THESIS_DRIVE = (THESIS_BENCH.damping_1_s, THESIS_BENCH.input_rad_s2_v)

LISTED_VOLTS = 0.5 * 104.0 * 0.2245 * 4.0 * 0.547
"""What a friction coefficient of 1 is in volts in the thesis's listings: 25.5 V, if radius and
load are in inches and pounds. Newton metres make 2.89 V of the same factors."""

_TABLE_ENTRIES = 64


class Scheme(Protocol):
    """Anything that the bench can put into its loop."""

    @property
    def name(self) -> str:
        """Its name in options, tables and pictures."""
        ...

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """What the core's compensator is built from."""
        ...

    def guard(self, bench: Bench) -> Settings | None:
        """Settings whose `moving_v` and `patience_s` guard the loop; None for no guard."""
        ...


class _Unguarded:
    """Nothing but a jump of the counter stops it, as in the thesis."""

    def guard(self, bench: Bench) -> Settings | None:
        """See `Scheme`."""
        return None


@dataclass(frozen=True)
class NoCompensation(_Unguarded):
    """The control law alone."""

    name: str = "none"

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """See `Scheme`."""
        return {"nothing": True}


@dataclass(frozen=True)
class Coulomb(_Unguarded):
    """The Coulomb friction observer, (6.1): gain k_F, exponent p, the most it may learn."""

    gain: float = 0.01
    exponent: float = 1.0
    limit_v: float = 5.0
    start_v: float = 0.0
    name: str = "coulomb"

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """See `Scheme`."""
        return {
            "gain": self.gain,
            "exponent": self.exponent,
            "damping_1_s": bench.damping_1_s,
            "input_rad_s2_v": bench.input_rad_s2_v,
            "limit_v": self.limit_v,
            "start_v": self.start_v,
        }


@dataclass(frozen=True)
class Learning(_Unguarded):
    """The thesis's learning compensator with the numbers of its programs.

    `volts` is what a friction coefficient of 1 is in volts, by default the bench's own scale; the
    thesis's listings have `LISTED_VOLTS`. Gains are per step of 2 ms; those left None are the
    listings', in proportion to the parameters that learning starts from.
    """

    rig: Rig = THESIS_RIG
    f_m: float = 0.26
    u_tr_m_s: float = 0.05
    eps_tr: float | None = 0.9747
    volts: float | None = None
    k0: float = 650_000.0
    gamma: float = 33.0
    k0_gain: float | None = None
    gamma_gain: float | None = None
    k0_bounds: tuple[float, float] = (1.0, 1e8)
    gamma_bounds: tuple[float, float] = (1e-3, 1e4)
    clock: Clock = "thesis"
    name: str = "learning"

    @classmethod
    def of(cls, model: Model) -> Learning:
        """It starts from a fitted model's parameters, effects left out.

        Raises
        ------
        InputError
            The model's law is not the journal's.
        """
        if model.law != "journal":
            raise InputError(
                problem=f"the learning scheme runs the journal's film, this is {model.law}",
                mend="choose another scheme",
            )
        values = {n: p.value for n, p in model.parameters.items()}
        return cls(
            rig=model.rig,
            f_m=values["f_m"],
            u_tr_m_s=values["U_tr_m_s"],
            eps_tr=None,
            k0=values["K0"],
            gamma=values["gamma"],
            k0_bounds=(1e-4 * values["K0"], 1e2 * values["K0"]),
            gamma_bounds=(1e-4 * values["gamma"], 1e2 * values["gamma"]),
            clock=model.clock,
        )

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """See `Scheme`."""
        k0_gain, gamma_gain = (12_500.0, 0.5) if task.is_position else (15_000.0, 2.0)
        load_n = core_load_n(self.rig) or 1.0
        k0_gain, gamma_gain = k0_gain / 650_000.0 * self.k0, gamma_gain / 33.0 * self.gamma
        return {
            "bearing": core_bearing(self.rig) or {},
            "load_n": load_n,
            "clock": self.clock,
            "f_m": self.f_m,
            "u_tr_m_s": self.u_tr_m_s,
            "k0": self.k0,
            "gamma": self.gamma,
            "eps_tr": self.eps_tr,
            "volts": bench.volts_per_n * load_n if self.volts is None else self.volts,
            "k0_gain": k0_gain if self.k0_gain is None else self.k0_gain,
            "gamma_gain": gamma_gain if self.gamma_gain is None else self.gamma_gain,
            "k0_bounds": self.k0_bounds,
            "gamma_bounds": self.gamma_bounds,
            "gate_rad": 0.8,
            "clip_rad": 0.3,
        }


@dataclass(frozen=True)
class Table(_Unguarded):
    """A look-up table of the model's steady friction against speed, from zero at rest."""

    model: Model
    name: str = "table"

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """See `Scheme`."""
        bearing = self.model.rig.bearing
        radius_m = 1.0 if bearing is None else bearing.radius_m
        width = max(task.top_speed_rad_s, 1.0) / (_TABLE_ENTRIES - 1)
        speeds = np.maximum(np.arange(_TABLE_ENTRIES) * width, 1e-3 * width) * radius_m
        levels = self.model.steady_friction(speeds) * bench.volts_per_n
        # A ramp through rest: the full level with the sign of an estimate would hunt there.
        levels[0] = 0.0
        return {
            "levels_v": levels.tolist(),
            "by_angle": False,
            "width": width,
            "viscous_v_s": 0.0,
        }


@dataclass(frozen=True)
class Repetitive(_Unguarded):
    """Learning from lap to lap: gain in volts per unit of error, smoothing, lead, limit."""

    gain: float | None = None
    smooth: float = 0.1
    lead_s: float | None = None
    limit_v: float = 3.0
    name: str = "repetitive"

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """See `Scheme`."""
        # Half of what the loop's stiffness against a steady disturbance would take.
        g, c = gains(task, bench)
        stuck = bench.input_rad_s2_v / (bench.damping_1_s + OBSERVER_1_S)
        stiffness = g / (1.0 + c * stuck) if task.is_position else g + c
        lead = (0.1 if task.is_position else 0.02) if self.lead_s is None else self.lead_s
        return {
            "steps_per_lap": round(task.period_s / bench.dt_s),
            "lap_gain": 0.5 * stiffness if self.gain is None else self.gain,
            "smooth": self.smooth,
            "lead_s": lead,
            "limit_v": self.limit_v,
        }


@dataclass(frozen=True)
class Observed:
    """A friction model corrected by an observer; settings from `tune` unless given."""

    model: Model
    settings: Settings | None = None
    start: tuple[float, float] = (0.0, 0.0)
    name: str = "observed"

    def guard(self, bench: Bench) -> Settings:
        """See `Scheme`."""
        return tune(self.model, bench) if self.settings is None else self.settings

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """See `Scheme`."""
        s = self.guard(bench)
        w, b = s.loop_rad_s, bench.input_rad_s2_v
        law = gains(task, bench)
        stiffer = (0.0, 0.0)
        if task.is_position:
            wanted = (w * w / b, (w * math.sqrt(2.0) - bench.damping_1_s) / b)
            stiffer = (wanted[0] - law[0], wanted[1] - law[1])
        return {
            "model": core_model(self.model),
            "volts_per_n": bench.volts_per_n,
            "damping_1_s": bench.damping_1_s,
            "input_rad_s2_v": b,
            "bandwidth_rad_s": s.bandwidth_rad_s,
            "learning_1_s": s.learning_1_s,
            "level_limit_v": s.level_limit_v,
            "rest_limit_v": s.rest_limit_v,
            "slow_rad_s": s.slow_rad_s,
            "approach_1_s": w / 3.0 if task.is_position else 0.0,
            "breakaway": s.breakaway,
            "stiffer_v_rad": stiffer[0],
            "stiffer_v_s_rad": stiffer[1],
            "law_forward_v_s_rad": -law[1] if task.is_position else law[1],
            "start": self.start,
        }


SCHEMES = ("none", "learning", "coulomb", "table", "repetitive", "observed")
"""Names that `scheme` knows."""


def scheme(name: str, model: Model | None = None, settings: Settings | None = None) -> Scheme:
    """The scheme of that name; `model` is what it knows of friction, where it knows any.

    Without a model the learning scheme has the thesis's own numbers, a table and the observed
    compensator the friction that fits the thesis's bench.

    Raises
    ------
    InputError
        The name is not known, or the scheme does not go with the model's law.
    """
    if name == "table":
        return Table(thesis_model() if model is None else model)
    if name == "observed":
        return Observed(thesis_model() if model is None else model, settings)
    if name == "learning":
        return Learning() if model is None else Learning.of(model)
    plain: dict[str, type[NoCompensation | Coulomb | Repetitive]] = {
        "none": NoCompensation,
        "coulomb": Coulomb,
        "repetitive": Repetitive,
    }
    if name not in plain:
        raise InputError(problem=f'there is no scheme "{name}"', mend=did_you_mean(name, SCHEMES))
    return plain[name]()


def gains(task: Task, bench: Bench) -> tuple[float, float]:
    """Gains of the control law: the thesis's, on another drive those with the same poles."""
    a, b = bench.damping_1_s, bench.input_rad_s2_v
    if (a, b) == _THESIS_DRIVE:
        return POSITION_GAINS if task.is_position else VELOCITY_GAINS
    if task.is_position:
        return 200.0 / b, (20.0 - a) / b
    return _THESIS_DRIVE[1] / b, a / b


def core_loop(task: Task, bench: Bench, guard: Settings | None) -> dict[str, Any]:
    """Encoder, velocity observer, control law and limits of the loop.

    Without a `guard` nothing but a jump of the counter stops a compensator, as in the thesis.
    """
    position = task.is_position
    return {
        "dt_s": bench.dt_s,
        "position": position,
        "gains": gains(task, bench),
        "observer_1_s": OBSERVER_1_S,
        "observer_damping_1_s": bench.damping_1_s if position else 0.0,
        "observer_input_rad_s2_v": bench.input_rad_s2_v if position else 0.0,
        "counts_per_rad": bench.counts_per_rad,
        "counter_bits": bench.counter_bits,
        "top_speed_rad_s": 2.0 * bench.limit_v * bench.input_rad_s2_v / bench.damping_1_s,
        "output_limit_v": bench.limit_v,
        "moving_v": bench.limit_v if guard is None else guard.moving_v,
        "patience_s": 1e5 if guard is None else guard.patience_s,
    }


__all__ = [
    "LISTED_VOLTS",
    "SCHEMES",
    "Coulomb",
    "Learning",
    "NoCompensation",
    "Observed",
    "Repetitive",
    "Scheme",
    "Table",
    "core_loop",
    "friction_level_v",
    "scheme",
]
