"""`jbf effects [NAME]`: the catalogue."""

from __future__ import annotations

import argparse
from dataclasses import asdict

from jbf.catalogue import effects, find_effect
from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_json, command


def add(commands: Commands) -> None:
    """Put the command on the command line."""
    does = "the catalogue of effects: forms, parameters, sources"
    parser = command(commands, "effects", does, run)
    parser.add_argument("name", metavar="NAME", nargs="?", help="one effect's page")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Do it."""
    from jbf.text import effect_page, effects_page

    wanted = {"--json": arguments.json}
    outputs.check(wanted)
    if arguments.name is None:
        pages = list(effects().values())
        text, data = effects_page(pages), [asdict(page) for page in pages]
    else:
        page = find_effect(arguments.name)
        text, data = effect_page(page), [asdict(page)]
    if arguments.json:
        outputs.write({arguments.json: outputs.json_text({"effects": data})})
    outputs.say(text, wanted)
    return 0
