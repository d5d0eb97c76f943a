"""`jbf demo [DIR]`: complete example on shipped data with a hidden effect."""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
import sys
from pathlib import Path

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "demo", COMMANDS["demo"], run)
    parser.add_argument(
        "directory", metavar="DIR", nargs="?", default="jbf-demo", help="folder for its files"
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from jbf.demo import run as run_demo

    directory = Path(arguments.directory)
    outputs.check_folder("DIR", directory)
    with shown("the demo") as report:
        run_demo(directory, progress=report, jbf=called(sys.argv[0]))
    return 0


def called(started: str) -> str:
    """Return the shell command that starts this program.

    It is the name if the shell finds it, otherwise the path.

    Parameters
    ----------
    started
        Path of the program as passed to the process.
    """
    path = Path(started)
    if path.name == "__main__.py":
        return f"{_from_here(Path(sys.executable))} -m jbf"
    found = shutil.which(path.name)
    if not path.is_file() or (found is not None and Path(found).samefile(path)):
        return "jbf"
    return _from_here(path)


def _from_here(path: Path) -> str:
    """Return the shortest form of a path, relative to the working directory where possible."""
    here = Path.cwd()
    whole = Path(os.path.abspath(path))
    return shlex.quote(str(whole.relative_to(here) if whole.is_relative_to(here) else whole))
