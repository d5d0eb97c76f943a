"""`jbf compare MODEL RUN...`: size and location of the errors of a model."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.cli import inputs, outputs
from jbf.cli.arguments import Commands, add_effects_from, add_json, add_report, add_runs, command
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.reporting.json import json_text


@dataclass(frozen=True)
class CompareOptions:
    """Arguments of `jbf compare`."""

    model: str
    runs: tuple[str, ...]
    map: str | None
    json: str | None
    report: str | None
    effects_from: tuple[str, ...]
    typed: str


def add(commands: Commands) -> None:
    """Add `jbf compare` to the parser."""
    parser = command(commands, "compare", COMMANDS["compare"], CompareOptions, run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    add_runs(parser)
    parser.add_argument(
        "--map", metavar="MAP", help="map of jbf import with which the runs are read"
    )
    add_json(parser)
    add_report(parser)
    add_effects_from(parser)


def run(options: CompareOptions) -> int:
    """Run `jbf compare` and return its exit code."""
    targets = {"--json": options.json, "--report": options.report}
    read = outputs.inputs_in(options.model, options.runs, options.map, options.effects_from)
    outputs.check(targets, read)
    model = inputs.model(options.model)
    if options.map is None:
        runs = inputs.runs(options.runs, model.rig, first="MODEL")
    else:
        _, runs = inputs.recordings(options.map, options.runs)
    outputs.check(targets, [run.path for run in runs if run.path])

    from jbf.comparison.compare import compare

    texts = {}
    with shown("comparing"):
        comparison = compare(model, runs)
        if options.report:
            from jbf.reporting.comparison_page import comparison_page

            texts[options.report] = comparison_page(comparison, options.typed)
    if options.json:
        texts[options.json] = json_text(comparison.to_dict())
    summary = comparison.summary()
    outputs.write(texts)
    outputs.say(summary, targets)
    return 0
