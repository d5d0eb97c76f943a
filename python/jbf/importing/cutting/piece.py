"""What cutting gives: cuts, and the pieces between them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Cut:
    """One cut; what lies between its two instants is left out.

    Attributes
    ----------
    segment
        The stretch of growing time that it is in.
    last_s, first_s
        The last instant before it and the first one after.
    """

    segment: int
    last_s: float
    first_s: float
    why: str


@dataclass(frozen=True)
class Piece:
    """A stretch of a recording, a run or left out.

    Attributes
    ----------
    name
        What the run is called.
    file
        The recording's file, by its name.
    from_s, to_s
        First and last instant, both of it.
    why
        Where it is not kept: why.
    """

    name: str
    file: str
    segment: int
    from_s: float
    to_s: float
    keep: bool = True
    why: str = ""
