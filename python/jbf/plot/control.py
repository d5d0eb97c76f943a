"""Time series of a control-loop run: response, error, friction, and learned quantities."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from jbf.errors import InputError
from jbf.plot.style import BEFORE, MEASURED, MODEL, NOISE, dress, legend_above, one_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.control.run import Result

Trace = Literal["response", "error", "loop", "friction", "learned"]
TRACES: tuple[Trace, ...] = ("response", "error", "loop", "friction", "learned")

_LEARNED = {
    "learning": ("K0 / 1e5", "gamma / 10", 1e-5, 0.1),
    "coulomb": ("level (V)", None, 1.0, 1.0),
    "observed": ("level correction (V)", "rest (V)", 1.0, 1.0),
    "table": ("table (V)", None, 1.0, 1.0),
    "repetitive": ("memory (V)", None, 1.0, 1.0),
}
_MOST_POINTS = 6000


def control_trace(
    run: Result, what: Trace = "response", *, ax: Axes | None = None, named: bool = True
) -> Axes:
    """Plot one signal of a control-loop run.

    Parameters
    ----------
    run
        Result of `jbf.control.run`.
    what
        `response` with its reference, `error`, `loop` (friction against speed), `friction` in
        time, or the quantities that the compensator `learned`.
    ax
        Matplotlib axes to draw on. Default: those of a new figure.
    named
        Whether to add the label of the vertical axis and a legend.
    """
    if what not in TRACES:
        raise InputError(
            problem=f"trace {what} is not available", remedy=f"known: {', '.join(TRACES)}"
        )
    ax = one_axes(ax, (7.0, 2.6))
    draw = {
        "response": _response,
        "error": _error,
        "loop": _loop,
        "friction": _friction,
        "learned": _learned,
    }[what]
    draw(ax, run, max(len(run.time_s) // _MOST_POINTS, 1), named)
    return ax


def _response(ax: Axes, r: Result, stride: int, named: bool) -> None:
    what = "Angle" if r.task.is_position else "Speed"
    t = r.time_s[::stride]
    ax.plot(t, r.reference[::stride], color=MEASURED, linewidth=2.2, label="reference")
    ax.plot(t, r.response[::stride], color=MODEL, linewidth=0.9, label="response")
    dress(ax, r.scheme, "Time (s)" if named else "", f"{what} ({r.task.unit})" if named else "")
    if named:
        legend_above(ax, 2)


def _error(ax: Axes, r: Result, stride: int, named: bool) -> None:
    title = f"RMS {r.rms:.3g}, peak {r.peak:.3g}"
    t = r.time_s[::stride]
    counts = r.time_s >= max(r.task.skip_s, 1.0)
    errors = [r.error[counts]]
    thin: dict[str, Any] = {"linewidth": 0.8, "rasterized": True}
    if not r.task.is_position:
        # The loop's own estimate differs from the motion of the shaft.
        ax.plot(t, r.true_error[::stride], color=MEASURED, label="of the shaft", **thin)
        title += f", of the shaft {r.true_rms:.3g}"
        errors.append(r.true_error[counts])
    ax.plot(t, r.error[::stride], color=BEFORE, label="of the estimate", **thin)
    largest = max((float(np.quantile(np.abs(e), 0.999)) for e in errors if len(e)), default=1.0)
    ax.set_ylim(-1.5 * largest, 1.5 * largest)
    dress(ax, title, "Time (s)" if named else "", f"Error ({r.task.unit})" if named else "")
    if named and len(errors) > 1:
        ax.legend(loc="upper right", ncols=2, fontsize="x-small", frameon=False)


def _loop(ax: Axes, r: Result, stride: int, named: bool) -> None:
    rate = r.velocity_rad_s[::stride]
    dots: dict[str, Any] = {"marker": ".", "linestyle": "", "rasterized": True}
    ax.plot(rate, r.friction_v[::stride], color=MEASURED, markersize=1.5, label="true", **dots)
    if r.scheme != "none":
        estimated = r.estimated_friction_v[::stride]
        ax.plot(rate, estimated, color=NOISE, markersize=1.0, label="estimated", **dots)
        _span(ax, r)
    dress(ax, "Friction against speed", "Speed (rad/s)", "Friction (V)" if named else "")


def _friction(ax: Axes, r: Result, stride: int, named: bool) -> None:
    t = r.time_s[::stride]
    ax.plot(t, r.friction_v[::stride], color=MEASURED, linewidth=1.8, label="true")
    if r.scheme != "none":
        estimated = r.estimated_friction_v[::stride]
        ax.plot(t, estimated, color=NOISE, linewidth=0.8, label="estimated")
        _span(ax, r)
    dress(ax, "Friction", "Time (s)" if named else "", "Friction (V)" if named else "")
    if r.scheme != "none":
        ax.legend(loc="upper right", ncols=2, fontsize="x-small", frameon=False)


def _span(ax: Axes, r: Result) -> None:
    """Limit the vertical axis to 2.5 times the true friction, so that a diverging estimate fits."""
    span = 2.5 * float(np.max(np.abs(r.friction_v)))
    ax.set_ylim(-span, span)


def _learned(ax: Axes, r: Result, stride: int, named: bool) -> None:
    from jbf.control.constants import FALLBACK

    t = r.time_s[::stride]
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
