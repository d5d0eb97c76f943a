"""`jbf export MODEL --rust F / --c F`: the model as source code for firmware."""

from __future__ import annotations

import argparse
from pathlib import Path

from jbf.cli import inputs, outputs
from jbf.cli.arguments import Commands, command
from jbf.cli.commands import COMMANDS
from jbf.errors import InputError
from jbf.export import c, rust


def add(commands: Commands) -> None:
    """Add the command to the parser."""
    parser = command(commands, "export", COMMANDS["export"], run)
    parser.add_argument("model", metavar="MODEL", help="model file (TOML)")
    parser.add_argument("--rust", metavar="FILE.rs", help="a Rust module for jbf-core; - is stdout")
    parser.add_argument("--c", metavar="FILE.h", help="a C header for jbf-c; - is stdout")


def run(arguments: argparse.Namespace) -> int:
    """Run the command."""
    wanted = {"--rust": arguments.rust, "--c": arguments.c}
    if not any(wanted.values()):
        raise InputError(
            problem="nothing to write", mend="name a file: --rust FILE.rs or --c FILE.h"
        )
    outputs.check(wanted, outputs.read_by(arguments))
    model = inputs.model(arguments.model)
    name = Path(arguments.model).name
    texts = {}
    try:
        for path, write in ((arguments.rust, rust), (arguments.c, c)):
            if path is not None:
                texts[path] = write(model, name)
    except InputError as error:
        raise error.within(file=arguments.model) from None
    outputs.write(texts)
    outputs.say(f"model written to {', '.join(texts)}", wanted)
    return 0
