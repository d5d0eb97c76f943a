"""`jbf diagnose RIG RUN...`: find the missing effect, and report the error as effects are added."""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING

from jbf.cli import diagnose_many, hold_out, inputs, level, limits, outputs
from jbf.cli.arguments import (
    Commands,
    add_effects_from,
    add_json,
    add_law,
    add_report,
    add_runs,
    command,
)
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.errors import InputError, Stopped, Unfinished
from jbf.models.catalogue import find_law
from jbf.models.vocabulary import AUTO
from jbf.reporting.json import json_text

if TYPE_CHECKING:
    from jbf.cli import Parser


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "diagnose", COMMANDS["diagnose"], run)
    parser.add_argument(
        "rig", metavar="RIG", nargs="?", help="rig file (TOML), a folder of jbf import, or its map"
    )
    add_runs(parser, needed=False)
    parser.add_argument("--out", metavar="MODEL", help="write the completed model")
    add_json(parser)
    add_report(parser)
    add_law(parser, also=f"; {AUTO}, which a drive takes: the one that alone predicts best")
    parser.set_defaults(law=None)
    add_effects_from(parser)
    hold_out.add(parser)
    level.add(parser)
    _add_next_run(parser)
    diagnose_many.add(parser)


def _add_next_run(parser: Parser) -> None:
    group = parser.add_argument_group(
        "next experiment", "the run that would part effects that fit equally well"
    )
    group.add_argument(
        "--next-run", metavar="CSV", help="write its motion, to be played; needs a tie"
    )
    group.add_argument("--next-duration-s", metavar="X", type=float, default=60.0, help="60")
    limits.add(group, otherwise="as recorded", sharpest="as recorded")


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    if arguments.many is not None:
        if arguments.hold_out:
            raise InputError(
                file=hold_out.OPTION, problem="goes with one rig", mend="leave out --many"
            )
        return diagnose_many.run(arguments, limits.limits(arguments, arguments.next_duration_s))
    alone = arguments.rig is not None and os.path.isdir(arguments.rig)
    if arguments.rig is None or not (arguments.runs or alone):
        raise InputError(
            file="jbf diagnose",
            problem="RIG and RUN are missing",
            mend="name the rig's TOML and its runs, or --many FOLDER",
        )
    wanted = {"--out": arguments.out, "--json": arguments.json, "--report": arguments.report}
    wanted["--next-run"] = arguments.next_run
    outputs.check(wanted, outputs.read_by(arguments))
    if arguments.law not in (None, AUTO):
        find_law(arguments.law)
    rig, runs = inputs.campaign(arguments.rig, arguments.runs, arguments.law)
    policy = level.policy(arguments, rig.quantities)
    asked = limits.limits(arguments, arguments.next_duration_s, rig.quantities)
    outputs.check(wanted, [run.path for run in runs if run.path])
    runs, held = hold_out.split(runs, arguments)

    from jbf.diagnosis import diagnose

    texts = {}
    try:
        with shown("diagnosing") as report:
            diagnosis = diagnose(
                rig,
                runs,
                law=inputs.law_for(rig, arguments.law),
                clock=arguments.clock,
                limits=asked,
                policy=policy,
                progress=report,
            )
            if arguments.report:
                from jbf.reporting.diagnosis_page import diagnosis_page

                texts[arguments.report] = diagnosis_page(diagnosis, arguments.typed)
    except Stopped as stop:
        raise outputs.keep(stop, arguments.out) from None
    except Unfinished as end:
        kept = outputs.keep_unfinished(end, arguments.out, arguments.json, arguments.report)
        raise kept from None
    told = hold_out.error_for_json(diagnosis.model, held)
    if arguments.json:
        texts[arguments.json] = json_text(diagnosis.to_dict() | told)
    if arguments.out:
        texts[arguments.out] = diagnosis.model.to_toml()
    summary = diagnosis.summary() + hold_out.words(diagnosis.model, told)
    if arguments.next_run and diagnosis.experiment:
        texts[arguments.next_run] = diagnosis.experiment.run.to_csv()
    elif arguments.next_run:
        summary += f"\n\nNo next run to play: {arguments.next_run} was not written"
    outputs.write(texts)
    outputs.say(summary, wanted)
    return 0
