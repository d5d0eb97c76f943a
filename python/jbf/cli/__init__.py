"""Command line: one module per command, with `add(commands)` and `run(options) -> int`.

Input: arguments and files. Output: text, files, an exit code. The package contains no physics and
no statistics.

Exit codes: 0 on success; 2 if the input is wrong, with a one-line message on stderr and nothing
written; 130 if interrupted.

May import: every package.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
import warnings
from collections.abc import Collection, Iterator, Sequence
from importlib import import_module
from io import TextIOWrapper
from typing import Any, NoReturn

from jbf.cli import outputs
from jbf.cli.commands import COMMANDS
from jbf.cli.completion import SHELLS, Completion
from jbf.cli.examples import HEAD, Help
from jbf.errors import InputError, closest, did_you_mean
from jbf.renamed import current_option

_MODULES = {"import": "import_files"}
"""Modules of commands whose name is a Python keyword."""

FIRST_COMMANDS = (
    ("jbf demo", "an example of the complete workflow"),
    ("jbf import log.csv", "read a recording of your own"),
    ("jbf diagnose rig.toml runs/ --report report.html", "find the missing effects"),
)
"""Commands to begin with, and a description of each, for the help of `jbf`."""
TOP_EXAMPLES = (*(line for line, _ in FIRST_COMMANDS), 'eval "$(jbf --completion bash)"')
"""Examples in the help of `jbf --help`."""

_PIPE_CLOSED = 141
_INTERRUPTED = 130


class Parser(argparse.ArgumentParser):
    """Argument parser that reports errors in one line, like all other errors."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse as `argparse` does, and suggest the intended option for an unknown one.

        Unknown options are reported before missing arguments.
        """
        words = sys.argv[1:] if args is None else list(args)
        self._find_slips(
            [word for word in self._words_before_subcommand(words) if word.startswith("--")]
        )
        parsed, rest = super().parse_known_args(args, namespace)
        self._find_slips(rest)
        return parsed, rest

    def _words_before_subcommand(self, words: Sequence[str]) -> Iterator[str]:
        """Yield the words of the command line before a subcommand and before `--`."""
        below = [a.choices for a in self._actions if isinstance(a, argparse._SubParsersAction)]
        for word in words:
            if word == "--" or any(word in names for names in below):
                return
            yield word

    def _find_slips(self, rest: Sequence[str]) -> None:
        """Raise an error for the first unknown option, with a suggestion."""
        options = list(self._option_string_actions)
        for word in rest:
            option = word.partition("=")[0]
            if option in options:
                continue
            longer = [name for name in options if len(option) > 3 and name.startswith(option)]
            guess = longer[0] if longer else closest(option, options)
            if word.startswith("--") and guess is not None:
                self.error(f"unrecognized arguments: {word}; did you mean {guess}?")

    def error(self, message: str) -> NoReturn:
        """Print an error message in one line and exit with code 2."""
        self.exit(2, f"jbf: {' '.join(message.split())} (see {self.prog} --help)\n")


def parser(words: Sequence[str] | None = None) -> Parser:
    """Build the argument parser of jbf.

    Parameters
    ----------
    words
        Words of the command line; only the commands that they may require get their arguments.
        None to build the complete parser.
    """
    from jbf._core import __version__

    top = Parser(
        prog="jbf",
        description="Find the friction effect that a model lacks. From recorded force and motion "
        "of a joint, axis, seal or bearing, jbf fits a friction law, shows where it fails, names "
        "the missing effect, confirms it on held-out data, and exports the model to a controller.",
        allow_abbrev=False,
        formatter_class=Help,
    )
    top.add_argument("--version", action="version", version=f"jbf {__version__}")
    top.add_argument(
        "--completion",
        action=Completion,
        choices=SHELLS,
        help="print a script for shell completion of commands and options: bash, zsh or fish",
    )
    top.epilog = "\n".join([HEAD, *(f"  {line}" for line in TOP_EXAMPLES)])
    commands = top.add_subparsers(
        dest="command", metavar="COMMAND", required=True, parser_class=Parser
    )
    needed = COMMANDS if words is None else _needed(words)
    for name, description in COMMANDS.items():
        if name in needed:
            import_module(f"jbf.cli.{_MODULES.get(name, name)}").add(commands)
        else:
            commands.add_parser(name, help=description)
    return top


def _needed(words: Sequence[str]) -> Collection[str]:
    """Names of the commands whose arguments the words of a command line may require."""
    if words and words[0] in COMMANDS:
        return words[:1]
    return () if words and words[0] in ("-h", "--help", "--version") else COMMANDS


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command of jbf and return its exit code.

    Parameters
    ----------
    argv
        Arguments without the program name. Default: those of the process.
    """
    if argv is None:
        _configure_process()
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        code = _dispatch(arguments)
        outputs.flush()
    except BrokenPipeError:
        # The reader has closed the pipe (`jbf effects | head`); this is not an error.
        outputs.drop_stdout()
        return _PIPE_CLOSED
    except KeyboardInterrupt as stop:
        outputs.complain(
            str(stop) if isinstance(stop, outputs.PartialResultSaved) else "interrupted"
        )
        return _INTERRUPTED
    except InputError as error:
        return _refuse(error)
    return code


def _configure_process() -> None:
    """Set the plot backend and the error handling of the output streams of a `jbf` process.

    This is not done if jbf is used as a library.
    """
    # Figures are written to files: use no window, whatever backend the environment requests.
    os.environ["MPLBACKEND"] = "agg"
    for stream in (sys.stdout, sys.stderr):
        # Escape characters that the terminal's encoding lacks.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _dispatch(arguments: list[str]) -> int:
    """Run the command of the arguments and return its exit code."""
    if not arguments:
        return _without_command()
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _show
            arguments = [current_option(word) for word in arguments]
        _check_command(arguments)
        chosen = parser(arguments).parse_args(arguments)
        run = chosen.run
        chosen.typed = shlex.join(["jbf", *arguments])
    except SystemExit as stop:  # argparse has printed the reason
        return stop.code if isinstance(stop.code, int) else 2
    except InputError as error:
        return _refuse(error)
    try:
        for file in getattr(chosen, "effects_from", []):
            import_module("jbf.models.user_effects").load_effects(file)
        with warnings.catch_warnings():
            warnings.showwarning = _show
            code: int = run(chosen)
    except InputError as error:
        return _refuse(error)
    return code


def _show(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
    """Print a warning as one line on stderr.

    Deprecation warnings of libraries are suppressed because they concern developers, not users.
    """
    if not issubclass(category, (DeprecationWarning, PendingDeprecationWarning)):
        outputs.complain(message)


def _refuse(error: InputError) -> int:
    """Print an InputError in one line and return exit code 2."""
    outputs.complain(error)
    return 2


def _without_command() -> int:
    """Print the commands to begin with, and an error that no command was given."""
    width = max(len(line) for line, _ in FIRST_COMMANDS)
    lines = [f"  {line:<{width}}  {does}" for line, does in FIRST_COMMANDS]
    outputs.say("\n".join(["Commands to begin with:", *lines]), {})
    return _refuse(InputError(problem="COMMAND is missing", remedy="jbf --help lists all commands"))


def _check_command(arguments: list[str]) -> None:
    """Raise an InputError for an unknown command, with the most similar one as suggestion."""
    first = arguments[0]
    if not first.startswith("-") and first not in COMMANDS:
        raise InputError(
            problem=f'there is no command "{first}"', remedy=did_you_mean(first, COMMANDS)
        )
