"""`jbf export MODEL --rust F / --c F`: source code of a model for firmware."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from jbf.cli import inputs, outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.errors import InputError
from jbf.export import c, rust


@dataclass(frozen=True)
class ExportOptions:
    """Arguments of `jbf export`."""

    model: str
    rust: str | None
    c: str | None


def add(commands: Commands) -> None:
    """Add `jbf export` to the parser."""
    parser = command(commands, "export", COMMANDS["export"], ExportOptions, run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    parser.add_argument(
        "--rust", metavar="FILE.rs", help="write a Rust module for jbf-core (- for standard output)"
    )
    parser.add_argument(
        "--c", metavar="FILE.h", help="write a C header for jbf-c (- for standard output)"
    )


def run(options: ExportOptions) -> int:
    """Run `jbf export` and return its exit code."""
    targets = {"--rust": options.rust, "--c": options.c}
    if not any(targets.values()):
        raise InputError(problem="no output is given", remedy="add --rust FILE.rs or --c FILE.h")
    outputs.check(targets, [options.model])
    model = inputs.model(options.model)
    name = Path(options.model).name
    texts = {}
    try:
        for path, write in ((options.rust, rust), (options.c, c)):
            if path is not None:
                texts[path] = write(model, name)
    except InputError as error:
        raise error.within(file=options.model) from None
    outputs.write(texts)
    outputs.say(f"model written to {', '.join(texts)}", targets)
    return 0
