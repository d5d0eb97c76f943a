"""Force and motion sampled by separate clocks."""

from __future__ import annotations

import numpy as np

from jbf.records.channels import of_motion
from jbf.records.findings.finding import Finding
from jbf.records.run import Run


def separate_clock(run: Run) -> list[Finding]:
    """Report a force that was not sampled at the instants of the motion."""
    force, motion = run.read.get("friction_n"), of_motion(run.read)
    if force is None and motion is None:
        return []
    rates = [
        1.0 / float(np.median(np.diff(run.time_s if sampled is None else run.time_s[sampled])))
        for sampled in (force, motion)
    ]
    noun = run.quantities.noun
    words = f"the {noun} was sampled at {rates[0]:.4g} Hz and the motion at {rates[1]:.4g} Hz"
    done = "compared at its own sampling times"
    return [Finding("own_clock", "friction_n", run.name, rates[0], "Hz", done, words)]
