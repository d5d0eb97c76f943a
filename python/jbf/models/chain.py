"""The core's chain for a rig, and a run's motion as the core takes it."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import numpy.typing as npt

from jbf import _core
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
from jbf.models.own_chain import BENDING, OwnChain
from jbf.models.own_effects import OwnEffect
from jbf.models.own_laws import OwnLaw
from jbf.records.arguments import one_run, the_rig
from jbf.records.channels import of_motion
from jbf.records.findings.noisy_load import steady_load
from jbf.records.findings.repeated_rows import as_read
from jbf.records.findings.slow_temperature import recorded_temperature
from jbf.records.motion.first_stroke import begins_in_a_hum
from jbf.records.motion.imposed import ImposedMotion, impose
from jbf.records.motion.readings import ReadingErrors
from jbf.records.recorded_load import recorded_load
from jbf.records.rig import Rig
from jbf.records.run import Run, run_on

Array = npt.NDArray[np.float64]
MAX_STEP_S = 0.02
"""Longest inner step of a prediction. The core lands on every reversal and takes shorter steps
where the law or an effect asks for them; at 0.02 s the bare law errs by some 1e-5 of its peak."""


@contextmanager
def core_refusals(mend: str | Callable[[str], str] = "correct the value") -> Iterator[None]:
    """What the core refuses in here, as an InputError: the one kind of error that users meet.

    Parameters
    ----------
    mend
        What to do about it, or what gives that for the core's words.
    """
    try:
        yield
    except InputError:
        raise
    except (ValueError, OverflowError) as error:
        said = str(error)
        raise InputError(problem=said, mend=mend if isinstance(mend, str) else mend(said)) from None


def check_rig(rig: Rig, law: str) -> None:
    """An InputError where this is no rig, or lacks what a law needs."""
    the_rig(rig)
    if not find_law(law).needs_bearing:
        return
    for section, there in (
        ("bearing", rig.bearing),
        ("lubricant", rig.lubricant),
        ("load", rig.load),
    ):
        if there is None and rig.drive is not None:
            raise InputError(
                problem=f"the rig is a drive, and the law {law} is one of journal bearings",
                mend="choose a law for it: --law coulomb, stribeck or lugre (`jbf.laws()`)",
            )
        if there is None:
            raise InputError(
                problem=f"the rig has no [{section}]",
                mend=f"the law {law} needs one: add a [{section}] section",
            )


def core_bearing(rig: Rig) -> _core.BearingSizes | None:
    """The rig's bearing as the core takes it; None where the rig has none."""
    b = rig.bearing
    if b is None:
        return None
    return {
        "radius_m": b.radius_m,
        "length_m": b.length_m,
        "clearance_m": b.clearance_m,
        "mass_kg": b.mass_kg,
        "count": b.count,
        # A law with a film has been refused by now; any other takes the radius alone.
        "viscosity_pa_s": 1.0 if rig.lubricant is None else rig.lubricant.viscosity_pa_s,
    }


def core_load_n(rig: Rig) -> float | None:
    """The load on one bearing, N; None where the rig has none."""
    return None if rig.load is None else rig.load.normal_n


def chain(rig: Rig, law: str, clock: str, effects: Sequence[str]) -> DrivenChain:
    """The core's chain for a rig.

    Raises
    ------
    InputError
        The rig lacks what the law needs, or an effect does not go with the law.
    """
    check_rig(rig, law)
    check_applies(law, effects)
    film_clock = find_clock(clock)
    pages = [find_effect(name) for name in in_chain_order(effects)]
    own = [page for page in pages if isinstance(page, OwnEffect)]
    page_of_law = find_law(law)
    own_law = page_of_law.force if isinstance(page_of_law, OwnLaw) else None

    def of_core(names: list[str]) -> _core.Chain:
        with core_refusals():
            return _core.Chain(
                law=law if own_law is None else CARRIER,
                bearing=core_bearing(rig),
                load_n=core_load_n(rig),
                clock=film_clock,
                effects=names,
                max_step_s=MAX_STEP_S,
            )

    core = of_core([page.name for page in pages if page not in own])
    if not own and own_law is None:
        return DrivenChain(core)
    held = [] if own_law is None else [p.lower for p in find_law(CARRIER).parameters]
    first = 0 if own_law is None else len(own_law.parameters) - len(held)
    names = core.parameter_names
    instrument = [
        (page.name, [first + names.index(f"{page.name}.{p.name}") for p in page.parameters])
        for page in pages
        if page.stage == "instrument" and page not in own
    ]
    carrier = None if own_law is None else of_core([])
    bends = any(name in BENDING for name, _ in instrument)
    before = [p.name for p in pages if p not in own and p.stage != "instrument"]
    bare = of_core(before) if bends else None
    return DrivenChain(OwnChain(core, instrument, own, own_law, held, carrier, bare))


def imposed(rig: Rig, run: Run) -> ImposedMotion:
    """The motion that a run imposed on the rig's journal or slider."""
    instants, motion = imposed_as_read(rig, run)
    return motion if len(instants) == len(run) else motion.at(instants, run.time_s)


def imposed_as_read(
    rig: Rig, run: Run, starts: Sequence[ReadingErrors] = ()
) -> tuple[Array, ImposedMotion]:
    """The motion, and the instants at which it was read, s: those of a clock of its own, where it
    has one; `starts` as of :func:`jbf.records.motion.imposed.impose`."""
    run = as_read(run_on(rig, one_run(run)))
    there = of_motion(run.read)
    if there is not None:
        run = run.select(there)
    motion = impose(run, rig.radius_m, starts)
    return (run.time_s if motion.clock_s is None else motion.clock_s), motion


def core_motion(
    rig: Rig, run: Run, motion: ImposedMotion, before: tuple[float, float] | None = None
) -> Driven:
    """A run's motion and load, handed to the core; a law in newtons does not ask for the load.

    Parameters
    ----------
    before
        An imagined motion before the run: its constant speed, as a share of the run's largest, in
        the direction in which the run first moves, and how long it lasts, s.
    """
    recorded = recorded_load(rig, run)
    if recorded is not None:
        load = steady_load(recorded)
    else:
        load = np.full(len(run), core_load_n(rig) or 1.0)
    columns = run.columns() | {
        "velocity_m_s": _from_rest(run, motion.velocity_m_s),
        "acceleration_m_s2": motion.acceleration_m_s2,
        "angle_rad": motion.angle_rad,
        "load_n": load,
    }
    celsius = recorded_temperature(run)
    if celsius is not None:
        columns["temperature_c"] = celsius
    kept = None
    if before is not None:
        count, columns = _with_motion_before(columns, rig, *before)
        kept = count + np.arange(len(run))
    with core_refusals("correct the run"):
        made = _core.Motion(
            np.ascontiguousarray(columns["time_s"]),
            np.ascontiguousarray(columns["velocity_m_s"]),
            np.ascontiguousarray(columns["acceleration_m_s2"]),
            np.ascontiguousarray(columns["angle_rad"]),
            np.ascontiguousarray(columns["load_n"]),
            None if celsius is None else np.ascontiguousarray(columns["temperature_c"]),
        )
    # What effects of one's own see: the record, its motion as the models are driven with it.
    made.columns = columns
    return Driven(made, kept)


def _from_rest(run: Run, velocity_m_s: Array) -> Array:
    """The speed, m/s, at rest at first where it only hums there."""
    if not begins_in_a_hum(run.time_s, velocity_m_s):
        return velocity_m_s
    return np.concatenate(([0.0], velocity_m_s[1:]))


def _with_motion_before(
    columns: dict[str, Array], rig: Rig, share: float, duration_s: float
) -> tuple[int, dict[str, Array]]:
    """How many samples of an imagined motion, and the columns with it before them."""
    speed, time = columns["velocity_m_s"], columns["time_s"]
    step_s = float(np.median(np.diff(time)))
    count = int(duration_s / step_s)
    moving = np.flatnonzero(speed)
    way = float(np.sign(speed[moving[0]])) if len(moving) else 1.0
    velocity = way * share * float(np.max(np.abs(speed), initial=0.0))
    arm = 1.0 if rig.bearing is None else rig.bearing.radius_m
    back = -step_s * np.arange(count, 0, -1)
    before = {name: np.full(count, values[0]) for name, values in columns.items()}
    before["time_s"] = time[0] + back
    before["velocity_m_s"] = np.full(count, velocity)
    before["acceleration_m_s2"] = np.zeros(count)
    before["angle_rad"] = columns["angle_rad"][0] + velocity / arm * back
    return count, {name: np.concatenate((before[name], columns[name])) for name in columns}


def warn_of_fast_film(core: DrivenChain, values: Array, motions: Sequence[Driven]) -> None:
    """Say it where a prediction does not follow the film."""
    rate = core.film_rate_1_s(values, motions)
    if rate > _core.FASTEST_FILM_1_S:
        warnings.warn(
            f"the film of this model answers at {rate:.2g} 1/s; a prediction follows it up to "
            f"{_core.FASTEST_FILM_1_S:.2g} 1/s and holds it inside the bearing beyond: are "
            "U_tr_m_s, K0 and the load those of a bearing?",
            FilmWarning,
            stacklevel=4,
        )
