"""Expensive results that are computed once per test session and shared between its workers.

A decorated function is computed by the first test that calls it with given arguments; every other
test, in any pytest-xdist worker, reads the pickled result. `conftest.py` creates the directory
before the workers start and removes it after the session, so that no result outlives the source
code from which it was computed.
"""

import hashlib
import os
import pickle
from collections.abc import Callable
from functools import cache, wraps
from pathlib import Path
from typing import ParamSpec, TypeVar

from filelock import FileLock

P = ParamSpec("P")
R = TypeVar("R")

DIRECTORY = "JBF_SHARED_TEST_RESULTS"
"""Environment variable with the directory of the pickled results."""


def shared(compute: Callable[P, R]) -> Callable[P, R]:
    """Compute each result once per session; arguments are hashable and identified by their repr."""

    @cache
    @wraps(compute)
    def once(*args: P.args, **kwargs: P.kwargs) -> R:
        directory = os.environ.get(DIRECTORY)
        if directory is None:
            return compute(*args, **kwargs)
        call = f"{compute.__module__}.{compute.__qualname__}{args!r}{sorted(kwargs.items())!r}"
        path = Path(directory) / hashlib.sha256(call.encode()).hexdigest()
        with FileLock(path.with_suffix(".lock")):
            if path.exists():
                stored: R = pickle.loads(path.read_bytes())
                return stored
            result = compute(*args, **kwargs)
            path.write_bytes(pickle.dumps(result))
        return result

    return once
