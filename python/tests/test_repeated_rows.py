"""A logger that asks oftener than its link has something new: whole rows repeat."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Rig, Run, fit
from jbf.models.chain import imposed
from jbf.records.findings.repeated_rows import as_read, repeated_rows
from jbf.records.motion.ratio import way_per_unit
from rigsim import axis_campaign

Index = npt.NDArray[np.intp]
LAW: dict[str, Any] = {"law": "coulomb"}


def packets(n: int, rng: np.random.Generator) -> Index:
    """For each row the one that was new when it was asked for: answers come after 2 to 8 rows."""
    starts = np.cumsum(rng.integers(2, 9, n))
    starts = np.concatenate(([0], starts[starts < n]))
    return starts[np.searchsorted(starts, np.arange(n), side="right") - 1]


def logged(seed: int) -> tuple[list[Run], list[Run], dict[str, Any]]:
    """Runs of a slide as they were, and as such a logger has them."""
    records, truth = axis_campaign(seed, runs=3)
    rng = np.random.default_rng(seed)
    clean, stale = [], []
    for r in records:
        last = packets(len(r.time_s), rng)
        for into, at in ((clean, slice(None)), (stale, last)):
            into.append(
                Run.from_arrays(
                    r.time_s, r.velocity_m_s[at], r.force_n[at], position_m=r.path[at], name=r.name
                )
            )
    return clean, stale, truth


def test_the_rows_that_repeat_are_left_out_and_said() -> None:
    _, stale, truth = logged(41)
    found = fit(Rig(), stale, **LAW)
    kinds = {finding.kind: finding for finding in found.findings}
    assert kinds["repeated_rows"].size == pytest.approx(80.0, abs=3.0)
    assert kinds["repeated_rows"].unit == "%"
    assert found.rms_n == pytest.approx(truth["noise_n"], rel=0.05)
    for name in ("F_c_n", "F_v_n_s_m"):
        p, own = found[name], truth["law"][name]
        assert p.stderr is not None
        assert abs(p.value - own) < 4.0 * p.stderr + 0.005 * own


def test_the_motion_goes_on_where_the_rows_do_not() -> None:
    clean, stale, _ = logged(42)
    for was, run in zip(clean, stale, strict=True):
        motion = imposed(Rig(), run)
        assert len(motion.velocity_m_s) == len(run)
        off = motion.velocity_m_s - was.velocity_m_s
        held = run.velocity_m_s - was.velocity_m_s
        assert np.sqrt(np.mean(off**2)) < 0.1 * np.sqrt(np.mean(held**2))


def test_a_record_whose_rows_are_new_keeps_them() -> None:
    clean, _, _ = logged(43)
    for run in clean:
        assert as_read(run) is run


def test_one_channel_that_is_held_is_no_row() -> None:
    clean, stale, _ = logged(44)
    held = stale[0]
    assert clean[0].friction_n is not None
    assert held.position_m is not None
    alone = Run.from_arrays(
        held.time_s, held.velocity_m_s, clean[0].friction_n, position_m=held.position_m
    )
    assert repeated_rows(alone) is None


def test_a_rest_is_no_silence() -> None:
    _, stale, _ = logged(45)
    run, rest = stale[0], 300
    assert run.friction_n is not None
    assert run.position_m is not None
    # The drive stops, and all that is read stays what it is: coarse counts see no noise.
    time = np.concatenate([run.time_s, run.time_s[-1] + 0.01 * np.arange(1, rest + 1)])
    columns = [run.velocity_m_s, run.friction_n, run.position_m]
    speed, force, place = (np.concatenate([c, np.full(rest, c[-1])]) for c in columns)
    speed[-rest:] = 0.0
    stopped = Run.from_arrays(time, speed, force, position_m=place)
    again = repeated_rows(stopped)
    assert again is not None
    assert again[: len(run)].mean() > 0.7
    assert not again[-rest + 1 :].any()


def test_the_motion_is_the_same_where_no_force_was_recorded() -> None:
    _, (run, *_), _ = logged(46)
    assert run.position_m is not None
    bare = Run.from_arrays(run.time_s, run.velocity_m_s, position_m=run.position_m)
    one, other = (imposed(Rig(), r).velocity_m_s for r in (run, bare))
    np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("even", [True, False])
def test_a_slow_motion_that_is_logged_fast_or_unevenly_tells_its_way_a_radian(even: bool) -> None:
    rng = np.random.default_rng(9)
    steps = np.full(8000, 0.003) if even else rng.choice([0.005, 0.05], 4000, p=[0.7, 0.3])
    time = np.cumsum(steps)
    angle, speed = 0.1 * np.sin(0.5 * time), 0.05 * np.cos(0.5 * time)
    counts = 4e-4 * np.round(angle / 4e-4)
    noisy = speed + 1e-3 * rng.standard_normal(len(time))
    assert way_per_unit(time, counts, noisy) == 1.0
    assert way_per_unit(time, counts, 0.03 * noisy) == pytest.approx(0.03, rel=0.01)
