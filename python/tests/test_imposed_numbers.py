"""What of a motion's records is believed, and the motion that is imposed: by hand, and against
records whose fault is known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Run
from jbf.records.findings.noisy_load import find_noisy_load, only_noise, steady_load
from jbf.records.findings.repeated_rows import _of_rests, as_read, repeated_rows
from jbf.records.motion.believed import NOT_AS_RECORDED, believed
from jbf.records.motion.imposed import GONE, SIGN_SIGMA, impose
from jbf.records.motion.roughness import step_of

DT = 0.01
N = 800
TIME: Any = DT * np.arange(N)
STEP = 1e-5
RADIUS = 0.02


def speed_of(time: Any) -> Any:
    return 0.2 * np.sin(1.7 * time + 0.4) + 0.05 * np.sin(4.3 * time)


def path_of(time: Any) -> Any:
    return -0.2 / 1.7 * np.cos(1.7 * time + 0.4) - 0.05 / 4.3 * np.cos(4.3 * time)


SPEED = speed_of(TIME) + 1e-4 * np.random.default_rng(1).standard_normal(N)
PATH = STEP * np.round(path_of(TIME) / STEP)


def run_of(speed: Any = SPEED, path: Any = PATH, time: Any = TIME, **more: Any) -> Run:
    return Run.from_arrays(time, speed, position_m=path, name="a", **more)


def kinds(run: Run, radius: float | None = None) -> list[str]:
    return [finding.kind for finding in believed(run, radius).findings]


def test_records_without_a_fault_are_believed_as_they_are() -> None:
    """Path, step and speed; an angle's path is along its journal."""
    found = believed(run_of(), None)
    np.testing.assert_array_equal(found.path, PATH)
    np.testing.assert_array_equal(found.speed, SPEED)
    assert found.step == pytest.approx(step_of(PATH))
    assert (found.speed_measured, found.findings, found.arm_m, found.hum) == (True, (), 1.0, 0.0)
    turned = Run.from_arrays(TIME, SPEED, angle_rad=PATH / RADIUS)
    found = believed(turned, RADIUS)
    np.testing.assert_allclose(found.path, PATH)  # type: ignore[arg-type]
    assert found.step == pytest.approx(step_of(PATH))
    assert found.arm_m == RADIUS


def test_a_speed_alone_is_believed_and_an_angle_alone_is_not() -> None:
    """Without a path nothing is known of a step; its glitches are mended all the same."""
    spiked = SPEED.copy()
    spiked[300] += 0.1
    found = believed(Run.from_arrays(TIME, spiked), None)
    assert (found.path, found.step, found.speed_measured) == (None, 0.0, True)
    assert [f.kind for f in found.findings] == ["glitches"]
    assert found.speed[300] == pytest.approx(SPEED[300], abs=2e-3)
    with pytest.raises(InputError) as caught:
        believed(Run.from_arrays(TIME, angle_rad=PATH, name="a"), None)
    assert str(caught.value) == (
        "a, column velocity_m_s: is missing, and an angle tells no speed without the journal's "
        "radius; add the column, or give the rig its [bearing]"
    )


def test_a_path_alone_tells_the_motion() -> None:
    """And that it does is said; nothing is measured of the speed."""
    found = believed(Run.from_arrays(TIME, angle_rad=PATH / RADIUS, name="a"), RADIUS)
    (told,) = found.findings
    assert (told.kind, told.channel, told.run) == ("no_speed", "velocity_m_s", "a")
    assert (told.size, told.unit, told.words) == (0.0, "m/s", "no speed was recorded")
    assert told.done == "the path alone tells it"
    assert (found.speed_measured, found.arm_m) == (False, RADIUS)
    np.testing.assert_allclose(found.speed, np.gradient(found.path, TIME))  # type: ignore[arg-type]
    spiked = PATH.copy()
    spiked[300] += 0.01
    found = believed(Run.from_arrays(TIME, position_m=spiked), None)
    assert [f.kind for f in found.findings] == ["no_speed", "glitches"]
    np.testing.assert_allclose(found.path, PATH, atol=2.0 * STEP)  # type: ignore[arg-type]


def test_a_unit_is_converted_before_single_samples_are_asked() -> None:
    """A path in millimetres, a speed in millimetres a second, a sign that is turned."""
    found = believed(run_of(path=1e3 * PATH), None)
    assert [f.kind for f in found.findings] == ["units"]
    np.testing.assert_allclose(found.path, PATH)  # type: ignore[arg-type]
    assert found.step == pytest.approx(step_of(PATH))
    found = believed(run_of(speed=1e3 * SPEED), None)
    np.testing.assert_allclose(found.speed, SPEED)
    np.testing.assert_array_equal(found.path, PATH)
    found = believed(run_of(path=-PATH), None)
    assert [f.kind for f in found.findings] == ["sign"]
    np.testing.assert_allclose(found.path, PATH)  # type: ignore[arg-type]
    assert found.step == pytest.approx(step_of(PATH))


def test_a_late_speed_is_shifted_and_a_filtered_one_left_aside() -> None:
    """So is a difference of the path."""
    late = believed(run_of(speed=speed_of(TIME - 0.3 * DT)), None)
    assert [f.kind for f in late.findings] == ["late_speed"]
    assert late.speed_measured
    np.testing.assert_allclose(late.speed[5:-5], speed_of(TIME)[5:-5], atol=3e-4)
    filtered = believed(run_of(speed=speed_of(TIME - 3.0 * DT)), None)
    assert [f.kind for f in filtered.findings] == ["filtered_speed"]
    assert not filtered.speed_measured
    np.testing.assert_allclose(filtered.speed, np.gradient(PATH, TIME))
    difference = np.concatenate(([0.0], np.diff(PATH) / DT))
    assert kinds(run_of(speed=difference)) == ["coarse_speed"]
    assert {"late_speed", "filtered_speed", "coarse_speed"} <= set(NOT_AS_RECORDED)
    assert "glitches" not in NOT_AS_RECORDED


def test_each_fault_of_a_record_is_told_once() -> None:
    """Path's glitches, zero, unit, speed's glitches, held readings, stamps; in that order."""
    path, speed = PATH.copy(), SPEED.copy()
    path[300] += 0.01
    speed[500] += 0.1
    assert kinds(run_of(speed, path)) == ["glitches", "glitches"]
    told = [f.channel for f in believed(run_of(speed, path), None).findings]
    assert told == ["position_m", "velocity_m_s"]
    still = PATH.copy()
    still[601:609] = still[600]
    found = believed(run_of(path=still), None)
    assert [f.kind for f in found.findings] == ["held_samples"]
    assert "the shaft moves on" in found.findings[0].words
    np.testing.assert_allclose(found.path, PATH, atol=5e-5)  # type: ignore[arg-type]
    uneven = TIME + 5e-4 * np.random.default_rng(2).standard_normal(N)
    run = run_of(speed_of(uneven), STEP * np.round(path_of(uneven) / STEP), uneven)
    assert kinds(run) == ["jitter"]


def test_a_motion_has_the_signs_that_are_four_errors_from_zero() -> None:
    """And the angle of its path, the slope of its speed."""
    m = impose(run_of(), None)
    v = speed_of(TIME)
    np.testing.assert_allclose(m.velocity_m_s, v, atol=3e-4)
    np.testing.assert_allclose(m.angle_rad, path_of(TIME), atol=STEP)
    slope = 0.34 * np.cos(1.7 * TIME + 0.4) + 0.215 * np.cos(4.3 * TIME)
    assert np.std(m.acceleration_m_s2 - slope) < 0.02
    wanted = np.abs(m.velocity_m_s) > SIGN_SIGMA * m.velocity_error_m_s
    np.testing.assert_array_equal(m.sign_known, wanted)
    assert not m.resting.any()
    assert m.findings == ()
    assert 2e-5 < np.median(m.velocity_error_m_s) < 1e-4
    assert (SIGN_SIGMA, GONE) == (4.0, 3.0)
    turned = impose(Run.from_arrays(TIME, SPEED, angle_rad=PATH / RADIUS), RADIUS)
    np.testing.assert_allclose(turned.angle_rad, path_of(TIME) / RADIUS, atol=STEP / RADIUS)


def test_a_motion_without_a_path_goes_the_way_of_its_speed() -> None:
    """From where an angle is told, if it is."""
    m = impose(Run.from_arrays(TIME, SPEED), RADIUS)
    way = path_of(TIME) - path_of(TIME[0])
    np.testing.assert_allclose(m.angle_rad * RADIUS, way, atol=2e-4)
    np.testing.assert_allclose(m.velocity_m_s, speed_of(TIME), atol=4e-4)
    # A speed that is no multiple of the angle's own: the angle tells where it is, no more.
    strange = np.mod(np.cumsum(np.random.default_rng(3).uniform(0.0, 1.0, N)), 2.0 * np.pi)
    m = impose(Run.from_arrays(TIME, SPEED, angle_rad=strange), None)
    np.testing.assert_allclose(m.angle_rad, np.unwrap(strange))


def test_rests_have_no_speed_and_two_moving_samples_no_smoothing() -> None:
    """What is shorter than three samples is as it was recorded, its error that of the speed."""
    speed = np.where((TIME > 2.0) & (TIME < 4.0), 0.0, 0.1)
    speed[300:302] = 0.05
    path = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * DT)))
    noisy = np.where(speed == 0.0, 0.0, speed + 1e-4 * np.random.default_rng(4).standard_normal(N))
    m = impose(run_of(noisy, STEP * np.round(path / STEP)), None)
    rest = speed == 0.0
    np.testing.assert_array_equal(m.resting, rest)
    assert (m.velocity_m_s[rest] == 0.0).all()
    np.testing.assert_array_equal(m.velocity_m_s[300:302], noisy[300:302])
    assert m.velocity_error_m_s[300] == m.velocity_error_m_s[301] > 5e-5
    assert (m.velocity_error_m_s[rest] == 0.0).all()
    # The edges of a rest are unsure, all else of it is known.
    edges = np.flatnonzero(rest & ~m.sign_known)
    assert {201, 299, 302, 399} <= set(edges.tolist())
    assert m.sign_known[225:275].all()


def test_a_speed_that_contradicts_its_path_has_no_sign_there() -> None:
    """Nor does a run that begins in a hum begin in motion."""
    path = PATH.copy()
    path[400:] += 2e-3
    m = impose(run_of(path=path), None)
    assert not m.sign_known[398:402].any()
    assert m.sign_known[380:390].all()
    hums = np.where(TIME < 0.5, 1e-6 * np.where(np.arange(N) % 2, 1.0, -1.0), 0.1)
    whole = np.concatenate(([0.0], np.cumsum(0.5 * (hums[1:] + hums[:-1]) * DT)))
    m = impose(run_of(hums, STEP * np.round(whole / STEP)), None)
    assert m.velocity_m_s[0] == 0.0


STEADY: Any = 100.0 + 2.0 * np.random.default_rng(5).standard_normal(500)


def test_a_load_of_nothing_but_noise_is_its_mean() -> None:
    """Of white noise; not one that turns, drifts, jumps, is steady or short."""
    assert only_noise(STEADY)
    assert steady_load(STEADY).tolist() == [float(np.mean(STEADY))] * 500
    t = np.arange(500)
    for change in (2.0 * np.sin(0.3 * t), 0.01 * t, 4.0 * (t > 250)):
        assert not only_noise(STEADY + change)
        assert steady_load(STEADY + change) is not STEADY
    assert not only_noise(np.full(500, 100.0))
    for spread, there in ((0.9e-7, False), (1.1e-7, True)):
        fine = 100.0 + spread * (STEADY - 100.0) / np.ptp(STEADY)
        assert only_noise(fine) == there
    assert only_noise(STEADY[:100])
    assert not only_noise(STEADY[:99])
    assert not only_noise(np.cumsum(STEADY - 100.0) + 1000.0)
    (found,) = find_noisy_load("a", STEADY)
    size = float(np.std(STEADY))
    assert found.words == (
        f"the load is white noise of {size:.3g} N ({100.0 * size / np.mean(STEADY):.2g} %) about "
        f"{np.mean(STEADY):.4g} N"
    )
    assert (found.kind, found.channel, found.run) == ("noisy_load", "load_n", "a")
    assert (found.size, found.unit, found.done) == (size, "N", "its mean is taken")
    assert find_noisy_load("a", None) == find_noisy_load("a", np.full(500, 1.0)) == []


def of_powers(power: Any) -> Any:
    """A load about 100 N whose periodogram is known."""
    phases = np.random.default_rng(9).uniform(0.0, 2.0 * np.pi, len(power))
    lines = np.sqrt(power) * np.exp(1j * phases)
    wave = np.fft.irfft(np.concatenate(([0.0], lines, [0.0])), 2 * len(power) + 2)
    return 100.0 + wave / np.ptp(wave)


@pytest.mark.parametrize(("chance", "there"), [(1.03e-4, True), (0.97e-4, False)])
def test_a_line_that_sticks_out_of_noise_is_no_noise(chance: float, there: bool) -> None:
    """Fisher's test: a share g of the power has the chance m (1 - g)^(m - 1)."""
    m = 249
    g = 1.0 - (chance / m) ** (1.0 / (m - 1))
    power = np.ones(m)
    power[m // 2] = g * (m - 1) / (1.0 - g)
    assert only_noise(of_powers(power)) == there


@pytest.mark.parametrize(("chance", "there"), [(1.1e-4, True), (0.9e-4, False)])
@pytest.mark.parametrize("way", [1, -1])
def test_noise_has_its_power_evenly_from_slow_to_fast(chance: float, there: bool, way: int) -> None:
    """Bartlett's test: a rise that is off by d has the chance 2 exp(-2 m d^2)."""
    m = 300
    off = np.sqrt(np.log(2.0 / chance) / (2.0 * m))
    power = np.where(np.arange(m) < m // 2, 0.5 + off, 0.5 - off)[::way]
    assert only_noise(of_powers(power)) == there


def test_the_way_of_a_row_is_its_speed_for_as_long_as_it_lasts() -> None:
    """Of rows that are unevenly apart those that go by two counts are in motion."""
    steps = np.where(np.arange(400) % 2, 0.001, 0.1)
    time = np.concatenate(([0.0], np.cumsum(steps)))
    path = np.round(time, 12)
    force = np.random.default_rng(10).standard_normal(401)
    # Only the short ones repeat: in a thousandth of a second the drive goes by one count.
    for k in range(1, 400, 2):
        path[k + 1], force[k + 1] = path[k], force[k]
    path += np.where(np.arange(401) == 400, 0.001, 0.0)
    run = Run.from_arrays(time, np.ones(401), force, position_m=path)
    assert repeated_rows(run) is None
    longer = np.where(np.arange(400) % 2, 0.01, 0.1)
    later = np.concatenate(([0.0], np.cumsum(longer)))
    again = repeated_rows(Run.from_arrays(later, np.ones(401), force, position_m=path))
    assert again is not None
    assert np.flatnonzero(again).tolist()[:3] == [2, 4, 6]


def asked(every: int, rows: int = N) -> Run:
    """A record of which each row of so many repeats the one before."""
    last = np.arange(rows)
    last[every::every] -= 1
    time = DT * np.arange(rows)
    read = time[last]
    force = np.sin(3.0 * read) + 0.1 * np.random.default_rng(6).standard_normal(rows)[last]
    return Run.from_arrays(time, speed_of(read), force, position_m=path_of(read), name="a")


def test_rows_that_repeat_the_one_before_while_the_drive_moves_are_no_readings() -> None:
    """Forty of them at least, and a fiftieth."""
    run = asked(5)
    again = repeated_rows(run)
    assert again is not None
    assert np.flatnonzero(again).tolist() == list(range(5, N, 5))
    left = as_read(run)
    (found,) = left.reading
    assert len(left) == N - again.sum()
    assert found.words == (
        f"{100.0 * again.mean():.2g} % of the rows repeat the one before while the shaft moves on: "
        "the logger asks oftener than it is answered"
    )
    assert (found.kind, found.channel, found.run) == ("repeated_rows", "time_s", "a")
    assert (found.unit, found.done) == ("%", "left out")
    assert found.size == pytest.approx(100.0 * again.mean())
    for every, there in ((22, False), (18, True)):
        assert (repeated_rows(asked(every)) is not None) == there
    for every, there in ((60, False), (40, True)):
        assert (repeated_rows(asked(every, 4000)) is not None) == there


def test_what_stands_still_alone_is_no_row() -> None:
    """A position that repeats while the force does not; a run without a place, or of clocks."""
    run = asked(5)
    assert run.friction_n is not None
    new = replace(run, friction_n=run.friction_n + 1e-3 * np.arange(N))
    assert repeated_rows(new) is None
    assert as_read(new) is new
    assert repeated_rows(replace(run, position_m=None)) is None
    assert repeated_rows(replace(run, speed_recorded=False)) is None
    assert repeated_rows(replace(run, read={"own": np.ones(N, dtype=bool)})) is None
    assert repeated_rows(replace(run, position_m=None, angle_rad=run.position_m)) is not None
    warm = replace(run, temperature_c=20.0 + 0.1 * TIME)
    assert repeated_rows(warm) is not None


def test_repeats_of_a_rest_are_its_news() -> None:
    """Where they last more than twice as long as any in motion."""
    same = np.zeros(60, dtype=bool)
    same[[5, 6, 20, 21, 22, 23, 24, 40, 41, 42]] = True
    moving = np.zeros(60, dtype=bool)
    moving[:10] = True
    run = Run.from_arrays(0.1 * np.arange(61), np.ones(61))
    assert np.flatnonzero(_of_rests(run, same, moving)).tolist() == [20, 21, 22, 23, 24]


def test_a_path_that_is_finer_than_any_encoder_is_as_good_as_its_noise() -> None:
    """Where the smallest change on record is chance; its motion is smoothed accordingly."""
    noise = 2e-5 * np.random.default_rng(7).standard_normal(N)
    rough = impose(run_of(path=path_of(TIME) + noise), None)
    smooth = impose(run_of(), None)
    np.testing.assert_allclose(rough.velocity_m_s, speed_of(TIME), atol=4e-4)
    assert np.median(rough.velocity_error_m_s) > 1.1 * np.median(smooth.velocity_error_m_s)
    # Were the smallest change believed, every sample of the path would be taken to its digit.
    assert np.std(rough.angle_rad - path_of(TIME)) < 1.5e-5


def test_noise_that_comes_and_goes_makes_errors_that_do() -> None:
    """Thrice as large and more, for long enough."""
    loud = np.where((TIME > 3.0) & (TIME < 6.0), 10.0, 1.0)
    noise = 1e-4 * np.random.default_rng(8).standard_normal(N)
    m = impose(Run.from_arrays(TIME, speed_of(TIME) + loud * noise), None)
    inside, outside = (TIME > 3.6) & (TIME < 5.4), TIME < 2.0
    ratio = np.median(m.velocity_error_m_s[inside]) / np.median(m.velocity_error_m_s[outside])
    assert 5.0 < ratio < 15.0


def test_a_first_way_that_the_path_alone_tells_is_known_where_it_has_gone() -> None:
    """Three standard errors of the path, which is one count."""
    speed = np.where((TIME > 2.0) & (TIME < 4.0), 0.0, 0.1 * np.minimum(np.abs(TIME - 4.0), 1.0))
    path = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * DT)))
    coarse = 1e-4 * np.round(path / 1e-4)
    m = impose(Run.from_arrays(TIME, position_m=coarse), None)
    assert m.resting[250:380].all()
    first = int(np.flatnonzero(~m.resting & (TIME > 3.0))[0])
    gone = np.abs(coarse - coarse[first - 1]) > GONE * 1e-4 / np.sqrt(12.0)
    unsure = np.arange(first, first + int(np.argmax(gone[first:])))
    assert not m.sign_known[unsure].any()
    assert m.sign_known[500:].all()


def test_a_run_that_begins_in_a_hum_begins_at_rest() -> None:
    """Whatever the sign of its first sample."""
    for sign in (1.0, -1.0):
        speed = np.where(np.arange(N) < 3, 1e-5 * sign * np.array([1.0, -1.0] * (N // 2)), 0.1)
        path = np.concatenate(([0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * DT)))
        m = impose(run_of(speed + 0.0, path), None)
        assert m.velocity_m_s[0] == 0.0
        assert not m.sign_known[0]
    moving = impose(run_of(), None)
    assert moving.sign_known[0]
    assert moving.velocity_m_s[0] == pytest.approx(float(speed_of(0.0)), abs=4e-4)
