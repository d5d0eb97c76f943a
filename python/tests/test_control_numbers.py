"""Tuning, the cases of robustness and the thesis's tables: numbers that can be worked out."""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Model, Rig
from jbf.control import TASKS, THESIS_BENCH, Coulomb, Learning, NoCompensation, thesis_model
from jbf.control.assumptions import assumptions
from jbf.control.robustness import HARM, HELP, STRONG, Outcome, cases, robustness
from jbf.control.schemes import LISTED_VOLTS
from jbf.control.thesis_tables import (
    PRINTED_PEAK,
    PRINTED_RMS,
    Cell,
    Tables,
    _mean_square_root,
    fit_friction,
    tables,
)
from jbf.control.tuning import LAW_RAD_S, friction_level_v, tune
from jbf.models.catalogue import find_effect

ROBUST: Any = importlib.import_module("jbf.control.robustness")
TABLES: Any = importlib.import_module("jbf.control.thesis_tables")
ASSUMED: Any = importlib.import_module("jbf.control.assumptions")
TUNING: Any = importlib.import_module("jbf.control.tuning")
DRY = Model(Rig(), "coulomb", parameters={"F_c_n": 5.0, "F_s_n": 5.0, "F_v_n_s_m": 20.0})
VOLT = replace(THESIS_BENCH, volts_per_n=1.0 / 5.1)
"""A bench on which `DRY` has a volt at 5 mm/s."""


def test_the_level_of_friction_is_the_largest_of_a_slow_turn() -> None:
    """5 N and 20 N s/m at 5 mm/s, in the bench's volts."""
    assert friction_level_v(DRY, VOLT) == pytest.approx(1.0, rel=1e-3)
    assert friction_level_v(DRY, replace(VOLT, volts_per_n=1.0)) == pytest.approx(5.1, rel=1e-3)


@pytest.mark.parametrize("share", [-0.4, 0.4])
def test_the_slow_motion_goes_there_and_back(share: float) -> None:
    """Friction that is larger one way is seen whichever way that is."""
    values = {n: p.value for n, p in DRY.parameters.items()}
    uneven = Model(Rig(), "coulomb", ["dry_asymmetry"], values | {"dry_asymmetry.a": share})
    assert friction_level_v(uneven, VOLT) == pytest.approx(7.1 / 5.1, rel=1e-3)


@pytest.mark.parametrize(("rig", "radius"), [(Rig(), None), (Rig.thesis(), 0.0127)])
def test_the_slow_motion_is_a_period_of_a_sine_and_its_path(rig: Rig, radius: Any) -> None:
    """5 mm/s at most; its angle where there is a journal, else its place."""
    asked: list[Any] = []

    def predict(run: Any) -> Any:
        asked.append(run)
        return np.where(run.time_s == 2.0, -7.0, 1.0)

    assert TUNING._friction_level_n(SimpleNamespace(rig=rig, predict=predict)) == 7.0
    (run,) = asked
    assert 2.0 * np.pi / 0.6 < run.duration_s < 1.1 * 2.0 * np.pi / 0.6
    np.testing.assert_allclose(run.velocity_m_s, 0.005 * np.sin(0.6 * run.time_s))
    way = 0.005 / 0.6 * (1.0 - np.cos(0.6 * run.time_s))
    if radius is None:
        assert run.angle_rad is None
        np.testing.assert_allclose(run.position_m, way)
    else:
        assert run.position_m is None
        np.testing.assert_allclose(run.angle_rad, way / radius)


def test_settings_follow_from_step_counts_and_friction() -> None:
    """Each by its formula, on a bench whose friction is a volt."""
    level = friction_level_v(DRY, VOLT)
    found = tune(DRY, VOLT)
    count = 1.0 / VOLT.counts_per_rad
    noise = count / math.sqrt(12.0)
    assert found.bandwidth_rad_s == pytest.approx(60.0)
    assert found.learning_1_s == pytest.approx(2.0)
    assert found.level_limit_v == level
    assert found.rest_limit_v == pytest.approx(level + 0.1 * VOLT.limit_v)
    assert found.loop_rad_s == pytest.approx(30.0)
    speed_noise = noise * 60.0 * math.sqrt(60.0 * 0.002)
    assert found.slow_rad_s == pytest.approx(max(5.0 * speed_noise, 2.0 * count * 60.0))
    assert found.breakaway == 1.0
    assert found.moving_v == pytest.approx(2.5 * level)
    assert found.patience_s == pytest.approx(0.1)


def test_noise_bounds_the_bandwidth_and_makes_the_shaft_slow() -> None:
    """Noise makes a hundredth of the level of the output, whose estimate's is w sqrt(w dt)."""
    noisy = replace(VOLT, encoder_noise_counts=40.0)
    noise = math.sqrt(1.0 / 12.0 + 1600.0) / VOLT.counts_per_rad
    found, level = tune(DRY, noisy), friction_level_v(DRY, VOLT)
    w = found.bandwidth_rad_s
    assert w < 60.0
    assert noise * w * math.sqrt(w * noisy.dt_s) == pytest.approx(0.01 * level)
    assert found.slow_rad_s == pytest.approx(5.0 * 0.01 * level)
    assert found.loop_rad_s == pytest.approx(LAW_RAD_S)
    assert pytest.approx(math.hypot(10.0, 10.0)) == LAW_RAD_S


def test_a_voltage_that_surely_moves_is_no_more_than_there_is() -> None:
    """2.5 times the level, at most the drive's; friction beyond that is refused."""
    level = friction_level_v(DRY, VOLT)
    assert tune(DRY, replace(VOLT, limit_v=2.0 * level)).moving_v == 2.0 * level
    assert tune(DRY, replace(VOLT, limit_v=level * (1.0 + 1e-9))).level_limit_v == level
    with pytest.raises(InputError) as refused:
        tune(DRY, replace(VOLT, limit_v=level))
    assert str(refused.value) == (
        f"the model's friction is {level:.3g} V, the drive has {level:g} V; correct --volts-per-n"
    )


@pytest.mark.parametrize(
    ("ratios", "worst", "verdict"),
    [((HELP,), HELP, "neutral"), ((0.1, 0.94), 0.94, "help"), ((HARM, 0.1), HARM, "neutral"),
     ((1.03, 0.1), 1.03, "harm")],
)  # fmt: skip
def test_a_verdict_is_that_of_the_worst_row(
    ratios: tuple[float, ...], worst: float, verdict: str
) -> None:
    """Below 0.95 it helps, above 1.02 it harms, between and at them neither."""
    found = Outcome("", {str(i): ratio for i, ratio in enumerate(ratios)})
    assert (found.worst, found.verdict) == (worst, verdict)


@pytest.fixture
def unfitted(monkeypatch: pytest.MonkeyPatch) -> Model:
    """What a compensator would carry that was fitted to records that mislead."""
    carried = Model(Rig.thesis(), parameters={"f_m": 0.2})
    monkeypatch.setattr(ROBUST, "misled", lambda base, seen: carried)
    return carried


def test_what_is_hidden_is_in_the_plant_or_in_the_records(unfitted: Model) -> None:
    """An instrument's effect in what the compensator carries, any other in the plant, at its
    strength; what the model has already, or does not go with its law, is not hidden."""
    base = Model(Rig.thesis(), effects=["coulomb_drag"])
    found = {case.name: case for case in cases(base)}
    assert "hidden coulomb_drag" not in found
    hidden = {n.removeprefix("hidden "): c for n, c in found.items() if n.startswith("hidden ")}
    for name, case in hidden.items():
        page = find_effect(name)
        assert "journal" not in page.refused
        if page.stage == "instrument":
            assert (case.plant, case.carried) == (base, unfitted)
            continue
        assert case.carried is None
        assert set(case.plant.effects) == {"coulomb_drag", name}
        for p in page.parameters:
            wanted = STRONG.get(name, {}).get(p.name, p.starts[0])
            assert case.plant.parameters[f"{name}.{p.name}"].value == wanted
    assert {"wear_in", "sensor_offset", "drive_compliance"} <= set(hidden)
    rest = [name for name in found if not name.startswith("hidden ")]
    assert rest == [
        "load doubled", "load halved", "viscosity doubled", "viscosity halved",
        "friction half as large again", "friction a third smaller",
        "motor gain 10 % larger", "motor gain 10 % smaller", "noise four times",
    ]  # fmt: skip


@pytest.mark.usefixtures("unfitted")
def test_a_law_without_a_film_has_no_viscosity_to_be_wrong() -> None:
    """Nor has a rig without a lubricant."""
    for model in (DRY, Model(Rig.thesis(), "coulomb")):
        assert not any("viscosity" in case.name for case in cases(model))


def test_a_ratio_is_of_the_error_with_over_that_without(monkeypatch: pytest.MonkeyPatch) -> None:
    """27 s beyond what is left out; both are told the undisturbed bench, under the case's load."""
    asked: list[tuple[Any, ...]] = []

    def noted(plant: Any, scheme: Any, task: Any, *, bench: Any, told: Any, load_n: Any) -> Any:
        asked.append((plant, scheme.name, task.seconds, task.skip_s, bench, told, load_n))
        return SimpleNamespace(true_rms=0.5 if scheme.name == "none" else 0.1)

    base = thesis_model(elastic="nothing")
    strong = replace(THESIS_BENCH, volts_per_n=1.0)
    case = ROBUST.Case("load", base, strong, 3.0)
    monkeypatch.setattr(ROBUST, "run", noted)
    monkeypatch.setattr(ROBUST, "cases", lambda *_: iter([case, replace(case, plant=DRY)]))
    told: list[Any] = []
    found = robustness(tasks={"a": TASKS["velocity sine"]}, scheme=Coulomb(),
                       report=lambda *said: told.append(said))  # fmt: skip
    assert [dict(o.ratios) for o in found] == [{"a": pytest.approx(0.2)}] * 2
    assert told == [("robustness", 1, 2), ("robustness", 2, 2)]
    with_load = [call[1:] for call in asked if call[0] is base]
    assert with_load == [
        (name, 29.0, 2.0, strong, THESIS_BENCH, 312.0) for name in ("none", "coulomb")
    ]
    assert {call[-1] for call in asked if call[0] is DRY} == {None}


def test_the_observed_compensator_carries_the_cases_model_or_the_base(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Tuned to it on the undisturbed bench."""
    base, other = thesis_model(elastic="nothing"), thesis_model(elastic="nothing", f_m=0.4)
    carried: list[Any] = []

    def noted(plant: Any, scheme: Any, *_: Any, **__: Any) -> Any:
        if scheme.name == "observed":
            carried.append((scheme.model, scheme.settings))
        return SimpleNamespace(true_rms=1.0)

    first = ROBUST.Case("a", base, replace(THESIS_BENCH, volts_per_n=1.0))
    monkeypatch.setattr(ROBUST, "run", noted)
    for case, model in ((first, base), (replace(first, carried=other), other)):
        monkeypatch.setattr(ROBUST, "cases", lambda *_, case=case: iter([case]))
        robustness(base, tasks={"a": TASKS["velocity sine"]})
        assert carried.pop() == (model, tune(model, THESIS_BENCH))
        assert carried == []


def cell(row: str, column: str, rms: float, printed: float | None, true: float = 1.0) -> Cell:
    return Cell(row, column, rms, 2.0, printed, None, true)


def tables_of(*cells: Cell) -> Tables:
    return Tables({(c.row, c.column): c for c in cells}, thesis_model(), THESIS_BENCH)


def test_cells_columns_and_what_is_near() -> None:
    """A ratio only where something is printed; a factor holds either way, its ends included."""
    assert cell("a", "none", 3.0, 2.0).ratio == 1.5
    assert cell("a", "none", 3.0, None).ratio is None
    ratios = (0.5, 0.499, 1.0, 2.0, 2.001)
    found = tables_of(
        cell("a", "none", 9.0, 1.0),
        cell("a", "observed", 1.0, None),
        cell("b", "coulomb", 1.0, None),
        *(cell(f"r{i}", "learning", x, 1.0) for i, x in enumerate(ratios)),
    )
    assert [c.rms for c in found.predicted] == list(ratios)
    assert (found.within(2.0), found.within(1.0)) == (3, 1)
    assert [c.row for c in found.column("none")] == ["a"]
    assert found["b", "coulomb"].rms == 1.0
    other = replace(tables_of(cell("a", "none", 5.0, 1.0), cell("n", "none", 6.0, 1.0)),
                    model=DRY)  # fmt: skip
    both = found.replaced(other)
    assert [c.rms for c in both.column("none")] == [5.0, 6.0]
    assert (len(both.cells), both.model) == (len(found.cells) + 1, DRY)


def test_a_gain_is_over_the_better_of_the_two() -> None:
    """By the shaft's true error."""
    cells = []
    for i, row in enumerate(PRINTED_RMS):
        first, second = (0.6, 0.8) if i % 2 else (0.9, 0.6)
        cells += [cell(row, "learning", 1.0, 1.0, first), cell(row, "coulomb", 1.0, 1.0, second),
                  cell(row, "observed", 1.0, None, 0.1 + 0.1 * i)]  # fmt: skip
    gains = tables_of(*cells).gains()
    assert gains == pytest.approx({r: 0.6 / (0.1 + 0.1 * i) for i, r in enumerate(PRINTED_RMS)})


def test_a_cell_is_the_mean_of_several_seeds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Square roots of mean squares of the errors, the mean of the peaks; ours has none in print."""

    def noted(model: Any, scheme: Any, task: Any, *, bench: Any) -> Any:
        return SimpleNamespace(rms=bench.seed, peak=10.0 * bench.seed, true_rms=2.0 * bench.seed)

    monkeypatch.setattr(TABLES, "run", noted)
    told: list[Any] = []
    found = tables(thesis_model(), replace(THESIS_BENCH, seed=9), seeds=3,
                   report=lambda *said: told.append(said))  # fmt: skip
    assert told == [("the tables", k, 4) for k in (1, 2, 3, 4)]
    assert len(found.cells) == 28
    one = found["position sine", "learning"]
    assert one.rms == pytest.approx(math.sqrt(14.0 / 3.0))
    assert one.peak == pytest.approx(20.0)
    assert one.true_rms == pytest.approx(2.0 * one.rms)
    for i, column in enumerate(("none", "learning", "coulomb")):
        for row in TASKS:
            assert found[row, column].printed_rms == PRINTED_RMS[row][i]
            assert found[row, column].printed_peak == PRINTED_PEAK[row][i]
    ours = found["position sine", "observed"]
    assert (ours.printed_rms, ours.printed_peak) == (None, None)
    assert found.bench.seed == 9
    five = tables(thesis_model(), THESIS_BENCH, schemes={"none": NoCompensation()})
    assert five["position sine", "none"].rms == pytest.approx(math.sqrt(11.0))
    assert _mean_square_root([3.0, -4.0]) == pytest.approx(math.sqrt(12.5))


def test_a_fit_stays_within_a_factor_and_takes_a_long_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """The logarithm of bench over printed, about the numbers found before."""
    kept: dict[str, Any] = {}

    def solved(misses: Any, start: Any, **more: Any) -> Any:
        kept.update(more, start=start, missed=misses(np.asarray(start)))
        return SimpleNamespace(x=np.log([2.0, 0.1, 1e6, 50.0]))

    import scipy.optimize

    monkeypatch.setattr(scipy.optimize, "least_squares", solved)
    monkeypatch.setattr(TABLES, "run", lambda *_, **__: SimpleNamespace(rms=0.5))
    model, bench = fit_friction(elastic="contact", clock="journal")
    wanted = [math.log(0.5 / PRINTED_RMS[row][0]) for row in TASKS]  # type: ignore[operator]
    assert kept["missed"] == pytest.approx(wanted)
    low, high = kept["bounds"]
    assert np.exp(high - kept["start"]) == pytest.approx([math.exp(3.0)] * 4)
    assert np.exp(low - kept["start"]) == pytest.approx([math.exp(-3.0)] * 4)
    # The cells are noisy at the 1e-3 level: steps are longer, and it ends below.
    assert (kept["diff_step"], kept["max_nfev"]) == ([0.01], 20)
    assert max(kept["xtol"], kept["ftol"]) < 1e-3
    assert bench.volts_per_n == pytest.approx(2.0)
    values = {n: model.parameters[n].value for n in ("U_tr_m_s", "K0", "gamma")}
    assert values == pytest.approx({"U_tr_m_s": 0.1, "K0": 1e6, "gamma": 50.0})
    assert (model.effects, model.clock) == (("presliding",), "journal")


def test_each_assumption_changes_one_thing(monkeypatch: pytest.MonkeyPatch) -> None:
    """What it computes anew, and the rest from the base."""
    asked: list[tuple[Model, Mapping[str, Any], dict[str, Any]]] = []

    def noted(model: Model, bench: Any, *, schemes: Any, **more: Any) -> Tables:
        asked.append((model, schemes, more))
        return tables_of(cell("new", "none", float(len(asked)), 1.0))

    monkeypatch.setattr(ASSUMED, "tables", noted)
    base = tables_of(cell("old", "none", 7.0, 1.0))
    base = replace(base, model=thesis_model(K0=2e6))
    found = list(assumptions(base))
    assert found[0] == ("the rig's scale, elastic belt", base)
    assert [t["new", "none"].rms for _, t in found[1:]] == [1, 2, 3, 4, 5, 6, 7, 8]
    assert all(t["old", "none"].rms == 7.0 for _, t in found)
    learning = [schemes.get("learning") for _, schemes, _ in asked]
    assert learning[:3] == [Learning(volts=3.5), Learning(volts=LISTED_VOLTS),
                            Learning(clock="journal")]  # fmt: skip
    assert asked[3][1] == {"coulomb": Coulomb(gain=0.02)}
    assert learning[4:] == [Learning(), Learning(volts=LISTED_VOLTS), Learning(), Learning()]
    for _, schemes, _ in asked[4:]:
        assert list(schemes) == ["none", "learning", "coulomb"]
    assert [model.effects for model, _, _ in asked[3:]] == [
        ("drive_compliance",), ("presliding",), ("presliding",), (), ("drive_compliance",)
    ]  # fmt: skip
    assert {model.parameters["K0"].value for model, _, _ in asked} == {2e6}
    seeds = [more.get("seeds") for _, _, more in asked]
    assert seeds == [3, 3, 3, None, 3, 3, 3, 3]
    assert {task.skip_s for task in asked[-1][2]["tasks"].values()} == {0.0}
