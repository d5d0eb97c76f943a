"""Write docs/reference/commands.md from the parsers: `.venv/bin/python docs/site/commands.py`.

`--check` writes nothing, and exits with 1 if the page differs from the parsers.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator

from jbf.cli import parser
from pages import DOCS

PAGE = DOCS / "reference" / "commands.md"
HEAD = """# Commands

Written from the parsers by `docs/site/commands.py`. Exit codes: 0 done; 2 the input is wrong, with
one line that names file, row, column and what to do; 130 interrupted (a fit keeps its best so far).
Long work shows its progress on a terminal. `--json -` writes to standard output
([the results](results.md)); numbers are in SI units.

`eval "$(jbf --completion bash)"` completes commands and options (also `zsh`, `fish`).
"""


def leaves(
    of: argparse.ArgumentParser, about: str = ""
) -> Iterator[tuple[argparse.ArgumentParser, str]]:
    """Generate the parsers of the executable commands, with their descriptions."""
    for action in of._actions:
        if isinstance(action, argparse._SubParsersAction):
            words = {choice.dest: choice.help or "" for choice in action._choices_actions}
            for name, below in action.choices.items():
                yield from leaves(below, words.get(name, ""))
            return
    yield of, about


def cell(text: str) -> str:
    """Format text for a table cell."""
    return " ".join(text.split()).replace("|", "\\|")


def named(action: argparse.Action) -> str:
    """Format an argument as it is typed."""
    value = action.metavar if action.metavar is not None else (action.dest or "").upper()
    if action.choices and action.metavar is None:
        value = "{" + ",".join(map(str, action.choices)) + "}"
    words = " ".join(value) if isinstance(value, tuple) else value
    if not action.option_strings:
        return f"`{words}`"
    spelled = ", ".join(action.option_strings)
    return f"`{spelled}`" if action.nargs == 0 else f"`{spelled} {words}`"


def usage(of: argparse.ArgumentParser) -> str:
    """Format a command as one line; the usage text of argparse varies with the Python version."""
    shown = {"?": "[{}]", "*": "[{} ...]", "+": "{0} [{0} ...]", None: "{}"}
    needed = [named(a)[1:-1] for a in of._actions if a.option_strings and a.required]
    places = [
        shown[a.nargs if isinstance(a.nargs, str) else None].format(named(a)[1:-1])
        for a in of._actions
        if not a.option_strings
    ]
    return " ".join([of.prog, *needed, "[options]", *places])


def section(of: argparse.ArgumentParser, about: str) -> str:
    """Return the section of a command."""
    lines = [f"## {of.prog}", (of.description or about).strip(), ""]
    lines += ["```text", usage(of), "```", "", "| argument | what |", "| --- | --- |"]
    for group in of._action_groups:
        for action in group._group_actions:
            if "-h" in action.option_strings or action.help == argparse.SUPPRESS:
                continue
            said = (action.help or "") % {"default": action.default, "prog": of.prog}
            lines.append(f"| {named(action)} | {cell(said)} |")
    shown = [line.strip() for line in (of.epilog or "").splitlines() if line.startswith("  ")]
    if shown:
        lines += ["", "```text", *shown, "```"]
    return "\n".join(lines) + "\n"


def page() -> str:
    """Return the complete page."""
    return "\n".join([HEAD, *(section(of, about) for of, about in leaves(parser()))])


def main() -> int:
    """Write the page or check it."""
    text = page()
    if "--check" in sys.argv[1:]:
        return PAGE.read_text(encoding="utf-8") != text
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
