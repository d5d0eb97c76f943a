"""`jbf plan RIG`: design of the runs to record on a rig."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from jbf.cli import level, limits, outputs, power
from jbf.cli.arguments import (
    Commands,
    LawOptions,
    add_earlier_name,
    add_effects_from,
    add_json,
    add_law,
    command,
)
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.reporting.json import json_text


@dataclass(frozen=True)
class PlanOptions:
    """Arguments of `jbf plan`."""

    rig: str
    minutes: float
    run_s: float
    step_s: float
    limits: limits.LimitOptions
    noise: str | None
    law: LawOptions
    level: level.LevelOptions
    folder: str | None
    json: str | None
    effects_from: tuple[str, ...]


def add(commands: Commands) -> None:
    """Add `jbf plan` to the parser."""
    parser = command(commands, "plan", COMMANDS["plan"], PlanOptions, run)
    power.add_rig_or_model(parser)
    parser.add_argument(
        "--minutes",
        metavar="X",
        type=float,
        default=10.0,
        help="total duration of the runs, min (default 10)",
    )
    parser.add_argument(
        "--run-s", metavar="X", type=float, default=60.0, help="duration of a run, s (default 60)"
    )
    limits.add(
        parser,
        otherwise="a single value",
        sharpest="that of a sine of the largest speed at 2 rad/s",
        longest="that of the runs of the model; not limited for a rig",
        needed=True,
    )
    power.add_noise(parser)
    parser.add_argument(
        "--step-s",
        metavar="X",
        type=float,
        default=0.02,
        help="sampling interval, s (default 0.02)",
    )
    parser.add_argument(
        "--folder", metavar="FOLDER", help="write the motions to CSV files in this folder"
    )
    add_earlier_name(parser, "--out", "--folder")
    level.add(parser)
    add_json(parser)
    add_law(parser, also="; default: journal for a bearing, otherwise coulomb")
    add_effects_from(parser)


def run(options: PlanOptions) -> int:
    """Run `jbf plan` and return its exit code."""
    from jbf.diagnosis.experiment_design.plan import plan

    targets = {"--json": options.json}
    outputs.check(targets, outputs.inputs_in(options.rig, options.effects_from))
    model = power.model_of(options.rig, options.law)
    quantities = model.rig.quantities
    with shown("planning"):
        result = plan(
            model,
            limits=options.limits.limits(options.run_s, quantities),
            minutes=options.minutes,
            noise_rms=power.noise_of(options.noise, model),
            step_s=options.step_s,
            policy=options.level.policy(quantities),
        )
    texts = {}
    if options.folder:
        folder = Path(options.folder)
        outputs.check_folder("--folder", folder)
        texts = {
            str(folder / f"{planned_run.name}.csv"): planned_run.to_csv()
            for planned_run in result.runs
        }
    if options.json:
        texts[options.json] = json_text(result.to_dict())
    outputs.write(texts)
    outputs.say(result.summary(), targets)
    return 0
