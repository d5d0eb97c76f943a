"""`jbf plan RIG`: design the runs to record."""

from __future__ import annotations

import argparse
from pathlib import Path

from jbf.cli import level, limits, outputs, power
from jbf.cli.arguments import Commands, add_effects_from, add_json, add_law, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.reporting.json import json_text


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "plan", COMMANDS["plan"], run)
    parser.add_argument(
        "rig", metavar="RIG", help="rig file (TOML), or a model of it (jbf fit --out)"
    )
    parser.add_argument(
        "--minutes", metavar="X", type=float, default=10.0, help="all runs together; 10"
    )
    parser.add_argument("--run-s", metavar="X", type=float, default=60.0, help="each run; 60")
    limits.add(
        parser,
        otherwise="one",
        sharpest="that of a sine of the largest speed at 2 rad/s",
        needed=True,
    )
    power.add_noise(parser)
    parser.add_argument(
        "--step-s", metavar="X", type=float, default=0.02, help="from sample to sample; 0.02"
    )
    parser.add_argument("--out", metavar="FOLDER", help="write the motions, to be played")
    level.add(parser)
    add_json(parser)
    add_law(parser)
    parser.set_defaults(law=None)
    add_effects_from(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from jbf.diagnosis.plan import plan

    wanted = {"--json": arguments.json}
    outputs.check(wanted, outputs.read_by(arguments))
    model = power.machine(arguments)
    quantities = model.rig.quantities
    with shown("planning"):
        found = plan(
            model,
            limits=limits.limits(arguments, arguments.run_s, quantities),
            minutes=arguments.minutes,
            noise_rms=power.noise_rms(arguments, model),
            step_s=arguments.step_s,
            policy=level.policy(arguments, quantities),
        )
    texts = {}
    if arguments.out:
        folder = Path(arguments.out)
        outputs.check_folder("--out", folder)
        texts = {str(folder / f"{one.name}.csv"): one.to_csv() for one in found.runs}
    if arguments.json:
        texts[arguments.json] = json_text(found.to_dict())
    outputs.write(texts)
    outputs.say(found.summary(), wanted)
    return 0
