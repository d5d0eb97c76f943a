"""Language of documentation, docstrings and comments: short sentences, established terms."""

import ast
import io
import re
import tokenize
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


INSTEAD = {
    r"(?:^|[.;:] )Of (?:an?|the|each|all|what|which|it|one|no)\b": "begin with the subject",
    r"(?:^|[.;:] )What (?!(?:is|are|if|to|do|does|can|happens)\b)[a-z]+\b(?![^.]*\?)": (
        "begin with a noun"
    ),
    r"(?:^|[.;] )The same (?:of|for|as)\b": "state the thing itself",
    r"(?<!here )\b(?:is|are|was|were) no(?:ne)?\b(?! (?:longer|more|less|better))": "is not a ...",
    r"\b(?:told|tells?|said|says?|asked|asks|speaks?)\b": "reported, states, requires, returns",
    r"\bbeside\b": "next to, in addition to, together with",
    r"\bso (?:many|much|long)\b(?! as| that)": "the number",
    r"\bstands?\b(?! for| still)": "is",
    r"\b(?:leaves?|left) (?:less|more|most|least|as little)\b": "residual",
    r"\bwhat (?:remains|is left|no effect explains)\b": "residual, residual structure",
    r"\bruns? left out\b|\bleft-out\b": "held-out",
    r"\bprices?\b": "threshold",
    r"\bimperfections?\b": "artefact margin",
    r"\bindifference\b": "minimum effect size",
    r"\blateness(?:es)?\b": "delay",
    r"\bfar off\b": "outlier",
    r"\buneven noise\b": "heteroscedastic noise",
    r"\bcoarse steps\b": "coarse quantisation",
    r"\bunsettled\b": "initial-state transient",
    r"\binertia[- ]leak\b|\bwear-in\b": "inertia, running-in",
    r"\b\d+ of 100\b": "percent",
    r"\b(?:rooms|houses?|doors?)\b": "package, path, entry point",
    r"\b(?:by lot|strangers?|felt|torn off)\b": "at random, user, reaction, removed",
}
"""Expressions, and the terms that replace them."""
OTHER_TEXTS = ("CODE_OF_CONDUCT.md", "THIRD_PARTY.md")
"""Rules of conduct and quoted licences."""
GENERATED = ("docs/effects/", "docs/reference/")
"""Pages that repeat strings of the core, the policy and the command line."""
CODE = ("python", "simulator", "benches", "docs", "examples", "release")
NO_TEXT = re.compile(r"^(`{3,}).*?^\1[ \t]*$|^\$\$.*?^\$\$|<!--.*?-->", re.M | re.S)
NAMES = re.compile(r"^[ \t]*(?:\w+(?:, \w+)*|\w+ : [^\n.]+)[ \t]*$", re.M)
RUST_COMMENT = re.compile(r"(?:(?:^|(?<=\n))[ \t]*//[^\n]*\n?)+|(?<=[;{},]) +//[^\n]*\n")


def python_prose(source: str) -> Iterator[str]:
    """Comments and docstrings, without lines that name parameters and without quoted code."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.string.lstrip("# ")
    for node in ast.walk(ast.parse(source)):
        is_constant = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        value = node.value.value if is_constant else None
        if isinstance(value, str):
            yield NAMES.sub("", value)


def rust_prose(source: str) -> Iterator[str]:
    """Blocks of comments."""
    for block in RUST_COMMENT.findall(source):
        yield re.sub(r"^[ \t]*//[/!]? ?", "", block, flags=re.M)


def markdown_prose(source: str) -> Iterator[str]:
    """Paragraphs, headings and tables of a page without code and formulas."""
    yield from re.split(r"\n\s*\n|\n(?=#|\|)", LINK.sub(r"\1", NO_TEXT.sub("", source)))


def expressions(text: str) -> Iterator[tuple[str, str]]:
    """Each listed expression in a text, with the terms that replace it."""
    text = " ".join(re.sub(r"`[^`]*`|\$[^$]*\$", "X", text).split())
    for pattern, instead in INSTEAD.items():
        for match in re.finditer(pattern, text):
            yield match[0].strip(" .;:"), instead


def test_expressions_are_found_in_docstrings_comments_and_text_but_not_in_code() -> None:
    python = '"""Doc.\n\nbeside\n    A file that stands beside `said`."""\nsaid = 1  # told\n'
    rust = "/// Of a film, the\n/// price.\nlet told = 1;\n"
    page = "# What friction costs\n\n```sh\nsaid\n```\n| so many | `told` |\n"
    found = [
        [words for text in prose(source) for words, _ in expressions(text)]
        for prose, source in (
            (python_prose, python), (rust_prose, rust), (markdown_prose, page),
        )
    ]  # fmt: skip
    assert found == [["told", "beside", "stands"], ["Of a", "price"], ["so many"]]


def test_documents_and_comments_use_the_terms_of_the_glossary() -> None:
    files = [*ROOT.glob("*.md"), *ROOT.glob("crates/**/*.rs"), *ROOT.glob("crates/**/*.md")]
    files += [
        p for folder in CODE for e in ("py", "md", "rs") for p in (ROOT / folder).rglob(f"*.{e}")
    ]
    prose = {".py": python_prose, ".rs": rust_prose, ".md": markdown_prose}
    found: list[str] = []
    for path in files:
        name = path.relative_to(ROOT).as_posix()
        if name in OTHER_TEXTS or "/target/" in name or name.startswith(GENERATED):
            continue
        for text in prose[path.suffix](path.read_text(encoding="utf-8")):
            found += [f"{name}: {words} -> {instead}" for words, instead in expressions(text)]
    assert not found, "\n".join(found)
