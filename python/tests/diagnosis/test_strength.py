"""Effects as functions of strength, and the part of a change beyond the law."""

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from jbf import effects
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.power.strength import PresentRuns, Strength, strength_of
from jbf.estimation.likelihood import effective_share
from jbf.estimation.noise import estimate_noise
from linear_campaigns import coulomb_candidates, coulomb_run


@pytest.fixture(scope="module")
def candidates() -> Candidates:
    return coulomb_candidates(four_runs(coulomb, noise_rms=0.1))


@pytest.fixture(scope="module")
def at_hand(candidates: Candidates) -> PresentRuns:
    return PresentRuns(candidates, ())


def model_of(candidates: Candidates, effect: str) -> Strength:
    model = strength_of(candidates, (), effect)
    assert model is not None
    return model


@pytest.mark.parametrize(
    "name",
    ["sensor_offset", "dry_asymmetry", "inertia", "presliding", "warm_up", "stribeck_excess"],
)
def test_parameter_moves_from_its_null_with_strength(name: str, candidates: Candidates) -> None:
    model = model_of(candidates, name)
    parameter = f"{name}.{effects()[name].parameters[0].name}"
    page = model.problem.parameters[parameter]
    assert model.which == model.problem.names.index(parameter)
    assert model.usual[model.which] == page.starts[0]
    for times in (0.5, 1.0, 2.0):
        value = float(model.values(times)[model.which])
        if page.null == np.inf:
            # The null of a contact is an infinite stiffness: twice the strength is half the
            # stiffness.
            assert value == pytest.approx(page.starts[0] / times)
        else:
            assert page.null is not None
            assert value == pytest.approx(page.null + times * (page.starts[0] - page.null))


def test_effect_parameter_stays_within_its_bounds_at_any_strength(candidates: Candidates) -> None:
    model = model_of(candidates, "dry_asymmetry")
    page = effects()["dry_asymmetry"].parameters[0]
    assert model.values(1e6)[model.which] == page.upper
    assert model.values(-1e6)[model.which] == page.lower


def test_all_coefficients_of_an_effect_grow_with_its_strength(candidates: Candidates) -> None:
    """All six knots of a curve grow by the same factor."""
    model = model_of(candidates, "stroke_dependence")
    knots = [i for i, name in enumerate(model.problem.names) if ".a_" in name]
    assert len(knots) == 6
    pages = list(model.problem.parameters.values())
    nulls = np.array([pages[i].null for i in knots], dtype=float)
    grown = model.values(2.0)[knots] - nulls
    assert grown == pytest.approx(2.0 * (model.usual[knots] - nulls))
    others = [i for i in range(len(pages)) if i not in knots]
    assert model.values(2.0)[others] == pytest.approx(model.usual[others])


def test_friction_change_by_a_linear_effect_is_proportional_to_its_strength(
    candidates: Candidates, at_hand: PresentRuns
) -> None:
    offset, mass = (model_of(candidates, name) for name in ("sensor_offset", "inertia"))
    prepared = candidates.campaign.prepared
    for times in (1.0, 2.0, 1.0):
        for change in at_hand.change(offset, times):
            assert change == pytest.approx(times * offset.usual[offset.which], abs=1e-9)
        for change, p in zip(at_hand.change(mass, times), prepared, strict=True):
            inertial = times * mass.usual[mass.which] * p.motion.acceleration
            assert change == pytest.approx(inertial, abs=1e-6)
    assert at_hand.shares(offset, 1.0) is None


def test_unexplained_part_of_a_change_is_its_residual_in_a_regression_on_the_law(
    candidates: Candidates, at_hand: PresentRuns
) -> None:
    changes = [
        np.sin(3.0 * np.arange(len(f))) + 0.3 * np.sign(f) + 0.02 * f for f in at_hand.prediction
    ]
    v = np.concatenate([p.motion.velocity for p in candidates.campaign.prepared])
    counted = np.concatenate(at_hand.samples.counted)
    x, y = np.column_stack([np.sign(v), v])[counted], np.concatenate(changes)[counted]
    assert at_hand.noise.white
    sigma = at_hand.base.rms / np.sqrt(effective_share(at_hand.solution))
    expected = (y - x @ np.linalg.lstsq(x, y, rcond=None)[0]) / sigma
    tolerance = 1e-3 * float(np.max(np.abs(expected)))
    assert at_hand.unexplained(changes)[:, 0] == pytest.approx(expected, abs=tolerance)
    assert sigma == pytest.approx(0.1, rel=0.15)


def test_weight_of_samples_next_to_jumps_is_reduced_if_an_effect_moves_the_jumps() -> None:
    t = np.arange(0.0, 12.0, 0.02)
    v = 0.1 * np.sin(1.1 * t)
    tried = coulomb_candidates([coulomb_run(t, v, seed=1)])
    at_hand, model = PresentRuns(tried, ()), model_of(tried, "time_delay")
    shares = at_hand.shares(model, 1.0)
    assert shares is not None
    (share,), (change,) = shares, at_hand.change(model, 1.0)
    reversals = np.flatnonzero(np.diff(np.sign(v)))
    assert all(np.min(share[k - 1 : k + 4]) < 1.0 for k in reversals[1:])
    assert np.mean(share == 1.0) > 0.8
    difference = model.problem.predict(model.values(1.0))[0] - at_hand.prediction[0]
    assert change == pytest.approx(difference * share)


def test_gain_of_a_fast_change_in_white_noise_counts_in_full(at_hand: PresentRuns) -> None:
    """Because the long-run variance is estimated, a gain may by chance count in part."""
    count = sum(int(np.count_nonzero(w > 0.0)) for w in at_hand.samples.weight)
    fast = at_hand.discounts(np.where(np.arange(count) % 2, 1.0, -1.0))
    slow = at_hand.discounts(np.sin(2.0 * np.pi * np.arange(count) / count))
    for counts in (fast, slow):
        assert all(0.0 < c <= 1.0 for c in counts)
    assert np.mean(fast) > 0.9


def waves(at_hand: PresentRuns, size: float, rate: float) -> list[Array]:
    return [size * np.sin(rate * np.arange(len(f)) + i) for i, f in enumerate(at_hand.prediction)]


@pytest.mark.parametrize(("size", "rate"), [(0.05, 0.03), (0.08, 0.3), (0.2, 3.0)])
def test_share_of_a_change_not_absorbed_by_noise_is_a_likelihood_ratio(
    candidates: Candidates, at_hand: PresentRuns, size: float, rate: float
) -> None:
    """Loss of likelihood with the re-estimated noise, relative to that with the previous noise."""
    signs = [np.sign(f) for f in at_hand.prediction]
    velocities = [p.motion.velocity for p in candidates.campaign.prepared]
    designs = [np.column_stack(columns) for columns in zip(signs, velocities, strict=True)]
    changes = [w + 0.1 * s for w, s in zip(waves(at_hand, size, rate), signs, strict=True)]
    step = np.linalg.lstsq(np.concatenate(designs), np.concatenate(changes), rcond=None)[0]
    apart = [c - x @ step for c, x in zip(changes, designs, strict=True)]
    residual, change = np.concatenate(at_hand.solution.residuals), np.concatenate(apart)
    chance = float(residual @ change) / float(change @ change)
    noise = [r - chance * c for r, c in zip(at_hand.solution.residuals, apart, strict=True)]
    there = [r + c for r, c in zip(noise, apart, strict=True)]
    samples, most_n = at_hand.samples, at_hand.problem.campaign.most_noise_n
    again = estimate_noise(there, samples.steps_s, samples.counted, most_n)
    before = samples.cost(noise, at_hand.noise)
    ratio = (samples.cost(there, again) - before) / (samples.cost(there, at_hand.noise) - before)
    assert at_hand.share_after_noise_refit(changes) == pytest.approx(
        np.clip(ratio, 0.02, 1.0), rel=1e-3
    )


def test_smooth_change_is_absorbed_by_coloured_noise_unlike_a_fast_one(
    at_hand: PresentRuns,
) -> None:
    assert at_hand.share_after_noise_refit(waves(at_hand, 0.2, 0.01)) < 0.2
    assert at_hand.share_after_noise_refit(waves(at_hand, 0.2, 3.0)) == 1.0
