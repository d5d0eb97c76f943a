"""Linear algebra on one thread while fits run.

The core works on all cores. The matrices of a fit are long and narrow, a second thread gains
nothing on them; but OpenBLAS keeps its own waiting busily for some 20 ms after each call, on the
cores that the core needs: fits took twice as long with them, on a busy machine four times.
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
    """`work` with BLAS held to one thread as long as any such function runs, then as before."""

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
