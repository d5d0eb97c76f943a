"""Fits in parallel threads: order and equality of results, and cancellation."""

import threading
import time
from collections.abc import Iterator

import jbf
import numpy as np
import pytest
from by_hand import coulomb, four_runs
from jbf import Rig
from jbf.estimation.campaign import Campaign
from jbf.estimation.parallel_fits import MOST_AT_ONCE, fits_at_once, in_parallel


@pytest.mark.parametrize("at_once", [1, 2, 4])
def test_parallel_results_are_in_the_order_of_the_arguments(at_once: int) -> None:
    def work(k: int) -> int:
        time.sleep(0.002 * (5 - k))
        return k * k

    assert list(in_parallel(work, range(5), at_once)) == [0, 1, 4, 9, 16]


def test_two_tasks_run_at_the_same_time_if_two_are_allowed() -> None:
    both = threading.Barrier(2, timeout=20.0)
    assert len(list(in_parallel(lambda _: both.wait(), range(2), 2))) == 2


@pytest.mark.parametrize("at_once", [1, 3])
def test_first_exception_cancels_the_remaining_tasks(at_once: int) -> None:
    started: list[int] = []

    def work(k: int) -> int:
        started.append(k)
        if k == 1:
            raise KeyboardInterrupt
        time.sleep(0.01)
        return k

    with pytest.raises(KeyboardInterrupt):
        list(in_parallel(work, range(200), at_once))
    assert len(started) < 200


@pytest.fixture
def drag_effect() -> Iterator[None]:
    jbf.register_effect(
        lambda velocity, c_n: c_n * np.sign(velocity),
        parameters=[jbf.Parameter("c_n", "N", lower=-9.0, upper=9.0, null=0.0, starts=(0.5,))],
        name="own_drag",
    )
    yield
    jbf.forget_effect("own_drag")


@pytest.mark.usefixtures("drag_effect")
def test_number_of_parallel_fits_is_that_of_threads_and_one_for_python_effects(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Effects in Python may have a state and are therefore fitted one at a time."""
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_rms=0.1))
    for threads, expected in (("64", MOST_AT_ONCE), ("2", 2), ("1", 1)):
        monkeypatch.setenv("RAYON_NUM_THREADS", threads)
        assert fits_at_once(campaign, "coulomb", ["sensor_offset"]) == expected
    monkeypatch.setenv("RAYON_NUM_THREADS", "4")
    assert fits_at_once(campaign, "coulomb", ["own_drag"]) == 1


def test_parallel_fits_have_the_same_values_as_sequential_fits() -> None:
    runs = four_runs(coulomb, noise_rms=0.1)[:2]
    effects = ["sensor_offset", "quadratic_drag", "inertia"]

    def fitted(effect: str) -> dict[str, float]:
        return jbf.fit(Rig(), runs, [effect], law="coulomb").params

    one_by_one, parallel = (list(in_parallel(fitted, effects, n)) for n in (1, 4))
    assert one_by_one == parallel
