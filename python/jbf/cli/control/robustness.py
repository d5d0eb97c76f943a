"""`jbf control robustness [MODEL]`: effect of compensation when its model is wrong."""

from __future__ import annotations

import argparse

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_json, command
from jbf.cli.control.options import add_bench, bench_of, model_of
from jbf.cli.control.pictures import add_plot, check_picture, save_picture
from jbf.cli.progress import shown
from jbf.reporting.json import json_text


def add(actions: Commands) -> None:
    """Add the action to the parser."""
    does = "does it still help when its model is wrong: every effect hidden, wrong load, more noise"
    parser = command(actions, "robustness", does, run)
    parser.add_argument("model", metavar="MODEL", nargs="?", help="model file; the thesis's")
    add_bench(parser)
    add_json(parser)
    add_plot(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the action."""
    from jbf.control.bench import thesis_model
    from jbf.control.robustness import robustness
    from jbf.reporting.control_json import robustness_dict
    from jbf.reporting.control_run_text import robustness_text

    wanted = {"--json": arguments.json, "--plot": arguments.plot}
    outputs.check(wanted, outputs.read_by(arguments))
    check_picture(arguments.plot)
    base = thesis_model(elastic="nothing") if arguments.model is None else model_of(arguments.model)
    with shown("robustness") as report:
        found = robustness(base, bench_of(arguments), report=report)
    if arguments.json:
        outputs.write({arguments.json: json_text(robustness_dict(found))})
    if arguments.plot:
        from jbf.reporting.control_plots import plot_robustness

        save_picture(plot_robustness(found), arguments.plot)
    outputs.say(robustness_text(found), wanted)
    return 0
