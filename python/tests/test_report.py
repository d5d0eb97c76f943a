"""The HTML pages: whole, self-contained, escaped."""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import get_args

import jbf.plot
import numpy as np
import pytest
from jbf import Fit, Run, compare, read_run
from jbf.comparison.bins import Axis
from jbf.diagnosis import Remainder
from jbf.diagnosis.result import Diagnosis
from jbf.errors import InputError
from jbf.reporting import gallery
from jbf.reporting.advice import ADVICE, advice_on
from jbf.reporting.diagnosis_page import diagnosis_page
from jbf.reporting.gallery import failure_cards, remainder_cards
from jbf.reporting.provenance import file_rows, fingerprint
from jbf.reporting.svg import svg

VOID = {"meta", "img", "br", "link"}
LINKS = ("src", "href", "xlink:href")


class Balance(HTMLParser):
    """Collects what is left open, and what the page would fetch."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.pictures = 0
        self.fetched: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        # What begins with a hash is in the page itself.
        self.fetched += [v for k, v in attrs if k in LINKS and v and not v.startswith("#")]
        self.pictures += tag == "svg"
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def checked(page: str) -> Balance:
    balance = Balance()
    balance.feed(page)
    assert balance.open == []
    for address in balance.fetched:
        head, _, data = address.partition(",")
        assert head == "data:image/png;base64"
        assert base64.b64decode(data).startswith(b"\x89PNG")
    assert "url(http" not in page
    assert "@import" not in page.partition("<body>")[0]
    return balance


@pytest.mark.parametrize("verdict", ["adequate", "missing", "ambiguous", "unexplained"])
def test_diagnosis(
    verdict: str, make_diagnosis: Callable[[str], Diagnosis], tmp_path: Path
) -> None:
    diagnosis = make_diagnosis(verdict)
    diagnosis.save_html(tmp_path / "d.html")
    page = (tmp_path / "d.html").read_text()
    assert checked(page).pictures >= 6
    headings = re.findall(r"<h2>(.*?)</h2>", page)
    wanted = ["Where the bare law fails", "What remains", "Friction", "The error falling"]
    wanted += ["What was added"] * bool(diagnosis.effects)
    wanted += ["Parameters of the final model", "What these runs would have shown"]
    wanted += ["Candidates tried", "Each run"]
    wanted += ["What it was made from"]
    assert headings == wanted
    assert f"Diagnosis: {verdict}" in page
    assert ("record a run at twice the load" in page) == (verdict == "ambiguous")
    assert [p.name for p in tmp_path.iterdir()] == ["d.html"]


def test_comparison(bare_fit: Fit, runs: list[Run], tmp_path: Path) -> None:
    comparison = compare(bare_fit.model, runs)
    comparison.report(tmp_path / "c.html")
    page = (tmp_path / "c.html").read_text()
    assert checked(page).pictures == 4
    assert "numpy" in page
    assert all(run.name in page for run in runs)


def test_names_of_runs_cannot_break_the_page(
    bare_fit: Fit, runs: list[Run], tmp_path: Path
) -> None:
    evil = [replace(run, name=f"<script>$x^{{$</script>{i}") for i, run in enumerate(runs)]
    compare(bare_fit.model, evil).save_html(tmp_path / "c.html")
    page = (tmp_path / "c.html").read_text()
    checked(page)
    assert "<script>" not in page
    assert "&lt;script&gt;" in page


def test_no_folder_no_page(bare_fit: Fit, runs: list[Run], tmp_path: Path) -> None:
    with pytest.raises(InputError, match="folder does not exist"):
        compare(bare_fit.model, runs).save_html(tmp_path / "no" / "c.html")


def test_the_ledger_comes_first_and_the_verdict_is_a_sentence(
    make_diagnosis: Callable[[str], Diagnosis],
) -> None:
    page = diagnosis_page(make_diagnosis("missing"), "jbf diagnose 'a rig.toml' runs")
    (headline,) = re.findall(r"<h1>(.*?)</h1>", page)
    assert headline == "Missing: coulomb_drag."
    assert page.index("<h1>") < page.index('id="ledger"') < page.index("<h2>")
    assert "Made by: <code>jbf diagnose &#39;a rig.toml&#39; runs</code>" in page
    remains = diagnosis_page(make_diagnosis("unexplained"))
    assert "<h1>Something remains that no effect in the catalogue explains.</h1>" in remains
    assert "Made by" not in remains


def test_every_candidate_of_every_round_is_on_the_page(
    make_diagnosis: Callable[[str], Diagnosis],
) -> None:
    found = make_diagnosis("missing")
    page = diagnosis_page(found)
    tried = page.partition("<h2>Candidates tried</h2>")[2].partition("<h2>")[0]
    assert re.findall(r"<h3>Beside the (.*?)</h3>", tried) == ["bare law"]
    for trial in found.steps[0].trials:
        assert trial.effect in tried
        assert trial.reason in tried
        assert f"{trial.evidence:.0f}".replace("-", "") in tried


def test_a_failure_says_what_it_came_from_and_what_to_do(
    make_diagnosis: Callable[[str], Diagnosis],
) -> None:
    found = make_diagnosis("missing")
    cards = failure_cards(found)
    assert [card.title for card in cards] == [f"Along {f.axis}" for f in found.failures]
    assert cards[0].cause.startswith("coulomb_drag (")
    assert cards[0].to_do.startswith("Nothing more: with the final model the means fall from")
    (first, *_) = remainder_cards(make_diagnosis("unexplained"))
    assert first.cause.startswith("None in the catalogue. Usually ")
    assert first.to_do == f"{advice_on(found.failures[0].axis).to_do.capitalize()}."


@pytest.mark.parametrize("count", [1, 3])
def test_what_remains_is_drawn_along_where_it_is(
    count: int,
    bare_fit: Fit,
    runs: list[Run],
    make_diagnosis: Callable[[str], Diagnosis],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a recording that is one run, what differs by run is seen in time."""
    after = compare(bare_fit.model, runs[:count])
    drawn = {
        "angle": "Shaft angle (deg)",
        "direction": "Direction of motion",
        "run": "Time (s)" if count == 1 else "Run",
        "frequency": "Frequency (Hz)",
        "stroke": "Time (s)",
    }
    left = tuple(Remainder(axis, "somewhere", 0.3) for axis in drawn)
    monkeypatch.setattr(gallery, "svg", lambda axes, alt: axes[0].get_xlabel())
    found = replace(make_diagnosis("unexplained"), after=after, unexplained=left)
    assert [card.picture for card in remainder_cards(found)] == [*drawn.values()]


def test_every_kind_of_failure_has_advice() -> None:
    axes = set(get_args(Axis)) | {
        "frequency",
        "bursts",
        "way",
        "period",
        "stroke",
        "parameters",
        "effects",
        "unconfirmed",
    }
    assert set(ADVICE) == axes


def test_held_parameters_are_marked(make_diagnosis: Callable[[str], Diagnosis]) -> None:
    found = make_diagnosis("missing")
    held = replace(found.fit.parameters["K0"], held=True, note="never moved", stderr=None)
    told = [name for name, p in found.fit.parameters.items() if not p.held and name != "K0"]
    fit = replace(
        found.fit,
        parameters=found.fit.parameters | {"K0": held},
        correlations=np.eye(len(told)),
    )
    page = diagnosis_page(replace(found, fit=fit))
    assert re.findall(r'<tr class="held"><td class="name">(.*?)</td>', page) == ["K0"]
    assert 'class="held"' not in diagnosis_page(found).partition("</style>")[2]


def test_the_samples_and_their_files_have_hashes(runs: list[Run], tmp_path: Path) -> None:
    assert fingerprint(runs) == fingerprint(list(runs))
    other = replace(runs[0], friction_n=runs[0].friction_n + 1e-9)
    assert fingerprint([other, *runs[1:]]) != fingerprint(runs)
    assert file_rows(runs) == []
    path = tmp_path / "a.csv"
    path.write_text(runs[0].to_csv())
    read = read_run(path)
    whole = hashlib.sha256(path.read_bytes()).hexdigest()
    assert file_rows([read]) == [("a", str(path), whole[:16])]
    path.unlink()
    assert file_rows([read]) == [("a", str(path), "no longer there")]


def test_colours_are_the_pages_and_text_is_text(bare_fit: Fit, runs: list[Run]) -> None:
    drawn = str(svg([jbf.plot.loops(compare(bare_fit.model, runs))], 'of "one" run'))
    assert 'aria-label="of &quot;one&quot; run"' in drawn
    assert "Surface speed (m/s)</text>" in drawn
    assert "var(--model)" in drawn
    assert "#0072b2" not in drawn
    assert "DejaVu" not in drawn
