"""Simulation of a control loop on the bench."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf import _core
from jbf.arrays import Array
from jbf.control.bench import THESIS_BENCH, Bench, thesis_model
from jbf.control.loop import core_loop
from jbf.control.schemes import SCHEMES, Scheme, scheme
from jbf.control.settings import Settings
from jbf.control.task import RECORDED, TASKS, Task
from jbf.errors import InputError
from jbf.models.chain import core_load_n, core_refusals
from jbf.models.model import Model, the_model
from jbf.records.arguments import described, of_kind
from jbf.results import Result as SharedResult

_NEVER = 2**62
_COLUMNS = (
    "time_s",
    "reference",
    "angle_rad",
    "velocity_rad_s",
    "friction_v",
    "measured_angle_rad",
    "estimated_velocity_rad_s",
    "error",
    "base_v",
    "compensation_v",
    "estimated_friction_v",
    "correction_v",
    "forward_v",
    "output_v",
    "learned_0",
    "learned_1",
    "status",
)


@dataclass(frozen=True, eq=False, repr=False)
class Result(SharedResult):
    """Signals of a control-loop run: arrays of shape (n,), one value per step of the loop.

    Attributes
    ----------
    task, scheme
        The task, and the name of the compensation scheme.
    time_s, reference : ndarray
        Time, and reference in rad or rad/s, depending on `task.control`.
    angle_rad, velocity_rad_s, friction_v : ndarray
        True motion of the shaft, and its true friction.
    measured_angle_rad, estimated_velocity_rad_s : ndarray
        Signals available to the loop.
    error : ndarray
        Measured angle or estimated speed, minus reference; the tables of Cohn (1998) report this
        error.
    base_v, compensation_v, output_v : ndarray
        Outputs of the control law and the compensator, and the input of the amplifier.
    estimated_friction_v, correction_v, forward_v : ndarray
        Components of the compensation.
    learned_0, learned_1 : ndarray
        K0 and gamma (learning), the level (Coulomb), level and rest corrections in V (observed).
    status : ndarray of uint8
        Flags: 1 saturated, 2 encoder frozen, 4 jumped, 8 reference not finite, 16 fallback.
    """

    task: Task
    scheme: str
    time_s: Array
    reference: Array
    angle_rad: Array
    velocity_rad_s: Array
    friction_v: Array
    measured_angle_rad: Array
    estimated_velocity_rad_s: Array
    error: Array
    base_v: Array
    compensation_v: Array
    estimated_friction_v: Array
    correction_v: Array
    forward_v: Array
    output_v: Array
    learned_0: Array
    learned_1: Array
    status: npt.NDArray[np.uint8]

    def __repr__(self) -> str:
        return (
            f"Result({self.scheme} on {self.task.control} {self.task.wave}: "
            f"RMS error {self.rms:.4g} {self.task.unit})"
        )

    def to_dict(self) -> dict[str, Any]:
        """Return task, scheme and errors, JSON-serialisable; `columns` has the arrays."""
        return {
            "task": asdict(self.task),
            "scheme": self.scheme,
            "rms": self.rms,
            "peak": self.peak,
            "true_rms": self.true_rms,
        }

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """Signals by name, in the order in which `to_csv` writes them."""
        return {name: getattr(self, name) for name in _COLUMNS}

    def to_csv(self) -> str:
        """Text of a CSV file with the signals of the run."""
        columns = self.columns()
        rows = zip(*(a.tolist() for a in columns.values()), strict=True)
        return "\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n"

    @property
    def response(self) -> Array:
        """True angle (rad) or speed (rad/s) of the shaft, whichever is controlled."""
        return self.angle_rad if self.task.is_position else self.velocity_rad_s

    @property
    def true_error(self) -> Array:
        """True response minus reference, rad or rad/s."""
        return self.response - self.reference

    def _counting(self, error: Array) -> Array:
        """Samples of an error signal after the skipped start of the run."""
        return error[self.time_s >= self.task.skip_s - 1e-9]

    @property
    def rms(self) -> float:
        """Root mean square of `error` after the skipped start."""
        return float(np.sqrt(np.mean(self._counting(self.error) ** 2)))

    @property
    def peak(self) -> float:
        """Largest absolute `error` after the skipped start."""
        return float(np.max(np.abs(self._counting(self.error))))

    @property
    def true_rms(self) -> float:
        """Root mean square of `true_error` after the skipped start."""
        return float(np.sqrt(np.mean(self._counting(self.true_error) ** 2)))


def run(
    model: Model | None = None,
    scheme: str | Scheme = "observed",
    task: Task = TASKS["velocity sine"],
    *,
    bench: Bench = THESIS_BENCH,
    assumed: Bench | None = None,
    carried: Model | None = None,
    settings: Settings | None = None,
    guard: Settings | None = None,
    load_n: float | npt.ArrayLike | None = None,
    reference: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
    frozen_s: tuple[float, float] | None = None,
    jump: tuple[float, int] | None = None,
    precision: str = "f64",
) -> Result:
    """Run a control loop on the simulated bench.

    Parameters
    ----------
    model
        True friction of the bench. Default: `thesis_model()`.
    scheme
        A name of `SCHEMES`, or a scheme with user-defined settings.
    task
        Reference, control law and duration.
    bench
        Motor, shaft, encoder, noise.
    assumed
        Bench assumed by control law, observer and compensator. Default: the true one.
    carried
        Model used by the compensator. Default: the true one.
    settings
        Settings of the observed compensator. Default: `tune(carried, assumed)`.
    guard
        Settings whose `moving_v` and `patience_s` guard the loop. Default: those of the observed
        compensator; the schemes of Cohn (1998) have no guard.
    load_n
        Load on one bearing, N: a number, or one value per step. Default: that of the model.
    reference
        Values and rates of change, one per step, which replace the task's wave.
    frozen_s
        Start and end of the interval in which the encoder's counter is frozen, s.
    jump
        Time (s) at which the counter jumps, and the number of counts.
    precision
        `f64`, or `f32` as on a microcontroller. The plant is always `f64`.

    Raises
    ------
    InputError
        An argument is out of range or has the wrong length.
    """
    truth = thesis_model() if model is None else the_model(model)
    of_kind(task, Task, "the task", 'name one of control.TASKS: TASKS["velocity sine"]')
    chosen = _scheme(scheme, model if carried is None else carried, settings)
    assumed_bench = bench if assumed is None else assumed
    if assumed_bench.dt_s != bench.dt_s:
        raise InputError(
            problem="the two benches have different steps", remedy="give both one dt_s"
        )
    n = max(round(task.seconds / bench.dt_s), 1)
    value, rate = _reference(task, bench, n, reference)
    n = len(value)
    load = _load(truth, load_n, n)
    faults = {
        "frozen": _steps(frozen_s, bench),
        "jump_at": _NEVER if jump is None else round(jump[0] / bench.dt_s),
        "jump_counts": 0 if jump is None else jump[1],
    }
    with core_refusals(_remedy):
        arrays: dict[str, Any] = _core.control_run(
            bench.core(truth),
            core_loop(task, assumed_bench, chosen.guard(assumed_bench) if guard is None else guard),
            chosen.core(task, assumed_bench),
            value,
            rate,
            load,
            faults,
            precision=precision,
        )
    time_s = np.arange(n, dtype=np.float64) * bench.dt_s
    return Result(task, chosen.name, time_s, value, **arrays)


def _remedy(problem: str) -> str:
    """Remedy for an input that the core's loop rejects, by the text of the problem."""
    if problem.startswith("top_speed_rad_s"):
        return "decrease counts_per_rad, or limit_v and input_rad_s2_v, or use a wider counter"
    return "correct the value"


def _scheme(given: str | Scheme, carried: Model | None, settings: Settings | None) -> Scheme:
    if isinstance(given, str):
        return scheme(given, carried, settings)
    if not hasattr(given, "core"):
        remedy = f"name one of {', '.join(SCHEMES)}"
        raise InputError(problem=f"the scheme is {described(given)}", remedy=remedy)
    return given


def _steps(span_s: tuple[float, float] | None, bench: Bench) -> tuple[int, int]:
    """Convert an interval in s to first step and end (exclusive)."""
    if span_s is None:
        return _NEVER, _NEVER
    first, last = (round(t / bench.dt_s) for t in span_s)
    return max(first, 0), max(last, 0)


def _reference(
    task: Task, bench: Bench, n: int, given: tuple[npt.ArrayLike, npt.ArrayLike] | None
) -> tuple[Array, Array]:
    """Reference (rad or rad/s) and its rate of change, one value per time step."""
    if given is None and task.wave == RECORDED:
        raise InputError(problem="a recorded task has no wave", remedy="give its reference")
    if given is None:
        return _core.control_reference(
            task.wave, task.low, task.high, task.frequency_rad_s, bench.dt_s, n
        )
    value, rate = (np.ascontiguousarray(a, dtype=float) for a in given)
    if value.ndim != 1 or value.shape != rate.shape or not len(value):
        raise InputError(
            problem=f"the reference has shapes {value.shape} and {rate.shape}",
            remedy="give two arrays of equal length",
        )
    return value, rate


def _load(model: Model, given: float | npt.ArrayLike | None, n: int) -> Array:
    """Load on one bearing at each step, N."""
    of_rig = core_load_n(model.rig) or 1.0
    load = np.full(n, of_rig) if given is None else np.array(np.broadcast_to(given, n), dtype=float)
    if not np.all(np.isfinite(load)):
        raise InputError(problem="a load is not finite", remedy="give finite values, N")
    return load
