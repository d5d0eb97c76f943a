"""Size of the contribution of an effect, as text."""

from __future__ import annotations

from jbf.comparison.comparison import Comparison
from jbf.comparison.parts import added_by
from jbf.reporting.words import against_noise, number


def size_words(comparison: Comparison, effect: str) -> str:
    """State the RMS contribution of an effect to a model, as in `cogging contributes 0.8 N RMS`.

    It is given in the unit of the rig, as a multiple of the noise, and as a share of the recorded
    force or torque. Only included samples count.
    """
    samples, quantities = comparison.samples, comparison.model.rig.quantities
    rms = samples.rms(added_by(comparison, (effect,)))
    recorded_rms = samples.rms([p.friction for p in comparison.campaign.prepared])
    words = f"{effect} contributes {number(rms)} {quantities.force} RMS"
    if comparison.noise_rms > 0.0:
        words += f", {against_noise(rms, comparison.noise_rms, quantities.force)}"
    if recorded_rms > 0.0:
        words += f", {number(100.0 * rms / recorded_rms, 2)} % of the recorded {quantities.noun}"
    return words
