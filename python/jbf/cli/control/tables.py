"""`jbf control tables`: reproduce Tables 6.1 and 6.2 of Cohn (1998) by simulation."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_json, command
from jbf.cli.control.pictures import add_plot, check_picture, save_picture
from jbf.cli.progress import shown
from jbf.reporting.json import json_text


@dataclass(frozen=True)
class TablesOptions:
    """Arguments of `jbf control tables`."""

    json: str | None
    plot: str | None


def add(actions: Commands) -> None:
    """Add `jbf control tables` to the parser."""
    description = (
        "reproduce Tables 6.1 and 6.2 of the thesis: published, fitted and predicted values"
    )
    parser = command(actions, "tables", description, TablesOptions, run)
    add_json(parser)
    add_plot(parser)


def run(options: TablesOptions) -> int:
    """Run `jbf control tables` and return its exit code."""
    from jbf.control.assumptions import assumptions
    from jbf.control.thesis_tables import fit_friction, tables
    from jbf.reporting.control_json import tables_dict
    from jbf.reporting.control_tables_text import tables_report

    targets = {"--json": options.json, "--plot": options.plot}
    outputs.check(targets)
    check_picture(options.plot)
    with shown("fitting the friction of the bench") as report:
        model, bench = fit_friction(report=report)
        both = tables(model, bench, report=report)
        alternatives = list(assumptions(both, report=report))
    if options.json:
        outputs.write({options.json: json_text(tables_dict(both, alternatives))})
    if options.plot:
        from jbf.reporting.control_plots import plot_tables

        save_picture(plot_tables(both), options.plot)
    outputs.say(tables_report(both, alternatives), targets)
    return 0
