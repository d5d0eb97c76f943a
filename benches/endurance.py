"""Memory of a process during many diagnoses: `python benches/endurance.py`.

The program diagnoses one campaign after another in one process and prints its resident memory. It
fails if the memory after the last tenth of the campaigns exceeds that after the second tenth by
more than `--growth-mib`.
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from pathlib import Path

import jbf
import numpy as np


def resident_mib() -> float:
    """Return the resident memory of this process, MiB."""
    status = Path("/proc/self/statm")
    if status.exists():
        return int(status.read_text().split()[1]) * resource.getpagesize() / 2**20
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10


def campaign(seed: int, samples: int) -> list[jbf.Run]:
    """Simulate two runs of an axis with dry friction, with a zero offset for odd seeds."""
    random = np.random.default_rng(seed)
    runs = []
    for name, rate in (("slow", 0.7), ("fast", 2.9)):
        t = 0.01 * np.arange(samples)
        v, path = 0.1 * np.cos(rate * t), 0.1 / rate * np.sin(rate * t)
        force = 5.0 * np.sign(v) + 20.0 * v + (seed % 2) + random.normal(0.0, 0.2, len(t))
        runs.append(jbf.Run.from_arrays(t, v, force, position_m=path, name=name))
    return runs


def main() -> int:
    """Run the diagnoses, print the memory and check its growth."""
    parser = argparse.ArgumentParser(prog="endurance", description=__doc__.split(":")[0])
    parser.add_argument("--diagnoses", type=int, default=1000)
    parser.add_argument("--samples", type=int, default=800, help="of a run")
    parser.add_argument("--growth-mib", type=float, default=20.0)
    options = parser.parse_args()
    held, verdicts, begun = [], {"adequate": 0, "missing": 0}, time.monotonic()
    tenth = max(options.diagnoses // 10, 1)
    for k in range(options.diagnoses):
        diagnosis = jbf.diagnose(jbf.Rig(), campaign(k, options.samples), law="stribeck")
        verdicts[diagnosis.verdict] = verdicts.get(diagnosis.verdict, 0) + 1
        if (k + 1) % tenth == 0:
            held.append(resident_mib())
            print(
                f"{k + 1:6} diagnoses {held[-1]:8.1f} MiB {time.monotonic() - begun:7.0f} s",
                flush=True,
            )
    print(", ".join(f"{count} {verdict}" for verdict, count in verdicts.items()))
    growth = held[-1] - held[min(1, len(held) - 1)]
    print(f"grown by {growth:.1f} MiB")
    return 0 if growth <= options.growth_mib else 1


if __name__ == "__main__":
    sys.exit(main())
