"""Time to read the file of a run, compared with numpy's reader: `python benches/reading.py`.

Pairs of readings in turn, in processor time; the result is the median of their ratios. Most of the
work is what numpy omits: names and units of columns, quotes, empty cells, and the row and column of
an error.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from jbf import read_run

HEADER = "time_s,angle_rad,velocity_m_s,friction_n,load_n"


def seconds(read: Callable[[], object]) -> float:
    """Return the processor time of one call of `read`, s."""
    begun = time.process_time()
    read()
    return time.process_time() - begun


def main() -> int:
    """Write a run, read it with both readers and print the times."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split(":")[0])
    parser.add_argument("--rows", type=int, default=6301)
    parser.add_argument("--pairs", type=int, default=101)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.csv"
        lines = (f"{0.02 * i:.3f},5.42412,0.000271,-0.4962,104.0" for i in range(given.rows))
        path.write_text("\n".join((HEADER, *lines)) + "\n", encoding="ascii")
        pairs = [
            (
                seconds(lambda: read_run(path)),
                seconds(lambda: np.loadtxt(path, delimiter=",", skiprows=1)),
            )
            for _ in range(given.pairs)
        ]
    ours, numbers = np.median(pairs, axis=0)
    ratio = np.median([a / b for a, b in pairs])
    times_text = f"{1e3 * ours:.2f} ms, numpy.loadtxt {1e3 * numbers:.2f} ms, {ratio:.1f} times"
    print(f"{given.rows} rows: {times_text}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
