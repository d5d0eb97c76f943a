"""Linear least squares by blocks of rows, with limited memory.

The derivatives of a long recording may exceed the memory. They are computed run by run and reduced
to triangular factors.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import overload

import numpy as np

from jbf.arrays import Array

MOST_HELD = 2_000_000
"""Largest number of values (samples times parameters) that a solution holds. Larger results are
computed again for each access."""
SEARCHED = 6_000
"""Approximate number of samples of the runs that are selected for searches and score tests. All
runs are used below twice this number, or with fewer than twice `LEAST_RUNS` runs."""
LEAST_RUNS = 4
"""Smallest number of runs that are selected for a search."""
GROUP = 16_000_000
"""Largest number of derivatives held at a time during the computation of a solution."""
BLOCK = 1_000
"""Number of rows of a block of a QR decomposition, which then fits into the cache of a
processor."""
INDEPENDENT = 1e-10
"""Relative singular value above which a direction of a design is independent."""


class OnDemand(Sequence[Array]):
    """Sequence with one array per run, computed at each access.

    Parameters
    ----------
    make
        Function that returns the array of run i.
    count
        Number of runs.
    """

    def __init__(self, make: Callable[[int], Array], count: int) -> None:
        self._make, self._count = make, count

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> Array: ...
    @overload
    def __getitem__(self, index: slice) -> list[Array]: ...
    def __getitem__(self, index: int | slice) -> Array | list[Array]:
        if isinstance(index, slice):
            return [self._make(i) for i in range(self._count)[index]]
        return self._make(range(self._count)[index])


def memory_groups(lengths: Sequence[int], width: int) -> list[list[int]]:
    """Group consecutive runs so that the matrix rows of a group (`width` columns) fit in memory."""
    groups: list[list[int]] = []
    held = GROUP
    for i, length in enumerate(lengths):
        if held + length * width > GROUP:
            groups.append([])
            held = 0
        groups[-1].append(i)
        held += length * width
    return groups


def select_runs(lengths: Sequence[int], names: Sequence[str]) -> list[int]:
    """Select at least `LEAST_RUNS` runs with about `SEARCHED` samples or more, for a search.

    The selection is at regular intervals by name, and does not depend on the order of the runs.
    """
    interval = max(min(sum(lengths) // SEARCHED, len(lengths) // LEAST_RUNS), 1)
    by_name = sorted(range(len(names)), key=lambda i: names[i])
    return sorted(by_name[::interval])


def triangular(r: Array, j: Array) -> tuple[Array, Array]:
    """Reduce residuals and their Jacobian to as many rows as columns by a QR decomposition.

    An orthogonal transformation of the rows changes neither sums of squares nor a Gauss-Newton step
    (Golub & Van Loan, Matrix Computations, section 5.3).
    """
    rows: Array = np.column_stack([j, r])
    factor = rows[:0]
    for start in range(0, len(rows), BLOCK):
        block = np.concatenate([factor, rows[start : start + BLOCK]])
        factor = np.asarray(np.linalg.qr(block, mode="r"), dtype=np.float64)
    return factor[:, -1], factor[:, :-1]


def least_squares(design: Array, target: Array) -> Array:
    """Minimum-norm least-squares solution for a design with columns scaled to unit length."""
    size = np.linalg.norm(design, axis=0)
    size[size <= 0.0] = 1.0
    reduced, axes = triangular(target, design / size)
    step, *_ = np.linalg.lstsq(axes, reduced, rcond=INDEPENDENT)
    return np.asarray(step / size)


def _unit_columns(design: Array) -> Array:
    """Columns of a design scaled to unit length, without those that are zero."""
    # Scale by powers of two, which are exact, so that the squares of large columns do not overflow.
    _, power = np.frexp(np.max(np.abs(design), axis=0, initial=0.0))
    design = np.ldexp(design, -power)
    size = np.linalg.norm(design, axis=0)
    return np.asarray(design[:, size > 0.0] / size[size > 0.0])


def unexplained(design: Array, target: Array) -> Array:
    """Residual of the projection of a target on the column space of a design."""
    design = _unit_columns(design)
    step, *_ = np.linalg.lstsq(design, target, rcond=INDEPENDENT)
    return np.asarray(target - design @ step)


def spanned(design: Array) -> Array:
    """Orthonormal basis of the column space of a design, shape (n, rank)."""
    axes, sizes, _ = np.linalg.svd(_unit_columns(design), full_matrices=False)
    return np.asarray(axes[:, sizes > INDEPENDENT * np.max(sizes, initial=0.0)])


def unexplained_square(design: Array, target: Array) -> float:
    """Sum of squares of the residual of the projection of a target on a design's columns."""
    residual = unexplained(design, target)
    return float(residual @ residual)
