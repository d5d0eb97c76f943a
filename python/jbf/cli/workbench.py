"""`jbf workbench [FOLDER]`: local web page for runs, models and errors."""

from __future__ import annotations

import contextlib
import os
import sys
import webbrowser
from dataclasses import dataclass

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS


@dataclass(frozen=True)
class WorkbenchOptions:
    """Arguments of `jbf workbench`."""

    folder: str
    demo: bool
    port: int
    no_browser: bool


def add(commands: Commands) -> None:
    """Add `jbf workbench` to the parser."""
    parser = command(commands, "workbench", COMMANDS["workbench"], WorkbenchOptions, run)
    parser.add_argument(
        "folder",
        metavar="FOLDER",
        nargs="?",
        default=".",
        help="folder that the page may read (default: the current folder)",
    )
    parser.add_argument("--demo", action="store_true", help="open the shipped data of jbf demo")
    parser.add_argument(
        "--port", type=int, default=0, metavar="N", help="port (default: any free port)"
    )
    parser.add_argument(
        "--no-browser", action="store_true", help="print the address without opening a browser"
    )


def run(options: WorkbenchOptions) -> int:
    """Run `jbf workbench` and return its exit code."""
    from jbf.workbench.serve import serve

    def opened(address: str) -> None:
        opens_browser = not options.no_browser and _has_a_screen()
        where = (
            "The page opens in your browser" if opens_browser else "Open this address in a browser"
        )
        outputs.say(f"{address}\n{where}. Ctrl-C saves the session and stops the program.", {})
        outputs.flush()
        if opens_browser:
            webbrowser.open(address)

    def ended(sentence: str) -> None:
        with contextlib.suppress(OSError):  # the terminal is closed
            outputs.say(sentence, {})
            outputs.flush()

    serve(options.folder, options.port, opened, ended, demo=options.demo)
    return 0


def _has_a_screen() -> bool:
    """Whether a graphical browser can be opened.

    The result is False on Linux without a display, where a text browser would take over the
    terminal.
    """
    return sys.platform != "linux" or any(os.environ.get(n) for n in ("DISPLAY", "WAYLAND_DISPLAY"))
