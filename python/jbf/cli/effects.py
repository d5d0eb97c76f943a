"""`jbf effects [NAME] [--law NAME]`: catalogue of effects, or one entry of it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import Any

from jbf.cli import outputs
from jbf.cli.arguments import Commands, add_effects_from, add_json, add_law_name, command
from jbf.cli.commands import COMMANDS
from jbf.models.catalogue import Effect, effects, find_effect, find_law, reason_not_applicable
from jbf.reporting.json import json_text


@dataclass(frozen=True)
class EffectsOptions:
    """Arguments of `jbf effects`."""

    name: str | None
    law: str | None
    json: str | None


def add(commands: Commands) -> None:
    """Add `jbf effects` to the parser."""
    parser = command(commands, "effects", COMMANDS["effects"], EffectsOptions, run)
    parser.add_argument(
        "name", metavar="NAME", nargs="?", help="effect whose description is printed"
    )
    add_law_name(parser, "list the effects that apply to this law, and why the others do not")
    add_json(parser)
    add_effects_from(parser)


def run(options: EffectsOptions) -> int:
    """Run `jbf effects` and return its exit code."""
    from jbf.reporting.catalogue_text import effect_page, effects_page

    targets = {"--json": options.json}
    outputs.check(targets)
    law = None if options.law is None else find_law(options.law).name
    if options.name is None:
        pages = list(effects().values())
        text = effects_page(pages, law)
    else:
        pages = [find_effect(options.name)]
        text = effect_page(pages[0])
        reason = None if law is None else reason_not_applicable(pages[0], law)
        if reason is not None:
            text += f"\n\nDoes not apply: the law {law} {reason}"
    if options.json:
        outputs.write({options.json: json_text({"effects": list(map(_plain, pages))})})
    outputs.say(text, targets)
    return 0


def _plain(page: Effect) -> dict[str, Any]:
    """Convert a catalogue entry to JSON data, without the function of a user-defined effect."""
    content = {f.name: getattr(page, f.name) for f in fields(Effect)}
    return content | {"parameters": [asdict(p) for p in page.parameters]}
