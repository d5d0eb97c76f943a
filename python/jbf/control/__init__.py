"""Friction compensation in a control loop: a simulated bench, compensators, and their settings.

Input: a `Model`, a task, a scheme. Output: settings, and the signals of the loop on the bench.
Loops, observers and compensators are implemented in the core.

>>> from jbf import control
>>> result = control.run(scheme="observed", task=control.TASKS["velocity sine"])
>>> result.rms < 0.005
True

May import: `jbf.records`, `jbf.models`, `jbf._core`.
"""

from jbf.control.bench import THESIS_BENCH, Bench, thesis_model
from jbf.control.motion import Motion, follow
from jbf.control.run import Result, run
from jbf.control.schemes import (
    SCHEMES,
    Coulomb,
    Learning,
    NoCompensation,
    Observed,
    Repetitive,
    Scheme,
    Table,
    scheme,
)
from jbf.control.settings import Settings
from jbf.control.task import TASKS, Task
from jbf.control.tuning import tune

__all__ = [
    "SCHEMES",
    "TASKS",
    "THESIS_BENCH",
    "Bench",
    "Coulomb",
    "Learning",
    "Motion",
    "NoCompensation",
    "Observed",
    "Repetitive",
    "Result",
    "Scheme",
    "Settings",
    "Table",
    "Task",
    "follow",
    "run",
    "scheme",
    "thesis_model",
    "tune",
]
