"""Columns of a run that are computed from recorded columns: temperature in gaps, and speed."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jbf.arrays import Array
from jbf.records.channels import filled
from jbf.records.checks import SLOW, frozen
from jbf.records.findings.finding import Finding


def fill_gaps(name: str, time_s: Array, celsius: Array) -> tuple[Array, tuple[Finding, ...]]:
    """Interpolate the gaps of a temperature record, C, linearly, and report them as a finding."""
    finite = np.isfinite(celsius)
    if finite.all():
        return celsius, ()
    ends = np.concatenate((time_s[:1], time_s[finite], time_s[-1:]))
    longest_s = float(np.max(np.diff(ends)))
    words = f"the temperature has readings at {finite.sum()} of {len(celsius)} samples"
    finding = Finding("gaps", SLOW, name, longest_s, "s", "interpolated linearly", words)
    return filled(time_s, celsius, finite), (finding,)


def derived_speed_column(columns: Mapping[str, Array]) -> Array:
    """Speed as the derivative of the position, m/s; nan if only an angle was recorded."""
    if "position_m" in columns:
        return frozen(np.gradient(columns["position_m"], columns["time_s"]))
    return frozen(np.full(len(columns["time_s"]), np.nan))
