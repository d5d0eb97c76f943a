"""Effects that move the instants of jumps: what is doubted, and that fits find their way."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from campaigns import campaign
from jbf import InputError, Model, compare, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.jumps import active_effects, jumps, moves_jumps, samples_beside_jumps
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.models.catalogue import parameters_of


def test_only_a_jump_is_in_doubt() -> None:
    t = np.arange(0.0, 10.0, 0.02)
    smooth = 20.0 * np.cos(t)
    assert not jumps(smooth).any()
    jumped = np.where(t < 5.0, smooth + 20.0, smooth - 20.0)
    assert np.flatnonzero(jumps(jumped)).tolist() == [249, 250]
    assert jumps(jumped)[250] == pytest.approx(40.0, rel=0.02)
    assert not jumps(np.zeros(20)).any()


def test_two_jumps_at_a_gap_are_seen_and_a_resolved_rise_is_none() -> None:
    gap = np.concatenate((np.full(20, 20.0), np.zeros(2), np.full(20, -20.0)))
    assert np.flatnonzero(jumps(gap)).tolist() == [19, 20, 21, 22]
    rise = np.concatenate((np.zeros(20), np.linspace(0.0, 20.0, 6), np.full(20, 20.0)))
    assert not jumps(rise).any()


def test_only_effects_that_move_jumps_cast_doubt() -> None:
    assert moves_jumps(["sensor_lag", "time_delay"])
    assert not moves_jumps(["sensor_lag", "drive_compliance"])


@pytest.mark.parametrize("noise_n", [0.3, 3.0])
def test_a_sample_beside_a_jump_counts_by_what_is_in_doubt_there(noise_n: float) -> None:
    """Half of the change over the sample, beside the noise; and no test looks at it."""
    t = np.arange(0.0, 10.0, 0.02)
    jumped = np.where(t < 5.0, 20.0, -20.0)
    read = jumped + noise_n * np.random.default_rng(4).standard_normal(len(t))
    every = np.ones(len(t))
    samples = Samples(("a",), (0.02,), (every > 0.0,), (every,))
    prepared = cast(Prepared, SimpleNamespace(friction_n=read))
    found = samples_beside_jumps(samples, [prepared], [jumped], ["time_delay"])
    beside = np.zeros(len(t), dtype=bool)
    beside[[249, 250]] = True
    np.testing.assert_array_equal(found.counted[0], ~beside)
    np.testing.assert_array_equal(found.weight[0][~beside], 1.0)
    wanted = noise_n / np.hypot(noise_n, 20.0)
    np.testing.assert_allclose(found.weight[0][beside], wanted, rtol=0.1)


@pytest.mark.parametrize("name", ["time_delay", "backlash"])
def test_recovers_what_moves_a_jump(name: str) -> None:
    rig, runs, truth = campaign(5, (name,))
    fitted = fit(rig, runs, [name])
    assert fitted.rms_n < 1.03 * truth["noise_n"]
    (short, value), *_ = truth["effects"][name].items()
    full = next(n for n in fitted.parameters if n.startswith(f"{name}.{short}"))
    found = fitted.parameters[full]
    assert found.stderr is not None
    assert abs(found.value - value) < 3.5 * found.stderr
    assert found.stderr < 0.3 * value
    # The samples next to the moved jumps are left out, and few others.
    bare = compare(Model(rig), runs)
    assert 0.97 * bare.samples.count < fitted.samples < bare.samples.count
    after = compare(fitted.model, runs)
    assert after.rms_n < 1.03 * truth["noise_n"]
    assert bare.samples is bare.campaign.samples


def test_the_delay_of_the_start_does_not_matter() -> None:
    rig, runs, truth = campaign(6, ("time_delay",))
    tau = truth["effects"]["time_delay"]["tau"]
    for start in (0.5 * tau, 2.0 * tau, 0.004):
        fitted = fit(rig, runs, ["time_delay"], start={"time_delay.tau_s": start})
        assert fitted.parameters["time_delay.tau_s"].value == pytest.approx(tau, abs=0.003)


def test_an_effect_at_its_null_casts_no_doubt() -> None:
    rig, runs, _ = campaign(6)
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", ("time_delay",))
    values = problem.starts({})[0]
    every = problem.campaign.samples
    assert problem.samples_at(values).count < every.count
    values[problem.names.index("time_delay.tau_s")] = 0.0
    assert active_effects(["time_delay"], problem.parameters, values) == []
    assert problem.samples_at(values) is every
    # A comparison sees as many samples as that of the law alone.
    law = dict(zip(problem.names, values, strict=True))
    late = compare(Model(rig, effects=["time_delay"], parameters=law), runs)
    assert late.samples.count == compare(Model(rig), runs).samples.count


def test_an_effect_acts_where_any_of_its_parameters_is_off_its_null() -> None:
    pages = parameters_of("journal", ("load_dependence",))
    law = [page.starts[0] for name, page in pages.items() if "." not in name]
    for p, q in ((0.0, 1.5), (0.4, 0.0), (0.4, 1.5)):
        assert active_effects(["load_dependence"], pages, [*law, p, q]) == ["load_dependence"]
    assert active_effects(["load_dependence"], pages, [*law, 0.0, 0.0]) == []


def test_load_dependence_needs_several_loads() -> None:
    rig, runs, _ = campaign(7)
    with pytest.raises(InputError, match="all runs have one load"):
        fit(rig, runs, ["load_dependence"])


def test_load_dependence_is_recovered() -> None:
    loads = (("two_way_0.25", 0.7), ("stop_and_go", 0.7), ("two_way_2", 1.35))
    rig, runs, truth = campaign(8, ("load_dependence",), loads=loads)
    fitted = fit(rig, runs, ["load_dependence"])
    assert fitted.rms_n < 1.03 * truth["noise_n"]
    for short, value in truth["effects"]["load_dependence"].items():
        found = fitted.parameters[f"load_dependence.{short}"]
        assert found.stderr is not None
        assert abs(found.value - value) < 3.5 * found.stderr < value
