"""A model against runs by hand: its errors run by run, over the speed, and effect by effect."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import LAW, along, coulomb, one_way, there_and_back
from jbf import Comparison, Model, ParameterValue, Rig, Run, compare
from jbf.comparison.comparison import compare_prepared, predicted
from jbf.comparison.over_speed import BINS, friction_over_speed, regimes
from jbf.comparison.parts import beside_friction, without
from jbf.estimation.campaign import Campaign

Array = npt.NDArray[np.float64]
MODEL = Model(Rig(), "coulomb", parameters=LAW)


@pytest.fixture(scope="module")
def off() -> Comparison:
    """Runs there and back, whose friction is 1 N larger than the model's."""
    return compare(MODEL, there_and_back(along(1.0)))


def counting(comparison: Comparison, masks: list[npt.NDArray[Any]]) -> Comparison:
    """The same with only these samples counted."""
    samples = comparison.samples.within([m.astype(bool) for m in masks])
    return replace(comparison, samples=samples)


def test_the_residual_is_the_record_less_the_model(off: Comparison) -> None:
    for r, f, p in zip(off.residuals, off.predictions, off.campaign.prepared, strict=True):
        way = np.sign(p.motion.velocity_m_s)
        assert f == pytest.approx(5.0 * way + 20.0 * p.motion.velocity_m_s, rel=1e-4)
        assert r == pytest.approx(way, abs=1e-4)
    assert off.rms_n == pytest.approx(1.0, abs=1e-4)
    assert [(r.name, r.samples) for r in off.runs] == [("there", 501), ("back", 501)]
    assert [r.rms_n for r in off.runs] == pytest.approx([1.0, 1.0], abs=1e-4)


def test_runs_count_by_their_samples() -> None:
    """501 samples off by 1 N and 101 off by 3 N: (501 + 909) / 602 in the mean square."""
    runs = [one_way("long", along(1.0)), one_way("short", along(3.0), duration_s=2.0)]
    found = compare(MODEL, runs)
    assert [r.samples for r in found.runs] == [501, 101]
    assert [r.rms_n for r in found.runs] == pytest.approx([1.0, 3.0], abs=1e-5)
    assert found.rms_n == pytest.approx(np.sqrt((501 + 909) / 602), abs=1e-5)
    told = found.to_dict()
    assert told["rms_n"] == found.rms_n
    assert told["noise_n"] == found.noise_n
    assert [r["run"] for r in told["runs"]] == ["long", "short"]
    assert [r["samples"] for r in told["runs"]] == [501, 101]
    assert [r["rms_n"] for r in told["runs"]] == [r.rms_n for r in found.runs]
    assert [f["axis"] for f in told["failures"]] == [f.axis for f in found.failures]
    assert [f["kind"] for f in told["findings"]] == [f.kind for f in found.findings]


def test_a_run_of_which_nothing_counts_has_no_error() -> None:
    campaign = Campaign.prepare(Rig(), there_and_back(along(1.0)))
    first, second = (np.ones(len(p.run), dtype=bool) for p in campaign.prepared)
    found = compare_prepared(MODEL, campaign.without([first, ~second]))
    assert [(r.rms_n, r.samples) for r in found.runs] == [(0.0, 0), (pytest.approx(1.0), 501)]
    assert found.rms_n == pytest.approx(1.0)
    # Half of the second one: the mean is of what counts.
    half = np.arange(len(second)) < 250
    found = compare_prepared(MODEL, campaign.without([first, half]))
    assert [r.samples for r in found.runs] == [0, 251]
    assert found.rms_n == pytest.approx(1.0)


# ---- over the speed ----------------------------------------------------------------------------


def test_means_over_the_speed_lie_on_the_lines_of_record_and_model(off: Comparison) -> None:
    """Both are straight in the speed, so their means lie on them, and scatter by the slope."""
    found = friction_over_speed(off)
    assert [one.way for one in found] == [1.0, -1.0]
    for one in found:
        assert len(one.speed_m_s) == BINS
        # The slowest first.
        assert np.all(np.diff(one.way * one.speed_m_s) > 0.0)
        assert one.measured_n == pytest.approx(6.0 * one.way + 20.0 * one.speed_m_s, rel=1e-4)
        assert one.modelled_n == pytest.approx(5.0 * one.way + 20.0 * one.speed_m_s, rel=1e-4)
    v = np.sort(off.campaign.prepared[0].motion.velocity_m_s)
    # 501 samples: 21 in each of the first bins.
    assert found[0].speed_m_s[0] == pytest.approx(v[:21].mean())
    assert found[0].scatter_n[0] == pytest.approx(20.0 * v[:21].std(), rel=1e-4)
    assert found[0].speed_m_s[-1] == pytest.approx(v[-20:].mean())


@pytest.mark.parametrize(("count", "bins"), [(4, 0), (5, 1), (9, 1), (10, 2), (119, 23), (125, 24)])
def test_five_samples_make_a_mean(off: Comparison, count: int, bins: int) -> None:
    few = counting(off, [np.arange(501) < count, np.arange(501) < 50])
    found = {one.way: one for one in friction_over_speed(few)}
    assert len(found[-1.0].speed_m_s) == 10
    assert (len(found[1.0].speed_m_s) if 1.0 in found else 0) == bins


def test_what_is_no_friction_is_taken_off_record_and_model() -> None:
    """A zero off by 2 N is not friction: the means are the law's own."""
    runs = there_and_back(lambda t, v, a: coulomb(t, v, a) + 2.0)
    model = Model(Rig(), "coulomb", ["sensor_offset"], {**LAW, "sensor_offset.b_n": 2.0})
    for one in friction_over_speed(compare(model, runs)):
        line = 5.0 * one.way + 20.0 * one.speed_m_s
        assert one.measured_n == pytest.approx(line, rel=1e-4)
        assert one.modelled_n == pytest.approx(line, rel=1e-4)


def test_regimes_begin_at_a_fifth_of_the_transition_and_at_it() -> None:
    model = Model(Rig.thesis(), parameters={"U_tr_m_s": 0.05})
    assert regimes(model) == [(pytest.approx(0.01), "mixed"), (0.05, "full film")]
    assert regimes(MODEL) == []


# ---- parts of a model --------------------------------------------------------------------------


def test_a_model_without_effects_keeps_all_else() -> None:
    values = {"sensor_offset.b_n": 0.5, "sensor_drift.d_n_s": 0.01}
    held = {"F_c_n": ParameterValue(4.0, 0.25), "F_v_n_s_m": ParameterValue(9.0, None, held=True)}
    model = Model(Rig(), "coulomb", ["sensor_offset", "sensor_drift"], {**held, **values})
    left = without(model, ["sensor_offset"])
    assert tuple(left.effects) == ("sensor_drift",)
    assert left.law == "coulomb"
    own = {n: p for n, p in model.parameters.items() if n != "sensor_offset.b_n"}
    assert dict(left.parameters) == own
    assert tuple(without(model, model.effects).effects) == ()


def test_effects_that_are_no_friction_are_known() -> None:
    effects = ["sensor_offset", "inertia_leak", "sensor_lag", "sensor_drift"]
    off = compare(Model(Rig(), "coulomb", effects), there_and_back(coulomb))
    assert set(beside_friction(off)) == {"sensor_offset", "inertia_leak", "sensor_drift"}


def test_a_delayed_model_lags_the_one_without_a_delay() -> None:
    """On a ramp of the speed a delay of 0.1 s is the viscous force of the speed 0.1 s before."""
    t = np.arange(0.0, 4.0, 0.02)
    v = 0.05 + 0.02 * t
    run = Run.from_arrays(t, v, coulomb(t, v, v), name="ramp")
    campaign = Campaign.prepare(Rig(), [run])
    delayed = Model(Rig(), "coulomb", ["time_delay"], {**LAW, "time_delay.tau_s": 0.1})
    (now,), (late,) = predicted(MODEL, campaign), predicted(delayed, campaign)
    inner = slice(10, -10)
    assert (now - late)[inner] == pytest.approx(20.0 * 0.02 * 0.1, rel=0.02)


def test_what_stands_still_moves_neither_way(off: Comparison) -> None:
    """Ten samples there without a speed: the slowest mean is of those that move."""
    p, other = off.campaign.prepared
    still = np.arange(501) < 10
    v = np.where(still, 0.0, p.motion.velocity_m_s)
    moved = replace(p, motion=replace(p.motion, velocity_m_s=v))
    found = friction_over_speed(
        replace(off, campaign=replace(off.campaign, prepared=(moved, other)))
    )
    # 491 samples in 24 bins.
    assert found[0].speed_m_s[0] == pytest.approx(np.sort(v[~still])[:21].mean())
    assert np.all(found[1].speed_m_s < 0.0)
