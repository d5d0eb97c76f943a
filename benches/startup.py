"""Time of `import jbf` and of short commands, each in a new process.

`python benches/startup.py --times 20` prints the shortest and the median time, and the processor
time.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from statistics import median

TASKS = {
    "python -c pass": ["-c", "pass"],
    "import numpy": ["-c", "import numpy"],
    "import jbf": ["-c", "import jbf"],
    "import jbf; jbf.Model": ["-c", "import jbf; jbf.Model"],
    "import jbf; jbf.diagnose": ["-c", "import jbf; jbf.diagnose"],
    "jbf --version": ["-m", "jbf", "--version"],
    "jbf --help": ["-m", "jbf", "--help"],
    "jbf diagnose --help": ["-m", "jbf", "diagnose", "--help"],
    "jbf effects": ["-m", "jbf", "effects"],
}


def turn(words: list[str]) -> tuple[float, float]:
    """Return the wall-clock time and the processor time of one command in a new process, s."""
    before, start = os.times(), time.perf_counter()
    subprocess.run([sys.executable, *words], stdout=subprocess.DEVNULL, check=True)
    wall, after = time.perf_counter() - start, os.times()
    spent = after.children_user + after.children_system
    return wall, spent - before.children_user - before.children_system


def main() -> None:
    """Time each command and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--times", type=int, default=20)
    times = parser.parse_args().times
    print("| task | least, ms | median, ms | of the processor, median, ms |")
    print("| --- | --- | --- | --- |")
    turns: dict[str, list[tuple[float, float]]] = {task: [] for task in TASKS}
    for again in range(times + 1):
        for task, words in TASKS.items():
            took = turn(words)
            if again:  # the first run fills the disk cache
                turns[task].append(took)
    for task, took in turns.items():
        walls, spent = [w for w, _ in took], [s for _, s in took]
        cells = (1e3 * min(walls), 1e3 * median(walls), 1e3 * median(spent))
        print(f"| `{task}` | {' | '.join(f'{cell:.0f}' for cell in cells)} |")


if __name__ == "__main__":
    main()
