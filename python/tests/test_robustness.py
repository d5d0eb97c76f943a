"""The cases of `jbf control robustness` are what their names say, and its ratios what they mean."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Model, Rig
from jbf.control import TASKS, THESIS_BENCH, NoCompensation, Repetitive, robustness, run
from jbf.control import thesis_model as friction
from jbf.control.robustness import Case, Outcome, cases, misled

QUIET = replace(THESIS_BENCH, input_noise_v=0.0)
ROWS = {"position sine": TASKS["position sine"], "velocity sine": TASKS["velocity sine"]}


def test_without_compensation_nothing_helps_and_with_the_truth_much_does(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    base = friction(elastic="nothing")
    case = Case("as told", base, THESIS_BENCH)
    monkeypatch.setattr(robustness, "cases", lambda *_: iter([case]))
    told: list[tuple[int, int]] = []
    (ours,) = robustness.robustness(base, tasks=ROWS, report=lambda _, *done: told.append(done))
    (none,) = robustness.robustness(base, tasks=ROWS, scheme=NoCompensation())
    assert dict(none.ratios) == dict.fromkeys(ROWS, 1.0)
    assert none.verdict == "neutral"
    assert ours.worst == max(ours.ratios.values()) < 0.2
    assert ours.verdict == "help"
    assert told == [(1, 1)]


def test_a_verdict_is_the_worst_rows() -> None:
    words = {0.949: "help", 0.951: "neutral", 1.019: "neutral", 1.021: "harm"}
    for ratio, word in words.items():
        assert Outcome("", {"one": 0.1, "other": ratio}).verdict == word


def test_each_case_is_wrong_by_what_it_says(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robustness, "misled", lambda base, _: base)
    base = Model(Rig.thesis("4.2"))
    found = {case.name: case for case in cases(base, THESIS_BENCH)}
    assert len(found) > 25

    def of(name: str, field: str) -> float:
        return float(getattr(found[name].bench, field) / getattr(THESIS_BENCH, field))

    assert of("friction half as large again", "volts_per_n") == pytest.approx(3 / 2)
    assert of("friction a third smaller", "volts_per_n") == pytest.approx(2 / 3)
    assert of("motor gain 10 % larger", "input_rad_s2_v") == pytest.approx(1.1)
    assert of("motor gain 10 % smaller", "input_rad_s2_v") == pytest.approx(0.9)
    assert of("noise four times", "input_noise_v") == pytest.approx(4.0)
    # What depends on the load shows under another one; all else is tried under the rig's.
    hidden = {n.removeprefix("hidden "): c.load_factor for n, c in found.items() if "hidden" in n}
    assert {n for n, factor in hidden.items() if factor == 1.5} == {"load_dependence"}
    assert set(hidden.values()) == {1.0, 1.5}
    assert (found["load doubled"].load_factor, found["load halved"].load_factor) == (2.0, 0.5)
    assert base.rig.lubricant is not None
    for word, factor in (("doubled", 2.0), ("halved", 0.5)):
        oil = found[f"viscosity {word}"].plant.rig.lubricant
        assert oil is not None
        assert oil.viscosity_pa_s == pytest.approx(factor * base.rig.lubricant.viscosity_pa_s)


def test_a_misled_model_is_fitted_to_two_periods_with_two_percent_of_noise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    base = Model(Rig.thesis("4.2"))
    kept: dict[str, Any] = {}

    def fitted(rig: Rig, runs: list[Any], *_: Any, **more: Any) -> Any:
        kept.update(runs=runs, more=more)
        return type("Found", (), {"model": base})

    monkeypatch.setattr(robustness, "fit", fitted)
    misled(base, base)
    for made, rate in zip(kept["runs"], (0.25, 1.0), strict=True):
        periods = (made.time_s[-1] + 0.02) * rate / (2.0 * np.pi)
        assert periods == pytest.approx(2.0, abs=0.01)
        # Path and angle are the integral of the speed.
        walked = np.concatenate(
            ([0.0], np.cumsum(0.01 * (made.velocity_m_s[1:] + made.velocity_m_s[:-1])))
        )
        assert np.max(np.abs(made.position_m - walked)) < 1e-4 * np.max(np.abs(walked))
        assert np.allclose(made.angle_rad * base.rig.bearing.radius_m, made.position_m)
        clean = base.predict(replace(made, friction_n=None))
        off = made.friction_n - clean
        assert np.std(off) / np.max(np.abs(clean)) == pytest.approx(0.02, rel=0.1)


def test_a_laps_gain_is_half_of_the_held_shafts_stiffness() -> None:
    """Volts for a radian, or a radian a second, that the loop gives to a shaft that is stuck."""
    for row in ROWS:
        task = replace(TASKS[row], seconds=6.0, skip_s=0.0)
        steps = round(task.seconds / QUIET.dt_s)
        held = (np.full(steps, 0.01), np.zeros(steps))
        stuck = replace(QUIET, volts_per_n=100.0 * QUIET.volts_per_n)
        r = run(friction(elastic="nothing"), "none", task, bench=stuck, reference=held)
        assert np.all(r.velocity_rad_s == 0.0)
        core = Repetitive().core(task, QUIET)
        assert core["lap_gain"] == pytest.approx(0.5 * float(r.output_v[-1]) / 0.01, rel=1e-3), row
        assert core["steps_per_lap"] * QUIET.dt_s == pytest.approx(task.period_s, abs=QUIET.dt_s)
