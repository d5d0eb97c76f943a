"""Tests that code blocks of every page have the shown output, and relative links lead to files."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from pages import LINK, ROOT, Block, blocks, every_page, name_of, prose
from snippets import PROSE, Reader, Wrong, compare, missing

SITE = Path(__file__).resolve().parents[1]
WITH_CODE = [
    page
    for page in every_page()
    if any(b.language not in PROSE for b in blocks(page.read_text(encoding="utf-8")))
]


@pytest.mark.parametrize("page", WITH_CODE, ids=name_of)
def test_code_blocks_of_a_page_print_the_output_shown_below_them(page: Path) -> None:
    unavailable = missing(page)
    if unavailable:
        pytest.skip(f"{name_of(page)} needs {', '.join(unavailable)}")
    command = [sys.executable, str(SITE / "snippets.py"), str(page)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("page", every_page(), ids=name_of)
def test_relative_links_of_a_page_lead_to_existing_files(page: Path) -> None:
    for match in LINK.finditer(prose(page.read_text(encoding="utf-8"))):
        target = match["target"].partition("#")[0]
        if target and ":" not in target:
            assert (page.parent / target).exists(), target


def test_snippet_reader_refuses_wrong_output_failing_commands_and_untested_code(
    tmp_path: Path,
) -> None:
    reader = Reader(tmp_path)
    reader.follow(Block("python", "", "print('one')\nprint('two words')\n", 1))
    reader.follow(Block("output", "", "one\ntwo  words\n", 1))
    with pytest.raises(Wrong, match="not printed"):
        reader.follow(Block("output", "", "two words\none\n", 1))
    with pytest.raises(Wrong, match="ended with 3"):
        reader.follow(Block("sh", "", "exit 3\n", 1))
    with pytest.raises(Wrong, match="neither run"):
        reader.follow(Block("rust", "", "fn main() {}\n", 1))
    with pytest.raises(Wrong, match="no reason"):
        reader.follow(Block("sh", "", "reboot\n", 1, "not tested: no"))
    with pytest.raises(Wrong, match="none before"):
        Reader(tmp_path).follow(Block("output", "", "one\n", 1))


def test_shell_blocks_import_the_source_of_this_repository(tmp_path: Path) -> None:
    reader = Reader(tmp_path)
    reader.follow(Block("sh", "", 'python -c "import jbf; print(jbf.__file__)"\n', 1))
    reader.follow(Block("output", "", f"{ROOT / 'python' / 'jbf' / '__init__.py'}\n", 1))
    reader.follow(Block("sh", "", "jbf --version\n", 1))
    reader.follow(Block("output", "", "jbf ...\n", 1))


def test_snippet_reader_writes_files_and_changes_folders(tmp_path: Path) -> None:
    reader = Reader(tmp_path)
    reader.follow(Block("toml", "a/b.toml", "x = 1\n", 1))
    reader.follow(Block("sh", "", "cd a\n", 1))
    reader.follow(Block("sh", "", "cat b.toml\n", 1))
    reader.follow(Block("output", "", "x = ...\n", 1))


def test_snippet_reader_skips_a_block_below_a_comment_that_marks_it_as_not_tested(
    tmp_path: Path,
) -> None:
    text = "<!-- not tested: it would fail here -->\n```sh\nfalse\n```\n\n```sh\ntrue\n```\n"
    marked, plain = blocks(text)
    assert (marked.note, plain.note) == ("not tested: it would fail here", "")
    reader = Reader(tmp_path)
    reader.follow(marked)
    reader.follow(plain)


def test_dots_in_the_shown_output_match_omitted_lines_and_words() -> None:
    compare("a\n...\nd 1 ... 3\n", "a\nb\nc\nd 1 2 3\n")
    with pytest.raises(Wrong):
        compare("d 1 ... 4\n", "d 1 2 3\n")


def test_missing_programs_that_a_page_needs_are_listed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("<!-- needs: sh no-such-program thumb-no-target -->\n")
    assert missing(page) == ["no-such-program", "thumb-no-target"]
