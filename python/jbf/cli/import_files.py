"""`jbf import FILE... [--map MAP] [--out FOLDER]`: convert recordings to a campaign."""

from __future__ import annotations

import argparse
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.errors import InputError
from jbf.text_files import read_text, real_path, write_text

if TYPE_CHECKING:
    from jbf.importing.result import Import


EVERY = "all"
"""Value of `--joint` that selects every joint."""


def add(commands: Commands) -> None:
    """Add the command to the parser."""
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
    parser.add_argument(
        "--beside",
        metavar="FILE",
        action="append",
        help="a file that was recorded at the same time with a clock of its own; may be repeated; "
        "replaces [file] beside of the map",
    )
    parser.add_argument("--out", metavar="FOLDER", help="write the runs and rig.toml there")
    parser.add_argument(
        "--joint",
        metavar="NAME",
        help="one of the joints in the file; all: import each joint into a subfolder of FOLDER",
    )
    parser.add_argument("--cut", metavar="CUT", help="cut.toml of an earlier import, edited")
    parser.add_argument(
        "--no-cut",
        action="store_true",
        help="do not cut at rests where the map says nothing of cutting",
    )
    parser.add_argument("--plot", metavar="PNG", help="draw how the recordings were cut")
    parser.add_argument(
        "--force", action="store_true", help="replace an earlier import, an earlier map.toml"
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    outputs.check({"--plot": arguments.plot}, outputs.read_by(arguments))
    if arguments.joint is not None and arguments.map is not None:
        raise InputError(file="--joint", problem="goes without --map", mend="the map names columns")
    if arguments.map is None and arguments.out is None:
        return _look(arguments)
    if arguments.joint == EVERY:
        return _each_joint(arguments)
    return _import(arguments, arguments.joint, arguments.out)


def _each_joint(arguments: argparse.Namespace) -> int:
    """Import each joint as a campaign into a folder with the joint's name."""
    from jbf.importing.campaign_folder import check_folder
    from jbf.importing.import_files import look
    from jbf.importing.joints import JointNotChosen

    if arguments.out is None or arguments.plot is not None:
        mend = "name --out FOLDER, and no --plot"
        raise InputError(file="--joint", problem="all makes a folder of each joint", mend=mend)
    try:
        look(arguments.files[0], beside=arguments.beside or ())
    except JointNotChosen as several:
        joints = several.joints
    else:
        mend = "leave --joint out"
        raise InputError(file=arguments.files[0], problem="holds one joint", mend=mend)
    out = Path(arguments.out)
    check_folder(out, replace=arguments.force, holding=joints)
    out.mkdir(exist_ok=True)
    for joint in joints:
        check_folder(out / joint, replace=arguments.force)
    return max(_import(arguments, joint, str(Path(arguments.out) / joint)) for joint in joints)


def _import(arguments: argparse.Namespace, joint: str | None, out: str | None) -> int:
    """Import one campaign."""
    from jbf.importing.import_files import OpenQuestions, import_files

    try:
        with shown("importing") as report:
            found = import_files(
                arguments.files,
                arguments.map,
                out,
                cut_file=arguments.cut,
                whole=arguments.no_cut,
                replace_folder=arguments.force,
                joint=joint,
                beside=arguments.beside,
                progress=report,
            )
    except OpenQuestions as questions:
        for line in questions.lines:
            outputs.complain(line)
        return 2
    if arguments.plot is not None:
        _draw(found, arguments.plot)
    outputs.say(found.summary(), {})
    if out is None:
        outputs.say("\nNothing was written: name --out FOLDER", {})
    return 0


def _look(arguments: argparse.Namespace) -> int:
    """Inspect a file, print the guess, and write a map to edit."""
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
    file = Path(arguments.files[0])
    if arguments.beside and len(arguments.files) > 1:
        mend = "name one FILE, and the others with --beside"
        raise InputError(file="--beside", problem="goes with one main file", mend=mend)
    target, kept = _map_path(file, arguments.joint, replace=arguments.force)
    shown_path = file.parent / target.name
    if not kept:
        outputs.check({shown_path.name: str(target)}, outputs.read_by(arguments))
    if kept and arguments.beside:
        problem = f"{shown_path.name} is there and may name other files"
        mend = f"--force replaces it; or go on with --map {shown_path}"
        raise InputError(file=shown_path, problem=problem, mend=mend)
    found = look(file, arguments.joint, arguments.beside or ())
    if not kept:
        write_text(target, map_text(found, str(shown_path)))
    outputs.say(guess_report(found, str(shown_path), kept=kept), {})
    return 0


def _map_path(file: Path, joint: str | None, *, replace: bool) -> tuple[Path, bool]:
    """Return the path of a file's map, and whether an existing map there is kept.

    The name is `map.toml`. A joint has a name of its own, and so has a file if `map.toml` is the
    map of another file.
    """
    from jbf.importing.map_text import map_was_written_for

    folder = real_path(file).parent
    stem = file.stem if joint is None else f"{file.stem}.{joint}"
    names = chain(
        ["map.toml"] if joint is None else [],
        [f"{stem}.map.toml"],
        (f"{stem}_{k}.map.toml" for k in count(2)),
    )
    path = next(
        path
        for path in (folder / name for name in names)
        if not path.exists() or map_was_written_for(read_text(path), file.name)
    )
    return path, path.exists() and not replace


def _draw(found: Import, path: str) -> None:
    from jbf.reporting.cut_plot import save_cut

    save_cut(found, path)
