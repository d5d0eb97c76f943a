"""Realistic motions with random rates, phases, stops and rests, not aligned to a sampling grid.

A motion is slightly longer than its record at both ends, because a delayed or leading channel
samples beyond the record.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

from .designs import Design
from .motions import Motion, multisine, polyline
from .seeds import Rng, log_uniform, stream

LEAD_IN_S = 0.06
TAIL_S = 0.3
SLOWEST, FASTEST = 0.08, 3.0  # rad/s
Knots = list[tuple[float, float]]


@dataclass(frozen=True)
class Plan:
    """Planned run: `length_s` of `motion` from `begins_s` on, under a multiple of the rig's load.

    A run that begins before its motion (below 0 s) starts at rest, as the motion does. Other runs
    start during the motion, with an unknown state of the film.
    """

    motion: Motion
    length_s: float
    load_share: float = 1.0
    begins_s: float = LEAD_IN_S


def _length(omega: float, rng: Rng) -> float:
    """Draw the length of a run, two to four periods within limits (s)."""
    period = 2.0 * math.pi / omega
    usual = min(max(rng.uniform(2.0, 4.0) * period, 18.0), max(60.0, 1.1 * period))
    return float(usual * rng.uniform(0.95, 1.1))


def _phase(rng: Rng) -> float:
    """Draw the start of a run: any phase of the motion, or at rest in one of four runs."""
    return 0.0 if rng.random() < 0.25 else float(rng.uniform(0.0, 2.0 * math.pi))


def two_way(name: str, top: float, omega: float, rng: Rng) -> Plan:
    """Draw a run whose speed is a sine without an offset."""
    length = _length(omega, rng)
    tones = [(top * rng.uniform(0.8, 1.0), omega, _phase(rng))]
    return Plan(multisine(name, LEAD_IN_S + length + TAIL_S, tones), length)


def one_way(name: str, top: float, omega: float, rng: Rng) -> Plan:
    """Draw a run whose speed is a sine with an offset and never changes sign."""
    length, swing = _length(omega, rng), rng.uniform(0.35, 0.47) * top
    sense = 1.0 if rng.random() < 0.5 else -1.0
    tones = [(swing, omega, _phase(rng))]
    bias = sense * rng.uniform(1.05, 1.4) * swing
    return Plan(multisine(name, LEAD_IN_S + length + TAIL_S, tones, bias), length)


def triangle(name: str, top: float, omega: float, rng: Rng) -> Plan:
    """Draw a run with a triangular speed and a random starting phase."""
    length, quarter = _length(omega, rng), 0.5 * math.pi / omega
    end = LEAD_IN_S + length + TAIL_S
    begun = 4.0 * quarter * float(rng.uniform())
    heights = (0.0, top, 0.0, -top)
    corners = [
        (k * quarter - begun, heights[k % 4]) for k in range(int((end + begun) / quarter) + 2)
    ]
    return Plan(polyline(name, _between(corners, 0.0, end)), length)


def _between(knots: Knots, start: float, end: float) -> Knots:
    """Cut a speed given by points (s, m/s) to a time interval."""

    def at(t: float) -> float:
        for (t0, v0), (t1, v1) in pairwise(knots):
            if t0 <= t <= t1:
                return v0 + (v1 - v0) * (t - t0) / (t1 - t0)
        raise ValueError(f"no motion at {t} s")

    inside = [(t, v) for t, v in knots if start + 1e-6 < t < end - 1e-6]
    return [(start, at(start)), *inside, (end, at(end))]


def stops(name: str, top: float, _omega: float, rng: Rng) -> Plan:
    """Draw a stop-and-go run: ramps and rests of random length, in either direction."""
    knots: Knots = [(0.0, 0.0), (LEAD_IN_S + float(rng.uniform(0.3, 3.0)), 0.0)]
    for _ in range(int(rng.integers(3, 7))):
        ramp, plateau = rng.uniform(0.15, 1.0), rng.uniform(1.0, 5.0)
        speed = top * rng.uniform(0.25, 0.9) * (1.0 if rng.random() < 0.5 else -1.0)
        start = knots[-1][0]
        knots += [(start + ramp, speed), (start + ramp + plateau, speed)]
        knots += [(start + 2.0 * ramp + plateau, 0.0)]
        knots += [(knots[-1][0] + log_uniform(rng, 0.8, 14.0), 0.0)]
    length = knots[-1][0] - LEAD_IN_S
    knots[-1] = (knots[-1][0] + TAIL_S, 0.0)
    return Plan(polyline(name, knots), length)


def steady(name: str, top: float, _omega: float, rng: Rng) -> Plan:
    """Draw a run with several constant speeds; it begins at the first of them."""
    sense = 1.0 if rng.random() < 0.5 else -1.0
    knots: Knots = [(0.0, sense * log_uniform(rng, 0.03, 1.0) * top)]
    for _ in range(int(rng.integers(3, 7))):
        knots.append((knots[-1][0] + rng.uniform(3.0, 8.0), knots[-1][1]))
        knots.append(
            (knots[-1][0] + rng.uniform(0.2, 1.0), sense * log_uniform(rng, 0.03, 1.0) * top)
        )
    knots.append((knots[-1][0] + 4.0, knots[-1][1]))
    return Plan(polyline(name, knots), knots[-1][0] - LEAD_IN_S - TAIL_S)


def from_rest(name: str, top: float, omega: float, rng: Rng) -> Plan:
    """Draw a run whose speed is a sine without an offset that begins at zero."""
    length = _length(omega, rng)
    return Plan(
        multisine(name, length + TAIL_S, [(top * rng.uniform(0.8, 1.0), omega, 0.0)]), length
    )


def tones(name: str, top: float, _omega: float, rng: Rng) -> Plan:
    """Draw a run whose speed is the sum of three sines and begins at zero."""
    rates = [0.2 * rng.uniform(0.7, 1.4), 0.7 * rng.uniform(0.7, 1.4), 1.8 * rng.uniform(0.7, 1.4)]
    parts = [
        (share * top, omega, float(rng.choice([0.0, math.pi])))
        for share, omega in zip((0.45, 0.3, 0.2), rates, strict=True)
    ]
    return Plan(multisine(name, 40.0 + TAIL_S, parts), 40.0)


Maker = Callable[[str, float, float, Rng], Plan]
EXTRA: tuple[tuple[str, Maker], ...] = (
    ("sine", two_way),
    ("sine", two_way),
    ("one_way", one_way),
    ("triangle", triangle),
    ("steady", steady),
    ("stops", stops),
)


def _named(makers: list[tuple[str, Maker, float]], top: float, rng: Rng) -> list[Plan]:
    order = rng.permutation(len(makers))
    return [
        makers[k][1](f"{i}_{makers[k][0]}", top, makers[k][2], rng) for i, k in enumerate(order)
    ]


def campaign(design: Design, effects: tuple[str, ...], seed: int) -> list[Plan]:
    """Draw the three to seven runs of a campaign.

    They include a slow sine, a fast sine and stops, which any effect needs. With `load_dependence`
    there are three loads; some other campaigns also have several.
    """
    rng = stream(seed, "excitation")
    makers: list[tuple[str, Maker, float]] = [
        ("slow", two_way, log_uniform(rng, SLOWEST, 0.35)),
        ("fast", two_way, log_uniform(rng, 0.9, FASTEST)),
        ("stops", stops, 0.0),
    ]
    for _ in range(int(rng.integers(0, 5))):
        name, maker = EXTRA[int(rng.integers(len(EXTRA)))]
        makers.append((name, maker, log_uniform(rng, SLOWEST, FASTEST)))
    plans = _named(makers, design.top_m_s, rng)
    if "load_dependence" not in effects and rng.random() > 0.12:
        return plans
    shares = [1.0, rng.uniform(0.6, 0.8), rng.uniform(1.25, 1.5)]
    return [Plan(p.motion, p.length_s, shares[i % 3]) for i, p in enumerate(plans)]


def held_out(design: Design, effects: tuple[str, ...], seed: int) -> list[Plan]:
    """Draw runs with other motions of the same rig, for held-out errors.

    One of them has an intermediate load if `effects` contains `load_dependence`. All begin at rest,
    between two samples, because a model cannot predict an unknown initial state.
    """
    rng = stream(seed, "held out")
    makers: list[tuple[str, Maker, float]] = [
        ("h_sine", from_rest, log_uniform(rng, 0.3, 1.2)),
        ("h_tones", tones, 0.0),
        ("h_stops", stops, 0.0),
    ]
    plans = [
        replace(plan, begins_s=-float(rng.uniform(0.05, 0.95)) / design.rate_hz)
        for plan in _named(makers, design.top_m_s, rng)
    ]
    if "load_dependence" in effects:
        plans[0] = replace(plans[0], load_share=1.15)
    return plans
