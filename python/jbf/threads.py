"""Restriction of BLAS to one thread while fits run.

The core uses all cores. The matrices of a fit are long and narrow, so a second BLAS thread gains
nothing. However, OpenBLAS threads keep spinning for about 20 ms after each call, on the cores that
the core needs. Fits took twice as long with them, and four times as long on a busy machine.
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
