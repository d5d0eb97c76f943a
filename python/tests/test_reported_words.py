"""What reports say of numbers, and under which heading each effect stands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from jbf.control import TASKS, run
from jbf.diagnosis.result import Diagnosis
from jbf.models import catalogue
from jbf.reporting.catalogue_text import effects_page
from jbf.reporting.control_run_plot import plot_runs
from jbf.reporting.paragraphs import columns
from jbf.reporting.words import times, verdict_sentence


def test_an_error_in_multiples_of_the_noise() -> None:
    assert times(2.58, 2.0) == "1.29 times"
    assert times(0.1, 0.2) == "0.50 times"
    assert times(1.0, 0.0) == "above"


def test_each_effect_stands_under_its_own_stage_and_each_stage_once() -> None:
    pages = catalogue.effects()
    stage, headings, placed = "", [], {}
    for line in effects_page(pages.values()).splitlines():
        if line.startswith("["):
            stage = line.strip("[]")
            headings.append(stage)
        elif line[:3].strip() and line.split()[0] in pages:
            placed[line.split()[0]] = stage
    assert placed == {name: page.stage for name, page in pages.items()}
    assert len(headings) == len(set(headings)) > 2


@pytest.mark.parametrize("effects", [(), ("coulomb_drag",), ("coulomb_drag", "presliding")])
def test_what_remains_is_said_beside_what_is_missing(
    make_diagnosis: Callable[[str], Diagnosis], effects: tuple[str, ...]
) -> None:
    said = verdict_sentence(replace(make_diagnosis("unexplained"), effects=effects))
    assert "omething remains that no effect in the catalogue explains" in said
    assert said.startswith(f"Missing: {' and '.join(effects)}. With" if effects else "Something")
    assert ("With them, the held-out error falls" in said) == (len(effects) == 2)
    assert ("With it, the held-out error falls" in said) == (len(effects) == 1)


def test_a_row_of_another_length_is_no_row_of_a_table() -> None:
    assert columns([("a", "bb"), ("cc", "d")], "<>", indent=1) == [" a   bb", " cc   d"]
    with pytest.raises(ValueError, match="zip"):
        columns([("a", "b"), ("a", "b", "c")], "<<")


def test_the_picture_of_loops_has_every_scheme_and_draws_its_numbers() -> None:
    task = replace(TASKS["velocity sine"], seconds=6.0)
    results = [run(None, scheme, task) for scheme in ("none", "observed")]
    axes = np.array(plot_runs(results).axes).reshape(5, 2)
    for column, result in enumerate(results):
        top = axes[0, column]
        assert top.get_title(loc="left") == result.scheme
        drawn = {line.get_label(): line.get_ydata() for line in top.lines}
        assert np.array_equal(drawn["reference"], result.reference)
        assert np.array_equal(drawn["response"], result.velocity_rad_s)
        friction = {line.get_label() for line in axes[3, column].lines}
        assert ("estimated" in friction) == (result.scheme != "none")
