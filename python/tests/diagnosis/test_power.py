"""Detectable and distinguishable strength of an effect: regressions, and simulated gains."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from by_hand import Array, Friction, coulomb, one_way
from golden import golden
from jbf import Run
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import evidence
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.power.detection_limits import non_centrality, power
from jbf.diagnosis.power.distinction import (
    NEVER,
    Change,
    bounded_square,
    detection_probability,
    distinction_factor,
    distinction_probability,
    distinguishable_size,
)
from jbf.diagnosis.power.strength import PresentRuns, strength_of
from linear_campaigns import coulomb_candidates, coulomb_run
from scipy import optimize, stats

NOISE_N = 0.1


def runs(friction: Friction = coulomb, seed: int = 0) -> list[Run]:
    return [
        one_way(
            f"{k}", friction, direction=direction, rate=rate, noise_rms=NOISE_N, seed=4 * seed + k
        )
        for k, (direction, rate) in enumerate([(1.0, 0.7), (-1.0, 1.3), (1.0, 2.1), (-1.0, 4.0)])
    ]


@cache
def powers() -> dict[str, Any]:
    """`Power` of each effect; arithmetic with a missing strength fails."""
    return {p.effect: p for p in power(coulomb_candidates(runs()), ())}


def columns() -> tuple[Array, Array, Array]:
    """Velocity, acceleration and time of all samples."""
    records = runs()
    v = np.concatenate([run.velocity for run in records])
    a = np.concatenate([np.gradient(run.velocity, run.time_s) for run in records])
    return v, a, np.concatenate([run.time_s for run in records])


def residual_norm(change: Array, *others: Array) -> float:
    """Norm of the part of a change that neither the law nor additional columns explain."""
    v = columns()[0]
    design = np.column_stack([np.sign(v), v, *others])
    return float(np.linalg.norm(change - design @ np.linalg.lstsq(design, change, rcond=None)[0]))


@cache
def price() -> float:
    return coulomb_candidates(runs()).price(1)


@pytest.mark.parametrize("chance", [0.8, 0.95])
@pytest.mark.parametrize("parameters", [1, 3])
def test_non_centrality_has_the_given_detection_probability(parameters: int, chance: float) -> None:
    for threshold in (10.0, 30.0, 400.0):
        found = non_centrality(threshold, parameters, chance)
        assert stats.ncx2.sf(threshold, parameters, found) == pytest.approx(chance, abs=1e-4)


def test_gain_that_counts_for_a_share_requires_a_larger_non_centrality() -> None:
    """A gain counts in full or by a quarter, each with probability one half."""
    exceeds = stats.ncx2.sf([30.0, 120.0], 1, non_centrality(30.0, 1, 0.8, (1.0, 0.25)))
    assert np.mean(exceeds) == pytest.approx(0.8, abs=1e-4)
    assert non_centrality(30.0, 1, 0.8, (0.5,)) == pytest.approx(non_centrality(60.0, 1, 0.8))


def test_detectable_strength_of_a_mass_is_that_of_a_regression() -> None:
    """The mass is a third column in addition to dry and viscous friction."""
    v, a, _ = columns()
    found = powers()["inertia"]
    for value, chance in ((found.detectable_80, 0.8), (found.detectable_95, 0.95)):
        wanted = np.sqrt(non_centrality(price(), 1, chance)) * NOISE_N
        # The noise estimate from 2000 samples has an error of a few percent.
        assert value * residual_norm(a) == pytest.approx(wanted, rel=0.03)
    share = found.detectable_80 * np.sqrt(np.mean(a**2) / np.mean((5.0 + 20.0 * np.abs(v)) ** 2))
    assert found.share_80 == pytest.approx(share, rel=0.02)
    assert (found.parameter, found.unit) == ("m_e", "kg")


@pytest.mark.parametrize("effect", ["sensor_offset", "sensor_drift", "viscous_asymmetry"])
def test_detectable_size_of_a_smooth_change_is_larger_than_in_white_noise(effect: str) -> None:
    """The size is larger by 5 to 70 %, because coloured noise can absorb a part of the change."""
    v, _, t = columns()
    changes = {"sensor_offset": np.ones(len(v)), "sensor_drift": t, "viscous_asymmetry": np.abs(v)}
    wanted = np.sqrt(non_centrality(price(), 1, 0.8)) * NOISE_N
    assert (
        1.05 * wanted
        < powers()[effect].detectable_80 * residual_norm(changes[effect])
        < 1.7 * wanted
    )


def test_effect_that_the_law_explains_has_no_detectable_strength() -> None:
    """At one speed a quadratic drag is equivalent to dry friction."""
    t = np.arange(0.0, 20.0, 0.02)
    records = [coulomb_run(t, np.full(len(t), v), seed=k) for k, v in enumerate((0.1, -0.1))]
    powers = power(coulomb_candidates(records), ())
    (found,) = (p for p in powers if p.effect == "quadratic_drag")
    assert (found.detectable_80, found.detectable_95, found.distinguishable_80, found.share_80) == (
        None,
    ) * 4
    assert found.confounded_with == ()
    assert found.hidden


def test_effect_is_reported_as_hidden_if_its_usual_strength_is_undetectable() -> None:
    tried = coulomb_candidates(runs())
    for p in powers().values():
        model = strength_of(tried, (), p.effect)
        assert model is not None
        if model.page.null == 0.0:
            usual = float(model.usual[model.which])
            assert p.hidden == (p.detectable_80 is None or p.detectable_80 > usual), p
    hidden = [p for p in powers().values() if p.hidden]
    assert {p.detectable_80 is None for p in hidden} == {True, False}


def test_effects_with_the_same_signature_are_confounded() -> None:
    """Without rests a direction-dependent dry friction is equivalent to a sensor offset."""
    offset, dry = powers()["sensor_offset"], powers()["dry_asymmetry"]
    assert offset.detectable_80 is not None
    assert (offset.distinguishable_80, dry.distinguishable_80) == (None, None)
    assert offset.confounded_with[0] == "dry_asymmetry"
    assert dry.confounded_with[0] == "sensor_offset"


def test_effect_with_a_unique_signature_is_distinguishable_if_detectable() -> None:
    for name in ("stribeck_asymmetry", "sensor_hysteresis", "sensor_drift"):
        found = powers()[name]
        assert found.confounded_with == ()
        assert found.distinguishable_80 == pytest.approx(found.detectable_80, rel=0.1)


def test_distinguishable_strength_is_that_of_a_regression_on_law_and_rival() -> None:
    """Viscous friction that depends on direction; in the nearest rival all friction does."""
    found = powers()["viscous_asymmetry"]
    assert found.confounded_with[0] == "direction_asymmetry"
    change = np.abs(columns()[0])
    alone = residual_norm(change) / NOISE_N
    apart = residual_norm(change, 5.0 + 20.0 * change) / NOISE_N

    def surplus(strength: float) -> float:
        gains = stats.ncx2.sf(price(), 1, (strength * alone) ** 2)
        unexplained = strength * apart
        margin = (unexplained**2 - DEFAULT.selection.tie) / (2.0 * unexplained)
        return float(gains * stats.norm.cdf(margin)) - 0.8

    assert found.distinguishable_80 == pytest.approx(optimize.brentq(surplus, 0.05, 5.0), rel=0.05)
    assert found.distinguishable_80 > 1.5 * found.detectable_80


def test_power_is_reported_for_effects_that_are_not_in_the_model() -> None:
    tried = coulomb_candidates(runs(lambda t, v, a: coulomb(t, v, a) + 2.0 * a))
    found = power(tried, ("inertia",))
    assert {p.effect for p in found} == set(tried.names) - {"inertia"}


def test_presliding_is_not_detectable_at_any_stiffness_from_rests() -> None:
    """At rest friction balances any force, like a contact of arbitrary stiffness."""
    t = np.arange(0.0, 20.0, 0.02)
    moving = np.mod(t, 6.0) > 2.0
    records = [coulomb_run(t, 0.1 * np.sin((0.6 + 0.2 * k) * t) * moving, seed=k) for k in range(3)]
    found = {p.effect: p for p in power(coulomb_candidates(records), ())}
    assert not found["presliding"].always
    assert not found["inertia"].always
    assert found["presliding"].detectable_80 is not None


def test_diagnosis_reports_power_only_if_no_structure_is_unexplained() -> None:
    result = golden("bearing_coulomb_drag")
    names = {p.effect for p in result.power}
    assert "inertia" in names
    assert "coulomb_drag" not in names
    row = next(r for r in result.to_dict()["power"] if r["effect"] == "inertia")
    assert row["detectable_95"] > row["detectable_80"] > 0.0
    assert golden("bearing_hum").power == ()


@pytest.mark.extended
@pytest.mark.parametrize("effect", ["inertia", "sensor_drift"])
def test_effect_of_detectable_strength_is_detected_in_eighty_percent_of_campaigns(
    effect: str,
) -> None:
    value: float = powers()[effect].detectable_80

    def friction(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + value * (a if effect == "inertia" else t)

    found, campaigns = 0, 60
    for seed in range(1, campaigns + 1):
        tried = coulomb_candidates(runs(friction, seed))
        found += evidence(tried, tried.converge((effect,)), tried.converge(())) > 0.0
    low, high = stats.binom.ppf([0.0005, 0.9995], campaigns, 0.8)
    assert low <= found <= high


PRICE, TIE, CHANCE = 30.0, 8.0, 0.8
SQUARE = non_centrality(PRICE, 1, CHANCE)
"""Non-centrality of the gain at which an effect with one parameter is detected."""


@pytest.mark.parametrize(("unexplained", "margin"), [(4.0, 8.0), (3.0, 2.0), (10.0, 40.0)])
def test_gain_difference_to_a_rival_is_normally_distributed(
    unexplained: float, margin: float
) -> None:
    """The variance of the difference of the gains is four times its mean."""
    expected = stats.norm.sf(margin, loc=unexplained**2, scale=2.0 * unexplained)
    assert distinction_probability(unexplained, margin) == pytest.approx(float(expected))


@pytest.mark.parametrize("parameters", [1, 3])
def test_detection_probability_is_that_of_a_noncentral_chi_square(parameters: int) -> None:
    expected = stats.ncx2.sf([10.0, 30.0], parameters, 25.0)
    assert detection_probability(np.array([10.0, 30.0]), parameters, 25.0) == pytest.approx(
        expected, abs=1e-6
    )


@pytest.mark.parametrize("correlation", [0.3, 0.8, 0.9])
def test_effect_of_distinguishable_strength_is_named_in_eighty_percent(correlation: float) -> None:
    size, unexplained = np.sqrt(SQUARE), np.sqrt(1.0 - correlation**2)
    times = distinction_factor(PRICE, 1, SQUARE, {"rival": (size * unexplained, TIE)}, CHANCE)
    draws = np.array([times * size, 0.0]) + np.random.default_rng(2).standard_normal((40_000, 2))
    own, rival = draws[:, 0] ** 2, (draws @ [correlation, unexplained]) ** 2
    alone = float(np.mean((own > PRICE) & (own - rival > TIE)))
    # Independence of the two events is assumed, which requires a slightly larger strength.
    assert CHANCE - 0.01 < alone < CHANCE + 0.06


def test_distinguishable_strength_is_infinite_with_an_inseparable_rival_only() -> None:
    assert distinction_factor(PRICE, 1, SQUARE, {}, CHANCE) == pytest.approx(1.0, abs=1e-6)
    assert distinction_factor(PRICE, 1, SQUARE, {"rival": (100.0, TIE)}, CHANCE) < 1.01
    for unexplained in (0.0, 0.01):
        rivals = {"far": (100.0, TIE), "near": (unexplained, TIE)}
        assert distinction_factor(PRICE, 1, SQUARE, rivals, CHANCE) == np.inf


def test_large_distinguishable_strength_depends_on_the_rival_only() -> None:
    """Far above the threshold the strength follows from l^2 - 1.683 l = margin at 80 %."""
    quantile = 2.0 * stats.norm.ppf(CHANCE)
    needed = 0.5 * (quantile + np.sqrt(quantile**2 + 4.0 * TIE))
    rivals = {"rival": (2.0 * needed / NEVER, TIE)}
    assert distinction_factor(PRICE, 1, SQUARE, rivals, CHANCE) == pytest.approx(
        0.5 * NEVER, rel=0.01
    )


def test_squared_change_of_each_sample_is_clipped_at_three_sigma() -> None:
    assert bounded_square(np.array([1.0, -2.0, 100.0])) == pytest.approx(1.0 + 4.0 + 9.0)


def swings(velocity_noise: float = 0.0) -> Candidates:
    """Reversing slides whose noise is a hundredth of the friction."""
    runs, t = [], np.arange(0.0, 30.0, 0.02)
    for k, rate in enumerate((1.1, 1.7, 2.3)):
        v = 0.1 * np.sin(rate * t)
        noise, error = np.random.default_rng(k).standard_normal((2, len(t)))
        force = coulomb(t, v, v) + 0.05 * noise
        runs.append(Run.from_arrays(t, v + velocity_noise * error, force, name=f"{k}"))
    return coulomb_candidates(runs)


def test_unexplained_part_of_a_change_by_a_rival_is_a_regression_residual() -> None:
    at_hand = PresentRuns(swings(), ())
    random = np.random.default_rng(5)
    changes = [0.02 * random.standard_normal((len(f), 2)) for f in at_hand.prediction]
    mixed = [c @ np.array([[0.6], [0.8]]) for c in changes]
    own = Change(mixed, None, at_hand.unexplained(mixed))
    first = [c[:, :1] for c in changes]
    rival = Change(first, None, at_hand.unexplained(first))
    design, target = at_hand.unexplained(first)[:, 0], at_hand.unexplained(mixed)[:, 0]
    residual = target - design * float(design @ target) / float(design @ design)
    assert distinguishable_size(own, rival, at_hand) == pytest.approx(
        np.sqrt(bounded_square(residual)), rel=1e-6
    )
    assert distinguishable_size(own, own, at_hand) == pytest.approx(0.0, abs=1e-6)


def test_effects_are_compared_only_at_samples_that_have_weight_in_both() -> None:
    """A rival without weight in the second half is compared only in the first half."""
    at_hand = PresentRuns(swings(), ())
    lengths = [len(f) for f in at_hand.prediction]
    random = np.random.default_rng(5)
    everywhere = [random.standard_normal((n, 1)) for n in lengths]
    first_half = [(np.arange(n) < n // 2).astype(float) for n in lengths]
    own = Change(everywhere, None, at_hand.unexplained(everywhere))
    weighted = [c * s[:, None] for c, s in zip(everywhere, first_half, strict=True)]
    rival = Change(weighted, first_half, at_hand.unexplained(weighted))
    assert distinguishable_size(own, rival, at_hand) < 1e-4
    assert distinguishable_size(rival, own, at_hand) < 1e-4
    assert (
        distinguishable_size(own, Change(weighted, None, at_hand.unexplained(weighted)), at_hand)
        > 10.0
    )


def test_only_filters_must_change_the_friction_by_a_minimum_share_of_the_noise() -> None:
    candidates, limits = swings(), []
    for share in (DEFAULT.motion.min_filter_share, 0.0):
        candidates.policy = DEFAULT.with_values({"motion.min_filter_share": share})
        limits.append({found.effect: found.share_80 for found in power(candidates, ())})
    friction = np.concatenate([p.friction for p in candidates.campaign.prepared])
    least = np.sqrt(DEFAULT.motion.min_filter_share) * 0.05 / np.sqrt(np.mean(friction**2))
    for name in ("sensor_lag", "time_delay"):
        assert limits[0][name] > max(limits[1][name], least)
    assert limits[0]["sensor_offset"] == limits[1]["sensor_offset"]


@pytest.mark.parametrize("velocity_noise", [0.0, 1e-3])
def test_delay_and_lag_are_confounded_if_reversals_are_uncertain(velocity_noise: float) -> None:
    """With an exact velocity the two effects differ only within a sample of 20 ms."""
    names, candidates = ["time_delay", "sensor_lag"], swings(velocity_noise)
    candidates.policy = DEFAULT.with_values({"motion.min_filter_share": 0.0})
    found: dict[str, Any] = {p.effect: p for p in power(candidates, ())}
    for name, other in (names, names[::-1]):
        own = found[name]
        if velocity_noise:
            assert other in own.confounded_with
            limit = own.distinguishable_80
            assert limit is None or limit > max(own.detectable_80, 2e-3)
        else:
            assert own.distinguishable_80 < 2e-3
