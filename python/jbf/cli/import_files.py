"""`jbf import FILE... [--map MAP] [--folder FOLDER]`: import recordings as a campaign."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_earlier_name, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.errors import InputError
from jbf.text_files import read_text, real_path, write_text

if TYPE_CHECKING:
    from jbf.importing.guessed import Guess
    from jbf.importing.result import Import


ALL_JOINTS = "all"
"""Value of `--joint` that selects every joint."""


@dataclass(frozen=True)
class ImportOptions:
    """Arguments of `jbf import`."""

    files: tuple[str, ...]
    map: str | None
    beside: tuple[str, ...] | None
    folder: str | None
    joint: str | None
    cut: str | None
    no_cut: bool
    plot: str | None
    force: bool

    def inputs(self) -> list[Path]:
        """Paths of all files that the command may read."""
        return list(outputs.inputs_in(self.files, self.map, self.beside, self.cut))


def add(commands: Commands) -> None:
    """Add `jbf import` to the parser."""
    parser = command(commands, "import", COMMANDS["import"], ImportOptions, run)
    parser.add_argument(
        "files", metavar="FILE", nargs="+", help="recordings, all read with one map"
    )
    parser.add_argument(
        "--map",
        metavar="MAP",
        help="map of the columns and their units (TOML); without --map and --folder, the file is "
        "inspected and a map.toml to edit is written next to it",
    )
    parser.add_argument(
        "--beside",
        metavar="FILE",
        action="append",
        help="file recorded at the same time by another logger with its own clock; may be "
        "repeated; overrides beside in the [file] table of the map",
    )
    parser.add_argument(
        "--folder", metavar="FOLDER", help="write the runs and rig.toml to this folder"
    )
    add_earlier_name(parser, "--out", "--folder")
    parser.add_argument(
        "--joint",
        metavar="NAME",
        help="joint to import, where the file contains several; all: each joint into a subfolder "
        "of FOLDER",
    )
    parser.add_argument("--cut", metavar="CUT", help="edited cut.toml of an earlier import")
    parser.add_argument(
        "--no-cut",
        action="store_true",
        help="do not divide recordings at rests, unless the map says so",
    )
    parser.add_argument(
        "--plot", metavar="PNG", help="plot how the recordings were divided into runs"
    )
    parser.add_argument(
        "--force", action="store_true", help="replace an earlier import or map.toml"
    )


def run(options: ImportOptions) -> int:
    """Run `jbf import` and return its exit code."""
    outputs.check({"--plot": options.plot}, options.inputs())
    if options.joint is not None and options.map is not None:
        raise InputError(
            file="--joint",
            problem="cannot be combined with --map",
            remedy="the map names the columns of a joint",
        )
    if options.map is None and options.folder is None:
        return _inspect(options)
    if options.joint == ALL_JOINTS:
        return _each_joint(options)
    return _import(options, options.joint, options.folder)


def _each_joint(options: ImportOptions) -> int:
    """Import each joint of a robot log as a campaign, into a folder with the joint's name."""
    from jbf.importing.campaign_folder import check_folder
    from jbf.importing.import_files import look
    from jbf.importing.joints import JointNotChosen

    if options.folder is None or options.plot is not None:
        remedy = "add --folder FOLDER, and leave out --plot"
        raise InputError(
            file="--joint", problem="all writes a folder for each joint", remedy=remedy
        )
    try:
        look(options.files[0], beside=options.beside or ())
    except JointNotChosen as several:
        joints = several.joints
    else:
        remedy = "leave out --joint"
        raise InputError(file=options.files[0], problem="contains a single joint", remedy=remedy)
    out = Path(options.folder)
    check_folder(out, replace=options.force, holding=joints)
    out.mkdir(exist_ok=True)
    for joint in joints:
        check_folder(out / joint, replace=options.force)
    return max(_import(options, joint, str(Path(options.folder) / joint)) for joint in joints)


def _import(options: ImportOptions, joint: str | None, out: str | None) -> int:
    """Import one campaign and return the exit code."""
    from jbf.importing.import_files import import_files
    from jbf.importing.mapping import OpenQuestions

    try:
        with shown("importing") as report:
            campaign = import_files(
                options.files,
                options.map,
                out,
                cut_file=options.cut,
                whole=options.no_cut,
                replace_folder=options.force,
                joint=joint,
                beside=options.beside,
                progress=report,
            )
    except OpenQuestions as questions:
        lines = list(questions.lines)
        if options.map is None:
            others = [f"--beside {name}" for name in options.beside or ()]
            command = " ".join(("jbf import", *options.files, *others))
            lines[-1] += f". To write a map with these questions: {command}"
        for line in lines:
            outputs.complain(line)
        return 2
    if options.plot is not None:
        _draw(campaign, options.plot)
    outputs.say(campaign.summary(), {})
    if out is None:
        outputs.say("\nNothing was written; add --folder FOLDER", {})
    return 0


def _inspect(options: ImportOptions) -> int:
    """Inspect a file, print its proposed map, and write it as a map to edit."""
    from jbf.reporting.import_text import guess_report

    for option, path in (("--cut", options.cut), ("--plot", options.plot)):
        if path is not None:
            raise InputError(
                file=option,
                problem="requires --map or --folder",
                remedy="jbf import FILE alone inspects the file",
            )
    proposal, map_path, kept = _proposed_map(options, options.joint)
    outputs.say(guess_report(proposal, str(map_path), files=options.files, kept=kept), {})
    return 0


def _proposed_map(options: ImportOptions, joint: str | None) -> tuple[Guess, Path, bool]:
    """Propose a map for the first file, and write it unless one exists.

    Returns
    -------
    (Guess, Path, bool)
        The proposal, the path of the map, and whether an existing map was kept.
    """
    from jbf.importing.import_files import look
    from jbf.importing.map_text import map_text

    file = Path(options.files[0])
    if options.beside and len(options.files) > 1:
        remedy = "name one FILE, and the others with --beside"
        raise InputError(file="--beside", problem="requires a single FILE", remedy=remedy)
    target, exists = _map_path(file, joint, replace=options.force)
    shown_path = file.parent / target.name
    if not exists:
        outputs.check({shown_path.name: str(target)}, options.inputs())
    if exists and options.beside:
        problem = f"{shown_path.name} exists and may name other files"
        remedy = f"replace it with --force, or use it with --map {shown_path}"
        raise InputError(file=shown_path, problem=problem, remedy=remedy)
    proposal = look(file, joint, options.beside or ())
    if not exists:
        write_text(target, map_text(proposal, str(shown_path)))
    return proposal, shown_path, exists


def _map_path(file: Path, joint: str | None, *, replace: bool) -> tuple[Path, bool]:
    """Path for the proposed map of a file, and whether an existing map there is kept.

    The name is `map.toml`, or `STEM.map.toml` if `map.toml` is the map of another file. The map of
    a joint is `STEM.JOINT.map.toml`. A number is appended if this name is in use as well.
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


def _draw(campaign: Import, path: str) -> None:
    """Save the figure of an import."""
    from jbf.reporting.cut_plot import save_cut

    save_cut(campaign, path)
