"""`jbf control run|tables|tune|robustness`: control loops on the simulated bench."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.cli.control import robustness, run, tables, tune


@dataclass(frozen=True)
class ControlOptions:
    """Options of `jbf control`, which has subcommands (actions) only."""


def add(commands: Commands) -> None:
    """Add the actions of `jbf control` to the parser, one module each.

    Without an action, the help is printed.
    """

    def print_help(options: ControlOptions) -> int:
        parser.print_help()
        return 0

    parser = command(commands, "control", COMMANDS["control"], ControlOptions, print_help)
    actions = parser.add_subparsers(dest="action", metavar="ACTION", parser_class=type(parser))
    for action in (run, tables, tune, robustness):
        action.add(actions)
