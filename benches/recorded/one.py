"""Diagnose one campaign from its files: `python one.py < case.json > row.json`.

The program is a separate process, so that it can be ended if it takes too long. The limit is
processor time, which does not depend on the load of the machine.
"""

from __future__ import annotations

import json
import math
import sys
import time
import warnings
from collections.abc import Sequence
from types import ModuleType

import jbf
import numpy as np
from case import Case, Row
from judge import found, judge

resource: ModuleType | None
try:
    import resource
except ImportError:  # not on Windows
    resource = None

SLOWEST_M_S = 5e-4
"""Speed below which the sign of a measured speed is uncertain, m/s."""

SETTLED_S = 2.0
"""Duration of the initial-state transient of a film, s."""


def held_out(model: jbf.Model, runs: Sequence[jbf.Run]) -> tuple[float, float]:
    """Return the held-out RMS over all moving samples, and over those after the transient, N."""
    every, late = [], []
    for run in runs:
        assert run.friction is not None
        moves = np.abs(run.velocity) >= SLOWEST_M_S
        error = run.friction - model.predict(run)
        every.append(error[moves])
        late.append(error[moves & (run.time_s >= run.time_s[0] + SETTLED_S)])
    rms = [float(np.sqrt(np.mean(np.concatenate(part) ** 2))) for part in (every, late)]
    return rms[0], rms[1]


def answered(case: Case) -> Row:
    """Diagnose a campaign, assess the result and return its row."""
    begun, worked = time.monotonic(), time.process_time()
    rig = jbf.read_rig(f"{case.runs}/rig.toml")
    diagnosis = jbf.diagnose(rig, jbf.read_runs([case.runs]))
    seconds, cpu_s = time.monotonic() - begun, time.process_time() - worked
    content = diagnosis.to_dict()
    kinds = sorted({finding["kind"] for finding in content.get("findings", [])})
    detected, silent, untrue = found(case.artefacts, kinds)
    rms, settled = held_out(diagnosis.model, jbf.read_runs([case.held_out]))
    named, alternatives = content["effects"], content["alternatives"]
    return {
        "verdict": content["verdict"],
        "named": named,
        "alternatives": alternatives,
        "not_detectable": content["not_detectable"],
        "judged": judge(case.effects, case.artefacts, content["verdict"], named, alternatives),
        "names_all": set(case.effects) <= set(named),
        "residual_structure": [part["where"] for part in content["residual_structure"]],
        "findings": kinds,
        "found": detected,
        "not_found": silent,
        "untrue_findings": untrue,
        "held_out_over_noise": rms / case.noise_rms,
        "held_out_settled": settled / case.noise_rms,
        "seconds": seconds,
        "cpu_s": cpu_s,
    }


def main() -> None:
    """Read a case from standard input and write its row of results.

    `one.py SECONDS` limits the processor time.
    """
    if len(sys.argv) > 1 and resource is not None:
        most = math.ceil(float(sys.argv[1]))
        resource.setrlimit(resource.RLIMIT_CPU, (most, most + 5))
    case = Case(**json.load(sys.stdin))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        row = answered(case)
    json.dump(row, sys.stdout)


if __name__ == "__main__":
    main()
