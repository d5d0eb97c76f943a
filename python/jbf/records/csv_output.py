"""Conversion of columns to CSV text without loss of precision."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt


def csv_of_columns(
    columns: Mapping[str, npt.NDArray[np.float64]],
    read: Mapping[str, npt.NDArray[np.bool_] | None],
) -> str:
    """Convert columns of equal length to CSV text.

    Parameters
    ----------
    columns
        Column name to values.
    read
        Column name to a mask of the instants at which the column was sampled; its other cells are
        empty. None for a column that was sampled at every instant.
    """
    # repr of a float is the shortest text that is parsed to the same float.
    cells = {name: list(map(repr, values.tolist())) for name, values in columns.items()}
    for name, mask in read.items():
        for i in np.flatnonzero(~mask).tolist() if mask is not None else ():
            cells[name][i] = ""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*cells.values(), strict=True))
    return text.getvalue()
