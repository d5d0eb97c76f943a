"""`jbf plan`: runs that show more than others of the same length."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jbf import InputError, Limits, Model, Rig, Run, plan, planned_power
from jbf.cli import main
from jbf.diagnosis.excitations import excitations
from jbf.diagnosis.plan import Plan, _effects, _told, _worth
from jbf.diagnosis.planned import as_recorded
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.separation import played
from jbf.records.run_files import read_runs

SLIDE = '[drive]\nmotion = "linear"\nfriction = "force"\n'
TOP_M_S, SHARP_M_S2, NOISE_N = 0.2, 0.4, 0.2
LIMITS = Limits(TOP_M_S, SHARP_M_S2, duration_s=30.0)
MODEL = Model(Rig(), "coulomb", (), {"F_c": 5.0, "F_v": 20.0})


@pytest.fixture(scope="module")
def planned() -> Plan:
    return plan(MODEL, limits=LIMITS, minutes=2.0, noise_n=NOISE_N)


def test_what_adds_up_over_runs_is_worth_what_is_left_of_the_law_and_of_the_likest_rival() -> None:
    # One parameter of the law and two effects, told by rows that can be counted by hand.
    rows = np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 3.0, 3.0], [0.0, 0.0, 4.0]])
    left = rows[:, 1:] - np.outer(rows[:, 0], [0.0, 0.0])
    a, b = left.T
    alone = [a @ a - (a @ b) ** 2 / (b @ b), b @ b - (a @ b) ** 2 / (a @ a)]
    prices = np.array([10.0, 40.0])
    wanted = np.sum(np.log1p(np.array(alone) / prices)) + 0.05 * 2.0 * np.log(4.0)
    assert _worth(rows.T @ rows, 1, prices) == pytest.approx(wanted)


def test_the_plan_keeps_to_time_and_limits(planned: Plan) -> None:
    assert [run.name for run in planned.runs] == ["01", "02", "03", "04"]
    for run in planned.runs:
        assert run.duration_s == pytest.approx(30.0, abs=0.05)
        assert np.max(np.abs(run.velocity_m_s)) <= TOP_M_S
        assert np.max(np.abs(np.diff(run.velocity_m_s))) <= 1.01 * SHARP_M_S2 * 0.02
        assert run.friction_n is None
        assert run.position_m is not None
    assert len(set(planned.words)) > 1


def test_it_shows_more_than_runs_taken_at_random(planned: Plan) -> None:
    every = [played(Rig(), e, 0.02, linear=True) for e in excitations(LIMITS, 0.02)]
    random = np.random.default_rng(4)
    tell = ("inertia_leak", "dry_asymmetry", "dwell_stiction", "warm_up", "quadratic_drag")

    def strengths(runs: list[Run]) -> np.ndarray:
        named = [
            Run.from_arrays(r.time_s, r.velocity_m_s, position_m=r.position_m, name=f"{i}")
            for i, r in enumerate(runs)
        ]
        rows = {p.effect: p for p in planned_power(MODEL, named, noise_n=NOISE_N).power}
        # What is never told alone is told a hundred times too late.
        return np.array([rows[n].alone_80 or 100.0 * (rows[n].found_80 or 1e3) for n in tell])

    ours = np.log(strengths(list(planned.runs)))
    others = [np.log(strengths([every[k] for k in random.choice(len(every), 4)])) for _ in range(6)]
    # In the middle an effect may be weaker by a third and still be named alone.
    assert np.mean(np.median(others, axis=0) - ours) > 0.4


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"minutes": 1.0}, "1 hold 2 runs of 30 s"),
        ({"minutes": 0.0}, "minutes: 0 is not above zero"),
        ({"noise_n": -1.0}, "noise_n: -1 is not above zero"),
        ({"step_s": float("nan")}, "step_s"),
        ({"limits": Limits(duration_s=30.0)}, "velocity_m_s is missing"),
    ],
)
def test_what_is_no_plan(change: dict[str, object], words: str) -> None:
    asked = {"limits": LIMITS, "minutes": 2.0, "noise_n": NOISE_N} | change
    with pytest.raises(InputError, match=words):
        plan(MODEL, **asked)  # type: ignore[arg-type]


def test_from_the_command_line_to_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig, out, told = tmp_path / "rig.toml", tmp_path / "plan", tmp_path / "plan.json"
    rig.write_text(SLIDE)
    command = ["plan", str(rig), "--law", "coulomb", "--minutes", "1.5", "--run-s", "30"]
    command += ["--max-velocity-m-s", "0.2", "--noise-n", "0.1", "--loads-n", "50", "150"]
    assert main([*command, "--out", str(out), "--json", str(told)]) == 0
    said = capsys.readouterr().out
    assert "under 50 N" in said
    assert "under 150 N" in said
    assert "inertia_leak" in said
    files = sorted(out.glob("*.csv"))
    assert [f.name for f in files] == ["01.csv", "02.csv", "03.csv"]
    loads = {float(np.asarray(r.load_n)[0]) for r in read_runs([out], Rig(), need_friction=False)}
    assert loads == {50.0, 150.0}
    found = json.loads(told.read_text())
    assert [row["run"] for row in found["plan"]] == ["01", "02", "03"]
    assert {row["effect"] for row in found["power"]} >= {"dry_load_dependence", "inertia_leak"}
    # The plan is what `jbf power` takes.
    power = ["power", str(rig), str(out), "--law", "coulomb", "--noise-n", "0.1"]
    assert main(power) == 0


def test_nothing_is_planned_without_a_noise(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "rig.toml").write_text(SLIDE)
    command = ["plan", str(tmp_path / "rig.toml"), "--law", "coulomb", "--max-velocity-m-s", "1"]
    assert main(command) == 2
    assert "--noise-n is missing" in capsys.readouterr().err


def test_a_plan_does_not_claim_what_only_exact_instants_would_show(planned: Plan) -> None:
    found = {p.effect: p for p in planned_power(MODEL, planned.runs, noise_n=NOISE_N).power}
    # A jump of ten newtons in a noise of 0.2 N shows on which side of a reversal a sample lies, and
    # a recorded reversal has no such instant: play must be there for a sample, or nearly.
    step_s, slope = 0.02, SHARP_M_S2
    play_m, late_s, lag_s = (
        found[name].found_80 for name in ("backlash", "time_delay", "sensor_lag")
    )
    assert play_m is not None
    assert play_m > 0.1 * 0.5 * slope * step_s**2
    assert late_s is not None
    assert late_s > 0.2 * step_s
    # Of a lag within a sample nothing is left at the next but one.
    assert lag_s is not None
    assert 0.1 * step_s < lag_s < step_s


def test_what_a_motion_tells_goes_with_the_square_of_one_over_the_noise() -> None:
    """Fisher's information of a mean under normal noise."""
    motions = [played(Rig(), e, 0.02, linear=True) for e in list(excitations(LIMITS, 0.02))[::20]]
    named = [replace(run, name=f"{i}") for i, run in enumerate(motions)]
    candidates = as_recorded(MODEL, named, NOISE_N, DEFAULT)
    effects = _effects(candidates, MODEL)[:2]
    quiet, loud = (_told(candidates, MODEL, effects, named[0], sd) for sd in (0.1, 0.3))
    np.testing.assert_allclose(quiet, 9.0 * loud, rtol=1e-9)
    assert np.all(np.linalg.eigvalsh(quiet) > -1e-6 * np.trace(quiet))
