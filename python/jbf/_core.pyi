"""Types of the extension module."""

from collections.abc import Sequence
from typing import Any, Literal, Protocol, TypeAlias, TypedDict, final, type_check_only

import numpy as np
import numpy.typing as npt
from typing_extensions import Self

_Array: TypeAlias = npt.NDArray[np.float64]
_Array32: TypeAlias = npt.NDArray[np.float32]

__all__ = [
    "DRIVE_COMPLIANCE_LONGEST_INNER_STEP",
    "DRIVE_COMPLIANCE_MOST_INNER_STEPS",
    "DRIVE_COMPLIANCE_SHORTEST_STEP_S",
    "FASTEST_FILM_1_S",
    "LUGRE_LONGEST_STEP_S",
    "LUGRE_STEPS_PER_SAMPLE",
    "RATE_AND_STATE_AGES_S",
    "RATE_AND_STATE_FAR_ABOVE_CREEP",
    "RATE_AND_STATE_LONGEST",
    "SEVEN_PARAMETER_DELAY_POINTS",
    "SEVEN_PARAMETER_LONGEST_STEP_S",
    "SEVEN_PARAMETER_STEPS_PER_SAMPLE",
    "BatchRig",
    "Chain",
    "Motion",
    "MotionErrorChain",
    "MotionReadings",
    "MotionWhitening",
    "SmoothedMotion",
    "__version__",
    "control_constants",
    "control_gains",
    "control_reference",
    "control_run",
    "effects",
    "film_integrals",
    "first_order_filter",
    "laws",
    "maxwell_slip_elements",
    "read_force",
    "steady_friction",
    "thesis_bearing",
    "trajectories",
    "transition_eccentricity",
]

__version__: str
FASTEST_FILM_1_S: float
DRIVE_COMPLIANCE_LONGEST_INNER_STEP: float
DRIVE_COMPLIANCE_MOST_INNER_STEPS: float
DRIVE_COMPLIANCE_SHORTEST_STEP_S: float
LUGRE_LONGEST_STEP_S: float
LUGRE_STEPS_PER_SAMPLE: float
SEVEN_PARAMETER_LONGEST_STEP_S: float
SEVEN_PARAMETER_STEPS_PER_SAMPLE: float
SEVEN_PARAMETER_DELAY_POINTS: int
RATE_AND_STATE_AGES_S: list[float]
RATE_AND_STATE_LONGEST: float
RATE_AND_STATE_FAR_ABOVE_CREEP: float

@type_check_only
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

@type_check_only
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
    spreads_jumps: bool
    peaks: str | None
    longest_step_s: float
    further_of: str | None
    unknown_start: bool
    erased_by_sliding: bool
    rust_type: str
    parameters: list[ParameterPage]

@type_check_only
class LawPage(TypedDict):
    name: str
    summary: str
    equation: str
    source: str
    limits: str
    needs_bearing: bool
    has_film: bool
    has_bristle: bool
    has_memory: bool
    rust_type: str
    parameters: list[ParameterPage]

@type_check_only
class BearingSizes(TypedDict):
    radius_m: float
    length_m: float
    clearance_m: float
    mass_kg: float
    count: int
    viscosity_pa_s: float

@final
class Motion:
    columns: dict[str, _Array]
    def __new__(
        cls,
        time_s: _Array,
        velocity_m_s: _Array,
        acceleration_m_s2: _Array,
        angle_rad: _Array,
        load_n: _Array,
        temperature_c: _Array | None = None,
        weight_offset_rad: _Array | None = None,
    ) -> Self: ...
    def __len__(self) -> int: ...

@final
class Chain:
    def __new__(
        cls,
        *,
        law: str,
        bearing: BearingSizes | None,
        load_n: float | None,
        clock: str,
        effects: Sequence[str],
        max_step_s: float,
    ) -> Self: ...
    @property
    def parameter_names(self) -> list[str]: ...
    def predict(self, parameters: _Array, motions: Sequence[Motion]) -> list[_Array]: ...
    def film_rate_1_s(self, parameters: _Array, motions: Sequence[Motion]) -> float: ...
    def inner_steps(self, parameters: _Array, motions: Sequence[Motion]) -> float: ...
    def jacobian(
        self, parameters: _Array, motions: Sequence[Motion], which: Sequence[int]
    ) -> list[tuple[_Array, _Array]]: ...

@final
class BatchRig:
    def __new__(
        cls,
        *,
        radius_m: float,
        length_m: float,
        clearance_m: float,
        mass_kg: float,
        count: int,
        viscosity_pa_s: float,
        clock: str,
        method: str,
    ) -> Self: ...
    def friction_f64(
        self, sets: _Array, speeds: _Array, each: bool, dt_s: float, out: _Array
    ) -> None: ...
    def friction_f32(
        self, sets: _Array, speeds: _Array32, each: bool, dt_s: float, out: _Array32
    ) -> None: ...
    def squares_f64(
        self, sets: _Array, speeds: _Array, each: bool, dt_s: float, data: _Array
    ) -> _Array: ...
    def squares_f32(
        self, sets: _Array, speeds: _Array32, each: bool, dt_s: float, data: _Array32
    ) -> _Array32: ...

def effects() -> list[EffectPage]: ...
def laws() -> list[LawPage]: ...
def film_integrals(eps: float) -> tuple[float, float, float]: ...
def transition_eccentricity(load_number: float) -> float: ...
def steady_friction(
    velocity_m_s: _Array,
    *,
    law: str,
    parameters: Sequence[float],
    bearing: BearingSizes | None,
    load_n: float | None,
) -> _Array: ...
def maxwell_slip_elements(parameters: Sequence[float]) -> list[tuple[float, float]]: ...

@type_check_only
class _ReadingErrors(Protocol):
    @property
    def position_variance(self) -> float: ...
    @property
    def velocity_variance(self) -> float: ...
    @property
    def stamp_variance(self) -> float: ...
    @property
    def intensity(self) -> float: ...
    @property
    def order(self) -> int: ...
    @property
    def velocity_delay_s(self) -> float: ...

@final
class MotionReadings:
    def __new__(
        cls,
        time: _Array,
        position: _Array,
        position_shape: _Array,
        position_floor: float,
        velocity: _Array,
        velocity_shape: _Array,
        velocity_floor: float,
        assigned: float,
    ) -> Self: ...
    def log_likelihood(self, errors: _ReadingErrors, corners: _Array, speed: _Array) -> float: ...
    def lower_bound(self, errors: _ReadingErrors, corners: _Array, speed: _Array) -> float: ...
    def smoothed(
        self, errors: _ReadingErrors, corners: _Array, speed: _Array
    ) -> SmoothedMotion: ...
    def estimated(
        self,
        errors: _ReadingErrors,
        corners: _Array,
        passes: tuple[int, int],
        known: Literal["nothing", "intensity", "everything"],
        linear: tuple[_Array, _Array, _Array, npt.NDArray[np.bool_]] | None = None,
    ) -> tuple[float, float, float, float, _Array]: ...

@final
class SmoothedMotion:
    @property
    def mean(self) -> _Array: ...
    @property
    def covariance(self) -> _Array: ...
    @property
    def gain(self) -> _Array: ...

@final
class MotionErrorChain:
    def __new__(cls, posterior: _Array, gain: _Array) -> Self: ...

@final
class MotionWhitening:
    def __new__(
        cls,
        chains: Sequence[MotionErrorChain | None],
        sensitivity: Sequence[_Array],
        ratio: float,
        weight: Sequence[_Array],
    ) -> Self: ...
    @property
    def log_determinant(self) -> float: ...
    def whiten(self, columns: Sequence[_Array], runs: Sequence[int]) -> list[_Array]: ...

def first_order_filter(now: tuple[float, float], before: float, values: _Array) -> _Array: ...
def read_force(
    effects: Sequence[tuple[str, Sequence[float]]], time_s: _Array, force_n: _Array
) -> tuple[_Array, _Array]: ...
def trajectories(
    runs: Sequence[tuple[_Array, tuple[float, float, float] | tuple[_Array, _Array]]],
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
) -> list[tuple[_Array, _Array, _Array, int, _Array | None]]: ...

@type_check_only
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
) -> tuple[_Array, _Array]: ...
def control_run(
    plant: dict[str, Any],
    loop_settings: dict[str, Any],
    compensator: dict[str, Any],
    reference: _Array,
    rate: _Array,
    load_n: _Array,
    faults: dict[str, Any],
    *,
    precision: str,
) -> dict[str, Any]: ...
