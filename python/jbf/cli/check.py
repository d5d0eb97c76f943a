"""`jbf check MODEL RUN...`: simulated success rates of the diagnosis of such campaigns."""

from __future__ import annotations

import json
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
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


@dataclass(frozen=True)
class CheckOptions:
    """Arguments of `jbf check`."""

    model: str
    runs: tuple[str, ...]
    campaigns: int
    jobs: int | None
    resume: str | None
    level: level.LevelOptions
    json: str | None
    effects_from: tuple[str, ...]


def add(commands: Commands) -> None:
    """Add `jbf check` to the parser."""
    parser = command(commands, "check", COMMANDS["check"], CheckOptions, run)
    parser.add_argument(
        "model", metavar="MODEL", help="model of the runs, written by jbf diagnose --out"
    )
    add_runs(parser)
    parser.add_argument(
        "-n",
        "--campaigns",
        metavar="N",
        type=int,
        default=200,
        help="number of simulated campaigns with the effects of the model, and of campaigns "
        "without (default 200)",
    )
    parser.add_argument(
        "--jobs", metavar="N", type=int, help="number of parallel processes (default: all cores)"
    )
    parser.add_argument(
        "--resume",
        metavar="FILE.jsonl",
        help="append each result to this file, and continue from the results that it contains",
    )
    level.add(parser)
    add_json(parser)
    add_effects_from(parser)


def run(options: CheckOptions) -> int:
    """Run `jbf check` and return its exit code."""
    from jbf.diagnosis.check import check, identity

    targets = {"--json": options.json, "--resume": options.resume}
    outputs.check(targets, outputs.inputs_in(options.model, options.runs, options.effects_from))
    check_jobs(options.jobs)
    jobs = processes(options.jobs, 2 * options.campaigns)
    model = inputs.model(options.model)
    policy = options.level.policy(model.rig.quantities)
    runs = read_runs(options.runs, model.rig)
    name = identity(model, runs, policy)
    done = [] if options.resume is None else _stored_answers(Path(options.resume), name)

    def keep(answer: Answer) -> None:
        """Append a result to the file of `--resume`."""
        if options.resume is not None:
            with Path(options.resume).open("a", encoding="utf-8") as file:
                file.write(json.dumps({"of": name, **answer.to_dict()}) + "\n")

    with shown("diagnosing") as report, ProcessPoolExecutor(jobs) as executor:
        result = check(
            model,
            runs,
            campaigns=options.campaigns,
            policy=policy,
            executor=executor,
            progress=report,
            done=done,
            keep=keep,
        )
    if options.json:
        outputs.write({options.json: json_text(result.to_dict())})
    outputs.say(result.summary(), {"--json": options.json})
    return 0


def _stored_answers(file: Path, name: str) -> Sequence[Answer]:
    """Read the simulation results that the file of `--resume` already contains.

    Raises
    ------
    InputError
        The results belong to a different model, runs or level, or a line is not a result.
    """
    from jbf.diagnosis.check import answer_of

    if not file.exists():
        return []
    answers = []
    text = read_text(file)
    lines = text.splitlines()
    for row, line in enumerate(lines, 1):
        try:
            content = json.loads(line)
            campaign, answer = content["of"], answer_of(content)
        except (ValueError, KeyError, TypeError, AttributeError):
            # A last line that was cut off while being written is removed; its result is computed
            # again.
            if row == len(lines):
                write_text(file, "".join(f"{complete}\n" for complete in lines[:-1]))
                break
            raise InputError(
                file=file,
                row=row,
                problem="is not a result of jbf check",
                remedy="name another file",
            ) from None
        if campaign != name:
            raise InputError(
                file=file,
                row=row,
                problem="belongs to another model, other runs or another level",
                remedy="name another file, or remove this one",
            )
        answers.append(answer)
    if len(answers) == len(lines) and lines and not text.endswith("\n"):
        # Only the final newline is missing: append it, so that the next result starts a new line.
        write_text(file, text + "\n")
    return answers
