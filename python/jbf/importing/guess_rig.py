"""Proposal of rig sections from the columns of a file, with questions to the user."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from jbf.importing.expression import OPEN
from jbf.importing.guessed import Entry, Guess, Question
from jbf.importing.targets import LINEAR, ROTARY

Sections = dict[str, dict[str, Any]]

BEARING: Sections = {
    "bearing": dict.fromkeys(("radius_m", "length_m", "clearance_m", "mass_kg", "count"), OPEN),
    "lubricant": {"viscosity_pa_s": OPEN},
    "load": {"normal_n": OPEN},
}
"""Sections of a journal bearing, whose values no recording contains."""
LEVER = f" * {OPEN} [mm]"
"""End of the expression of a torque that is a force at an unknown radius."""

_QUESTIONS = {
    "rated_torque_n_m": 'what is the motor\'s rated torque, 100 % (such as "1.27 N m")?',
    "rated_force_n": 'what is the motor\'s rated force, 100 % (such as "60 N")?',
    "torque_constant_n_m_a": 'what is the motor\'s torque per ampere (such as "0.5 N m/A")?',
    "inertia_kg_m2": 'no force was recorded: what is the moved inertia (such as "0.02 kg m^2")?',
    "mass_kg": 'no force was recorded: what is the moved mass (such as "3.5 kg")?',
    "pitch_m": 'what is the travel per revolution of the screw (such as "10 mm")?',
}


def guess_rig(keys: set[str], lone_motion: bool = False) -> tuple[Sections, list[Question]]:
    """Propose the sections of a rig, with `?` for open values, and the questions about them.

    Parameters
    ----------
    keys
        Columns of the run.
    lone_motion
        Whether the file holds only a motion, as of a coast-down.
    """
    linear = any(key in keys for key in LINEAR)
    turning = any(key in keys for key in ROTARY)
    if not linear and not turning:
        return {}, []
    motion = "linear" if linear else "rotary"
    drive: dict[str, Any] = {"motion": motion}
    open_keys: list[str] = []
    if "friction_n" in keys:
        drive["friction"] = "force"
    elif keys & {"torque_n_m", "motor_torque_n_m"}:
        drive["friction"] = "torque"
    elif "torque_percent" in keys:
        drive["friction"] = "percent"
        open_keys.append("rated_torque_n_m")
    elif "force_percent" in keys:
        drive["friction"] = "percent"
        open_keys.append("rated_force_n")
    elif "current_a" in keys:
        drive["friction"] = "current"
        open_keys.append("torque_constant_n_m_a")
    elif "voltage_v" in keys:
        drive["friction"] = "voltage"
    elif lone_motion:
        drive["friction"] = "none"
        open_keys.append("mass_kg" if linear else "inertia_kg_m2")
    else:
        drive["friction"] = OPEN  # the friction itself is a question
    of_motor = any(key.startswith("motor_") for key in keys)
    if linear and (of_motor or set(open_keys) & {"rated_torque_n_m", "torque_constant_n_m_a"}):
        open_keys.append("pitch_m")
    drive |= dict.fromkeys(open_keys, OPEN)
    return {"drive": drive}, [
        Question(f"drive.{key}", f"{_QUESTIONS[key]} Write it into the map") for key in open_keys
    ]


def as_bearing(columns: Mapping[str, str]) -> tuple[dict[str, str], Sections]:
    """Expressions of the columns of a map for a journal bearing, and the sections of its rig.

    A force that was taken for one at a lever acts at the surface of the journal.
    """
    renamed = {
        "friction_n" if expression.endswith(LEVER) else key: expression.removesuffix(LEVER)
        for key, expression in columns.items()
    }
    return renamed, {name: dict(section) for name, section in BEARING.items()}


def as_drive(columns: Mapping[str, str]) -> tuple[dict[str, str], Sections]:
    """Expressions of the columns of a map for a drive, and the sections of its rig."""
    renamed = dict(columns)
    if "friction_n" in columns and not any(key in columns for key in LINEAR):
        renamed["torque_n_m"] = f"{renamed.pop('friction_n')}{LEVER}"
    return renamed, guess_rig(set(renamed))[0]


def assumed_machine(sections: Mapping[str, Mapping[str, Any]]) -> str | None:
    """Describe in one line the machine that was derived from the columns; None if none was.

    A recording of a journal bearing may have the same columns as that of a drive.
    """
    if "drive" not in sections:
        return None
    motion = sections["drive"]["motion"]
    return (
        f"described as a {motion} drive ([drive]); for a journal bearing write [bearing] instead "
        "(docs/import.md#a-journal-bearing)"
    )


def force_of_motor(guess: Guess) -> bool:
    """Whether the recorded force is a torque of a motor, which may drive through a gear."""
    drive = guess.rig.get("drive", {})
    of_motor = {"rated_torque_n_m", "torque_constant_n_m_a"} & drive.keys()
    return bool(of_motor) or any(entry.key == "motor_torque_n_m" for entry in guess.entries)


def by_machine(entries: Mapping[str, Entry]) -> dict[str, Entry]:
    """Rename entries by machine type: on a slide, a recorded torque is that of the motor."""
    renamed = dict(entries)
    places = [key for key in ("position_m", "velocity_m_s") if key in renamed]
    of_torque = renamed.keys() & {"torque_n_m", "current_a", "torque_percent", "voltage_v"}
    if of_torque and places and all(renamed[k].expression.endswith(f"[{OPEN}]") for k in places):
        # If a torque is recorded, a position without a unit is more often an angle.
        for key, turning in (("position_m", "angle_rad"), ("velocity_m_s", "velocity_rad_s")):
            if key in renamed and turning not in renamed:
                renamed[turning] = replace(renamed.pop(key), key=turning)
        return renamed
    linear = bool(places)
    if not linear or ("friction_n" in renamed and "velocity_m_s" in renamed):
        return renamed
    for key in ("torque_n_m", "angle_rad", "velocity_rad_s", "speed_rpm"):
        if key in renamed and f"motor_{key}" not in renamed:
            renamed[f"motor_{key}"] = replace(renamed.pop(key), key=f"motor_{key}")
    return renamed


def redundant_motor_columns(entries: Mapping[str, Entry]) -> list[str]:
    """Motor columns that a slide with a recorded force and motion does not need.

    These columns would require a screw pitch.
    """
    if "friction_n" not in entries or not entries.keys() & {"position_m", "velocity_m_s"}:
        return []
    return [key for key in entries if key.startswith("motor_")]


def force_as_torque(entries: dict[str, Entry], ignored: dict[str, str]) -> list[Question]:
    """Replace a force that is recorded with an angle by a torque, and ask for its radius."""
    turning = [key for key in ROTARY if key in entries]
    if "friction_n" not in entries or not turning or "position_m" in entries:
        return []
    force = entries.pop("friction_n")
    if force.expression == OPEN:
        entries["torque_n_m"] = replace(force, key="torque_n_m")
        return []
    if "velocity_m_s" in entries:
        ignored[column_of(entries.pop("velocity_m_s"))] = "redundant: the angle is recorded"
    if "torque_n_m" in entries:
        both = f"{force.expression} or {entries['torque_n_m'].expression}"
        entries["torque_n_m"] = Entry("torque_n_m", OPEN, f"one of: {both}", sure=False)
        return [Question("torque_n_m", f"which is the friction: {both}?")]
    lever = f"{force.expression}{LEVER}"
    entries["torque_n_m"] = Entry("torque_n_m", lever, force.why, sure=False)
    question = (
        f"at what radius does {force.expression} act? Write it in place of the {OPEN}; "
        "for a journal bearing write friction_n and [bearing] (docs/import.md)"
    )
    return [Question("torque_n_m", question)]


def column_of(entry: Entry) -> str:
    """File column of a map entry; the key of the entry if its expression is open."""
    parts = entry.expression.split("`")
    return parts[1] if len(parts) > 1 else entry.key
