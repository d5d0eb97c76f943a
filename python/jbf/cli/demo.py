"""`jbf demo [DIR]`: complete example on shipped data with a hidden effect."""

from __future__ import annotations

import os
import shlex
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

from jbf.cli import outputs
from jbf.cli.arguments import Commands, Verbosity, add_verbosity, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown


@dataclass(frozen=True)
class DemoOptions:
    """Arguments of `jbf demo`."""

    directory: str
    verbosity: Verbosity


def add(commands: Commands) -> None:
    """Add `jbf demo` to the parser."""
    parser = command(commands, "demo", COMMANDS["demo"], DemoOptions, run)
    parser.add_argument(
        "directory",
        metavar="DIR",
        nargs="?",
        default="jbf-demo",
        help="folder for the data and the results (default: jbf-demo)",
    )
    add_verbosity(parser)


def run(options: DemoOptions) -> int:
    """Run `jbf demo` and return its exit code."""
    from jbf.demo import run as run_demo
    from jbf.reporting.diagnosis_summary import verdict_line

    directory = Path(options.directory)
    outputs.check_folder("DIR", directory)
    with shown("diagnosing the shipped data") as report:
        demo = run_demo(directory, report)
    if options.verbosity.quiet:
        outputs.say(verdict_line(demo.diagnosis), {})
    else:
        text = demo.text(full=options.verbosity.full, command=called(sys.argv[0]))
        outputs.say(text, {})
    return 0


def called(started: str) -> str:
    """Shell command that starts this program: its name if the shell finds it, else its path.

    The command is used in suggestions to the user.

    Parameters
    ----------
    started
        Path of the program as passed to the process.
    """
    path = Path(started)
    if path.name == "__main__.py":
        return f"{_shortest_path(Path(sys.executable))} -m jbf"
    executable = shutil.which(path.name)
    if not path.is_file() or (executable is not None and Path(executable).samefile(path)):
        return "jbf"
    return _shortest_path(path)


def _shortest_path(path: Path) -> str:
    """Shortest form of a path, relative to the working directory where possible."""
    working_folder = Path.cwd()
    absolute = Path(os.path.abspath(path))
    return shlex.quote(
        str(
            absolute.relative_to(working_folder)
            if absolute.is_relative_to(working_folder)
            else absolute
        )
    )
