"""Results at a prompt, in a notebook and as columns: their numbers, to the letter."""

from __future__ import annotations

import sys
from dataclasses import replace
from html.parser import HTMLParser
from textwrap import dedent
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand, fit_by_hand
from jbf import Bootstrap, ParameterValue, TrajectoryFit

FIT = fit_by_hand(["sensor_offset"])
COMPARISON = comparison_by_hand(1.25, (1.0, 1.5))
DIAGNOSIS = diagnosis_by_hand("missing")
BOOTSTRAP = Bootstrap(FIT, {name: np.arange(20.0) for name in FIT.parameters})
TRAJECTORY = TrajectoryFit(
    {"f_m": ParameterValue(0.25, 0.0012), "U_tr_m_s": ParameterValue(0.05)}, 4e-4, 100, 7, True, ""
)
VALUES = "F_c_n 4.988 +/- 0.012, F_s_n held at 6.0000, F_v_n_s_m 20.44 +/- 0.52, "
VALUES += "sensor_offset.b_n -0.250 +/- 0.025"


def test_what_a_prompt_shows() -> None:
    assert repr(FIT) == (
        f"Fit(coulomb + sensor_offset; 2 runs, 1001 samples, RMS 0.525 N;\n    {VALUES})"
    )
    assert repr(replace(FIT, converged=False)).startswith(
        "Fit(coulomb + sensor_offset; 2 runs, 1001 samples, RMS 0.525 N, not converged;"
    )
    assert repr(BOOTSTRAP) == f"Bootstrap(20 fits again;\n    {VALUES})"
    assert repr(TRAJECTORY) == (
        "TrajectoryFit(100 samples;\n    f_m 0.2500 +/- 0.0012, U_tr_m_s 0.050000)"
    )
    assert repr(COMPARISON) == (
        "Comparison(coulomb; 2 runs, RMS 1.25 N, 2.50 times the noise of 0.500 N;\n"
        "    fails along direction)"
    )
    assert repr(DIAGNOSIS) == (
        "Diagnosis(missing: sensor_offset;\n    held out 0.550 N, 1.10 times the noise of 0.500 N)"
    )


class Rows(HTMLParser):
    """The cells of a small table, row by row."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_data(self, data: str) -> None:
        if self.rows:
            self.rows[-1][-1] += data


def test_what_a_notebook_shows() -> None:
    assert Rows(FIT._repr_html_()).rows[1:3] == [
        ["F_c_n", "4.988", "0.012", "0.25 %", "N", ""],
        ["F_s_n", "held at 6.0000", "", "", "N", "held fixed"],
    ]
    assert Rows(COMPARISON._repr_html_()).rows == [
        ["run", "samples", "RMS (N)", "RMS / noise"],
        ["there", "501", "1.00", "2.00"],
        ["back", "500", "1.50", "3.00"],
    ]
    assert Rows(DIAGNOSIS._repr_html_()).rows == [
        ["step", "fit (N)", "held out (N)", "noise (N)", "held out / noise"],
        ["bare law", "2.50", "2.75", "0.500", "5.50"],
        ["+ sensor_offset", "0.525", "0.550", "0.500", "1.10"],
    ]


@pytest.fixture
def columns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames as the dictionaries that they are made of."""
    pandas: Any = ModuleType("pandas")
    pandas.DataFrame = dict
    monkeypatch.setitem(sys.modules, "pandas", pandas)


@pytest.mark.usefixtures("columns")
def test_the_columns_of_a_frame() -> None:
    assert DIAGNOSIS.to_frame() == {
        "effects": ["", "sensor_offset"],
        "rms_n": [2.5, 0.525],
        "holdout_rms_n": [2.75, 0.55],
        "noise_n": [0.5, 0.5],
    }
    found: Any = FIT.to_frame()
    assert found["parameter"] == ["F_c_n", "F_s_n", "F_v_n_s_m", "sensor_offset.b_n"]
    assert found["value"] == [4.9876, 6.0, 20.44, -0.25]
    assert found["unit"] == ["N", "N", "N s/m", "N"]
    assert found["held"] == [False, True, False, False]
    assert found["note"] == ["", "held fixed", "", ""]
    np.testing.assert_array_equal(found["stderr"], [0.0123, np.nan, 0.52, 0.025])


@pytest.mark.usefixtures("columns")
def test_a_frame_of_samples_is_record_model_and_what_is_left() -> None:
    found: Any = COMPARISON.to_frame()
    assert found["run"] == ["there"] * 501 + ["back"] * 501
    np.testing.assert_array_equal(found["residual_n"], found["friction_n"] - found["model_n"])
    # The record has 1 N more in the direction of motion.
    np.testing.assert_allclose(found["residual_n"], np.sign(found["velocity_m_s"]), atol=1e-3)
    assert found["counts"].all()


def test_the_report_of_a_bootstrap_is_its_fits() -> None:
    first, _, rest = BOOTSTRAP.summary().partition("\n")
    assert first == "Errors from 20 fits of simulated records of the same runs"
    assert rest == FIT.summary()


def test_the_report_of_a_fit_to_known_motions() -> None:
    expected = dedent("""\
        [[Fit]]
            samples         = 100
            sum of squares  = 0.000400 (of friction coefficients)
            simulations     = 7
            search          = converged
        [[Parameters]]
            f_m         0.2500  +/- 0.0012  (0.48 %)
            U_tr_m_s  0.050000                        m/s  (no error known)""")
    assert TRAJECTORY.summary() == expected
