"""Rows of many samples, without holding them all: of a recording of days the derivatives alone
would fill a machine's memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import overload

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

MOST_HELD = 2_000_000
"""Numbers (samples times parameters) that a solution holds; more are made again when asked for."""
MOST_SEARCHED = 400_000
"""Samples of a search for the way to a minimum; of more, some of the runs show it as well."""
GROUP = 16_000_000
"""Derivatives that are held at a time on the way to a solution."""


class OnDemand(Sequence[Array]):
    """One array a run, made each time that it is asked for.

    Parameters
    ----------
    make
        The array of run i.
    count
        Number of runs.
    """

    def __init__(self, make: Callable[[int], Array], count: int) -> None:
        self._make, self._count = make, count

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, which: int) -> Array: ...
    @overload
    def __getitem__(self, which: slice) -> list[Array]: ...
    def __getitem__(self, which: int | slice) -> Array | list[Array]:
        if isinstance(which, slice):
            return [self._make(i) for i in range(self._count)[which]]
        return self._make(range(self._count)[which])


def groups_of(lengths: Sequence[int], width: int) -> list[list[int]]:
    """Runs in a row whose rows, so wide, are held at a time."""
    groups: list[list[int]] = []
    held = GROUP
    for i, length in enumerate(lengths):
        if held + length * width > GROUP:
            groups.append([])
            held = 0
        groups[-1].append(i)
        held += length * width
    return groups


def every_so_many(lengths: Sequence[int], names: Sequence[str]) -> list[int]:
    """Runs with half as many samples as a search takes at most, all of them where that many are not
    there: every so many by name, in whatever order they are given."""
    apart = 2.0 * sum(lengths) / MOST_SEARCHED
    if apart <= 2.0 or len(lengths) < 2.0 * apart:
        return list(range(len(lengths)))
    by_name = sorted(range(len(names)), key=lambda i: names[i])
    return sorted(by_name[k] for k in range(0, len(names), int(np.ceil(apart))))


def triangular(r: Array, j: Array) -> tuple[Array, Array]:
    """A residual and its derivatives in as few rows as there are numbers in one.

    A rotation of rows changes neither sums of squares nor what a Gauss-Newton step does (Golub &
    Van Loan, Matrix Computations, section 5.3).
    """
    rows: Array = np.column_stack([j, r])
    factor = np.asarray(np.linalg.qr(rows, mode="r"), dtype=np.float64)
    return factor[:, -1], factor[:, :-1]
