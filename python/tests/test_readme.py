"""The snippets of the README run as they stand."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def _snippets(name: str) -> list[str]:
    text = (ROOT / name).read_text(encoding="utf-8")
    return re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)


def test_control_python(capsys: pytest.CaptureFixture[str]) -> None:
    snippets = _snippets("docs/control.md")
    assert len(snippets) == 1
    exec(compile(snippets[0], "docs/control.md", "exec"), {})
    assert 0.0 < float(capsys.readouterr().out) < 0.1


@pytest.mark.parametrize("page", ["README.md", "docs/control.md", "docs/drives.md"])
def test_pictures_and_links_are_there(page: str) -> None:
    text = (ROOT / page).read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)#:]+)\)", text)
    assert targets
    for target in targets:
        assert (ROOT / page).parent.joinpath(target).exists(), target


def test_readme_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    snippets = _snippets("README.md")
    assert len(snippets) == 1
    assert len(snippets[0].splitlines()) <= 25
    exec(compile(snippets[0], "README.md", "exec"), {})
    out = capsys.readouterr().out
    assert "missing ('presliding',)" in out
    assert (tmp_path / "model.toml").exists()
