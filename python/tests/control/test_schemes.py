"""Compensators: their constants, and the error of the shaft under each of them."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Model, Rig
from jbf.control import SCHEMES, TASKS, THESIS_BENCH, Table, Task, run, scheme, thesis_model
from jbf.control.bench import FITTED
from jbf.control.constants import OBSERVER_1_S
from jbf.control.schemes import Coulomb, Learning, NoCompensation, Observed, Repetitive, gains

POSITION, VELOCITY = TASKS["position sine"], TASKS["velocity sine"]
SHORT = replace(VELOCITY, seconds=27.0)
NEWTONS = Model(Rig(), "coulomb", parameters={"F_c": 5.0, "F_v": 20.0})


def extended(*values: object) -> list[Any]:
    """Parameters of a test that runs in the extended suite only."""
    return [pytest.param(value, marks=pytest.mark.extended) for value in values]


def test_scheme_is_created_by_name_with_its_model_and_unknown_names_are_rejected() -> None:
    schemes = [scheme(name) for name in SCHEMES]
    kinds = [NoCompensation, Learning, Coulomb, Table, Repetitive, Observed]
    assert [type(s) for s in schemes] == kinds
    assert tuple(s.name for s in schemes) == SCHEMES
    assert scheme("table", NEWTONS) == Table(NEWTONS)
    assert scheme("observed", NEWTONS) == Observed(NEWTONS)
    assert scheme("table") == Table(thesis_model())
    assert scheme("learning", thesis_model()) == Learning.of(thesis_model())
    with pytest.raises(InputError, match='did you mean "none"'):
        scheme("non")


def test_feedback_gains_of_the_thesis_bench_are_those_of_the_thesis() -> None:
    assert gains(POSITION, THESIS_BENCH) == (0.43764, -0.25164)
    assert gains(VELOCITY, THESIS_BENCH) == (1.0, 0.295)


OTHER_DRIVE = replace(THESIS_BENCH, damping_1_s=10.0, input_rad_s2_v=100.0)


def test_closed_loop_poles_do_not_depend_on_the_drive() -> None:
    k1, k2 = gains(POSITION, OTHER_DRIVE)
    a, b = OTHER_DRIVE.damping_1_s, OTHER_DRIVE.input_rad_s2_v
    poles = np.sort_complex(np.roots([1.0, a + b * k2, b * k1]))
    assert np.allclose(poles, [-10.0 - 10.0j, -10.0 + 10.0j])


def test_observed_compensator_reduces_the_error_tenfold_on_another_drive() -> None:
    none, ours = (run(None, s, SHORT, bench=OTHER_DRIVE).true_rms for s in ("none", "observed"))
    assert ours < 0.1 * none


CONSTANT = Model(Rig(), "coulomb", parameters={"F_c": 5.0, "F_s": 5.0, "F_v": 1e-6})
"""Friction of 5 N, independent of the speed."""
TENTH_VOLT = replace(THESIS_BENCH, volts_per_n=0.1)


def test_coulomb_observer_learns_the_friction_level_in_volts_within_15_percent() -> None:
    r = run(CONSTANT, Coulomb(), SHORT, bench=TENTH_VOLT)
    assert r.learned_0[0] == pytest.approx(0.0, abs=0.05)
    assert r.learned_0[-1] == pytest.approx(0.5, rel=0.15)


def test_coulomb_observer_starts_at_its_initial_value_and_stops_at_its_limit() -> None:
    started = run(CONSTANT, Coulomb(start_v=0.4), replace(SHORT, seconds=2.1))
    assert started.learned_0[0] == pytest.approx(0.4, abs=0.05)
    limited = run(CONSTANT, Coulomb(limit_v=0.2), SHORT, bench=TENTH_VOLT)
    assert limited.learned_0[-1] == pytest.approx(0.2, abs=1e-3)


@pytest.mark.parametrize("task", [POSITION, VELOCITY], ids=["position", "velocity"])
def test_repetitive_gain_is_half_of_the_loop_stiffness_at_a_blocked_shaft(task: Task) -> None:
    """The stiffness is the output voltage per unit of error of a blocked shaft."""
    task = replace(task, seconds=6.0, skip_s=0.0)
    bench = replace(THESIS_BENCH, input_noise_v=0.0)
    held = (np.full(3000, 0.01), np.zeros(3000))
    stuck = replace(bench, volts_per_n=100.0 * bench.volts_per_n)
    r = run(thesis_model(elastic="nothing"), "none", task, bench=stuck, reference=held)
    assert np.all(r.velocity_rad_s == 0.0)
    core = Repetitive().core(task, bench)
    assert core["lap_gain"] == pytest.approx(0.5 * float(r.output_v[-1]) / 0.01, rel=1e-3)
    g, c = gains(task, bench)
    stiffness = g / (1.0 + c * 457.0 / (135.0 + OBSERVER_1_S)) if task.is_position else g + c
    assert core["lap_gain"] == pytest.approx(0.5 * stiffness)
    assert core["steps_per_lap"] == round(2.0 * math.pi / 0.25 / 0.002)
    assert core["lead_s"] == (0.1 if task.is_position else 0.02)
    given = Repetitive(gain=0.0, lead_s=0.0).core(task, bench)
    assert (given["lap_gain"], given["lead_s"]) == (0.0, 0.0)


def test_repetitive_scheme_halves_the_error_between_the_first_and_the_last_period() -> None:
    task = replace(VELOCITY, frequency_rad_s=1.0, seconds=38.0)
    error = run(None, "repetitive", task).true_error
    lap = round(task.period_s / THESIS_BENCH.dt_s)
    first, last = error[lap // 2 : lap + lap // 2], error[-lap:]
    assert np.sqrt(np.mean(last**2)) < 0.5 * np.sqrt(np.mean(first**2))


@pytest.mark.parametrize(("task", "top"), [(VELOCITY, 1.04), (POSITION, 1.0)])
def test_friction_table_has_the_steady_friction_up_to_the_top_speed(task: Task, top: float) -> None:
    """Friction of 5 N + 20 N s/m times the speed, tabulated from rest up to at least 1 rad/s."""
    core = Table(NEWTONS).core(task, THESIS_BENCH)
    speeds = core["width"] * np.arange(len(core["levels_v"]))
    assert speeds[-1] == pytest.approx(top)
    assert core["levels_v"][0] == 0.0
    expected = (5.0 + 20.0 * speeds) * THESIS_BENCH.volts_per_n
    assert core["levels_v"][1:] == pytest.approx(expected[1:].tolist())
    # The speed of a bearing is the surface speed of its journal.
    model = thesis_model()
    levels = Table(model).core(task, THESIS_BENCH)["levels_v"]
    (steady,) = model.steady_friction(np.array([top * 0.0127])) * THESIS_BENCH.volts_per_n
    assert levels[-1] == pytest.approx(float(steady))


@pytest.mark.parametrize("row", ["velocity sine", *extended("position sine", "velocity triangle")])
def test_friction_table_halves_the_error_of_sine_and_triangle_tasks(row: str) -> None:
    model = Model(Rig.thesis("4.2"))
    none, table = (run(model, s, TASKS[row]).true_rms for s in ("none", "table"))
    assert table < 0.5 * none


FAST_ROWS = ["position triangle", "velocity square"]


@pytest.mark.parametrize("row", [*FAST_ROWS, *extended(*(r for r in TASKS if r not in FAST_ROWS))])
def test_observed_compensator_halves_the_thesis_error_except_in_position_square(row: str) -> None:
    learning, coulomb, observed = (
        run(None, s, TASKS[row]).true_rms for s in ("learning", "coulomb", "observed")
    )
    factor = 1.3 if row == "position square" else 2.0
    assert min(learning, coulomb) / observed > factor


@pytest.mark.parametrize("counts_per_rad", [100.0, *extended(652.0, 30.0)])
def test_observed_compensator_with_a_coarse_encoder_reduces_the_error(
    counts_per_rad: float,
) -> None:
    bench = replace(THESIS_BENCH, counts_per_rad=counts_per_rad)
    for row in ("position square", "position sine", "velocity triangle"):
        task = replace(TASKS[row], seconds=26.0)
        none, ours = (run(None, s, task, bench=bench).true_rms for s in ("none", "observed"))
        assert ours < none, row


def test_observed_compensator_error_is_smaller_if_started_from_the_learned_level() -> None:
    halved = thesis_model(f_m=0.13)
    level = float(run(None, Observed(halved), SHORT).learned_0[-1])
    assert level > 0.1
    start = replace(SHORT, seconds=3.0, skip_s=0.0)
    cold, warm = (run(None, Observed(halved, start=(v, 0.0)), start) for v in (0.0, level))
    assert warm.true_rms < cold.true_rms


def test_learning_scheme_has_the_initial_values_of_chapter_six_of_the_thesis() -> None:
    learning = Learning()
    assert (learning.f_m, learning.u_tr_m_s, learning.eps_tr) == (0.26, 0.05, 0.9747)
    assert (learning.k0, learning.gamma) == (650_000.0, 33.0)
    core = learning.core(VELOCITY, THESIS_BENCH)
    assert core["volts"] == pytest.approx(THESIS_BENCH.volts_per_n * 104.0)
    assert Learning(volts=3.5).core(VELOCITY, THESIS_BENCH)["volts"] == 3.5


def test_learning_scheme_has_initial_values_and_bounds_of_the_given_model() -> None:
    learning = Learning.of(thesis_model(clock="journal", gamma=50.0))
    assert (learning.k0, learning.gamma) == (FITTED["K0"], 50.0)
    assert (learning.u_tr_m_s, learning.f_m) == (FITTED["U_tr_m_s"], 0.26)
    assert (learning.eps_tr, learning.clock) == (None, "journal")
    assert learning.k0_bounds == pytest.approx((1e-4 * FITTED["K0"], 1e2 * FITTED["K0"]))
    assert learning.gamma_bounds == pytest.approx((5e-3, 5e3))
    r = run(thesis_model(), "learning", replace(SHORT, seconds=2.1))
    assert (r.learned_0[0], r.learned_1[0]) == pytest.approx((FITTED["K0"], FITTED["gamma"]), 0.01)


def test_learning_scheme_reduces_the_error_on_the_model_that_it_starts_from() -> None:
    model = Model(Rig.thesis("4.2"))
    none, learning = (run(model, s, SHORT).true_rms for s in ("none", "learning"))
    assert learning < 0.6 * none


def test_learning_scheme_of_a_law_without_a_film_is_rejected() -> None:
    with pytest.raises(InputError, match="coulomb"):
        Learning.of(NEWTONS)
