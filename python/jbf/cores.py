"""No more threads than cores, no more processes than work.

The core's threads read how many they shall be when they are first needed; of thousands most wait,
and a machine may not have them.
"""

from __future__ import annotations

import os

from jbf.errors import InputError

_VARIABLES = ("RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS")


def cap_threads() -> None:
    """Hold what the environment asks for to the cores that there are."""
    cores = os.cpu_count() or 1
    for name in _VARIABLES:
        try:
            asked = int(os.environ.get(name, "0"))
        except ValueError:
            continue  # no number: the core takes all cores
        if asked > cores:
            os.environ[name] = str(cores)


def check_jobs(asked: int | None) -> None:
    """Refuse to work on nothing at a time.

    Raises
    ------
    InputError
        Fewer than one were asked for.
    """
    if asked is not None and asked < 1:
        raise InputError(file="--jobs", problem=f"{asked} campaigns at a time", mend="1 or more")


def processes(asked: int | None, tasks: int) -> int:
    """How many work side by side: as many as were asked for (None: as there are cores), and never
    more than there are tasks. All of them start at once, however little there is to do."""
    return max(min(asked or os.cpu_count() or 1, tasks), 1)
