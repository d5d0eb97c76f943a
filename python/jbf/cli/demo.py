"""`jbf demo [DIR]`: the whole story on shipped data with a hidden effect."""

from __future__ import annotations

import argparse
from pathlib import Path

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown


def add(commands: Commands) -> None:
    """Put the command on the command line."""
    parser = command(commands, "demo", COMMANDS["demo"], run)
    parser.add_argument(
        "directory", metavar="DIR", nargs="?", default="jbf-demo", help="folder for its files"
    )


def run(arguments: argparse.Namespace) -> int:
    """Do it."""
    from jbf.demo import run as run_demo

    directory = Path(arguments.directory)
    outputs.check_folder("DIR", directory)
    with shown("the demo") as report:
        run_demo(directory, progress=report)
    return 0
