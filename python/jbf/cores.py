"""No more threads than cores.

The core's threads read how many they shall be when they are first needed; of thousands most wait,
and a machine may not have them.
"""

from __future__ import annotations

import os

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
