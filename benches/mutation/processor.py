"""Commands with a limit of processor time, which does not depend on the load of the machine."""

from __future__ import annotations

import resource
import signal
import subprocess
from pathlib import Path

IDLE = 20.0
"""Ratio of the wall-clock limit to the processor-time limit, for a loaded machine."""


def run(
    command: list[str], folder: Path, environment: dict[str, str], limit_s: float
) -> tuple[int | None, str, str]:
    """Run a command; return its exit code (None if it exceeded the limit), output and errors.

    The limit applies to each process.
    """

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (int(limit_s), int(limit_s) + 5))

    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=IDLE * limit_s,
            preexec_fn=limited,
        )
    except subprocess.TimeoutExpired:
        return None, "", ""
    out_of_time = done.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
    return None if out_of_time else done.returncode, done.stdout, done.stderr
