"""Learning friction compensator of Cohn (1998), section 6.4."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from jbf.control.bench import THESIS_LOAD_N, THESIS_RIG, VOLTS_PER_N_M, Bench
from jbf.control.schemes.scheme import Unguarded
from jbf.control.task import Task
from jbf.errors import InputError
from jbf.models.chain import core_bearing, core_load_n
from jbf.models.model import Model
from jbf.models.vocabulary import Clock
from jbf.records.rig import Rig

LISTED_VOLTS = 0.5 * THESIS_LOAD_N * 0.2245 * 4.0 * VOLTS_PER_N_M
"""Voltage for a friction coefficient of 1 in the program listings of Cohn (1998): 25.5 V.

This assumes that radius and load are in inches and pounds. In newton metres, the same factors
yield 2.89 V.
"""


@dataclass(frozen=True)
class Learning(Unguarded):
    """Learning friction compensator of Cohn (1998), section 6.4: adapts K0 and gamma to the error.

    The defaults are those of the program listings in the thesis.

    Attributes
    ----------
    rig
        Bearing and load.
    f_m, u_tr_m_s, eps_tr
        Boundary friction coefficient, transition speed (m/s) and transition eccentricity ratio of
        the journal law; None for the eccentricity that follows from the law.
    volts
        Voltage for a friction coefficient of 1; None for that of the bench. The listings use
        `LISTED_VOLTS`.
    k0, gamma
        Initial values of the adapted parameters.
    k0_gain, gamma_gain
        Adaptation gains per step of 2 ms; None for those of the listings, scaled in proportion to
        the initial values.
    k0_bounds, gamma_bounds
        Lower and upper bounds of the adapted parameters.
    clock
        Definition of the film's time constant.
    name
        Name of the scheme.
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
        """Create the scheme with the parameters of a fitted model, without its effects.

        Raises
        ------
        InputError
            The model's law is not `journal`.
        """
        if model.law != "journal":
            raise InputError(
                problem=f"the learning scheme requires the law journal, not {model.law}",
                remedy="choose another scheme",
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
        """Return the arguments from which the core builds the compensator; see `Scheme`."""
        load_n = core_load_n(self.rig) or 1.0
        return {
            "kind": "learning",
            "bearing": core_bearing(self.rig) or {},
            "load_n": load_n,
            "clock": self.clock,
            "f_m": self.f_m,
            "u_tr_m_s": self.u_tr_m_s,
            "k0": self.k0,
            "gamma": self.gamma,
            "eps_tr": self.eps_tr,
            "volts": bench.volts_per_n * load_n if self.volts is None else self.volts,
            "k0_gain": self.k0_gain,
            "gamma_gain": self.gamma_gain,
            "k0_bounds": self.k0_bounds,
            "gamma_bounds": self.gamma_bounds,
        }
