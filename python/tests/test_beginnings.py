"""What runs remember of how they began, jumps of a prediction, gaps and work: in small numbers."""

from __future__ import annotations

import sys
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.errors import Unfinished
from jbf.estimation.film_gaps import GAP, _gaps
from jbf.estimation.initial_state import (
    FURTHER,
    LONGER,
    MOST_OF_A_RUN,
    MOST_OF_A_STROKE,
    MOST_OF_ALL,
    SPEEDS,
    WAYS,
    Memory,
    _remembered,
    memories,
    remembering,
)
from jbf.estimation.jumps import (
    active_effects,
    jumps,
    moves_jumps,
    samples_beside_jumps,
    spreads_jumps,
)
from jbf.estimation.run_start import _findings, _what
from jbf.estimation.work import ANY_STEPS, STEPS_A_SAMPLE, Work
from jbf.models.catalogue import Parameter
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.estimation.initial_state"]
N = 100
TIME = 0.1 * np.arange(N)


def stretch(first: int, last: int) -> npt.NDArray[np.bool_]:
    found: npt.NDArray[np.bool_] = (np.arange(N) >= first) & (np.arange(N) <= last)
    return found


# ---- how a run began ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("first", "last", "longer", "until"),
    [(0, 20, 1.5, 30), (10, 20, 1.5, 25), (10, 20, 1.0, 20), (10, 10, 1.5, 10), (0, 30, 1.1, 33)],
)
def test_a_beginning_is_set_aside_for_longer_than_it_shows(
    first: int, last: int, longer: float, until: int
) -> None:
    """From where two beginnings part to where they meet, and in between, whatever is there."""
    apart = stretch(first, last)
    apart[first + 1 : last] = False
    which = Memory((0.1, 1.0), longer, 0.5)
    assert np.flatnonzero(_remembered(record(TIME + 5.0), apart, which)).tolist() == list(
        range(first, until + 1)
    )


@pytest.mark.parametrize(("last", "kept"), [(48, True), (49, False), (99, False)])
def test_a_run_that_never_forgets_is_taken_as_it_is(last: int, kept: bool) -> None:
    """Less than half of it may go."""
    found = _remembered(record(TIME), stretch(0, last), Memory((0.1, 1.0), 1.0, 0.5))
    assert found.any() == kept
    assert len(found) == N
    assert not _remembered(record(TIME), stretch(0, -1), Memory((0.1,), 1.0, 0.5)).any()


def test_laws_remember_by_their_films_and_their_contacts() -> None:
    """A film was anywhere between a rest and the top speed, a contact bent either way; of a run not
    more than a part may go, of a single stroke most."""
    assert (SPEEDS, WAYS) == ((1e-3, 0.1, 1.0), (-1.0, 1.0))
    assert (MOST_OF_A_RUN, MOST_OF_A_STROKE, MOST_OF_ALL) == (0.5, 0.75, 0.5)
    assert (LONGER, FURTHER) == (1.5, 1.1)
    assert memories("coulomb", ()) == []
    assert memories("journal", ()) == [Memory(SPEEDS, LONGER, MOST_OF_A_RUN)]
    assert memories("lugre", ()) == [Memory(WAYS, FURTHER, MOST_OF_A_STROKE)]
    # A cell in its play may be anywhere: a run may go whole, of all runs a half.
    assert memories("coulomb", ("sensor_hysteresis",)) == [
        Memory(WAYS, FURTHER, np.inf, MOST_OF_ALL)
    ]
    assert memories("journal", ("sensor_hysteresis",)) == [
        Memory((*SPEEDS, *WAYS), FURTHER, np.inf, MOST_OF_ALL)
    ]
    assert memories("journal", ("sensor_offset",)) == memories("journal", ())


@pytest.mark.parametrize(("noise_n", "until"), [(1.0, 30), (10.0, 20), (25.0, -1), (40.0, -1)])
def test_beginnings_differ_until_a_fifth_of_the_noise(
    noise_n: float, until: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between the highest and the lowest of them: 5 N to sample 20, 0.5 N to sample 30."""
    monkeypatch.setattr(module, "core_motion", lambda rig, run, motion, before: before[0])
    size = np.where(np.arange(N) <= 20, 5.0, np.where(np.arange(N) <= 30, 0.5, 0.0))
    chain: Any = SimpleNamespace(predict=lambda values, motions: [m * size for m in motions])
    p = record(TIME)
    p.rig = None
    which = Memory((-0.5, 0.1, 0.5), 1.0, 0.5)
    (found,) = remembering(chain, np.zeros(1), [p], which, noise_n)
    assert np.flatnonzero(found).tolist() == list(range(until + 1))


@pytest.mark.parametrize(("most", "kept"), [(0.32, True), (0.31, True), (0.30, False)])
def test_of_all_runs_no_more_than_a_share_goes(
    most: float, kept: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of two runs 62 samples of 200 are 31 %."""
    monkeypatch.setattr(module, "core_motion", lambda rig, run, motion, before: before[0])
    size = np.where(np.arange(N) <= 30, 5.0, 0.0)
    chain: Any = SimpleNamespace(predict=lambda values, motions: [m * size for m in motions])
    runs = [record(TIME), record(TIME)]
    for p in runs:
        p.rig = None
    found = remembering(chain, np.zeros(1), runs, Memory((-0.5, 0.5), 1.0, 0.5, most), 1.0)
    assert [int(f.sum()) for f in found] == ([31, 31] if kept else [0, 0])


def test_a_beginning_that_was_off_is_worth_a_word() -> None:
    """Of 3 N in what counts of it, where the rest leaves 1 N; less than twice that is none."""
    prepared = [record(TIME, name=name) for name in "abc"]
    masks = [stretch(0, 20), stretch(5, 10), stretch(0, -1)]
    samples = samples_of(prepared)
    campaign: Any = SimpleNamespace(prepared=prepared, samples=samples)
    kept = samples.within([~m for m in masks])
    residuals = [np.where(m, 3.0, 1.0) for m in masks]
    found = _findings(campaign, residuals, masks, kept, "film was not settled")
    assert [(f.kind, f.channel, f.run, f.unit, f.done) for f in found] == [
        ("unsettled_start", "friction_n", "a", "s", "set aside"),
        ("unsettled_start", "friction_n", "b", "s", "set aside"),
    ]
    assert [f.size for f in found] == pytest.approx([2.0, 0.5])
    assert found[0].words == "the film was not settled when the run began: 2 s, off by 3 N"
    # One that is not worth a word keeps no other from it.
    some = [np.where(m, size, 1.0) for m, size in zip(masks, (1.0, 3.0, 1.0), strict=True)]
    turned: Any = SimpleNamespace(prepared=prepared[::-1], samples=samples.only([2, 1, 0]))
    for given, which in ((campaign, 1), (turned, -1)):
        told_of = _findings(
            given, some[::which], masks[::which], kept.only([0, 1, 2][::which]), "x"
        )
        assert [f.run for f in told_of] == ["b"]
    for part, told in ((0.99, 0), (1.0, 2), (1.01, 2)):
        for unit in (0.25, 1.0, 64.0):
            less = [unit * np.where(m, part * 2.0, 1.0) for m in masks]
            assert len(_findings(campaign, less, masks, kept, "cell")) == told


@pytest.mark.parametrize(
    ("law", "effects", "what"),
    [
        ("journal", (), "film was not settled"),
        ("journal", ("sensor_hysteresis",), "film, or the cell in its play, was not settled"),
        ("lugre", (), "contact was bent another way"),
        ("coulomb", ("sensor_hysteresis",), "cell was elsewhere in its play"),
    ],
)
def test_what_was_another_thing_is_said(law: str, effects: tuple[str, ...], what: str) -> None:
    assert _what(law, effects) == what


# ---- jumps -------------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_a_change_within_a_sample_alone_is_a_jump(unit: float) -> None:
    """Of 8 N in a run of at most 4 N: both samples beside it are told its size."""
    force = unit * np.array([-4.0, -4.0, -4.0, -4.0, 4.0, 4.0, 4.0, 4.0])
    assert jumps(force) == pytest.approx(unit * np.array([0, 0, 0, 8.0, 8.0, 0, 0, 0]))
    # Of less than a tenth of the largest friction it is none.
    for size, there in ((0.39, False), (0.41, True)):
        small = unit * np.array([4.0 - size, 4.0 - size, 4.0 - size, 4.0, 4.0, 4.0])
        assert bool(jumps(small).any()) == there
    assert jumps(unit * np.linspace(-4.0, 4.0, 9)).tolist() == [0.0] * 9


@pytest.mark.parametrize(("before", "alone"), [(0.32, True), (0.35, False)])
def test_a_rise_that_the_record_resolves_is_no_jump(before: float, alone: bool) -> None:
    """A third of it in each of two samples before, or after: it is steep, and no jump."""
    change = np.array([0.0, before, before, 1.0, 0.0, 0.0])
    for steps in (change, change[::-1]):
        force = np.concatenate(([0.0], np.cumsum(steps)))
        assert bool(np.any(jumps(force) > 0.9)) == alone
    # Just a third, and just a tenth of the largest force, are no jump.
    third = np.concatenate(([0.0], np.cumsum([0.0, 1.0, 1.0, 3.0, 0.0, 0.0])))
    assert np.max(jumps(third)) < 3.0
    assert not jumps(np.array([9.0, 9.0, 9.0, 10.0, 10.0, 10.0])).any()
    # Of two samples one may be a ramp's own part.
    one = np.concatenate(([0.0], np.cumsum([0.0, 0.0, 0.9, 1.0, 0.0, 0.0])))
    assert jumps(one).any()


def test_samples_beside_a_jump_count_by_what_is_in_doubt_there() -> None:
    """Half of the jump, 4 N, beside a noise of 3 N: three fifths."""
    force = np.where(np.arange(N) < 50, -4.0, 4.0)
    p = record(TIME, friction=force + 3.0 * np.where(np.arange(N) % 2, 1.0, -1.0))
    samples = samples_of([p])
    found = samples_beside_jumps(samples, [p], [force], ["time_delay"])
    assert np.flatnonzero(~found.counted[0]).tolist() == [49, 50]
    assert found.weight[0][[49, 50]] == pytest.approx([0.6, 0.6])
    assert np.all(np.delete(found.weight[0], [49, 50]) == 1.0)
    assert samples_beside_jumps(samples, [p], [force], ["sensor_offset"]) is samples
    half = replace(samples, weight=(np.full(N, 0.5),))
    assert samples_beside_jumps(half, [p], [force], ["time_delay"]).weight[0][49] == 0.3


def test_behind_a_reversal_a_sample_counts_by_the_error_of_its_instant(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Off by 4 N beside a noise of 3 N: three fifths; no test looks there, nor where none did."""
    count = 20
    asked: list[float] = []
    error = np.where(np.isin(np.arange(count), [7, 8]), 4.0, 0.0)

    def errors(p: Any, prediction: Array, least_n: float) -> Array:
        asked.append(least_n)
        return error

    monkeypatch.setattr(sys.modules["jbf.estimation.jumps"], "instant_errors_n", errors)
    prediction = np.full(count, 5.0)
    noise = 3.0 * np.where(np.arange(count) % 2, 1.0, -1.0)
    noise[3] = 1e3
    run = record(0.02 * np.arange(count), friction=prediction + noise)
    counted = np.arange(count) != 3
    found = samples_beside_jumps(samples_of([run], [counted]), [run], [prediction], ["sensor_lag"])
    # From half of the noise on it is told.
    assert asked == [1.5]
    assert np.flatnonzero(~found.counted[0]).tolist() == [3, 7, 8]
    assert found.weight[0][[7, 8]] == pytest.approx([0.6, 0.6])
    assert found.weight[0][[0, 19]].tolist() == [1.0, 1.0]


def test_effects_that_move_or_spread_jumps_are_known() -> None:
    assert moves_jumps(["sensor_offset", "time_delay"])
    assert not moves_jumps(["sensor_offset"])
    assert spreads_jumps(["sensor_lag"])
    assert not spreads_jumps(["time_delay"])
    assert not moves_jumps([])
    assert not spreads_jumps([])


def test_an_effect_acts_where_a_parameter_is_off_its_null() -> None:
    pages = {
        "F_c_n": Parameter("F_c_n"),
        "one.a": Parameter("a", null=0.0),
        "one.b": Parameter("b"),
        "two.c": Parameter("c", null=np.inf),
        "three.d": Parameter("d"),
    }
    effects = ("one", "two", "three")
    assert active_effects(effects, pages, [1.0, 0.0, 5.0, np.inf, 7.0]) == ["three"]
    assert active_effects(effects, pages, [1.0, 0.1, 5.0, 1e9, 7.0]) == ["one", "two", "three"]


# ---- gaps and work -----------------------------------------------------------------------------


def test_a_gap_is_more_than_four_and_a_half_steps() -> None:
    assert GAP == 4.5
    time = np.cumsum(np.array([0.0, 1.0, 1.0, 4.4, 1.0, 4.6, 1.0, 1.0, 9.0, 1.0]))
    assert _gaps(record(time)).tolist() == [4, 7]
    assert _gaps(record(1e-3 * time)).tolist() == [4, 7]
    assert _gaps(record(np.array([0.0, 1.0, 2.0, 6.5, 7.5, 12.5, 13.5]))).tolist() == [4]


def test_work_is_what_samples_are_worth_and_no_more() -> None:
    # A diagnosis of four thousand samples and less may take as many as one of four thousand.
    assert [Work.of(n).most for n in (1, 4000, 5000)] == [4e8, 4e8, 5e8]
    assert Work.of(10).most == ANY_STEPS
    assert Work.of(10_000).most == STEPS_A_SAMPLE * 10_000
    work = Work(10.0)
    work.take(6.0)
    work.take(4.0)
    assert work.taken == 10.0
    with pytest.raises(Unfinished):
        work.take(1e-6)
    part = work.part(0.25)
    assert (part.most, part.taken) == (2.5, 0.0)
    work.renew()
    assert (work.most, work.taken) == (10.0, 0.0)
    work.renew(3.0)
    assert (work.most, work.taken) == (3.0, 0.0)
    assert Work().most == np.inf
