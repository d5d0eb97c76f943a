"""Fits side by side: the answers of one after the other, in order, and an end that is heard."""

from __future__ import annotations

import threading
import time

import jbf
import numpy as np
import pytest
from jbf.diagnosis import side_by_side as module
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.side_by_side import fits_at_once, side_by_side
from jbf.estimation.campaign import Campaign
from rigruns import simulated


@pytest.mark.parametrize("at_once", [1, 2, 4])
def test_answers_come_in_order(at_once: int) -> None:
    def work(k: int) -> int:
        time.sleep(0.002 * (5 - k))
        return k * k

    assert list(side_by_side(work, range(5), at_once)) == [0, 1, 4, 9, 16]


def test_two_at_once_meet() -> None:
    # Each waits for the other: one after the other they would wait in vain.
    both = threading.Barrier(2, timeout=20.0)
    assert len(list(side_by_side(lambda _: both.wait(), range(2), 2))) == 2


@pytest.mark.parametrize("at_once", [1, 3])
def test_the_first_exception_ends_it(at_once: int) -> None:
    begun: list[int] = []

    def work(k: int) -> int:
        begun.append(k)
        if k == 1:
            raise KeyboardInterrupt
        time.sleep(0.01)
        return k

    with pytest.raises(KeyboardInterrupt):
        list(side_by_side(work, range(200), at_once))
    assert len(begun) < 200


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    rig, runs, _ = simulated(4711, ("coulomb_drag",), strength=1.0, campaign="short")
    return Campaign.prepare(rig, runs[:3])


def test_many_samples_and_own_functions_go_one_by_one(
    campaign: Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("RAYON_NUM_THREADS", raising=False)
    monkeypatch.setattr("os.cpu_count", lambda: 64)
    assert fits_at_once(campaign, "journal", ["coulomb_drag"]) == module.FEW
    monkeypatch.setenv("RAYON_NUM_THREADS", "2")
    assert fits_at_once(campaign, "journal", ["coulomb_drag"]) == 2
    jbf.register_effect(
        lambda velocity_m_s, c_n: c_n * np.sign(velocity_m_s),
        parameters=[jbf.Parameter("c_n", "N", lower=-9.0, upper=9.0, null=0.0, starts=(0.5,))],
        name="own_drag",
    )
    try:
        assert fits_at_once(campaign, "journal", ["own_drag"]) == 1
    finally:
        jbf.forget_effect("own_drag")
    monkeypatch.setattr(module, "MOST_SEARCHED", campaign.samples.count - 1)
    assert fits_at_once(campaign, "journal", ["coulomb_drag"]) == 1


def test_the_bits_of_one_after_the_other(
    campaign: Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ["coulomb_drag", "sensor_lag", "thermal_thinning", "presliding", "inertia_leak"]
    found = []
    for threads in ("1", "4"):
        monkeypatch.setenv("RAYON_NUM_THREADS", threads)
        monkeypatch.setattr("os.cpu_count", lambda: 4)
        candidates = Candidates(campaign, "journal", "journal")
        base = candidates.converge(())
        candidates.score_all([(name,) for name in names], base)
        candidates.rank_all([(name,) for name in names], base)
        scores = [candidates.score_test((name,), base) for name in names]
        found.append((scores, [candidates.rank((name,)).values.tolist() for name in names]))
    assert found[0] == found[1]
