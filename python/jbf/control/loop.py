"""Control loop around a compensator: control law and observer of Cohn (1998), loop guards."""

from __future__ import annotations

from typing import Any

from jbf import _core
from jbf.control.bench import Bench
from jbf.control.settings import Settings
from jbf.control.task import Task


def gains(task: Task, bench: Bench) -> tuple[float, float]:
    """Gains of the control law for a task, with the closed-loop poles of Cohn (1998).

    The gains follow from the damping and the input gain of the bench.

    Returns
    -------
    tuple
        k1 (V/rad) and k2 (V s/rad) in position control; g and C (V s/rad) in velocity control.
    """
    return _core.control_gains(task.is_position, bench.damping_1_s, bench.input_rad_s2_v)


def core_loop(task: Task, bench: Bench, guard: Settings | None) -> dict[str, Any]:
    """Arguments of the core for encoder, velocity observer, control law and limits of a loop.

    Without a `guard`, a compensator is stopped only by a jump of the counter, as in the thesis.
    """
    return {
        "dt_s": bench.dt_s,
        "position": task.is_position,
        "drive": bench.drive(),
        "counts_per_rad": bench.counts_per_rad,
        "counter_bits": bench.counter_bits,
        "moving_v": None if guard is None else guard.moving_v,
        "patience_s": None if guard is None else guard.patience_s,
    }
