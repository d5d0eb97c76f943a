"""Maps over all runs: distribution of the friction, and mean residual."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError
from jbf.models.number_format import number
from jbf.plot.runs import axes_words, quantities_of
from jbf.plot.style import DIVERGING, MEASURED, MODEL, dress, one_axes, plain, shortened

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.comparison.comparison import Comparison

Over = Literal["time", "speed", "place", "run"]

CELLS = 120
ROWS = 40
MOST_NAMES = 24
OUTSIDE_SHARE = 0.0005
"""Fraction of the samples that may lie outside a map on each side."""


def friction_map(comparison: Comparison, *, alone: bool = True, ax: Axes | None = None) -> Axes:
    """Plot the density of all samples over speed and friction, with the means of the model.

    Parameters
    ----------
    alone
        Whether to subtract the model terms that are not friction, such as inertia and weight.
    """
    from matplotlib.colors import ListedColormap, LogNorm, to_rgb

    from jbf.comparison.parts import added_by, non_friction_effects

    ax = one_axes(ax)
    samples, prepared = comparison.samples, comparison.campaign.prepared
    rest = added_by(comparison, non_friction_effects(comparison) if alone else ())
    speed = samples.flat([p.motion.velocity for p in prepared])
    measured = samples.flat([p.friction - f for p, f in zip(prepared, rest, strict=True)])
    modelled = samples.flat([m - f for m, f in zip(comparison.predictions, rest, strict=True)])
    edges = [_edges(speed), _edges(measured, ROWS * 2)]
    counts, across, up = np.histogram2d(speed, measured, bins=edges)
    drawn_counts = np.where(counts > 0, counts, np.nan).T
    largest = max(float(counts.max()), 2.0)
    # Opacity grows with the density, so that the map works on light and dark backgrounds.
    veil = ListedColormap([(*to_rgb(MEASURED), a) for a in np.linspace(0.2, 1.0, 64)])
    mesh = ax.pcolormesh(
        across, up, drawn_counts, cmap=veil, norm=LogNorm(1.0, largest), rasterized=True
    )
    named = False
    for direction in (-1.0, 1.0):
        in_direction = speed * direction > 0.0
        if in_direction.any():
            x, mean = _means(speed[in_direction], modelled[in_direction])
            ax.plot(x, mean, color=MODEL, linewidth=1.8, label=None if named else "model, mean")
            named = True
    ax.figure.colorbar(mesh, ax=ax, label="Samples", pad=0.01)
    count = len(prepared)
    dress(ax, f"All samples of {count} run{'s' * (count != 1)}", *axes_words(comparison))
    ax.legend(loc="upper left", frameon=False, fontsize="small")
    return ax


def residual_map(
    comparison: Comparison,
    across: Over = "time",
    up: Over | None = None,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Plot the mean residual (record minus model) in cells of two quantities, in noise units.

    Parameters
    ----------
    across, up
        Horizontal and vertical quantity: `time` in the run, `speed`, `place` (position or angle)
        or `run`. The default of `up` is the run, or the speed if there is only one run.
    """
    from matplotlib.colors import TwoSlopeNorm

    prepared, samples = comparison.campaign.prepared, comparison.samples
    up = up or ("run" if len(prepared) > 1 else "speed")
    for name in (across, up):
        if name not in ("time", "speed", "place", "run"):
            raise InputError(
                problem=f"a map over {name} is not available",
                remedy="choose time, speed, place or run",
            )
    ax = one_axes(ax, (9.0, 1.6 + min(0.22 * len(prepared), 6.0) if up == "run" else 3.6))
    x, y = (samples.flat(_values(comparison, name)) for name in (across, up))
    residual = samples.flat(comparison.residuals)
    edges = [_edges(v, n, runs=len(prepared) if name == "run" else 0)
             for v, n, name in ((x, CELLS, across), (y, ROWS, up))]  # fmt: skip
    sums, *_ = np.histogram2d(x, y, bins=edges, weights=residual)
    counts, *_ = np.histogram2d(x, y, bins=edges)
    noise = comparison.noise_rms or comparison.rms or 1.0
    with np.errstate(invalid="ignore"):
        means = sums / np.where(counts > 0, counts, np.nan) / noise
    top = max(float(np.nanquantile(np.abs(means), 0.99)), 1.0)
    norm = TwoSlopeNorm(0.0, -top, top)
    mesh = ax.pcolormesh(edges[0], edges[1], means.T, cmap=DIVERGING, norm=norm, rasterized=True)
    quantities = quantities_of(comparison)
    ax.figure.colorbar(mesh, ax=ax, label="Residual / noise", pad=0.01, extend="both")
    for name, axis in ((across, ax.xaxis), (up, ax.yaxis)):
        if name == "run":
            every = -(-len(prepared) // MOST_NAMES)
            names = [plain(shortened(p.run.name, 20)) for p in prepared][::every]
            axis.set_ticks(range(0, len(prepared), every), labels=names, fontsize="small")
    if up == "run":
        ax.invert_yaxis()
    words = {
        "time": "Time in the run (s)",
        "speed": f"{quantities.velocity} ({quantities.speed})",
        "place": f"Position ({quantities.length})"
        if quantities.motion == "linear"
        else "Angle (rad)",
        "run": "",
    }
    title = f"Mean residual / noise ({number(noise, 2)} {quantities.force})"
    dress(ax, title, words[across], words[up])
    ax.grid(visible=False)
    return ax


def _values(comparison: Comparison, name: Over) -> list[Array]:
    """Values of a quantity at all samples, one array per run."""
    prepared = comparison.campaign.prepared
    if name == "time":
        return [p.run.time_s - p.run.time_s[0] for p in prepared]
    if name == "speed":
        return [p.motion.velocity for p in prepared]
    if name == "place":
        return [_place(comparison, i) for i in range(len(prepared))]
    return [np.full(len(p.run), float(i)) for i, p in enumerate(prepared)]


def _place(comparison: Comparison, index: int) -> Array:
    """Position or angle of a run."""
    p = comparison.campaign.prepared[index]
    if comparison.model.rig.quantities.motion == "linear" and p.run.position_m is not None:
        return np.asarray(p.run.position_m)
    return np.asarray(p.motion.angle_rad)


def _edges(values: Array, cells: int = CELLS, runs: int = 0) -> Array:
    """Edges of the cells of a map, which cover nearly all values, or one cell per run."""
    if runs:
        return np.linspace(-0.5, runs - 0.5, runs + 1)
    low, high = map(float, np.quantile(values, [OUTSIDE_SHARE, 1.0 - OUTSIDE_SHARE]))
    room = 0.04 * (high - low) or 1.0
    edges: Array = np.linspace(low - room, high + room, cells + 1)
    return edges


def _means(speed: Array, force: Array) -> tuple[Array, Array]:
    """Mean speed and force of samples in bins of the speed."""
    order = np.argsort(speed, kind="stable")
    parts = np.array_split(order, max(min(CELLS // 2, len(order) // 5), 1))
    return np.array([speed[p].mean() for p in parts]), np.array([force[p].mean() for p in parts])
