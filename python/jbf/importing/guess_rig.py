"""What a file's columns say of the machine: sections of its rig, and what only a person knows."""

from __future__ import annotations

from typing import Any

from jbf.importing.expression import OPEN
from jbf.importing.guessed import Question
from jbf.importing.targets import LINEAR, TURNING

Sections = dict[str, dict[str, Any]]

_ASKS = {
    "rated_torque_n_m": 'what is 100 % of the motor\'s torque (such as "1.27 N m")?',
    "rated_force_n": 'what is 100 % of the motor\'s force (such as "60 N")?',
    "torque_constant_n_m_a": 'what torque is 1 A of the motor (such as "0.5 N m/A")?',
    "pitch_m": 'how far does it move in one turn of its screw (such as "10 mm")?',
}


def guess_rig(keys: set[str]) -> tuple[Sections, list[Question]]:
    """The sections of the rig, `?` where a value is open."""
    linear = any(key in keys for key in LINEAR)
    turning = any(key in keys for key in TURNING)
    if not linear and not turning:
        return {}, []
    motion = "linear" if linear else "rotary"
    drive: dict[str, Any] = {"motion": motion}
    asked: list[str] = []
    if "friction_n" in keys:
        drive["friction"] = "force"
    elif keys & {"torque_n_m", "motor_torque_n_m"}:
        drive["friction"] = "torque"
    elif "torque_percent" in keys:
        drive["friction"] = "percent"
        asked.append("rated_torque_n_m")
    elif "force_percent" in keys:
        drive["friction"] = "percent"
        asked.append("rated_force_n")
    elif "current_a" in keys:
        drive["friction"] = "current"
        asked.append("torque_constant_n_m_a")
    else:
        return {}, []
    of_motor = any(key.startswith("motor_") for key in keys)
    if linear and (of_motor or set(asked) & {"rated_torque_n_m", "torque_constant_n_m_a"}):
        asked.append("pitch_m")
    drive |= dict.fromkeys(asked, OPEN)
    return {"drive": drive}, [
        Question(f"drive.{key}", f"{_ASKS[key]} write it into the map") for key in asked
    ]
