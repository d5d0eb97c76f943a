"""`jbf workbench [FOLDER]`: a local page on which runs, models and errors can be seen."""

from __future__ import annotations

import argparse
import webbrowser

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS


def add(commands: Commands) -> None:
    """Put the command on the command line."""
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
    """Do it."""
    from jbf.workbench.serve import serve

    def opened(address: str) -> None:
        outputs.say(f"{address}\nCtrl-C ends it.", {})
        outputs.flush()
        if not arguments.no_browser:
            webbrowser.open(address)

    serve(arguments.folder, arguments.port, opened, demo=arguments.demo)
    return 0
