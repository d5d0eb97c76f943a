"""Assessment of a diagnosis against the hidden effects."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

MOST_ALTERNATIVES = 2
"""A tie with more alternatives than this per name does not count as a result."""


def judge(
    hidden: Collection[str],
    verdict: str,
    named: Sequence[str],
    alternatives: Mapping[str, Sequence[str]],
    *,
    foreign: bool = False,
    unseen: Sequence[str] = (),
) -> str:
    """Assess a result as `right`, `tied`, `abstained` or `wrong`.

    `tied`: all hidden effects are among the names of valid ties. `abstained`: the result reports
    remaining structure, or that the effect could be hidden in these runs, and names nothing false.

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
    """Whether a single set of names was given without alternatives and it is false."""
    return verdict == "missing" and bool(set(named) - set(truth))
