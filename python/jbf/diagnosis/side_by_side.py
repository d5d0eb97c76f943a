"""Several fits side by side, in threads: while one is between two calls of the core, which works
without the interpreter's lock, another is inside.

Each is a task of its own: the answers are those of one after the other, to the bit.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from jbf.estimation.campaign import Campaign
from jbf.estimation.rows import MOST_SEARCHED
from jbf.models.catalogue import find_effect, find_law
from jbf.models.own_effects import OwnEffect
from jbf.models.own_laws import OwnLaw

T = TypeVar("T")
R = TypeVar("R")

FEW = 4
"""Fits at a time at most: of more the interpreter itself, which only one has at a time, is the
narrow place."""


def fits_at_once(campaign: Campaign, law: str, effects: Sequence[str]) -> int:
    """How many fits of such a campaign go side by side: one where records are so long that the
    matrices of each fill the memory, or where functions of one's own, which may remember what they
    were called with, take part."""
    own = isinstance(find_law(law), OwnLaw)
    own = own or any(isinstance(find_effect(name), OwnEffect) for name in effects)
    if own or campaign.samples.count > MOST_SEARCHED:
        return 1
    threads = os.environ.get("RAYON_NUM_THREADS", "")
    asked = int(threads) if threads.isdecimal() else 0
    return min(asked or os.cpu_count() or 1, FEW)


def side_by_side(work: Callable[[T], R], things: Sequence[T], at_once: int) -> Iterator[R]:
    """`work` on each of `things`, so many at once: the answers in their order. The first exception,
    and a caller that stops listening, end it."""
    if at_once <= 1 or len(things) < 2:
        yield from map(work, things)
        return
    with ThreadPoolExecutor(at_once) as threads:
        answers = [threads.submit(work, thing) for thing in things]
        try:
            for answer in answers:
                yield answer.result()
        finally:
            for answer in answers:
                answer.cancel()
