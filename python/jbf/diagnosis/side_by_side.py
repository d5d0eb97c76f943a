"""Parallel fits in threads.

The core releases the interpreter lock, so that one fit can run in the core while another is between
two calls. Each fit is an independent task: the results are bit-identical to sequential ones.
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
"""Largest number of parallel fits; with more, the interpreter lock is the bottleneck.

It limits the effort only.
"""


def parallel_fits(campaign: Campaign, law: str, effects: Sequence[str]) -> int:
    """Number of parallel fits for a campaign.

    One fit at a time is used where the matrices of long records fill the memory. User-defined
    functions are not run in parallel either, since they may have an internal state.
    """
    own = isinstance(find_law(law), OwnLaw)
    own = own or any(isinstance(find_effect(name), OwnEffect) for name in effects)
    if own or campaign.samples.count > MOST_SEARCHED:
        return 1
    threads = os.environ.get("RAYON_NUM_THREADS", "")
    asked = int(threads) if threads.isdecimal() else 0
    return min(asked or os.cpu_count() or 1, FEW)


def side_by_side(work: Callable[[T], R], things: Sequence[T], at_once: int) -> Iterator[R]:
    """Apply `work` to each of `things` in parallel and yield the results in order.

    The first exception, or a caller that stops iterating, cancels the remaining tasks.
    """
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
