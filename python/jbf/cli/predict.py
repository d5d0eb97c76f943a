"""`jbf predict MODEL RUN [--out CSV]`: force predicted by a model for a run's motion."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.cli import inputs, outputs
from jbf.cli.arguments import Commands, add_effects_from, command
from jbf.cli.commands import COMMANDS
from jbf.errors import InputError
from jbf.records.checks import POINT


@dataclass(frozen=True)
class PredictOptions:
    """Arguments of `jbf predict`."""

    model: str
    motion: str
    out: str
    effects_from: tuple[str, ...]


def add(commands: Commands) -> None:
    """Add `jbf predict` to the parser."""
    parser = command(commands, "predict", COMMANDS["predict"], PredictOptions, run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    parser.add_argument("motion", metavar="RUN", help="CSV file of a run, with or without friction")
    parser.add_argument(
        "--out",
        metavar="CSV",
        default=outputs.STDOUT,
        help="write the predicted force to this file: friction, and the inertia, weight and offset "
        "of the model (default: standard output)",
    )
    add_effects_from(parser)


def run(options: PredictOptions) -> int:
    """Run `jbf predict` and return its exit code."""
    targets = {"--out": options.out}
    read = outputs.inputs_in(options.model, options.motion, options.effects_from)
    outputs.check(targets, read)
    model = inputs.model(options.model)
    motion = inputs.motion(options.motion, model.rig)
    try:
        force = model.predict(motion)
    except InputError as error:
        raise error.within(file=options.motion) from None
    instants, clock = (motion.extra[POINT], POINT) if motion.steady else (motion.time_s, "time_s")
    rows = zip(instants.tolist(), force.tolist(), strict=True)
    # The repr of a float is the shortest text that is read back as the same value.
    column = model.rig.quantities.friction_column
    lines = [f"{clock},{column}", *(f"{t!r},{f!r}" for t, f in rows)]
    outputs.write({options.out: "\n".join(lines) + "\n"})
    outputs.say(f"{len(motion)} samples of predicted force written to {options.out}", targets)
    return 0
