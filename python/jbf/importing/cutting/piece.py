"""Results of cutting: cuts, and the pieces between them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Cut:
    """One cut; the span between its two instants is left out.

    Attributes
    ----------
    segment
        Index of the segment of increasing time that contains the cut.
    last_s, first_s
        Last instant before the cut and first instant after it, s.
    """

    segment: int
    last_s: float
    first_s: float
    why: str


@dataclass(frozen=True)
class Piece:
    """Span of a recording that becomes a run or is left out.

    Attributes
    ----------
    name
        Name of the run.
    file
        File name of the recording.
    from_s, to_s
        First and last instant, both included, s.
    why
        Reason, if the piece is not kept.
    """

    name: str
    file: str
    segment: int
    from_s: float
    to_s: float
    keep: bool = True
    why: str = ""
