"""The plot of an import: curves, shaded runs, hatched excluded pieces, labels."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jbf.errors import InputError
from jbf.importing.cutting.piece import Piece
from jbf.importing.overview import Overview
from jbf.importing.result import Import
from jbf.plot.style import BEFORE, MODEL
from jbf.records.rig import Rig
from jbf.reporting.cut_plot import plot_cut, save_cut
from matplotlib.axes import Axes
from matplotlib.colors import to_hex

CURVE = (np.arange(4.0), np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, 2.0, 4.0, 7.0]))


def imported(pieces: Sequence[Piece]) -> Import:
    """An import of given pieces; the second part of its recording is drawn 100 s later."""
    overview = Overview("a.csv", (0.0, 100.0), {"friction_n": CURVE})
    return Import(Path("out"), Rig(), tuple(pieces), {"files": []}, (overview,))


def spans(ax: Axes) -> list[tuple[float, float, str]]:
    """Start, end and colour of each shaded piece, and the hatch of excluded pieces."""
    boxes: Any = ax.patches
    return [
        (b.get_x(), b.get_x() + b.get_width(), b.get_hatch() or to_hex(b.get_facecolor()))
        for b in boxes
    ]


def test_runs_are_shaded_alternately_and_excluded_pieces_hatched_in_the_plot() -> None:
    pieces = [
        Piece("a_1", "a.csv", 0, 1.0, 2.0),
        Piece("", "a.csv", 0, 2.0, 4.0, False, "at rest"),
        Piece("a_2", "a.csv", 1, 5.0, 6.0),
        Piece("b_1", "b.csv", 0, 7.0, 8.0),
        Piece("a_3", "a.csv", 1, 6.0, 9.0),
    ]
    (ax,) = plot_cut(imported(pieces))
    assert spans(ax) == [
        (1.0, 2.0, MODEL),
        (2.0, 4.0, "///"),
        (105.0, 106.0, BEFORE),
        (106.0, 109.0, MODEL),
    ]
    named = [(text.get_text(), text.xy) for text in ax.texts]  # type: ignore[attr-defined]
    assert named == [("1", (1.0, 1.0)), ("2", (105.0, 1.0)), ("3", (106.0, 1.0))]


@pytest.mark.parametrize(("runs", "labels"), [(40, 40), (41, 0)])
def test_runs_are_labelled_in_the_plot_only_up_to_forty_of_them(runs: int, labels: int) -> None:
    (ax,) = plot_cut(imported([Piece(f"r_{k}", "a.csv", 0, k, k + 0.5) for k in range(runs)]))
    assert (len(ax.patches), len(ax.texts)) == (runs, labels)


def test_import_is_plotted_on_given_axes_and_a_wrong_number_of_axes_is_refused() -> None:
    outcome = imported([Piece("r", "a.csv", 0, 1.0, 2.0)])
    drawn = plot_cut(outcome)
    assert plot_cut(outcome, drawn) == drawn
    with pytest.raises(InputError, match="2 axes were given"):
        plot_cut(outcome, [*drawn, *drawn])


def test_import_plot_is_saved_as_svg_and_unknown_file_types_are_refused(tmp_path: Path) -> None:
    outcome = imported([Piece("r", "a.csv", 0, 1.0, 2.0)])
    save_cut(outcome, tmp_path / "cut.svg")
    assert "<svg" in (tmp_path / "cut.svg").read_text()
    with pytest.raises(InputError, match=r"name a \.png"):
        save_cut(outcome, tmp_path / "cut.words")
