"""HTML pages: self-contained, escaped, and with the numbers under their headings."""

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import jbf
import pytest
from by_hand import LAW, TRIALS, along, diagnosis_by_hand, fit_by_hand, there_and_back
from jbf.diagnosis.power import Power
from jbf.reporting.diagnosis_page import diagnosis_page
from jbf.reporting.text_pages import bootstrap_page, fit_page, loop_page, trajectory_page
from shared import shared

Table = list[list[str]]
VOID = {"meta", "img", "br", "link"}
LINKS = ("src", "href", "xlink:href")
LEDGER = ("step", "fit RMS (N)", "held-out RMS (N)", "noise (N)", "held-out / noise")


class Page(HTMLParser):
    """Tables, text and plots of a page; checks that every element is closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tables: list[Table] = []
        self.words: list[str] = []
        self.links: list[str] = []
        self.open: list[str] = []
        self.pictures = 0
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        # A link that begins with a hash stays within the page.
        self.links += [v for k, v in attrs if k in LINKS and v and not v.startswith("#")]
        self.pictures += tag == "svg"
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("td", "th"):
            self.tables[-1][-1][-1] += data
        else:
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())

    def below(self, *head: str) -> Table:
        """Rows of the table with these column headings."""
        (matching,) = [table for table in self.tables if table[0] == list(head)]
        return matching[1:]


def diagnosis_of(verdict: str) -> jbf.Diagnosis:
    """A diagnosis of each verdict: `missing` with power, `unexplained` of a rotary drive."""
    diagnosis = diagnosis_by_hand(verdict)
    if verdict == "missing":
        power = (Power("backlash", "gap", "rad", 0.1, 0.13, False, 0.02, 0.1, ()),)
        second = replace(diagnosis.steps[1], trials=TRIALS[2:])
        return replace(
            diagnosis,
            power=power,
            steps=(diagnosis.steps[0], second),
            not_detectable=("running_in",),
        )
    if verdict == "unexplained":
        joint = jbf.Rig(drive=jbf.Drive("rotary", "current", torque_constant_n_m_a=0.5))
        model = replace(diagnosis.fit.model, rig=joint)
        return replace(diagnosis, fit=replace(diagnosis.fit, model=model))
    return diagnosis


@shared  # drawing is slow
def html_of(verdict: str) -> str:
    return diagnosis_page(diagnosis_of(verdict), "jbf diagnose 'a b'")


def page(verdict: str) -> Page:
    return Page(html_of(verdict))


EXTENDED = (pytest.param(v, marks=pytest.mark.extended) for v in ("adequate", "ambiguous"))


@pytest.mark.parametrize("verdict", ["missing", "unexplained", *EXTENDED])
def test_diagnosis_page_has_all_plots_and_no_external_links(verdict: str) -> None:
    text = html_of(verdict)
    found = Page(text)
    # Ledger, two plots of the residual, two of the friction, and a card for each failure.
    assert found.pictures >= 5 + len(diagnosis_of(verdict).failures)
    for link in found.links:
        head, _, data = link.partition(",")
        assert head == "data:image/png;base64"
        assert base64.b64decode(data).startswith(b"\x89PNG")
    assert "url(http" not in text
    assert f"Diagnosis: {verdict}" in text
    assert ("record a rest" in text) == (verdict == "ambiguous")


def test_diagnosis_page_begins_with_the_verdict_and_the_ledger() -> None:
    text = html_of("missing")
    assert re.findall(r"<h1>(.*?)</h1>", text) == ["Missing: sensor_offset."]
    assert text.index("<h1>") < text.index('id="ledger"') < text.index("<h2>")
    assert "<code>jbf diagnose &#39;a b&#39;</code>" in text
    assert "noise floor 0.500 N" in page("missing").text
    assert "2 runs, 20 s in total, 1002 samples" in page("missing").text


def test_diagnosis_page_lists_the_errors_of_each_step_of_the_ledger() -> None:
    bare = ["base law", "2.50", "2.75", "0.500", "5.50"]
    added = ["+ sensor_offset", "0.525", "0.550", "0.500", "1.10"]
    assert page("missing").below(*LEDGER) == [bare, added]
    torques = [cell.replace("(N)", "(N m)") for cell in LEDGER]
    assert page("unexplained").below(*torques) == [bare]


def test_diagnosis_page_has_the_rms_of_each_run_under_bare_law_and_final_model() -> None:
    both = ("run", "samples", "base law (N)", "final model (N)", "final / noise")
    there, back = page("missing").below(*both)
    assert there == ["there", "501", "2.00", "0.450", "0.90"]
    assert back == ["back", "500", "3.00", "0.600", "1.20"]


def test_diagnosis_page_tabulates_candidates_with_a_gain_and_names_the_others() -> None:
    head = ["effect", "RMS (N)", "evidence", "outcome", "reason"]
    rows = next(table for table in page("missing").tables if table[0] == head)[1:]
    assert [row[:4] for row in rows] == [
        ["sensor_offset", "0.525", "+812", "added"],
        ["sensor_drift", "1.50", "+55", "ties"],
        ["inertia", "2.00", "+7", "rejected"],
    ]
    assert re.search(r"No significant gain: sensor_lag\.", page("missing").text)


def test_diagnosis_page_lists_candidates_under_each_step_that_tried_them() -> None:
    headings = re.findall(r"<h3>Added to the (.*?)</h3>", html_of("missing"))
    assert headings == ["base law", "base law + sensor_offset"]
    assert len(re.findall("inertia</td>", html_of("missing"))) == 2


def test_diagnosis_page_has_parameters_correlations_and_the_added_effect() -> None:
    found = page("missing")
    assert found.below("parameter", "value", "standard error", "", "unit", "note") == [
        ["F_c", "4.988", "0.012", "0.25 %", "N", ""],
        ["F_s", "held at 6.0000", "", "", "N", "held fixed"],
        ["F_v", "20.44", "0.52", "2.5 %", "N s/m", ""],
        ["sensor_offset.b", "-0.250", "0.025", "10 %", "N", ""],
    ]
    assert "F_c with F_v -0.90; F_c with sensor_offset.b +0.45" in found.text
    assert "offset of the force sensor" in found.text
    held = re.findall(r'<tr class="held"><td class="name">(.*?)</td>', html_of("missing"))
    assert held == ["F_s"]


def test_diagnosis_page_has_failures_with_their_share_and_description() -> None:
    assert "Along direction 60 % of the mean square" in page("missing").text
    assert "Record above the model." in page("missing").text
    assert "12 % of the mean square" in page("unexplained").text


def test_diagnosis_page_has_detection_limits_undetectable_and_untried_effects() -> None:
    found = page("missing")
    head = ("effect", "detectable from", "of friction", "distinct from", "confounded with")
    assert found.below(*head) == [["backlash", "gap 0.100 m", "2 %", "same", ""]]
    assert re.search(r"[Nn]ot detectable[^.]*\brunning_in\b", found.text)
    assert found.below("name", "reason")[0][0] == "position_ripple"
    assert "the residual has structure above the noise" in page("unexplained").text


def test_diagnosis_page_of_a_rotary_drive_has_the_units_of_the_drive() -> None:
    found = page("unexplained")
    there, back = found.below("run", "samples", "RMS (N m)", "RMS / noise")
    assert there == ["there", "501", "2.00", "4.00"]
    assert back == ["back", "500", "3.00", "6.00"]
    rows = found.below("parameter", "value", "standard error", "", "unit", "note")
    units = {row[0]: row[4] for row in rows}
    assert units == {"F_c": "N m", "F_s": "N m", "F_v": "N m s/rad"}


def test_comparison_page_has_runs_and_failures_and_escapes_run_names(tmp_path: Path) -> None:
    plain = enumerate(there_and_back(along(1.0)))
    runs = [replace(run, name=f"<script>$x^{{$</script>{i}") for i, run in plain]
    compared = jbf.compare(jbf.Model(jbf.Rig(), "coulomb", parameters=LAW), runs)
    compared.save_html(tmp_path / "c.html")
    assert [p.name for p in tmp_path.iterdir()] == ["c.html"]
    text = (tmp_path / "c.html").read_text(encoding="utf-8")
    assert "<script>" not in text
    assert "<script>" not in compared._repr_html_()
    found = Page(text)
    assert found.pictures == 4
    rows = found.below("run", "samples", "RMS (N)", "RMS / noise")
    assert [row[:2] for row in rows] == [[run.name, "501"] for run in runs]
    assert [float(row[2]) for row in rows] == pytest.approx([1.0, 1.0], rel=1e-3)
    failures = found.below("along", "share", "pattern")
    assert [row[0] for row in failures] == [f.axis for f in compared.failures]
    assert failures[0][1] == f"{100 * compared.failures[0].share:.0f} %"


def test_saving_a_page_in_a_missing_folder_is_rejected(tmp_path: Path) -> None:
    with pytest.raises(jbf.InputError, match="folder does not exist"):
        fit_by_hand().save_html(tmp_path / "no" / "c.html")


def test_pages_of_fits_and_loops_have_their_summary_and_one_plot() -> None:
    fit = fit_by_hand()
    bootstrap = jbf.Bootstrap(fit, dict.fromkeys(fit.parameters, fit.residuals[0][:3]))
    trajectory = jbf.TrajectoryFit({"f_m": jbf.ParameterValue(0.25, 0.01)}, 1.0, 2, 3, True, "")
    loop = jbf.control.run(None, "none", replace(jbf.control.TASKS["velocity sine"], seconds=2.1))
    for text, result in (
        (fit_page(fit), fit),
        (bootstrap_page(bootstrap), bootstrap),
        (trajectory_page(trajectory), trajectory),
        (loop_page(loop), loop),
    ):
        found = Page(text)
        assert found.pictures == 1
        assert " ".join(result.summary().split()) in found.text
