"""Usual causes and remedies for each kind of residual structure.

The texts are general practical experience and do not depend on the numerical results.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from jbf.estimation.campaign import Campaign


@dataclass(frozen=True)
class Advice:
    """Usual causes of one kind of residual structure, and the recommended action."""

    causes: str
    to_do: str


NONE = Advice(
    "a mechanism that the catalogue does not contain", "look at the runs where it is largest"
)

ADVICE = {
    "velocity": Advice(
        "a friction curve over speed that differs from the law",
        "compare the laws (--law auto); hold a few slow and a few fast speeds for some seconds",
    ),
    "speed range": Advice(
        "a friction curve over speed that differs from the law",
        "compare the laws (--law auto); hold a few slow and a few fast speeds for some seconds",
    ),
    "regime": Advice(
        "a viscosity or load that differs from the rig file",
        "check the oil's viscosity at its temperature, and the load; record slow sweeps",
    ),
    "direction": Advice(
        "a sensor offset, a weight, or friction that differs by direction",
        "read the unloaded sensor before and after; record the same motion in both directions",
    ),
    "acceleration": Advice(
        "an inertia that the model lacks, a delayed channel, or friction with memory",
        "record one slow and one fast sine of the same speeds; check the filters of both channels",
    ),
    "angle": Advice(
        "a bent shaft, an eccentric seat, a weight, or a ripple of the encoder or the motor",
        "record a few slow turns in each direction; check whether shaft or motor has the period",
    ),
    "time": Advice(
        "warm-up, running-in, or sensor drift",
        "record a temperature; warm the rig up first; read the zero before and after each run",
    ),
    "run": Advice(
        "a setting that differs between runs: zero, load, oil, temperature",
        "repeat one run at the end of the campaign, and compare it with the first",
    ),
    "time since a rest": Advice(
        "static friction that grows during a rest, or a film that forms slowly",
        "record starts after rests of 0.1, 1, 10 and 100 s",
    ),
    "distance since a reversal": Advice(
        "presliding, backlash, or a soft drive",
        "record reversals of 10 um to 1 mm with a well-resolved position",
    ),
    "force": Advice(
        "a force sensor with nonlinearity or hysteresis",
        "calibrate the sensor with weights, up and down",
    ),
    "frequency": Advice(
        "mains hum, a resonance of the frame, or current ripple of the motor",
        "record at another speed: a resonance keeps its frequency, a rotating cause does not",
    ),
    "bursts": Advice(
        "an impact, a loose cable, a particle in the contact, or contact with the rig",
        "inspect the record at those instants; record the run again",
    ),
    "momentum": Advice(
        "an impact, a push, contact with the rig, or a force that the model lacks there",
        "inspect the record at those instants; record the run again",
    ),
    "motion": Advice(
        "a force that no effect describes, such as that of a resonance, or an encoder that is "
        "coarser than its readings suggest",
        "record the motion with a finer encoder or a higher rate",
    ),
    "way": Advice(
        "a periodic force of rack, ball, magnet or tooth whose phase differs between runs",
        "reference the position, so that all runs have the same origin",
    ),
    "period": Advice(
        "friction that depends on earlier positions in a way that no effect describes",
        "record the same motion at half and at twice the speed",
    ),
    "stroke": Advice(
        "friction that changes from stroke to stroke: moving lubricant, particles, scatter",
        "record more strokes, with rests between them",
    ),
    "parameters": Advice(
        "a machine that changed between runs",
        "check what changed between the runs that disagree; diagnose them separately",
    ),
    "unconfirmed": Advice(
        "an effect that represents another one, or that only single runs require",
        "inspect the runs that require it; record one of them again",
    ),
    "search": Advice("a time limit or a budget", "repeat with a longer time limit (--time-limit)"),
    "effects": Advice(
        "more effects than the search allows, or a different law",
        "compare the laws (--law auto)",
    ),
}


CHANNELS = {"record a temperature": "temperature"}
"""Steps that recommend a further channel, with the quantity in the name of its column."""


def advice_on(axis: str, campaign: Campaign | None = None) -> Advice:
    """Advice for residual structure along an axis, or of another kind (name in `axis`).

    Parameters
    ----------
    campaign
        The recorded runs. Channels that all of them contain are not recommended.
    """
    advice = ADVICE.get(axis, NONE)
    if campaign is None:
        return advice
    columns = [list(p.run.columns()) for p in campaign.prepared]
    steps = advice.to_do.split("; ")
    kept = [s for s in steps if s not in CHANNELS or not _in_all(CHANNELS[s], columns)]
    return replace(advice, to_do="; ".join(kept))


def _in_all(quantity: str, columns: Iterable[Iterable[str]]) -> bool:
    """Whether every run has a column whose name contains a quantity."""
    return all(any(quantity in name for name in names) for names in columns)
