"""Option `--plot` of `jbf control`: checked before the computation, written after it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jbf.errors import InputError

if TYPE_CHECKING:
    from jbf.cli import Parser


def add_plot(parser: Parser) -> None:
    """Add the option `--plot`."""
    parser.add_argument("--plot", metavar="PNG", help="write a figure (png, svg or pdf)")


def check_picture(path: str | None) -> None:
    """Raise an InputError if the suffix of a path is not a supported image format."""
    if path is None:
        return
    from matplotlib.backend_bases import FigureCanvasBase

    kind = path.rpartition(".")[2].lower()
    if kind not in FigureCanvasBase.get_supported_filetypes():
        raise InputError(
            file=f"--plot {path}",
            problem="is not an image file",
            remedy="name a png, svg or pdf file",
        )


def save_picture(figure: Any, path: str | None) -> None:
    """Save a figure to the path of `--plot`, if one was given."""
    if path is None:
        return
    try:
        figure.savefig(path, dpi=110)
    except (ValueError, OSError) as error:
        raise InputError(
            file=f"--plot {path}", problem=str(error), remedy="name a png, svg or pdf file"
        ) from None
