"""Single pictures: on the axes given, with the units of the rig, of the numbers that are there."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf
import jbf.plot
import numpy as np
import pytest
from by_hand import LAW, coulomb, four_runs
from jbf import Comparison, Fit, InputError, Model, Rig, Run, compare, control
from jbf.comparison.parts import added_by, beside_friction, friction_alone, made_of
from jbf.diagnosis.power import Power
from jbf.diagnosis.result import Diagnosis
from jbf.plot.power import deviate
from jbf.plot.style import BEFORE, MEASURED, MODEL, NOISE, OTHER, one_axes
from matplotlib.axes import Axes
from matplotlib.figure import Figure

FOLDER = Path(jbf.plot.__file__).parent
SHOWN = Power("backlash", "gap_rad", "rad", 0.1, 0.13, False, 0.02, 0.1, ())


@pytest.fixture(scope="module")
def found(make_diagnosis: Callable[[str], Diagnosis]) -> Diagnosis:
    return replace(make_diagnosis("missing"), power=(SHOWN,))


@pytest.fixture(scope="module")
def loop() -> control.Result:
    return control.run(None, "observed", control.TASKS["velocity sine"])


def drawings(found: Diagnosis, loop: control.Result) -> dict[str, Callable[[Axes | None], Axes]]:
    plot = jbf.plot
    return {
        "ledger": lambda ax: plot.ledger(found, ax=ax),
        "ranking": lambda ax: plot.ranking(found, ax=ax),
        "power": lambda ax: plot.power(found, ax=ax),
        "parameters": lambda ax: plot.parameters(found.fit, ax=ax),
        "loops": lambda ax: plot.loops(found.after, ax=ax),
        "stribeck": lambda ax: plot.stribeck(found.after, ax=ax),
        "friction_map": lambda ax: plot.friction_map(found.after, ax=ax),
        "record_and_model": lambda ax: plot.record_and_model(found.before, ax=ax),
        "residual_in_time": lambda ax: plot.residual_in_time(found.before, ax=ax),
        "residual_along": lambda ax: plot.residual_along(found.before, ax=ax),
        "residual_map": lambda ax: plot.residual_map(found.before, ax=ax),
        "residuals_in_a_row": lambda ax: plot.residuals_in_a_row(found.fit, ax=ax),
        "spectrum": lambda ax: plot.spectrum(found.before, ax=ax),
        "control_trace": lambda ax: plot.control_trace(loop, "error", ax=ax),
    }


def test_every_function_draws_where_it_is_told_and_is_on_the_page(
    found: Diagnosis, loop: control.Result, tmp_path: Path
) -> None:
    drawn = drawings(found, loop)
    assert {*drawn, "save"} == set(jbf.plot.__all__)
    for name, draw in drawn.items():
        given = Figure().subplots()
        assert draw(given) is given, name
        ax = draw(None)
        assert ax.figure is not given.figure
        assert ax.get_xlabel() + ax.get_ylabel(), name
        assert ax.get_title(loc="left"), name
        jbf.plot.save(ax, tmp_path / f"{name}.svg")
        assert "<text" in (tmp_path / f"{name}.svg").read_text()
    page = FOLDER.parents[2] / "docs" / "pictures.md"
    if page.is_file():
        text = page.read_text()
        for name in drawn:
            assert f"`{name}(" in text
            assert (page.parent / "images" / "plot" / f"{name}.svg").is_file()


def test_matplotlib_comes_with_the_first_picture() -> None:
    code = "import jbf.plot, sys; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
    for path in FOLDER.glob("*.py"):
        for node in ast.parse(path.read_text()).body:
            named = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            named += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not [n for n in named if n.startswith("matplotlib")], path.name


def test_colours_differ_for_people_who_confuse_red_and_green() -> None:
    """Vienot's projection of the colours as a deuteranope sees them: no two are alike."""

    def least(*colours: str) -> float:
        seen = np.array([[0.293, 0.707, 0.0], [0.293, 0.707, 0.0], [-0.022, 0.022, 1.0]])
        rgb = np.array([[int(c[i : i + 2], 16) / 255.0 for i in (1, 3, 5)] for c in colours])
        places = rgb**2.2 @ seen.T
        return min(float(np.linalg.norm(a - b)) for i, a in enumerate(places) for b in places[:i])

    assert least(MEASURED, MODEL, BEFORE, NOISE, OTHER) > 0.08
    assert least("#8c6d00", "#5f8c00") < 0.08  # two that look alike to them


def test_a_power_curve_goes_through_what_is_known() -> None:
    from scipy.special import ndtr

    shares = np.array([0.02, 0.02 * 1.3])
    assert ndtr(deviate(SHOWN, shares)) == pytest.approx([0.80, 0.95])
    with pytest.raises(InputError, match="no power is known"):
        jbf.plot.power(_with_power(replace(SHOWN, found_80=None)))


def _with_power(one: Power) -> Any:
    class Told:
        power = (one,)

    return Told()


def test_the_ranking_shows_evidence_as_it_is(found: Diagnosis) -> None:
    ax = jbf.plot.ranking(found)
    assert [bar.get_width() for bar in ax.patches] == [812.4, 55.0, -6.1]
    assert [t.get_text() for t in ax.get_yticklabels()] == [
        "coulomb_drag", "presliding", "sensor_lag",
    ]  # fmt: skip
    with pytest.raises(InputError, match="nothing was tried at step 1"):
        jbf.plot.ranking(found, 1)
    with pytest.raises(InputError, match="there is no step 7"):
        jbf.plot.ranking(found, 7)


def test_a_map_of_residuals_has_their_means(found: Diagnosis) -> None:
    before = found.before
    ax = jbf.plot.residual_map(before, "time", "run")
    (mesh,) = ax.collections
    cells = np.asarray(np.ma.filled(mesh.get_array(), np.nan)).reshape(len(before.runs), -1)
    first = before.samples.counted[0]
    time = before.campaign.prepared[0].run.time_s
    edges = np.linspace(*ax.get_xlim(), cells.shape[1] + 1)
    at = np.clip(np.digitize(time, edges) - 1, 0, cells.shape[1] - 1)
    cell = int(at[first][len(at[first]) // 2])
    mean = before.residuals[0][first & (at == cell)].mean() / before.noise_n
    assert cells[0, cell] == pytest.approx(mean, abs=0.35)
    with pytest.raises(InputError, match="not over nothing"):
        jbf.plot.residual_map(before, "nothing")  # type: ignore[arg-type]


def test_a_spectrum_shows_a_hum_where_it_is(full_fit: Fit, runs: list[Run]) -> None:
    hum = 3.0 * np.sin(2.0 * np.pi * 7.0 * runs[0].time_s)
    loud = replace(runs[0], friction_n=runs[0].friction_n + hum)
    ax = jbf.plot.spectrum(compare(full_fit.model, [loud]))
    line = ax.lines[0]
    x, y = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert x[np.argmax(y)] == pytest.approx(7.0, abs=0.3)


def with_inertia(runs: list[Run], fitted: Fit) -> tuple[Comparison, Comparison]:
    """A comparison of the model, and of the model with a mass of 40 kg."""
    model = fitted.model
    values = {**model.parameters, "inertia_leak.m_e_kg": 40.0}
    heavy = jbf.Model(model.rig, model.law, (*model.effects, "inertia_leak"), values, model.clock)
    return compare(model, runs), compare(heavy, runs)


def test_what_is_no_friction_is_taken_out(full_fit: Fit, runs: list[Run]) -> None:
    light, heavy = with_inertia(runs, full_fit)
    assert beside_friction(light) == ()
    assert beside_friction(heavy) == ("inertia_leak",)
    for i, p in enumerate(heavy.campaign.prepared):
        mass = 40.0 * p.motion.acceleration_m_s2
        (added, alone) = added_by(heavy, ["inertia_leak"])[i], friction_alone(heavy)[i]
        assert np.corrcoef(added, mass)[0, 1] > 0.99
        assert alone == pytest.approx(p.friction_n - added)
        assert friction_alone(light)[i] == pytest.approx(p.friction_n)


def test_a_failure_is_made_of_the_effect_that_was_missing(found: Diagnosis) -> None:
    """What the drag says of the residual that the law alone left is that residual, less noise."""
    (name, parts), *more = made_of(found.before, found.after).items()
    assert (name, more) == ("coulomb_drag", [])
    left = found.before.samples.flat(found.before.residuals)
    said = found.before.samples.flat(parts)
    assert float(said @ left) / float(said @ said) == pytest.approx(1.0, abs=0.15)


def test_a_parameter_that_shows_nowhere_takes_no_part() -> None:
    """How fast a warming goes that changes nothing: what an offset says is still the offset."""
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 0.5, noise_n=0.01)
    idle = {"F_s_n": 6.0, **LAW, "warm_up.a": 0.0, "warm_up.tau_s": 30.0}
    before, after = (
        Model(Rig(), "coulomb", effects=["warm_up", *more], parameters=idle | values)
        for more, values in (((), {}), (("sensor_offset",), {"sensor_offset.b_n": 0.5}))
    )
    (parts,) = made_of(compare(before, runs), compare(after, runs)).values()
    for part, run in zip(parts, runs, strict=True):
        assert len(part) == len(run)
        assert np.mean(part) == pytest.approx(0.5, rel=0.05)


def test_a_kind_of_picture_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"name a \.png, \.svg or \.pdf"):
        jbf.plot.save(one_axes(None), tmp_path / "a.nonsense")


def test_traces_of_the_loop(loop: control.Result) -> None:
    line = jbf.plot.control_trace(loop).lines[1]
    assert np.asarray(line.get_ydata())[0] == loop.response[0]
    with pytest.raises(InputError, match="there is no trace speed"):
        jbf.plot.control_trace(loop, "speed")  # type: ignore[arg-type]


def test_models_runs_fits_and_diagnoses_show_themselves_in_a_notebook(
    found: Diagnosis, runs: list[Run]
) -> None:
    evil = replace(runs[0], name="<script>$")
    shown = [x._repr_html_() for x in (found.model, found.fit, found, found.after, evil)]
    for html in shown:
        assert html.startswith("<p>")
        assert html.count("<table>") == html.count("</table>") == 1
        assert "<script>" not in html
        assert len(html) < 4000
    assert "coulomb_drag.F_d_n" in shown[0]
    assert "&lt;script&gt;" in shown[-1]
    assert "friction_n" in shown[-1]
    planned = jbf.planned_power(
        found.model, runs[:1], noise_n=0.3, policy=jbf.Policy(false_alarms=0.05)
    )
    assert "found from" in planned._repr_html_()
