"""Results of cutting: cuts, and the pieces between them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Cut:
    """One cut of a recording; the span between its two instants is omitted.

    Attributes
    ----------
    segment
        Index of the segment of increasing time that contains the cut.
    last_s, first_s
        Last instant before the cut and first instant after it, s.

    why
        Reason for the cut.
    """

    segment: int
    last_s: float
    first_s: float
    why: str


@dataclass(frozen=True)
class Piece:
    """Span of a recording that becomes a run or is omitted.

    Attributes
    ----------
    name
        Name of the run.
    file
        File name of the recording.
    segment
        Index of the segment of increasing time.
    from_s, to_s
        First and last instant, both included, s.
    keep
        Whether the piece becomes a run.
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
