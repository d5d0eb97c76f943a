"""The memory of an import is limited, even for a recording of one day."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

SAMPLES = 4_320_000  # 24 h at 50 Hz
BLOCK = 200_000
COLUMNS = ("time_s", "position_m", "velocity_m_s", "friction_n", "temperature_c")
MAP = (
    "[columns]\n" + "".join(f'{name} = "{name}"\n' for name in COLUMNS)
    + '[cut]\nby = "rests"\n[drive]\nmotion = "linear"\nfriction = "force"\n'
)  # fmt: skip
IMPORT = """\
import sys
from jbf.cli import main
assert main(["import", sys.argv[1], "--map", sys.argv[2], "--folder", sys.argv[3]]) == 0
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
        file.write(",".join(block(0)) + "\n")
        for first in range(0, SAMPLES, BLOCK):
            rows = zip(*(map(repr, c.tolist()) for c in block(first).values()), strict=True)
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
    assert float(done.stdout.splitlines()[-1]) < 500.0
    assert len(list((tmp_path / "out").glob("day_*.csv"))) == SAMPLES / 50 / 120
