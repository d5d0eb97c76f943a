"""A command with a limit of processor time: how busy the machine is changes nothing."""

from __future__ import annotations

import resource
import signal
import subprocess
from pathlib import Path

IDLE = 20.0
"""Times its limit that a command may take by the clock: others want the machine too."""


def run(
    command: list[str], folder: Path, environment: dict[str, str], limit_s: float
) -> tuple[int | None, str, str]:
    """Exit code (None: out of time), output and errors; each of its processes has the limit."""

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
