"""Parallel fits in threads.

The compiled core releases the global interpreter lock, so that several fits can run in it at the
same time. Each fit is an independent task: the results are bit-identical to sequential ones.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from jbf.estimation.campaign import Campaign
from jbf.models.catalogue import find_effect, find_law
from jbf.models.user_effects import UserEffect
from jbf.models.user_laws import UserLaw

T = TypeVar("T")
R = TypeVar("R")

MOST_AT_ONCE = 4
"""Largest number of parallel fits; with more, the interpreter lock is the bottleneck."""
MAX_PARALLEL_SAMPLES = 400_000
"""Number of samples above which fits run one after another, since their matrices fill the
memory."""


def fits_at_once(campaign: Campaign, law: str, effects: Sequence[str]) -> int:
    """Number of fits of a campaign to run in parallel.

    The number is one if the matrices of long records fill the memory. It is also one for
    user-defined functions, since they may have an internal state.
    """
    user_defined = isinstance(find_law(law), UserLaw)
    user_defined = user_defined or any(isinstance(find_effect(n), UserEffect) for n in effects)
    if user_defined or campaign.samples.count > MAX_PARALLEL_SAMPLES:
        return 1
    variable = os.environ.get("RAYON_NUM_THREADS", "")
    threads = int(variable) if variable.isdecimal() else 0
    return min(threads or os.cpu_count() or 1, MOST_AT_ONCE)


def in_parallel(work: Callable[[T], R], items: Sequence[T], at_once: int) -> Iterator[R]:
    """Apply `work` to each of `items` in parallel and yield the results in order.

    The first exception, or a caller that stops iterating, cancels the remaining tasks.
    """
    if at_once <= 1 or len(items) < 2:
        yield from map(work, items)
        return
    with ThreadPoolExecutor(at_once) as threads:
        yield from threads.map(work, items)
