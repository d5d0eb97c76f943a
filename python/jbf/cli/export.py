"""`jbf export MODEL`: source code of a model for firmware, or a model in the form of a target."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from jbf.cli import inputs, outputs
from jbf.cli.arguments import Commands, add_effects_from, add_json, command
from jbf.cli.commands import COMMANDS
from jbf.errors import InputError
from jbf.export import TARGETS, Compensator, Settings, c, rust, to
from jbf.export.registry import check_settings


@dataclass(frozen=True)
class ExportOptions:
    """Arguments of `jbf export`."""

    model: str
    runs: tuple[str, ...]
    rust: str | None
    c: str | None
    to: str | None
    out: str | None
    json: str | None
    max_loss: float | None
    effects_from: tuple[str, ...]
    compensator_file: str | None
    settings: Settings


def add(commands: Commands) -> None:
    """Add `jbf export` to the parser."""
    parser = command(commands, "export", COMMANDS["export"], ExportOptions, run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    parser.add_argument(
        "runs",
        metavar="RUN",
        nargs="*",
        help="required with --to: CSV file of a run along which the loss is computed, folder of "
        "such files, or pattern; usually the runs that the model was fitted to",
    )
    parser.add_argument(
        "--rust", metavar="FILE.rs", help="write a Rust module for jbf-core (- for standard output)"
    )
    parser.add_argument(
        "--c", metavar="FILE.h", help="write a C header for jbf-c (- for standard output)"
    )
    parser.add_argument(
        "--to",
        metavar="TARGET",
        choices=tuple(TARGETS),
        help="convert to a target and print its losses: "
        + "; ".join(f"{target.name} ({target.summary})" for target in TARGETS.values()),
    )
    parser.add_argument(
        "--out",
        metavar="FILE",
        help="with --to: write the main file of the target here and further files next to it (- "
        "for the main file on standard output); without it only the losses are printed",
    )
    parser.add_argument(
        "--max-loss",
        metavar="SHARE",
        type=float,
        help="with --to: refuse an export whose loss (RMS error relative to the model) exceeds "
        "this share of the RMS friction, such as 0.05",
    )
    add_json(parser)
    add_effects_from(parser)
    default = Settings()
    parser.add_argument(
        "--points",
        metavar="N",
        type=int,
        default=default.points,
        help=f"table: largest number of points, both directions together; default {default.points}",
    )
    parser.add_argument(
        "--joint",
        metavar="NAME",
        default=default.joint,
        help="c, st, FMU, modelica, simulators: name of the joint, and prefix of the names in "
        f"code; default {default.joint}",
    )
    parser.add_argument(
        "--precision",
        choices=("double", "float"),
        default=default.precision,
        help=f"c, FMU: floating-point type of the code; default {default.precision}",
    )
    parser.set_defaults(compensator=None)
    parser.add_argument(
        "--compensator",
        dest="compensator_file",
        metavar="FILE.toml",
        help="c: add the friction compensator in which an observer corrects the model, with the "
        "settings in this file",
    )
    parser.add_argument(
        "--mujoco",
        metavar="VERSION",
        default=default.mujoco,
        help="mjcf: use only elements that this version of MuJoCo has, such as 3.3; "
        f"default {default.mujoco}",
    )


def run(options: ExportOptions) -> int:
    """Run `jbf export` and return its exit code."""
    if options.to is not None:
        return _to_target(options, options.to)
    for name in ("runs", "out", "json", "max_loss", "compensator_file"):
        if getattr(options, name) not in (None, ()):
            argument = "--" + name.removesuffix("_file").replace("_", "-")
            argument = "RUN" if name == "runs" else argument
            raise InputError(problem=f"{argument} is used with --to only", remedy="add --to TARGET")
    check_settings(None, options.settings)
    targets = {"--rust": options.rust, "--c": options.c}
    if not any(targets.values()):
        raise InputError(
            problem="no output is given",
            remedy="add --rust FILE.rs or --c FILE.h, or RUN... and --to TARGET",
        )
    outputs.check(targets, [options.model])
    model = inputs.model(options.model)
    name = Path(options.model).name
    texts = {}
    try:
        for path, write in ((options.rust, rust), (options.c, c)):
            if path is not None:
                texts[path] = write(model, name)
    except InputError as error:
        raise error.within(file=options.model) from None
    outputs.write(texts)
    outputs.say(f"model written to {', '.join(texts)}", targets)
    return 0


def _to_target(options: ExportOptions, target: str) -> int:
    """Convert the model to a target and print the ledger."""
    if options.rust is not None or options.c is not None:
        raise InputError(
            problem="--rust and --c are not used with --to", remedy="run jbf export twice"
        )
    if not options.runs:
        raise InputError(
            problem="no run is given, and the loss of an export is computed along runs",
            remedy=f"name the runs of the model: jbf export {options.model} RUN... --to {target}",
        )
    check_settings(target, options.settings)
    settings = options.settings
    if options.compensator_file is not None:
        settings = replace(settings, compensator=Compensator.load(options.compensator_file))
    targets = {"--out": options.out, "--json": options.json}
    outputs.check(targets, outputs.inputs_in(options.model, options.runs, options.effects_from))
    model = inputs.model(options.model)
    runs = inputs.runs(options.runs, model.rig, first="MODEL")
    exported = to(
        model,
        target,
        runs,
        settings=settings,
        max_loss=options.max_loss,
    )
    texts: dict[str, str | bytes] = {}
    if options.out == outputs.STDOUT:
        texts[outputs.STDOUT] = exported.text
    elif options.out is not None:
        texts |= exported.texts(options.out)
    written = [path for path in texts if path != outputs.STDOUT]
    if options.json is not None:
        from jbf.reporting.json import json_text

        texts[options.json] = json_text(exported.to_dict())
    outputs.write(texts)
    outputs.say(exported.summary(), targets)
    if written:
        outputs.say(f"written to {', '.join(written)}", targets)
    return 0
