"""Run an exported joint in MuJoCo along the motions of a reference, where MuJoCo is installed."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.export.reference import Reference

MOST_STEPS = 400_000
"""Largest number of steps of all runs, about ten seconds of computing time."""


def installed_version() -> str | None:
    """Version of the installed MuJoCo; None without one."""
    if find_spec("mujoco") is None:
        return None
    try:
        return str(import_module("mujoco").__version__)
    except ImportError:
        return None


def run_mujoco(test_model: str, step_s: float, reference: Reference) -> list[Array] | None:
    """Friction of the joint of a model along imposed motions, each shape (n,).

    None if the motions need more than `MOST_STEPS` steps.

    Parameters
    ----------
    test_model
        MJCF of a model with one joint, without gravity.
    step_s
        Time step, s.
    reference
        The motions.
    """
    if sum(run.duration_s for run in reference.runs) > MOST_STEPS * step_s:
        return None
    engine = import_module("mujoco")
    model = engine.MjModel.from_xml_string(test_model)
    model.opt.timestep = step_s
    motions = zip(reference.runs, reference.velocity, reference.position, strict=True)
    return [
        _along(engine, model, run.time_s, velocity, position) for run, velocity, position in motions
    ]


def _along(engine: Any, model: Any, time_s: Array, velocity: Array, position: Array) -> Array:
    """Friction along one motion: what holds the joint at constant speed, without its actuators."""
    step_s = float(model.opt.timestep)
    data = engine.MjData(model)
    instants = np.arange(time_s[0], time_s[-1] + step_s, step_s)
    speeds = np.interp(instants, time_s, velocity)
    positions = np.interp(instants, time_s, position)
    force = np.empty(len(instants))
    for k in range(len(instants)):
        data.qpos[0], data.qvel[0] = positions[k], speeds[k]
        engine.mj_forward(model, data)
        actuators = data.qfrc_actuator[0]
        data.qacc[0] = 0.0
        engine.mj_inverse(model, data)
        force[k] = data.qfrc_inverse[0] - actuators
        # The step advances bristles and springs; its position is replaced by the next sample.
        engine.mj_step(model, data)
    return np.asarray(np.interp(time_s, instants, force))
