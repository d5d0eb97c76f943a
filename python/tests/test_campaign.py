"""What a campaign holds of what effects need, in runs of known loads and temperatures; and starts
that take more than its sizes."""

from __future__ import annotations

import sys
from dataclasses import FrozenInstanceError, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import InputError, Parameter, Rig, Run
from jbf.estimation.campaign import LEFT_OF_BIAS, LOADS_DIFFER, Campaign, _each, _span
from jbf.estimation.converter import curve_rms_n, noise_before
from jbf.estimation.starts import (
    CAMPAIGN_RULES,
    RULES_OF_ANY_LAW,
    _bounded,
    _down_to_a_sample,
    _inside,
    _within_the_way,
    with_starts,
)
from jbf.models.catalogue import find_effect
from jbf.records.findings.finding import Finding
from made_of import record, samples_of
from scipy import stats

Array = npt.NDArray[np.float64]
N = 800
TIME = 0.02 * np.arange(N)
SPEED = 0.1 * np.sin(TIME)


def run(name: str = "a", **columns: Any) -> Run:
    force = columns.pop("force", 5.0 * np.sign(SPEED) + 20.0 * SPEED)
    return Run.from_arrays(TIME, SPEED, force, name=name, **columns)


def of(*runs: Run, rig: Rig | None = None) -> Campaign:
    return Campaign.prepare(rig or Rig(), list(runs))


def lacking(name: str, *runs: Run, rig: Rig | None = None) -> str | None:
    return of(*runs, rig=rig).lacking(find_effect(name))


# ---- what it holds -----------------------------------------------------------------------------


def test_no_run_and_no_force_are_refused() -> None:
    with pytest.raises(InputError, match="no run was given"):
        of()
    with pytest.raises(InputError, match="zero in every sample of every run"):
        of(run(force=np.zeros(N)))
    # Of two runs one with a force will do.
    assert len(of(run("a"), run("b", force=np.zeros(N))).prepared) == 2


def test_of_forces_that_are_nothing_throughout_the_first_run_is_named() -> None:
    nothing = [run(name, force=np.zeros(N)) for name in "ab"]
    nothing[1] = replace(nothing[1], path=Path("last.csv"), velocity_m_s=2.0 * SPEED)
    with pytest.raises(InputError) as refused:
        of(*nothing)
    assert (refused.value.file, refused.value.column) == ("a", "friction_n")


def test_a_campaign_is_one_with_itself_alone_and_stays_what_it_is() -> None:
    """What is known of it is kept under it."""
    campaign = of(run())
    assert campaign != replace(campaign)
    assert {campaign: 1}[campaign] == 1
    with pytest.raises(FrozenInstanceError):
        campaign.prepared = ()  # type: ignore[misc]


def test_a_run_that_was_given_twice_is_one() -> None:
    other = run("b", force=6.0 * np.sign(SPEED))
    campaign = of(run("a"), other, run("c"))
    assert [p.run.name for p in campaign.prepared] == ["a", "b"]
    told = [f.run for f in campaign.findings if f.kind == "repeated_run"]
    assert len(told) == 1
    assert campaign.named == "a"


@pytest.mark.parametrize(("share", "differ"), [(0.049, False), (0.05, False), (0.055, True)])
def test_loads_differ_by_more_than_a_twentieth(share: float, differ: bool) -> None:
    assert LOADS_DIFFER == 0.05
    loads = [np.full(N, 100.0), np.full(N, 100.0 * (1.0 - share))]
    campaign = of(*(run(name, load_n=load) for name, load in zip("ab", loads, strict=True)))
    assert campaign.has_loads == differ
    # Or within a run: nine tenths of it lie between the ends.
    wave = 100.0 * (1.0 - share * 0.5 * (1.0 + np.sin(0.5 * TIME)))
    span = np.ptp(np.quantile(wave, [0.05, 0.95]))
    one = of(run(load_n=wave))
    assert one.has_loads == (span > 0.05 * np.median(wave))
    assert not of(run()).has_loads


def test_noise_on_a_load_is_no_load() -> None:
    noisy = 100.0 + 4.0 * np.random.default_rng(1).standard_normal(N)
    assert not of(run(load_n=noisy)).has_loads


@pytest.mark.parametrize("noise_n", [0.0, 4.0, 8.0])
def test_how_far_a_load_goes_is_told_without_its_noise(noise_n: float) -> None:
    """A slow load of normally distributed heights, 4 N each way: 3.29 of them from 5 % to 95 %."""
    n = 20000
    turns = np.abs(np.arange(n) % 2000 - 999.5) / 1000.0
    slow = 100.0 + 4.0 * stats.norm.ppf(0.0005 + 0.999 * turns)
    noisy = slow + noise_n * np.random.default_rng(2).standard_normal(n)
    assert _span(noisy) == pytest.approx(3.29 * 4.0, rel=0.06)


@pytest.mark.parametrize(
    ("rates_hz", "period_s"),
    [
        ((0.0, 0.0, 0.0), None),
        ((50.0, 20.0, 5.0), None),
        ((0.5, 0.0, 0.0), 2.0),
        ((50.0, 0.0, 30.0), 1.0 / 40.0),
        ((0.0, 50.0, 0.0), 1.0 / 50.0),
    ],
)
def test_a_run_is_looked_at_anew_by_the_rate_that_others_of_its_logger_tell(
    rates_hz: tuple[float, ...], period_s: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def of_run(rig: Any, run: Any, period_s: float | None = None) -> Any:
        return SimpleNamespace(run=run, drawn_at_hz=rates_hz[run], period_s=period_s)

    module = sys.modules["jbf.estimation.campaign"]
    monkeypatch.setattr(module, "Prepared", SimpleNamespace(of=of_run))
    runs: Any = list(range(len(rates_hz)))
    found: Any = _each(Rig(), runs)
    assert [p.run for p in found] == runs
    wanted = [None if rate > 0.0 else period_s for rate in rates_hz]
    assert [p.period_s for p in found] == [pytest.approx(w) if w else None for w in wanted]


def test_temperatures_go_from_the_lowest_to_the_highest_on_record() -> None:
    cold, warm = np.linspace(20.0, 22.0, N), np.linspace(25.0, 23.0, N)
    campaign = of(run("a", temperature_c=cold), run("b", temperature_c=warm))
    assert campaign.temperature_range_c == pytest.approx((20.0, 25.0), abs=0.1)
    assert campaign.temperatures_k == pytest.approx(5.0, abs=0.2)
    some = of(run("a", temperature_c=cold), run("b", force=6.0 * np.sign(SPEED)))
    assert some.temperature_range_c is None
    assert some.temperatures_k is None


def test_what_runs_lack_is_said() -> None:
    """Of what an effect needs the first that is not there; nothing where all of it is."""
    assert lacking("sensor_offset", run()) is None
    assert lacking("position_ripple", run()) is not None
    loaded = [run(name, load_n=np.full(N, load)) for name, load in (("a", 80.0), ("b", 120.0))]
    by_load = "zero_load_dependence"
    assert lacking(by_load, *loaded) is None
    alike = "all runs have one load, under which it changes nothing"
    assert lacking(by_load, *loaded[:1]) == alike


@pytest.mark.parametrize(("span_k", "enough"), [(1.9, False), (2.1, True)])
def test_a_temperature_must_move_by_two_kelvin(span_k: float, enough: bool) -> None:
    effect: Any = SimpleNamespace(needs=("temperatures",), columns=())
    campaign = of(run(temperature_c=np.linspace(20.0, 20.0 + span_k, N)))
    said = campaign.lacking(effect)
    assert (said is None) == enough
    if not enough:
        assert str(said).startswith("the temperature stays within 1.9 K: what it changes takes 2 K")
    assert of(run()).lacking(effect) == "not every run has the column temperature_c"


def test_columns_angles_and_places_are_needed_of_every_run() -> None:
    def asked(campaign: Campaign, *needs: str, columns: tuple[str, ...] = ()) -> str | None:
        effect: Any = SimpleNamespace(needs=needs, columns=columns)
        return campaign.lacking(effect)

    path = np.concatenate(([0.0], np.cumsum(0.01 * (SPEED[1:] + SPEED[:-1]))))
    whole = of(run("a", position_m=path), run("b", position_m=path, force=6.0 * np.sign(SPEED)))
    part = of(run("a", position_m=path), run("b", force=6.0 * np.sign(SPEED)))
    assert asked(whole, "position") is None
    assert asked(part, "position") == "not every run has a position or an angle"
    assert asked(part, columns=("position_m",)) == "not every run has the column position_m"
    assert asked(whole, columns=("position_m", "velocity_m_s")) is None
    assert asked(whole) is None


def test_parts_of_a_campaign_keep_what_belongs_to_them() -> None:
    campaign = of(run("a"), run("b", force=6.0 * np.sign(SPEED)), run("c", force=7.0 * SPEED))
    some = campaign.only([2, 0])
    assert [p.run.name for p in some.prepared] == ["c", "a"]
    assert some.samples.runs == ("c", "a")
    assert some.work is campaign.work
    fewer = campaign.without([np.arange(N) < 100] * 3)
    assert not any(c[:100].any() for c in fewer.samples.counted)
    assert all(
        np.array_equal(a[100:], b[100:])
        for a, b in zip(fewer.samples.counted, campaign.samples.counted, strict=True)
    )
    found = Finding("made_up", "friction_n", "a", 1.0, "1", "none", "said")
    told = campaign.with_findings([found]).with_findings([found])
    assert told.more_findings == (found, found)
    assert told.findings[-2:] == (found, found)


# ---- a converter's steps -----------------------------------------------------------------------


def stepped(step_n: float, moves: Array, *, taken: float = 0.0) -> Campaign:
    """A campaign of readings that move so, of whose bias so much was taken off."""
    readings = np.concatenate(([0.0], np.cumsum(moves)))
    n = len(readings)
    p = record(0.02 * np.arange(n), friction=readings - taken)
    p.readings_n = readings
    steps = (Finding("steps", "friction_n", "a", step_n, "N", "none", ""),) if step_n else ()
    p.examined = SimpleNamespace(findings=steps)
    return Campaign(Rig(), (p,), samples_of([p]))


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_steps_make_of_a_mean_what_their_noise_leaves(unit: float) -> None:
    assert LEFT_OF_BIAS == 0.3
    moves = unit * np.tile([0.0, 0.0, 1.0, 0.0, -1.0, 0.0], 50)
    campaign = stepped(unit, moves)
    assert campaign.step_n == unit
    noise = noise_before(unit, moves)
    assert 0.05 * unit < noise < 0.5 * unit
    assert campaign.steps_rms_n(10.0 * unit) == pytest.approx(curve_rms_n(unit, noise))
    # A residual is no less than the noise.
    small = 0.5 * noise
    assert campaign.steps_rms_n(small) == pytest.approx(curve_rms_n(unit, small))
    # Of what was taken off a share is left.
    assert stepped(unit, moves, taken=0.25 * unit).steps_rms_n(unit) == pytest.approx(
        LEFT_OF_BIAS * 0.25 * unit
    )
    assert stepped(0.0, moves).steps_rms_n(unit) == 0.0
    assert stepped(0.0, moves).step_n == 0.0


# ---- starts ------------------------------------------------------------------------------------


def page(**more: Any) -> Parameter:
    return Parameter("p", **{"lower": 1e-3, "upper": 1e3, "starts": (1.0, 0.5), **more})


def test_starts_are_brought_within_bounds_and_each_is_one() -> None:
    assert _inside(page(), (1e-9, 2.0, 1e9, 2.0, 5e9)).starts == (1e-3, 2.0, 1e3)
    assert _inside(page(), ()).starts == (1.0, 0.5)


def test_a_transition_speed_is_at_most_five_times_the_fastest() -> None:
    """0.1 m/s on record; and twice the catalogue's start at least."""
    campaign = of(run())
    assert _bounded(page(starts=(0.05,)), campaign).upper == pytest.approx(0.5, rel=0.01)
    assert _bounded(page(starts=(0.5, 2.0)), campaign).upper == 4.0
    assert _bounded(page(starts=(0.05,), upper=0.3), campaign).upper == 0.3


def test_a_pitch_comes_four_times_in_the_way() -> None:
    """A sine of 0.1 m/s at 1 rad/s goes 0.2 m."""
    path = np.concatenate(([0.0], np.cumsum(0.01 * (SPEED[1:] + SPEED[:-1]))))
    campaign = of(run(position_m=path))
    assert _within_the_way(page(), campaign).upper == pytest.approx(0.05, rel=0.02)
    assert _within_the_way(page(upper=0.01), campaign).upper == 0.01
    assert _within_the_way(page(lower=0.08), campaign).upper == pytest.approx(0.08, rel=1e-5)
    assert _within_the_way(page(lower=0.08), campaign).upper > 0.08


def test_times_start_at_a_third_and_a_tenth_of_a_run() -> None:
    last = float(TIME[-1])
    assert CAMPAIGN_RULES["run_time"](of(run())) == pytest.approx((0.3 * last, 0.1 * last))


def test_a_lateness_goes_by_thirds_down_to_a_quarter_of_a_sample() -> None:
    """From 0.5 s by thirds to 5 ms: five steps."""
    found = _down_to_a_sample(page(), of(run()))
    assert found == pytest.approx((1.0, 0.5, *(0.5 / 3.0**k for k in range(1, 6))))
    assert _down_to_a_sample(page(starts=(0.004,)), of(run())) == (0.004,)


def test_the_middle_and_the_half_of_the_stroke() -> None:
    """Of a way from 0 to 0.2 m, and a little beyond."""
    path = np.concatenate(([0.0], np.cumsum(0.01 * (SPEED[1:] + SPEED[:-1]))))
    campaign = of(run(position_m=path))
    (middle,), (half,) = (CAMPAIGN_RULES[f"stroke_{what}"](campaign) for what in ("middle", "half"))
    assert middle == pytest.approx(0.1, abs=0.005)
    assert 0.1 <= half < 0.12


def test_a_cells_errors_are_three_hundredths_of_its_largest_reading() -> None:
    force = 5.0 * np.sign(SPEED)
    force[400] = 1e4
    campaign = of(run(force=force))
    assert RULES_OF_ANY_LAW["cell_play"](campaign) == pytest.approx((0.15,))
    assert RULES_OF_ANY_LAW["cell_cubic"](campaign) == pytest.approx((0.03 / 25.0,))


def test_a_reference_is_the_lubricants_or_the_mean_to_a_degree() -> None:
    cold, warm = np.full(N, 20.2), np.full(N, 25.0)
    runs = [run("a", temperature_c=cold), run("b", temperature_c=warm)]
    rule = RULES_OF_ANY_LAW["reference_temperature"]
    assert rule(of(*runs)) == (23.0,)
    assert rule(of(run())) == ()
    oil: Any = SimpleNamespace(
        rig=SimpleNamespace(lubricant=SimpleNamespace(temperature_c=41.0)), prepared=()
    )
    assert rule(oil) == (41.0,)
    unknown: Any = SimpleNamespace(
        rig=SimpleNamespace(lubricant=SimpleNamespace(temperature_c=None)),
        prepared=of(*runs).prepared,
    )
    assert rule(unknown) == (23.0,)


def test_a_page_that_says_nothing_starts_where_it_says() -> None:
    found = with_starts({"p": page()}, of(run()), in_newtons=True)
    assert found["p"] == page()
    kinetic = with_starts({"p": page(start="kinetic")}, of(run()), in_newtons=True)["p"]
    assert kinetic.starts[0] == pytest.approx(5.0, rel=0.05)
    assert with_starts({"p": page(start="kinetic")}, of(run()), in_newtons=False)["p"].starts == (
        1.0,
        0.5,
    )
