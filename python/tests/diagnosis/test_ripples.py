"""Ripples along the path with a random phase in each run: pitch, size, share, significance."""

from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from jbf import Rig
from jbf.diagnosis import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure.periodic import find_ripples
from jbf.estimation.campaign import Campaign
from jbf.records.drive import Drive
from scipy import stats
from slides import STEP_S, Array, numbers_in, slides

N = 1500
PITCH_M = 0.05
SPEEDS_M_S = (0.1, 0.137, 0.171, 0.229, 0.083)


@cache
def reversing(speeds: tuple[float, ...] = SPEEDS_M_S) -> Campaign:
    """Slides that reverse once, in the middle of the run."""
    return slides([np.where(np.arange(N) < N // 2, v, -v) for v in speeds])


@cache
def one_way(speeds: tuple[float, ...] = SPEEDS_M_S) -> Campaign:
    return slides([np.full(N, v) for v in speeds])


def paths(campaign: Campaign) -> list[Array]:
    return [p.motion.angle_rad - p.motion.angle_rad[0] for p in campaign.prepared]


def waves(
    campaign: Campaign,
    amplitudes: Sequence[float],
    *,
    pitch: float = PITCH_M,
    phase: float | None = None,
    friction: bool = False,
    seed: int = 3,
) -> list[Array]:
    """White noise of 1 N and a wave along the path; each run has its own phase by default.

    A wave of `friction` has the sign of the velocity.
    """
    random = np.random.default_rng(seed)
    signals = []
    for i, (p, path) in enumerate(zip(campaign.prepared, paths(campaign), strict=True)):
        angle = 2.0 * np.pi * path / pitch + (2.4 * i if phase is None else phase)
        sign = np.sign(p.motion.velocity) if friction else 1.0
        signals.append(random.standard_normal(len(path)) + amplitudes[i] * np.cos(angle) * sign)
    return signals


def ripples_in(campaign: Campaign, signals: list[Array], share: float = 1e-6) -> list[Remainder]:
    """Ripples of the given innovations and residuals."""
    policy = DEFAULT.with_values({"tones.min_share": share})
    return find_ripples(campaign, campaign.samples, signals, signals, policy)


def pitch_and_size(remainder: Remainder) -> tuple[float, float]:
    """Pitch (m) and amplitude (N) stated in a description."""
    pitch_m, size_n = numbers_in(r"period ([\d.e+-]+) m.*?, ([\d.e+-]+) N;", remainder.where)
    return pitch_m, size_n


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_ripple_is_reported_with_its_pitch_median_size_and_share(unit: float) -> None:
    campaign, sizes = reversing(), [0.8, 0.9, 1.0, 1.1, 1.2]
    signals = [unit * x for x in waves(campaign, sizes)]
    (found,) = ripples_in(campaign, signals)
    assert found.axis == "way"
    assert found.where.startswith("periodic force")
    assert pitch_and_size(found) == pytest.approx((PITCH_M, unit), rel=0.1)
    power = 0.5 * float(np.mean(np.square(sizes)))
    assert found.share == pytest.approx(power / (1.0 + power), rel=0.1)
    assert len(ripples_in(campaign, signals, 0.99 * found.share)) == 1
    assert ripples_in(campaign, signals, 1.01 * found.share) == []


def test_ripple_with_the_sign_of_the_velocity_is_reported_as_friction() -> None:
    campaign = reversing()
    (found,) = ripples_in(campaign, waves(campaign, [1.0] * 5, friction=True))
    assert found.where.startswith("periodic friction")
    assert pitch_and_size(found) == pytest.approx((PITCH_M, 1.0), rel=0.1)
    assert found.share == pytest.approx(1.0 / 3.0, rel=0.1)


@pytest.mark.parametrize("amplitude", [0.5, 2.0])
def test_only_the_larger_ripple_is_reported_if_a_record_has_two(amplitude: float) -> None:
    campaign = reversing()
    force = waves(campaign, [1.0] * 5)
    friction = waves(campaign, [amplitude] * 5, friction=True, seed=4)
    (found,) = ripples_in(campaign, [a + b for a, b in zip(force, friction, strict=True)])
    assert found.where.startswith("periodic friction" if amplitude > 1.0 else "periodic force")


def test_no_ripple_is_reported_in_white_noise() -> None:
    campaign = reversing()
    for seed in range(10):
        assert ripples_in(campaign, waves(campaign, [0.0] * 5, seed=seed)) == []


def test_wave_with_one_phase_in_all_runs_is_not_reported_as_a_ripple() -> None:
    campaign = reversing()
    assert ripples_in(campaign, waves(campaign, [1.0] * 5, phase=0.7)) == []


def test_wave_is_not_reported_as_a_ripple_if_all_runs_have_one_speed() -> None:
    alike, apart = one_way((0.1,) * 4), one_way()
    assert ripples_in(alike, waves(alike, [1.0] * 4)) == []
    assert len(ripples_in(apart, waves(apart, [1.0] * 5))) == 1


@pytest.mark.parametrize(("runs", "found"), [(2, 0), (3, 1)])
def test_ripple_is_not_reported_with_fewer_than_three_runs(runs: int, found: int) -> None:
    campaign = reversing(SPEEDS_M_S[:runs])
    assert len(ripples_in(campaign, waves(campaign, [1.0] * runs))) == found


def exact_waves(campaign: Campaign, amplitudes: Sequence[float], seed: int) -> list[Array]:
    """Waves in noise of mean square one without a component at their pitch."""
    signals, noise = [], waves(campaign, [0.0] * len(amplitudes), seed=seed)
    for i, (e, path) in enumerate(zip(noise, paths(campaign), strict=True)):
        angle = 2.0 * np.pi * path / PITCH_M
        design = np.stack([np.cos(angle), np.sin(angle), np.ones(len(path))], axis=1)
        rest = e - design @ np.linalg.lstsq(design, e, rcond=None)[0]
        wave = amplitudes[i] * np.cos(angle + 2.4 * i)
        signals.append(rest / np.sqrt(np.mean(rest**2)) + wave)
    return signals


@pytest.mark.parametrize(("part", "found"), [(0.75, 0), (1.6, 1)])
def test_significance_of_a_ripple_is_chi_square_over_its_runs(part: float, found: int) -> None:
    """A wave of amplitude A in noise of variance 1 adds A^2 n / 2 to the ordinate of its run."""
    campaign = one_way()
    longest, step = 0.229 * STEP_S * N, 0.137 * STEP_S
    lines = 4.0 * longest / step / 4.0
    least = stats.chi2.isf(DEFAULT.tones.chance / lines, 2 * len(SPEEDS_M_S))
    amplitude = float(np.sqrt(2.0 * part * least / (len(SPEEDS_M_S) * N)))
    signals = exact_waves(campaign, [amplitude] * 5, seed=11)
    for unit in (0.01, 10.0):
        assert len(ripples_in(campaign, [unit * x for x in signals])) == found


@pytest.mark.parametrize(("part", "found"), [(0.8, 0), (1.25, 1)])
def test_ripple_requires_significance_in_two_thirds_of_the_runs(part: float, found: int) -> None:
    """Twice the ordinates of the two weakest of three runs is chi-square with four degrees."""
    campaign = one_way(SPEEDS_M_S[:3])
    least = stats.chi2.isf(DEFAULT.ripples.weaker_chance, 4)
    # The ordinate of a wave of amplitude A in a run of mean square m is A^2 n / (2 m).
    ordinate = 0.5 * part * least
    square = 2.0 * ordinate / N / (1.0 - ordinate / N)
    weak = float(np.sqrt(square))
    assert len(ripples_in(campaign, exact_waves(campaign, [weak, weak, 3.0], seed=12))) == found


@pytest.mark.parametrize(("third_m_s", "found"), [(0.05, 0), (0.09, 1)])
def test_ripple_requires_eight_periods_in_each_of_three_runs(third_m_s: float, found: int) -> None:
    """Runs of 30 s and a pitch of 0.3 m: 10, 9 and 5 or 9 periods."""
    campaign = one_way((0.1, 0.09, third_m_s))
    assert len(ripples_in(campaign, waves(campaign, [1.0] * 3, pitch=0.3))) == found


@pytest.mark.parametrize(("steps", "found"), [(3.6, 0), (4.4, 1)])
def test_ripple_requires_a_pitch_of_four_steps_of_the_path(steps: float, found: int) -> None:
    """The step of the path is the median over all runs, that at 0.1 m/s: 2 mm."""
    campaign = one_way((0.1, 0.099, 0.101))
    seen = ripples_in(campaign, waves(campaign, [2.0] * 3, pitch=steps * 0.1 * STEP_S))
    assert [pitch_and_size(x)[0] for x in seen] == pytest.approx([steps * 0.002] * found, rel=0.01)


def test_ripple_is_estimated_without_samples_excluded_from_the_fit() -> None:
    campaign = reversing()
    counted = [np.arange(N) % 3 > 0] * 5
    signals = [
        np.where(c, x, 50.0) for c, x in zip(counted, waves(campaign, [1.0] * 5), strict=True)
    ]
    samples = campaign.samples.within(counted)
    (found,) = find_ripples(
        campaign, samples, signals, signals, DEFAULT.with_values({"tones.min_share": 1e-6})
    )
    assert pitch_and_size(found) == pytest.approx((PITCH_M, 1.0), rel=0.1)
    assert found.share == pytest.approx(1.0 / 3.0, rel=0.1)


@pytest.mark.parametrize(
    ("rig", "pitch", "noun", "per_turn"),
    [
        (Rig(drive=Drive("linear", "force", pitch_m=0.2)), PITCH_M, "force", 4.0),
        (Rig(drive=Drive("rotary", "torque")), 2.0 * np.pi / 100.0, "torque", 100.0),
    ],
)
def test_ripple_is_described_by_periods_per_turn_if_the_drive_turns(
    rig: Rig, pitch: float, noun: str, per_turn: float
) -> None:
    campaign = slides([np.where(np.arange(N) < N // 2, v, -v) for v in SPEEDS_M_S], rig=rig)
    (found,) = ripples_in(campaign, waves(campaign, [1.0] * 5, pitch=pitch))
    assert found.where.startswith(f"periodic {noun}")
    found_per_turn = numbers_in(r"([\d.]+) per revolution", found.where)
    assert found_per_turn == pytest.approx([per_turn], rel=0.01)
