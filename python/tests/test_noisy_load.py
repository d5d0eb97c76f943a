"""A load column that is only noise is a load that does not change; one that changes is not."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Model, Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.models.catalogue import find_effect
from jbf.records.findings.noisy_load import steady_load

Array = npt.NDArray[np.float64]
TIME = 0.02 * np.arange(2000)
LOAD_N = 104.0


def noise(share: float, seed: int = 0) -> Array:
    return share * LOAD_N * np.random.default_rng(seed).standard_normal(len(TIME))


def campaign(*loads: Array) -> Campaign:
    v = 0.1 * np.sin(0.5 * TIME)
    force = 20.0 * np.tanh(v / 0.002) + 0.3 * np.random.default_rng(9).standard_normal(len(TIME))
    runs = [Run.from_arrays(TIME, v, force, load_n=n, name=str(i)) for i, n in enumerate(loads)]
    return Campaign.prepare(Rig.thesis(), runs)


def lacks_loads(c: Campaign) -> bool:
    return c.lacking(find_effect("load_dependence")) is not None


@pytest.mark.parametrize("share", [0.005, 0.02, 0.05])
@pytest.mark.parametrize("seed", range(4))
def test_noise_about_one_load_is_one_load(share: float, seed: int) -> None:
    c = campaign(LOAD_N + noise(share, seed), LOAD_N + noise(share, seed + 10))
    found = [f for f in c.findings if f.kind == "noisy_load"]
    assert [f.run for f in found] == ["0", "1"]
    assert found[0].size == pytest.approx(share * LOAD_N, rel=0.1)
    assert lacks_loads(c)


def test_a_steady_load_says_nothing() -> None:
    c = campaign(np.full(len(TIME), LOAD_N), np.full(len(TIME), LOAD_N))
    assert "noisy_load" not in {f.kind for f in c.findings}
    assert lacks_loads(c)


@pytest.mark.parametrize("share", [0.0, 0.005, 0.02, 0.05])
def test_loads_that_differ_by_run_stay(share: float) -> None:
    assert not lacks_loads(campaign(LOAD_N + noise(share, 1), 1.3 * LOAD_N + noise(share, 2)))


CHANGES = {
    "a step": 0.15 * (TIME > 25.0),
    "a ramp": 0.3 * TIME / TIME[-1],
    "a swing": 0.1 * np.sin(0.5 * TIME),
    "a fast swing": 0.1 * np.sin(15.0 * TIME),
}


@pytest.mark.parametrize("share", [0.0, 0.005, 0.02, 0.05])
@pytest.mark.parametrize("change", list(CHANGES))
def test_a_load_that_changes_within_a_run_stays(share: float, change: str) -> None:
    load = LOAD_N * (1.0 + CHANGES[change]) + noise(share, 3)
    c = campaign(load)
    assert not any(f.kind == "noisy_load" for f in c.findings)
    assert not lacks_loads(c)
    np.testing.assert_array_equal(steady_load(load), load)


def test_a_prediction_takes_the_mean() -> None:
    v = 0.1 * np.sin(0.5 * TIME)
    load = LOAD_N + noise(0.02)
    model = Model(Rig.thesis())
    noisy = model.predict(Run.from_arrays(TIME, v, load_n=load))
    steady = model.predict(Run.from_arrays(TIME, v, load_n=np.full(len(TIME), np.mean(load))))
    np.testing.assert_array_equal(noisy, steady)


def test_a_steady_load_stays_steady_at_other_instants() -> None:
    """Lines through white noise are not white: whoever resamples a run has the mean already."""
    (prepared,) = campaign(LOAD_N + noise(0.03)).prepared
    assert prepared.run.load_n is not None
    assert np.ptp(prepared.run.load_n) == 0.0
    for other in (prepared.shifted(7e-3, 0.0).run, prepared.run.at(TIME[:-1] + 0.003, TIME[:-1])):
        assert other.load_n is not None
        assert np.ptp(other.load_n) < 1e-9 * LOAD_N
    (changing,) = campaign(LOAD_N * (1.0 + 0.2 * np.sin(0.3 * TIME)) + noise(0.01)).prepared
    assert changing.run.load_n is not None
    assert np.ptp(changing.run.load_n) > 0.3 * LOAD_N
