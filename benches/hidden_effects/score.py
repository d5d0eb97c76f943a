"""What an answer is worth against what was hidden."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

MOST_ALTERNATIVES = 2
"""A tie of more names than this beside the one given names nothing."""


def judge(
    hidden: Collection[str],
    verdict: str,
    named: Sequence[str],
    alternatives: Mapping[str, Sequence[str]],
    *,
    foreign: bool = False,
    unseen: Sequence[str] = (),
) -> str:
    """`right`, `tied` (all hidden effects are among the names of honest ties), `abstained` (says
    that structure remains, or that the effect could hide in these runs, and names nothing false),
    or `wrong`.

    Parameters
    ----------
    hidden
        Effects of the catalogue in the record.
    foreign
        Whether something is hidden that no catalogue has.
    unseen
        Effects that the answer says could hide in these runs.
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
    """Whether one answer alone was given, and it is not the truth."""
    return verdict == "missing" and bool(set(named) - set(truth))
