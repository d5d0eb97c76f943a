"""Estimation of the motion from records of speed and position of known motions."""

from typing import Any

import numpy as np
import pytest
from input_errors import input_error
from jbf import Model, Rig, Run
from jbf.records.motion.corrected_records import corrected_records
from jbf.records.motion.estimated_motion import EstimatedMotion, estimate_motion
from known_motions import STEP_S, TIME_S, Array, integrated, path_of, quantised, speed_of, white

SAMPLES = len(TIME_S)
COUNT_M = 1e-5
RADIUS_M = 0.0127
SPEED_M_S = speed_of(TIME_S) + white(SAMPLES, 1, 1e-4)
PATH_M = quantised(path_of(TIME_S), COUNT_M)
COUNT_RAD = 1.0 / 2387.3


def run_of(speed: Any = SPEED_M_S, path: Any = PATH_M, time_s: Any = TIME_S) -> Run:
    return Run.from_arrays(time_s, speed, position_m=path, name="a")


def kinds(run: Run) -> list[str]:
    return [finding.kind for finding in corrected_records(run, None).findings]


def test_recorded_speed_and_path_without_a_fault_are_used_unchanged() -> None:
    records: Any = corrected_records(run_of(), None)
    np.testing.assert_array_equal(records.path, PATH_M)
    np.testing.assert_array_equal(records.speed, SPEED_M_S)
    assert records.step == pytest.approx(COUNT_M)
    assert (records.speed_measured, records.findings, records.arm_m) == (True, (), 1.0)
    records = corrected_records(
        Run.from_arrays(TIME_S, SPEED_M_S, angle_rad=PATH_M / RADIUS_M), RADIUS_M
    )
    np.testing.assert_allclose(records.path, PATH_M)
    assert (records.step, records.arm_m) == (pytest.approx(COUNT_M), RADIUS_M)


def test_speed_is_derived_from_an_angle_only_if_the_radius_is_known() -> None:
    run = Run.from_arrays(TIME_S, angle_rad=PATH_M / RADIUS_M, name="a")
    error = input_error(corrected_records, run, None)
    assert (error.file, error.column) == ("a", "velocity_m_s")
    records: Any = corrected_records(run, RADIUS_M)
    assert [finding.kind for finding in records.findings] == ["no_speed"]
    assert (records.speed_measured, records.arm_m) == (False, RADIUS_M)
    np.testing.assert_allclose(records.speed, np.gradient(records.path, TIME_S))


@pytest.mark.parametrize(
    ("path", "speed"), [(1e3, 1.0), (-1e3, 1.0), (7.7, 1.0), (1.0, 1e3), (-1.0, 1.0)]
)
def test_wrong_unit_or_sign_of_speed_or_path_is_corrected(path: float, speed: float) -> None:
    run = run_of(speed * SPEED_M_S, path * PATH_M)
    records: Any = corrected_records(run, None)
    assert [finding.kind for finding in records.findings] == ["sign" if path == -1.0 else "units"]
    # The factor 7.7 matches no unit and is estimated.
    rtol = 2e-3 if path == 7.7 else 1e-9
    np.testing.assert_allclose(records.path, PATH_M, rtol=rtol)
    np.testing.assert_allclose(records.speed, SPEED_M_S)
    assert records.step == pytest.approx(COUNT_M, rel=rtol)
    motion = estimate_motion(run, None)
    assert motion.aside == {records.findings[0].channel}
    assert np.std(motion.velocity - speed_of(TIME_S)) < 1e-4


def test_speed_delayed_by_three_samples_is_replaced_by_the_path_derivative() -> None:
    records = corrected_records(run_of(speed_of(TIME_S - 3.0 * STEP_S)), None)
    assert [finding.kind for finding in records.findings] == ["filtered_speed"]
    assert not records.speed_measured
    np.testing.assert_allclose(records.speed, np.gradient(PATH_M, TIME_S))


def test_speed_computed_as_a_difference_of_the_path_is_reported_as_coarse() -> None:
    assert kinds(run_of(np.concatenate(([0.0], np.diff(PATH_M) / STEP_S)))) == ["coarse_speed"]


def test_glitches_held_samples_and_jitter_of_a_motion_are_each_reported_once() -> None:
    path, speed = PATH_M.copy(), SPEED_M_S.copy()
    path[300] += 0.01
    speed[500] += 0.1
    findings = corrected_records(run_of(speed, path), None).findings
    assert [finding.kind for finding in findings] == ["glitches", "glitches"]
    assert [finding.channel for finding in findings] == ["position_m", "velocity_m_s"]
    held = PATH_M.copy()
    held[601:609] = held[600]
    records: Any = corrected_records(run_of(path=held), None)
    assert [f.kind for f in records.findings] == ["held_samples"]
    np.testing.assert_allclose(records.path, PATH_M, atol=5e-5)
    uneven_s = TIME_S + white(SAMPLES, 2, 5e-4)
    path = quantised(path_of(uneven_s), COUNT_M)
    assert kinds(run_of(speed_of(uneven_s), path, uneven_s)) == ["jitter"]
    shaken_s = TIME_S + white(SAMPLES, 2, 2e-3)
    assert kinds(run_of(path=quantised(path_of(shaken_s), COUNT_M))) == ["jitter"]


def triangle_and_stops(name: str, time_s: Any) -> tuple[Array, Array]:
    """Speed and path of a triangular speed, or of strokes between stops."""
    fine_s = np.arange(0.0, 40.0, 1e-3)
    phase = np.mod(fine_s, 8.0)
    v = 0.1 * (1.0 - 2.0 * np.abs(phase / 4.0 - 1.0))
    if name == "stops":
        direction = np.where(np.mod(fine_s, 16.0) < 8.0, 1.0, -1.0)
        v = 0.08 * direction * np.clip(np.minimum(phase - 1.003, 6.007 - phase), 0.0, 1.0)
    return np.interp(time_s, fine_s, v), np.interp(time_s, fine_s, integrated(v, 1e-3))


@pytest.mark.parametrize("name", ["slow", "fast", "triangle", "stops"])
@pytest.mark.parametrize("noise", [0.0, 1e-5, 2e-3])
@pytest.mark.parametrize("count", [1e-9, 4e-4, pytest.param(4e-3, marks=pytest.mark.extended)])
def test_motion_without_a_fault_has_no_findings_and_no_glitches_at_gaps(
    name: str, noise: float, count: float
) -> None:
    time_s = 0.02 * np.arange(1500)
    if omega := {"slow": 0.05, "fast": 4.0}.get(name):
        v, x = 0.1 * np.sin(omega * time_s + 0.3), -0.1 / omega * np.cos(omega * time_s + 0.3)
    else:
        v, x = triangle_and_stops(name, time_s)
    speed = np.where(v == 0.0, 0.0, v + white(1500, 1, noise))
    angle = quantised(x / RADIUS_M, count)
    assert estimate_motion(Run.from_arrays(time_s, speed, angle_rad=angle), RADIUS_M).findings == ()
    assert estimate_motion(Run.from_arrays(time_s, speed), RADIUS_M).findings == ()
    kept = np.sort(np.random.default_rng(8).permutation(1500)[:1350])
    gappy = estimate_motion(
        Run.from_arrays(time_s[kept], speed[kept], angle_rad=angle[kept]), RADIUS_M
    )
    assert "glitches" not in {finding.kind for finding in gappy.findings}


def recorded(time_s: Array, v: Array, path: Array) -> Run:
    """A tachometer with noise except at rest, and an encoder with 15,000 counts per turn."""
    speed = np.where(v == 0.0, 0.0, v + white(len(v), 0, 1e-4))
    return Run.from_arrays(time_s, speed, angle_rad=quantised(path / RADIUS_M, COUNT_RAD))


@pytest.mark.parametrize("omega", [0.1, 2.0])
@pytest.mark.parametrize("even", [True, False])
def test_noisy_sine_is_recovered_within_its_errors_without_a_rest(omega: float, even: bool) -> None:
    time_s = np.arange(0.0, 40.0, 0.02)
    if not even:
        time_s = np.cumsum(np.random.default_rng(3).uniform(0.01, 0.03, 2000))
    v = 0.127 * np.sin(omega * time_s)
    motion = estimate_motion(
        recorded(time_s, v, 0.127 / omega * (1.0 - np.cos(omega * time_s))), RADIUS_M
    )
    assert np.std(motion.velocity - v) < 0.4e-4
    a = 0.127 * omega * np.cos(omega * time_s)
    assert np.std(motion.acceleration - a) < 2e-3 + 0.02 * 0.127 * omega
    assert np.mean(np.abs(motion.velocity - v) < 3.0 * motion.velocity_error_m_s) > 0.95
    known = motion.sign_known & ~motion.resting
    np.testing.assert_array_equal(np.sign(motion.velocity[known]), np.sign(v[known]))
    assert np.mean(motion.sign_known) > 0.98
    # A slow reversal is not a rest.
    assert not motion.resting.any()


def test_sign_of_a_recovered_motion_is_known_beyond_four_standard_errors() -> None:
    motion = estimate_motion(run_of(), None)
    np.testing.assert_allclose(motion.velocity, speed_of(TIME_S), atol=3e-4)
    np.testing.assert_allclose(motion.angle_rad, path_of(TIME_S), atol=COUNT_M)
    acceleration = 0.2 * 1.7 * np.cos(1.7 * TIME_S + 0.4) + 0.05 * 4.3 * np.cos(4.3 * TIME_S)
    assert np.std(motion.acceleration - acceleration) < 0.02
    significant = np.abs(motion.velocity) > 4.0 * motion.velocity_error_m_s
    np.testing.assert_array_equal(motion.sign_known, significant)
    assert 2e-5 < np.median(motion.velocity_error_m_s) < 1e-4
    turned = estimate_motion(
        Run.from_arrays(TIME_S, SPEED_M_S, angle_rad=PATH_M / RADIUS_M), RADIUS_M
    )
    np.testing.assert_allclose(turned.angle_rad, path_of(TIME_S) / RADIUS_M, atol=1e-3)


def test_speed_without_a_position_is_smoothed_and_integrated_to_an_angle() -> None:
    motion = estimate_motion(Run.from_arrays(TIME_S, SPEED_M_S), RADIUS_M)
    np.testing.assert_allclose(motion.velocity, speed_of(TIME_S), atol=4e-4)
    path = path_of(TIME_S) - path_of(0.0)
    np.testing.assert_allclose(motion.angle_rad * RADIUS_M, path, atol=2e-4)
    motion = estimate_motion(Run.from_arrays(TIME_S, speed_of(TIME_S)), RADIUS_M)
    np.testing.assert_allclose(motion.velocity, speed_of(TIME_S), atol=2e-5)


def test_error_of_the_imposed_speed_is_larger_where_its_record_is_noisier() -> None:
    loud = np.where((TIME_S > 3.0) & (TIME_S < 6.0), 10.0, 1.0)
    run = Run.from_arrays(TIME_S, speed_of(TIME_S) + loud * white(SAMPLES, 8, 1e-4))
    motion = estimate_motion(run, None)
    inside, outside = (TIME_S > 3.6) & (TIME_S < 5.4), TIME_S < 2.0
    error = motion.velocity_error_m_s
    assert np.median(error[inside]) > 3.0 * np.median(error[outside])
    off = np.abs(motion.velocity - speed_of(TIME_S)) / error
    assert np.sqrt(np.mean(off[inside] ** 2)) < 1.3
    assert np.sqrt(np.mean(off[outside] ** 2)) < 1.3


def test_error_of_the_imposed_speed_is_larger_if_the_path_is_noisier() -> None:
    rough = estimate_motion(run_of(path=path_of(TIME_S) + white(SAMPLES, 7, 2e-5)), None)
    np.testing.assert_allclose(rough.velocity, speed_of(TIME_S), atol=4e-4)
    error_m_s = np.median(estimate_motion(run_of(), None).velocity_error_m_s)
    assert np.median(rough.velocity_error_m_s) > 1.1 * error_m_s
    assert np.std(rough.angle_rad - path_of(TIME_S)) < 1.5e-5


def test_sign_of_the_motion_is_unknown_where_speed_contradicts_position() -> None:
    path = PATH_M + np.where(np.arange(SAMPLES) >= 400, 2e-3, 0.0)
    motion = estimate_motion(run_of(path=path), None)
    assert not motion.sign_known[398:402].any()
    assert motion.sign_known[380:390].all()


def test_wrapped_and_unwrapped_angle_give_equal_motions_and_predictions() -> None:
    time_s = np.arange(0.0, 20.0, 0.02)
    v = 0.1 + 0.05 * np.sin(time_s)
    angle = (0.1 * time_s + 0.05 * (1.0 - np.cos(time_s))) / RADIUS_M
    unwrapped = Run.from_arrays(time_s, v, angle_rad=angle)
    wrapped = Run.from_arrays(time_s, v, angle_rad=np.mod(angle + 1.0, 2.0 * np.pi) - 1.0)
    for radius_m in (RADIUS_M, None):
        one, other = estimate_motion(unwrapped, radius_m), estimate_motion(wrapped, radius_m)
        np.testing.assert_allclose(other.velocity, one.velocity, atol=1e-9)
        np.testing.assert_allclose(other.angle_rad, one.angle_rad, atol=1e-6)
    model = Model(Rig.thesis(), effects=["position_ripple"], parameters={"position_ripple.a": 0.2})
    np.testing.assert_allclose(model.predict(wrapped), model.predict(unwrapped), atol=1e-6)


def test_trapezoidal_speed_is_recovered_with_its_corners_and_rests() -> None:
    time_s = np.arange(0.0, 12.0, 0.02)
    v = 0.05 * np.clip(np.minimum(time_s - 2.0, 8.0 - time_s), 0.0, 1.0)
    path = integrated(v, 0.02)
    motion = estimate_motion(recorded(time_s, v, path), RADIUS_M)
    assert np.max(np.abs(motion.velocity - v)) < 4e-4
    np.testing.assert_array_equal(motion.resting, v == 0.0)
    assert np.all(motion.velocity[motion.resting] == 0.0)
    assert abs(motion.angle_rad[-1] - path[-1] / RADIUS_M) < 0.3 * COUNT_RAD


def test_rms_position_error_at_rests_is_below_0_15_encoder_counts() -> None:
    """Rounding to counts has an RMS error of 1 / sqrt(12) = 0.29 counts."""
    time_s = np.arange(0.0, 80.0, 0.02)
    phase, stroke = np.mod(time_s, 4.0), (time_s // 4.0).astype(int)
    way = np.where(stroke % 2 == 0, 1.0, -1.0) * (1.0 + 0.0137 * stroke)
    v = 0.005 * way * np.clip(np.minimum(phase, 2.0 - phase), 0.0, 0.5) * (phase < 2.0)
    angle = integrated(v, 0.02) / RADIUS_M
    counted = quantised(angle, COUNT_RAD)
    speed = np.where(v == 0.0, 0.0, v + white(len(v), 5, 1e-5))
    motion = estimate_motion(Run.from_arrays(time_s, speed, angle_rad=counted), RADIUS_M)
    rests = [np.flatnonzero((stroke == k) & (phase > 3.0)) for k in range(20)]
    assert all(motion.resting[rest].all() for rest in rests)

    def rms_counts(found: Array) -> float:
        errors = [np.mean(found[rest] - angle[rest]) / COUNT_RAD for rest in rests]
        return float(np.sqrt(np.mean(np.square(errors))))

    assert rms_counts(counted) == pytest.approx(0.29, abs=0.03)
    assert rms_counts(motion.angle_rad) < 0.15


def test_standstill_with_a_small_oscillation_of_the_speed_is_a_rest() -> None:
    time_s = np.arange(0.0, 12.0, 0.005)
    phase = np.mod(time_s, 2.0)
    way = np.where(np.mod(time_s, 4.0) < 2.0, 1.0, -1.0)
    v = np.where(phase < 1.4, way * 2.5e-4 * np.sin(np.pi * phase / 1.4) ** 2, 0.0)
    hum = 4e-7 * np.sin(40.0 * time_s) * (v == 0.0)
    motion = estimate_motion(run_of(v + hum, np.round(integrated(v, 0.005), 7), time_s), None)
    assert motion.resting[(v == 0.0) & (phase > 1.5) & (phase < 1.9)].all()
    assert not motion.velocity[motion.resting].any()
    assert not motion.resting[np.abs(v) > 5e-6].any()


def two_rests() -> tuple[Array, Array, EstimatedMotion]:
    """True speed, recorded speed and estimated motion, with two moving samples between rests."""
    v = np.where((TIME_S > 2.0) & (TIME_S < 4.0), 0.0, 0.1)
    v[300:302] = 0.05
    speed = np.where(v == 0.0, 0.0, v + white(SAMPLES, 4, 1e-4))
    motion = estimate_motion(run_of(speed, quantised(integrated(v, STEP_S), COUNT_M)), None)
    return v, speed, motion


def test_two_moving_samples_between_rests_keep_their_recorded_speed() -> None:
    v, speed, motion = two_rests()
    rest = v == 0.0
    np.testing.assert_array_equal(motion.resting, rest)
    assert (motion.velocity_error_m_s[rest] == 0.0).all()
    np.testing.assert_allclose(motion.velocity[300:302], speed[300:302], atol=2e-4)
    assert (motion.velocity_error_m_s[300:302] > 1e-5).all()


def test_sign_of_the_motion_is_unknown_at_the_edges_of_rests() -> None:
    _, _, motion = two_rests()
    assert not motion.sign_known[[201, 299, 302, 399]].any()
    assert motion.sign_known[225:275].all()


def test_sign_after_a_rest_is_unknown_up_to_three_standard_errors_of_path() -> None:
    """Three standard errors of the path are about one encoder count."""
    ramp = 0.1 * np.minimum(np.abs(TIME_S - 4.0), 1.0)
    v = np.where((TIME_S > 2.0) & (TIME_S < 4.0), 0.0, ramp)
    coarse = quantised(integrated(v, STEP_S), 1e-4)
    motion = estimate_motion(Run.from_arrays(TIME_S, position_m=coarse), None)
    assert motion.resting[250:380].all()
    first = int(np.flatnonzero(~motion.resting & (TIME_S > 3.0))[0])
    moved = np.abs(coarse - coarse[first - 1]) > 3.0 * 1e-4 / np.sqrt(12.0)
    assert not motion.sign_known[first : first + int(np.argmax(moved[first:]))].any()
    assert motion.sign_known[500:].all()


@pytest.mark.parametrize("start_s", [19.002, 19.011, 19.0125])
def test_smoothed_onset_of_a_motion_is_not_used_while_the_recorded_speed_is_zero(
    start_s: float,
) -> None:
    """A smooth stroke, then an abrupt start: the smoothing spreads it over 0.1 s before it."""
    time_s = 0.01 * np.arange(3000)
    stroke = np.where((time_s > 3.0) & (time_s < 13.0), np.sin(0.1 * np.pi * (time_s - 3.0)), 0.0)
    v = 0.04 * stroke**2 - 0.055 * np.clip(time_s - start_s, 0.0, 1.0)
    for seed in range(4):
        speed = np.where(v == 0.0, 0.0, v + white(len(v), seed, 3e-4))
        path = quantised(integrated(v, 0.01), 2e-5)
        motion = estimate_motion(run_of(speed, path, time_s), None)
        assert not np.any(motion.slides[v == 0.0])


def test_first_sample_of_a_motion_that_begins_at_zero_speed_has_no_direction() -> None:
    """Speed and position without noise: the smoothed first speed exceeds its standard error."""
    v = 0.05 * np.sin(0.25 * np.pi * TIME_S) ** 2 * (1.0 + np.sin(0.7 * TIME_S + 1.0))
    motion = estimate_motion(run_of(v, integrated(v, STEP_S)), None)
    assert not motion.slides[0]
    assert motion.slides[5:100].all()


def test_creep_below_the_resolution_of_the_speed_channel_is_a_motion() -> None:
    """0.2 mm/s with a speed channel of 1 mm/s, before a start; the encoder resolves the creep."""
    time_s = 0.01 * np.arange(1600)
    creep = np.where(time_s < 5.0, 0.0, 2e-4)
    v = creep + 0.02 * np.clip(time_s - 7.0, 0.0, 1.0) - 0.0202 * np.clip(time_s - 12.0, 0.0, 1.0)
    motion = estimate_motion(
        run_of(quantised(v, 1e-3), quantised(integrated(v, 0.01), 1e-6), time_s), None
    )
    assert motion.slides[685:700].all()
    np.testing.assert_allclose(motion.velocity[685:700], 2e-4, atol=4e-5)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_run_that_begins_with_a_small_oscillation_begins_at_rest(sign: float) -> None:
    alternating = np.where(np.arange(SAMPLES) % 2, -1.0, 1.0)
    v = np.where(np.arange(SAMPLES) < 3, 1e-5 * sign * alternating, 0.1)
    motion = estimate_motion(run_of(v, integrated(v, STEP_S)), None)
    assert (motion.velocity[0], motion.sign_known[0]) == (0.0, False)
