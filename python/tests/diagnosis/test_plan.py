"""Plans of runs: greedy selection against an independent one, limits, and bad requests."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import LAW
from jbf import InputError, Limits, Model, Rig, Run, plan, planned_power
from jbf.cli import main
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.excitations import excitations
from jbf.diagnosis.plan import LEAST_RUNS, MOST_RUNS, Plan
from jbf.diagnosis.planned import as_recorded
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.separation import played
from jbf.diagnosis.strength import strength_of
from jbf.models.chain import core_motion, imposed
from jbf.records.drive import Drive
from jbf.records.run_files import read_runs
from shared import shared

Array = npt.NDArray[np.float64]
TOP_M_S, SHARP_M_S2, NOISE_N, STEP_S = 0.2, 0.4, 0.2, 0.05
LIMITS = Limits(TOP_M_S, SHARP_M_S2, duration_s=30.0)
MODEL = Model(Rig(), "coulomb", parameters={**LAW, "F_s_n": 5.0})
RIG_TOML = '[drive]\nmotion = "linear"\nfriction = "force"\n'


@shared
def planned(minutes: float = 2.0) -> Plan:
    return plan(MODEL, limits=LIMITS, minutes=minutes, noise_n=NOISE_N, step_s=STEP_S)


def candidate_runs() -> list[tuple[str, Run]]:
    """Every motion within the limits: description and run."""
    return [
        (e.words, replace(played(Rig(), e, STEP_S, linear=True), name=f"{k}"))
        for k, e in enumerate(excitations(LIMITS, STEP_S))
    ]


def worth(information: Array, laws: int, prices: Array) -> float:
    """Sum over effects of the logarithm of their information relative to their threshold.

    Information is what remains after the law and after the rival with the largest correlation.
    """
    size = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled = information / np.outer(size, size)
    law, mixed, own = scaled[:laws, :laws], scaled[laws:, :laws], scaled[laws:, laws:]
    left = (own - mixed @ np.linalg.pinv(law, rcond=1e-9) @ mixed.T) * np.outer(
        size[laws:], size[laws:]
    )
    # An effect that the law explains up to rounding errors has no information and is no rival.
    seen = np.diag(left) > 1e-9 * size[laws:] ** 2
    variance = np.where(seen, np.diag(left), 0.0)
    correlation = np.where(seen, left, 0.0) ** 2 / np.outer(
        np.where(seen, variance, 1.0), np.where(seen, variance, 1.0)
    )
    np.fill_diagonal(correlation, 0.0)
    times = variance * np.maximum(1.0 - correlation.max(axis=1), 0.0) / prices
    total = np.log1p(np.minimum(times, 4.0)) + 0.05 * np.log(np.maximum(times, 4.0))
    return float(np.sum(total))


def test_each_run_of_a_plan_is_the_best_addition_to_the_runs_before_it() -> None:
    """The criterion is the worth of the plan plus that without its most informative run."""
    motions = candidate_runs()
    tried = as_recorded(MODEL, [run for _, run in motions[::3]], NOISE_N, DEFAULT)
    models = [m for name in tried.names if (m := strength_of(tried, (), name)) is not None]
    laws = len(tried.fitted(()).problem.open)
    prices = np.array([price_of(tried, max(len(m.problem.open) - laws, 1)) for m in models])
    step = 1e-4
    informations = []
    for _, run in motions:
        driven = [core_motion(MODEL.rig, run, imposed(MODEL.rig, run))]
        friction = MODEL.predict(run)
        slopes = [
            (replace_values(MODEL, name, 1.0 + step).predict(run) - friction) / step
            for name in MODEL.parameters
        ]
        changes = [m.problem.chain.predict(m.values(1.0), driven)[0] - friction for m in models]
        rows = np.column_stack([*slopes, *changes]) / NOISE_N
        informations.append(rows.T @ rows)
    words = [words for words, _ in motions]
    chosen: list[int] = []
    for found in planned().words:
        scores = []
        for k in range(len(motions)):
            together = [*chosen, k]
            total = np.sum([informations[i] for i in together], axis=0)
            without = min(worth(total - informations[i], laws, prices) for i in set(together))
            scores.append(worth(total, laws, prices) + without)
        chosen.append(words.index(found))
        # Noise and fitted values of the law differ a little between the two computations.
        assert scores[chosen[-1]] > np.max(scores) - 0.02 * (np.max(scores) - np.median(scores))
        assert scores[chosen[-1]] - np.min(scores) > 1.0


def replace_values(model: Model, name: str, factor: float) -> Model:
    """The model with one parameter multiplied."""
    values = {n: p.value for n, p in model.parameters.items()}
    return Model(model.rig, model.law, parameters={**values, name: factor * values[name]})


def test_plan_respects_the_total_time_and_the_limits_of_the_rig() -> None:
    found = planned()
    assert [run.name for run in found.runs] == ["01", "02", "03", "04"]
    descriptions = dict(candidate_runs())
    for run, words in zip(found.runs, found.words, strict=True):
        assert run.duration_s == pytest.approx(30.0, abs=0.05)
        assert np.max(np.abs(run.velocity_m_s)) <= TOP_M_S
        assert np.max(np.abs(np.diff(run.velocity_m_s))) <= 1.01 * SHARP_M_S2 * STEP_S
        assert run.velocity_m_s == pytest.approx(descriptions[words].velocity_m_s)
        assert run.friction_n is None
        assert run.position_m is not None
    assert len(set(found.words)) > 1


def test_plan_reports_the_power_of_its_runs() -> None:
    found = planned()
    again = planned_power(MODEL, found.runs, noise_n=NOISE_N)
    assert found.planned.power == again.power
    table = found.to_dict()
    assert [row["run"] for row in table["plan"]] == [run.name for run in found.runs]
    assert [row["motion"] for row in table["plan"]] == list(found.words)
    assert table["power"] == [p.to_dict() for p in again.power]


def test_plan_does_not_rely_on_exact_instants_of_reversals() -> None:
    """A jump of 10 N in a noise of 0.2 N would show on which side of a reversal a sample lies."""
    found = {p.effect: p.found_80 for p in planned().planned.power}
    play_m, delay_s, lag_s = (found[name] for name in ("backlash", "time_delay", "sensor_lag"))
    assert play_m is not None
    assert delay_s is not None
    assert lag_s is not None
    assert play_m > 0.1 * 0.5 * SHARP_M_S2 * STEP_S**2
    assert delay_s > 0.2 * STEP_S
    assert 0.1 * STEP_S < lag_s < STEP_S


def test_shaft_is_planned_with_its_angle_and_the_default_acceleration() -> None:
    """A missing acceleration is that of a sine at 2 rad/s with the largest speed."""
    model = Model(Rig(drive=Drive("rotary", "torque")), "coulomb", parameters=MODEL.parameters)
    limits = Limits(2.0, duration_s=15.0)
    found = plan(model, limits=limits, minutes=0.75, noise_n=NOISE_N, step_s=STEP_S)
    allowed = excitations(replace(limits, acceleration_m_s2=4.0), STEP_S, "rad/s")
    assert set(found.words) <= {e.words for e in allowed}
    assert max(np.max(np.abs(np.diff(run.velocity_m_s))) for run in found.runs) > 3.0 * STEP_S
    for run in found.runs:
        assert run.position_m is None
        assert run.angle_rad is not None
        middle = 0.5 * (run.velocity_m_s[1:] + run.velocity_m_s[:-1])
        assert np.diff(run.angle_rad) == pytest.approx(STEP_S * middle, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"minutes": 1.49}, "2 runs of 30 s"),
        ({"minutes": 100.5}, "more than 200 runs"),
        ({"minutes": 1e300}, "more than 200 runs"),
        ({"minutes": 0.0}, "minutes: 0 is not above zero"),
        ({"minutes": np.inf}, "minutes: inf is not above zero"),
        ({"noise_n": -1.0}, "noise_n: -1 is not above zero"),
        ({"step_s": np.nan}, "step_s"),
        ({"limits": Limits(duration_s=30.0)}, "velocity_m_s is missing"),
    ],
)
def test_impossible_plan_is_rejected_with_the_reason(change: dict[str, Any], problem: str) -> None:
    assert (LEAST_RUNS, MOST_RUNS) == (3, 200)
    request: dict[str, Any] = {"limits": LIMITS, "minutes": 2.0, "noise_n": NOISE_N} | change
    with pytest.raises(InputError, match=problem):
        plan(MODEL, **request)


@pytest.mark.parametrize(
    ("run_s", "loads"), [("10", ()), pytest.param("30", ("50", "150"), marks=pytest.mark.extended)]
)
def test_plan_command_writes_runs_that_the_power_command_reads(
    run_s: str, loads: tuple[str, ...], tmp_path: Path
) -> None:
    rig, out, table = tmp_path / "rig.toml", tmp_path / "plan", tmp_path / "plan.json"
    rig.write_text(RIG_TOML)
    minutes = f"{3.0 * float(run_s) / 60.0}"
    command = ["plan", str(rig), "--law", "coulomb", "--minutes", minutes, "--run-s", run_s]
    command += [
        "--max-velocity-m-s",
        "0.2",
        "--noise-n",
        "0.1",
        *(["--loads-n", *loads] * bool(loads)),
    ]
    assert main([*command, "--out", str(out), "--json", str(table)]) == 0
    assert [f.name for f in sorted(out.glob("*.csv"))] == ["01.csv", "02.csv", "03.csv"]
    runs = read_runs([out], Rig(), need_friction=False)
    recorded = {float(run.load_n[0]) for run in runs if run.load_n is not None}
    assert recorded == {float(load) for load in loads}
    found = json.loads(table.read_text())
    assert [row["run"] for row in found["plan"]] == ["01", "02", "03"]
    effects = {row["effect"] for row in found["power"]}
    assert "inertia_leak" in effects
    assert ("dry_load_dependence" in effects) == bool(loads)
    power = ["power", str(rig), str(out), "--law", "coulomb", "--noise-n", "0.1"]
    assert main(power) == 0


def test_plan_command_without_the_noise_is_rejected(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "rig.toml").write_text(RIG_TOML)
    command = ["plan", str(tmp_path / "rig.toml"), "--law", "coulomb", "--max-velocity-m-s", "1"]
    assert main(command) == 2
    assert "--noise-n is missing" in capsys.readouterr().err
