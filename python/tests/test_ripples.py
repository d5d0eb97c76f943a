"""Waves over the way with a phase in each run: their sizes and shares by hand, and what is none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Rig
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.ripples import (
    BINS_A_PITCH,
    LEAST_PERIODS,
    _in_most,
    _pitch,
    _waves,
    _words,
    find_ripples,
)
from made_of import record, samples_of
from scipy import stats

Array = npt.NDArray[np.float64]
STEP_S = 0.02
N = 1500
PITCH_M = 0.05
SPEEDS = (0.1, 0.137, 0.171, 0.229, 0.083)


def campaign_of(prepared: list[Any], **rig: Any) -> Any:
    held = {"bearing": None, "drive": None, "quantities": Rig().quantities, **rig}
    return SimpleNamespace(prepared=tuple(prepared), rig=SimpleNamespace(**held))


def there_and_back(speed: float, name: str) -> Any:
    """A run that turns round in its middle."""
    time = STEP_S * np.arange(N)
    v = np.where(np.arange(N) < N // 2, speed, -speed)
    return record(time, name=name, velocity=v, way=0.3 + np.cumsum(v) * STEP_S)


def one_way(speed: float, name: str) -> Any:
    time = STEP_S * np.arange(N)
    return record(time, name=name, velocity=np.full(N, speed), way=0.3 + speed * time)


def waves(
    prepared: list[Any], sizes: list[float], *, phase: float | None = None, along: bool = False
) -> list[Array]:
    """White noise of 1 N, and waves of these sizes; each run's phase its own unless told."""
    random = np.random.default_rng(3)
    found = []
    for i, (p, size) in enumerate(zip(prepared, sizes, strict=True)):
        turns = 2.0 * np.pi * (p.motion.angle_rad - p.motion.angle_rad[0]) / PITCH_M
        wave = size * np.cos(turns + (2.4 * i if phase is None else phase))
        way = np.sign(p.motion.velocity_m_s) if along else 1.0
        found.append(random.standard_normal(N) + wave * way)
    return found


def told(
    prepared: list[Any], e: list[Array], *, share: float = 1e-6, **rig: Any
) -> list[tuple[str, float]]:
    policy = replace(DEFAULT, tone_share=share)
    found = find_ripples(campaign_of(prepared, **rig), samples_of(prepared), e, e, policy)
    assert all(x.axis == "way" for x in found)
    return [(x.where, x.share) for x in found]


@pytest.fixture(scope="module")
def prepared() -> list[Any]:
    return [there_and_back(speed, name) for speed, name in zip(SPEEDS, "abcde", strict=True)]


# ---- what is told ------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_a_wave_of_the_force_is_told_with_pitch_size_and_share(
    prepared: list[Any], unit: float
) -> None:
    """The median of 0.8 to 1.2 N is 1 N; half the mean of the squares beside a variance of one."""
    sizes = [0.8, 0.9, 1.0, 1.1, 1.2]
    e = [unit * x for x in waves(prepared, sizes)]
    ((words, share),) = told(prepared, e)
    lead, size, rest = words.split(", ")
    assert lead.startswith("a force that comes again with every 0.0")
    assert float(lead.split()[-2]) == pytest.approx(PITCH_M, rel=0.01)
    assert float(size.split()[0]) == pytest.approx(unit, rel=0.1)
    assert (size.split()[1], rest) == ("N", "in each run at a phase of its own")
    half = 0.5 * np.mean(np.square(sizes))
    assert share == pytest.approx(half / (1.0 + half), rel=0.1)
    assert told(prepared, e, share=0.9 * share) != []
    assert told(prepared, e, share=share) != []
    assert told(prepared, e, share=1.1 * share) == []


def test_a_wave_in_the_direction_of_motion_is_one_of_friction(prepared: list[Any]) -> None:
    ((words, share),) = told(prepared, waves(prepared, [1.0] * 5, along=True))
    assert words.startswith("friction that comes again with every 0.0")
    assert share == pytest.approx(1.0 / 3.0, rel=0.1)


def test_a_sample_without_speed_has_no_part_in_friction(prepared: list[Any]) -> None:
    first = there_and_back(SPEEDS[0], "a")
    first.motion.velocity_m_s[100:105] = 0.0
    e = waves([first, *prepared[1:]], [1.0] * 5, along=True)
    ((words, _),) = told([first, *prepared[1:]], e)
    assert words.startswith("friction that comes again with every 0.0")


def test_of_two_the_clearer_is_told(prepared: list[Any]) -> None:
    both = [
        a + 2.0 * b
        for a, b in zip(
            waves(prepared, [1.0] * 5), waves(prepared, [1.0] * 5, along=True), strict=True
        )
    ]
    ((words, _),) = told(prepared, both)
    assert words.startswith("friction")


# ---- what is none ------------------------------------------------------------------------------


def test_noise_has_no_wave(prepared: list[Any]) -> None:
    assert told(prepared, waves(prepared, [0.0] * 5)) == []


def test_shafts_in_bearings_and_two_runs_are_not_looked_at(prepared: list[Any]) -> None:
    e = waves(prepared, [1.0] * 5)
    assert told(prepared, e, bearing=object()) == []
    assert told(prepared[:2], e[:2]) == []
    assert len(told(prepared[:3], e[:3])) == 1


def test_one_phase_in_all_runs_is_an_effects_to_tell(prepared: list[Any]) -> None:
    assert told(prepared, waves(prepared, [1.0] * 5, phase=0.7)) == []


def test_at_one_speed_a_wave_is_a_tone() -> None:
    alike = [one_way(0.1, name) for name in "abcd"]
    assert told(alike, waves(alike, [1.0] * 4)) == []
    apart = [one_way(speed, name) for speed, name in zip(SPEEDS, "abcde", strict=True)]
    assert len(told(apart, waves(apart, [1.0] * 5))) == 1


def test_one_run_of_five_with_a_wave_is_not_most(prepared: list[Any]) -> None:
    assert told(prepared, waves(prepared, [3.0, 0.0, 0.0, 0.0, 0.0])) == []
    assert len(told(prepared, waves(prepared, [2.0, 2.0, 2.0, 2.0, 0.0]))) == 1


# ---- the pitch ---------------------------------------------------------------------------------


def lines(part: float, count: int = 6, per: int = 100) -> tuple[list[Any], list[Any], float]:
    """Ways of one sample a bin, and waves in noise of so many times the least size that a line is
    no chance at; with that pitch."""
    fine = 1e-3
    n = 16 * per
    ways = [fine * (np.arange(n) + 0.5) for _ in range(count)]
    tried = 4 * n // 4
    least = stats.chi2.isf(DEFAULT.tone_chance / tried, 2 * count)
    # Twice the power over level and count: A^2 n / (2 level) of each run, beside chance's two.
    a2 = 2.0 * part * (least - 2.0 * count) / (count * n)
    random = np.random.default_rng(11)
    e = []
    for i, way in enumerate(ways):
        noise = random.standard_normal(n)
        turns = 2.0 * np.pi * way / (per * fine)
        for f in (np.cos(turns), np.sin(turns)):
            # What chance has there is known: nothing.
            noise -= f * 2.0 * float(f @ noise) / n
        noise *= 1.0 / np.sqrt(np.mean(noise**2))
        e.append(noise + np.sqrt(a2) * np.cos(turns + 1.3 * i))
    return ways, e, per * fine


@pytest.mark.parametrize(("part", "is_found"), [(0.75, False), (1.6, True)])
def test_a_pitch_is_no_chance_in_all_lines_that_are_looked_at(part: float, is_found: bool) -> None:
    """Ordinates add to a chi-square of two degrees a run."""
    ways, e, pitch = lines(part)
    samples = samples_of([record(STEP_S * np.arange(len(w))) for w in ways])
    for unit in (0.01, 10.0):
        found = _pitch(ways, [unit * x for x in e], samples, DEFAULT)
        assert found == (pytest.approx(pitch, rel=0.01) if is_found else None)


@pytest.mark.parametrize(("periods", "is_found"), [(7.0, False), (9.0, True)])
def test_the_way_holds_eight_periods(periods: float, is_found: bool) -> None:
    assert LEAST_PERIODS == 8.0
    way = np.linspace(0.0, 1.0, 2000)
    e = [np.cos(2.0 * np.pi * periods * way + i) for i in range(4)]
    noise = np.random.default_rng(4).standard_normal((4, 2000))
    samples = samples_of([record(STEP_S * np.arange(2000))] * 4)
    found = _pitch([way] * 4, [a + b for a, b in zip(e, noise, strict=True)], samples, DEFAULT)
    assert (found is not None and abs(found * periods - 1.0) < 0.05) == is_found


@pytest.mark.parametrize(("bins", "is_found"), [(3.6, False), (4.4, True)])
def test_the_shortest_pitch_is_four_steps_of_the_way(bins: float, is_found: bool) -> None:
    assert BINS_A_PITCH == 4.0
    way = np.arange(2000.0)
    e = [2.0 * np.cos(2.0 * np.pi * way / bins + i) for i in range(4)]
    noise = np.random.default_rng(5).standard_normal((4, 2000))
    samples = samples_of([record(STEP_S * np.arange(2000))] * 4)
    found = _pitch([way] * 4, [a + b for a, b in zip(e, noise, strict=True)], samples, DEFAULT)
    assert found == (pytest.approx(bins, rel=0.01) if is_found else None)


def noisy(ways: list[Array], bins: float, size: float = 1.0) -> list[Array]:
    """Waves of one phase a run in white noise of 1 N."""
    random = np.random.default_rng(9)
    return [
        size * np.cos(2.0 * np.pi * way / bins + i) + random.standard_normal(len(way))
        for i, way in enumerate(ways)
    ]


def pitch_of(ways: list[Array], e: list[Array]) -> float | None:
    return _pitch(ways, e, samples_of([record(STEP_S * np.arange(len(w))) for w in ways]), DEFAULT)


def test_lines_are_a_quarter_of_a_line_apart() -> None:
    """A way of 2000 bins has lines at 1/8000 of a wave a bin: one at every whole number of 400."""
    ways = [np.arange(2000.0)] * 4
    assert pitch_of(ways, noisy(ways, 20.0)) == pytest.approx(20.0, rel=1e-9)
    assert pitch_of(ways, noisy(ways, 8000.0 / 401.0)) == pytest.approx(8000.0 / 401.0, rel=1e-9)


def test_a_pitch_of_just_four_bins_is_looked_for() -> None:
    ways = [np.arange(2000.0)] * 4
    assert pitch_of(ways, noisy(ways, 4.0)) == pytest.approx(4.0, rel=1e-9)


@pytest.mark.parametrize(("long", "is_found"), [(2, False), (3, True)])
def test_three_runs_are_long_enough_for_a_pitch(long: int, is_found: bool) -> None:
    """Of a pitch of 100 bins one of 2000 holds twenty, one of 500 but five."""
    ways = [np.arange(2000.0)] * long + [np.arange(500.0)] * 2
    found = pitch_of(ways, noisy(ways, 100.0))
    assert found == (pytest.approx(100.0, rel=0.01) if is_found else None)


def test_runs_that_stand_still_or_leave_nothing_have_no_pitch() -> None:
    ways, e, pitch = lines(3.0)
    samples = samples_of([record(STEP_S * np.arange(len(w))) for w in ways])
    still = [np.zeros(len(w)) for w in ways]
    assert _pitch(still, e, samples, DEFAULT) is None
    assert _pitch(ways, still, samples, DEFAULT) is None
    # One such run does not keep the others from being seen.
    first = [np.zeros(len(e[0])), *e[1:]]
    assert _pitch(ways, first, samples, DEFAULT) == pytest.approx(pitch, rel=0.01)
    resting = [np.zeros(len(ways[0])), *ways[1:]]
    assert _pitch(resting, e, samples, DEFAULT) == pytest.approx(pitch, rel=0.01)


# ---- in most runs, and its sizes ---------------------------------------------------------------


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_the_weakest_two_thirds_have_the_wave_beyond_chance(unit: float) -> None:
    """Of three runs two: twice their ordinates is a chi-square of four degrees."""
    n = 1000
    way = np.arange(n) / 50.0
    samples = samples_of([record(STEP_S * np.arange(n))] * 3)
    least = stats.chi2.isf(1e-3, 4)
    for part, most in ((0.9, False), (1.1, True)):
        # A wave of mean square s beside what is across it, of mean square 1 - s: n s / 1 each.
        share = 0.5 * part * least / n
        across = np.cos(2.0 * np.pi * 7.3 * way)
        rest = np.where(np.arange(n) % 2, 1.0, -1.0) + 0.0 * across
        wave = np.sqrt(2.0 * share) * np.cos(2.0 * np.pi * way)
        e = [unit * (wave + np.sqrt(1.0 - share) * rest) for _ in range(2)]
        e.append(unit * 5.0 * np.cos(2.0 * np.pi * way))
        assert _in_most([way] * 3, e, samples, 1.0) == most


@pytest.mark.parametrize(("periods", "most"), [(8.0, True), (7.99, False)])
def test_a_run_of_just_eight_periods_has_its_say(periods: float, most: bool) -> None:
    """Shorter ones are not asked; where none is, none has the wave."""
    n = 1000
    way = np.linspace(0.0, 4.0, n)
    samples = samples_of([record(STEP_S * np.arange(n))] * 3)
    e = [np.cos(2.0 * np.pi * periods * way / 4.0)] * 3
    assert _in_most([way] * 3, e, samples, 4.0 / periods) == most
    # Among longer ones it is left out.
    long = np.linspace(0.0, 40.0, n)
    whole = [np.cos(2.0 * np.pi * periods * x / 4.0) for x in (way, long, long)]
    assert _in_most([way, long, long], whole, samples, 4.0 / periods)


def test_waves_have_the_share_of_their_squares_and_their_median_size() -> None:
    """Sizes 1, 2 and 4 N on a level, phases 0, 0 and half a turn: (1 + 2 - 4)^2 / 3 of 21 is one
    wave's."""
    n = 800
    way = np.arange(n) / 40.0
    samples = samples_of([record(STEP_S * np.arange(n))] * 3)
    r = [a * np.cos(2.0 * np.pi * way) for a in (1.0, 2.0, -4.0)]
    other = 3.0 * np.where(np.arange(n) % 2, 1.0, -1.0)
    share, size, one = _waves([way] * 3, [x + other for x in r], samples, 1.0)
    assert share == pytest.approx(10.5 / (10.5 + 27.0))
    assert size == pytest.approx(2.0)
    assert one == pytest.approx((1.0 / 3.0) / 21.0)
    # A level is none of it, but part of what is left.
    share, size, one = _waves([way] * 3, [x + other + 1.0 for x in r], samples, 1.0)
    assert share == pytest.approx(10.5 / (10.5 + 27.0 + 3.0))
    assert size == pytest.approx(2.0)
    # Of samples that do not count nothing is asked.
    half = samples_of([record(STEP_S * np.arange(n))] * 3, [np.arange(n) < 400] * 3)
    wild = [np.where(np.arange(n) < 400, x, 100.0) for x in r]
    assert _waves([way] * 3, wild, half, 1.0)[:2] == pytest.approx((1.0, 2.0))


def test_words_are_those_of_the_rig() -> None:
    """A pitch of 5 mm beside a lead of 20 mm comes four times a turn."""
    linear = _words(campaign_of([]), 0.00512345, 0.1234, along=False)
    assert linear == (
        "a force that comes again with every 0.005123 m, 0.12 N, in each run at a phase of its own"
    )
    driven = _words(campaign_of([], drive=SimpleNamespace(pitch_m=0.02)), 0.005, 1.0, along=True)
    assert driven == (
        "friction that comes again with every 0.005 m (4 times a turn), 1 N, "
        "in each run at a phase of its own"
    )
    joint = replace(Rig().quantities, motion="rotary", noun="torque", force="N m", length="rad")
    turning = _words(campaign_of([], quantities=joint), 2.0 * np.pi / 36.0, 1.0, along=False)
    assert turning.startswith("a torque that comes again 36 times a turn, 1 N m, ")
    unknown = SimpleNamespace(pitch_m=None)
    assert "times a turn" not in _words(campaign_of([], drive=unknown), 0.005, 1.0, along=False)
