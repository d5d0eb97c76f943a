"""The import of a day of samples needs bounded memory."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

SAMPLES = 4_320_000  # 24 h at 50 Hz
LIMIT_MB = 500
BLOCK = 200_000
MAP = """\
[columns]
position_m = "position_m"
velocity_m_s = "velocity_m_s"
friction_n = "friction_n"
temperature_c = "temperature_c"
time_s = "time_s"
[cut]
by = "rests"
[drive]
motion = "linear"
friction = "force"
"""
IMPORT = """\
import sys
from jbf.cli import main
assert main(["import", sys.argv[1], "--map", sys.argv[2], "--out", sys.argv[3]]) == 0
# getrusage would include the memory of the parent process.
lines = open("/proc/self/status").read().splitlines()
print(next(int(line.split()[1]) for line in lines if line.startswith("VmHWM")) / 1024.0)
"""


def block(first: int) -> dict[str, np.ndarray]:
    """Samples of one block: repeated strokes of 100 s and rests of 20 s."""
    time = np.arange(first, min(first + BLOCK, SAMPLES)) / 50.0
    rng = np.random.default_rng(first)
    moves = (time % 120.0 < 100.0).astype(float)
    speed = moves * 0.05 * np.sin(0.7 * time)
    return {
        "time_s": time,
        "position_m": np.round(0.05 / 0.7 * (1.0 - np.cos(0.7 * time)), 6),
        "velocity_m_s": np.round(speed, 6),
        "friction_n": np.round(8.0 * np.sign(speed) + 0.2 * rng.standard_normal(len(time)), 4),
        "temperature_c": np.round(20.0 + np.sin(time / 5e3), 3),
    }


def write_csv(path: Path) -> None:
    with path.open("w") as file:
        for first in range(0, SAMPLES, BLOCK):
            columns = block(first)
            if first == 0:
                file.write(",".join(columns) + "\n")
            rows = zip(*(map(repr, c.tolist()) for c in columns.values()), strict=True)
            file.write("\n".join(map(",".join, rows)) + "\n")


@pytest.mark.extended
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads memory from /proc")
def test_recording_of_one_day_is_imported_within_500_mb_of_memory(tmp_path: Path) -> None:
    write_csv(tmp_path / "day.csv")
    (tmp_path / "map.toml").write_text(MAP)
    arguments = [str(tmp_path / part) for part in ("day.csv", "map.toml", "out")]
    done = subprocess.run(
        [sys.executable, "-c", IMPORT, *arguments], capture_output=True, text=True, check=True
    )
    assert float(done.stdout.splitlines()[-1]) < LIMIT_MB
    runs = list((tmp_path / "out").glob("day_*.csv"))
    assert len(runs) == SAMPLES / 50 / 120
