"""`jbf compare MODEL RUN...`: error of a model against measurement, and where it fails."""

from __future__ import annotations

import argparse

from jbf.cli import inputs, outputs
from jbf.cli.arguments import Commands, add_effects_from, add_json, add_report, add_runs, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.reporting.json import json_text


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "compare", COMMANDS["compare"], run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    add_runs(parser)
    parser.add_argument(
        "--map", metavar="MAP", help="the runs are recordings, read through this map (jbf import)"
    )
    add_json(parser)
    add_report(parser)
    add_effects_from(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    wanted = {"--json": arguments.json, "--report": arguments.report}
    outputs.check(wanted, outputs.read_by(arguments))
    model = inputs.model(arguments.model)
    if arguments.map is None:
        runs = inputs.runs(arguments.runs, model.rig, first="MODEL")
    else:
        _, runs = inputs.recordings(arguments.map, arguments.runs)
    outputs.check(wanted, [run.path for run in runs if run.path])

    from jbf.comparison.compare import compare

    texts = {}
    with shown("comparing"):
        comparison = compare(model, runs)
        if arguments.report:
            from jbf.reporting.comparison_page import comparison_page

            texts[arguments.report] = comparison_page(comparison, arguments.typed)
    if arguments.json:
        texts[arguments.json] = json_text(comparison.to_dict())
    summary = comparison.summary()
    outputs.write(texts)
    outputs.say(summary, wanted)
    return 0
