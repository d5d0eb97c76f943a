"""Counts in words: `1 run`, `3 runs`."""

from __future__ import annotations


def count_of(count: int, one: str, many: str = "") -> str:
    """Return a count with its noun in the singular or the plural.

    Parameters
    ----------
    one, many
        Singular and plural of the noun; the default plural is the singular with an s.
    """
    return f"{count} {one if count == 1 else many or one + 's'}"
