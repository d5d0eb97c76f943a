"""Comparison of a model with runs: residuals, RMS errors and friction over speed in closed form."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import LAW, along, coulomb, one_way, there_and_back
from jbf import Comparison, Model, Rig, Run, compare
from jbf.comparison.comparison import compare_prepared, predicted
from jbf.comparison.over_speed import BINS, friction_over_speed, regimes
from jbf.estimation.campaign import Campaign

MODEL = Model(Rig(), "coulomb", parameters=LAW)


@pytest.fixture(scope="module")
def off_by_1_n() -> Comparison:
    """Two runs whose friction is 1 N larger than that of the model, without noise."""
    return compare(MODEL, there_and_back(along(1.0)))


def test_residual_is_record_minus_model(off_by_1_n: Comparison) -> None:
    found = off_by_1_n
    runs = found.campaign.prepared
    for residual, prediction, p in zip(found.residuals, found.predictions, runs, strict=True):
        v = p.motion.velocity
        assert prediction == pytest.approx(5.0 * np.sign(v) + 20.0 * v, rel=1e-4)
        assert residual == pytest.approx(np.sign(v), abs=1e-4)
    assert found.rms == pytest.approx(1.0, abs=1e-4)


def test_rms_of_all_runs_weighs_each_run_by_its_samples() -> None:
    """501 samples off by 1 N and 101 samples off by 3 N: mean square (501 + 909) / 602."""
    runs = [one_way("long", along(1.0)), one_way("short", along(3.0), duration_s=2.0)]
    found = compare(MODEL, runs)
    assert [(r.name, r.samples) for r in found.runs] == [("long", 501), ("short", 101)]
    assert [r.rms for r in found.runs] == pytest.approx([1.0, 3.0], abs=1e-5)
    assert found.rms == pytest.approx(np.sqrt((501 + 909) / 602), abs=1e-5)


def test_comparison_json_has_errors_noise_runs_and_failures(off_by_1_n: Comparison) -> None:
    found = off_by_1_n
    content = found.to_dict()
    assert (content["rms"], content["noise_rms"]) == (found.rms, None)
    # The noise floor of a force without noise is unknown.
    assert found.noise_rms == 0.0
    runs = [{"run": r.name, "rms": r.rms, "samples": r.samples} for r in found.runs]
    assert content["runs"] == runs
    assert [f["axis"] for f in content["failures"]] == [f.axis for f in found.failures]


def test_noise_floor_of_white_noise_is_its_standard_deviation() -> None:
    found = compare(MODEL, there_and_back(coulomb, noise_rms=0.2))
    assert found.noise_rms == pytest.approx(0.2, rel=0.1)
    assert found.rms == pytest.approx(0.2, rel=0.1)
    assert found.failures == ()


def test_excess_friction_is_reported_along_the_direction(off_by_1_n: Comparison) -> None:
    failure = next(f for f in off_by_1_n.failures if f.axis == "direction")
    assert failure.means_n == pytest.approx([-1.0, 1.0], abs=1e-4)
    assert "above the model by 1 N" in failure.where


def test_run_without_counted_samples_has_an_rms_of_zero() -> None:
    campaign = Campaign.prepare(Rig(), there_and_back(along(1.0)))
    first, second = (np.ones(len(p.run), dtype=bool) for p in campaign.prepared)
    found = compare_prepared(MODEL, campaign.without([first, ~second]))
    assert [(r.rms, r.samples) for r in found.runs] == [(0.0, 0), (pytest.approx(1.0), 501)]
    assert found.rms == pytest.approx(1.0)
    half = np.arange(len(second)) < 250
    found = compare_prepared(MODEL, campaign.without([first, half]))
    assert [r.samples for r in found.runs] == [0, 251]
    assert found.rms == pytest.approx(1.0)


def test_model_with_a_delay_excludes_samples_next_to_jumps_of_the_force() -> None:
    """The instant of a reversal is uncertain because the model shifts it."""
    t = np.arange(0.0, 20.0, 0.02)
    v = 0.1 * np.sin(t)
    runs = [Run.from_arrays(t, v, coulomb(t, v, v))]
    plain = compare(MODEL, runs)
    delayed = Model(Rig(), "coulomb", ["time_delay"], {**LAW, "time_delay.tau_s": 0.05})
    assert plain.samples.count == plain.campaign.samples.count
    assert compare(delayed, runs).samples.count < plain.samples.count


def test_prediction_with_a_time_delay_lags_by_the_delay() -> None:
    """On a ramp of the speed the viscous force lags by slope times delay times viscosity."""
    t = np.arange(0.0, 4.0, 0.02)
    v = 0.05 + 0.02 * t
    campaign = Campaign.prepare(Rig(), [Run.from_arrays(t, v, coulomb(t, v, v))])
    delayed = Model(Rig(), "coulomb", ["time_delay"], {**LAW, "time_delay.tau_s": 0.1})
    (without_delay,), (with_delay,) = predicted(MODEL, campaign), predicted(delayed, campaign)
    difference = without_delay - with_delay
    assert difference[10:-10] == pytest.approx(20.0 * 0.02 * 0.1, rel=0.02)


def test_means_over_speed_lie_on_lines_of_record_and_model(off_by_1_n: Comparison) -> None:
    """Friction is linear in the speed: the means lie on the line."""
    found = friction_over_speed(off_by_1_n)
    assert [one.way for one in found] == [1.0, -1.0]
    for one in found:
        assert len(one.speed_m_s) == BINS
        assert np.all(np.diff(one.way * one.speed_m_s) > 0.0)
        assert one.measured_n == pytest.approx(6.0 * one.way + 20.0 * one.speed_m_s, rel=1e-4)
        assert one.modelled_n == pytest.approx(5.0 * one.way + 20.0 * one.speed_m_s, rel=1e-4)
    # 501 samples in 24 bins: 21 in each of the first and 20 in each of the last.
    v = np.sort(off_by_1_n.campaign.prepared[0].motion.velocity)
    assert found[0].speed_m_s[0] == pytest.approx(v[:21].mean())
    assert found[0].scatter_n[0] == pytest.approx(20.0 * v[:21].std(), rel=1e-4)
    assert found[0].speed_m_s[-1] == pytest.approx(v[-20:].mean())


@pytest.mark.parametrize(("count", "bins"), [(4, 0), (5, 1), (9, 1), (10, 2), (119, 23), (125, 24)])
def test_speed_bin_with_fewer_than_5_samples_is_omitted(
    off_by_1_n: Comparison, count: int, bins: int
) -> None:
    masks: list[npt.NDArray[np.bool_]] = [np.arange(501) < count, np.arange(501) < 50]
    few = replace(off_by_1_n, samples=off_by_1_n.samples.within(masks))
    found = {one.way: len(one.speed_m_s) for one in friction_over_speed(few)}
    assert found.get(1.0, 0) == bins
    assert found[-1.0] == 10


def test_sensor_offset_is_removed_from_friction_over_speed() -> None:
    runs = there_and_back(lambda t, v, a: coulomb(t, v, a) + 2.0)
    model = Model(Rig(), "coulomb", ["sensor_offset"], {**LAW, "sensor_offset.b": 2.0})
    for one in friction_over_speed(compare(model, runs)):
        line = 5.0 * one.way + 20.0 * one.speed_m_s
        assert one.measured_n == pytest.approx(line, rel=1e-4)
        assert one.modelled_n == pytest.approx(line, rel=1e-4)


def test_regimes_begin_at_0_2_and_1_0_times_the_transition_speed() -> None:
    model = Model(Rig.thesis(), parameters={"U_tr_m_s": 0.05})
    assert regimes(model) == [(pytest.approx(0.01), "mixed"), (0.05, "full film")]
    assert regimes(MODEL) == []
