"""The simulated bench: its equation of motion, its noise, its friction, and invalid values."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Model, Parameter, Rig, forget_effect, register_effect
from jbf.control import TASKS, THESIS_BENCH, run, thesis_model
from jbf.control.bench import (
    ELASTIC,
    FITTED,
    THESIS_LOAD_N,
    THESIS_RIG,
    VOLTS_PER_N_M,
    core_model,
    with_noise,
)
from jbf.control.constants import COUNTS_PER_RAD
from jbf.control.schemes import LISTED_VOLTS

QUIET = replace(THESIS_BENCH, input_noise_v=0.0)
SHORT = replace(TASKS["velocity sine"], seconds=12.0)
POSITIVE = [
    "damping_1_s", "input_rad_s2_v", "volts_per_n", "limit_v", "counts_per_rad", "dt_s",
    "inner_steps",
]  # fmt: skip
NOT_NEGATIVE = ["input_noise_v", "encoder_noise_counts", "stood_s"]


def test_bench_has_the_constants_of_the_thesis() -> None:
    assert (THESIS_BENCH.damping_1_s, THESIS_BENCH.input_rad_s2_v) == (135.0, 457.0)
    assert (THESIS_BENCH.dt_s, THESIS_BENCH.inner_steps) == (0.002, 2)
    assert pytest.approx(104.0) == THESIS_LOAD_N
    # A friction coefficient of 1 is 25.5 V in inches and pounds, 2.89 V in metres and newtons.
    assert pytest.approx(25.5, abs=0.1) == LISTED_VOLTS
    assert pytest.approx(2.89, abs=0.01) == 4.0 * 0.0127 * 104.0 * VOLTS_PER_N_M


def test_simulated_shaft_without_noise_obeys_its_equation_of_motion() -> None:
    """Exact solution of v' = -a v + b (u - F) over a step of constant input and friction."""
    bench = replace(QUIET, inner_steps=1)
    r = run(None, "none", SHORT, bench=bench)
    decay = math.exp(-bench.damping_1_s * bench.dt_s)
    gain = bench.input_rad_s2_v / bench.damping_1_s * (1.0 - decay)
    expected = decay * r.velocity_rad_s[:-1] + gain * (r.output_v[:-1] - r.friction_v[1:])
    assert np.max(np.abs(expected - r.velocity_rad_s[1:])) < 1e-9


def test_velocity_loop_without_friction_has_the_analytical_transfer_function() -> None:
    """First-order plant under u = -g (v_hat - r) + c r; v_hat has the observer's lag 1/k."""
    task = replace(SHORT, frequency_rad_s=2.0, seconds=40.0, skip_s=10.0)
    r = run(None, "none", task, bench=replace(QUIET, volts_per_n=1e-12))
    s = 2.0j
    a, b, k, g, c = 135.0, 457.0, 15.0, 1.0, 0.295
    closed_loop = b * (g + c) / (s + a + b * g * k / (s + k))
    counted = r.time_s >= task.skip_s
    wave = np.exp(s * r.time_s[counted])
    response = 2.0 * np.mean(r.velocity_rad_s[counted] * np.conj(wave)) / (1.04 * -1j)
    assert abs(response - closed_loop) < 0.01


def test_shaft_below_the_breakaway_voltage_stays_at_rest_for_ten_minutes() -> None:
    """An error of 0.1 rad gives 0.19 V, below the breakaway voltage of 0.76 V."""
    task = replace(TASKS["position sine"], seconds=600.0)
    held = (np.full(300_000, 0.1), np.zeros(300_000))
    r = run(thesis_model(elastic="nothing"), "none", task, bench=QUIET, reference=held)
    assert np.all(r.angle_rad == 0.0)
    assert np.all(r.velocity_rad_s == 0.0)
    assert r.friction_v[-1] == pytest.approx(r.output_v[-1], rel=1e-9)


def test_friction_of_a_sliding_shaft_equals_the_coulomb_law_in_volts() -> None:
    model = Model(Rig(), "coulomb", parameters={"F_c": 5.0, "F_s": 5.0, "F_v": 3.0})
    r = run(model, "none", SHORT, bench=replace(QUIET, volts_per_n=0.05))
    # Friction is constant over the step that leads to the velocity.
    before, after = r.velocity_rad_s[:-1], r.velocity_rad_s[1:]
    sliding = np.minimum(np.abs(before), np.abs(after)) > 0.2
    expected = 0.05 * (5.0 * np.sign(before) + 3.0 * before)
    assert np.count_nonzero(sliding) > 1000
    assert r.friction_v[1:][sliding] == pytest.approx(expected[sliding], abs=0.01)


def test_measured_angle_is_an_integer_number_of_encoder_counts() -> None:
    r = run(None, "observed", SHORT)
    counts = r.measured_angle_rad * THESIS_BENCH.counts_per_rad
    assert counts == pytest.approx(np.round(counts), abs=1e-6)
    assert np.max(np.abs(r.measured_angle_rad - r.angle_rad)) <= 1.01 / COUNTS_PER_RAD


def test_simulated_runs_are_equal_if_and_only_if_their_noise_seeds_are() -> None:
    benches = (THESIS_BENCH, THESIS_BENCH, replace(THESIS_BENCH, seed=2))
    first, second, other = (run(None, "coulomb", SHORT, bench=b).angle_rad for b in benches)
    assert np.array_equal(first, second)
    assert not np.array_equal(first, other)


@pytest.mark.parametrize("factor", [0.5, 1.0, 4.0])
@pytest.mark.parametrize("counts", [0.0, 0.7])
def test_scaled_noise_multiplies_encoder_variance_including_rounding(
    factor: float, counts: float
) -> None:
    """Rounding to integer counts adds a variance of 1/12 (Widrow), the minimum of any encoder."""
    bench = with_noise(replace(THESIS_BENCH, encoder_noise_counts=counts), factor)
    assert bench.input_noise_v == pytest.approx(0.005 * factor)
    expected = max(factor**2 * (counts**2 + 1.0 / 12.0) - 1.0 / 12.0, 0.0)
    assert bench.encoder_noise_counts**2 == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("elastic", "effects"),
    [("belt", ("drive_compliance",)), ("contact", ("presliding",)), ("nothing", ())],
)
def test_thesis_model_has_given_elastic_element_and_parameters(elastic: str, effects: Any) -> None:
    model = thesis_model(elastic=elastic, clock="journal", K0=1e6)
    assert (model.effects, model.clock, model.rig) == (effects, "journal", THESIS_RIG)
    values = {n: p.value for n, p in model.parameters.items()}
    assert values == {"f_m": 0.26, **FITTED, "K0": 1e6, **ELASTIC[elastic]}
    # At f_m = 0.26 the contact deflects by one encoder count before it slides.
    stiffness = ELASTIC["contact"]["presliding.sigma"]
    assert stiffness * 0.0127 / COUNTS_PER_RAD == pytest.approx(0.26)


def test_core_model_has_the_parameters_of_law_effects_bearing_and_load() -> None:
    values = {"F_c": 5.0, "F_s": 6.0, "F_v": 20.0, "running_in.a": 0.5, "running_in.s_0": 0.2}
    content = core_model(Model(Rig(), "coulomb", ["running_in"], values))
    assert content["parameters"] == [5.0, 6.0, 20.0]
    assert content["effects"] == [("running_in", [0.5, 0.2])]
    assert (content["bearing"], content["load_n"]) == (None, 1.0)
    bearing = core_model(thesis_model())
    assert bearing["load_n"] == THESIS_LOAD_N
    assert bearing["bearing"]["radius_m"] == pytest.approx(0.0127)


def test_user_defined_effect_in_a_control_loop_is_rejected_by_name() -> None:
    drag = Parameter("c", "N s/m", lower=-5.0, upper=5.0, null=0.0, starts=(0.1,))
    register_effect(lambda velocity, c: c * velocity, name="my_drag", parameters=[drag])
    try:
        with pytest.raises(InputError, match="my_drag"):
            run(Model(Rig.thesis(), effects=["my_drag"]), "none", SHORT)
    finally:
        forget_effect("my_drag")


@pytest.mark.parametrize(
    ("name", "accepted", "refused"),
    [
        *((n, (1e-9,), (0.0, -1.0, math.inf, math.nan)) for n in POSITIVE),
        *((n, (0.0,), (-1e-12, math.inf, math.nan)) for n in NOT_NEGATIVE),
        ("seed", (0, 2**64 - 1), (-1, 2**64)),
        ("counter_bits", (8, 32), (7, 33)),
    ],
)
def test_bench_quantity_outside_its_range_is_rejected(
    name: str, accepted: Any, refused: Any
) -> None:
    for value in accepted:
        assert getattr(replace(THESIS_BENCH, **{name: value}), name) == value
    for value in refused:
        with pytest.raises(InputError, match=name):
            replace(THESIS_BENCH, **{name: value})
