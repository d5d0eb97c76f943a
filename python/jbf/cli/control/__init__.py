"""`jbf control run|tables|tune|robustness`: control loops on the simulated bench."""

from __future__ import annotations

from dataclasses import dataclass

from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.cli.control import robustness, run, tables, tune


@dataclass(frozen=True)
class ControlOptions:
    """No arguments: the command has only actions."""


def add(commands: Commands) -> None:
    """Add the actions to the parser, one module each; without an action, the help is printed."""

    def print_help(options: ControlOptions) -> int:
        parser.print_help()
        return 0

    parser = command(commands, "control", COMMANDS["control"], ControlOptions, print_help)
    actions = parser.add_subparsers(dest="action", metavar="ACTION", parser_class=type(parser))
    for action in (run, tables, tune, robustness):
        action.add(actions)
