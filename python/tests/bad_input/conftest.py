"""Every test runs in a temporary folder with a minimal campaign."""

from pathlib import Path

import pytest

pytest.register_assert_rewrite("input_checks")

from input_checks import campaign  # noqa: E402


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return campaign(tmp_path)
