"""Motions of a joint or an axis, for exports of models."""

import jbf
import numpy as np

JOINT = jbf.Rig(drive=jbf.Drive("rotary", "torque"))
AXIS = jbf.Rig(drive=jbf.Drive("linear", "force"))
SINES = ((1.3, 0.8), (0.4, 2.0))
"""Angular frequency, rad/s, and amplitude of the speed of each run."""


def joint_runs(rig: jbf.Rig = JOINT, step_s: float = 0.005, scale: float = 1.0) -> list[jbf.Run]:
    """Two runs with modulated sines; the axis moves by the numbers of the joint in metres."""
    runs = []
    for omega, top in SINES:
        time_s = np.arange(0.0, 8.0, step_s)
        velocity = scale * top * np.sin(omega * time_s) * (1.0 + 0.2 * np.sin(0.31 * time_s))
        path = np.concatenate([[0.0], np.cumsum(0.5 * step_s * (velocity[1:] + velocity[:-1]))])
        name = f"{omega:g}_rad_s"
        if rig.radius_m is None:
            runs.append(jbf.Run.from_arrays(time_s, velocity, position_m=path, name=name))
        else:
            angle = path / rig.radius_m
            runs.append(jbf.Run.from_arrays(time_s, velocity, angle_rad=angle, name=name))
    return runs
