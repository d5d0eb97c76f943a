"""`jbf control tune MODEL`: settings of the observed compensator from a fitted model."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_earlier_name, command
from jbf.cli.control.options import BenchOptions, add_bench, model_of
from jbf.cli.progress import shown


@dataclass(frozen=True)
class TuneOptions:
    """Arguments of `jbf control tune`."""

    model: str
    toml: str | None
    bench: BenchOptions


def add(actions: Commands) -> None:
    """Add `jbf control tune` to the parser."""
    description = "compute the settings of the compensator from a fitted model"
    parser = command(actions, "tune", description, TuneOptions, run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    parser.add_argument("--toml", metavar="FILE", help="write the settings to this file")
    add_earlier_name(parser, "--out", "--toml")
    add_bench(parser)


def run(options: TuneOptions) -> int:
    """Run `jbf control tune` and return its exit code."""
    from jbf.control import tune

    targets = {"--toml": options.toml}
    outputs.check(targets, outputs.inputs_in(options.model))
    with shown("tuning"):
        text = tune(model_of(options.model), options.bench.bench()).to_toml()
    if options.toml:
        outputs.write({options.toml: text})
        outputs.say(f"settings written to {options.toml}", targets)
    else:
        outputs.say(text.rstrip(), targets)
    return 0
