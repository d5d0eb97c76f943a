"""Friction and forces that depend on the position along the stroke, and their pitches."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf import Rig, Run, diagnose, fit
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.campaign import Campaign
from jbf.estimation.pitches import known_pitches, longest_pitch, pitches
from jbf.estimation.problem import Problem
from jbf.estimation.settings import DEFAULT as SETTINGS
from jbf.estimation.starting_values import BEYOND, SHORTEST_M, stroke
from jbf.records.drive import Drive

STEP_S, NOISE_N = 0.01, 0.2
EXTENDED = pytest.mark.extended
Waves = Sequence[tuple[float, float]]
"""Pitch (m) and amplitude (N) of each wave along the path."""


def waves_of(x: Array, waves: Waves) -> Array:
    total = np.zeros(len(x))
    for pitch, amplitude_n in waves:
        total += amplitude_n * np.sin(2.0 * np.pi * x / pitch - 0.7)
    return total


def axis_runs(
    waves: Waves = (), *, along: bool = False, seed: int = 0, noise_rms: float = NOISE_N
) -> list[Run]:
    """Two runs of an axis under dry and viscous friction, a mass and a weight that turns.

    `along`: the waves act in the direction of motion.
    """
    runs = []
    for i in range(2):
        rng = np.random.default_rng([seed, i])
        t = np.arange(0.0, 20.0, STEP_S)
        v = 0.06 * np.sin(0.9 * t + i) + 0.03 * np.sin(2.3 * t + 2.0 * i)
        a = 0.054 * np.cos(0.9 * t + i) + 0.069 * np.cos(2.3 * t + 2.0 * i)
        x = -0.06 / 0.9 * np.cos(0.9 * t + i) - 0.03 / 2.3 * np.cos(2.3 * t + 2.0 * i)
        force = (5.0 + i) * np.sign(v) + 30.0 * v + 3.0 * a + 20.0 * np.sin(x - 1.0)
        force = force + waves_of(x, waves) * (np.sign(v) if along else 1.0)
        force = force + noise_rms * rng.standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, force, position_m=x, name=f"{i}"))
    return runs


def shuttle(waves: Waves, *, path_m: float = 0.2, periods: int = 10) -> Campaign:
    """A run back and forth at 0.05 m/s, 0.5 mm for each sample."""
    count = round(path_m / 0.05 / STEP_S)
    direction = np.tile(np.repeat([1.0, -1.0], count), periods)
    t = STEP_S * np.arange(len(direction))
    x = np.concatenate(([0.0], np.cumsum(0.05 * STEP_S * direction[:-1])))
    noise = 0.01 * np.random.default_rng(1).standard_normal(len(t))
    force = 5.0 * direction + waves_of(x, waves) + noise
    return Campaign.prepare(
        Rig(), [Run.from_arrays(t, 0.05 * direction, force, position_m=x, name="s")]
    )


@pytest.mark.parametrize(
    ("pitch", "along"),
    [
        (0.0041, False),
        (0.0123, True),
        *(pytest.param(p, a, marks=EXTENDED) for p, a in ((0.0041, True), (0.0123, False))),
        *(pytest.param(0.031, a, marks=EXTENDED) for a in (True, False)),
    ],
)
def test_pitch_of_maximum_likelihood_is_that_of_the_simulated_wave(
    pitch: float, along: bool
) -> None:
    """A fit converges from within half a period over the path; the test requires a quarter."""
    campaign = Campaign.prepare(Rig(), axis_runs([(pitch, 0.3)], along=along))
    found = pitches(campaign, along=along)
    path_m = np.ptp(np.concatenate([p.motion.angle_rad for p in campaign.prepared]))
    assert abs(path_m / found[0] - path_m / pitch) < 0.25


def test_pitches_of_waves_are_listed_in_the_order_of_their_amplitudes() -> None:
    some = [(0.0123, 0.4), (0.0079, 0.2), (0.0043, 0.04)]
    campaign = Campaign.prepare(Rig(), axis_runs(some, noise_rms=0.05))
    found = pitches(campaign, along=False)
    assert found == pytest.approx([p for p, _ in some], rel=0.01)


@pytest.mark.parametrize(("periods", "found"), [(1.7, False), (2.3, True)])
def test_pitch_is_estimated_only_if_the_path_contains_two_periods(
    periods: float, found: bool
) -> None:
    lines = [0.2 / p for p in pitches(shuttle([(0.2 / periods, 1.0)]), along=False)]
    assert (abs(lines[0] - periods) < 0.25) == found


@pytest.mark.parametrize(("samples", "found"), [(3.8, False), (4.3, True)])
def test_pitch_is_estimated_only_if_it_spans_four_path_samples(samples: float, found: bool) -> None:
    pitch = samples * 0.5e-3
    likeliest = pitches(shuttle([(pitch, 1.0)]), along=False)[0]
    assert (likeliest == pytest.approx(pitch, rel=2e-3)) == found


def test_no_pitch_is_estimated_from_a_short_record_or_a_short_path() -> None:
    t = np.arange(0.0, 0.5, STEP_S)
    v = np.full(len(t), 0.01)
    run = Run.from_arrays(t, v, np.full(len(t), 5.0), position_m=0.01 * t)
    assert pitches(Campaign.prepare(Rig(), [run]), along=False) == ()
    # A path of seven samples does not contain two periods of the shortest pitch.
    assert pitches(shuttle([(2e-3, 1.0)], path_m=3.5e-3, periods=20), along=False) == ()


@pytest.mark.parametrize("seeds", [range(3), pytest.param(range(3, 20), marks=EXTENDED)])
def test_gain_of_the_highest_spectral_line_of_noise_is_below_the_threshold(seeds: range) -> None:
    gains, samples = [], 0
    for seed in seeds:
        runs = axis_runs(seed=seed)
        samples = sum(len(r) for r in runs)
        randoms = (np.random.default_rng([seed, i]) for i in range(len(runs)))
        noise = np.concatenate([r.standard_normal(samples // len(runs)) for r in randoms])
        place = np.concatenate([np.asarray(r.position_m) for r in runs])
        for pitch in pitches(Campaign.prepare(Rig(), runs), along=False):
            phase = 2.0 * np.pi * place / pitch
            pair = np.stack([np.cos(phase), np.sin(phase)], axis=1)
            gains.append(float(np.sum((pair @ np.linalg.lstsq(pair, noise, rcond=None)[0]) ** 2)))
    threshold = Level.in_white_noise(DEFAULT, 20, samples, NOISE_N).price(3, samples)
    # Two parameters of a fixed pitch would gain 1.4 (median of chi-square).
    assert 4.0 < np.median(gains) < 0.8 * threshold
    assert max(gains) < threshold


@pytest.mark.parametrize("shaft", [False, True])
def test_longest_pitch_and_stroke_are_those_of_the_recorded_path(shaft: bool) -> None:
    """The pitch limit is half of the path, the stroke the path plus a tenth at either end."""
    rig = Rig.thesis() if shaft else Rig()
    radius_m = rig.bearing.radius_m if rig.bearing is not None else 1.0
    t = np.arange(0.0, 20.0, STEP_S)
    v = 0.05 * np.sin(t)
    noise = NOISE_N * np.random.default_rng(0).standard_normal(len(t))
    place = {"angle_rad" if shaft else "position_m": (0.3 - 0.05 * np.cos(t)) / radius_m}
    run = Run.from_arrays(t, v, 5.0 * np.sign(v) + 30.0 * v + noise, **place)
    campaign = Campaign.prepare(rig, [run])
    low, high = stroke(campaign)
    assert longest_pitch(campaign) == pytest.approx(
        0.1 / SETTINGS.conditions.min_pitch_periods, rel=0.02
    )
    assert high - low == pytest.approx((1.0 + 2.0 * BEYOND) * 0.1, rel=0.02)
    middle = float(np.mean(campaign.prepared[0].motion.angle_rad)) * radius_m
    assert 0.5 * (low + high) == pytest.approx(middle, abs=0.004)
    nothing = campaign.without([np.ones(len(t), dtype=bool)])
    assert longest_pitch(nothing) == np.inf
    assert stroke(nothing) == (-SHORTEST_M, SHORTEST_M)


@pytest.mark.parametrize(
    ("drive", "found"),
    [
        (Drive("linear", "force", pitch_m=0.02, gear_ratio=4.0), (0.02, 0.005)),
        (Drive("linear", "force", pitch_m=0.02), (0.02,)),
        (Drive("linear", "force"), ()),
        (Drive("rotary", "torque", gear_ratio=100.0), (0.02 * np.pi,)),
        (Drive("rotary", "torque"), ()),
        (None, ()),
    ],
)
def test_known_pitches_of_a_drive_are_the_travel_per_turn_of_screw_and_motor(
    drive: Any, found: tuple[float, ...]
) -> None:
    assert known_pitches(Rig(drive=drive)) == pytest.approx(found)


def test_fit_of_cogging_starts_at_the_pitches_of_the_drive() -> None:
    rig = Rig(drive=Drive("linear", "force", pitch_m=0.02, gear_ratio=4.0))
    problem = Problem(Campaign.prepare(rig, axis_runs()), "coulomb", "journal", ("cogging",))
    assert {0.02, 0.005} <= set(problem.parameters["cogging.pitch"].starts)


SLIDE_NOISE_N = 0.15
STROKE = "stroke_dependence"


def slide(dry: Callable[[Array], Array], count: int = 4) -> list[Run]:
    """Runs over 0.4 m with a dry friction that is a function of the position (m)."""
    runs = []
    for i in range(count):
        random = np.random.default_rng([4130, i])
        t = np.arange(0.0, 30.0, STEP_S)
        rate = 0.5 + 0.15 * i
        x = 0.2 + 0.16 * np.sin(rate * t) + 0.04 * np.sin(3.1 * rate * t + i)
        v = 0.16 * rate * np.cos(rate * t) + 0.124 * rate * np.cos(3.1 * rate * t + i)
        force = np.sign(v) * dry(x) + 30.0 * v + SLIDE_NOISE_N * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, force, position_m=x, name=f"{i}"))
    return runs


def test_fitted_stroke_dependence_predicts_the_friction_level_over_the_position() -> None:
    def level(x: Array) -> Array:
        return 6.0 + 1.2 * np.cos(np.pi * x / 0.4) + 0.5 * np.sin(2.0 * x / 0.4)

    model = fit(Rig(), slide(level, count=2), [STROKE], law="coulomb").model
    x = np.linspace(0.02, 0.38, 50)
    v = np.full(50, x[1] - x[0])
    run = Run.from_arrays(np.arange(50.0), v, position_m=x)
    np.testing.assert_allclose(model.predict(run), level(x) + 30.0 * v, atol=0.06)


def test_ends_of_the_stroke_are_taken_from_the_runs_and_not_fitted() -> None:
    runs = slide(lambda x: 6.0 + 2.0 * x, count=2)
    places = np.concatenate([np.asarray(r.position_m) for r in runs])
    found = fit(Rig(), runs, [STROKE], law="coulomb")
    # A tenth of the path is added at either end.
    wanted = {"x_0": 0.5 * (places.min() + places.max()), "h": 0.6 * np.ptp(places)}
    for name, value in wanted.items():
        p = found[f"{STROKE}.{name}"]
        assert (p.held, p.stderr) == (True, None)
        assert p.value == pytest.approx(value, abs=2e-3)
    assert found[f"{STROKE}.a_1"].stderr is not None
    campaign = Campaign.prepare(Rig(), runs)
    # Only the six coefficients are fitted; the ends are given.
    given = Problem(campaign, "coulomb", "journal", (STROKE,), {f"{STROKE}.x_0": 0.25})
    assert len(given.open) - len(Problem(campaign, "coulomb", "journal", ()).open) == 6
    assert given.fixed[f"{STROKE}.x_0"] == 0.25


@pytest.mark.extended
def test_tight_spot_is_diagnosed_as_stroke_dependence() -> None:
    """A bump and a slope, which are not among the basis functions of the effect."""
    runs = slide(lambda x: 6.0 + 1.5 * np.exp(-(((x - 0.3) / 0.08) ** 2)) - 2.0 * (x - 0.2))
    found = diagnose(Rig(), runs, law="coulomb")
    assert (found.verdict, found.effects) == ("missing", (STROKE,))
    assert found.steps[-1].rms == pytest.approx(SLIDE_NOISE_N, rel=0.05)
    assert found.steps[-1].held_out_rms == pytest.approx(SLIDE_NOISE_N, rel=0.05)
