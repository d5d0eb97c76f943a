"""Habits of a command line: help with examples that hold, completion, slips told, version."""

from __future__ import annotations

import argparse
import shlex
import shutil
import subprocess
import warnings
from collections.abc import Iterator

import jbf
import pytest
from jbf.cli import COMMANDS, main, parser
from jbf.cli.examples import EXAMPLES


def every_parser(top: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    yield top
    for action in top._actions:
        if isinstance(action, argparse._SubParsersAction):
            for below in action.choices.values():
                yield from every_parser(below)


def names() -> list[str]:
    return [p.prog.removeprefix("jbf ") for p in every_parser(parser()) if p.prog != "jbf"]


def test_every_command_has_examples() -> None:
    assert set(names()) == set(EXAMPLES)
    assert {name.split()[0] for name in names()} == set(COMMANDS)


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_help_ends_with_examples_that_parse(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*name.split(), "--help"]) == 0
    said = capsys.readouterr().out
    lines = said[said.index("examples:\n") :].splitlines()[1:]
    assert [line.strip() for line in lines] == list(EXAMPLES[name])
    for line in EXAMPLES[name]:
        program, *words = shlex.split(line)
        assert program == "jbf"
        assert " ".join(words).startswith(name)
        chosen = parser().parse_args(words)
        assert chosen.command == name.split()[0]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--versoin"], "unrecognized arguments: --versoin; did you mean --version?"),
        (["fit", "--efects", "a"], "unrecognized arguments: --efects; did you mean --effects?"),
        (["control", "run", "--shceme=a"], "did you mean --scheme?"),
        (["--complet", "bash"], "did you mean --completion?"),
    ],
)
def test_a_slip_is_told_before_what_is_missing(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    said = capsys.readouterr().err
    assert told in said
    assert said.count("\n") == 1


def test_values_are_no_slips(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["effects", "--law=lugre"]) == 0
    assert main(["effects", "presliding", "--law", "lugre"]) == 0
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.endswith(f"jbf {jbf.__version__}\n")


def test_what_a_library_deprecates_is_no_matter_of_the_user(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def outdated() -> dict[str, object]:
        warnings.warn("old() is deprecated", DeprecationWarning, stacklevel=2)
        warnings.warn("the film is too fast", jbf.FilmWarning, stacklevel=2)
        return {}

    monkeypatch.setattr("jbf.cli.effects.effects", outdated)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert main(["effects"]) == 0
    assert capsys.readouterr().err == "jbf: the film is too fast\n"


def script(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["--completion", shell]) == 0
    return capsys.readouterr().out


def completed(text: str, *words: str) -> list[str]:
    """What bash offers after some words."""
    line = " ".join(shlex.quote(word) for word in ("jbf", *words))
    asked = (
        f'COMP_WORDS=({line}); COMP_CWORD={len(words)}; _jbf; printf "%s\\n" "${{COMPREPLY[@]}}"'
    )
    done = subprocess.run(
        ["bash", "-c", f"{text}\n{asked}"], capture_output=True, text=True, check=True
    )
    return done.stdout.split()


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_bash_completes(capsys: pytest.CaptureFixture[str]) -> None:
    text = script("bash", capsys)
    assert completed(text, "di") == ["diagnose"]
    assert completed(text, "fit", "--boot") == ["--bootstrap"]
    assert completed(text, "fit", "rig.toml", "--law", "lu") == ["lugre"]
    assert completed(text, "fit", "--clock", "")[:2] == ["journal", "thesis"]
    assert "tune" in completed(text, "control", "t")
    assert completed(text, "control", "run", "--sch") == ["--scheme"]
    assert completed(text, "--comp") == ["--completion"]


def test_zsh_and_fish_get_scripts_of_their_own(capsys: pytest.CaptureFixture[str]) -> None:
    assert script("zsh", capsys).startswith("#compdef jbf\n")
    fish = script("fish", capsys)
    for name in COMMANDS:
        assert f"'__fish_seen_subcommand_from {name}'" in fish
    assert "-l bootstrap" in fish
    for shell, check in (("zsh", "-n"), ("fish", "-n")):
        if shutil.which(shell):
            done = subprocess.run(
                [shell, check], input=script(shell, capsys), text=True, check=False
            )
            assert done.returncode == 0


def test_a_shell_that_is_none(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--completion", "tcsh"]) == 2
    assert "tcsh" in capsys.readouterr().err
