"""Docstrings of the public names: sections in the style of numpydoc, and examples that run."""

import doctest
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jbf
import pytest

NAMES = [
    name
    for name in jbf.__all__
    if not name.startswith("_") and name not in ("control", "export", "plot")
]
FUNCTIONS = [name for name in NAMES if inspect.isfunction(getattr(jbf, name))]
ROOT = Path(__file__).resolve().parents[3]
FOLDERS = ("python", "simulator", "benches", "docs", "release")
JOINED = re.compile(
    r"^[ \t]*(?:Parameters|Attributes|Notes|Returns|Raises|Examples)[ \t]+-{5,}", re.M
)
OPTIONS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.chdir(tmp_path)
    effects, laws = set(jbf.effects()), set(jbf.laws())
    yield
    # An example removes what it registers.
    assert (set(jbf.effects()), set(jbf.laws())) == (effects, laws)


def section(text: str, title: str) -> str:
    """Text of a section of a docstring; empty if it has none."""
    match = re.search(rf"(?ms)^{title}\n-+\n(.*?)(?=^\w[\w ]*\n-{{3,}}$|\Z)", text)
    return match[1] if match else ""


@pytest.mark.parametrize("name", NAMES)
def test_example_of_a_public_name_runs_with_the_documented_output(name: str) -> None:
    documented: Any = getattr(jbf, name)
    text = section(inspect.getdoc(documented) or "", "Examples")
    assert ">>>" in text
    runner = doctest.DocTestRunner(optionflags=OPTIONS)
    example = doctest.DocTestParser().get_doctest(text, {"jbf": jbf}, name, None, None)
    out: list[str] = []
    runner.run(example, out=out.append)
    assert not runner.failures, "".join(out)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_arguments_and_result_of_a_public_function_are_documented(name: str) -> None:
    function = getattr(jbf, name)
    text, signature = inspect.getdoc(function) or "", inspect.signature(function)
    if signature.return_annotation != "None":
        assert section(text, "Returns"), name
    parameters = section(text, "Parameters")
    documented = set(re.findall(r"\w+", " ".join(re.findall(r"(?m)^\S.*$", parameters))))
    shared = re.search(r"parameters are those of|other arguments are those of", text)
    if not shared:
        assert set(signature.parameters) <= documented, name


def test_headings_of_sections_are_above_their_underlines() -> None:
    assert JOINED.search("Title.\n\n    Returns -------\n    The value.\n")
    assert not JOINED.search("Title.\n\n    Returns\n    -------\n    The value.\n")
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py")]
    texts = {path: path.read_text(encoding="utf-8") for path in files if path != Path(__file__)}
    assert not [f"{path}: {match[0]}" for path in texts for match in JOINED.finditer(texts[path])]
