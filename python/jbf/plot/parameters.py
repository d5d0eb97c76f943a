"""Plot of fitted parameters with their confidence intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from jbf.arrays import Array
from jbf.models.number_format import value_and_error
from jbf.models.parameter_units import units_of
from jbf.plot.style import INK, MEASURED, MODEL, dress, one_axes, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.estimation.fit import Fit
    from jbf.models.parameter_value import ParameterValue


LINEAR_PERCENT = 1.0
"""Linear threshold of the error axis, in percent of the value; the axis is logarithmic beyond it.

Errors of a few permille and of half the value then fit on one axis.
"""
WIDEST_PERCENT = 300.0
NO_UNITS: Mapping[str, str] = MappingProxyType({})


def height(parameters: Mapping[str, object]) -> float:
    """Height of a figure with this number of parameters, inches."""
    return 1.6 + 0.5 * len(parameters)


def parameters(
    fit: Fit, *, ax: Axes | None = None, answers: Mapping[str, Array] | None = None
) -> Axes:
    """Plot the parameters of a fit with their confidence intervals.

    Parameters
    ----------
    answers
        Estimates of repeated fits by parameter name, drawn behind the intervals.
    """
    ax = one_axes(ax, (7.0, height(fit.parameters)))
    units = units_of(fit.model.law, fit.model.effects, fit.model.rig.quantities)
    return intervals(fit.parameters, answers, units, ax=ax)


def intervals(
    parameters: Mapping[str, ParameterValue],
    answers: Mapping[str, Array] | None = None,
    units: Mapping[str, str] = NO_UNITS,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Plot the standard error of each parameter in percent of its value, and repeated estimates.

    A parameter with value zero or without a standard error is an open marker. `units` contains
    the unit of each parameter that has one.
    """
    from matplotlib.ticker import FuncFormatter

    ax = one_axes(ax, (7.0, height(parameters)))
    names = list(parameters)
    largest = 2.0 * LINEAR_PERCENT
    for row, name in enumerate(names):
        p = parameters[name]
        if p.stderr is None or p.value == 0.0 or not math.isfinite(p.value):
            ax.plot(0.0, row, "o", color=MODEL, markerfacecolor="white", markersize=5)
            continue
        percent = 100.0 * abs(p.stderr / p.value)
        if answers is not None:
            deviation = 100.0 * (answers[name] / p.value - 1.0)
            ax.plot(deviation, np.full(len(deviation), row), "|", color=MEASURED, markersize=9)
        ax.errorbar(0.0, row, xerr=percent, fmt="o", color=MODEL, capsize=3, markersize=5)
        largest = max(largest, 1.5 * percent)
    labels = []
    for name in names:
        value = f"{_value_words(parameters[name])} {units.get(name, '')}".rstrip()
        labels.append(f"{name}\n{value}")
    ax.set_yticks(range(len(names)), labels=list(map(plain, labels)), fontsize="small")
    ax.set_ylim(len(names) - 0.4, -0.6)
    ax.axvline(0.0, color=INK, linewidth=0.6)
    ax.set_xscale("symlog", linthresh=LINEAR_PERCENT)
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    reach = min(largest, WIDEST_PERCENT)
    ax.set_xlim(-reach, reach)
    dress(ax, "Parameters with standard errors", "Deviation from the value (%)", "")
    return ax


def _value_words(p: ParameterValue) -> str:
    value, error = value_and_error(p)
    return f"{value} ± {error}" if error else value
