"""Effects as functions of strength, and the part of a change that the law does not explain."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import coulomb, four_runs
from jbf import Rig, Run, effects
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.strength import RunsAtHand, strength_of
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import effective_share
from jbf.estimation.noise import estimate_noise

Array = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def candidates() -> Candidates:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    return Candidates(campaign, "coulomb", "journal")


@pytest.fixture(scope="module")
def at_hand(candidates: Candidates) -> RunsAtHand:
    return RunsAtHand(candidates, ())


@pytest.mark.parametrize(
    "name",
    ["sensor_offset", "dry_asymmetry", "inertia_leak", "presliding", "warm_up", "stribeck_excess"],
)
def test_parameter_moves_from_its_null_in_proportion_to_the_strength(
    name: str, candidates: Candidates
) -> None:
    model = strength_of(candidates, (), name)
    assert model is not None
    parameter = f"{name}.{effects()[name].parameters[0].name}"
    page = model.problem.parameters[parameter]
    assert model.which == model.problem.names.index(parameter)
    assert model.usual[model.which] == page.starts[0]
    for times in (0.5, 1.0, 2.0):
        value = float(model.values(times)[model.which])
        if page.null == np.inf:
            # An infinite stiffness has no effect: twice as strong is half as stiff.
            assert value == pytest.approx(page.starts[0] / times)
        else:
            assert page.null is not None
            assert value == pytest.approx(page.null + times * (page.starts[0] - page.null))


def test_parameter_stays_within_its_bounds_at_any_strength(candidates: Candidates) -> None:
    model = strength_of(candidates, (), "dry_asymmetry")
    assert model is not None
    page = effects()["dry_asymmetry"].parameters[0]
    assert model.values(1e6)[model.which] == page.upper
    assert model.values(-1e6)[model.which] == page.lower


def test_all_coefficients_of_an_effect_grow_in_proportion_to_the_strength(
    candidates: Candidates,
) -> None:
    """A curve of six knots grows as a whole."""
    model = strength_of(candidates, (), "stroke_dependence")
    assert model is not None
    knots = [i for i, name in enumerate(model.problem.names) if ".a_" in name]
    assert len(knots) == 6
    pages = list(model.problem.parameters.values())
    nulls = np.array([pages[i].null for i in knots], dtype=float)
    grown = model.values(2.0)[knots] - nulls
    assert grown == pytest.approx(2.0 * (model.usual[knots] - nulls))
    others = [i for i in range(len(pages)) if i not in knots]
    assert model.values(2.0)[others] == pytest.approx(model.usual[others])


def test_change_of_a_linear_effect_is_its_column_times_the_strength(
    candidates: Candidates, at_hand: RunsAtHand
) -> None:
    offset = strength_of(candidates, (), "sensor_offset")
    mass = strength_of(candidates, (), "inertia_leak")
    assert offset is not None
    assert mass is not None
    for times in (1.0, 2.0, 1.0):
        for change in at_hand.change(offset, times):
            assert change == pytest.approx(times * offset.usual[offset.which], abs=1e-9)
        for change, p in zip(
            at_hand.change(mass, times), candidates.campaign.prepared, strict=True
        ):
            inertial = times * mass.usual[mass.which] * p.motion.acceleration_m_s2
            assert change == pytest.approx(inertial, abs=1e-6)
    assert at_hand.shares(offset, 1.0) is None


def test_change_beyond_the_law_is_its_regression_residual_in_units_of_the_noise(
    candidates: Candidates, at_hand: RunsAtHand
) -> None:
    changes = [np.sin(3.0 * np.arange(len(f))) + 0.3 * np.sign(f) + 0.02 * f for f in at_hand.now]
    v = np.concatenate([p.motion.velocity_m_s for p in candidates.campaign.prepared])
    design = np.column_stack([np.sign(v), v])
    target = np.concatenate(changes)
    counted = np.concatenate(at_hand.samples.counted)
    x, y = design[counted], target[counted]
    residual = y - x @ np.linalg.lstsq(x, y, rcond=None)[0]
    assert at_hand.noise.white
    sigma = at_hand.base.rms_n / np.sqrt(effective_share(at_hand.solution))
    shown = at_hand.shown(changes)[:, 0]
    assert shown == pytest.approx(
        residual / sigma, abs=1e-3 * float(np.max(np.abs(residual / sigma)))
    )
    assert sigma == pytest.approx(0.1, rel=0.15)


def test_samples_next_to_jumps_count_less_with_an_effect_that_moves_them() -> None:
    t = np.arange(0.0, 12.0, 0.02)
    v = 0.1 * np.sin(1.1 * t)
    force = coulomb(t, v, v) + 0.1 * np.random.default_rng(1).standard_normal(len(t))
    run = Run.from_arrays(t, v, force, name="swings")
    tried = Candidates(Campaign.prepare(Rig(), [run]), "coulomb", "journal")
    at_hand, model = RunsAtHand(tried, ()), strength_of(tried, (), "time_delay")
    assert model is not None
    shares = at_hand.shares(model, 1.0)
    assert shares is not None
    (share,), (change,) = shares, at_hand.change(model, 1.0)
    reversals = np.flatnonzero(np.diff(np.sign(v)))
    assert all(np.min(share[k - 1 : k + 4]) < 1.0 for k in reversals[1:])
    assert np.mean(share == 1.0) > 0.8
    values = model.values(1.0)
    difference = model.problem.predict(values)[0] - at_hand.now[0]
    assert change == pytest.approx(difference * share)


def test_gain_in_white_noise_counts_in_full_in_a_fast_direction(at_hand: RunsAtHand) -> None:
    """The long-run variance is estimated: a gain never counts more, and less by chance."""
    count = sum(int(np.count_nonzero(w > 0.0)) for w in at_hand.samples.weight)
    fast = at_hand.counts(np.where(np.arange(count) % 2, 1.0, -1.0))
    slow = at_hand.counts(np.sin(2.0 * np.pi * np.arange(count) / count))
    for counts in (fast, slow):
        assert all(0.0 < c <= 1.0 for c in counts)
    assert np.mean(fast) > 0.9


def waves(at_hand: RunsAtHand, size: float, rate: float) -> list[Array]:
    return [size * np.sin(rate * np.arange(len(f)) + i) for i, f in enumerate(at_hand.now)]


@pytest.mark.parametrize(("size", "rate"), [(0.05, 0.03), (0.08, 0.3), (0.2, 3.0)])
def test_remaining_share_of_a_change_is_its_likelihood_loss_with_reestimated_noise(
    candidates: Candidates, at_hand: RunsAtHand, size: float, rate: float
) -> None:
    """Loss of likelihood with the noise estimated again, over that with the previous noise."""
    signs = [np.sign(f) for f in at_hand.now]
    designs = [
        np.column_stack([s, p.motion.velocity_m_s])
        for s, p in zip(signs, candidates.campaign.prepared, strict=True)
    ]
    changes = [w + 0.1 * s for w, s in zip(waves(at_hand, size, rate), signs, strict=True)]
    step = np.linalg.lstsq(np.concatenate(designs), np.concatenate(changes), rcond=None)[0]
    apart = [c - x @ step for c, x in zip(changes, designs, strict=True)]
    residual, change = np.concatenate(at_hand.solution.residuals), np.concatenate(apart)
    chance = float(residual @ change) / float(change @ change)
    noise = [r - chance * c for r, c in zip(at_hand.solution.residuals, apart, strict=True)]
    there = [r + c for r, c in zip(noise, apart, strict=True)]
    samples = at_hand.samples
    again = estimate_noise(
        there, samples.steps_s, samples.counted, at_hand.problem.campaign.most_noise_n
    )
    before = samples.cost(noise, at_hand.noise)
    ratio = (samples.cost(there, again) - before) / (samples.cost(there, at_hand.noise) - before)
    expected = np.clip(ratio, 0.02, 1.0)
    assert at_hand.not_forgiven(changes) == pytest.approx(expected, rel=1e-3)


def test_smooth_change_is_absorbed_by_coloured_noise_and_a_fast_one_is_not(
    at_hand: RunsAtHand,
) -> None:
    assert at_hand.not_forgiven(waves(at_hand, 0.2, 0.01)) < 0.2
    assert at_hand.not_forgiven(waves(at_hand, 0.2, 3.0)) == 1.0
