"""Where a fit starts, taken from the data: a law in newtons has no one scale that suits a watch
and a press.

Each rule is found by the parameter's name, which is the same in every law; a parameter without
a rule starts where the catalogue says.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jbf.estimation.campaign import Campaign
from jbf.estimation.scales import Scales, scales
from jbf.models.catalogue import Parameter

Starts = tuple[float, ...]
FASTEST_FILM = 5.0
"""A search looks for transition speeds up to so many times the fastest on record."""


def _stiffness(s: Scales) -> Starts:
    """Breakaway over a tenth of a stroke, over the shortest way resolved, and between them."""
    long, short = 0.1 * s.stroke_m, s.resolved_m
    ways = (long, float(np.sqrt(long * short)), short)
    return tuple(s.breakaway_n / way for way in ways)


_RULES: dict[str, Callable[[Scales], Starts]] = {
    "F_c_n": lambda s: (s.kinetic_n, s.whole_n),
    "F_s_n": lambda s: (s.breakaway_n,),
    "F_s_inf_n": lambda s: (s.breakaway_n - s.kinetic_n,),
    "F_v_n_s_m": lambda s: (s.viscous_n_s_m, 0.0),
    "v_s_m_s": lambda s: (s.slow_m_s, 0.3 * s.usual_m_s),
    "v_d_m_s": lambda s: (s.usual_m_s,),
    "sigma_0_n_m": _stiffness,
    "k_t_n_m": _stiffness,
    # A law in newtons presses with one.
    "presliding.sigma_1_m": _stiffness,
    "sigma_1_n_s_m": lambda s: (0.05 * s.kinetic_n / s.usual_m_s,),
    "coulomb_drag.F_d_n": lambda s: (0.1 * s.kinetic_n,),
}
"""Name to starting values, likeliest first."""
_LINEAR_RULES: dict[str, Callable[[Scales], Starts]] = {
    # A drive that gives by a hundredth or a thousandth of a stroke under the friction, and
    # swings well within the time of a stroke.
    "drive_compliance.k_n_m_rad": lambda s: tuple(
        s.breakaway_n / (share * s.stroke_m) for share in (1e-2, 1e-3)
    ),
    "drive_compliance.J_kg_m2": lambda s: (
        s.breakaway_n / (1e-2 * s.stroke_m) * (0.02 * s.stroke_m / s.usual_m_s) ** 2,
    ),
    "drive_compliance.c_n_m_s_rad": lambda s: (s.breakaway_n / s.usual_m_s,),
}
"""The same for a drive on a linear axis, whose catalogue values are those of a shaft."""


def _bounded(pages: dict[str, Parameter], campaign: Campaign) -> dict[str, Parameter]:
    """Pages of parameters that the data bound: a film that carries the load only at several times
    the fastest speed on record never shows, and its equations grow stiff."""
    name = "U_tr_m_s"
    if name not in pages:
        return {}
    top = max(float(np.max(np.abs(p.motion.velocity_m_s))) for p in campaign.prepared)
    page = pages[name]
    upper = min(page.upper, max(FASTEST_FILM * top, 2.0 * max(page.starts)))
    return {name: replace(page, upper=upper)}


def with_starts(pages: dict[str, Parameter], campaign: Campaign) -> dict[str, Parameter]:
    """The pages of a problem's parameters, their starting values taken from the data.

    A law that scales with the load keeps the catalogue's: its coefficients know no newtons. Of a
    law with a film the data bound the transition speed.
    """
    if "F_c_n" not in pages:
        return pages | _bounded(pages, campaign)
    rules = dict(_RULES)
    if campaign.rig.bearing is None:
        rules |= _LINEAR_RULES
    sizes = scales(campaign)
    found = {}
    for name, page in pages.items():
        if name in rules:
            inside = (float(np.clip(x, page.lower, page.upper)) for x in rules[name](sizes))
            page = replace(page, starts=tuple(dict.fromkeys(inside)))
        found[name] = page
    return found
