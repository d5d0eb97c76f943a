"""A picture of loops: response, error, friction and what was learned, schemes side by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jbf.control.constants import FALLBACK
from jbf.control.run import Result
from jbf.reporting.plot_parts import BEFORE, MEASURED, MODEL, NOISE, axes_or_new, dress

Array = npt.NDArray[np.float64]

_LEARNED = {
    "learning": ("K0 / 1e5", "gamma / 10", 1e-5, 0.1),
    "coulomb": ("level (V)", None, 1.0, 1.0),
    "observed": ("level correction (V)", "rest (V)", 1.0, 1.0),
    "table": ("table (V)", None, 1.0, 1.0),
    "repetitive": ("memory (V)", None, 1.0, 1.0),
}
_MOST_POINTS = 6000


def plot_runs(results: Sequence[Result], figure: Figure | None = None) -> Figure:
    """One column a scheme: response, error, friction against speed, friction in time, learned."""
    n = len(results)
    made = Figure(figsize=(4.2 * n, 12.5), layout="constrained") if figure is None else figure
    grid = made.subplots(5, n, squeeze=False)
    for column, result in enumerate(results):
        _column([grid[row][column] for row in range(5)], result, first=column == 0)
    return made


def plot_run_of_loop(run: Result, axes: Sequence[Axes] | None = None) -> list[Axes]:
    """One run: response, error, friction against speed, friction in time, learned; five axes."""
    found = axes_or_new(axes, 5, 1, (7.0, 12.5))
    _column(found, run, first=True)
    return found


def _column(axes: Sequence[Axes], r: Result, *, first: bool) -> None:
    unit = r.task.unit
    what = "Angle" if r.task.is_position else "Speed"
    stride = max(len(r.time_s) // _MOST_POINTS, 1)
    t = r.time_s[::stride]
    top, error, loop, friction, learned = axes
    top.plot(t, r.reference[::stride], color=MEASURED, linewidth=2.2, label="reference")
    top.plot(t, r.response[::stride], color=MODEL, linewidth=0.9, label="response")
    dress(top, r.scheme, "", f"{what} ({unit})" if first else "")
    _errors(error, r, t, stride, f"Error ({unit})" if first else "")
    loop.plot(
        r.velocity_rad_s[::stride],
        r.friction_v[::stride],
        ".",
        color=MEASURED,
        markersize=1.5,
        rasterized=True,
        label="true",
    )
    dress(loop, "Friction against speed", "Speed (rad/s)", "Friction (V)" if first else "")
    friction.plot(t, r.friction_v[::stride], color=MEASURED, linewidth=1.8, label="true")
    if r.scheme != "none":
        estimated = r.estimated_friction_v[::stride]
        friction.plot(t, estimated, color=NOISE, linewidth=0.8, label="estimated")
        loop.plot(
            r.velocity_rad_s[::stride],
            estimated,
            ".",
            color=NOISE,
            markersize=1.0,
            rasterized=True,
            label="estimated",
        )
        span = 2.5 * float(np.max(np.abs(r.friction_v)))
        for ax in (friction, loop):
            ax.set_ylim(-span, span)
    dress(friction, "Friction", "", "Friction (V)" if first else "")
    _learned(learned, r, t, stride)
    if first:
        top.legend(loc="upper right", fontsize="x-small", frameon=False)
    if r.scheme != "none":
        friction.legend(loc="upper right", ncols=2, fontsize="x-small", frameon=False)


def _errors(ax: Axes, r: Result, t: Array, stride: int, label: str) -> None:
    title = f"RMS {r.rms:.3g}, peak {r.peak:.3g}"
    counts = r.time_s >= max(r.task.skip_s, 1.0)
    shown = [r.error[counts]]
    if not r.task.is_position:
        # The loop's own estimate is not the shaft.
        ax.plot(t, r.true_error[::stride], color=MEASURED, linewidth=0.8, label="of the shaft")
        title += f", of the shaft {r.true_rms:.3g}"
        shown.append(r.true_error[counts])
    ax.plot(t, r.error[::stride], color=BEFORE, linewidth=0.8, label="of the estimate")
    largest = max((float(np.quantile(np.abs(e), 0.999)) for e in shown if len(e)), default=1.0)
    ax.set_ylim(-1.5 * largest, 1.5 * largest)
    dress(ax, title, "", label)
    if label and len(shown) > 1:
        ax.legend(loc="upper right", ncols=2, fontsize="x-small", frameon=False)


def _learned(ax: Axes, r: Result, t: Array, stride: int) -> None:
    names = _LEARNED.get(r.scheme)
    if names is None:
        ax.set_axis_off()
    else:
        first, second, by_first, by_second = names
        ax.plot(t, by_first * r.learned_0[::stride], color=MODEL, linewidth=0.9, label=first)
        if second is not None:
            ax.plot(t, by_second * r.learned_1[::stride], color=BEFORE, linewidth=0.9, label=second)
        ax.legend(loc="best", fontsize="x-small", frameon=False)
    alone = (r.status & FALLBACK) > 0
    if alone.any():
        low, high = ax.get_ylim()
        ax.fill_between(r.time_s, low, high, where=alone.tolist(), color=MEASURED, alpha=0.4)
    dress(ax, "Learned", "Time (s)", "")
