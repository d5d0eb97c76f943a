"""A campaign, that is a rig and its prepared runs: quantities for effects, time columns,
quantisation."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from by_hand import Array, coulomb
from jbf import InputError, Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.quantisation import bias_rms, noise_before_converter
from jbf.models.catalogue import find_effect
from jbf.records.findings.finding import Finding
from known_motions import integrated, reversing_force

N = 800
TIME = 0.02 * np.arange(N)
SPEED = 0.1 * np.sin(TIME)
PATH = 0.1 * (1.0 - np.cos(TIME))


def run(name: str = "a", force: Array | None = None, **columns: Any) -> Run:
    friction = coulomb(TIME, SPEED, SPEED) if force is None else force
    return Run.from_arrays(TIME, SPEED, friction, name=name, **columns)


def other(name: str = "b", **columns: Any) -> Run:
    return run(name, 6.0 * np.sign(SPEED), **columns)


def prepared(*runs: Run) -> Campaign:
    return Campaign.prepare(Rig(), list(runs))


def test_campaign_is_rejected_if_it_has_no_run_or_every_force_is_zero() -> None:
    with pytest.raises(InputError, match="no run"):
        prepared()
    last = replace(run("b", np.zeros(N)), path=Path("last.csv"), velocity=2.0 * SPEED)
    with pytest.raises(InputError) as refused:
        prepared(run("a", np.zeros(N)), last)
    assert (refused.value.file, refused.value.column) == ("a", "friction_n")
    assert len(prepared(run(), run("b", np.zeros(N))).prepared) == 2


def test_run_that_is_given_twice_is_used_once_and_reported() -> None:
    campaign = prepared(run("a"), other(), run("c"))
    assert [p.run.name for p in campaign.prepared] == ["a", "b"]
    assert [f.kind for f in campaign.findings].count("repeated_run") == 1


def test_part_of_a_campaign_contains_the_selected_runs_or_excludes_the_masked_samples() -> None:
    campaign = prepared(run("a"), other("b"), run("c", 7.0 * SPEED))
    some = campaign.only([2, 0])
    assert [p.run.name for p in some.prepared] == ["c", "a"]
    assert some.samples.runs == ("c", "a")
    assert some.most_noise_n == campaign.most_noise_n
    fewer = campaign.without([np.arange(N) < 100] * 3)
    for before, after in zip(campaign.samples.counted, fewer.samples.counted, strict=True):
        assert not after[:100].any()
        np.testing.assert_array_equal(after[100:], before[100:])


def test_findings_added_to_a_campaign_follow_those_of_its_runs() -> None:
    campaign = prepared(run())
    found = Finding("other", "friction_n", "a", 1.0, "1", "none", "text")
    more = campaign.with_findings([found]).with_findings([found])
    assert more.findings == (*campaign.findings, found, found)


@pytest.mark.parametrize(("share", "differ"), [(0.049, False), (0.055, True)])
def test_campaign_has_loads_if_runs_differ_by_five_percent(share: float, differ: bool) -> None:
    first, second = run(load_n=np.full(N, 100.0)), other(load_n=np.full(N, 100.0 - 100.0 * share))
    assert prepared(first, second).has_loads == differ


@pytest.mark.parametrize(
    ("noise_rms", "swing_n", "differ"),
    # 90 % of a sine's samples lie within 0.988 of its amplitude.
    [(4.0, 0.0, False), (1.5, 1.8, False), (0.0, 2.4, False), (0.0, 2.7, True), (1.0, 5.0, True)],
)
def test_campaign_has_loads_if_the_load_of_a_run_varies_beyond_its_noise(
    noise_rms: float, swing_n: float, differ: bool
) -> None:
    noise = noise_rms * np.random.default_rng(1).standard_normal(N)
    load = 100.0 + swing_n * np.sin(np.pi * TIME / 8.0) + noise
    assert prepared(run(load_n=load)).has_loads == differ


def test_temperature_range_covers_all_runs_and_is_missing_if_one_has_no_temperature() -> None:
    cold, warm = np.linspace(20.0, 22.0, N), np.linspace(25.0, 23.0, N)
    campaign = prepared(run("a", temperature_c=cold), other(temperature_c=warm))
    assert campaign.temperature_range_c == pytest.approx((20.0, 25.0), abs=0.1)
    some = prepared(run("a", temperature_c=cold), other())
    assert some.temperature_range_c is None


def missing_requirement(effect: str, *runs: Run) -> str | None:
    return prepared(*runs).missing_requirement(find_effect(effect))


def test_effect_is_excluded_if_loads_do_not_differ_or_a_run_has_no_position() -> None:
    loaded = [make(load_n=np.full(N, load)) for make, load in ((run, 80.0), (other, 120.0))]
    assert missing_requirement("zero_load_dependence", *loaded) is None
    assert "same load" in str(missing_requirement("zero_load_dependence", loaded[0]))
    assert (
        missing_requirement("stroke_dependence", run(position_m=PATH), other(position_m=PATH))
        is None
    )
    assert "position" in str(
        missing_requirement("stroke_dependence", run(position_m=PATH), other())
    )
    assert "angle" in str(missing_requirement("position_ripple", run()))
    assert missing_requirement("sensor_offset", run()) is None


@pytest.mark.parametrize(("span_k", "enough"), [(1.9, False), (2.1, True)])
def test_temperature_effect_requires_a_range_of_two_kelvin(span_k: float, enough: bool) -> None:
    effect = next(e for e in jbf.effects().values() if "temperatures" in e.needs)
    campaign = prepared(run(temperature_c=np.linspace(20.0, 20.0 + span_k, N)))
    assert (campaign.missing_requirement(effect) is None) == enough
    assert "temperature_c" in str(prepared(run()).missing_requirement(effect))


def test_quantisation_rms_is_computed_from_step_and_noise_of_the_readings() -> None:
    noise, step = 0.1 * np.random.default_rng(5).standard_normal(N), 0.2
    campaign = prepared(run(force=step * np.round((5.0 * np.sign(SPEED) + noise) / step)))
    assert campaign.step_n == pytest.approx(step, rel=1e-6)
    (p,), (counted,) = campaign.prepared, campaign.samples.counted
    raw = replace(campaign, prepared=(replace(p, friction=p.readings_n),))
    noise_rms = noise_before_converter(step, np.diff(p.readings_n)[counted[1:] & counted[:-1]])
    assert raw.steps_rms(2.0) == pytest.approx(bias_rms(step, noise_rms), rel=1e-6)
    # The residual is not smaller than the noise.
    assert raw.steps_rms(0.5 * noise_rms) == pytest.approx(bias_rms(step, 0.5 * noise_rms))
    # After a bias correction three tenths of the correction are assumed to remain.
    corrected = replace(campaign, prepared=(replace(p, friction=p.readings_n - 0.25 * step),))
    assert corrected.steps_rms(2.0) == pytest.approx(0.3 * 0.25 * step)
    plain = prepared(run(force=5.0 * np.sign(SPEED) + noise))
    assert (plain.step_n, plain.steps_rms(1.0)) == (0.0, 0.0)


STEP_S = 3.0 / 128.0
INSTANTS = 5.0 + STEP_S * np.arange(400)


def speed(time: Array) -> Array:
    return 0.1 * np.sin(1.7 * time) + 0.02 * np.cos(4.1 * time)


@pytest.fixture(scope="module")
def ready() -> Prepared:
    v = speed(INSTANTS)
    return Prepared.of(Rig(), Run.from_arrays(INSTANTS, v, coulomb(v, v, v), name="slide"))


def test_run_without_motion_or_force_is_rejected() -> None:
    still = Run.from_arrays(INSTANTS, np.zeros(400), np.ones(400), name="still")
    with pytest.raises(InputError, match="never moves") as refused:
        Prepared.of(Rig(), still)
    assert refused.value.file == "still"
    with pytest.raises(InputError, match="friction_n"):
        Prepared.of(Rig(), Run.from_arrays(INSTANTS, speed(INSTANTS), name="no force"))


def test_prepared_run_uses_the_largest_step_and_rate_of_its_findings(ready: Prepared) -> None:
    """Findings of another kind and interpolation reported as a duration are ignored."""
    assert (ready.converter_step_n, ready.drawn_at_hz) == (0.0, 0.0)
    found = [("steps", 0.25, "N"), ("steps", 0.5, "N"), ("late", 70.0, "Hz")]
    found += [("interpolated", *size) for size in ((50.0, "Hz"), (20.0, "Hz"), (9e2, "s"))]
    some = ready.finding([Finding(k, "friction_n", "a", x, u, "none", k) for k, x, u in found])
    assert (some.converter_step_n, some.drawn_at_hz) == (0.5, 50.0)


def test_force_with_a_separate_time_column_is_compared_at_its_reading_instants() -> None:
    """Readings outside the recorded motion are dropped; those at its ends are used."""
    instants, force = INSTANTS[10:301], INSTANTS[::5]
    channels = {
        "velocity_m_s": (instants, speed(instants)),
        "position_m": (instants, integrated(speed(instants), STEP_S)),
        "friction_n": (force, 5.0 * np.sign(speed(force))),
    }
    found = Prepared.of(Rig(), Run.from_channels(channels, name="slide"))
    np.testing.assert_array_equal(found.run.time_s, INSTANTS[10:301:5])
    assert found.step_s == pytest.approx(5.0 * STEP_S)
    np.testing.assert_allclose(found.motion.velocity, speed(found.run.time_s), atol=2e-3)
    np.testing.assert_array_equal(found.recorded[0], instants)


def interpolated(rate_hz: float, seed: int, length: int = 3000) -> Run:
    """A force sampled at this rate and interpolated to 50 Hz."""
    t = 0.02 * np.arange(length)
    ticks = np.arange(-0.3 / rate_hz, t[-1] + 2.0 / rate_hz, 1.0 / rate_hz)
    force = np.interp(t, ticks, reversing_force(ticks, seed))
    return Run.from_arrays(t, 0.1 * np.sin(0.3 * t), force, name=f"{seed}")


def test_interpolated_force_is_compared_at_the_rate_of_its_original_readings() -> None:
    found = Prepared.of(Rig(), interpolated(20.0, 1))
    assert found.drawn_at_hz == pytest.approx(20.0, rel=1e-3)
    assert found.step_s == pytest.approx(0.05, rel=1e-3)
    assert len(found.run) == len(found.motion.velocity) == pytest.approx(1200, abs=3)
    v = 0.1 * np.sin(0.3 * found.run.time_s)
    np.testing.assert_allclose(found.motion.velocity, v, atol=1e-4)
    assert len(found.recorded[0]) == 3000


def test_short_run_takes_the_interpolation_rate_of_the_other_runs() -> None:
    short = interpolated(43.3, 3, length=300)
    assert Prepared.of(Rig(), short).drawn_at_hz == 0.0
    campaign = Campaign.prepare(Rig(), [interpolated(43.3, 1), short])
    assert [p.drawn_at_hz for p in campaign.prepared] == pytest.approx([43.3] * 2, rel=1e-3)


@pytest.mark.parametrize(
    ("steps", "drift", "first", "last"),
    # Readings at the ends of the motion can be compared; the drift is zero at mid-run.
    [(2.0, 0.0, 2, 400), (-3.0, 0.0, 0, 397), (2.5, 0.0, 3, 400), (0.0, -(2.0**-7), 2, 398)],
)
def test_shift_compares_the_force_with_the_motion_at_the_shifted_instants(
    ready: Prepared, steps: float, drift: float, first: int, last: int
) -> None:
    found = ready.shifted(steps * STEP_S, drift)
    read = INSTANTS - steps * STEP_S - drift * (INSTANTS - 0.5 * (INSTANTS[0] + INSTANTS[-1]))
    np.testing.assert_allclose(found.run.time_s, read[first:last], atol=1e-12)
    np.testing.assert_array_equal(found.friction, ready.friction[first:last])
    np.testing.assert_array_equal(found.examined.usable, ready.examined.usable[first:last])
    speeds = found.motion.velocity[5:-5]
    np.testing.assert_allclose(speeds, speed(read[first:last])[5:-5], atol=1e-4)


@pytest.mark.parametrize(("times", "finer"), [(1.45, False), (1.6, True)])
def test_core_uses_the_recorded_motion_before_the_force_and_finer_motion_within_it(
    ready: Prepared, times: float, finer: bool
) -> None:
    """The motion within the force record is used if sampled 1.5 times as often as the force."""
    instants = INSTANTS[0] - 0.25 + STEP_S / times * np.arange(int(460 * times))
    fine = Run.from_arrays(instants, speed(instants), np.ones(len(instants)))
    core = replace(ready, recorded=(instants, Prepared.of(Rig(), fine).motion)).core
    assert core.kept is not None
    end_s = INSTANTS[-1] if finer else INSTANTS[0]
    expected = np.union1d(instants[instants < end_s], INSTANTS)
    np.testing.assert_array_equal(expected[core.kept], INSTANTS)


@pytest.mark.parametrize("times", [1.45, 1.6])
def test_prediction_at_a_reading_depends_on_the_motion_at_this_reading(
    ready: Prepared, times: float
) -> None:
    """Also if the motion was recorded at other instants than the force."""
    instants = INSTANTS[0] - 0.25 + STEP_S / times * np.arange(int(460 * times))
    fine = Run.from_arrays(instants, speed(instants), np.ones(len(instants)))
    before = replace(ready, recorded=(instants, Prepared.of(Rig(), fine).motion))
    faster = replace(before.motion, velocity=1.01 * before.motion.velocity)
    problem = Problem(Campaign.prepare(Rig(), [ready.run]), "coulomb", "journal", ())
    values = problem.starts({"F_c": 1e-6, "F_s": 1e-6, "F_v": 20.0})[0]
    cores = [before.core, replace(before, motion=faster).core]
    forces = problem.chain.predict(values, cores)
    moving = before.motion.slides
    np.testing.assert_allclose(forces[1][moving], 1.01 * forces[0][moving], atol=1e-7)
