"""Plot of power curves: detection probability over the strength of an effect."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np

from jbf.errors import InputError
from jbf.plot.style import BEFORE, INK, MEASURED, MODEL, NOISE, OTHER, dress, one_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.diagnosis.power import Power
    from jbf.diagnosis.power.planned_runs import PlannedPower
    from jbf.diagnosis.result import Diagnosis

MOST = 8
LINE_STYLES = ("-", "--", "-.", ":")
COLOURS = (MODEL, BEFORE, NOISE, OTHER, MEASURED)


def power(
    found: Diagnosis | PlannedPower,
    effects: Collection[str] | None = None,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Plot the detection probability of effects against their share of the friction.

    Each curve passes through the strengths that are detected in 80 % and 95 % of campaigns. The
    log-likelihood gain of an effect grows as the square of its strength. The probability is the
    normal distribution function of a deviate that is linear in the strength.

    Parameters
    ----------
    effects
        Effects to draw. Default: the eight with the smallest detectable strength.

    Raises
    ------
    InputError
        No power is known for any of the effects.
    """
    from matplotlib.ticker import LogLocator, NullFormatter
    from scipy.special import ndtr

    curves = [p for p in found.power if _has_curve(p) and (effects is None or p.effect in effects)]
    curves.sort(key=lambda p: p.share_80 or 0.0)
    if not curves:
        raise InputError(
            problem="the power of these effects is unknown",
            remedy="see .power for the available effects",
        )
    ax = one_axes(ax, (7.0, 4.4))
    shown = curves if effects is not None else curves[:MOST]
    strongest = max(100.0 * (p.share_80 or 0.0) for p in shown)
    x = np.geomspace(0.3 * min(100.0 * (p.share_80 or 0.0) for p in shown), 3.0 * strongest, 400)
    for i, p in enumerate(shown):
        chance = ndtr(deviate(p, x / 100.0))
        look = LINE_STYLES[i // len(COLOURS) % len(LINE_STYLES)]
        ax.plot(x, 100.0 * chance, look, color=COLOURS[i % len(COLOURS)], label=p.effect)
    for level in (80.0, 95.0):
        ax.axhline(level, color=INK, linewidth=0.6, alpha=0.5)
    ax.set_xscale("log")
    ax.set_ylim(0.0, 102.0)
    ax.set_xlim(x[0], x[-1])
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    ax.xaxis.set_minor_formatter(NullFormatter())
    more = len(curves) - len(shown)
    title = "Detection probability" + (f"; {more} more require a larger strength" if more else "")
    dress(ax, title, "Strength, share of the friction (%)", "Detection probability (%)")
    ax.legend(frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    return ax


def _has_curve(p: Power) -> bool:
    """Whether the strengths of 80 % and 95 % power are known."""
    return not p.always and None not in (p.detectable_80, p.detectable_95, p.share_80)


def deviate(p: Power, share: np.ndarray) -> np.ndarray:
    """Normal deviate of the detection probability at shares of the friction.

    The deviate is linear in the share, through the points of 80 % and 95 %.
    """
    from scipy.special import ndtri

    assert p.detectable_80 is not None
    assert p.detectable_95 is not None
    assert p.share_80 is not None
    at_80, at_95 = float(ndtri(0.80)), float(ndtri(0.95))
    # For a parameter whose effect saturates, use the change of the friction, which is nearly
    # proportional to the strength.
    ratio = max(abs(p.detectable_95 / p.detectable_80), 1.0 + 1e-6)
    ratio = ratio if ratio < 3.0 else 1.3
    slope = (at_95 - at_80) / (ratio - 1.0)
    return np.asarray(at_80 + slope * (share / p.share_80 - 1.0))
