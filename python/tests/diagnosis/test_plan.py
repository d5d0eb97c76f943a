"""Plans of runs and their power: selection, limits, simulated records, and invalid requests."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from by_hand import LAW, Array, coulomb
from jbf import InputError, Limits, Model, Rig, Run, fit, plan, planned_power
from jbf.cli import main
from jbf.diagnosis.experiment_design.excitations import excitations, run_from_motion
from jbf.diagnosis.experiment_design.plan import LEAST_RUNS, MOST_RUNS, Plan
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.power.detection_limits import non_centrality
from jbf.diagnosis.power.planned_runs import as_recorded
from jbf.diagnosis.power.strength import strength_of
from jbf.models.chain import core_motion, estimated_motion
from jbf.records.drive import Drive
from jbf.records.run_files import read_runs
from jbf.records.toml_file import MOST
from shared import shared

TOP_M_S, SHARP_M_S2, NOISE_N, STEP_S = 0.2, 0.4, 0.2, 0.05
LIMITS = Limits(TOP_M_S, SHARP_M_S2, duration_s=30.0)
VALUES = {**LAW, "F_s": 5.0}
MODEL = Model(Rig(), "coulomb", parameters=VALUES)
WITH_MASS = Model(Rig(), "coulomb", ["inertia"], VALUES | {"inertia.m_e": 3.0})
RIG_TOML = '[drive]\nmotion = "linear"\nfriction = "force"\n'
TIME_S = 0.02 * np.arange(600.0)


@shared
def planned() -> Plan:
    """A plan of four runs."""
    return plan(MODEL, limits=LIMITS, minutes=2.0, noise_rms=NOISE_N, step_s=STEP_S)


def candidate_runs() -> list[tuple[str, Run]]:
    """Description and run of every motion within the limits."""
    return [
        (e.words, replace(run_from_motion(Rig(), e, STEP_S, linear=True), name=f"{k}"))
        for k, e in enumerate(excitations(LIMITS, STEP_S))
    ]


def worth(information: Array, laws: int, prices: Array) -> float:
    """Sum over effects of the logarithm of their information relative to their threshold.

    Information is the residual after the law and after the rival with the largest correlation.
    """
    size = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled = information / np.outer(size, size)
    law, mixed, effects = scaled[:laws, :laws], scaled[laws:, :laws], scaled[laws:, laws:]
    reduced = (effects - mixed @ np.linalg.pinv(law, rcond=1e-9) @ mixed.T) * np.outer(
        size[laws:], size[laws:]
    )
    # An effect that the law explains up to rounding errors has no information and is not a rival.
    seen = np.diag(reduced) > 1e-9 * size[laws:] ** 2
    variance = np.where(seen, np.diag(reduced), 0.0)
    correlation = np.where(seen, reduced, 0.0) ** 2 / np.outer(
        np.where(seen, variance, 1.0), np.where(seen, variance, 1.0)
    )
    np.fill_diagonal(correlation, 0.0)
    times = variance * np.maximum(1.0 - correlation.max(axis=1), 0.0) / prices
    return float(np.sum(np.log1p(np.minimum(times, 4.0)) + 0.05 * np.log(np.maximum(times, 4.0))))


@pytest.mark.extended
def test_each_run_of_a_plan_is_the_best_addition_to_the_runs_before_it() -> None:
    """The criterion is the information of the plan plus that without its most informative run."""
    motions = candidate_runs()
    tried = as_recorded(MODEL, [run for _, run in motions[::3]], NOISE_N, DEFAULT)
    models = [m for name in tried.names if (m := strength_of(tried, (), name)) is not None]
    laws = len(tried.fitted(()).problem.open)
    prices = np.array([tried.price(max(len(m.problem.open) - laws, 1)) for m in models])
    step = 1e-4
    steps = [VALUES | {name: (1.0 + step) * value} for name, value in VALUES.items()]
    informations = []
    for _, run in motions:
        driven = [core_motion(MODEL.rig, run, estimated_motion(MODEL.rig, run))]
        friction = MODEL.predict(run)
        slopes = [
            (Model(Rig(), "coulomb", parameters=stepped).predict(run) - friction) / step
            for stepped in steps
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
        # The two computations differ slightly in noise and fitted parameters of the law.
        assert scores[chosen[-1]] > np.max(scores) - 0.02 * (np.max(scores) - np.median(scores))
        assert scores[chosen[-1]] - np.min(scores) > 1.0


def test_plan_respects_the_total_time_and_the_limits_of_the_rig() -> None:
    found = planned()
    assert [run.name for run in found.runs] == ["01", "02", "03", "04"]
    descriptions = dict(candidate_runs())
    for run, words in zip(found.runs, found.words, strict=True):
        assert run.duration_s == pytest.approx(30.0, abs=0.05)
        assert np.max(np.abs(run.velocity)) <= TOP_M_S
        assert np.max(np.abs(np.diff(run.velocity))) <= 1.01 * SHARP_M_S2 * STEP_S
        assert run.velocity == pytest.approx(descriptions[words].velocity)
        assert run.friction is None
        assert run.position_m is not None
    assert len(set(found.words)) > 1


def test_plan_reports_the_power_of_its_runs() -> None:
    found, table = planned(), planned().to_dict()
    power = planned_power(MODEL, found.runs, noise_rms=NOISE_N).power
    assert found.planned.power == power
    assert [row["run"] for row in table["plan"]] == [run.name for run in found.runs]
    assert [row["motion"] for row in table["plan"]] == list(found.words)
    assert table["power"] == [p.to_dict() for p in power]


def test_planned_power_allows_for_uncertain_instants_of_reversals() -> None:
    """A jump of 10 N in noise of 0.2 N would reveal the side of a reversal of each sample."""
    found: dict[str, Any] = {p.effect: p.detectable_80 for p in planned().planned.power}
    assert found["backlash"] > 0.1 * 0.5 * SHARP_M_S2 * STEP_S**2
    assert found["time_delay"] > 0.2 * STEP_S
    assert 0.1 * STEP_S < found["sensor_lag"] < STEP_S


def test_plan_for_a_shaft_has_its_angle_and_the_default_acceleration() -> None:
    """The default acceleration limit is that of a sine at 2 rad/s with the largest speed."""
    model = Model(Rig(drive=Drive("rotary", "torque")), "coulomb", parameters=MODEL.parameters)
    limits = Limits(2.0, duration_s=10.0)
    found = plan(model, limits=limits, minutes=0.5, noise_rms=NOISE_N, step_s=STEP_S)
    allowed = excitations(replace(limits, acceleration=4.0), STEP_S, "rad/s")
    assert set(found.words) <= {e.words for e in allowed}
    assert max(np.max(np.abs(np.diff(run.velocity))) for run in found.runs) > 3.0 * STEP_S
    for run in found.runs:
        assert run.position_m is None
        assert run.angle_rad is not None
        middle = 0.5 * (run.velocity[1:] + run.velocity[:-1])
        assert np.diff(run.angle_rad) == pytest.approx(STEP_S * middle, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"minutes": 1.49}, "2 runs of 30 s"),
        ({"minutes": 100.5}, "more than 200 runs"),
        ({"minutes": 1e300}, "more than 200 runs"),
        ({"minutes": 0.0}, "minutes: 0 is not above zero"),
        ({"minutes": np.inf}, "minutes: inf is not above zero"),
        ({"noise_rms": -1.0}, "noise_rms: -1 is not above zero"),
        ({"step_s": np.nan}, "step_s"),
        ({"limits": Limits(duration_s=30.0)}, "velocity_m_s is missing"),
    ],
)
def test_plan_with_invalid_limits_or_duration_is_rejected_with_the_reason(
    change: dict[str, Any], problem: str
) -> None:
    assert (LEAST_RUNS, MOST_RUNS) == (3, 200)
    request: dict[str, Any] = {"limits": LIMITS, "minutes": 2.0, "noise_rms": NOISE_N} | change
    with pytest.raises(InputError, match=problem):
        plan(MODEL, **request)


@pytest.mark.parametrize(
    ("run_s", "loads"), [("6", ()), pytest.param("30", ("50", "150"), marks=pytest.mark.extended)]
)
def test_plan_command_writes_runs_that_the_power_command_reads(
    run_s: str, loads: tuple[str, ...], tmp_path: Path
) -> None:
    rig, out, table = tmp_path / "rig.toml", tmp_path / "plan", tmp_path / "plan.json"
    rig.write_text(RIG_TOML)
    minutes = f"{3.0 * float(run_s) / 60.0}"
    command = ["plan", str(rig), "--law", "coulomb", "--minutes", minutes, "--run-s", run_s]
    command += ["--max-velocity", "0.2", "--noise", "0.1"]
    if loads:
        command += ["--loads", *loads]
    assert main([*command, "--folder", str(out), "--json", str(table)]) == 0
    assert [f.name for f in sorted(out.glob("*.csv"))] == ["01.csv", "02.csv", "03.csv"]
    runs = read_runs([out], Rig(), need_friction=False)
    recorded = {float(run.load_n[0]) for run in runs if run.load_n is not None}
    assert recorded == {float(load) for load in loads}
    found = json.loads(table.read_text())
    assert [row["run"] for row in found["plan"]] == ["01", "02", "03"]
    effects = {row["effect"] for row in found["power"]}
    assert "inertia" in effects
    assert ("dry_load_dependence" in effects) == bool(loads)
    assert main(["power", str(rig), str(out), "--law", "coulomb", "--noise", "0.1"]) == 0


@pytest.mark.parametrize(
    ("options", "limit_m", "source"),
    [
        (["--travel", "150 mm"], 0.15, "given"),
        pytest.param(["--travel", "0.15"], 0.15, "given", marks=pytest.mark.extended),
        ([], 0.2, "recorded"),
    ],
)
def test_plan_stays_within_the_given_or_the_recorded_travel(
    options: list[str], limit_m: float, source: str, tmp_path: Path
) -> None:
    """The runs of the model cover 0.2 m."""
    path, table, out = tmp_path / "model.toml", tmp_path / "plan.json", tmp_path / "plan"
    t = 0.02 * np.arange(1000.0)
    friction = coulomb(t, 0.1 * np.sin(t), t) + 0.1 * np.random.default_rng(0).normal(size=1000)
    run = Run.from_arrays(t, 0.1 * np.sin(t), friction, position_m=1.0 - 0.1 * np.cos(t))
    fit(Rig(), [run], law="coulomb").model.save(path)
    command = ["plan", str(path), "--minutes", "0.5", "--run-s", "10", "--max-velocity", "0.2"]
    command += ["--folder", str(out), "--json", str(table), *options]
    assert main(command) == 0
    found = json.loads(table.read_text())
    assert found["travel_limit"] == pytest.approx(limit_m, rel=1e-3)
    assert found["travel_source"] == source
    paths = [run.position_m for run in read_runs([out], Rig(), need_friction=False)]
    travels = [float(np.ptp(path)) for path in paths if path is not None]
    assert len(travels) == 3
    assert max(travels) == pytest.approx(found["travel"], rel=1e-3)
    assert max(travels) <= limit_m


def test_plan_without_a_travel_reports_the_travel_of_its_motions() -> None:
    found, table = planned(), planned().to_dict()
    assert (found.travel_limit, found.travel_source) == (None, None)
    paths = [run.position_m for run in found.runs]
    assert table["travel"] == max(np.ptp(path) for path in paths if path is not None)
    assert "--travel" in found.summary()


def test_plan_command_without_the_noise_is_rejected(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "rig.toml").write_text(RIG_TOML)
    command = ["plan", str(tmp_path / "rig.toml"), "--law", "coulomb", "--max-velocity", "1"]
    assert main(command) == 2
    assert "--noise is missing" in capsys.readouterr().err


def motion(name: str, rate: float = 1.0) -> Run:
    return Run.from_arrays(TIME_S, 0.1 * np.sin(rate * TIME_S), name=name)


@pytest.mark.parametrize("noise_rms", [0.01, 0.5])
def test_planned_runs_have_the_friction_of_the_model_and_white_noise(noise_rms: float) -> None:
    """Friction already contained in a planned run is ignored."""
    other = replace(motion("b"), friction=7.0 * motion("b").velocity)
    campaign = as_recorded(MODEL, [motion("a"), other], noise_rms, DEFAULT).campaign
    clean = MODEL.predict_many([motion("a"), motion("b")])
    noise = [p.friction - f for p, f in zip(campaign.prepared, clean, strict=True)]
    assert [float(np.std(e)) for e in noise] == pytest.approx([noise_rms] * 2, rel=0.1)
    assert abs(np.corrcoef(noise[0], noise[1])[0, 1]) < 0.15
    assert abs(np.corrcoef(noise[0][1:], noise[0][:-1])[0, 1]) < 0.15
    again = as_recorded(MODEL, [motion("a"), other], noise_rms, DEFAULT).campaign
    assert np.array_equal(again.prepared[0].friction, campaign.prepared[0].friction)


def test_samples_next_to_a_planned_reversal_are_excluded_from_the_fit() -> None:
    campaign = as_recorded(MODEL, [motion("a")], 0.1, DEFAULT).campaign
    turns = np.flatnonzero(np.diff(np.sign(campaign.prepared[0].motion.velocity)))
    assert len(turns) > 2
    counted = campaign.samples.counted[0]
    assert not counted[turns].any()
    assert not counted[turns + 1].any()
    assert np.count_nonzero(~counted) <= 2 * len(turns) + 1


@pytest.mark.parametrize("noise_rms", [0.0, -1.0, np.inf, 2.0 * MOST])
def test_planned_power_with_noise_outside_its_range_is_rejected(noise_rms: float) -> None:
    with pytest.raises(InputError, match="noise_rms"):
        planned_power(MODEL, [motion("a")], noise_rms=noise_rms)


def test_planned_power_of_no_runs_is_rejected() -> None:
    with pytest.raises(InputError, match="no run was given"):
        planned_power(MODEL, [], noise_rms=0.1)


def test_planned_power_of_a_mass_is_that_of_a_regression() -> None:
    noise_rms, runs = 0.1, [motion("a", 4.0), motion("b", 6.0), motion("c", 8.0)]
    planned, rows = planned_power(MODEL, runs, noise_rms=noise_rms), []
    found = next(p for p in planned.power if p.effect == "inertia")
    for run in runs:
        v = run.velocity
        turn = np.flatnonzero(np.diff(np.sign(v)) != 0.0)
        # The sign of the friction is unknown next to a reversal.
        known = ~np.isin(np.arange(len(v)), [*turn, *(turn + 1)])
        rows.append(np.column_stack([np.sign(v), v, np.gradient(v, TIME_S)])[known])
    design, a = np.split(np.concatenate(rows), [2], axis=1)
    left = np.linalg.norm(a - design @ np.linalg.lstsq(design, a, rcond=None)[0])
    wanted = noise_rms * np.sqrt(non_centrality(planned.level.price(1, len(a)), 1, 0.8))
    assert found.detectable_80 is not None
    assert found.detectable_80 * left == pytest.approx(wanted, rel=0.03)


def test_dictionary_of_planned_power_has_its_law_runs_level_and_results() -> None:
    planned = planned_power(MODEL, [motion("a"), motion("b", 1.7)], noise_rms=0.2)
    table = planned.to_dict()
    assert (table["law"], table["effects"], table["noise_rms"]) == ("coulomb", [], 0.2)
    assert table["runs"] == ["a", "b"]
    assert table["level"] == planned.level.to_dict()
    assert table["power"] == [p.to_dict() for p in planned.power]
    assert table["not_tried"] == planned.not_tried
    assert "position_ripple" not in {p.effect for p in planned.power}


def test_planned_power_excludes_the_effects_of_the_model() -> None:
    planned = planned_power(WITH_MASS, [motion("a"), motion("b", 1.7)], noise_rms=0.1)
    assert planned.to_dict()["effects"] == ["inertia"]
    assert "inertia" not in {p.effect for p in planned.power}


def test_friction_of_planned_runs_includes_the_effects_of_the_model() -> None:
    (run,) = as_recorded(WITH_MASS, [motion("a")], 1e-3, DEFAULT).campaign.prepared
    (without,) = as_recorded(MODEL, [motion("a")], 1e-3, DEFAULT).campaign.prepared
    inertial = run.friction - without.friction
    assert inertial == pytest.approx(0.3 * np.cos(TIME_S), abs=0.01)
