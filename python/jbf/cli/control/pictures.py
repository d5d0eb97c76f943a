"""`--plot`: refused before the work where no such picture can be written, written after it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jbf.errors import InputError

if TYPE_CHECKING:
    from jbf.cli import Parser


def add_plot(parser: Parser) -> None:
    """--plot."""
    parser.add_argument("--plot", metavar="PNG", help="write a picture (png, svg or pdf)")


def check_picture(path: str | None) -> None:
    """Before the work: can such a picture be written?"""
    if path is None:
        return
    from matplotlib.backend_bases import FigureCanvasBase

    kind = path.rpartition(".")[2].lower()
    if kind not in FigureCanvasBase.get_supported_filetypes():
        raise InputError(
            file=f"--plot {path}", problem="is no picture", mend="name a png, svg or pdf file"
        )


def save_picture(figure: Any, path: str | None) -> None:
    """Write a figure, where a path was given."""
    if path is None:
        return
    try:
        figure.savefig(path, dpi=110)
    except (ValueError, OSError) as error:
        raise InputError(
            file=f"--plot {path}", problem=str(error), mend="name a png, svg or pdf file"
        ) from None
