"""Missing rows, repeated rows, and runs that were recorded once and given twice."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run, fit
from jbf.models.chain import imposed
from jbf.records.findings.gaps import find_gaps
from jbf.records.findings.repeated_rows import as_read, repeated_rows
from jbf.records.findings.repeated_run import copies, repeated, same_recording
from known_motions import path_of, places, speed_of, white
from rigsim import axis_campaign

TIME_S: Any = 0.01 * np.arange(800)


def run_at(time_s: Any) -> Run:
    return Run.from_arrays(time_s, np.ones(len(time_s)), name="a")


def test_gap_finding_has_the_longest_gap() -> None:
    (finding,) = find_gaps(run_at(np.delete(TIME_S[:200], [50, 100, 101, 102])))
    assert (finding.kind, finding.channel, finding.unit) == ("gaps", "time_s", "s")
    assert finding.size == pytest.approx(0.04)
    assert "4 rows" in finding.words
    assert find_gaps(run_at(TIME_S[:200])) == []


@pytest.mark.parametrize(("steps", "missing"), [(1.4, 0), (1.6, 1), (2.4, 1), (2.6, 2)])
def test_gap_begins_at_one_and_a_half_usual_steps(steps: float, missing: int) -> None:
    time_s = TIME_S[:100].copy()
    time_s[50:] += (steps - 1.0) * 0.01
    findings = find_gaps(run_at(time_s))
    assert len(findings) == (missing > 0)
    assert all(f"{missing} row" in finding.words for finding in findings)


@pytest.mark.parametrize(("every", "found"), [(8, False), (12, True)])
def test_record_without_a_usual_step_has_no_gaps(every: int, found: bool) -> None:
    """Nine of ten steps must be equal."""
    time_s = np.delete(TIME_S[:240], np.arange(5, 230, every))
    assert (find_gaps(run_at(time_s)) != []) == found


ANGLE = 0.3 * TIME_S
RUN = Run.from_arrays(TIME_S, speed_of(TIME_S), np.cos(TIME_S), angle_rad=ANGLE, name="a")


def test_copy_on_another_clock_and_from_another_angle_is_the_same_recording() -> None:
    copy = replace(RUN, name="b", time_s=RUN.time_s + 5.0, angle_rad=ANGLE - 2.0)
    assert same_recording(RUN, copy)
    finding = repeated(RUN, copy)
    assert (finding.kind, finding.run, finding.size) == ("repeated_run", "b", len(RUN))


@pytest.mark.parametrize(("of_span", "same"), [(0.9e-6, True), (1.1e-6, False)])
def test_shift_may_round_a_millionth_of_the_span(of_span: float, same: bool) -> None:
    moved = ANGLE - 2.0 + np.where(TIME_S == 5.0, of_span * np.ptp(ANGLE), 0.0)
    assert same_recording(RUN, replace(RUN, angle_rad=moved)) == same


def test_runs_that_differ_in_a_digit_a_column_or_length_are_not_copies() -> None:
    assert RUN.friction_n is not None
    digit = RUN.friction_n + np.where(TIME_S == 5.0, 1e-9, 0.0)
    for other in (
        replace(RUN, friction_n=digit),
        replace(RUN, angle_rad=None),
        RUN.select(slice(1, None)),
    ):
        assert not same_recording(RUN, other)
    bare = replace(RUN, friction_n=None)
    assert not same_recording(bare, bare)
    patchy = replace(RUN, extra={"w": np.where(TIME_S < 5.0, np.nan, 20.0)})
    assert same_recording(patchy, replace(patchy, name="c"))


def test_each_copy_refers_to_the_first_of_its_kind() -> None:
    assert RUN.friction_n is not None
    other = replace(RUN, friction_n=2.0 * RUN.friction_n)
    assert copies([RUN, other, RUN, RUN, other]) == {2: 0, 3: 0, 4: 1}
    assert copies([RUN, other]) == {}


def polled(every: int, rows: int = 800) -> Run:
    """A record in which one row in `every` repeats the one before."""
    last = np.arange(rows)
    last[every::every] -= 1
    time_s = 0.01 * np.arange(rows)
    force = np.sin(3.0 * time_s) + white(rows, 6, 0.1)
    return Run.from_arrays(
        time_s, speed_of(time_s)[last], force[last], position_m=path_of(time_s)[last], name="a"
    )


def test_repeated_rows_of_a_moving_drive_are_left_out() -> None:
    run = polled(5)
    again = repeated_rows(run)
    assert again is not None
    assert places(again) == list(range(5, 800, 5))
    read = as_read(run)
    (finding,) = read.reading
    assert len(read) == 800 - again.sum()
    assert (finding.kind, finding.channel, finding.unit) == ("repeated_rows", "time_s", "%")
    assert finding.size == pytest.approx(100.0 * again.mean())


@pytest.mark.parametrize(
    ("every", "rows", "found"),
    [(22, 800, False), (18, 800, True), (60, 4000, False), (40, 4000, True)],
)
def test_forty_rows_and_two_percent_must_repeat(every: int, rows: int, found: bool) -> None:
    assert (repeated_rows(polled(every, rows)) is not None) == found


def test_rows_are_repeated_only_if_all_fast_channels_are() -> None:
    run = polled(5)
    assert run.friction_n is not None
    changing = replace(run, friction_n=run.friction_n + 1e-3 * np.arange(800))
    assert repeated_rows(changing) is None
    assert as_read(changing) is changing
    assert repeated_rows(replace(run, temperature_c=20.0 + 0.1 * TIME_S)) is not None
    assert repeated_rows(replace(run, position_m=None, angle_rad=run.position_m)) is not None


def logged(seed: int) -> tuple[list[Run], list[Run], dict[str, Any]]:
    """Simulated runs of a slide, and the same as a logger whose link answers after 2 to 8 rows."""
    records, truth = axis_campaign(seed, runs=3)
    random = np.random.default_rng(seed)
    clean, stale = [], []
    for r in records:
        rows = len(r.time_s)
        begins = np.cumsum(random.integers(2, 9, rows))
        begins = np.concatenate(([0], begins[begins < rows]))
        last = begins[np.searchsorted(begins, np.arange(rows), side="right") - 1]
        for into, at in ((clean, slice(None)), (stale, last)):
            into.append(Run.from_arrays(
                r.time_s, r.velocity_m_s[at], r.force_n[at], position_m=r.path[at], name=r.name
            ))  # fmt: skip
    return clean, stale, truth


def test_fit_to_polled_rows_recovers_law_and_noise() -> None:
    _, stale, truth = logged(41)
    found = fit(Rig(), stale, law="coulomb")
    sizes = {finding.kind: finding.size for finding in found.findings}
    assert sizes["repeated_rows"] == pytest.approx(80.0, abs=3.0)
    assert found.rms_n == pytest.approx(truth["noise_n"], rel=0.05)
    for name in ("F_c_n", "F_v_n_s_m"):
        parameter, true = found[name], truth["law"][name]
        assert parameter.stderr is not None
        assert abs(parameter.value - true) < 4.0 * parameter.stderr + 0.005 * true


def test_motion_continues_through_repeated_rows_and_does_not_depend_on_the_force() -> None:
    clean, stale, _ = logged(42)
    for true, run in zip(clean, stale, strict=True):
        assert as_read(true) is true
        motion = imposed(Rig(), run)
        assert len(motion.velocity_m_s) == len(run)
        error = motion.velocity_m_s - true.velocity_m_s
        held = run.velocity_m_s - true.velocity_m_s
        assert np.sqrt(np.mean(error**2)) < 0.1 * np.sqrt(np.mean(held**2))
    run = stale[0]
    bare = Run.from_arrays(run.time_s, run.velocity_m_s, position_m=run.position_m)
    np.testing.assert_array_equal(
        imposed(Rig(), run).velocity_m_s, imposed(Rig(), bare).velocity_m_s
    )


def test_constant_rows_of_a_rest_are_readings() -> None:
    """A rest is longer than twice the longest silence of the link."""
    run, rest = logged(45)[1][0], 300
    assert run.friction_n is not None
    assert run.position_m is not None
    time_s = np.concatenate([run.time_s, run.time_s[-1] + 0.01 * np.arange(1, rest + 1)])
    columns = (run.velocity_m_s, run.friction_n, run.position_m)
    speed, force, place = (np.concatenate([c, np.full(rest, c[-1])]) for c in columns)
    speed[-rest:] = 0.0
    again = repeated_rows(Run.from_arrays(time_s, speed, force, position_m=place))
    assert again is not None
    assert again[: len(run)].mean() > 0.7
    assert not again[-rest + 1 :].any()
