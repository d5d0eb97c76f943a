"""Cards of residual patterns in a report: figure, description, cause and advice."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jbf.arrays import Array
from jbf.comparison.axes import all_axes
from jbf.comparison.parts import explained_residual
from jbf.comparison.patterns import Failure, bin_means
from jbf.errors import InputError
from jbf.models.catalogue import transition_speed
from jbf.plot.residuals import draw_means, means_along, residual_in_time
from jbf.plot.runs import largest_error_run
from jbf.plot.spectra import spectrum
from jbf.plot.style import MODEL, legend_above, noise_band, one_axes
from jbf.reporting.advice import advice_on
from jbf.reporting.diagnosis_plot import before_and_after
from jbf.reporting.svg import svg
from jbf.reporting.words import listed, number

if TYPE_CHECKING:
    from markupsafe import Markup

    from jbf.comparison.comparison import Comparison
    from jbf.diagnosis.ledger import Remainder
    from jbf.diagnosis.result import Diagnosis


SIZE = (4.7, 3.0)
LEAST_SHARE = 0.08
"""Minimum share of a pattern that an effect must explain to be named as its cause."""
UNCONFIRMED = "does not improve the held-out prediction"
"""Wording of the reason for a candidate that fits better but is rejected."""
MIN_CAUSE_SHARE = 0.6
"""Minimum total share of a pattern at which effects are named as its full, not partial, cause."""
PLOTTED_AXES = ("time", "run", "angle", "velocity", "speed range", "regime", "direction", "force")

TITLES = {
    "frequency": "Spectral lines",
    "bursts": "In bursts",
    "momentum": "Disturbances",
    "motion": "Larger than errors of the motion",
    "way": "Periodic in the position",
    "period": "Periodic in time",
    "stroke": "Variation between strokes",
    "parameters": "Parameters that differ between runs",
    "effects": "More effects than the limit",
    "unconfirmed": "Effects without held-out confirmation",
}
"""Titles of residual structure that is not associated with an axis."""


@dataclass(frozen=True)
class Card:
    """Card of one residual pattern in a report; its fields are text, except the figure."""

    title: str
    share: str
    picture: Markup
    looks: str
    cause: str
    to_do: str


def failure_cards(diagnosis: Diagnosis) -> list[Card]:
    """Cards of the residual patterns of the base law, with the residual before and after."""
    if not diagnosis.failures:
        return []
    try:
        contributions = explained_residual(diagnosis.before, diagnosis.after)
    except InputError:
        contributions = {}
    return [_failed(diagnosis, failure, contributions) for failure in diagnosis.failures]


def remainder_cards(diagnosis: Diagnosis) -> list[Card]:
    """Return one card per item of unexplained residual structure."""
    structure = [r for r in diagnosis.residual_structure if not r.unfinished]
    return [_remaining(diagnosis.after, remainder) for remainder in structure]


def _failed(
    diagnosis: Diagnosis, failure: Failure, contributions: Mapping[str, Sequence[Array]]
) -> Card:
    ax = one_axes(None, SIZE)
    before_and_after(diagnosis, failure, ax, titled=False)
    remaining = means_along(diagnosis.after, failure.axis)
    unit = diagnosis.model.rig.quantities.force
    first, now = _size(failure), _size(remaining)
    advice = advice_on(failure.axis, diagnosis.after.campaign)
    shares = _shares(diagnosis.before, failure, contributions)
    causes = listed(f"{name} ({100.0 * s:.0f} % of it)" for name, s in shares.items())
    fell = f"the means fall from {number(first, 2)} to {number(now, 2)} {unit}"
    fails = any(f.axis == failure.axis for f in diagnosis.after.failures)
    if shares and sum(shares.values()) >= MIN_CAUSE_SHARE:
        cause = f"{causes}."
    elif shares:
        cause = f"Partly {causes}. The usual cause of the rest: {advice.causes}."
    else:
        cause = f"No added effect. Usual cause: {advice.causes}."
    if fails:
        to_do = f"With the final model {fell}, but a pattern remains. {_sentence(advice.to_do)}"
    elif now < first:
        to_do = f"No action needed: with the final model {fell}, without a remaining pattern."
    else:
        to_do = _sentence(advice.to_do)
    share = f"{100 * failure.share:.0f} % of the mean square"
    alt = f"Residual along {failure.axis}, before and after"
    title = f"Along {failure.axis}"
    return Card(title, share, svg([ax], alt), _sentence(failure.where), cause, to_do)


def _remaining(after: Comparison, remainder: Remainder) -> Card:
    bursts = remainder.axis == "time" and "burst" in remainder.where
    kind = "bursts" if bursts else remainder.axis
    if kind == "run" and UNCONFIRMED in remainder.where:
        kind = "unconfirmed"
    advice = advice_on(kind, after.campaign)
    ax = one_axes(None, SIZE)
    if remainder.axis == "frequency":
        spectrum(after, ax=ax).set_title("", loc="left")
    elif bursts:
        residual_in_time(after, largest_error_run(after), ax=ax)
    elif remainder.axis == "run" and len(after.runs) == 1:
        residual_in_time(after, 0, ax=ax)
    elif remainder.axis in PLOTTED_AXES or any(remainder.axis == f.axis for f in after.failures):
        quantities = after.model.rig.quantities
        noise_band(ax, after.noise_rms, unit=quantities.force)
        draw_means(ax, means_along(after, remainder.axis), MODEL, quantities)
        ax.set_title("", loc="left")
        legend_above(ax, 2)
    else:
        residual_in_time(after, largest_error_run(after), ax=ax)
    alt = f"Residual structure along {remainder.axis}"
    return Card(
        TITLES.get(kind, f"Along {remainder.axis}"),
        f"{100 * remainder.share:.0f} % of the mean square",
        svg([ax], alt),
        _sentence(remainder.where),
        f"No effect of the catalogue. Usual cause: {advice.causes}.",
        _sentence(advice.to_do),
    )


def _size(failure: Failure) -> float:
    """Root mean square of a pattern's bin means, weighted by the number of samples, N."""
    weight = failure.counts / max(int(failure.counts.sum()), 1)
    return float(np.sqrt(np.sum(weight * failure.means_n**2)))


def _shares(
    before: Comparison, failure: Failure, contributions: Mapping[str, Sequence[Array]]
) -> dict[str, float]:
    """Share of a residual pattern that each effect explains, in descending order.

    Shares below `LEAST_SHARE` are omitted.
    """
    u_tr = transition_speed(before.model.law, before.model.values.tolist())
    axes = [a for a in all_axes(before.campaign, u_tr) if a.axis == failure.axis]
    sum_of_squares = float(np.sum(failure.counts * failure.means_n**2))
    if not axes or sum_of_squares <= 0.0 or len(axes[0].bins) != len(failure.bins):
        return {}
    shares = {}
    for name, parts in contributions.items():
        means, counts = bin_means(axes[0], before.samples, list(parts))
        shares[name] = float(np.sum(counts * means * failure.means_n)) / sum_of_squares
    largest = {name: s for name, s in shares.items() if s >= LEAST_SHARE}
    # Effects that partly cancel sum to more than the whole pattern: normalize the shares.
    total = max(sum(largest.values()), 1.0)
    return {name: s / total for name, s in sorted(largest.items(), key=lambda item: -item[1])}


def _sentence(words: str) -> str:
    """Capitalize a clause and end it with a full stop; the name of an effect is not capitalized."""
    capital = words[:1] if "_" in words.partition(" ")[0] else words[:1].upper()
    return f"{capital}{words[1:].rstrip('.')}."
