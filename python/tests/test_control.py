"""Loops on the simulated bench: what they must do whatever the friction."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jbf import (
    InputError,
    Model,
    Parameter,
    Rig,
    Run,
    control,
    forget_effect,
    register_effect,
)
from jbf.control import TASKS, THESIS_BENCH, Learning, Observed, run, thesis_model
from jbf.control.bench import with_noise
from jbf.control.constants import FALLBACK, FROZEN, JUMPED, NOT_FINITE, SATURATED
from jbf.control.robustness import cases
from jbf.control.schemes import gains

QUIET = replace(THESIS_BENCH, input_noise_v=0.0)
SHORT = replace(TASKS["velocity sine"], seconds=27.0)


def test_a_user_needs_one_import() -> None:
    code = "import jbf; print(jbf.control.run(scheme='none').rms > 0.1)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout == "True\n"


def test_the_same_seed_gives_the_same_run_and_another_seed_another() -> None:
    once, again = (run(task=SHORT, scheme="coulomb") for _ in range(2))
    assert np.array_equal(once.angle_rad, again.angle_rad)
    other = run(task=SHORT, scheme="coulomb", bench=replace(THESIS_BENCH, seed=2))
    assert not np.array_equal(once.angle_rad, other.angle_rad)


def test_the_plant_obeys_its_equation() -> None:
    """v' = -a v + b (u - F): exact over a step of constant input and friction."""
    bench = replace(QUIET, inner_steps=1)
    r = run(task=SHORT, scheme="none", bench=bench)
    keep = np.exp(-bench.damping_1_s * bench.dt_s)
    gain = bench.input_rad_s2_v / bench.damping_1_s * (1.0 - keep)
    expected = keep * r.velocity_rad_s[:-1] + gain * (r.output_v[:-1] - r.friction_v[1:])
    assert np.max(np.abs(expected - r.velocity_rad_s[1:])) < 1e-9


def test_without_friction_velocity_control_has_the_error_of_its_transfer_function() -> None:
    """A first-order plant under u = -g (v_hat - r) + C r with the observer's lag 1/k."""
    task = replace(SHORT, frequency_rad_s=2.0, seconds=40.0, skip_s=10.0)
    r = run(None, "none", task, bench=replace(QUIET, volts_per_n=1e-12))
    s = 2.0j
    a, b, k, g, c = 135.0, 457.0, 15.0, 1.0, 0.295
    closed = b * (g + c) / (s + a + b * g * k / (s + k))
    counting = r.time_s >= task.skip_s
    wave = np.exp(s * r.time_s[counting])
    found = 2.0 * np.mean(r.velocity_rad_s[counting] * np.conj(wave)) / (1.04 * -1j)
    assert abs(found - closed) < 0.01


def test_a_shaft_pushed_below_its_level_rests_for_an_hour() -> None:
    task = replace(TASKS["position sine"], seconds=3600.0)
    steps = round(task.seconds / THESIS_BENCH.dt_s)
    # 0.1 rad off asks for 0.19 V; the journal holds 0.76 V.
    still = (np.full(steps, 0.1), np.zeros(steps))
    r = run(thesis_model(elastic="nothing"), "none", task, bench=QUIET, reference=still)
    assert np.all(r.angle_rad == 0.0)
    assert np.all(r.velocity_rad_s == 0.0)
    assert r.friction_v[-1] == pytest.approx(r.output_v[-1], rel=1e-9)


@pytest.mark.parametrize("row", TASKS)
def test_ours_is_better_than_both_of_the_thesis(row: str) -> None:
    """By what the shaft truly did, on the bench of the tables."""
    learning, coulomb, ours = (
        run(None, s, TASKS[row]).true_rms for s in ("learning", "coulomb", "observed")
    )
    assert min(learning, coulomb) / ours > (1.3 if row == "position square" else 2.0)


@pytest.mark.parametrize("row", ["position sine", "velocity sine", "velocity triangle"])
def test_a_table_does_not_hunt(row: str) -> None:
    model = Model(Rig.thesis("4.2"))
    none, table = (run(model, s, TASKS[row]).true_rms for s in ("none", "table"))
    assert table < 0.5 * none


def test_another_drive_has_the_same_poles() -> None:
    drive = replace(THESIS_BENCH, damping_1_s=10.0, input_rad_s2_v=100.0)
    k1, k2 = gains(TASKS["position sine"], drive)
    a, b = drive.damping_1_s, drive.input_rad_s2_v
    poles = np.sort_complex(np.roots([1.0, a + b * k2, b * k1]))
    assert np.allclose(poles, [-10.0 - 10.0j, -10.0 + 10.0j])
    errors = [run(None, s, SHORT, bench=drive).true_rms for s in ("none", "observed")]
    assert errors[1] < 0.1 * errors[0]


def test_a_loop_may_be_told_of_another_drive() -> None:
    weak = replace(THESIS_BENCH, input_rad_s2_v=380.0)
    knows = run(None, "observed", SHORT, bench=weak)
    told = run(None, "observed", SHORT, bench=weak, told=THESIS_BENCH)
    assert not np.array_equal(knows.output_v, told.output_v)
    assert told.true_rms < 0.1 * run(None, "none", SHORT, bench=weak, told=THESIS_BENCH).true_rms
    with pytest.raises(InputError, match="steps"):
        run(None, "none", SHORT, told=replace(THESIS_BENCH, dt_s=0.001))


def test_in_single_precision_too() -> None:
    double, single = (run(task=SHORT, precision=p) for p in ("f64", "f32"))
    assert single.true_rms == pytest.approx(double.true_rms, rel=0.1)
    # It is single precision: what comes out of the loop are single numbers, and only there.
    assert np.array_equal(single.output_v, single.output_v.astype(np.float32))
    assert not np.array_equal(double.output_v, double.output_v.astype(np.float32))


def test_flags_have_a_bit_each() -> None:
    flags = (SATURATED, FROZEN, JUMPED, NOT_FINITE, FALLBACK)
    assert sorted(flags) == [1, 2, 4, 8, 16]


def test_the_thesiss_drive_has_the_thesiss_gains() -> None:
    assert gains(TASKS["position sine"], THESIS_BENCH) == (0.43764, -0.25164)
    assert gains(TASKS["velocity sine"], THESIS_BENCH) == (1.0, 0.295)


def test_a_compensator_that_is_none_is_refused() -> None:
    class Unknown(control.NoCompensation):
        def core(self, task: control.Task, bench: control.Bench) -> dict[str, Any]:
            return {"kind": "magic"}

    with pytest.raises(InputError, match="magic"):
        run(None, Unknown(), SHORT)


def test_the_true_error_is_the_shafts() -> None:
    r = run(task=SHORT)
    error = (r.velocity_rad_s - r.reference)[r.time_s >= SHORT.skip_s - 1e-9]
    assert r.true_rms == pytest.approx(float(np.sqrt(np.mean(error**2))))
    assert r.true_rms != r.rms


@pytest.mark.parametrize("scheme", control.SCHEMES)
@pytest.mark.parametrize("row", ["position sine", "velocity sine"])
def test_a_frozen_encoder_ends_compensation_and_nothing_else(scheme: str, row: str) -> None:
    task = replace(TASKS[row], seconds=20.0)
    guard = control.tune(thesis_model())
    r = run(None, scheme, task, guard=guard, frozen_s=(8.0, 12.0))
    assert np.all(np.isfinite(r.output_v))
    assert np.max(np.abs(r.output_v)) <= THESIS_BENCH.limit_v
    blind = (r.status & FROZEN) > 0
    assert not blind[r.time_s < 8.0].any()
    if blind.any():
        assert np.all(r.status[blind] & FALLBACK)
        alone = (r.status & FALLBACK) > 0
        inside = np.abs(r.base_v) < THESIS_BENCH.limit_v
        assert np.array_equal(r.output_v[alone & inside], r.base_v[alone & inside])
    # Two seconds after the counter lives again all is well.
    assert np.all(r.status[r.time_s > 15.0] & (FROZEN | FALLBACK) == 0)


def test_a_jump_of_the_counter_is_not_believed() -> None:
    r = run(task=SHORT, jump=(10.0, 9000))
    at = np.flatnonzero(r.status & JUMPED)
    assert at.tolist() == [5000]
    assert np.max(np.abs(r.true_error[r.time_s > 1.0])) < 0.5


def test_a_step_of_ten_radians_settles() -> None:
    task = replace(TASKS["position square"], seconds=12.0)
    n = round(task.seconds / THESIS_BENCH.dt_s)
    step = (np.full(n, 10.0), np.zeros(n))
    r = run(task=task, reference=step)
    assert np.max(r.angle_rad) < 11.0
    assert np.max(np.abs(r.true_error[r.time_s > 8.0])) < 0.02


def test_the_load_doubles_while_it_runs() -> None:
    n = round(SHORT.seconds / THESIS_BENCH.dt_s)
    load = np.where(np.arange(n) < n // 2, 104.0, 208.0)
    errors = {s: run(None, s, SHORT, load_n=load).true_rms for s in ("none", "observed")}
    assert errors["observed"] < 0.2 * errors["none"]


def test_no_effect_harms_at_four_times_the_noise() -> None:
    """The wrongest of `jbf control robustness` at a quarter of its cost."""
    from jbf.control.robustness import HARM, robustness

    rows = {row: TASKS[row] for row in ("position sine", "velocity triangle")}
    found = robustness(bench=with_noise(THESIS_BENCH, 4.0), tasks=rows)
    assert len(found) > 20
    assert {o.name for o in found if o.worst > HARM} == set()


@pytest.mark.parametrize("counts_per_rad", [652.0, 100.0, 30.0])
def test_a_coarse_encoder_does_no_harm(counts_per_rad: float) -> None:
    bench = replace(THESIS_BENCH, counts_per_rad=counts_per_rad)
    for row in ("position square", "position sine", "velocity triangle"):
        none, ours = (run(None, s, TASKS[row], bench=bench).true_rms for s in ("none", "observed"))
        assert ours < none, row


def test_the_learning_scheme_takes_a_fitted_model() -> None:
    model = Model(Rig.thesis("4.2"))
    errors = [run(model, s, SHORT).true_rms for s in ("none", "learning")]
    assert errors[1] < 0.6 * errors[0]
    with pytest.raises(InputError, match="coulomb"):
        Learning.of(Model(Rig.thesis(), law="coulomb"))


def test_the_listings_scale_chatters_where_the_rigs_own_does_not() -> None:
    """Why 25.5 V cannot be what ran in the position rows: it turns the shaft to and fro."""
    from jbf.control.schemes import LISTED_VOLTS

    task = replace(TASKS["position sine"], seconds=25.0)
    turns = {}
    for volts in (None, LISTED_VOLTS):
        r = run(None, Learning(volts=volts), task)
        turns[volts] = int(np.sum(np.diff(np.sign(r.velocity_rad_s)) != 0))
    assert turns[LISTED_VOLTS] > 5 * turns[None]


def test_settings_follow_the_model_and_survive_a_file(tmp_path: Path) -> None:
    settings = control.tune(thesis_model())
    settings.save(tmp_path / "s.toml")
    again = control.Settings.load(tmp_path / "s.toml")
    for name, value in vars(settings).items():
        assert getattr(again, name) == pytest.approx(value, rel=1e-5)
    strong = control.tune(thesis_model(f_m=0.5))
    assert strong.level_limit_v > 1.5 * settings.level_limit_v
    noisy = control.tune(thesis_model(), replace(THESIS_BENCH, encoder_noise_counts=20.0))
    assert noisy.bandwidth_rad_s < settings.bandwidth_rad_s


def test_what_was_learned_can_be_started_from() -> None:
    wrong = thesis_model(f_m=0.13)
    scheme = Observed(wrong)
    cold = run(None, scheme, SHORT)
    level = float(cold.learned_0[-1])
    assert level > 0.1
    warm = run(None, replace(scheme, start=(level, 0.0)), replace(SHORT, seconds=3.0, skip_s=0.0))
    cold = run(None, scheme, replace(SHORT, seconds=3.0, skip_s=0.0))
    assert warm.true_rms < cold.true_rms


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"damping_1_s": 0.0}, "damping_1_s"),
        ({"dt_s": float("nan")}, "dt_s"),
        ({"seed": -1}, "seed"),
        ({"counter_bits": 40}, "counter_bits"),
        ({"input_noise_v": -1.0}, "input_noise_v"),
    ],
)
def test_a_bench_that_is_none(change: dict[str, float], word: str) -> None:
    with pytest.raises(InputError, match=word):
        replace(THESIS_BENCH, **change)  # type: ignore[arg-type]


def test_an_effect_of_ones_own_is_no_loops() -> None:
    drag = Parameter("c", "N s/m", lower=-5.0, upper=5.0, null=0.0, starts=(0.1,))
    register_effect(lambda velocity_m_s, c: c * velocity_m_s, name="my_drag", parameters=[drag])
    try:
        model = Model(Rig.thesis(), effects=["my_drag"])
        with pytest.raises(InputError, match="my_drag is an effect of your own"):
            run(model, "none", SHORT)
        assert all("my_drag" not in case.name for case in cases(Model(Rig.thesis())))
    finally:
        forget_effect("my_drag")


def test_a_recorded_motion_is_the_reference() -> None:
    time_s = np.arange(0.0, 20.0, 0.02)
    speed = 0.02 * np.sin(time_s)
    angle = 3.0 + 0.02 * (1.0 - np.cos(time_s)) / 0.0127
    load = np.where(time_s < 10.0, 104.0, 150.0)
    recorded = Run.from_arrays(time_s, speed, angle_rad=angle, load_n=load)
    for what, wanted, rate in (
        ("velocity", np.sin, np.cos),
        ("position", lambda t: 1.0 - np.cos(t), np.sin),
    ):
        task, reference, load_n = control.follow(recorded, Rig.thesis(), what)
        assert reference is not None
        t = np.arange(len(reference[0])) * THESIS_BENCH.dt_s
        assert np.allclose(reference[0], 0.02 / 0.0127 * wanted(t), atol=2e-4)
        assert np.allclose(reference[1][20:-20], 0.02 / 0.0127 * rate(t)[20:-20], atol=2e-3)
        assert load_n is not None
        r = run(None, "observed", task, reference=reference, load_n=load_n)
        assert r.true_rms < 0.1 * float(np.std(reference[0]))


def test_a_recorded_motion_that_is_none() -> None:
    still = Run.from_arrays(np.arange(12.0), np.zeros(12))
    with pytest.raises(InputError, match="does not move"):
        control.follow(still, Rig.thesis())
    with pytest.raises(InputError, match="angle"):
        control.follow(still, Rig.thesis(), "position")
    with pytest.raises(InputError, match="reference"):
        run(task=replace(SHORT, wave="recorded"))


def test_references_and_loads_of_the_wrong_length_or_kind() -> None:
    with pytest.raises(InputError, match="one length"):
        run(task=SHORT, reference=(np.zeros(5), np.zeros(6)))
    with pytest.raises(InputError, match="finite"):
        run(task=SHORT, load_n=float("nan"))
