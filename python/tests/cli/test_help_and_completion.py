"""Help with examples that parse, suggestions for misspelt options, shell completion."""

from __future__ import annotations

import shlex
import shutil
import subprocess

import jbf
import pytest
from jbf.cli import COMMANDS, main, parser
from jbf.cli.examples import EXAMPLES


def test_every_command_has_examples() -> None:
    assert {name.split()[0] for name in EXAMPLES} == set(COMMANDS)


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_help_of_every_command_ends_with_examples_that_parse(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*name.split(), "--help"]) == 0
    shown = capsys.readouterr().out
    lines = shown[shown.index("examples:\n") :].splitlines()[1:]
    assert [line.strip() for line in lines] == list(EXAMPLES[name])
    for line in EXAMPLES[name]:
        program, *words = shlex.split(line)
        assert program == "jbf"
        assert " ".join(words).startswith(name)
        chosen = parser().parse_args(words)
        assert chosen.command == name.split()[0]


@pytest.mark.parametrize(
    ("words", "fragment"),
    [
        (["--versoin"], "unrecognized arguments: --versoin; did you mean --version?"),
        (["fit", "--efects", "a"], "unrecognized arguments: --efects; did you mean --effects?"),
        (["control", "run", "--shceme=a"], "did you mean --scheme?"),
        (["--complet", "bash"], "did you mean --completion?"),
    ],
)
def test_misspelt_option_is_reported_with_a_suggestion(
    words: list[str], fragment: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    message = capsys.readouterr().err
    assert fragment in message
    assert message.count("\n") == 1


def test_command_lines_with_valid_options_and_values_are_accepted(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["effects", "--law=lugre"]) == 0
    assert main(["effects", "presliding", "--law", "lugre"]) == 0
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.endswith(f"jbf {jbf.__version__}\n")


def script(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["--completion", shell]) == 0
    return capsys.readouterr().out


def completed(text: str, *words: str) -> list[str]:
    """Words that bash offers after the given ones."""
    line = " ".join(shlex.quote(word) for word in ("jbf", *words))
    request = (
        f'COMP_WORDS=({line}); COMP_CWORD={len(words)}; _jbf; printf "%s\\n" "${{COMPREPLY[@]}}"'
    )
    done = subprocess.run(
        ["bash", "-c", f"{text}\n{request}"], capture_output=True, text=True, check=True
    )
    return done.stdout.split()


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
def test_bash_completes_commands_options_and_values(capsys: pytest.CaptureFixture[str]) -> None:
    text = script("bash", capsys)
    assert completed(text, "di") == ["diagnose"]
    assert completed(text, "fit", "--boot") == ["--bootstrap"]
    assert completed(text, "fit", "rig.toml", "--law", "lu") == ["lugre"]
    assert completed(text, "fit", "--clock", "")[:2] == ["journal", "thesis"]
    assert "tune" in completed(text, "control", "t")
    assert completed(text, "control", "run", "--sch") == ["--scheme"]
    assert completed(text, "--comp") == ["--completion"]


def test_completion_for_an_unknown_shell_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--completion", "tcsh"]) == 2
    assert "tcsh" in capsys.readouterr().err
