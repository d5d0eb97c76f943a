"""Arguments shared by several commands."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

from jbf.cli.examples import Help, examples
from jbf.models.catalogue import laws

if TYPE_CHECKING:
    from jbf.cli import Parser

Commands: TypeAlias = "argparse._SubParsersAction[Parser]"


def command(
    commands: Commands, name: str, does: str, run: Callable[[argparse.Namespace], int]
) -> Parser:
    """Add a subcommand with a one-line help text."""
    added = commands.add_parser(
        name, help=does, description=f"{does[0].upper()}{does[1:]}.", allow_abbrev=False
    )
    added.epilog = examples(added.prog)
    added.formatter_class = Help
    added.set_defaults(run=run)
    return added


def add_runs(parser: Parser, *, needed: bool = True) -> None:
    """Add the positional argument `RUN...`."""
    parser.add_argument(
        "runs",
        metavar="RUN",
        nargs="+" if needed else "*",
        help="a CSV file, a folder of them, or a pattern",
    )


def add_law(parser: Parser, also: str = "") -> None:
    """Add `--law` and `--clock`.

    `also` is appended to the help and names further values of `--law`.
    """
    add_law_name(parser, "journal", f"base law: {', '.join(laws())} (journal){also}")
    parser.add_argument(
        "--clock",
        metavar="NAME",
        choices=("journal", "thesis"),
        default="journal",
        help="the film's clock: journal (default) or thesis",
    )


def add_law_name(parser: Parser, default: str | None, does: str) -> None:
    """Add `--law` without `--clock`."""
    parser.add_argument("--law", metavar="NAME", default=default, help=does)


def add_effects_from(parser: Parser) -> None:
    """Add `--effects-from`."""
    parser.add_argument(
        "--effects-from",
        metavar="FILE.py",
        action="append",
        default=[],
        help="run this Python file first, which registers effects of your own; may be repeated",
    )


def add_json(parser: Parser) -> None:
    """Add `--json`."""
    parser.add_argument(
        "--json", metavar="FILE", help="write the result as JSON; - is standard output"
    )


def add_report(parser: Parser) -> None:
    """Add `--report`."""
    parser.add_argument("--report", metavar="FILE.html", help="write a page with pictures")
