"""Compensation schemes with few friction parameters or none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from jbf.control.bench import Bench
from jbf.control.constants import OBSERVER_1_S
from jbf.control.loop import gains
from jbf.control.schemes.scheme import Unguarded
from jbf.control.task import Task


@dataclass(frozen=True)
class NoCompensation(Unguarded):
    """Control law without compensation."""

    name: str = "none"

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """Return the arguments from which the core builds the compensator; see `Scheme`."""
        return {"kind": "none"}


@dataclass(frozen=True)
class Coulomb(Unguarded):
    """Coulomb friction observer of Cohn (1998), section 6.1.

    Attributes
    ----------
    gain, exponent
        Gain k_F and exponent p of the adaptation.
    limit_v, start_v
        Limit and initial value of the learned friction level, V.
    name
        Name of the scheme.
    """

    gain: float = 0.01
    exponent: float = 1.0
    limit_v: float = 5.0
    start_v: float = 0.0
    name: str = "coulomb"

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """Return the arguments from which the core builds the compensator; see `Scheme`."""
        return {
            "kind": "coulomb",
            "gain": self.gain,
            "exponent": self.exponent,
            "limit_v": self.limit_v,
            "start_v": self.start_v,
        }


@dataclass(frozen=True)
class Repetitive(Unguarded):
    """Repetitive learning control: a correction over one period of the reference.

    Attributes
    ----------
    gain
        Learning gain, V per unit of the error; None for half of the loop's static stiffness.
    smooth
        Coefficient of the three-point smoothing of the correction, 0 to 0.5.
    lead_s
        Delay of the plant's response, by which the correction precedes the error, s; None for 0.1 s
        in position control and 0.02 s in velocity control.
    limit_v
        Limit of the correction, V.
    name
        Name of the scheme.
    """

    gain: float | None = None
    smooth: float = 0.1
    lead_s: float | None = None
    limit_v: float = 3.0
    name: str = "repetitive"

    def core(self, task: Task, bench: Bench) -> dict[str, Any]:
        """Return the arguments from which the core builds the compensator; see `Scheme`."""
        # Half of the gain that corresponds to the loop's stiffness against a steady disturbance.
        g, c = gains(task, bench)
        stuck = bench.input_rad_s2_v / (bench.damping_1_s + OBSERVER_1_S)
        stiffness = g / (1.0 + c * stuck) if task.is_position else g + c
        lead = (0.1 if task.is_position else 0.02) if self.lead_s is None else self.lead_s
        return {
            "kind": "repetitive",
            "steps_per_lap": round(task.period_s / bench.dt_s),
            "lap_gain": 0.5 * stiffness if self.gain is None else self.gain,
            "smooth": self.smooth,
            "lead_s": lead,
            "limit_v": self.limit_v,
        }
