"""How strong an effect must be to be named alone: by counting, and by what two effects share."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from by_hand import Array, coulomb
from jbf import Rig, Run
from jbf.diagnosis.alone import (
    NEVER,
    Change,
    chance_apart,
    chance_found,
    left_apart,
    times_alone,
    worth,
)
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.power import non_centrality, power
from jbf.diagnosis.strength import RunsAtHand
from jbf.estimation.campaign import Campaign

module = sys.modules["jbf.diagnosis.power"]
PRICE, TIE, CHANCE, DRAWS = 30.0, 8.0, 0.8, 40_000


def drawn(along: float, length: float) -> tuple[Array, Array]:
    """Gains of an effect so large, in noises, and of a rival whose direction has that much of it,
    in as many campaigns."""
    noise = np.random.default_rng(2).standard_normal((DRAWS, 2))
    whole = np.array([length, 0.0]) + noise
    rival = np.array([along, np.sqrt(1.0 - along**2)])
    return whole[:, 0] ** 2, (whole @ rival) ** 2


def test_the_chance_to_be_told_from_a_rival_is_counted() -> None:
    own, rival = drawn(0.8, 7.0)
    left = 7.0 * 0.6
    assert chance_apart(left, TIE) == pytest.approx(float(np.mean(own - rival > TIE)), abs=0.03)
    assert chance_apart(0.0, TIE) == 0.0


@pytest.mark.parametrize("along", [0.3, 0.8, 0.9])
def test_an_effect_of_that_strength_is_named_alone_so_often(along: float) -> None:
    root = np.sqrt(non_centrality(PRICE, 1, CHANCE))
    rivals = {"rival": (root * np.sqrt(1.0 - along**2), TIE)}
    times = times_alone(PRICE, 1, root**2, rivals, CHANCE)
    own, rival = drawn(along, times * root)
    alone = float(np.mean((own > PRICE) & (own - rival > TIE)))
    # Found and told from the rival: as if the two were independent, which is a little more.
    assert CHANCE - 0.01 < alone < CHANCE + 0.06


def test_found_and_told_are_one_promise_and_not_two() -> None:
    root = np.sqrt(non_centrality(PRICE, 1, CHANCE))
    sure = float(np.sqrt(0.7087) + np.sqrt(0.7087 + TIE))
    assert chance_apart(sure, TIE) == pytest.approx(CHANCE, abs=0.01)
    # At the strength at which each is so likely both are less so.
    assert times_alone(PRICE, 1, root**2, {"rival": (sure, TIE)}, CHANCE) > 1.05
    assert times_alone(PRICE, 1, root**2, {"rival": (10.0 * sure, TIE)}, CHANCE) < 1.01
    assert times_alone(PRICE, 1, root**2, {}, CHANCE) == pytest.approx(1.0, abs=1e-6)
    assert times_alone(PRICE, 1, root**2, {"rival": (0.0, TIE)}, CHANCE) == np.inf
    assert times_alone(PRICE, 1, root**2, {"rival": (0.01, TIE)}, CHANCE) == np.inf
    far = times_alone(PRICE, 1, root**2, {"rival": (2.0 * sure / NEVER, TIE)}, CHANCE)
    assert far == pytest.approx(0.5 * NEVER, rel=0.01)


def test_the_chance_to_be_found_is_what_the_non_centrality_was_asked_for() -> None:
    assert chance_found(PRICE, 2, non_centrality(PRICE, 2, 0.95)) == pytest.approx(0.95)


def test_a_sample_that_stands_out_alone_tells_no_more_than_three_noises() -> None:
    assert worth(np.array([1.0, -2.0, 100.0])) == pytest.approx(1.0 + 4.0 + 9.0)


# ---- samples beside jumps ----------------------------------------------------------------------


def swinging(speed_noise: float = 0.0) -> Candidates:
    """Slow swings with a noise of a hundredth of the friction; the speed as exact as asked for."""
    runs = []
    for k, rate in enumerate((1.1, 1.7, 2.3)):
        t = np.arange(0.0, 30.0, 0.02)
        v = 0.1 * np.sin(rate * t)
        noise, other = np.random.default_rng(k).standard_normal((2, len(t)))
        force = coulomb(t, v, v) + 0.05 * noise
        runs.append(Run.from_arrays(t, v + speed_noise * other, force, name=f"{k}"))
    return Candidates(Campaign.prepare(Rig(), runs), "coulomb", "journal")


def test_effects_are_compared_by_the_samples_that_both_leave() -> None:
    hand = RunsAtHand(swinging(), ())
    lengths = [len(now) for now in hand.now]
    random = np.random.default_rng(5)
    here = [random.standard_normal((n, 1)) for n in lengths]
    half = [(np.arange(n) < n // 2).astype(float) for n in lengths]
    own = Change(here, None, hand.shown(here))
    # One that moves jumps everywhere in the second half is judged by the first.
    ways = [w * s[:, None] for w, s in zip(here, half, strict=True)]
    rival = Change(ways, half, hand.shown(ways))
    rest = hand.shown([w * (1.0 - s)[:, None] for w, s in zip(here, half, strict=True)])
    assert np.linalg.norm(rest) > 10.0
    assert left_apart(own, rival, hand) < 1e-6 * np.linalg.norm(rest)
    assert left_apart(rival, own, hand) < 1e-6 * np.linalg.norm(rest)
    # By all samples the second half would tell them apart.
    blind = Change(rival.ways, None, hand.shown(rival.ways))
    assert left_apart(own, blind, hand) > 10.0


def test_where_instants_of_reversals_are_not_known_a_delay_and_a_lag_are_one() -> None:
    """A speed that is exact tells within a sample how long a force is late, and how."""
    for speed_noise in (0.0, 1e-3):
        found = {
            p.effect: p for p in power(swinging(speed_noise), (), ["time_delay", "sensor_lag"])
        }
        for name, other in (("time_delay", "sensor_lag"), ("sensor_lag", "time_delay")):
            own = found[name]
            assert own.found_80 is not None
            if speed_noise:
                assert other in own.like
                assert own.alone_80 is None or own.alone_80 > 1.2 * own.found_80
            else:
                # Of a step of 20 ms.
                assert own.alone_80 is not None
                assert own.alone_80 < 2e-3


def test_jumps_are_looked_at_where_two_effects_are_told_apart(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What moves them does not grow in proportion: from `found_80` on it is followed."""
    names = ["time_delay", "sensor_lag"]
    followed = {p.effect: p.alone_80 for p in power(swinging(1e-3), (), names)}
    monkeypatch.setattr(module, "LOOKS_ALONE", 0)
    straight = {p.effect: p.alone_80 for p in power(swinging(1e-3), (), names)}
    assert any(followed[n] != pytest.approx(straight[n], rel=0.05) for n in names)
