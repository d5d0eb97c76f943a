"""What the pages for contributors and releases name is there: files, tests, targets, options."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import jbf
import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = (
    "CONTRIBUTING.md",
    "CODE_OF_CONDUCT.md",
    "SECURITY.md",
    "docs/versions.md",
    "docs/dependencies.md",
    "release/README.md",
)


def text_of(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def targets() -> set[str]:
    """Of the Makefile."""
    return set(re.findall(r"^([a-z][a-z-]*):", text_of("Makefile"), flags=re.MULTILINE))


@pytest.mark.parametrize("page", PAGES)
def test_links_and_files_are_there(page: str) -> None:
    text = text_of(page)
    for target in re.findall(r"\]\(([^)#:]+)\)", text):
        assert (ROOT / page).parent.joinpath(target).exists(), target
    for named in re.findall(r"`([\w./-]+\.(?:py|rs|toml|md|yml|h))`", text):
        if "NAME" not in named and "/" in named:
            inside = ("", "crates", "crates/jbf-core/src", "python")
            places = [ROOT / folder for folder in inside]
            assert any((place / named).exists() for place in places), named


@pytest.mark.parametrize("page", [*PAGES, "README.md", ".github/PULL_REQUEST_TEMPLATE.md"])
def test_targets_are_there(page: str) -> None:
    named = set(re.findall(r"(?:`|^)make ([a-z-]+)", text_of(page), flags=re.MULTILINE))
    assert named <= targets()


def test_help_tells_every_target() -> None:
    told = set(re.findall(r'@echo "make ([a-z-]+)', text_of("Makefile")))
    assert told | {"help", "bits-table"} == targets()


def test_the_tests_that_a_contribution_must_pass_are_there() -> None:
    text = text_of("CONTRIBUTING.md")
    rust = set(re.findall(r"--test (\w+)", text))
    folders = [ROOT / "crates" / crate / "tests" for crate in ("jbf-core", "jbf-c")]
    there = {path.stem for folder in folders for path in folder.iterdir()}
    assert {"effects", "laws", "header", "control_safety"} <= rust <= there
    python = re.findall(r"python/tests/test_\w+\.py", text)
    assert len(set(python)) > 5
    assert [n for n in python if n[-4] != "X" and not (ROOT / n).is_file()] == []


def test_one_number_for_everything() -> None:
    version = jbf.__version__
    assert f'\nversion = "{version}"\n' in text_of("Cargo.toml")
    assert f"\nversion: {version}\n" in text_of("CITATION.cff")


def test_the_changelog_has_a_place_for_what_comes() -> None:
    headings = re.findall(r"^(##+ .*)$", text_of("CHANGELOG.md"), flags=re.MULTILINE)
    assert headings[0] == "## [Unreleased]"
    kinds = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    below = [h.removeprefix("### ") for h in headings if h.startswith("### ")]
    assert set(below) <= kinds
    assert all(
        re.fullmatch(r"## \[[^]]+\]( - \d{4}-\d\d-\d\d)?", h) for h in headings if h[2] == " "
    )


def test_what_is_published_has_what_a_registry_asks_for() -> None:
    asked = ["cargo", "metadata", "--no-deps", "--offline", "--format-version", "1"]
    done = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True, check=True)
    packages = [p for p in json.loads(done.stdout)["packages"] if p["publish"] != []]
    assert {p["name"] for p in packages} == {"jbf-core", "jbf-batch", "jbf-c"}
    for package in packages:
        folder = Path(package["manifest_path"]).parent
        for key in ("description", "license", "repository", "readme", "keywords", "categories"):
            assert package[key], (package["name"], key)
        assert (folder / "LICENSE-MIT").read_text() == text_of("LICENSE-MIT")
        assert (folder / "LICENSE-APACHE").read_text() == text_of("LICENSE-APACHE")
