"""Help with valid examples, suggestions for misspelt options, and shell completion."""

import shlex
import shutil
import subprocess

import pytest
from input_checks import Capture
from jbf.cli import COMMANDS, main, parser
from jbf.cli.examples import EXAMPLES


def test_help_examples_exist_for_every_command() -> None:
    assert {name.split()[0] for name in EXAMPLES} == set(COMMANDS)


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_help_of_a_command_ends_with_valid_examples(name: str, capsys: Capture) -> None:
    assert main([*name.split(), "--help"]) == 0
    shown, errors = capsys.readouterr()
    assert errors == ""
    lines = shown[shown.index("examples:\n") :].splitlines()[1:]
    assert [line.strip() for line in lines] == list(EXAMPLES[name])
    for line in EXAMPLES[name]:
        program, *words = shlex.split(line)
        assert program == "jbf"
        assert " ".join(words).startswith(name)
        chosen = parser().parse_args(words)
        assert chosen.command == name.split()[0]


def test_call_without_a_command_shows_valid_commands_to_begin_with(capsys: Capture) -> None:
    assert main([]) == 2
    shown, errors = capsys.readouterr()
    assert errors.startswith("jbf: ")
    assert errors.count("\n") == 1
    lines = [line.strip() for line in shown.splitlines() if line.startswith("  jbf ")]
    assert len(lines) == 3
    for line in lines:
        words = shlex.split(line.split("  ")[0])[1:]
        assert parser().parse_args(words).command == words[0]


def test_option_value_is_accepted_after_an_equals_sign_or_a_space() -> None:
    assert main(["effects", "--law=lugre"]) == 0
    assert main(["effects", "presliding", "--law", "lugre"]) == 0


@pytest.mark.parametrize(
    ("command", "current"),
    [
        ("import a.csv --out b", "--folder"),
        ("plan rig.toml --max-velocity 1 --out b", "--folder"),
        ("control run --out b", "--csv"),
        ("control tune model.toml --out b", "--toml"),
    ],
)
def test_earlier_name_of_an_option_is_accepted_with_a_note(
    command: str, current: str, capsys: Capture
) -> None:
    arguments = parser().parse_args(command.split())
    assert getattr(arguments, current.strip("-")) == "b"
    note = capsys.readouterr().err
    assert current in note
    assert note.count("\n") == 1


def completed(text: str, *words: str) -> list[str]:
    """Completions that bash offers after the given words."""
    line = " ".join(shlex.quote(word) for word in ("jbf", *words))
    request = f'COMP_WORDS=({line}); COMP_CWORD={len(words)}; _jbf; echo "${{COMPREPLY[@]}}"'
    command = ["bash", "-c", f"{text}\n{request}"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_bash_completion_offers_commands_options_and_values(capsys: Capture) -> None:
    assert main(["--completion", "bash"]) == 0
    text = capsys.readouterr().out
    assert completed(text, "di") == ["diagnose"]
    assert completed(text, "fit", "--boot") == ["--bootstrap"]
    assert completed(text, "fit", "rig.toml", "--law", "lu") == ["lugre"]
    assert completed(text, "fit", "--clock", "")[:2] == ["journal", "thesis"]
    assert "tune" in completed(text, "control", "t")
    assert completed(text, "control", "run", "--sch") == ["--scheme"]
    assert completed(text, "--comp") == ["--completion"]
