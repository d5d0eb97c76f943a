"""Processor time of `jbf.control.run` for 100 s of a loop at 2 ms (50,000 steps).

`python benches/control_runs.py` prints the median and the shortest of several runs for each scheme.
The times include the simulated shaft and the log. The task is the sine in velocity control of Table
6.2 in Cohn (1998). The simulated rig is the one described there, with its elastic belt or without
it (`rigid`). `all effects` has every effect of the catalogue that needs no thermometer, at its
starting values.
"""

from __future__ import annotations

import argparse
import statistics
import time
from dataclasses import replace

from jbf import Model, control
from jbf.control.bench import THESIS_RIG
from jbf.models.catalogue import effects

TASK = replace(control.TASKS["velocity sine"], seconds=100.0)
RUNS = 9


def burdened() -> Model:
    """Return the film model with every compatible effect that needs no thermometer."""
    names = [
        name
        for name, page in effects().items()
        if "journal" not in page.refused and not {"temperatures", "temperature"} & {*page.needs}
    ]
    values = {f"{n}.{p.name}": p.starts[0] for n in names for p in effects()[n].parameters}
    return Model(THESIS_RIG, effects=names, parameters=values, clock="thesis")


def main() -> None:
    """Print one row of times per scheme, for three simulated rigs."""
    argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0]).parse_args()
    benches = {
        "elastic belt": control.thesis_model(),
        "rigid": control.thesis_model(elastic="nothing"),
        "all effects": burdened(),
    }
    print("| scheme | " + " | ".join(f"{name}, ms" for name in benches) + " |")
    print("| --- |" + " --- |" * len(benches))
    for scheme in control.SCHEMES:
        cells = []
        for model in benches.values():
            times = []
            for _ in range(RUNS):
                begin = time.process_time()
                control.run(model, scheme, TASK)
                times.append(1e3 * (time.process_time() - begin))
            cells.append(f"{statistics.median(times):.1f} ({min(times):.1f})")
        print(f"| `{scheme}` | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
