"""Backlash: motion of a journal whose drive has a gap, divided into pieces.

The flanks of the drive are `gap_rad` apart. After each reversal the journal rests until the drive
has crossed the gap. At the first motion of a run the driving flank is in contact.
"""

from __future__ import annotations

from scipy.optimize import brentq

from .motions import Motion, Piece


def behind_gap(motion: Motion, gap_rad: float, radius_m: float) -> Motion:
    """Return the motion of the journal for the motion of a drive with a gap."""
    gap = gap_rad * radius_m
    pieces: list[Piece] = []
    place: float | None = None  # m from the flank that drives backward, 0 to gap
    offset = 0.0  # m, drive minus journal
    for piece in motion.pieces:
        if piece.sign == 0:
            pieces.append(_standing(piece, piece.t0, piece.t1, offset))
            continue
        if place is None:
            place = gap if piece.sign > 0 else 0.0
        room = gap - place if piece.sign > 0 else place
        start = piece.position(piece.t0)
        distance = abs(piece.position(piece.t1) - start)
        crossed = min(room, distance)
        place += piece.sign * crossed
        closes = piece.t0
        if distance <= room:
            closes = piece.t1
        elif room > 0.0:
            closes = brentq(
                lambda t, p=piece, s=start, r=room: abs(p.position(t) - s) - r,
                piece.t0,
                piece.t1,
                xtol=1e-13,
            )
        if closes > piece.t0:
            pieces.append(_standing(piece, piece.t0, closes, offset))
        offset += piece.sign * crossed
        if closes < piece.t1:
            pieces.append(_following(piece, closes, offset))
    return Motion(motion.name, motion.duration_s, tuple(pieces))


def _standing(piece: Piece, t0: float, t1: float, offset: float) -> Piece:
    held = piece.position(t0) - offset
    return Piece(t0, t1, lambda t: 0.0, lambda t: held, lambda t: 0.0, 0)


def _following(piece: Piece, t0: float, offset: float) -> Piece:
    return Piece(
        t0,
        piece.t1,
        piece.speed,
        lambda t: piece.position(t) - offset,
        piece.acceleration,
        piece.sign,
    )
