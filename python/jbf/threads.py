"""Restriction of BLAS to one thread while fits run.

`jbf._core` uses all processor cores. The matrices of a fit are tall and narrow, so that additional
BLAS threads do not accelerate it. However, idle OpenBLAS threads busy-wait for about 20 ms after
each call and occupy processor cores. They doubled the duration of fits, and quadrupled it on a
loaded machine.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController  # type: ignore[import-untyped]

P = ParamSpec("P")
R = TypeVar("R")

_lock = threading.Lock()
_inside = 0
_limit: Any = None


def one_blas_thread(work: Callable[P, R]) -> Callable[P, R]:
    """Decorate `work` to limit BLAS to one thread while any decorated function runs.

    The previous limits are restored afterwards.
    """

    @functools.wraps(work)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> R:
        _enter()
        try:
            return work(*args, **kwargs)
        finally:
            _leave()

    return wrapped


def _enter() -> None:
    global _inside, _limit
    with _lock:
        if _inside == 0:
            _limit = ThreadpoolController().limit(limits=1, user_api="blas")
        _inside += 1


def _leave() -> None:
    global _inside, _limit
    with _lock:
        _inside -= 1
        if _inside == 0:
            _limit.restore_original_limits()
            _limit = None
