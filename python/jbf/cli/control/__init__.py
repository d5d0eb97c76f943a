"""`jbf control run|tables|tune|robustness`: control loops on the simulated bench."""

from __future__ import annotations

from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.cli.control import robustness, run, tables, tune


def add(commands: Commands) -> None:
    """Add the actions to the parser, one module each; without an action, `tables` is run."""
    parser = command(commands, "control", COMMANDS["control"], tables.run)
    actions = parser.add_subparsers(dest="action", metavar="ACTION", parser_class=type(parser))
    tables.add_options(parser)
    for action in (run, tables, tune, robustness):
        action.add(actions)
