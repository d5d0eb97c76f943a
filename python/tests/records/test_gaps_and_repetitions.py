"""Missing rows, repeated rows, and copies of a recording."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run, fit
from jbf.models.chain import estimated_motion
from jbf.records.findings.gaps import find_gaps
from jbf.records.findings.repeated_rows import as_read, repeated_rows
from jbf.records.findings.repeated_run import copies, repeated, same_recording
from known_motions import path_of, places, speed_of, white
from rigsim import axis_campaign

TIME_S: Any = 0.01 * np.arange(800)
ANGLE = 0.3 * TIME_S
RUN: Any = Run.from_arrays(TIME_S, speed_of(TIME_S), np.cos(TIME_S), angle_rad=ANGLE, name="a")


def run_at(time_s: Any) -> Run:
    return Run.from_arrays(time_s, np.ones(len(time_s)), name="a")


def test_gap_finding_has_the_longest_gap_and_the_number_of_all_missing_rows() -> None:
    (finding,) = find_gaps(run_at(np.delete(TIME_S[:200], [50, 100, 101, 102])))
    assert (finding.kind, finding.channel, finding.unit) == ("gaps", "time_s", "s")
    assert finding.size == pytest.approx(0.04)
    assert "4 rows" in finding.words
    assert find_gaps(run_at(TIME_S[:200])) == []


@pytest.mark.parametrize(("steps", "missing"), [(1.4, 0), (1.6, 1), (2.4, 1), (2.6, 2)])
def test_gap_is_reported_from_one_and_a_half_median_steps_on(steps: float, missing: int) -> None:
    time_s = TIME_S[:100].copy()
    time_s[50:] += (steps - 1.0) * 0.01
    findings = find_gaps(run_at(time_s))
    assert len(findings) == (missing > 0)
    assert all(f"{missing} row" in finding.words for finding in findings)


def test_jittered_time_stamps_are_not_gaps_but_a_missing_row_is() -> None:
    """Jitter of 0.2 periods causes steps of 1.5 periods and more."""
    jitter = np.random.default_rng(6).normal(0.0, 0.2, 400)
    jitter[195:206] *= 0.1
    late = np.sort(0.01 * (np.arange(400) + jitter))
    assert np.max(np.diff(late)) > 0.015
    assert find_gaps(run_at(late)) == []
    (finding,) = find_gaps(run_at(np.delete(late, 200)))
    assert finding.words.startswith("1 row is missing")


@pytest.mark.parametrize(("every", "found"), [(8, False), (12, True)])
def test_gaps_are_reported_only_if_nine_of_ten_steps_are_equal(every: int, found: bool) -> None:
    time_s = np.delete(TIME_S[:240], np.arange(5, 230, every))
    assert (find_gaps(run_at(time_s)) != []) == found


def test_copy_with_shifted_time_and_angle_is_the_same_recording() -> None:
    copy = replace(RUN, name="b", time_s=RUN.time_s + 5.0, angle_rad=ANGLE - 2.0)
    assert same_recording(RUN, copy)
    finding = repeated(RUN, copy)
    assert (finding.kind, finding.run, finding.size) == ("repeated_run", "b", len(RUN))


def test_shifted_copy_is_recognised_if_it_deviates_by_a_millionth_of_its_span() -> None:
    for of_span, same in ((0.9e-6, True), (1.1e-6, False)):
        moved = ANGLE - 2.0 + np.where(TIME_S == 5.0, of_span * np.ptp(ANGLE), 0.0)
        assert same_recording(RUN, replace(RUN, angle_rad=moved)) == same


def test_runs_that_differ_in_a_digit_a_column_or_length_are_not_copies() -> None:
    digit = RUN.friction + np.where(TIME_S == 5.0, 1e-9, 0.0)
    assert not same_recording(RUN, replace(RUN, friction=digit))
    assert not same_recording(RUN, replace(RUN, angle_rad=None))
    assert not same_recording(RUN, RUN.select(TIME_S > 0.0))


def test_runs_without_friction_are_not_copies() -> None:
    without_friction = replace(RUN, friction=None)
    assert not same_recording(without_friction, without_friction)


def test_runs_with_equal_missing_samples_are_copies() -> None:
    patchy = replace(RUN, extra={"w": np.where(TIME_S < 5.0, np.nan, 20.0)})
    assert same_recording(patchy, replace(patchy, name="c"))


def test_copies_are_mapped_to_the_first_run_that_each_of_them_repeats() -> None:
    other = replace(RUN, friction=2.0 * RUN.friction)
    assert copies([RUN, other, RUN, RUN, other]) == {2: 0, 3: 0, 4: 1}
    assert copies([RUN, other]) == {}


def polled(every: int, rows: int = 800) -> Run:
    """A record in which every `every`-th row repeats the previous one."""
    last = np.arange(rows)
    last[every::every] -= 1
    time_s = 0.01 * np.arange(rows)
    force, path = np.sin(3.0 * time_s) + white(rows, 6, 0.1), path_of(time_s)
    return Run.from_arrays(time_s, speed_of(time_s)[last], force[last], position_m=path[last])


def test_repeated_rows_of_a_moving_drive_are_removed_and_their_share_reported() -> None:
    run = polled(5)
    again: Any = repeated_rows(run)
    assert places(again) == list(range(5, 800, 5))
    read = as_read(run)
    (finding,) = read.reading
    assert len(read) == 800 - again.sum()
    assert (finding.kind, finding.channel, finding.unit) == ("repeated_rows", "time_s", "%")
    assert finding.size == pytest.approx(100.0 * again.mean())


def test_repeated_rows_are_detected_from_40_rows_and_2_percent_on() -> None:
    for every, rows in ((22, 800), (60, 4000)):
        assert repeated_rows(polled(every, rows)) is None
    for every, rows in ((18, 800), (40, 4000)):
        assert repeated_rows(polled(every, rows)) is not None


def test_row_is_repeated_only_if_all_channels_but_the_temperature_repeat() -> None:
    run: Any = polled(5)
    changing = replace(run, friction=run.friction + 1e-3 * np.arange(800))
    assert repeated_rows(changing) is None
    assert as_read(changing) is changing
    assert repeated_rows(replace(run, temperature_c=20.0 + 0.1 * TIME_S)) is not None
    assert repeated_rows(replace(run, position_m=None, angle_rad=run.position_m)) is not None


def logged(seed: int) -> tuple[list[Run], list[Run], dict[str, Any]]:
    """Simulated runs of a slide, and their copies with each row repeated until a logger reads new
    values after 2 to 8 rows."""
    records, truth = axis_campaign(seed, runs=3)
    random = np.random.default_rng(seed)
    clean, stale = [], []
    for r in records:
        index = np.arange(len(r.time_s))
        begins = np.concatenate(([0], np.cumsum(random.integers(2, 9, len(index)))))
        last = begins[np.searchsorted(begins, index, side="right") - 1]
        for runs, at in ((clean, slice(None)), (stale, last)):
            v, force, path = r.velocity[at], r.force_n[at], r.path[at]
            runs.append(Run.from_arrays(r.time_s, v, force, position_m=path, name=r.name))
    return clean, stale, truth


def test_fit_recovers_law_and_noise_if_four_of_five_rows_are_repeated() -> None:
    _, stale, truth = logged(41)
    fitted = fit(Rig(), stale, law="coulomb")
    sizes = {finding.kind: finding.size for finding in fitted.findings}
    assert sizes["repeated_rows"] == pytest.approx(80.0, abs=3.0)
    assert fitted.rms == pytest.approx(truth["noise_n"], rel=0.05)
    for name in ("F_c", "F_v"):
        estimate: Any = fitted[name]
        true = truth["law"][name]
        assert abs(estimate.value - true) < 4.0 * estimate.stderr + 0.005 * true


def test_imposed_speed_has_a_tenth_of_the_error_of_a_speed_with_repeated_rows() -> None:
    clean, stale, _ = logged(42)
    for true, run in zip(clean, stale, strict=True):
        assert as_read(true) is true
        motion = estimated_motion(Rig(), run)
        assert len(motion.velocity) == len(run)
        error_m_s = np.linalg.norm(motion.velocity - true.velocity)
        assert error_m_s < 0.1 * np.linalg.norm(run.velocity - true.velocity)


def test_imposed_motion_with_repeated_rows_does_not_depend_on_the_force() -> None:
    run = logged(42)[1][0]
    bare = Run.from_arrays(run.time_s, run.velocity, position_m=run.position_m)
    speeds = [estimated_motion(Rig(), r).velocity for r in (run, bare)]
    np.testing.assert_array_equal(*speeds)


def test_constant_rows_of_a_long_rest_are_not_repeated_rows() -> None:
    # The rest is longer than twice the longest series of repeated rows.
    run, rest = logged(45)[1][0], 300
    columns: Any = (run.velocity, run.friction, run.position_m)
    time_s = np.concatenate([run.time_s, run.time_s[-1] + 0.01 * np.arange(1, rest + 1)])
    speed, force, place = (np.pad(column, (0, rest), "edge") for column in columns)
    speed[-rest:] = 0.0
    again: Any = repeated_rows(Run.from_arrays(time_s, speed, force, position_m=place))
    assert again[: len(run)].mean() > 0.7
    assert not again[-rest + 1 :].any()
