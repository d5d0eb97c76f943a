"""`jbf predict MODEL RUN --out CSV`: friction predicted by the model for a run's motion."""

from __future__ import annotations

import argparse

from jbf.cli import inputs, outputs
from jbf.cli.arguments import Commands, add_effects_from, command
from jbf.cli.commands import COMMANDS
from jbf.errors import InputError
from jbf.records.checks import POINT


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "predict", COMMANDS["predict"], run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    parser.add_argument("motion", metavar="RUN", help="a CSV file; it need not hold friction_n")
    parser.add_argument("--out", metavar="CSV", required=True, help="file to write; - is stdout")
    add_effects_from(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    wanted = {"--out": arguments.out}
    outputs.check(wanted, outputs.read_by(arguments))
    model = inputs.model(arguments.model)
    motion = inputs.motion(arguments.motion, model.rig)
    try:
        friction = model.predict(motion)
    except InputError as error:
        raise error.within(file=arguments.motion) from None
    instants, clock = (motion.extra[POINT], POINT) if motion.steady else (motion.time_s, "time_s")
    rows = zip(instants.tolist(), friction.tolist(), strict=True)
    # The repr of a float is the shortest text that is read back as the same value.
    column = model.rig.quantities.friction_column
    lines = [f"{clock},{column}", *(f"{t!r},{f!r}" for t, f in rows)]
    outputs.write({arguments.out: "\n".join(lines) + "\n"})
    outputs.say(f"{len(motion)} samples of friction written to {arguments.out}", wanted)
    return 0
