"""How many of what, in words: `1 run`, `3 runs`."""

from __future__ import annotations


def count_of(count: int, one: str, many: str = "") -> str:
    """A number and what it counts.

    Parameters
    ----------
    one, many
        What is counted, of one and of several; with an s where the latter is not given.
    """
    return f"{count} {one if count == 1 else many or one + 's'}"
