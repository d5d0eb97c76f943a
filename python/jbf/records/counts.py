"""Text for counts: `1 run`, `3 runs`."""

from __future__ import annotations


def count_of(count: int, singular: str, plural: str = "") -> str:
    """Return a count with its noun in the singular or the plural.

    Parameters
    ----------
    singular, plural
        Singular and plural of the noun; the default plural is the singular with an s.
    """
    return f"{count} {singular if count == 1 else plural or singular + 's'}"
