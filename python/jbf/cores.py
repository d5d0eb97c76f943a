"""Limits on the number of threads and processes.

The thread pool of the core reads its size from the environment at first use. Threads beyond the
number of cores are idle, and the operating system may fail to create thousands of threads.
"""

from __future__ import annotations

import os

from jbf.errors import InputError

_VARIABLES = ("RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS")


def cap_threads() -> None:
    """Limit the thread counts in the environment variables to the number of cores."""
    cores = os.cpu_count() or 1
    for name in _VARIABLES:
        try:
            requested = int(os.environ.get(name, "0"))
        except ValueError:
            continue  # not a number: the core uses all cores
        if requested > cores:
            os.environ[name] = str(cores)


def check_jobs(requested: int | None) -> None:
    """Check that the number of parallel jobs is at least one.

    Raises
    ------
    InputError
        The number is less than one.
    """
    if requested is not None and requested < 1:
        raise InputError(
            file="--jobs", problem=f"{requested} campaigns at a time", remedy="1 or more"
        )


def processes(requested: int | None, tasks: int) -> int:
    """Number of processes for parallel tasks.

    The result is the requested number (None: the number of cores), limited to the number of tasks.
    All processes are started at once, even for short tasks.
    """
    return max(min(requested or os.cpu_count() or 1, tasks), 1)
