"""Every test here works in a folder of its own that holds a small campaign."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.register_assert_rewrite("bad_input.checking")

from bad_input.checking import campaign  # noqa: E402


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return campaign(tmp_path)
