"""Where the search for a strength looks, step by step, and what is seen of an effect there."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import coulomb, one_way
from jbf import Rig
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.power import (
    FURTHER,
    LEVELS,
    _change,
    _Seen,
    _times,
    non_centrality,
    power,
)
from jbf.diagnosis.strength import RunsAtHand, strength_of
from jbf.estimation.campaign import Campaign

Array = npt.NDArray[np.float64]
SAMPLES = 400
PRICE = 30.0
module = sys.modules["jbf.diagnosis.power"]


class Growing:
    """Runs at which an effect is worth so much at so many times its strength; keeps what it was
    asked for."""

    def __init__(self, told: Callable[[float], float], left: float = 1.0, most: float = np.inf):
        self.told, self.left, self.most = told, left, most
        self.asked: list[float] = []
        self.forgiven: list[float] = []
        self.before = 0
        self.base = SimpleNamespace(free=3)
        self.samples = SimpleNamespace(rms=lambda change: float(np.sqrt(np.mean(change**2))))
        self.friction_n = 4.0
        self.model: Any = SimpleNamespace(
            values=lambda times: np.array([min(times, most)]),
            problem=SimpleNamespace(open=range(4)),
        )

    def change(self, model: Any, times: float) -> Array:
        self.asked.append(times)
        return np.full(SAMPLES, np.sqrt(self.told(min(times, self.most)) / SAMPLES))

    def shown(self, change: Array) -> Array:
        return change[:, None]

    def counts(self, change: Array) -> tuple[float, ...]:
        return (1.0,)

    def not_forgiven(self, change: Array) -> float:
        self.forgiven.append(float(np.sum(change**2)))
        self.before = len(self.asked)
        return self.left


def looks(told: Callable[[float], float], wanted: float, begin: float = 1.0) -> list[float]:
    runs: Any = Growing(told)
    _times(runs, runs.model, wanted, begin)
    found: list[float] = runs.asked
    return found


# ---- where it looks ----------------------------------------------------------------------------


@pytest.mark.parametrize("power", [1.0, 2.0, 8.0])
def test_from_two_looks_the_third_is_known(power: float) -> None:
    """A square is taken for granted at first; then by whatever power it grew, up to the eighth."""
    first = 2.0 * 0.5 ** (power / 2.0)
    asked = looks(lambda times: 7.0 * times**power, 7.0, 2.0)
    assert asked[:2] == pytest.approx([2.0, first])
    assert asked[-1] == pytest.approx(1.0)
    assert len(asked) == (2 if power == 2.0 else 3)


def test_it_is_taken_to_grow_in_proportion_at_least() -> None:
    """Of what grows as the root eight times as much asks for no more than eight times as strong."""
    assert looks(lambda times: times**0.5, 16.0)[:3] == pytest.approx([1.0, 4.0, 32.0])


def test_and_as_the_eighth_power_at_most() -> None:
    """A square leads to a sixteenth; of what grew as the ninth power from there to the whole, so
    much more is sought at the eighth root."""
    asked = looks(lambda times: times**9.0, 2.0**-8.0)
    assert asked[:3] == pytest.approx([1.0, 2.0**-4.0, 2.0**-4.0 * (2.0**28.0) ** 0.125])


def test_a_step_is_thirty_times_and_a_thousandth_at_most() -> None:
    assert looks(lambda times: 1e-6 * times**2, 1.0)[1] == 30.0
    assert looks(lambda times: 100.0 * times**2, 1e-6)[1] == 1e-3


@pytest.mark.parametrize(("part", "is_found"), [(0.4, False), (0.5, False), (0.6, True)])
def test_after_fourteen_looks_more_than_half_of_it_is_enough(part: float, is_found: bool) -> None:
    runs: Any = Growing(lambda times: 64.0 * part)
    found = _times(runs, runs.model, 64.0, 1.0)
    assert len(runs.asked) == 14
    assert np.isfinite(found) == is_found


# ---- what is seen there ------------------------------------------------------------------------


def seen(runs: Growing, monkeypatch: pytest.MonkeyPatch) -> tuple[_Seen, float]:
    """What is seen of an effect of one parameter; and where its change was looked at."""
    where: list[float] = []
    monkeypatch.setattr(module, "_change", lambda runs, model, times: where.append(times))
    candidates: Any = SimpleNamespace(
        level=SimpleNamespace(price=lambda parameters, samples: PRICE * parameters),
        campaign=SimpleNamespace(samples=SimpleNamespace(count=1000)),
    )
    there: Any = runs
    return _Seen.of(candidates, there, runs.model), where[0]


def strengths(worth: float, left: float = 1.0) -> list[float]:
    """Of an effect that is worth so much at its usual strength, of which so much is left."""
    return [float(np.sqrt(non_centrality(PRICE, 1, c) / left / worth)) for c in LEVELS]


@pytest.mark.parametrize(("left", "counts"), [(0.98, 1.0), (0.97, 1.0), (0.96, 0.96), (0.5, 0.5)])
def test_what_a_noise_described_anew_forgives_must_be_made_up_for(
    left: float, counts: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Up to three hundredths of it are nothing; it is asked for at 1.2 times the larger strength,
    whose square is 1.44 times what was wanted."""
    runs = Growing(lambda times: 90.0 * times**2, left)
    found, where = seen(runs, monkeypatch)
    assert found.times == pytest.approx(strengths(90.0, counts), rel=1e-6)
    assert runs.forgiven == pytest.approx([1.44 * non_centrality(PRICE, 1, 0.95)])
    assert where == found.times[0]
    if left < 0.97:
        # From what was found it is known where to look: once for each, and there for the share.
        assert runs.asked[runs.before :] == pytest.approx([*found.times, found.times[0]])
    # Of a friction of 4 N.
    assert found.share == pytest.approx(np.sqrt(90.0 / SAMPLES) * found.times[0] / 4.0)


def test_what_is_never_found_is_seen_at_its_usual_strength(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is worth less than is wanted wherever it may be; no noise is described anew for it."""
    runs = Growing(lambda times: 0.1 * times**2, 0.5, most=2.0)
    found, where = seen(runs, monkeypatch)
    assert np.isnan(found.times).all()
    assert runs.forgiven == []
    assert where == 1.0
    assert found.share == pytest.approx(np.sqrt(0.1 / SAMPLES) / 4.0)


def test_a_change_is_seen_there_and_at_twice_as_much_and_by_its_parameters() -> None:
    assert FURTHER == 2.0
    runs = [one_way(str(k), coulomb, way=w, noise_n=0.1, seed=k) for k, w in enumerate((1.0, -1.0))]
    tried = Candidates(Campaign.prepare(Rig(), runs), "coulomb", "journal")
    hand, model = RunsAtHand(tried, ()), strength_of(tried, (), "inertia_leak")
    assert model is not None
    found = _change(hand, model, 1.5)
    assert found.shares is None
    mass = model.values(1.5)[model.which]
    for way, now in zip(found.ways, hand.change(model, 1.5), strict=True):
        assert way.shape == (501, 3)
        assert way[:, 0] == pytest.approx(now)
        assert way[:, 1] == pytest.approx(2.0 * now)
        # Linear in the mass.
        assert mass * way[:, 2] == pytest.approx(now, abs=1e-9)
    assert found.shown == pytest.approx(hand.shown(found.ways))


# ---- of which effects --------------------------------------------------------------------------


def test_power_is_told_of_all_that_may_come_and_is_not_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A further one of an effect beside that one alone; none of an effect without a null; and all
    of them are rivals, whichever are asked for."""
    names = ["sensor_offset", "cogging", "cogging_2", "sensor_lag", "inertia_leak"]
    monkeypatch.setattr(module, "RunsAtHand", lambda candidates, present: "runs")
    monkeypatch.setattr(
        module, "strength_of", lambda c, present, name: None if name == "sensor_lag" else name
    )
    monkeypatch.setattr(module, "fits_at_once", lambda campaign, law, names: 1)
    monkeypatch.setattr(_Seen, "of", lambda candidates, runs, model: f"seen {model}")
    monkeypatch.setattr(module, "_power", lambda c, runs, models, seen, name: (name, seen))
    candidates: Any = SimpleNamespace(names=names, campaign=None, law="coulomb")

    def told(present: tuple[str, ...], *asked: Any) -> list[str]:
        found: Any = power(candidates, present, *asked)
        for _, seen in found:
            assert set(seen) == {"sensor_offset", "inertia_leak", *beside}
            assert seen["inertia_leak"] == "seen inertia_leak"
        return [name for name, _ in found]

    beside = ["cogging"]
    assert told(()) == ["sensor_offset", "cogging", "inertia_leak"]
    assert told((), ["inertia_leak", "sensor_lag"]) == ["inertia_leak"]
    beside = ["cogging_2"]
    assert told(("cogging",)) == ["sensor_offset", "cogging_2", "inertia_leak"]
