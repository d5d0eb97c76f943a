"""An effect by its strength, and what noise that is described anew forgives of a change."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import coulomb, four_runs
from jbf import Rig, Run
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.strength import RunsAtHand, Strength, strength_of
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import effective_share
from jbf.estimation.noise import estimate_noise

Array = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def candidates() -> Candidates:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    return Candidates(campaign, "coulomb", "journal")


@pytest.fixture(scope="module")
def hand(candidates: Candidates) -> RunsAtHand:
    return RunsAtHand(candidates, ())


# ---- by how strong it is -----------------------------------------------------------------------


def sized(null: float, usual: float, lower: float = -np.inf, upper: float = np.inf) -> Strength:
    """An effect of one size, and of one parameter that is none, beside a law of one."""
    pages = {
        "F_c_n": SimpleNamespace(null=None, lower=0.0, upper=9.0),
        "e.size": SimpleNamespace(null=null, lower=lower, upper=upper),
        "e.rate": SimpleNamespace(null=None, lower=0.0, upper=9.0),
    }
    problem: Any = SimpleNamespace(parameters=pages)
    page: Any = pages["e.size"]
    return Strength("e", problem, np.array([5.0, usual, 2.0]), 1, page, (1,))


@pytest.mark.parametrize(
    ("null", "usual", "times", "size"),
    [
        (0.0, 4.0, 0.5, 2.0),
        # So many times as far from where there is none of it.
        (1.0, 4.0, 3.0, 10.0),
        (1.0, 4.0, 0.0, 1.0),
        (3.0, 2.0, 2.0, 1.0),
        # A stiffness without end is none: twice as strong is half as stiff.
        (np.inf, 4.0, 2.0, 2.0),
        (np.inf, 4.0, 0.5, 8.0),
    ],
)
def test_so_many_times_its_strength_is_as_far_from_none(
    null: float, usual: float, times: float, size: float
) -> None:
    model = sized(null, usual)
    assert model.values(times).tolist() == [5.0, size, 2.0]
    # What is usual is left as it is.
    assert model.usual.tolist() == [5.0, usual, 2.0]


def test_no_strength_is_beyond_its_bounds() -> None:
    model = sized(0.0, 4.0, lower=1.0, upper=6.0)
    assert [model.values(t)[1] for t in (0.1, 1.0, 100.0)] == [1.0, 4.0, 6.0]


def test_the_strength_is_told_by_the_first_size_of_the_effect(candidates: Candidates) -> None:
    found = strength_of(candidates, (), "stribeck_asymmetry")
    assert found is not None
    names = found.problem.names
    assert found.which == found.sizes[0]
    own = [i for i, n in enumerate(names) if n.startswith("stribeck_asymmetry.")]
    pages = list(found.problem.parameters.values())
    assert list(found.sizes) == [i for i in own if pages[i].null is not None]
    assert found.page is pages[found.which]
    # The law is where its own fit has it.
    known = candidates.fitted(()).named_values()
    for name, value in known.items():
        assert found.usual[names.index(name)] == value


# ---- changes -----------------------------------------------------------------------------------


def test_a_change_is_worked_out_once_until_another_is_asked_for(
    candidates: Candidates, hand: RunsAtHand
) -> None:
    one, other = (strength_of(candidates, (), n) for n in ("sensor_offset", "inertia_leak"))
    assert one is not None
    assert other is not None
    first = hand.change(one, 1.0)
    assert hand.change(other, 1.0)[0] is not first[0]
    assert hand.change(one, 1.0)[0] is first[0]
    twice = hand.change(one, 2.0)
    assert twice[0] == pytest.approx(2.0 * first[0])
    assert hand.change(one, 1.0)[0] is not first[0]


def test_runs_that_stand_for_more_tell_as_much(candidates: Candidates) -> None:
    """Half of the runs in place of all: what is left of a change counts root two times as much."""
    problem = candidates.fitted(()).problem
    whole = RunsAtHand(candidates, ())
    try:
        few = type(problem)(problem.campaign.only([0, 1]), problem.law, problem.clock, ())
        vars(problem)["thinned"] = few
        half = RunsAtHand(candidates, ())
    finally:
        vars(problem)["thinned"] = problem
    assert half.samples.count == 0.5 * whole.samples.count
    assert len(half.now) == 2

    def level(hand: RunsAtHand) -> float:
        r = hand.solution.stacked()[0]
        return float(r @ r) / len(r) / effective_share(hand.solution)

    assert whole.scale == pytest.approx(level(whole) ** -0.5)
    assert half.scale == pytest.approx((2.0 / level(half)) ** 0.5)


def test_where_an_effect_moves_jumps_samples_count_for_less() -> None:
    """By as much its change does."""
    t = np.arange(0.0, 12.0, 0.02)
    v = 0.1 * np.sin(1.1 * t)
    force = coulomb(t, v, v) + 0.1 * np.random.default_rng(1).standard_normal(len(t))
    tried = Candidates(
        Campaign.prepare(Rig(), [Run.from_arrays(t, v, force, name="swings")]), "coulomb", "journal"
    )
    hand, model = RunsAtHand(tried, ()), strength_of(tried, (), "time_delay")
    assert model is not None
    values = model.values(1.0)
    (share,), (change,) = hand.shares(model, 1.0) or [], hand.change(model, 1.0)
    weight = model.problem.samples_at(values).weight[0]
    assert np.any((weight > 0.0) & (weight < 1.0))
    counted = hand.samples.weight[0] > 0.0
    assert share[counted] == pytest.approx(np.minimum(weight, hand.samples.weight[0])[counted])
    assert np.all(share[~counted] == 0.0)
    gap = model.problem.predict(values)[0] - hand.now[0]
    assert change == pytest.approx(gap * share)


# ---- what is forgiven --------------------------------------------------------------------------


def waves(hand: RunsAtHand, size: float, rate: float) -> list[Array]:
    return [size * np.sin(rate * np.arange(len(f)) + i) for i, f in enumerate(hand.now)]


@pytest.mark.parametrize(("size", "rate"), [(0.05, 0.03), (0.08, 0.3), (0.2, 3.0)])
def test_what_is_forgiven_is_what_another_noise_explains(
    hand: RunsAtHand, size: float, rate: float
) -> None:
    """A change beside residuals that have nothing of it: by how much they are less likely, once
    with the noise as it was and once with the noise that they then seem to have."""
    columns = [
        np.column_stack([np.sign(f), j]) for f, j in zip(hand.now, _slopes(hand), strict=True)
    ]
    # What the law makes up for is none of it.
    change = [w + 0.1 * np.sign(f) for w, f in zip(waves(hand, size, rate), hand.now, strict=True)]
    x = np.concatenate(columns)
    step = np.linalg.lstsq(x, np.concatenate(change), rcond=None)[0]
    way = [c - j @ step for c, j in zip(change, columns, strict=True)]
    r, w = np.concatenate(hand.solution.residuals), np.concatenate(way)
    share = float(r @ w) / float(w @ w)
    noise = [e - share * c for e, c in zip(hand.solution.residuals, way, strict=True)]
    there = [e + c for e, c in zip(noise, way, strict=True)]
    samples = hand.samples
    again = estimate_noise(
        there, samples.steps_s, samples.counted, hand.problem.campaign.most_noise_n
    )
    was = samples.cost(noise, hand.noise)
    plain = samples.cost(there, hand.noise) - was
    # In white noise that is what is seen of it.
    assert hand.noise.white
    wanted = np.clip((samples.cost(there, again) - was) / plain, 0.02, 1.0)
    assert hand.not_forgiven(change) == pytest.approx(wanted, rel=1e-3)


def _slopes(hand: RunsAtHand) -> list[Array]:
    """The derivative by viscous friction, the speed."""
    return [p.motion.velocity_m_s[:, None] for p in hand.problem.campaign.prepared]


def test_a_smooth_change_is_forgiven_and_a_jagged_one_is_not(hand: RunsAtHand) -> None:
    assert hand.not_forgiven(waves(hand, 0.2, 0.01)) < 0.2
    assert hand.not_forgiven(waves(hand, 0.2, 3.0)) == 1.0
