"""What all results share: verbs, short reprs, small tables, parameters by name."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import jbf
import numpy as np
import pytest
from jbf import Fit, InputError, Rig, Run, control
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.bootstrap import Bootstrap
from jbf.reporting.json import json_text
from jbf.results import Result

Make = Callable[[str], Diagnosis]


@pytest.fixture(scope="module")
def results(full_fit: Fit, make_diagnosis: Make, runs: list[Run], rig: Rig) -> dict[str, Result]:
    """One result of each kind."""
    random = np.random.default_rng(1)
    answers = {n: random.normal(p.value, p.stderr, 20) for n, p in full_fit.parameters.items()}
    task = control.Task("velocity", "sine", -5.0, 5.0, 2.0, seconds=2.0)
    time = np.arange(0.0, 10.0, 0.05)
    sine = (0.1, 2.0, 0.0)
    law = {"f_m": 0.26, "U_tr_m_s": 0.055, "K0": 6.5e5, "gamma": 33.0}
    friction = jbf.trajectory(rig, law, time, sine=sine).friction_coefficient
    return {
        "fit": full_fit,
        "bootstrap": Bootstrap(full_fit, answers),
        "trajectory fit": jbf.fit_trajectories(
            rig, [(time, sine)], [friction + random.normal(0.0, 0.001, len(time))], start=law
        ),
        "comparison": jbf.compare(full_fit.model, runs),
        "diagnosis": make_diagnosis("ambiguous"),
        "loop": control.run(None, "observed", task),
    }


KINDS = ("fit", "bootstrap", "trajectory fit", "comparison", "diagnosis", "loop")


@pytest.mark.parametrize("kind", KINDS)
def test_every_result_has_every_verb(
    kind: str, results: dict[str, Result], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = results[kind]
    assert result.summary()
    for ax in result.plot():
        assert ax.lines or ax.collections or ax.patches
    json.loads(json_text(result.to_dict()))
    result.save_html(tmp_path / "a.html")
    assert "<svg" in (tmp_path / "a.html").read_text()
    assert 20 < len(repr(result)) < 300
    assert result._repr_html_().count("<table>") == 1

    pandas = ModuleType("pandas")
    pandas.DataFrame = dict  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    columns: dict[str, Sequence[Any]] = result.to_frame()
    assert len({len(values) for values in columns.values()}) == 1


def test_a_frame_without_pandas_says_what_to_install(
    full_fit: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InputError, match="pip install pandas"):
        full_fit.to_frame()


def test_parameters_are_found_by_full_and_by_short_name(full_fit: Fit) -> None:
    assert full_fit["coulomb_drag.F_d"] is full_fit.parameters["coulomb_drag.F_d_n"]
    assert full_fit["f_m"].value == full_fit.values["f_m"]
    assert full_fit.stderr["f_m"] == full_fit.parameters["f_m"].stderr
    assert "U_tr" in full_fit
    assert "gam" not in full_fit
    assert list(full_fit) == list(full_fit.parameters)
    with pytest.raises(InputError, match='did you mean "f_m"'):
        full_fit["f_n"]


def test_the_words_of_the_short_reprs(results: dict[str, Result]) -> None:
    assert repr(results["fit"]).startswith("Fit(journal + coulomb_drag; 3 runs, ")
    assert " the noise of " in repr(results["comparison"])
    assert repr(results["diagnosis"]).startswith("Diagnosis(ambiguous: coulomb_drag;")
    assert "f_m 0.26" in repr(results["trajectory fit"])


def test_the_longest_model_has_a_short_repr(full_fit: Fit) -> None:
    effects = [e.name for e in jbf.effects().values() if "journal" not in e.refused]
    model = jbf.Model(full_fit.model.rig, effects=effects)
    assert len(repr(model)) < 300
    named = {"parameters": dict(model.parameters), "correlations": np.eye(len(model.parameters))}
    fit = jbf.Fit(**{**vars(full_fit), "model": model, **named})
    assert len(repr(fit)) < 300
    assert len(repr(jbf.effects()["presliding"])) < 300


def test_the_catalogue_is_a_mapping_shown_as_a_table() -> None:
    for pages in (jbf.effects(), jbf.laws()):
        assert isinstance(pages, dict)
        lines = repr(pages).splitlines()
        assert [line.split()[0] for line in lines] == list(pages)
        assert max(map(len, lines)) < 90


def test_a_table_escapes_what_users_name(bare_fit: Fit, runs: list[Run]) -> None:
    from dataclasses import replace

    evil = [replace(runs[0], name="<script>")]
    assert "<script>" not in jbf.compare(bare_fit.model, evil)._repr_html_()


def test_words_of_a_result_need_no_matplotlib() -> None:
    code = "import jbf.reporting.door, sys; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_jbf_itself_imports_neither_scipy_nor_matplotlib() -> None:
    code = "import jbf, sys; sys.exit(bool({'scipy', 'matplotlib', 'jinja2'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_picture_of_a_fit_shows_its_residuals_and_its_errors(full_fit: Fit) -> None:
    left, right = full_fit.plot()
    shown = np.concatenate([np.asarray(line.get_ydata()) for line in right.lines[:-1]])
    np.testing.assert_array_equal(shown, np.concatenate(full_fit.residuals))
    labels = [t.get_text() for t in left.get_yticklabels()]
    value = full_fit.parameters["f_m"].value
    name, shown_value, sign, _ = labels[0].split()
    assert (name, sign) == ("f_m", "±")
    assert float(shown_value) == pytest.approx(value, rel=1e-4)
    assert len(labels) == len(left.containers) == len(full_fit.parameters)
