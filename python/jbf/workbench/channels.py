"""Any channel of a run for a plot: as recorded, its derivative, or its spectrum."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.signal import welch

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.records.run import Run
from jbf.workbench.series import RunSeries, listed
from jbf.workbench.session import Session
from jbf.workbench.thinning import stretch_of, thinned
from jbf.workbench.views import series_of_run

TRANSFORMS = ("value", "derivative", "spectrum")
HALF_WINDOW = 3
"""Number of samples on each side over which a derivative is the slope of a straight line."""
SEGMENTS = 8
"""Number of segments of a record over which the spectrum is averaged (Welch 1967)."""
OF_MODEL = {"model_n": "model", "residual_n": "record minus model"}
UNITS = {
    "load_n": "N",
    "load_n_m": "N m",
    "angle_rad": "rad",
    "temperature_c": "°C",
    "pressure_pa": "Pa",
    "time_s": "s",
}


def channels(session: Session, number: int | None, name: str) -> dict[str, str]:
    """Names of the channels of a run with their units; those of the model are last."""
    quantities = session.on_bench().rig.quantities
    units = {
        **UNITS,
        "velocity_m_s": quantities.speed,
        "position_m": quantities.length,
        "friction_n": quantities.force,
    }
    run = session.on_bench().run(name)
    found = {key: units.get(key, "") for key in run.columns() if key != "time_s"}
    series = series_of_run(session, number, name)
    return found | {
        key: quantities.force for key in OF_MODEL if series.columns().get(key) is not None
    }


def channel(
    session: Session, number: int | None, name: str, key: str, transform: str,
    span: tuple[float | None, float | None], pixels: int,
) -> dict[str, Any]:  # fmt: skip
    """Curve of one channel of a run, for a plot.

    Parameters
    ----------
    key
        Name of the channel.
    transform
        `value`, `derivative` (slope of a straight line through 7 samples) or `spectrum`
        (root of Welch's power spectral density).
    span
        Interval, s; None is an open end.

    Raises
    ------
    InputError
        The channel or the transform does not exist, or the interval is too short.
    """
    units = channels(session, number, name)
    if key not in units:
        raise InputError(column=key, problem="does not exist", remedy=f"choose {', '.join(units)}")
    if transform not in TRANSFORMS:
        raise InputError(
            problem=f"{transform!r} is not known", remedy=f"choose {', '.join(TRANSFORMS)}"
        )
    time, values = _values(session.on_bench().run(name), series_of_run(session, number, name), key)
    unit = units[key]
    if transform == "spectrum":
        first, last = (
            time[i] if end is None else end for i, end in zip((0, -1), span, strict=True)
        )
        inside = (time >= first) & (time <= last) & np.isfinite(values)
        frequency, density = _spectrum(time[inside], values[inside])
        # The mean is not part of a spectrum.
        return {
            "x": listed(frequency[1:]),
            "y": [float(f"{v:.4g}") for v in density[1:]],
            "x_label": "frequency (Hz)",
            "y_label": f"{key} ({unit}/√Hz)",
            "logarithmic": True,
        }
    if transform == "derivative":
        values, unit = _derivative(time, values), f"{unit}/s"
    reduced = thinned(time, {"y": values}, stretch_of(time, span, pixels))
    label = f"{'d/dt ' * (transform == 'derivative')}{key} ({unit})"
    return {
        "x": listed(reduced["time_s"], 11),
        "y": listed(reduced["y"]),
        "x_label": "time (s)",
        "y_label": label,
        "logarithmic": False,
    }


def _values(run: Run, series: RunSeries, key: str) -> tuple[Array, Array]:
    """Time, s, and values of a channel."""
    if key in OF_MODEL:
        return series.time_s, series.columns()[key]
    return run.time_s, run.columns()[key]


def _derivative(time: Array, values: Array) -> Array:
    """Slope of the straight line through each sample and its neighbours, per second.

    The window is `2 HALF_WINDOW + 1` samples. The first and last `HALF_WINDOW` samples have the
    slope of the first and last complete window.
    """
    width = 2 * HALF_WINDOW + 1
    if len(time) < width:
        return np.gradient(values, time)
    t = np.lib.stride_tricks.sliding_window_view(time, width)
    y = np.lib.stride_tricks.sliding_window_view(values, width)
    centred = t - t.mean(axis=1, keepdims=True)
    slope = (centred * y).sum(axis=1) / (centred**2).sum(axis=1)
    return np.pad(slope, HALF_WINDOW, mode="edge")


def _spectrum(time: Array, values: Array) -> tuple[Array, Array]:
    """Frequency, Hz, and root of the power spectral density, on a uniform time grid."""
    if len(time) < 16:
        raise InputError(problem=f"only {len(time)} samples", remedy="choose a longer interval")
    step = float(np.median(np.diff(time)))
    grid = np.arange(time[0], time[-1], step)
    length = max(len(grid) * 2 // (SEGMENTS + 1), 16)
    frequency, power = welch(
        np.interp(grid, time, values), 1.0 / step, nperseg=min(length, len(grid))
    )
    return np.asarray(frequency), np.sqrt(np.asarray(power))
