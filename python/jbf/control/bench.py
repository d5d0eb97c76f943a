"""Simulated bench: motor, shaft, encoder and noise, with a `jbf.Model` as friction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from jbf import _core
from jbf.control.constants import COUNTER_BITS, COUNTS_PER_RAD, DRIVE
from jbf.errors import InputError
from jbf.models import catalogue
from jbf.models.chain import core_bearing, core_load_n
from jbf.models.model import Model
from jbf.models.user_effects import UserEffect
from jbf.models.user_laws import UserLaw
from jbf.models.vocabulary import Clock
from jbf.records.rig import Rig


@dataclass(frozen=True)
class Bench:
    """Simulated bench: plant `v' = -a v + b (u - F)` with encoder, counter and noise.

    Attributes
    ----------
    damping_1_s, input_rad_s2_v : float
        Parameters a and b of the plant.
    volts_per_n : float
        Voltage equivalent to one newton of friction on one bearing.
    limit_v : float
        Largest input in both directions, V.
    counts_per_rad, counter_bits
        Resolution of the encoder, and width of its counter.
    input_noise_v, encoder_noise_counts : float
        Standard deviations of white noise, one value per step. The quantisation of the encoder is
        added to it.
    seed : int
        Seed of the noise.
    stood_s : float
        Duration of the rest before the run, s, in which the film is squeezed out.
    dt_s : float
        Step of the loop, s; the plant takes `inner_steps` steps in each.
    """

    damping_1_s: float = DRIVE["damping_1_s"]
    input_rad_s2_v: float = DRIVE["input_rad_s2_v"]
    volts_per_n: float = DRIVE["volts_per_n"]
    limit_v: float = DRIVE["limit_v"]
    counts_per_rad: float = COUNTS_PER_RAD
    counter_bits: int = COUNTER_BITS
    input_noise_v: float = 0.005
    encoder_noise_counts: float = 0.0
    seed: int = 1
    stood_s: float = 60.0
    dt_s: float = 0.002
    inner_steps: int = 2

    def __post_init__(self) -> None:
        positive = ("damping_1_s", "input_rad_s2_v", "volts_per_n", "limit_v", "counts_per_rad")
        for name in (*positive, "dt_s", "inner_steps"):
            if not 0.0 < getattr(self, name) < float("inf"):
                raise _wrong(name, getattr(self, name), "positive and finite")
        for name in ("input_noise_v", "encoder_noise_counts", "stood_s"):
            if not 0.0 <= getattr(self, name) < float("inf"):
                raise _wrong(name, getattr(self, name), "zero or positive, and finite")
        if not 0 <= self.seed < 2**64:
            raise _wrong("seed", self.seed, "between 0 and 2^64 - 1")
        if not 8 <= self.counter_bits <= 32:
            raise _wrong("counter_bits", self.counter_bits, "between 8 and 32")

    def drive(self) -> dict[str, float]:
        """Motor and shaft parameters in the form of the core."""
        return {name: getattr(self, name) for name in DRIVE}

    def core(self, model: Model) -> dict[str, Any]:
        """Arguments from which the core builds its bench with a friction model."""
        names = (
            "counts_per_rad",
            "counter_bits",
            "input_noise_v",
            "encoder_noise_counts",
            "seed",
            "stood_s",
            "inner_steps",
        )
        constants = {name: getattr(self, name) for name in names}
        return {"model": core_model(model), "drive": self.drive(), **constants}


def _wrong(name: str, value: float, rule: str) -> InputError:
    return InputError(key=name, problem=f"{value} must be {rule}", remedy="correct the value")


def check_rotary(model: Model) -> None:
    """Raise an InputError for the model of a linear drive, since the bench is rotary.

    Raises
    ------
    InputError
        The motion of the model's drive is linear.
    """
    drive = model.rig.drive
    if drive is not None and drive.motion == "linear":
        raise InputError(
            problem="the model is of a linear drive, and the simulated bench is rotary",
            remedy="use the model in your own loop: jbf export MODEL",
        )


def core_model(model: Model) -> dict[str, Any]:
    """Convert a model to the form of the core's bench and compensators.

    Raises
    ------
    InputError
        The model is of a linear drive, or has a user-defined law or effect, which is Python code
        and cannot run in a loop.
    """
    check_rotary(model)
    pages = catalogue.effects()
    if isinstance(catalogue.find_law(model.law), UserLaw):
        raise InputError(
            problem=f"{model.law} is a user-defined law in Python, which cannot run in a loop",
            remedy="write it in Rust: cargo run --example user_law shows how",
        )
    user_effects = [name for name in model.effects if isinstance(pages.get(name), UserEffect)]
    if user_effects:
        raise InputError(
            problem=(
                f"{user_effects[0]} is a user-defined effect in Python, which cannot run in a loop"
            ),
            remedy="fit a model without it, or write it in Rust (ARCHITECTURE.md)",
        )
    values = [p.value for p in model.parameters.values()]
    names = list(model.parameters)
    law_values = [v for n, v in zip(names, values, strict=True) if "." not in n]
    effects = [
        (e, [v for n, v in zip(names, values, strict=True) if n.startswith(f"{e}.")])
        for e in model.effects
    ]
    bearing: _core.BearingSizes | None = core_bearing(model.rig)
    return {
        "law": model.law,
        "bearing": bearing,
        "load_n": core_load_n(model.rig) or 1.0,
        "clock": model.clock,
        "parameters": law_values,
        "effects": effects,
    }


THESIS_RIG = Rig.thesis()
"""Test rig of Cohn (1998)."""

THESIS_LOAD_N = core_load_n(THESIS_RIG) or 1.0
"""Load on one bearing of the test rig of Cohn (1998), N."""

THESIS_BENCH = Bench()
"""Bench whose friction fits the columns "none" of Tables 6.1 and 6.2 of Cohn (1998)."""

FITTED = {"U_tr_m_s": 0.05936, "K0": 5.029e6, "gamma": 84.58}
"""Parameters that `jbf control tables` fits to the seven cells without compensation."""

VOLTS_PER_N_M = 0.547
"""Voltage per newton metre on the shaft, from the program listings of Cohn (1998).

The listings omit its unit. Four bearings of 12.7 mm at 104 N yield 2.89 V for a friction
coefficient of 1.
"""

ELASTIC: Mapping[str, Mapping[str, float]] = {
    "belt": {
        "drive_compliance.k": 40.0,
        "drive_compliance.c": 0.5,
        "drive_compliance.J": 1.8e-4,
    },
    # The presliding displacement is one encoder count.
    "contact": {"presliding.sigma": 0.26 * COUNTS_PER_RAD / _core.thesis_bearing()["radius_m"]},
    "nothing": {},
}
"""Compliance between motor and sliding contact: the timing belt, the contact, or none.

The belt's inertia is that of a solid shaft of the rig's mass. Its stiffness and damping are those
that the Coulomb column of Table 6.2 requires (docs/control.md).
"""


def thesis_model(*, elastic: str = "belt", clock: Clock = "thesis", **parameters: float) -> Model:
    """Friction model of the bench that represents the one of Cohn (1998).

    Parameters
    ----------
    elastic
        Key of `ELASTIC`.
    clock
        Definition of the film's time constant.
    parameters
        Values that replace the fitted ones.
    """
    bend = ELASTIC[elastic]
    return Model(
        THESIS_RIG,
        effects=sorted({name.split(".")[0] for name in bend}),
        parameters={"f_m": 0.26, **FITTED, **bend, **parameters},
        clock=clock,
    )


def with_noise(bench: Bench, times: float) -> Bench:
    """Return a bench with all noise scaled by a factor, including the encoder's quantisation."""
    counting = (1.0 / 12.0) ** 0.5
    total = times * (counting**2 + bench.encoder_noise_counts**2) ** 0.5
    return replace(
        bench,
        input_noise_v=times * bench.input_noise_v,
        encoder_noise_counts=max(total**2 - counting**2, 0.0) ** 0.5,
    )
