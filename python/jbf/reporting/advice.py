"""Usual causes and remedies for each kind of residual structure.

The texts are general workshop experience. They complement the numerical results and do not depend
on them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Advice:
    """Usual causes of a residual pattern, and the recommended action."""

    causes: str
    to_do: str


NONE = Advice(
    "something that no effect in the catalogue has", "look at the runs where it is largest"
)

ADVICE = {
    "velocity": Advice(
        "friction that bends over the speed otherwise than the law does",
        "compare the laws (--law auto); hold a few slow and a few fast speeds for some seconds",
    ),
    "speed range": Advice(
        "friction that bends over the speed otherwise than the law does",
        "compare the laws (--law auto); hold a few slow and a few fast speeds for some seconds",
    ),
    "regime": Advice(
        "a film whose viscosity or load is not what the rig's file says",
        "check the oil's viscosity at its temperature, and the load; record slow sweeps",
    ),
    "direction": Advice(
        "a zero that is off, a weight, or friction that differs between the two ways",
        "read the sensor unloaded before and after; record the same motion both ways",
    ),
    "acceleration": Advice(
        "an inertia that is not in the model, a late channel, or friction that remembers",
        "record one slow and one fast sine of the same speeds; check the filters of both channels",
    ),
    "angle": Advice(
        "a bent shaft, an eccentric seat, a weight, or a ripple of encoder or motor",
        "record a few slow turns each way; see whether it turns with the shaft or with the motor",
    ),
    "time": Advice(
        "warming up, running in, or a zero that wanders",
        "log a temperature; let the rig run warm; read the zero before and after each run",
    ),
    "run": Advice(
        "something that was set differently from run to run: zero, load, oil, temperature",
        "repeat one run at the end of the campaign, and compare it with the first",
    ),
    "time since a rest": Advice(
        "friction that grows while the contact rests, or a film that comes back late",
        "record starts after rests of 0.1, 1, 10 and 100 s",
    ),
    "distance since a reversal": Advice(
        "bending of the contact before it slides, play, or a soft drive",
        "record small reversals of tens of micrometres to a millimetre, position well resolved",
    ),
    "force": Advice(
        "a sensor that is not straight, or that has a hysteresis",
        "calibrate the sensor with weights, up and down",
    ),
    "frequency": Advice(
        "a hum, a resonance of the frame, a motor's current ripple",
        "record at another speed: a resonance stays, what turns moves with the speed",
    ),
    "bursts": Advice(
        "a knock, a loose cable, dirt that passes, somebody who leans on the rig",
        "look at the record at those instants; record the run again",
    ),
    "way": Advice(
        "a wave of rack, ball, magnet or tooth whose phase is another in each run",
        "reference the position, so that all runs count from one place",
    ),
    "period": Advice(
        "friction that depends on where the motion has been, in a way no effect here has",
        "record the same motion at half and at twice the speed",
    ),
    "stroke": Advice(
        "a level of its own in each stroke: lubricant that is pushed about, dirt, scatter",
        "record more strokes, and let some rests lie between them",
    ),
    "parameters": Advice(
        "a machine that was not the same in all runs",
        "look at what was changed between the runs that disagree; diagnose them apart",
    ),
    "unconfirmed": Advice(
        "an effect that stands in for another, or that single runs ask for",
        "look at the runs that ask for it; record one of them again",
    ),
    "effects": Advice(
        "more effects than are searched for, or another law altogether",
        "compare the laws (--law auto)",
    ),
}


def advice_on(axis: str) -> Advice:
    """Return the advice for residual structure along an axis, or of the kind of that name."""
    return ADVICE.get(axis, NONE)
