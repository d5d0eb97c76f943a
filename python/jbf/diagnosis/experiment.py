"""The run that would part effects that fit equally well: simulate each under several motions
that the rig has shown it can make, and name the motion in which they differ most."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jbf.catalogue import find_effect
from jbf.model import chain
from jbf.own_effects import ALWAYS
from jbf.record import Run

if TYPE_CHECKING:
    from jbf.diagnosis.search import Search

Array = npt.NDArray[np.float64]

STEP_S = 0.02
DURATION_S = 60.0
SIMULATED = {*ALWAYS, "angle_rad", "position_m"}


def _motions(top: float) -> dict[str, Array]:
    """Speeds (m/s) at `STEP_S` of motions that separate effects, up to the speed `top`."""
    t = np.arange(0.0, DURATION_S, STEP_S)
    found = {
        f"a two-way sine of {top:.3g} m/s at {w:g} rad/s": top * np.sin(w * t)
        for w in (0.1, 0.5, 2.0, 4.0)
    }
    found[f"a one-way sine from {0.1 * top:.3g} to {top:.3g} m/s at 1 rad/s"] = top * (
        0.55 + 0.45 * np.sin(t)
    )
    found[f"a long run at a constant {0.3 * top:.3g} m/s"] = np.full_like(t, 0.3 * top)
    phase = np.mod(t, 20.0)
    ramp = np.clip(np.minimum(phase - 8.0, 14.0 - phase), 0.0, 1.0)
    way = np.where(np.mod(t, 40.0) < 20.0, 1.0, -1.0)
    found[f"stop and go to {0.4 * top:.3g} m/s with rests of 14 s"] = 0.4 * top * ramp * way
    return found


def propose(
    search: Search,
    present: tuple[str, ...],
    tied: dict[str, tuple[str, ...]],
    noise_n: float,
) -> str:
    """A sentence that names the run in which the tied effects differ most."""
    name, others = next(iter(tied.items()))
    rest = tuple(e for e in present if e != name)
    top = max(float(np.max(np.abs(p.motion.velocity_m_s))) for p in search.campaign.prepared)
    rig = search.campaign.rig
    radius = 1.0 if rig.bearing is None else rig.bearing.radius_m
    linear = any(p.run.position_m is not None for p in search.campaign.prepared)
    rivals = [present] + [(*rest, other) for other in others]
    strange = {c for rival in rivals for e in rival for c in find_effect(e).columns} - SIMULATED
    if strange:
        return f"no run can be proposed: nobody knows what {', '.join(sorted(strange))} would be"
    best, separation = "", 0.0
    for words, velocity in _motions(top).items():
        time = np.arange(len(velocity)) * STEP_S
        path = np.concatenate(([0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * STEP_S)))
        place = {"position_m": path} if linear else {"angle_rad": path / radius}
        run = Run.from_arrays(time, velocity, **place)
        curves = [_predict(search, effects, run) for effects in rivals]
        # The least separated pair decides whether the run would settle it.
        gap = min(float(np.sqrt(np.mean((curves[0] - c) ** 2))) for c in curves[1:])
        if gap > separation:
            best, separation = words, gap
    pair = " and ".join((name, *others))
    if separation < 0.1 * noise_n:
        return (
            f"{pair} predict the same friction in every motion tried: "
            "no run of this kind would part them"
        )
    return (
        f"record {best} for {DURATION_S:.0f} s: there {pair} differ by "
        f"{separation:.2g} N RMS, {separation / noise_n:.1f} times the noise"
    )


def _predict(search: Search, effects: tuple[str, ...], run: Run) -> Array:
    from jbf.model import core_motion, imposed

    rig = search.campaign.rig
    solution = search.solve(frozenset(effects))
    motion = core_motion(rig, run, imposed(rig, run))
    core = chain(rig, search.law, search.clock, solution.effects)
    return core.predict(solution.values, [motion])[0]
