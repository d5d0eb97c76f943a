"""Arguments shared by several commands, and their conversion to typed options."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, cast, get_type_hints

from jbf.cli import outputs
from jbf.cli.examples import Help, examples
from jbf.models.catalogue import laws
from jbf.models.vocabulary import Clock

if TYPE_CHECKING:
    from jbf.cli import Parser

Commands: TypeAlias = "argparse._SubParsersAction[Parser]"
Group: TypeAlias = "argparse._ArgumentGroup | argparse.ArgumentParser"
Options = TypeVar("Options")


def command(
    commands: Commands,
    name: str,
    description: str,
    options: type[Options],
    run: Callable[[Options], int],
) -> Parser:
    """Add a subcommand of jbf to the parser.

    Parameters
    ----------
    commands
        Subcommands to which it is added.
    name
        Name of the subcommand.
    description
        Help text in one line.
    options
        Dataclass to which the parsed arguments are converted.
    run
        Runs the command with these options, and returns the exit code.
    """
    added = commands.add_parser(
        name,
        help=description,
        description=f"{description[0].upper()}{description[1:]}.",
        allow_abbrev=False,
    )
    added.epilog = examples(added.prog)
    added.formatter_class = Help
    added.set_defaults(run=lambda arguments: run(typed(options, arguments)))
    return added


def typed(options: type[Options], arguments: argparse.Namespace) -> Options:
    """Convert parsed arguments to a dataclass with one field per argument.

    A field that is itself a dataclass takes its fields from the same arguments. Lists become
    tuples.
    """
    hints, values = get_type_hints(options), {}
    for field in fields(cast("Any", options)):
        if is_dataclass(hints[field.name]):
            values[field.name] = typed(cast("type[Any]", hints[field.name]), arguments)
        else:
            value = getattr(arguments, field.name)
            values[field.name] = tuple(value) if isinstance(value, list) else value
    return options(**values)


class _Renamed(argparse.Action):
    """Action for an earlier spelling of an option: accepted with a note on stderr."""

    def __init__(self, *args: Any, new: str, **named: Any) -> None:
        super().__init__(*args, **named)
        self.new = new

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option: str | None = None,
    ) -> None:
        outputs.complain(f"{option} is now called {self.new}")
        setattr(namespace, self.dest, values)


def add_earlier_name(parser: Parser, earlier: str, new: str) -> None:
    """Accept the earlier spelling of an option that takes one value."""
    parser.add_argument(
        earlier,
        dest=new.removeprefix("--").replace("-", "_"),
        action=_Renamed,
        new=new,
        default=argparse.SUPPRESS,
        help=argparse.SUPPRESS,
    )


def add_runs(parser: Parser, *, needed: bool = True) -> None:
    """Add the positional argument `RUN...`, the recorded runs."""
    parser.add_argument(
        "runs",
        metavar="RUN",
        nargs="+" if needed else "*",
        help="CSV file of a run, folder of such files, or pattern",
    )


def add_rig(parser: Parser, nargs: str | None = None) -> None:
    """Add the positional argument `RIG`, the rig file or folder of a recorded campaign."""
    parser.add_argument(
        "rig",
        metavar="RIG",
        nargs=nargs,
        help="rig file (TOML), folder written by jbf import, or map of jbf import",
    )


@dataclass(frozen=True)
class LawOptions:
    """Base law of a model, and the definition of its film's time constant.

    Attributes
    ----------
    law
        Name of the law; None for the default of the command.

    clock
        Definition of the time constant of the film.
    """

    law: str | None
    clock: Clock


def add_law(parser: Parser, also: str = "") -> None:
    """Add the options `--law` and `--clock`.

    `also` is appended to the help and describes the default or further values of `--law`.
    """
    add_law_name(parser, f"base friction law: {', '.join(laws())}{also}")
    parser.add_argument(
        "--clock",
        metavar="NAME",
        choices=("journal", "thesis"),
        default="journal",
        help="time base of the film equation: shaft angle of the journal (journal, default) or as "
        "printed in Cohn 1998 (thesis)",
    )


def add_law_name(parser: Parser, description: str) -> None:
    """Add the option `--law` without `--clock`."""
    parser.add_argument("--law", metavar="NAME", help=description)


def add_effects_from(parser: Parser) -> None:
    """Add the option `--effects-from`, a Python file with user-defined effects."""
    parser.add_argument(
        "--effects-from",
        metavar="FILE.py",
        action="append",
        default=[],
        help="Python file that registers your own effects, executed first; may be repeated",
    )


def add_json(parser: Parser) -> None:
    """Add the option `--json`, a file for the result."""
    parser.add_argument(
        "--json", metavar="FILE", help="write the result as JSON (- for standard output)"
    )


def add_report(parser: Parser) -> None:
    """Add the option `--report`, a file for the HTML report."""
    parser.add_argument("--report", metavar="FILE.html", help="write a report with figures")


@dataclass(frozen=True)
class Verbosity:
    """Length of the printed text.

    Attributes
    ----------
    full
        Print the complete report.
    quiet
        Print the verdict only.
    """

    full: bool
    quiet: bool


def add_verbosity(parser: Parser) -> None:
    """Add the options `--full` and `--quiet`."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument(
        "--full", action="store_true", help="print the complete report, not the summary"
    )
    group.add_argument("-q", "--quiet", action="store_true", help="print only the verdict")
