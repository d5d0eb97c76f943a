"""Assessment of a diagnosis against the hidden effects."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

MOST_ALTERNATIVES = 2
"""Largest number of alternatives per name for a tie that is assessed as `tied`."""


def judge(
    hidden: Collection[str],
    verdict: str,
    named: Sequence[str],
    alternatives: Mapping[str, Sequence[str]],
    *,
    foreign: bool = False,
    unseen: Sequence[str] = (),
) -> str:
    """Assess the effects that a diagnosis names as `right`, `tied`, `abstained` or `wrong`.

    `tied`: all hidden effects are among the named effects and their alternatives, of which there
    are few. `abstained`: no name is false, and the diagnosis reports lack of fit, or that the
    effect is not detectable in these runs.

    Parameters
    ----------
    hidden
        Effects of the catalogue in the record.
    foreign
        Whether an effect that is in no catalogue is hidden.
    unseen
        Effects that the diagnosis reports as not detectable in these runs.
    """
    truth, given = set(hidden), set(named)
    false_name = given - truth
    if foreign:
        return "right" if verdict == "unexplained" and not false_name else "wrong"
    if verdict == "unexplained":
        return "abstained" if not false_name else "wrong"
    if given == truth:
        return "right"
    if given < truth and truth <= given | set(unseen):
        return "abstained"
    honest = len(given) == len(truth)
    open_names = set(given)
    for others in alternatives.values():
        honest = honest and len(others) <= MOST_ALTERNATIVES
        open_names |= set(others)
    return "tied" if honest and truth <= open_names else "wrong"


def unique_and_false(verdict: str, named: Sequence[str], truth: Collection[str]) -> bool:
    """Return True if a diagnosis without alternatives names an effect that is not hidden."""
    return verdict == "missing" and bool(set(named) - set(truth))
