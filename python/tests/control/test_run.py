"""One run of the control loop: errors, references, loads, faults, and the compensator's model."""

import csv
import io
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import InputError, control
from jbf.control import TASKS, THESIS_BENCH, Coulomb, Observed, Result, run, thesis_model
from jbf.control.constants import FALLBACK, FROZEN, JUMPED, SATURATED
from jbf.control.task import RECORDED

SHORT = replace(TASKS["velocity sine"], seconds=14.0)


def same(a: Result, b: Result) -> bool:
    """Return whether two runs agree in every column."""
    return all(np.array_equal(x, b.columns()[n]) for n, x in a.columns().items())


@pytest.mark.parametrize("row", ["position sine", "velocity sine"])
def test_rms_and_peak_errors_of_a_run_exclude_the_skipped_seconds(row: str) -> None:
    task = replace(TASKS[row], seconds=6.0, skip_s=1.5)
    r = run(None, "coulomb", task)
    counted = np.arange(len(r.time_s)) >= 750
    known = r.measured_angle_rad if task.is_position else r.estimated_velocity_rad_s
    true = (r.angle_rad if task.is_position else r.velocity_rad_s) - r.reference
    assert r.error == pytest.approx(known - r.reference, abs=1e-12)
    assert r.true_error == pytest.approx(true)
    assert r.rms == pytest.approx(math.sqrt(np.mean(r.error[counted] ** 2)))
    assert r.peak == pytest.approx(np.max(np.abs(r.error[counted])))
    assert r.true_rms == pytest.approx(math.sqrt(np.mean(true[counted] ** 2)))


def test_output_voltage_is_control_law_plus_compensation_within_the_limit() -> None:
    r, limit = run(None, "observed", SHORT), THESIS_BENCH.limit_v
    expected = np.clip(r.base_v + r.compensation_v, -limit, limit)
    assert r.output_v == pytest.approx(expected, abs=1e-9)


def test_output_voltage_saturates_at_the_amplifier_limit_with_a_status_flag() -> None:
    task = replace(TASKS["position square"], seconds=2.0)
    bench, reference = replace(THESIS_BENCH, limit_v=2.0), (np.full(1000, 40.0), np.zeros(1000))
    r = run(None, "none", task, bench=bench, reference=reference)
    assert np.max(np.abs(r.output_v)) == 2.0
    assert np.any(r.status & SATURATED)
    assert np.all(np.abs(r.output_v[(r.status & SATURATED) > 0]) == 2.0)


def test_result_of_a_run_has_errors_in_json_and_all_samples_in_csv() -> None:
    r = run(None, "none", replace(SHORT, seconds=2.1))
    content = r.to_dict()
    assert (content["scheme"], content["task"]["wave"]) == ("none", "sine")
    assert (content["rms"], content["peak"], content["true_rms"]) == (r.rms, r.peak, r.true_rms)
    rows = list(csv.DictReader(io.StringIO(r.to_csv())))
    assert len(rows) == len(r.time_s)
    for name, values in r.columns().items():
        assert [float(row[name]) for row in rows] == values.tolist()


@pytest.mark.parametrize(("seconds", "steps"), [(1.0, 500), (0.0031, 2), (1e-4, 1)])
def test_run_has_one_sample_per_step_and_a_run_shorter_than_a_step_has_one(
    seconds: float, steps: int
) -> None:
    r = run(None, "none", replace(SHORT, seconds=seconds, skip_s=0.0))
    assert r.time_s == pytest.approx(0.002 * np.arange(steps))
    assert len(r.output_v) == len(r.reference) == steps


GIVEN = replace(TASKS["position sine"], wave=RECORDED, seconds=1.0)
VALUE = 0.3 * np.sin(0.002 * np.arange(700.0))
RATE = 0.3 * np.cos(0.002 * np.arange(700.0))


def test_given_reference_replaces_the_wave_of_a_task_and_sets_its_length() -> None:
    assert np.array_equal(run(None, "none", GIVEN, reference=(VALUE, RATE)).reference, VALUE)


def test_observed_compensator_error_is_smaller_if_the_reference_rate_is_given() -> None:
    with_rate, without_rate = (
        run(None, "observed", GIVEN, reference=(VALUE, rate)) for rate in (RATE, 0.0 * RATE)
    )
    assert with_rate.true_rms < 0.8 * without_rate.true_rms


def test_default_load_equals_an_explicit_constant_load_of_the_rig() -> None:
    default = run(None, "none", SHORT)
    for load_n in (104.0, np.full(7000, 104.0)):
        assert same(default, run(None, "none", SHORT, load_n=load_n))


def test_breakaway_friction_is_proportional_to_the_load() -> None:
    """The shaft breaks away when the output reaches f_m times the load in volts."""
    task = replace(TASKS["position sine"], seconds=4.0)
    ramp = (np.linspace(0.0, 2.0, 2000), np.zeros(2000))
    model, bench = thesis_model(elastic="nothing"), replace(THESIS_BENCH, input_noise_v=0.0)
    for load_n in (50.0, 100.0):
        r = run(model, "none", task, bench=bench, reference=ramp, load_n=load_n)
        breakaway_v = 0.26 * load_n * THESIS_BENCH.volts_per_n
        assert np.max(r.friction_v) == pytest.approx(breakaway_v, rel=0.02)


OTHER_SCHEMES = (
    pytest.param(name, marks=pytest.mark.extended)
    for name in ("learning", "coulomb", "table", "repetitive")
)


@pytest.mark.parametrize("scheme", ["observed", "none", *OTHER_SCHEMES])
@pytest.mark.parametrize("row", ["position sine", "velocity sine"])
def test_compensation_is_switched_off_while_the_encoder_is_frozen(scheme: str, row: str) -> None:
    task, guard = replace(TASKS[row], seconds=16.0), control.tune(thesis_model())
    r = run(None, scheme, task, guard=guard, frozen_s=(8.0, 12.0))
    assert np.max(np.abs(r.output_v)) <= THESIS_BENCH.limit_v
    stopped = (r.time_s >= 8.0 - 1e-9) & (r.time_s < 12.0 - 1e-9)
    assert np.ptp(r.measured_angle_rad[stopped]) == 0.0
    assert np.ptp(r.angle_rad[stopped]) > 0.0
    frozen = (r.status & FROZEN) > 0
    assert not frozen[r.time_s < 8.0].any()
    assert np.all(r.status[frozen] & FALLBACK)
    fallback = ((r.status & FALLBACK) > 0) & (np.abs(r.base_v) < THESIS_BENCH.limit_v)
    assert np.array_equal(r.output_v[fallback], r.base_v[fallback])
    # The encoder resumes counting at 12 s.
    assert np.all(r.status[r.time_s > 15.0] & (FROZEN | FALLBACK) == 0)


def test_jump_of_the_counter_is_flagged_at_its_step_and_hardly_moves_the_shaft() -> None:
    r = run(None, "observed", SHORT, jump=(10.0, 9000))
    assert np.flatnonzero(r.status & JUMPED).tolist() == [5000]
    assert np.max(np.abs(r.true_error[r.time_s > 1.0])) < 0.5


def test_run_with_model_or_settings_arguments_equals_run_with_a_scheme_object() -> None:
    weak = thesis_model(f_m=0.13)
    settings = replace(control.tune(thesis_model()), bandwidth_rad_s=40.0)
    with_weak = run(None, "observed", SHORT, carried=weak)
    assert same(with_weak, run(None, Observed(weak), SHORT))
    assert not same(with_weak, run(None, "observed", SHORT))
    with_settings = run(None, "observed", SHORT, settings=settings)
    assert same(with_settings, run(None, Observed(thesis_model(), settings), SHORT))
    assert same(run(None, "coulomb", SHORT), run(None, Coulomb(), SHORT))


def test_single_precision_run_has_float32_output_and_an_error_within_10_percent() -> None:
    double, single = (run(None, "observed", SHORT, precision=p) for p in ("f64", "f32"))
    assert single.true_rms == pytest.approx(double.true_rms, rel=0.1)
    assert np.array_equal(single.output_v, single.output_v.astype(np.float32))
    assert not np.array_equal(double.output_v, double.output_v.astype(np.float32))


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"assumed": replace(THESIS_BENCH, dt_s=0.001)}, "different steps"),
        ({"reference": ([], [])}, r"\(0,\) and \(0,\)"),
        ({"reference": ([1.0], [1.0, 2.0])}, r"\(1,\) and \(2,\)"),
        ({"reference": ([[1.0]], [[1.0]])}, r"\(1, 1\)"),
        ({"load_n": math.inf}, "load is not finite"),
        ({"load_n": math.nan}, "load is not finite"),
        ({"task": replace(SHORT, wave=RECORDED)}, "reference"),
        ({"task": "sine"}, "task"),
        ({"scheme": 3}, "scheme"),
        ({"scheme": "non"}, 'did you mean "none"'),
        ({"bench": replace(THESIS_BENCH, counts_per_rad=1e9)}, "counts_per_rad"),
    ],
)
def test_invalid_argument_of_a_run_is_rejected_by_name(given: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError, match=named):
        run(**{"scheme": "none", "task": SHORT, **given})
