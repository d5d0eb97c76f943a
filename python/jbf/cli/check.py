"""`jbf check MODEL RUN...`: estimate how often the diagnosis of such campaigns is right."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from jbf.cli import inputs, level, outputs
from jbf.cli.arguments import Commands, add_effects_from, add_json, add_runs, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.cores import check_jobs, processes
from jbf.errors import InputError
from jbf.records.run_files import read_runs
from jbf.reporting.json import json_text
from jbf.text_files import read_text, write_text

if TYPE_CHECKING:
    from jbf.diagnosis.check import Answer


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "check", COMMANDS["check"], run)
    parser.add_argument("model", metavar="MODEL", help="model of the runs (jbf diagnose --out)")
    add_runs(parser)
    parser.add_argument(
        "-n",
        "--campaigns",
        metavar="N",
        type=int,
        default=200,
        help="campaigns with the model's effects, and so many without; 200",
    )
    parser.add_argument("--jobs", metavar="N", type=int, help="campaigns at a time; all cores")
    parser.add_argument(
        "--resume",
        metavar="FILE.jsonl",
        help="keep each answer in this file as it comes, and go on from what is there",
    )
    level.add(parser)
    add_json(parser)
    add_effects_from(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from jbf.diagnosis.check import check, identity

    wanted = {"--json": arguments.json, "--resume": arguments.resume}
    outputs.check(wanted, outputs.read_by(arguments))
    check_jobs(arguments.jobs)
    jobs = processes(arguments.jobs, 2 * arguments.campaigns)
    model = inputs.model(arguments.model)
    policy = level.policy(arguments, model.rig.quantities)
    runs = read_runs(arguments.runs, model.rig)
    name = identity(model, runs, policy)
    done = [] if arguments.resume is None else _known(Path(arguments.resume), name)

    def keep(answer: Answer) -> None:
        if arguments.resume is not None:
            with Path(arguments.resume).open("a", encoding="utf-8") as file:
                file.write(json.dumps({"of": name, **answer.to_dict()}) + "\n")

    with shown("diagnosing") as report, ProcessPoolExecutor(jobs) as executor:
        found = check(
            model,
            runs,
            campaigns=arguments.campaigns,
            policy=policy,
            executor=executor,
            progress=report,
            done=done,
            keep=keep,
        )
    if arguments.json:
        outputs.write({arguments.json: json_text(found.to_dict())})
    outputs.say(found.summary(), {"--json": arguments.json})
    return 0


def _known(file: Path, name: str) -> Sequence[Answer]:
    """Read the results that a file already contains.

    Raises
    ------
    InputError
        The results belong to a different model, runs or level, or a line is not a result.
    """
    from jbf.diagnosis.check import answer_of

    if not file.exists():
        return []
    found = []
    text = read_text(file)
    lines = text.splitlines()
    for row, line in enumerate(lines, 1):
        try:
            told = json.loads(line)
            of, answer = told["of"], answer_of(told)
        except (ValueError, KeyError, TypeError, AttributeError):
            # A last line that was cut off while being written is removed; its result is computed
            # again.
            if row == len(lines):
                write_text(file, "".join(f"{kept}\n" for kept in lines[:-1]))
                break
            raise InputError(
                file=file, row=row, problem="is no answer of jbf check", mend="name another file"
            ) from None
        if of != name:
            raise InputError(
                file=file,
                row=row,
                problem="is of another model, other runs or another level",
                mend="name another file, or remove this one",
            )
        found.append(answer)
    if len(found) == len(lines) and lines and not text.endswith("\n"):
        # Only the final newline is missing: append it, so that the next result starts a new line.
        write_text(file, text + "\n")
    return found
