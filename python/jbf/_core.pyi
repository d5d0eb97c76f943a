"""Types of the extension module."""

from collections.abc import Sequence
from typing import Any, TypedDict

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]

__version__: str
FASTEST_FILM_1_S: float

class ParameterPage(TypedDict):
    name: str
    unit: str
    meaning: str
    lower: float
    upper: float
    null: float | None
    starts: list[float]
    log: bool
    period: float | None
    start: str
    bound: str
    stated: bool

class EffectPage(TypedDict):
    name: str
    stage: str
    summary: str
    equation: str
    source: str
    limits: str
    needs: list[str]
    refused: dict[str, str]
    moves_jumps: bool
    peaks: str | None
    longest_step_s: float
    further_of: str | None
    rust_place: str
    rust_type: str
    parameters: list[ParameterPage]

class LawPage(TypedDict):
    name: str
    summary: str
    equation: str
    source: str
    limits: str
    needs_bearing: bool
    has_film: bool
    has_bristle: bool
    rust_type: str
    parameters: list[ParameterPage]

class BearingSizes(TypedDict):
    radius_m: float
    length_m: float
    clearance_m: float
    mass_kg: float
    count: int
    viscosity_pa_s: float

class Motion:
    columns: dict[str, Array]
    def __init__(
        self,
        time_s: Array,
        velocity_m_s: Array,
        acceleration_m_s2: Array,
        angle_rad: Array,
        load_n: Array,
        temperature_c: Array | None = None,
    ) -> None: ...
    def __len__(self) -> int: ...

class Chain:
    def __init__(
        self,
        *,
        law: str,
        bearing: BearingSizes | None,
        load_n: float | None,
        clock: str,
        effects: Sequence[str],
        max_step_s: float,
    ) -> None: ...
    @property
    def parameter_names(self) -> list[str]: ...
    def predict(self, parameters: Array, motions: Sequence[Motion]) -> list[Array]: ...
    def film_rate_1_s(self, parameters: Array, motions: Sequence[Motion]) -> float: ...
    def jacobian(
        self, parameters: Array, motions: Sequence[Motion], which: Sequence[int]
    ) -> list[tuple[Array, Array]]: ...

class BatchRig:
    def __init__(
        self,
        *,
        radius_m: float,
        length_m: float,
        clearance_m: float,
        mass_kg: float,
        count: int,
        viscosity_pa_s: float,
        clock: str,
        method: str,
    ) -> None: ...
    def friction_f64(
        self, sets: Array, speeds: Array, each: bool, dt_s: float, out: Array
    ) -> None: ...
    def friction_f32(
        self, sets: Array, speeds: Array32, each: bool, dt_s: float, out: Array32
    ) -> None: ...
    def squares_f64(
        self, sets: Array, speeds: Array, each: bool, dt_s: float, data: Array
    ) -> Array: ...
    def squares_f32(
        self, sets: Array, speeds: Array32, each: bool, dt_s: float, data: Array32
    ) -> Array32: ...

def effects() -> list[EffectPage]: ...
def laws() -> list[LawPage]: ...
def film_integrals(eps: float) -> tuple[float, float, float]: ...
def transition_eccentricity(load_number: float) -> float: ...
def steady_friction(
    velocity_m_s: Array,
    *,
    law: str,
    parameters: Sequence[float],
    bearing: BearingSizes | None,
    load_n: float | None,
) -> Array: ...
def read_force(
    effects: Sequence[tuple[str, Sequence[float]]], time_s: Array, force_n: Array
) -> tuple[Array, Array]: ...
def trajectories(
    runs: Sequence[tuple[Array, tuple[float, float, float] | tuple[Array, Array]]],
    *,
    model: str,
    clock: str,
    tolerance: float,
    start_time_s: float | None,
    start_eps: float | None,
    start_phi_rad: float | None,
    f_m: float,
    u_tr_m_s: float,
    k0: float,
    gamma: float,
    radius_m: float,
    length_m: float,
    clearance_m: float,
    mass_kg: float,
    count: int,
    viscosity_pa_s: float,
    load_n: float,
    derivatives: bool = False,
) -> list[tuple[Array, Array, Array, int, Array | None]]: ...

class ControlConstants(TypedDict):
    drive: dict[str, float]
    counts_per_rad: float
    counter_bits: int
    observer_1_s: float
    table_entries: int
    flags: dict[str, int]

def thesis_bearing() -> dict[str, Any]: ...
def control_constants() -> ControlConstants: ...
def control_gains(
    position: bool, damping_1_s: float, input_rad_s2_v: float
) -> tuple[float, float]: ...
def control_reference(
    wave: str, low: float, high: float, frequency_rad_s: float, dt_s: float, samples: int
) -> tuple[Array, Array]: ...
def control_run(
    plant: dict[str, Any],
    loop_settings: dict[str, Any],
    compensator: dict[str, Any],
    reference: Array,
    rate: Array,
    load_n: Array,
    faults: dict[str, Any],
    *,
    precision: str,
) -> dict[str, Any]: ...
