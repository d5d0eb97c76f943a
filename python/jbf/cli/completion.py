"""`jbf --completion SHELL`: script that completes commands, options and their values."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Iterator
from typing import Any, cast

SHELLS = ("bash", "zsh", "fish")


class Completion(argparse.Action):
    """Action of `--completion`: prints the completion script of a shell and exits."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: Any, values: Any, option: Any = None
    ) -> None:
        """Print the script and exit."""
        print(script(parser, str(values)), end="")
        parser.exit()


def script(parser: argparse.ArgumentParser, shell: str) -> str:
    """Completion script of a shell for all commands of a parser."""
    words_of_command = dict(_commands(parser))
    if shell == "fish":
        return _fish(words_of_command)
    bash = _bash(words_of_command)
    if shell == "zsh":
        return f"#compdef jbf\nautoload -U +X bashcompinit && bashcompinit\n{bash}"
    return bash


class _Words:
    """Possible completions of a command: subcommands, options, and the values of options."""

    def __init__(self, parser: argparse.ArgumentParser) -> None:
        from jbf.models.catalogue import laws

        self.actions = list(_subcommands(parser))
        self.options: dict[str, str] = {}
        self.values: dict[str, list[str]] = {}
        for action in parser._actions:
            if action.help == argparse.SUPPRESS:
                continue
            for option in action.option_strings:
                self.options[option] = action.help or ""
                if action.choices is not None:
                    self.values[option] = [str(choice) for choice in action.choices]
                elif option == "--law":
                    self.values[option] = [*laws(), "auto"]


def _subcommands(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Parsers of the subcommands, by name."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            return cast("dict[str, argparse.ArgumentParser]", dict(action.choices))
    return {}


def _commands(parser: argparse.ArgumentParser, name: str = "") -> Iterator[tuple[str, _Words]]:
    """Yield the words of each command with its completions."""
    yield name, _Words(parser)
    for word, below in _subcommands(parser).items():
        yield from _commands(below, f"{name} {word}".strip())


def _bash(words_of_command: dict[str, _Words]) -> str:
    """Completion script for bash."""
    lines = [
        "_jbf() {",
        '  local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD-1]}"',
        '  local command="" words="" i',
        "  for ((i = 1; i < COMP_CWORD; i++)); do",
        '    case "$command ${COMP_WORDS[i]}" in',
    ]
    for name in filter(None, words_of_command):
        pattern = f'" {name}"' if " " not in name else f'"{name}"'
        lines.append(f'      {pattern}) command="{name}" ;;')
    lines += ["    esac", "  done", '  case "$command $before" in']
    for name, words in words_of_command.items():
        for option, values in words.values.items():
            lines.append(f'    "{name} {option}") words="{" ".join(values)}" ;;')
    lines += ["  esac", '  if [[ -z $words ]]; then case "$command" in']
    for name, words in words_of_command.items():
        lines.append(f'    "{name}") words="{" ".join([*words.actions, *words.options])}" ;;')
    return "\n".join(
        [
            *lines,
            "  esac; fi",
            '  COMPREPLY=($(compgen -W "$words" -- "$word"))',
            '  [[ -n $command && $word != -* ]] && COMPREPLY+=($(compgen -f -- "$word"))',
            "  return 0",
            "}",
            "complete -o filenames -F _jbf jbf",
            "",
        ]
    )


def _fish(words_of_command: dict[str, _Words]) -> str:
    """Completion script for fish."""
    lines = []
    for name, words in words_of_command.items():
        conditions = [f"__fish_seen_subcommand_from {word}" for word in name.split()]
        when = "; and ".join(conditions) if conditions else "__fish_use_subcommand"
        head = f"complete -c jbf -n {shlex.quote(when)}"
        if words.actions:
            lines.append(f"{head}{' -f' * (not name)} -a {shlex.quote(' '.join(words.actions))}")
        for option, description in words.options.items():
            flag = f"-l {option[2:]}" if option.startswith("--") else f"-s {option[1:]}"
            names = words.values.get(option)
            takes = f" -x -a {shlex.quote(' '.join(names))}" if names else ""
            quoted = shlex.quote(description.replace("%%", "%"))
            lines.append(f"{head} {flag}{takes} -d {quoted}")
    return "\n".join([*lines, ""])
