"""`jbf control tables`: the thesis's Tables 6.1 and 6.2, fitted and predicted."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_json, command
from jbf.cli.control.pictures import add_plot, check_picture, save_picture
from jbf.cli.progress import shown
from jbf.reporting.json import json_text

if TYPE_CHECKING:
    from jbf.cli import Parser


def add(actions: Commands) -> None:
    """Add the action to the parser."""
    does = "Tables 6.1 and 6.2: fitted, predicted, printed"
    add_options(command(actions, "tables", does, run))


def add_options(parser: Parser) -> None:
    """Add `--json` and `--plot`."""
    add_json(parser)
    add_plot(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run the action."""
    from jbf.control.assumptions import assumptions
    from jbf.control.thesis_tables import fit_friction, tables
    from jbf.reporting.control_json import tables_dict
    from jbf.reporting.control_tables_text import tables_report

    wanted = {"--json": arguments.json, "--plot": arguments.plot}
    outputs.check(wanted)
    check_picture(arguments.plot)
    with shown("the bench's friction") as report:
        model, bench = fit_friction(report=report)
        both = tables(model, bench, report=report)
        others = list(assumptions(both, report=report))
    if arguments.json:
        outputs.write({arguments.json: json_text(tables_dict(both, others))})
    if arguments.plot:
        from jbf.reporting.control_plots import plot_tables

        save_picture(plot_tables(both), arguments.plot)
    outputs.say(tables_report(both, others), wanted)
    return 0
