"""Every number of the policy moves a decision: none is dead, none is passed by on the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs, one_way
from jbf import Limits, Rig, diagnose
from jbf.diagnosis import Policy, late_channels
from jbf.diagnosis.bursts import find_bursts
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.confirmation import left_out_confirms
from jbf.diagnosis.constancy import Disagreement
from jbf.diagnosis.level import Level
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.rounds import select
from jbf.diagnosis.selection import (
    Ranked,
    _leaves_more,
    try_candidates,
    weights,
)
from jbf.diagnosis.uneven_noise import _uneven
from jbf.diagnosis.verdict import name_stands
from jbf.estimation.campaign import Campaign
from jbf.estimation.lateness import Lateness
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.records.findings.finding import Finding
from jbf.records.quantities import OF_BEARING
from made_up import MadeUp, N, price, sets
from policy_gates import GATES, linear, looked_at
from scipy import stats

FOUR = ["sensor_offset", "sensor_drift", "sensor_lag", "drive_compliance"]
PRICE = price(1, 4)


def test_the_numbers_are_these_until_somebody_means_to_change_them() -> None:
    assert Policy().to_dict() == {
        "false_alarms": 0.01,
        "imperfection": 22.0,
        "indifference": 0.03,
        "indifference_n": 0.0,
        "least_weight": 0.018,
        "most_effects": 5,
        "least_left_out_gain": 0.5,
        "least_better_runs": 0.66,
        "left_out_worse": 1.25,
        "leader_rms": 1.25,
        "weak": 60.0,
        "refused_rms": 0.99,
        "least_score": 0.3,
        "least_swap": 0.05,
        "contender": 60.0,
        "close": 0.6,
        "foreseen": 2.0,
        "promise": 5.0,
        "peaks_share": 0.5,
        "most_looks": 6,
        "most_shifts": 3,
        "late_apart": 0.08,
        "deviation_chance": 1e-4,
        "bias_moves": 0.01,
        "no_worse": 1.03,
        "uneven_noise": 1.25,
        "heavy_tails": 6.0,
        "coarse_steps": 2.0,
        "clear": 20.0,
        "pattern_share": 0.01,
        "pattern_sigma": 6.0,
        "tone_chance": 1e-7,
        "tone_share": 0.008,
        "replicate_sigma": 5.0,
        "replicate_share": 0.03,
        "burst_sigma": 5.0,
        "burst_share": 0.008,
        "burst_chance": 1e-4,
        "constancy_chance": 1e-8,
        "constancy_ratio": 2.5,
        "law_tie": 2.0,
        "law_same": 1.005,
        "least_separation": 25.0,
    }
    for value, decides, source in Policy.explained().values():
        assert value is not None
        assert decides
        assert source


def with_number(name: str, value: float) -> Policy:
    change: dict[str, Any] = {name: value}
    return replace(DEFAULT, **change)


# ---- decisions that turn where the number stands ----------------------------------------------


def selected(gains: dict[str, float], **more: Any) -> Callable[[Policy], object]:
    """Outcomes of a round, and what was fitted in it."""

    def decide(policy: Policy) -> object:
        candidates = MadeUp(FOUR, sets({"": 0.0} | gains), policy=policy, **more)
        found = try_candidates(cast(Candidates, candidates), ())
        asked = [(what, s) for what, s in candidates.asked if what in ("rank", "converge", "peaks")]
        return found.leader, [(t.effect, t.outcome) for t in found.trials], asked

    return decide


EFFECTS = ["sensor_offset", "sensor_drift", "sensor_lag", "inertia_leak", "wear_in", "backlash"]


def rounds(policy: Policy) -> object:
    """Effects added where each gains alone what it gains beside any other."""
    gains = {frozenset(EFFECTS[:k]): 200.0 * k for k in range(len(EFFECTS) + 1)}
    candidates = MadeUp(EFFECTS, gains, policy=policy)
    return select(cast(Candidates, candidates), 1.0).present


def test_a_search_that_ends_with_a_leader_in_hand_says_so() -> None:
    gains = {frozenset(EFFECTS[:k]): 200.0 * k for k in range(len(EFFECTS) + 1)}
    for most, said in ((5, 1), (6, 0)):
        made = MadeUp(EFFECTS, gains, policy=with_number("most_effects", most))
        found = select(cast(Candidates, made), 1.0)
        assert len(found.present) == most
        assert len(found.refused) == said
    made = MadeUp(EFFECTS, gains)
    (left,) = select(cast(Candidates, made), 1.0).refused
    assert left.where.startswith(f"{EFFECTS[5]} would bring ")
    assert left.where.endswith("beside 5 effects, and no more are searched for")
    assert left.share > 0.0


def swapped(policy: Policy) -> object:
    """An effect that would fit as well in another's place, and promises a twentieth of it."""
    gains = sets({"": 0.0, "sensor_lag": 1000.0, "sensor_drift": 1000.0})
    scores = {frozenset(["sensor_drift"]): 50.0}
    candidates = MadeUp(["sensor_lag", "sensor_drift"], gains, scores=scores, policy=policy)
    return tuple(weights(cast(Candidates, candidates), ("sensor_lag",))["sensor_lag"])


def refused(policy: Policy) -> object:
    """A candidate that fits down to 0.99 of the RMS, and is refused for other reasons."""
    gains = sets({"": 0.0, "sensor_lag": -2.0 * N * float(np.log(0.99))})
    candidates = MadeUp(
        ["sensor_lag"], gains, policy=replace(policy, weak=-100.0, false_alarms=1e-9)
    )
    return select(cast(Candidates, candidates), 1.0).refused


def apart(policy: Policy) -> object:
    """Runs of which half are 1.6 ms late and half as early, where a delay that they share could
    say it as well; samples are 20 ms apart."""
    late = Lateness((1.6e-3, 1.6e-3, -1.6e-3, -1.6e-3), 0.0, 1e-3)
    problem = linear()
    near = problem.solution(problem.starts({})[0], problem.campaign.samples, WHITE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(late_channels, "lateness", lambda *_: late)
        patch.setattr(late_channels, "jointly", lambda _, shifted: shifted)
        found = late_channels.on_time(problem, near, replace(policy, most_shifts=1), near, 1e9)
    return found is None


def standing(disagreement: float) -> Callable[[Policy], object]:
    return lambda policy: name_stands(1000.0, disagreement, policy)


def leaves_more(rms_n: float) -> Callable[[Policy], object]:
    ranked = Ranked(99.0, "sensor_lag", cast(Any, SimpleNamespace(rms_n=rms_n)))
    return lambda policy: _leaves_more(ranked, 1.0, policy)


def uneven(ratio: float) -> Callable[[Policy], object]:
    sizes, counts = np.array([1.0, ratio]), np.array([10**6, 10**6])
    return lambda policy: _uneven(sizes, counts, policy)


def disagreed(gain: float, degrees: int) -> Callable[[Policy], object]:
    return lambda policy: Disagreement(gain, degrees, {}).beyond_chance(policy)


def bursts(count: int, size: float, rest: Array) -> Callable[[Policy], object]:
    """Threes of large innovations among others whose median size makes one standard deviation."""
    time = 0.02 * np.arange(len(rest))
    prepared = [SimpleNamespace(run=SimpleNamespace(time_s=time, name="a", quantities=OF_BEARING))]
    every = np.ones(len(rest), dtype=bool)
    samples = Samples(("a",), (0.02,), (every,), (every.astype(float),))

    def decide(policy: Policy) -> object:
        innovations = rest.copy()
        for k in range(100, 100 + 100 * count, 100):
            innovations[k : k + 3] = size
        return bool(find_bursts(cast(Any, prepared), samples, [innovations], [innovations], policy))

    return decide


def coarse(policy: Policy) -> object:
    """The same in readings whose steps are twice the residual's RMS."""
    return tails(replace(policy, heavy_tails=5.0), steps=2.0)


def tails(policy: Policy, steps: float = 0.0) -> object:
    """Ten of the innovations of a long run are at five standard deviations: six times as many
    beyond four as Gaussian noise has."""
    count = round(10 / (6.0 * 2.0 * stats.norm.sf(4.0)))
    run = one_way("long", coulomb, duration_s=0.02 * (count - 1))
    assert len(run) == count
    e = 0.6745 * np.where(np.arange(count) % 2, 1.0, -1.0)
    e[1000:11000:1000] = 5.0
    campaign = Campaign.prepare(Rig(), [run])
    if steps > 0.0:
        size = steps * campaign.samples.rms([e])
        campaign = campaign.with_findings([Finding("steps", "", "long", size, "N", "", "")])
    problem = Problem(campaign, "coulomb", "journal", ())
    return looked_at(problem, [e], policy)


PLACES = np.arange(20_000)
EVEN = 0.6745 * np.where(PLACES % 2, 1.0, -1.0)[:501]
# One in eight is 2 in place of 0.67.
GENTLE = np.where(PLACES % 8 == 0, 2.0, 0.6745)[:501] * np.where(PLACES % 2, 1.0, -1.0)[:501]


def long_level(policy: Policy) -> float:
    """What one parameter must gain in 100,000 samples of 0.5 N."""
    return Level.shared(policy, 4, 1e5, 0.5).price(1, 100_000)


# Two in five are 4 in place of 0.67: the median says one, the mean square 6.7.
HEAVY = np.where(PLACES % 5 < 2, 4.0, 0.6745) * np.where(PLACES % 2, 1.0, -1.0)
BURST_SIZE = float(np.sqrt(0.008 / 0.992 * np.sum(HEAVY**2) / 12.0))

LINE = 0.6 * 280.0 - 60.0
"""Evidence from which on a candidate converges beside a leader of 280."""

TURNS: dict[str, tuple[Callable[[Policy], object], float, float]] = {
    "false_alarms": (selected({"sensor_lag": PRICE}), 0.0099, 0.0101),
    "imperfection": (selected({"sensor_lag": PRICE}), 21.9, 22.1),
    "indifference": (lambda p: long_level(p) > 90.0, 0.0299, 0.0301),
    # 13 mN beside a noise of half a newton are 2.6 % of it.
    "indifference_n": (lambda p: long_level(replace(p, indifference=0.0)) > 39.0, 0.0, 0.013),
    "least_weight": (selected({"sensor_lag": 300.0, "sensor_drift": 292.0}), 0.0179, 0.0181),
    "most_effects": (rounds, 4, 5),
    "least_left_out_gain": (lambda p: left_out_confirms(30.0, 0.5, 1.0, 1.0, p), 0.49, 0.51),
    "least_better_runs": (lambda p: left_out_confirms(99.0, 1.0, -1.0, 0.66, p), 0.65, 0.67),
    "left_out_worse": (lambda p: left_out_confirms(99.0, 1.0, -1.0, 1.0, p, 1.25), 1.24, 1.26),
    "weak": (lambda p: left_out_confirms(60.0, 0.1, 0.1, 0.0, p), 59.0, 61.0),
    "least_score": (
        selected({"sensor_lag": 300.0}, scores={frozenset(["sensor_lag"]): 0.3 * PRICE}),
        0.29,
        0.31,
    ),
    "refused_rms": (refused, 0.989, 0.991),
    "late_apart": (apart, 0.079, 0.081),
    "least_swap": (swapped, 0.049, 0.051),
    "contender": (
        selected({"sensor_lag": PRICE + 280.0, "sensor_drift": PRICE + LINE}),
        59.0,
        61.0,
    ),
    "close": (selected({"sensor_lag": PRICE + 280.0, "sensor_drift": PRICE + LINE}), 0.59, 0.61),
    # A first look promises 50 of the 108 that it must come to.
    "foreseen": (
        selected(
            {"sensor_lag": PRICE + 280.0},
            promised={frozenset(["sensor_drift"]): 0.5 * LINE},
        ),
        1.99,
        2.01,
    ),
    "promise": (
        # It lacks 10, and its next step promises 2.
        selected(
            {},
            ranked={frozenset(["sensor_lag"]): PRICE - 10.01},
            slopes={frozenset(["sensor_lag"]): 0.002},
        ),
        4.9,
        5.1,
    ),
    "peaks_share": (
        selected({"sensor_lag": PRICE + 200.0, "drive_compliance": PRICE + 100.0}),
        0.49,
        0.51,
    ),
    "heavy_tails": (tails, 5.9, 6.1),
    "coarse_steps": (coarse, 1.99, 2.01),
    "leader_rms": (leaves_more(1.25), 1.24, 1.26),
    "uneven_noise": (uneven(1.25), 1.24, 1.26),
    "clear": (standing(50.0), 19.9, 20.1),
    # Of four degrees of freedom chance decides, of a hundred the ratio.
    "constancy_chance": (disagreed(43.9, 4), 0.5e-8, 2e-8),
    "constancy_ratio": (disagreed(250.0, 100), 2.49, 2.51),
    "burst_sigma": (bursts(4, 5.0, EVEN), 4.9, 5.1),
    "burst_chance": (bursts(1, 7.0, GENTLE), 5e-5, 1.5e-4),
    "burst_share": (bursts(4, BURST_SIZE, HEAVY), 0.0078, 0.0082),
}
"""A decision that stands at the default: a little below it turns out otherwise than above."""


@pytest.mark.parametrize("name", list(TURNS))
def test_a_number_turns_a_decision_where_it_stands(name: str) -> None:
    decide, below, above = TURNS[name]
    assert below <= getattr(DEFAULT, name) <= above
    assert decide(with_number(name, below)) != decide(with_number(name, above))


# ---- tests of what remains: the amplitude at which they speak ---------------------------------


@pytest.mark.parametrize("name", list(GATES))
def test_a_number_is_what_a_test_of_the_remainder_waits_for(name: str) -> None:
    gate = GATES[name]
    quiet, loud = 0.0, 3.0
    assert not gate.finds(DEFAULT, quiet)
    assert gate.finds(DEFAULT, loud)
    for _ in range(14):
        middle = 0.5 * (quiet + loud)
        quiet, loud = (quiet, middle) if gate.finds(DEFAULT, middle) else (middle, loud)
    # Where the test begins to speak, it is this number that had kept it silent.
    assert gate.finds(with_number(name, gate.loose), quiet)
    assert not gate.finds(with_number(name, gate.strict), loud)


# ---- the whole way ----------------------------------------------------------------------------


def test_a_run_is_proposed_that_parts_rivals_far_enough() -> None:
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) - 0.1 * a, noise_n=0.05)
    limits = Limits(duration_s=15.0)
    found = diagnose(Rig(), runs, law="coulomb", limits=limits)
    assert found.verdict == "ambiguous"
    assert found.experiment is not None
    worth = found.experiment.evidence
    assert worth > DEFAULT.least_separation
    for least, proposed in ((0.99 * worth, True), (1.01 * worth, False)):
        policy = replace(DEFAULT, least_separation=least)
        again = diagnose(Rig(), runs, law="coulomb", limits=limits, policy=policy)
        assert (again.experiment is not None) == proposed
        assert again.verdict == "ambiguous"
        assert again.to_dict()["policy"]["least_separation"] == least


def test_no_number_is_left_out_here() -> None:
    known = {f.name for f in fields(Policy)}
    elsewhere = {
        "law_tie",
        "law_same",
        "most_looks",
        "most_shifts",
        "least_separation",
        "no_worse",
        "bias_moves",
    }
    assert {*TURNS, *GATES, *elsewhere} == known
