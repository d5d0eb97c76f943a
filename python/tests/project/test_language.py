"""Language of the documentation: sentences are short."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PAGES = (
    ROOT / "README.md",
    ROOT / "CHANGELOG.md",
    *sorted(p for p in (ROOT / "docs").rglob("*.md") if "effects" not in p.parts),
)
WORDS, SHARE = 30, 0.03
NO_PROSE = re.compile(
    r"^(`{3,}).*?^\1[ \t]*$|^\$\$.*?^\$\$|<!--.*?-->|^(?:#|\||:::|\[!)[^\n]*$", re.M | re.S
)
LINK = re.compile(r"!?\[((?:[^\[\]]|\[[^\]]*\])*)\]\([^)]*\)")
NEW_BLOCK = re.compile(r"\n\s*\n|\n(?=\s*(?:[-*] |\d+\. ))")
END = re.compile(r"(?<=[.!?])[)*]*\s+(?=[A-Z`*(\[\"'])")


def sentences(text: str) -> Iterator[str]:
    """Sentences of a page in Markdown without code, formulas, headings and tables."""
    text = LINK.sub(r"\1", NO_PROSE.sub("\n\n", text))
    text = re.sub(r"`[^`]*`|\$[^$]*\$", "X", text)
    for block in NEW_BLOCK.split(text):
        if block.strip():
            yield from END.split(" ".join(block.split()))


def long_sentences(text: str) -> tuple[list[str], int]:
    """Sentences of more than `WORDS` words, and the number of all sentences."""
    every = list(sentences(text))
    return [s for s in every if len(re.findall(r"[\w'-]+", s)) > WORDS], len(every)


def test_sentences_are_counted_without_code_tables_and_headings() -> None:
    text = (
        "# A\nOne two. Three `a b c`.\n\n| a | b |\n| --- | --- |\n\n```sh\nx y\n```\n- Four five"
    )
    assert list(sentences(text)) == ["One two.", "Three X.", "- Four five"]


def test_at_most_three_per_cent_of_sentences_have_more_than_thirty_words() -> None:
    counted = {page: long_sentences(page.read_text(encoding="utf-8")) for page in PAGES}
    total = sum(number for _, number in counted.values())
    found = [f"{p.relative_to(ROOT)}: {s}" for p, (long, _) in counted.items() for s in long]
    assert len(found) <= SHARE * total, "\n".join(found)


@pytest.mark.parametrize("page", ["README.md", "docs/index.md", "docs/validation.md"])
def test_pages_that_are_read_first_have_no_sentence_of_more_than_forty_words(page: str) -> None:
    for sentence in sentences((ROOT / page).read_text(encoding="utf-8")):
        assert len(sentence.split()) <= 40, sentence
