"""`jbf power RIG RUN...`: detection limits of effects in planned runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jbf.cli import inputs, level, outputs
from jbf.cli.arguments import (
    Commands,
    LawOptions,
    add_effects_from,
    add_json,
    add_law,
    add_runs,
    command,
)
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


@dataclass(frozen=True)
class PowerOptions:
    """Arguments of `jbf power`."""

    rig: str
    runs: tuple[str, ...]
    law: LawOptions
    noise: str | None
    level: level.LevelOptions
    json: str | None
    effects_from: tuple[str, ...]


def add(commands: Commands) -> None:
    """Add `jbf power` to the parser."""
    parser = command(commands, "power", COMMANDS["power"], PowerOptions, run)
    add_rig_or_model(parser)
    add_runs(parser)
    add_noise(parser)
    level.add(parser)
    add_json(parser)
    add_law(parser, also="; default: journal for a bearing, otherwise coulomb")
    add_effects_from(parser)


def add_rig_or_model(parser: Parser) -> None:
    """Add the positional argument `RIG`, which may also be a model file."""
    parser.add_argument(
        "rig", metavar="RIG", help="rig file (TOML), or a model written by jbf fit or diagnose"
    )


def add_noise(parser: Parser) -> None:
    """Add the option `--noise`."""
    parser.add_argument(
        "--noise",
        metavar="X",
        help="standard deviation of the noise of the friction, in the unit of the rig or as "
        "'0.1 N' (default: the RMS residual of the fitted model)",
    )


def noise_of(option: str | None, model: Model) -> float:
    """Noise on the force: the value of `--noise`, otherwise the RMS residual of a fitted model.

    Raises
    ------
    InputError
        Neither is available.
    """
    if option is not None:
        return number_in(model.rig.quantities.force, option, "--noise")
    residual = model.fit.get("rms", model.fit.get("rms_n"))  # "rms_n" before version 0.1.0
    if residual is None or isinstance(residual, str):
        raise InputError(problem="--noise is missing", remedy="give the expected noise")
    return float(residual)


def run(options: PowerOptions) -> int:
    """Run `jbf power` and return its exit code."""
    from jbf.diagnosis.power.planned_runs import planned_power

    targets = {"--json": options.json}
    outputs.check(targets, outputs.inputs_in(options.rig, options.runs, options.effects_from))
    model = model_of(options.rig, options.law)
    noise = noise_of(options.noise, model)
    runs = read_runs(options.runs, model.rig, need_friction=False)
    policy = options.level.policy(model.rig.quantities)
    with shown("computing the power"):
        result = planned_power(model, runs, noise_rms=noise, policy=policy)
    if options.json:
        outputs.write({options.json: json_text(result.to_dict())})
    outputs.say(result.summary(), targets)
    return 0


def model_of(path: str, law_options: LawOptions) -> Model:
    """Load a model, or build one from a rig and a law with the catalogue's starting values."""
    if inputs.is_model(path):
        if law_options.law is not None:
            raise InputError(
                file="--law",
                problem="applies to a rig, and a model has its own law",
                remedy="leave it out",
            )
        return inputs.model(path)
    rig = inputs.rig(path, law_options.law)
    law = inputs.law_of_fit(rig, law_options.law)
    values = {name: page.starts[0] for name, page in parameters_of(law, ()).items()}
    return Model(rig, law, (), values, law_options.clock)
