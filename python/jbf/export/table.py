"""Target `table`: friction against speed for the tables of drives, and a cogging map."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.export.ledger import Status, Term
from jbf.export.reference import BODY, COGGING, Reference, force_of_effects, instrument
from jbf.export.steady import best_points, speeds_of, steady_friction, weights_of
from jbf.export.target import MAIN, Settings, Target, Written
from jbf.models.catalogue import find_law
from jbf.models.chain import estimated_motion
from jbf.models.driven_motion import driven_motion
from jbf.records.run import Run

LEAST_POINTS = 4
MOST_POINTS = 1000
MAP_POINTS, MOST_MAP_POINTS = 32, 8192
"""Points of a cogging map per period, and largest number of all points."""
TWINCAT_POINTS = 20
"""Default limit of the entries of a friction table of TwinCAT CNC (P-COMP-00062), one at rest."""

_AT_MEDIAN = "at the median {} of the runs"
_LOST = {
    "drive_compliance": "a table has no drive dynamics",
    "backlash": "a table has no memory",
    "film_memory": "a table has no memory",
    "running_in": "a table does not depend on the distance slid; friction after running-in",
    "dwell_stiction": "a table has no memory",
    "position_ripple": "a table does not depend on the position",
    "stroke_dependence": "a table does not depend on the position",
    "pitch_ripple": "a table does not depend on the position",
    "pitch_ripple_2": "a table does not depend on the position",
    "warm_up": "a table does not depend on time; friction of the warm machine",
    "torque_proportional": "a table does not depend on the transmitted force",
    "presliding": "a table has no memory; friction in sliding",
}
"""Effects that a table over speed cannot contain, with the reason."""
_MEDIANS = {
    "dry_load_dependence": "load",
    "viscous_load_dependence": "load",
    "zero_load_dependence": "load",
    "load_dependence": "load",
    "dry_temperature_dependence": "temperature",
    "viscous_temperature_dependence": "temperature",
    "vogel_viscosity": "temperature",
}


@dataclass(frozen=True)
class SpeedTable:
    """Friction against signed speed or position; linear between its points, constant outside.

    Attributes
    ----------
    speed
        Speeds, m/s or rad/s, or positions, m or rad, ascending, shape (k,).
    friction
        Friction at these points, in the force unit of the rig, shape (k,).
    """

    speed: Array
    friction: Array

    def at(self, velocity: Array) -> Array:
        """Friction at each speed or position, in the force unit of the rig, shape (n,)."""
        return np.asarray(np.interp(velocity, self.speed, self.friction))


def speed_table(reference: Reference, points: int) -> SpeedTable:
    """Compute the table with the least error at the speeds of the runs."""
    speeds = speeds_of(reference)
    omitted = (*BODY, *COGGING, *_LOST)
    sides = {}
    for direction in (-1, 1):
        curve = steady_friction(reference, speeds, direction, omitted)
        weights = weights_of(reference, speeds, direction)
        sides[direction] = best_points(speeds, curve, weights, points // 2)
    (backward_x, backward_y), (forward_x, forward_y) = sides[-1], sides[1]
    return SpeedTable(
        np.concatenate([-backward_x[::-1], forward_x]),
        np.concatenate([backward_y[::-1], forward_y]),
    )


def cogging_map(reference: Reference) -> SpeedTable | None:
    """Cogging force against position; None for a model without cogging.

    The positions are one turn of a rotary machine, and the range of the runs of a linear one.
    """
    names = [name for name in COGGING if name in reference.model.effects]
    if not names:
        return None
    pitches = [reference.model.parameters[f"{name}.pitch"].value for name in names]
    low, high = 0.0, 2.0 * math.pi
    if reference.model.rig.radius_m is None:
        position = reference.pooled(reference.position)
        low, high = float(np.min(position)), float(np.max(position))
    elif reference.model.rig.bearing is not None:
        high *= reference.model.rig.bearing.radius_m
    periods = (high - low) / min(pitches)
    count = min(max(math.ceil(MAP_POINTS * periods), 360), MOST_MAP_POINTS)
    position = np.linspace(low, high, count + 1)
    rig = reference.model.rig
    time_s = 0.01 * np.arange(len(position))
    velocity = np.full(len(position), (high - low) / (0.01 * count))
    if rig.radius_m is None:
        run = Run.from_arrays(time_s, velocity, position_m=position)
    else:
        run = Run.from_arrays(time_s, velocity, angle_rad=position / rig.radius_m)
    motion = driven_motion(rig, run, estimated_motion(rig, run))
    return SpeedTable(position, force_of_effects(reference.model, names, [motion])[0])


def write_table(reference: Reference, settings: Settings) -> Written:
    """Write the tables of a model."""
    if not LEAST_POINTS <= settings.points <= MOST_POINTS:
        raise InputError(
            problem=f"{settings.points} is not a number of points of a table",
            remedy=f"choose {LEAST_POINTS} to {MOST_POINTS}",
        )
    table, map_ = speed_table(reference, settings.points), cogging_map(reference)
    quantities = reference.model.rig.quantities
    files = {MAIN: _csv(reference, quantities.speed_column, table)}
    force = [table.at(velocity) for velocity in reference.velocity]
    speeds = np.abs(table.speed)
    notes = [
        f"{len(speeds)} points from {np.min(speeds):.3g} to {np.max(speeds):.3g} "
        f"{quantities.speed}; linear between the points, also through zero, and constant outside",
    ]
    if map_ is not None:
        column = "position_m" if quantities.motion != "rotary" else "angle_rad"
        files["_cogging.csv"] = _csv(reference, column, map_)
        period = map_.speed[-1] if reference.model.rig.radius_m is not None else None
        for total, position in zip(force, reference.position, strict=True):
            place = position if period is None else np.mod(position, period)
            total += map_.at(place)
        notes.append(
            f"cogging map with {len(map_.speed)} positions, friction removed; the force is added "
            "to that of the table"
        )
    twincat = _twincat(reference, table)
    if twincat is None:
        notes.append(
            'no TwinCAT list: its values are shares of the rated torque (friction = "percent")'
        )
    else:
        files["_twincat.lis"], level = twincat
        notes.append(
            "the TwinCAT list has one level for both directions, which costs a further "
            f"{level:.3g} {quantities.force} (RMS)"
        )
    return Written(files, _terms(reference), force, "linear interpolation", tuple(notes))


def _terms(reference: Reference) -> tuple[Term, ...]:
    model = reference.model
    law = find_law(model.law)
    memory = "; its memory is not carried" if law.has_memory else ""
    terms = [Term(law.name, "approximate", f"steady friction, linear between points{memory}")]
    for name in model.effects:
        status: Status = "approximate"
        how = "part of the friction against speed"
        if name in instrument(model):
            status, how = "external", "property of the recording"
        elif name in BODY:
            status, how = "external", "feedforward of acceleration, weight or spring"
        elif name in COGGING:
            how = "cogging map, linear between positions"
        elif name in _LOST:
            status, how = "none", _LOST[name]
        elif name in _MEDIANS:
            how = _AT_MEDIAN.format(_MEDIANS[name])
        terms.append(Term(name, status, how))
    return tuple(terms)


def _csv(reference: Reference, column: str, table: SpeedTable) -> str:
    """CSV of a table, with a further column in the unit of the drive where it has one."""
    drive, quantities = reference.model.rig.drive, reference.model.rig.quantities
    columns = {column: table.speed, quantities.friction_column: table.friction}
    if drive is not None and drive.friction in ("current", "percent"):
        name = "current_a" if drive.friction == "current" else "percent"
        columns[name] = table.friction / drive.unit_n
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    return "\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows), ""])


def _twincat(reference: Reference, table: SpeedTable) -> tuple[str, float] | None:
    """Friction table of TwinCAT CNC, and the RMS error of its symmetry.

    The list has speeds in um/s or 0.001 deg/s and torques in 0.1 % of the rated torque, the unit of
    `dig_drv.act_torque` for CANopen drives. None if the drive does not record such a share.
    """
    drive = reference.model.rig.drive
    if drive is None or drive.friction != "percent":
        return None
    knots = table.speed[table.speed > 0.0]
    level = 0.5 * (table.at(knots) - table.at(-knots))
    weights = weights_of(reference, knots, 1) + weights_of(reference, knots, -1)
    knots, level = best_points(knots, level, weights, TWINCAT_POINTS - 1)
    velocity = reference.pooled(reference.velocity)
    symmetric = np.sign(velocity) * np.interp(np.abs(velocity), [0.0, *knots], [0.0, *level])
    error = float(np.sqrt(np.mean((symmetric - table.at(velocity)) ** 2)))
    to_axis = 1e6 if drive.motion == "linear" else 1e3 * 180.0 / math.pi
    entries = [(0, 0)]
    entries += [
        (round(to_axis * float(x)), round(10.0 * float(f) / drive.unit_n))
        for x, f in zip(knots, level, strict=True)
    ]
    lines = [
        ("frict_comp.mode", 3),
        ("frict_comp.table_entries", len(entries)),
        ("frict_comp.scaling_factor", 1000),
    ]
    for i, (x, f) in enumerate(entries):
        lines += [(f"frict_comp.table[{i}].in", x), (f"frict_comp.table[{i}].out", f)]
    return "\n".join([f"{name:<40}{value}" for name, value in lines] + [""]), error


TABLE = Target(
    "table",
    "friction against speed for a drive (CSV, TwinCAT list), and a cogging map",
    ".csv",
    write_table,
    ("points",),
)
