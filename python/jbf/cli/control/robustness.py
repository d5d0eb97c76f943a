"""`jbf control robustness [MODEL]`: effect of compensation if its friction model is wrong."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_json, command
from jbf.cli.control.options import BenchOptions, add_bench, model_of
from jbf.cli.control.pictures import add_plot, check_picture, save_picture
from jbf.cli.progress import shown
from jbf.reporting.json import json_text


@dataclass(frozen=True)
class RobustnessOptions:
    """Arguments of `jbf control robustness`."""

    model: str | None
    bench: BenchOptions
    json: str | None
    plot: str | None


def add(actions: Commands) -> None:
    """Add `jbf control robustness` to the parser."""
    description = (
        "test the compensation with a wrong model: missing effects, wrong load, more noise"
    )
    parser = command(actions, "robustness", description, RobustnessOptions, run)
    parser.add_argument("model", metavar="MODEL", nargs="?", help="model file (default: thesis)")
    add_bench(parser)
    add_json(parser)
    add_plot(parser)


def run(options: RobustnessOptions) -> int:
    """Run `jbf control robustness` and return its exit code."""
    from jbf.control.bench import thesis_model
    from jbf.control.robustness import robustness
    from jbf.reporting.control_json import robustness_dict
    from jbf.reporting.control_run_text import robustness_text

    targets = {"--json": options.json, "--plot": options.plot}
    outputs.check(targets, outputs.inputs_in(options.model))
    check_picture(options.plot)
    base = thesis_model(elastic="nothing") if options.model is None else model_of(options.model)
    with shown("testing wrong models") as report:
        outcomes = robustness(base, options.bench.bench(), report=report)
    if options.json:
        outputs.write({options.json: json_text(robustness_dict(outcomes))})
    if options.plot:
        from jbf.reporting.control_plots import plot_robustness

        save_picture(plot_robustness(outcomes), options.plot)
    outputs.say(robustness_text(outcomes), targets)
    return 0
