"""Minimum detectable strength of an effect: textbook regressions, and simulated campaigns."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import Friction, coulomb, one_way
from golden import golden
from jbf import Rig, Run
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import evidence, price_of
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.power import Power, non_centrality, power
from jbf.diagnosis.strength import strength_of
from jbf.estimation.campaign import Campaign
from scipy import optimize, stats

Array = npt.NDArray[np.float64]
NOISE_N = 0.1
DRY_N, VISCOUS_N_S_M = 5.0, 20.0


def runs(friction: Friction = coulomb, seed: int = 0) -> list[Run]:
    return [
        one_way(f"{k}", friction, way=way, rate=rate, noise_n=NOISE_N, seed=4 * seed + k)
        for k, (way, rate) in enumerate([(1.0, 0.7), (-1.0, 1.3), (1.0, 2.1), (-1.0, 4.0)])
    ]


def candidates(records: list[Run], policy: Policy = DEFAULT) -> Candidates:
    return Candidates(Campaign.prepare(Rig(), records), "coulomb", "journal", policy)


@cache
def powers() -> dict[str, Power]:
    return {p.effect: p for p in power(candidates(runs()), ())}


def columns() -> tuple[Array, Array, Array]:
    """Velocity, acceleration and time of all samples."""
    records = runs()
    v = np.concatenate([run.velocity_m_s for run in records])
    a = np.concatenate([np.gradient(run.velocity_m_s, run.time_s) for run in records])
    return v, a, np.concatenate([run.time_s for run in records])


def residual_norm(change: Array, *others: Array) -> float:
    """Norm of what the law, and other columns, do not explain of a change."""
    v = columns()[0]
    design = np.column_stack([np.sign(v), v, *others])
    return float(np.linalg.norm(change - design @ np.linalg.lstsq(design, change, rcond=None)[0]))


@cache
def price() -> float:
    return price_of(candidates(runs()), 1)


@pytest.mark.parametrize("chance", [0.8, 0.95])
@pytest.mark.parametrize("parameters", [1, 3])
def test_noncentral_chi_square_exceeds_the_threshold_with_the_given_probability(
    parameters: int, chance: float
) -> None:
    for threshold in (10.0, 30.0, 400.0):
        found = non_centrality(threshold, parameters, chance)
        exceeds = stats.ncx2.sf(threshold, parameters, found)
        assert exceeds == pytest.approx(chance, abs=1e-4)


def test_gain_that_counts_for_less_requires_a_larger_non_centrality() -> None:
    """With equal probability a gain counts in full or by a quarter."""
    found = non_centrality(30.0, 1, 0.8, (1.0, 0.25))
    exceeds = stats.ncx2.sf([30.0, 120.0], 1, found)
    assert np.mean(exceeds) == pytest.approx(0.8, abs=1e-4)
    assert non_centrality(30.0, 1, 0.8, (0.5,)) == pytest.approx(non_centrality(60.0, 1, 0.8))


def test_detectable_strength_of_a_mass_is_that_of_a_regression() -> None:
    """Together with dry and viscous friction a mass is a third column."""
    v, a, _ = columns()
    found = powers()["inertia_leak"]
    for value, chance in ((found.found_80, 0.8), (found.found_95, 0.95)):
        wanted = np.sqrt(non_centrality(price(), 1, chance)) * NOISE_N
        assert value is not None
        # The noise is estimated from 2000 samples, to within a few percent.
        assert value * residual_norm(a) == pytest.approx(wanted, rel=0.03)
    assert found.found_80 is not None
    friction = DRY_N + VISCOUS_N_S_M * np.abs(v)
    share = found.found_80 * np.sqrt(np.mean(a**2) / np.mean(friction**2))
    assert found.share_80 == pytest.approx(share, rel=0.02)
    assert (found.parameter, found.unit) == ("m_e_kg", "kg")


@pytest.mark.parametrize("effect", ["sensor_offset", "sensor_drift", "viscous_asymmetry"])
def test_detectable_size_of_a_smooth_change_is_larger_than_in_white_noise(effect: str) -> None:
    """By 5 to 70 %, since coloured noise can absorb a part of it."""
    v, _, t = columns()
    changes = {"sensor_offset": np.ones(len(v)), "sensor_drift": t, "viscous_asymmetry": np.abs(v)}
    found = powers()[effect].found_80
    assert found is not None
    wanted = np.sqrt(non_centrality(price(), 1, 0.8)) * NOISE_N
    assert 1.05 * wanted < found * residual_norm(changes[effect]) < 1.7 * wanted


def test_effect_that_the_law_explains_has_no_detectable_strength() -> None:
    """At one speed a quadratic drag is equivalent to dry friction."""
    t = np.arange(0.0, 20.0, 0.02)
    records = []
    for k, way in enumerate((1.0, -1.0)):
        v = np.full(len(t), way * 0.1)
        noise = NOISE_N * np.random.default_rng(k).standard_normal(len(t))
        records.append(Run.from_arrays(t, v, 5.0 * np.sign(v) + noise, name=f"{k}"))
    (found,) = power(candidates(records), (), ["quadratic_drag"])
    assert (found.found_80, found.found_95, found.alone_80, found.share_80) == (None,) * 4
    assert found.like == ()
    assert found.hidden


def test_effect_is_hidden_if_its_usual_strength_is_not_detectable() -> None:
    tried = candidates(runs())
    for p in powers().values():
        model = strength_of(tried, (), p.effect)
        assert model is not None
        if model.page.null == 0.0:
            usual = float(model.usual[model.which])
            assert p.hidden == (p.found_80 is None or p.found_80 > usual), p
    hidden = [p for p in powers().values() if p.hidden]
    assert {p.found_80 is None for p in hidden} == {True, False}


def test_effects_with_the_same_signature_are_confounded() -> None:
    """Without rests a dry friction that differs by direction is an offset of the sensor."""
    offset, dry = powers()["sensor_offset"], powers()["dry_asymmetry"]
    assert offset.found_80 is not None
    assert (offset.alone_80, dry.alone_80) == (None, None)
    assert offset.like[0] == "dry_asymmetry"
    assert dry.like[0] == "sensor_offset"


def test_effect_with_a_unique_signature_is_distinguishable_as_soon_as_detectable() -> None:
    for name in ("stribeck_asymmetry", "sensor_hysteresis", "sensor_drift"):
        found = powers()[name]
        assert found.like == ()
        assert found.alone_80 == pytest.approx(found.found_80, rel=0.1)


def test_distinguishable_strength_is_that_of_a_regression_on_law_and_rival() -> None:
    """Viscous friction that differs by direction; the nearest rival differs in all friction."""
    found = powers()["viscous_asymmetry"]
    assert found.like[0] == "direction_asymmetry"
    v = columns()[0]
    change, friction = np.abs(v), DRY_N + VISCOUS_N_S_M * np.abs(v)
    alone = residual_norm(change) / NOISE_N
    apart = residual_norm(change, friction) / NOISE_N

    def lacking(strength: float) -> float:
        gains = stats.ncx2.sf(price(), 1, (strength * alone) ** 2)
        unexplained = strength * apart
        margin = (unexplained**2 - DEFAULT.tie) / (2.0 * unexplained)
        return float(gains * stats.norm.cdf(margin)) - 0.8

    expected = optimize.brentq(lacking, 0.05, 5.0)
    assert found.alone_80 == pytest.approx(expected, rel=0.05)
    assert found.alone_80 > 1.5 * found.found_80


def test_power_is_reported_for_effects_that_are_not_in_the_model() -> None:
    tried = candidates(runs(lambda t, v, a: coulomb(t, v, a) + 2.0 * a))
    found = power(tried, ("inertia_leak",))
    assert {p.effect for p in found} == set(tried.names) - {"inertia_leak"}
    (offset,) = power(tried, ("inertia_leak",), ["inertia_leak", "sensor_offset"])
    assert offset == next(p for p in found if p.effect == "sensor_offset")


def test_presliding_is_detectable_at_any_stiffness_if_the_runs_have_rests() -> None:
    records = []
    for k in range(3):
        t = np.arange(0.0, 20.0, 0.02)
        v = 0.1 * np.sin((0.6 + 0.2 * k) * t) * (np.mod(t, 6.0) > 2.0)
        noise = NOISE_N * np.random.default_rng(k).standard_normal(len(t))
        records.append(Run.from_arrays(t, v, coulomb(t, v, v) + noise, name=f"{k}"))
    found = {p.effect: p for p in power(candidates(records), (), ["presliding", "inertia_leak"])}
    assert found["presliding"].always
    assert not found["inertia_leak"].always


def test_diagnosis_reports_power_only_if_no_structure_is_unexplained() -> None:
    result = golden("bearing_coulomb_drag")
    names = {p.effect for p in result.power}
    assert "inertia_leak" in names
    assert "coulomb_drag" not in names
    row = next(r for r in result.to_dict()["power"] if r["effect"] == "inertia_leak")
    assert row["found_95"] > row["found_80"] > 0.0
    assert golden("bearing_hum").power == ()


@pytest.mark.extended
@pytest.mark.parametrize("effect", ["inertia_leak", "sensor_drift"])
def test_effect_of_the_detectable_strength_is_found_in_eighty_percent_of_campaigns(
    effect: str,
) -> None:
    value = powers()[effect].found_80
    assert value is not None

    def friction(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + value * (a if effect == "inertia_leak" else t)

    found, campaigns = 0, 60
    for seed in range(1, campaigns + 1):
        tried = candidates(runs(friction, seed))
        found += evidence(tried, tried.converge((effect,)), tried.converge(())) > 0.0
    low, high = stats.binom.ppf([0.0005, 0.9995], campaigns, 0.8)
    assert low <= found <= high
