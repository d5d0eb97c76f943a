"""`jbf diagnose RIG RUN...`: which effect is missing, and the error falling as it is added."""

from __future__ import annotations

import argparse

from jbf.catalogue import find_law
from jbf.cli import inputs, outputs
from jbf.cli.arguments import Commands, add_json, add_law, add_own, add_report, add_runs, command
from jbf.cli.progress import shown


def add(commands: Commands) -> None:
    """Put the command on the command line."""
    does = "which effect is missing: adds it and shows the error fall, until nothing is missing"
    parser = command(commands, "diagnose", does, run)
    parser.add_argument("rig", metavar="RIG", help="rig file (TOML)")
    add_runs(parser)
    parser.add_argument("--out", metavar="MODEL", help="write the completed model")
    add_json(parser)
    add_report(parser)
    add_law(parser)
    add_own(parser)


def run(arguments: argparse.Namespace) -> int:
    """Do it."""
    wanted = {"--out": arguments.out, "--json": arguments.json, "--report": arguments.report}
    outputs.check(wanted, [arguments.rig, *arguments.runs])
    find_law(arguments.law)
    rig = inputs.rig(arguments.rig, arguments.law)
    runs = inputs.runs(arguments.runs, first="RIG")
    outputs.check(wanted, [run.path for run in runs if run.path])

    from jbf.diagnosis import diagnose

    texts = {}
    with shown("diagnosing") as report:
        diagnosis = diagnose(rig, runs, law=arguments.law, clock=arguments.clock, progress=report)
        if arguments.report:
            from jbf.report import diagnosis_page

            texts[arguments.report] = diagnosis_page(diagnosis)
    if arguments.json:
        texts[arguments.json] = outputs.json_text(diagnosis.to_dict())
    if arguments.out:
        texts[arguments.out] = diagnosis.model.to_toml()
    summary = diagnosis.summary()
    outputs.write(texts)
    outputs.say(summary, wanted)
    return 0
