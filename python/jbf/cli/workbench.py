"""`jbf workbench [FOLDER]`: local web page that shows runs, models and errors."""

from __future__ import annotations

import argparse
import os
import sys
import webbrowser

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "workbench", COMMANDS["workbench"], run)
    parser.add_argument(
        "folder", metavar="FOLDER", nargs="?", default=".", help="what the page may see (here)"
    )
    parser.add_argument("--demo", action="store_true", help="open with the shipped data")
    parser.add_argument("--port", type=int, default=0, metavar="N", help="any free one")
    parser.add_argument(
        "--no-browser", action="store_true", help="print the address and open nothing"
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from jbf.workbench.serve import serve

    def opened(address: str) -> None:
        shown = not arguments.no_browser and _has_a_screen()
        where = "It opens in your browser" if shown else "Open this address in a browser"
        outputs.say(f"{address}\n{where}; the page says what to do. Ctrl-C ends it.", {})
        outputs.flush()
        if shown:
            webbrowser.open(address)

    serve(arguments.folder, arguments.port, opened, demo=arguments.demo)
    return 0


def _has_a_screen() -> bool:
    """Return whether a graphical browser can be opened.

    False on Linux without a display, where a text browser would take over the terminal.
    """
    return sys.platform != "linux" or any(os.environ.get(n) for n in ("DISPLAY", "WAYLAND_DISPLAY"))
