"""Parts of texts and pages: paragraphs, embedded plots, provenance."""

import hashlib
import re
from dataclasses import replace
from pathlib import Path

import pytest
from by_hand import coulomb, one_way
from jbf import Run, read_run
from jbf.plot.style import BEFORE, INK, MEASURED, MODEL, NOISE, OTHER
from jbf.reporting.page import PACKAGES, page
from jbf.reporting.paragraphs import hanging
from jbf.reporting.provenance import file_rows, fingerprint
from jbf.reporting.svg import svg
from matplotlib.figure import Figure


@pytest.mark.parametrize("together", ["v < 0", "v >= 0.25 m/s", "0.25 N", "3 N m", "10 deg", "2 s"])
def test_wrapped_text_never_separates_a_number_from_its_unit(together: str) -> None:
    for filling in range(60, 95):
        lines = hanging("", f"{'x' * filling} {together} y", 0)
        assert any(together in line for line in lines)
        assert "\0" not in "".join(lines)


def drawing(colours: tuple[str, ...]) -> str:
    """SVG text of a plot with a line of each colour."""
    ax = Figure(figsize=(2.0, 1.0)).subplots()
    for i, colour in enumerate(colours):
        ax.plot([0, 1], [i, i], color=colour)
    ax.set_title("A <title>")
    return str(svg([ax], 'two & "more"'))


def test_style_colours_of_a_plot_become_css_variables_of_the_page() -> None:
    names = {MODEL: "model", BEFORE: "before", NOISE: "noise"}
    names |= {MEASURED: "measured", OTHER: "other", INK: "ink"}
    text = drawing((*names, "#123456"))
    for colour, name in names.items():
        assert f"var(--{name})" in text
        assert colour not in text
    assert "#123456" in text
    assert re.search(r"font[^;\"]*var\(--face\)", text)
    assert "A &lt;title&gt;</text>" in text


def test_embedded_plot_is_reproducible_and_has_neither_fixed_size_nor_date() -> None:
    """The view box is that of the figure in points."""
    text = drawing((MODEL,))
    assert text == drawing((MODEL,))
    head = text.partition(">")[0]
    assert 'viewBox="0 0 144 72"' in head
    assert not re.search("width|height", head)
    assert 'role="img" aria-label="two &amp; &quot;more&quot;"' in head
    assert "<dc:date>" not in text


def test_page_states_packages_date_and_command_and_escapes_html() -> None:
    text = page("text.html.j2", "A <title>", command="jbf <x>", words="1 < 2", picture="")
    for shown in ("A &lt;title&gt;", "jbf &lt;x&gt;", "1 &lt; 2", *PACKAGES):
        assert shown in text
    assert re.search(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC", text)


def run_of(name: str, more: float = 0.0) -> Run:
    return one_way(name, lambda t, v, a: coulomb(t, v, a) + more, duration_s=1.0)


def test_fingerprint_is_the_hash_of_names_and_samples_in_their_order() -> None:
    """SHA-256 of the name of each run, and of name and little-endian numbers of each column."""
    run, other = run_of("a"), run_of("b")
    digest = hashlib.sha256(b"a")
    for name, values in run.columns().items():
        digest.update(name.encode() + values.astype("<f8").tobytes())
    assert fingerprint([run]) == digest.hexdigest()
    cases = ([run, other], [other, run], [run], [run_of("a", 1e-9)], [])
    assert len({fingerprint(case) for case in cases}) == len(cases)


def test_file_of_a_run_is_listed_with_its_hash_or_as_missing(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(run_of("a").to_csv())
    run = read_run(path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    assert file_rows([run_of("x"), run]) == [("a", str(path), digest[:16])]
    path.unlink()
    assert file_rows([replace(run, name="b")]) == [("b", str(path), "no longer present")]
