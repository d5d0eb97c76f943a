"""Construction of the core's signal chain for a rig, and of its input motion."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from jbf import _core
from jbf.arrays import Array
from jbf.errors import FilmWarning, InputError
from jbf.models.catalogue import (
    CARRIER,
    check_applies,
    find_clock,
    find_effect,
    find_law,
    in_chain_order,
)
from jbf.models.driven import Driven, DrivenChain
from jbf.models.user_chain import NONLINEAR_EFFECTS, UserChain
from jbf.models.user_effects import MOTION_COLUMNS, UserEffect
from jbf.models.user_laws import UserLaw
from jbf.models.vocabulary import AUTO
from jbf.records.arguments import one_run, the_rig
from jbf.records.channels import of_motion
from jbf.records.findings.noisy_load import steady_load
from jbf.records.findings.repeated_rows import as_read
from jbf.records.findings.slow_temperature import recorded_temperature
from jbf.records.motion.estimated_motion import EstimatedMotion, estimate_motion
from jbf.records.motion.first_stroke import begins_with_oscillation
from jbf.records.motion.readings import ReadingErrors
from jbf.records.recorded_load import recorded_load
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.records.run_requirements import run_on
from jbf.records.weight_angle import weight_offset

MAX_STEP_S = 0.02
"""Longest inner step of a prediction, s.

The core ends a step at every reversal, and reduces the step if the law or an effect requires it. At
0.02 s the error of the base law is about 1e-5 of its peak.
"""


@contextmanager
def core_refusals(remedy: str | Callable[[str], str] = "correct the value") -> Iterator[None]:
    """Context in which exceptions of the core become an InputError.

    Parameters
    ----------
    remedy
        The remedy, or a function that maps the message of the core to the remedy.
    """
    try:
        yield
    except InputError:
        raise
    except (ValueError, OverflowError) as error:
        problem = str(error)
        raise InputError(
            problem=problem, remedy=remedy if isinstance(remedy, str) else remedy(problem)
        ) from None


def check_rig(rig: Rig, law: str) -> None:
    """Raise an InputError if the value is not a rig, or lacks a section that the law needs."""
    the_rig(rig)
    if not find_law(law).needs_bearing:
        return
    for section, content in (
        ("bearing", rig.bearing),
        ("lubricant", rig.lubricant),
        ("load", rig.load),
    ):
        if content is None and rig.drive is not None:
            raise InputError(
                problem=f"the rig is a drive, but the law {law} requires a journal bearing",
                remedy="choose another law: --law coulomb, stribeck or lugre (`jbf.laws()`)",
            )
        if content is None:
            raise InputError(
                problem=f"the rig has no [{section}]",
                remedy=f"the law {law} requires it: add [{section}]",
            )


def default_law(rig: Rig) -> str:
    """Law of a fit if none is named: `journal` for a bearing, otherwise `coulomb`."""
    return "journal" if _describes_bearing(rig) else "coulomb"


def default_law_of_diagnosis(rig: Rig) -> str:
    """Law of a diagnosis if none is named: `journal` for a bearing, otherwise `auto`."""
    return "journal" if _describes_bearing(rig) else AUTO


def _describes_bearing(rig: Rig) -> bool:
    """Whether a rig is not a drive, and has a bearing or a lubricant.

    The journal law requires both (`check_rig`), and an incomplete rig is reported as such.
    """
    the_rig(rig)
    return rig.drive is None and (rig.bearing is not None or rig.lubricant is not None)


def core_bearing(rig: Rig) -> _core.BearingSizes | None:
    """Dimensions of the bearing in the form of the core; None for a rig without a bearing."""
    b = rig.bearing
    if b is None:
        return None
    return {
        "radius_m": b.radius_m,
        "length_m": b.length_m,
        "clearance_m": b.clearance_m,
        "mass_kg": b.mass_kg,
        "count": b.count,
        # A law with a film has been rejected by `check_rig`; any other law uses the radius only.
        "viscosity_pa_s": 1.0 if rig.lubricant is None else rig.lubricant.viscosity_pa_s,
    }


def core_load_n(rig: Rig) -> float | None:
    """Load on one bearing of a rig, N; None for a rig without a load."""
    return None if rig.load is None else rig.load.normal_n


def chain(rig: Rig, law: str, clock: str, effects: Sequence[str]) -> DrivenChain:
    """Build the core's signal chain for a rig, a law and effects.

    Raises
    ------
    InputError
        The rig lacks a section that the law needs, or an effect cannot be combined with the law.
    """
    check_rig(rig, law)
    check_applies(law, effects)
    film_clock = find_clock(clock)
    pages = [find_effect(name) for name in in_chain_order(effects)]
    user_effects = [page for page in pages if isinstance(page, UserEffect)]
    page_of_law = find_law(law)
    user_law = page_of_law.force if isinstance(page_of_law, UserLaw) else None

    def of_core(names: list[str]) -> _core.Chain:
        with core_refusals():
            return _core.Chain(
                law=law if user_law is None else CARRIER,
                bearing=core_bearing(rig),
                load_n=core_load_n(rig),
                clock=film_clock,
                effects=names,
                max_step_s=MAX_STEP_S,
            )

    core = of_core([page.name for page in pages if page not in user_effects])
    if not user_effects and user_law is None:
        return DrivenChain(core)
    carrier_values = [] if user_law is None else [p.lower for p in find_law(CARRIER).parameters]
    first = 0 if user_law is None else len(user_law.parameters) - len(carrier_values)
    names = core.parameter_names
    instrument = [
        (page.name, [first + names.index(f"{page.name}.{p.name}") for p in page.parameters])
        for page in pages
        if page.stage == "instrument" and page not in user_effects
    ]
    carrier = None if user_law is None else of_core([])
    bends = any(name in NONLINEAR_EFFECTS for name, _ in instrument)
    before = [p.name for p in pages if p not in user_effects and p.stage != "instrument"]
    bare_core = of_core(before) if bends else None
    return DrivenChain(
        UserChain(core, instrument, user_effects, user_law, carrier_values, carrier, bare_core)
    )


def estimated_motion(rig: Rig, run: Run, delay_s: float = 0.0) -> EstimatedMotion:
    """Estimate the motion of a run with the journal radius of its rig.

    The motion is that of the times of the run minus `delay_s`, within the recorded times.
    """
    instants, motion = sampled_motion(rig, run)
    if delay_s == 0.0 and len(instants) == len(run):
        return motion
    return motion.at(instants, np.clip(run.time_s - delay_s, instants[0], instants[-1]))


def sampled_motion(
    rig: Rig, run: Run, starts: Sequence[ReadingErrors] = ()
) -> tuple[Array, EstimatedMotion]:
    """Estimate the motion of a run; return its sampling instants, s, and the motion.

    If the motion was recorded with a separate clock, the instants are those of that clock. `starts`
    is as in :func:`jbf.records.motion.estimated_motion.estimate_motion`.
    """
    run = as_read(run_on(rig, one_run(run)))
    sampled = of_motion(run.read)
    if sampled is not None:
        run = run.select(sampled)
    motion = estimate_motion(run, rig.radius_m, starts)
    return (run.time_s if motion.clock_s is None else motion.clock_s), motion


@dataclass(frozen=True)
class MotionBefore:
    """Hypothetical motion at a constant speed before a run.

    Attributes
    ----------
    speed_share
        Speed in the direction of the first motion, as a fraction of the run's largest speed.
    duration_s
        Duration, s.
    replaces_rest
        Whether the motion also replaces a rest at the start of the run.
    """

    speed_share: float
    duration_s: float
    replaces_rest: bool = False


def core_motion(
    rig: Rig, run: Run, motion: EstimatedMotion, before: MotionBefore | None = None
) -> Driven:
    """Convert motion and load of a run to an input of the core.

    A law in newtons does not use the load.

    Parameters
    ----------
    before
        Hypothetical motion before the run; None without one.
    """
    recorded = recorded_load(rig, run)
    if recorded is not None:
        load = steady_load(recorded)
    else:
        load = np.full(len(run), core_load_n(rig) or 1.0)
    velocity = _from_rest(run, motion.velocity)
    columns = run.columns() | {
        "velocity": velocity,
        "acceleration": motion.acceleration,
        "angle_rad": motion.angle_rad,
        "load_n": load,
    }
    celsius = recorded_temperature(run)
    if celsius is not None:
        columns["temperature_c"] = celsius
    offset = weight_offset(rig, run, motion.angle_rad)
    if offset is not None:
        columns["weight_offset_rad"] = offset
    run_samples = None
    if before is not None:
        count, columns = _with_motion_before(columns, rig, before)
        run_samples = count + np.arange(len(run))
    with core_refusals("correct the run"):
        core = _core.Motion(
            np.ascontiguousarray(columns["time_s"]),
            np.ascontiguousarray(columns["velocity"]),
            np.ascontiguousarray(columns["acceleration"]),
            np.ascontiguousarray(columns["angle_rad"]),
            np.ascontiguousarray(columns["load_n"]),
            None if celsius is None else np.ascontiguousarray(columns["temperature_c"]),
            None if offset is None else np.ascontiguousarray(columns["weight_offset_rad"]),
        )
    # User-defined effects receive the record with the estimated motion, which is also available
    # under the column names of a file.
    columns |= {column: columns[name] for column, name in MOTION_COLUMNS.items()}
    core.columns = columns
    return Driven(core, run_samples)


def _from_rest(run: Run, velocity: Array) -> Array:
    """Speed, m/s, set to zero at the start if the run begins with noise at standstill."""
    if not begins_with_oscillation(run.time_s, velocity):
        return velocity
    return np.concatenate(([0.0], velocity[1:]))


def _with_motion_before(
    columns: dict[str, Array], rig: Rig, motion: MotionBefore
) -> tuple[int, dict[str, Array]]:
    """Prepend a hypothetical motion to columns, which may also replace a rest at their start.

    Returns the number of its samples before the run, and the columns.
    """
    speed, time = columns["velocity"], columns["time_s"]
    step_s = float(np.median(np.diff(time)))
    count = int(motion.duration_s / step_s)
    moving = np.flatnonzero(speed)
    direction = float(np.sign(speed[moving[0]])) if len(moving) else 1.0
    velocity = direction * motion.speed_share * float(np.max(np.abs(speed), initial=0.0))
    if motion.replaces_rest and len(moving):
        columns = columns | {
            "velocity": np.append(np.full(moving[0], velocity), speed[moving[0] :])
        }
    arm = 1.0 if rig.bearing is None else rig.bearing.radius_m
    before_s = -step_s * np.arange(count, 0, -1)
    before = {name: np.full(count, values[0]) for name, values in columns.items()}
    before["time_s"] = time[0] + before_s
    before["velocity"] = np.full(count, velocity)
    before["acceleration"] = np.zeros(count)
    before["angle_rad"] = columns["angle_rad"][0] + velocity / arm * before_s
    return count, {name: np.concatenate((before[name], columns[name])) for name in columns}


def warn_of_fast_film(core: DrivenChain, values: Array, motions: Sequence[Driven]) -> None:
    """Warn if the film is too fast to be integrated by a prediction."""
    rate = core.film_rate_1_s(values, motions)
    if rate > _core.FASTEST_FILM_1_S:
        warnings.warn(
            f"the film of this model responds at {rate:.2g} 1/s, above the limit of "
            f"{_core.FASTEST_FILM_1_S:.2g} 1/s; it is kept inside the bearing; check U_tr_m_s, K0 "
            "and the load",
            FilmWarning,
            stacklevel=4,
        )
