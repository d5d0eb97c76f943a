"""The numbers of a page, of JSON and of the pictures: each in the cell whose head names it."""

from __future__ import annotations

from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand
from jbf import Diagnosis

Table = list[list[str]]


class Cells(HTMLParser):
    """The tables of a page as rows of text, the head first; and its plain paragraphs."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: list[Table] = []
        self.text: list[str] = []
        self.cell = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")
            self.cell = True

    def handle_endtag(self, tag: str) -> None:
        if tag in ("td", "th"):
            self.cell = False

    def handle_data(self, data: str) -> None:
        if self.cell:
            self.tables[-1][-1][-1] += data
        else:
            self.text.append(data)


def read(page: Path) -> Cells:
    cells = Cells()
    cells.feed(page.read_text())
    return cells


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Cells]:
    """The page of a diagnosis put together by hand."""
    folder, pages = tmp_path_factory.mktemp("pages"), dict[str, Cells]()

    def make(verdict: str) -> Cells:
        if verdict not in pages:
            diagnosis_by_hand(verdict).report(folder / f"{verdict}.html")
            pages[verdict] = read(folder / f"{verdict}.html")
        return pages[verdict]

    return make


def headed(cells: Cells, *head: str) -> Table:
    """The rows below a head."""
    (found,) = [table for table in cells.tables if table[0] == list(head)]
    return found[1:]


def test_the_ledger_of_the_page(page: Callable[[str], Cells]) -> None:
    head = ("step", "fit (N)", "held out (N)", "noise (N)", "held out / noise")
    assert headed(page("missing"), *head) == [
        ["bare law", "2.50", "2.75", "0.500", "5.50"],
        ["+ sensor_offset", "0.525", "0.550", "0.500", "1.10"],
    ]
    assert headed(page("unexplained"), *head) == [["bare law", "2.50", "2.75", "0.500", "5.50"]]


def test_the_bare_law_and_the_final_model_of_the_page(page: Callable[[str], Cells]) -> None:
    head = ("run", "samples", "bare law (N)", "final model (N)", "final / noise")
    assert headed(page("missing"), *head) == [
        ["there", "501", "2.00", "0.450", "0.90"],
        ["back", "500", "3.00", "0.600", "1.20"],
    ]
    assert headed(page("unexplained"), "run", "samples", "RMS (N)", "RMS / noise") == [
        ["there", "501", "2.00", "4.00"],
        ["back", "500", "3.00", "6.00"],
    ]


def test_the_candidates_of_the_page(page: Callable[[str], Cells]) -> None:
    head = ("effect", "RMS (N)", "evidence", "outcome", "why")
    rows = headed(page("missing"), *head)
    assert rows[0] == ["sensor_offset", "0.525", "+812", "added", "largest evidence"]
    assert "sensor_lag" not in {row[0] for row in rows}
    (said,) = {t for t in page("missing").text if "no more than chance would" in t}
    assert said == "The others gain no more than chance would: sensor_lag."


def test_the_parameters_of_the_page(page: Callable[[str], Cells]) -> None:
    head = ("parameter", "value", "standard error", "", "unit", "note")
    assert headed(page("missing"), *head) == [
        ["F_c_n", "4.988", "0.012", "0.25 %", "N", ""],
        ["F_s_n", "held at 6.0000", "", "", "N", "held fixed"],
        ["F_v_n_s_m", "20.44", "0.52", "2.5 %", "N s/m", ""],
        ["sensor_offset.b_n", "-0.250", "0.025", "10 %", "N", ""],
    ]
    (said,) = [t for t in page("missing").text if t.startswith("Strongest correlations")]
    assert said == (
        "Strongest correlations: F_c_n with F_v_n_s_m -0.90; F_c_n with sensor_offset.b_n +0.45."
    )


def test_patterns_and_sentences_of_the_page(page: Callable[[str], Cells]) -> None:
    text = " ".join(" ".join(page("missing").text).split())
    assert "Along direction 60 % of the mean square" in text
    assert "What it looks like Record above the model. Where it comes from" in text
    assert (
        "Missing: sensor_offset. With it, the held-out error falls from 2.75 N to 0.550 N, "
        "1.10 times the noise of 0.500 N." in text
    )
    assert "2 runs of 20 s in all, 1002 samples" in text
    assert "record a rest" in " ".join(page("ambiguous").text)


def test_the_page_of_a_comparison(tmp_path: Path) -> None:
    comparison_by_hand(1.25, (1.0, 1.5)).report(tmp_path / "c.html")
    cells = read(tmp_path / "c.html")
    assert headed(cells, "run", "samples", "RMS (N)", "RMS / noise") == [
        ["there", "501", "1.00", "2.00"],
        ["back", "500", "1.50", "3.00"],
    ]
    assert "RMS 1.25 N against a noise floor of 0.500 N: 2.50 times" in " ".join(cells.text)


# ---- JSON -------------------------------------------------------------------------------------


def without(found: dict[str, Any], *keys: str) -> dict[str, Any]:
    return {key: value for key, value in found.items() if key not in keys}


def test_the_dictionary_of_a_diagnosis() -> None:
    found = diagnosis_by_hand("missing").to_dict()
    first, last = found["steps"]
    assert without(first, "tried") == {
        "effects": [],
        "rms_n": 2.5,
        "holdout_rms_n": 2.75,
        "noise_n": 0.5,
    }
    assert last == {
        "effects": ["sensor_offset"],
        "rms_n": 0.525,
        "holdout_rms_n": 0.55,
        "noise_n": 0.5,
        "tried": [],
    }
    assert first["tried"][0] == {
        "effect": "sensor_offset",
        "rms_n": 0.525,
        "evidence": 812.4,
        "outcome": "added",
        "reason": "largest evidence",
    }
    assert found["parameters"]["F_c_n"] == {"value": 4.9876, "stderr": 0.0123, "note": None}
    assert found["parameters"]["F_s_n"] == {"value": 6.0, "held": True, "note": "held fixed"}
    assert found["failures"] == [
        {"axis": "direction", "where": "record above the model", "share": 0.6}
    ]
    tied = diagnosis_by_hand("ambiguous").to_dict()
    assert tied["alternatives"] == {"sensor_offset": ["sensor_drift"]}
    assert tied["next_experiment"] == "record a rest"
    assert diagnosis_by_hand("adequate").to_dict()["unseen"] == ["backlash"]


def test_the_dictionary_of_a_comparison() -> None:
    assert comparison_by_hand(1.25, (1.0, 1.5)).to_dict() == {
        "rms_n": 1.25,
        "noise_n": 0.5,
        "runs": [
            {"run": "there", "rms_n": 1.0, "samples": 501},
            {"run": "back", "rms_n": 1.5, "samples": 500},
        ],
        "failures": [{"axis": "direction", "where": "record above the model", "share": 0.6}],
        "findings": [],
    }


# ---- pictures ---------------------------------------------------------------------------------


def test_the_error_falling_is_drawn_as_it_is_written() -> None:
    diagnosis: Diagnosis = diagnosis_by_hand("missing")
    falling = diagnosis.plot()[0]
    drawn = {
        str(line.get_label()): np.asarray(line.get_xdata(), dtype=float).tolist()
        for line in falling.lines
    }
    assert drawn["fit"] == [2.5, 0.525]
    assert drawn["held out"] == [2.75, 0.55]
    assert drawn["noise floor"] == [0.5, 0.5]
    assert falling.get_xscale() == "log"
    assert [t.get_text() for t in falling.texts] == ["2.75 N", "0.550 N  (−80 %)"]


def test_the_means_of_a_pattern_are_drawn_above_zero_where_the_record_is() -> None:
    right = comparison_by_hand(1.25, (1.0, 1.5)).plot()[1]
    means = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in right.lines])
    # v < 0 first: there the record is 1 N below, in the direction of motion 1 N above.
    ticks = [tick.get_text() for tick in right.get_xticklabels()]
    assert ticks == ["v < 0", "v > 0"]
    assert means[np.abs(means) > 0.9].tolist() == pytest.approx([-1.0, 1.0], abs=1e-6)
