"""`jbf control tune MODEL`: settings of the compensator from a fitted model."""

from __future__ import annotations

import argparse

from jbf.cli import outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.control.options import add_bench, bench_of, model_of
from jbf.cli.progress import shown


def add(actions: Commands) -> None:
    """Add the action to the parser."""
    parser = command(actions, "tune", "settings of the compensator from a fitted model", run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    parser.add_argument("--out", metavar="TOML", help="write them to a file")
    add_bench(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the action."""
    from jbf.control import tune

    wanted = {"--out": arguments.out}
    outputs.check(wanted, outputs.read_by(arguments))
    with shown("tuning"):
        text = tune(model_of(arguments.model), bench_of(arguments)).to_toml()
    if arguments.out:
        outputs.write({arguments.out: text})
        outputs.say(f"settings written to {arguments.out}", wanted)
    else:
        outputs.say(text.rstrip(), wanted)
    return 0
