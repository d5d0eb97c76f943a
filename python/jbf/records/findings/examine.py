"""Examination of a run: all findings on its force, and its usable force readings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array, Mask
from jbf.records.findings.finding import Finding
from jbf.records.findings.gaps import find_gaps
from jbf.records.findings.glitches import find_glitches
from jbf.records.findings.held_samples import find_held
from jbf.records.findings.interpolated import Native, find_native, find_native_of
from jbf.records.findings.interpolated_samples import find_interpolated_samples
from jbf.records.findings.saturation import find_saturation
from jbf.records.findings.slow_channel import find_repeated
from jbf.records.findings.steps import find_steps
from jbf.records.run import Run


@dataclass(frozen=True, eq=False)
class Examined:
    """Findings on a run, and its usable force readings.

    Attributes
    ----------
    findings
        The data-quality findings.
    usable
        False at invalid readings of the force, shape (n,).
    native
        The original readings if the force was interpolated, held or partly filled in; None
        otherwise.
    """

    findings: tuple[Finding, ...]
    usable: Mask
    native: Native | None = None


def examine(run: Run, velocity: Array | None = None, period_s: float | None = None) -> Examined:
    """Detect the recording artefacts of the friction record of a run.

    Parameters
    ----------
    velocity
        Estimated speed, m/s, if it is more accurate than the recorded one.
    period_s
        Sampling period of the force in other runs of the same logger, s, if it is known.
    """
    velocity = run.velocity if velocity is None else velocity
    if run.friction is None:
        return Examined((), np.ones(len(run), dtype=bool))
    native = find_native(run.time_s, run.friction)
    if native is None and period_s is not None:
        native = find_native_of(run.time_s, run.friction, period_s)
    if native is not None:
        return Examined((_interpolated(run, native),), np.ones(len(run), dtype=bool), native)
    held_findings, is_held = find_held(run, np.zeros(len(run), dtype=bool))
    native = find_native(run.time_s[~is_held], run.friction[~is_held]) if held_findings else None
    if native is not None:
        # An interpolated record may also contain held samples.
        return Examined(
            (_interpolated(run, native), *held_findings), np.ones(len(run), dtype=bool), native
        )
    native = find_repeated(run.time_s, run.friction)
    if native is not None:
        return Examined((_repeated(run, native),), np.ones(len(run), dtype=bool), native)
    native = find_interpolated_samples(run.time_s, run.friction)
    if native is not None:
        return Examined((_filled_in(run, native),), np.ones(len(run), dtype=bool), native)
    of_readings = examine_readings(run, velocity)
    held_findings, is_held = find_held(run, ~of_readings.usable)
    usable = of_readings.usable & ~is_held
    findings = (*of_readings.findings, *held_findings, *find_gaps(run), *find_steps(run, usable))
    return Examined(findings, usable)


def examine_readings(run: Run, velocity: Array) -> Examined:
    """Detect single invalid readings of the force: outliers and saturation."""
    glitches, outliers = find_glitches(run, velocity)
    saturation, ends = find_saturation(run)
    return Examined((*glitches, *saturation), ~(outliers | ends))


def _interpolated(run: Run, native: Native) -> Finding:
    rate = 1.0 / native.period_s
    words = f"the {run.quantities.noun} was sampled at {rate:.4g} Hz and interpolated linearly"
    done = "reduced to its readings"
    return Finding("interpolated", "friction_n", run.name, rate, "Hz", done, words)


def _filled_in(run: Run, native: Native) -> Finding:
    share = 100.0 * (1.0 - len(native.time_s) / len(run))
    words = (
        f"{share:.2g} % of the {run.quantities.noun} samples are linear interpolations of their "
        "neighbours, not readings"
    )
    return Finding("interpolated", "friction_n", run.name, share, "%", "left out", words)


def _repeated(run: Run, native: Native) -> Finding:
    rate = 1.0 / native.period_s
    words = f"the {run.quantities.noun} was sampled at {rate:.4g} Hz and held in between"
    done = "reduced to its readings"
    return Finding("held_samples", "friction_n", run.name, rate, "Hz", done, words)
