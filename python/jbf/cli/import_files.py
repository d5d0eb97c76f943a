"""`jbf import FILE... [--map MAP] [--out FOLDER]`: from recordings to a campaign."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.errors import InputError
from jbf.text_files import real_path, write_text

if TYPE_CHECKING:
    from jbf.importing.result import Import


def add(commands: Commands) -> None:
    """Put the command on the command line."""
    parser = command(commands, "import", COMMANDS["import"], run)
    parser.add_argument(
        "files", metavar="FILE", nargs="+", help="recordings; one map fits all of them"
    )
    parser.add_argument(
        "--map",
        metavar="MAP",
        help="which columns make which, in which units (TOML); without it and --out the file is "
        "looked at and map.toml is written beside it",
    )
    parser.add_argument("--out", metavar="FOLDER", help="write the runs and rig.toml there")
    parser.add_argument("--cut", metavar="CUT", help="cut.toml of an earlier import, edited")
    parser.add_argument("--plot", metavar="PNG", help="draw how the recordings were cut")
    parser.add_argument(
        "--force", action="store_true", help="replace an earlier import, an earlier map.toml"
    )


def run(arguments: argparse.Namespace) -> int:
    """Do it."""
    outputs.check({"--plot": arguments.plot}, outputs.read_by(arguments))
    if arguments.map is None and arguments.out is None:
        return _look(arguments)
    from jbf.importing.import_files import OpenQuestions, import_files

    try:
        with shown("importing") as report:
            found = import_files(
                arguments.files,
                arguments.map,
                arguments.out,
                cut_file=arguments.cut,
                replace_folder=arguments.force,
                progress=report,
            )
    except OpenQuestions as questions:
        for line in questions.lines:
            outputs.complain(line)
        return 2
    if arguments.plot is not None:
        _draw(found, arguments.plot)
    outputs.say(found.summary(), {})
    if arguments.out is None:
        outputs.say("\nNothing was written: name --out FOLDER", {})
    return 0


def _look(arguments: argparse.Namespace) -> int:
    """The guess, and the map to edit."""
    from jbf.importing.import_files import look
    from jbf.importing.map_text import map_text
    from jbf.reporting.import_text import guess_report

    for option in ("cut", "plot"):
        if getattr(arguments, option) is not None:
            raise InputError(
                file=f"--{option}",
                problem="goes with --map or --out",
                mend="jbf import FILE alone looks at the file",
            )
    target = real_path(arguments.files[0]).parent / "map.toml"
    shown_path = Path(arguments.files[0]).parent / "map.toml"
    if target.exists() and not arguments.force:
        raise InputError(
            file=shown_path,
            problem="is there already, and would be written anew",
            mend=f"go on with it: jbf import {arguments.files[0]} --map {shown_path} --out "
            "FOLDER; or say --force",
        )
    outputs.check({"map.toml": str(target)}, arguments.files)
    found = look(arguments.files[0])
    write_text(target, map_text(found, str(shown_path)))
    outputs.say(guess_report(found, str(shown_path)), {})
    return 0


def _draw(found: Import, path: str) -> None:
    from jbf.reporting.cut_plot import save_cut

    save_cut(found, path)
