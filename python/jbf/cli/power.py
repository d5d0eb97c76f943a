"""`jbf power RIG RUN...`: power of planned runs, before anything is recorded."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from jbf.cli import inputs, level, outputs
from jbf.cli.arguments import Commands, add_effects_from, add_json, add_law, add_runs, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.errors import InputError
from jbf.models.catalogue import parameters_of
from jbf.models.model import Model
from jbf.records.run_files import read_runs
from jbf.reporting.json import json_text
from jbf.units.quantity import number_in

if TYPE_CHECKING:
    from jbf.cli import Parser


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "power", COMMANDS["power"], run)
    parser.add_argument(
        "rig", metavar="RIG", help="rig file (TOML), or a model of it (jbf fit --out)"
    )
    add_runs(parser)
    add_noise(parser)
    level.add(parser)
    add_json(parser)
    add_law(parser)
    parser.set_defaults(law=None)
    add_effects_from(parser)


def add_noise(parser: Parser) -> None:
    """Add `--noise`."""
    parser.add_argument(
        "--noise",
        metavar="X",
        help="standard deviation of the noise of the friction, in the unit of the rig or as "
        "'0.1 N' (default: the residual of the fitted model)",
    )


def noise_rms(arguments: argparse.Namespace, model: Model) -> float:
    """Return the noise given by `--noise`, or the RMS residual of the fitted model.

    Raises
    ------
    InputError
        Neither is available.
    """
    if arguments.noise is not None:
        return number_in(model.rig.quantities.force, arguments.noise, "--noise")
    left = model.fit.get("rms", model.fit.get("rms_n"))  # files before 0.1.0 have "rms_n"
    if left is None or isinstance(left, str):
        raise InputError(problem="--noise is missing", mend="state the expected noise")
    return float(left)


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    from jbf.diagnosis.planned import planned_power

    wanted = {"--json": arguments.json}
    outputs.check(wanted, outputs.read_by(arguments))
    model = machine(arguments)
    noise = noise_rms(arguments, model)
    runs = read_runs(arguments.runs, model.rig, need_friction=False)
    policy = level.policy(arguments, model.rig.quantities)
    with shown("power"):
        found = planned_power(model, runs, noise_rms=noise, policy=policy)
    if arguments.json:
        outputs.write({arguments.json: json_text(found.to_dict())})
    outputs.say(found.summary(), wanted)
    return 0


def machine(arguments: argparse.Namespace) -> Model:
    """Load a model, or build one from a rig and a law with the catalogue's typical values."""
    if inputs.is_model(arguments.rig):
        if arguments.law is not None:
            raise InputError(
                file="--law",
                problem="goes with a rig, and a model has its law",
                mend="leave it out",
            )
        return inputs.model(arguments.rig)
    law = arguments.law or "journal"
    rig = inputs.rig(arguments.rig, law)
    values = {name: page.starts[0] for name, page in parameters_of(law, ()).items()}
    return Model(rig, law, (), values, arguments.clock)
