"""How strong an effect must be for runs to show it: by closed forms, and by counting."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from by_hand import Array, coulomb, one_way
from jbf import Rig, Run, diagnose
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import evidence, price_of
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.diagnosis.power import Power, non_centrality, power
from jbf.diagnosis.strength import RunsAtHand, strength_of
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from scipy import stats

NOISE_N = 0.1
Friction = Callable[[Array, Array, Array], Array]


def runs(friction: Friction = coulomb, seed: int = 0) -> list[Run]:
    return [
        one_way(f"{k}", friction, way=way, rate=rate, noise_n=NOISE_N, seed=4 * seed + k)
        for k, (way, rate) in enumerate([(1.0, 0.7), (-1.0, 1.3), (1.0, 2.1), (-1.0, 4.0)])
    ]


def candidates(some: list[Run], policy: Policy = DEFAULT) -> Candidates:
    return Candidates(Campaign.prepare(Rig(), some), "coulomb", "journal", policy)


def of(found: tuple[Power, ...], name: str) -> Power:
    return next(p for p in found if p.effect == name)


@pytest.mark.parametrize("parameters", [1, 2, 4])
@pytest.mark.parametrize("chance", [0.8, 0.95])
def test_a_chi_square_of_that_non_centrality_exceeds_the_price_so_often(
    parameters: int, chance: float
) -> None:
    root = non_centrality(30.0, parameters, chance)
    shift = np.zeros(parameters)
    shift[0] = np.sqrt(root)
    drawn = np.random.default_rng(1).standard_normal((40_000, parameters)) + shift
    assert np.mean(np.sum(drawn**2, axis=1) > 30.0) == pytest.approx(chance, abs=0.01)


def test_a_gain_that_may_count_for_less_must_be_larger() -> None:
    counts = (1.0, 0.9, 0.6, 0.4)
    root = non_centrality(30.0, 1, 0.8, counts)
    random = np.random.default_rng(1)
    gains = (random.standard_normal(40_000) + np.sqrt(root)) ** 2 * random.choice(counts, 40_000)
    assert np.mean(gains > 30.0) == pytest.approx(0.8, abs=0.01)
    assert non_centrality(30.0, 1, 0.8, (0.5,)) == pytest.approx(non_centrality(60.0, 1, 0.8))


def test_the_strength_of_a_mass_is_that_of_a_regression() -> None:
    """Beside dry and viscous friction a mass is a third column: its error is in every textbook."""
    some = runs()
    tried = candidates(some)
    found = of(power(tried, (), ["inertia_leak"]), "inertia_leak")
    v = np.concatenate([run.velocity_m_s for run in some])
    a = np.concatenate([np.gradient(run.velocity_m_s, run.time_s) for run in some])
    design = np.column_stack([np.sign(v), v])
    left = a - design @ np.linalg.lstsq(design, a, rcond=None)[0]
    for value, chance in ((found.found_80, 0.8), (found.found_95, 0.95)):
        wanted = np.sqrt(non_centrality(price_of(tried, 1), 1, chance)) * NOISE_N
        assert value * np.sqrt(left @ left) / wanted == pytest.approx(1.0, abs=0.03)
    assert found.unit == "kg"
    friction = np.concatenate([coulomb(run.time_s, run.velocity_m_s, v) for run in some[:1]])
    assert found.share_80 == pytest.approx(
        found.found_80 * np.sqrt(np.mean(a**2)) / np.sqrt(np.mean(friction**2)), rel=0.1
    )


def test_a_slow_change_must_be_larger_for_the_noise_may_have_it() -> None:
    """A drift within a run passes in part for coloured noise, once it is large enough for that:
    it is no mere third column."""
    some = runs()
    tried = candidates(some, Policy(false_alarms=1e-7))
    value = of(power(tried, (), ["sensor_drift"]), "sensor_drift").found_80
    v = np.concatenate([run.velocity_m_s for run in some])
    t = np.concatenate([run.time_s for run in some])
    design = np.column_stack([np.sign(v), v])
    left = t - design @ np.linalg.lstsq(design, t, rcond=None)[0]
    wanted = np.sqrt(non_centrality(price_of(tried, 1), 1, 0.8)) * NOISE_N
    assert value is not None
    assert 1.2 < value * np.sqrt(left @ left) / wanted < 1.7


@pytest.mark.parametrize("effect", ["inertia_leak", "sensor_drift"])
def test_so_many_campaigns_show_it(effect: str) -> None:
    value = of(power(candidates(runs()), (), [effect]), effect).found_80
    assert value is not None

    def friction(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + value * (a if effect == "inertia_leak" else t)

    shown = 0
    campaigns = 24
    for seed in range(1, campaigns + 1):
        tried = candidates(runs(friction, seed))
        shown += evidence(tried, tried.converge((effect,)), tried.converge(())) > 0.0
    # Eighty of a hundred, as two dozen campaigns can tell (99.9 %).
    low, high = stats.binom.ppf([0.0005, 0.9995], campaigns, 0.8)
    assert low <= shown <= high


def test_what_the_law_makes_up_for_is_never_found() -> None:
    t = np.arange(0.0, 20.0, 0.02)
    some = []
    for k, way in enumerate((1.0, -1.0)):
        v = np.full(len(t), way * 0.1)
        noise = NOISE_N * np.random.default_rng(k).standard_normal(len(t))
        some.append(Run.from_arrays(t, v, 5.0 * np.sign(v) + noise, name=f"{k}"))
    found = of(power(candidates(some), (), ["quadratic_drag"]), "quadratic_drag")
    # At one speed a drag is dry friction.
    assert found.found_80 is None
    assert found.alone_80 is None
    assert found.like == ()


def test_two_effects_that_are_one_in_these_runs() -> None:
    """Without rests a dry level that differs by direction is a zero that is off."""
    found = power(candidates(runs()), ())
    offset, dry = of(found, "sensor_offset"), of(found, "dry_asymmetry")
    assert offset.found_80 is not None
    assert offset.alone_80 is None
    assert "dry_asymmetry" in offset.like
    assert "sensor_offset" in dry.like
    assert dry.alone_80 is None
    # No other effect of the catalogue has a peak at one end of these speeds.
    peak = of(found, "stribeck_asymmetry")
    assert peak.alone_80 == pytest.approx(peak.found_80, rel=0.2)


def stop_and_go() -> list[Run]:
    some = []
    for k in range(3):
        t = np.arange(0.0, 20.0, 0.02)
        v = 0.1 * np.sin((0.6 + 0.2 * k) * t) * (np.mod(t, 6.0) > 2.0)
        noise = NOISE_N * np.random.default_rng(k).standard_normal(len(t))
        some.append(Run.from_arrays(t, v, coulomb(t, v, v) + noise, name=f"{k}"))
    return some


def test_samples_beside_jumps_that_an_effect_moves_show_less() -> None:
    tried = candidates(stop_and_go())
    delay = strength_of(tried, (), "time_delay")
    assert delay is not None
    runs_at_hand = RunsAtHand(tried, ())
    changes = runs_at_hand.change(delay, 1.0)
    weights = delay.problem.samples_at(delay.values(1.0)).weight
    whole = [
        f - now
        for f, now in zip(delay.problem.predict(delay.values(1.0)), runs_at_hand.now, strict=True)
    ]
    less = 0
    for change, gap, w in zip(changes, whole, weights, strict=True):
        np.testing.assert_allclose(change[w == 1.0], gap[w == 1.0])
        beside = (w < 0.9) & (gap != 0.0)
        assert np.all(np.abs(change[beside]) < np.abs(gap[beside]))
        less += int(beside.sum())
    assert less > 10


def test_a_contact_that_holds_at_rest_shows_however_stiff_it_is() -> None:
    found = power(candidates(stop_and_go()), ())
    assert of(found, "presliding").always
    assert not of(found, "inertia_leak").always


def test_a_diagnosis_says_it_where_nothing_remains() -> None:
    d = diagnose(Rig(), runs(lambda t, v, a: coulomb(t, v, a) + 2.0 * a), law="coulomb")
    assert d.effects == ("inertia_leak",)
    names = [p.effect for p in d.power]
    assert "quadratic_drag" in names
    assert "inertia_leak" not in names
    text = d.summary()
    assert "What these runs would have shown" in text
    (row,) = [r for r in d.to_dict()["power"] if r["effect"] == "quadratic_drag"]
    assert row["unit"] == "N s^2/m^2"
    assert row["found_95"] > row["found_80"] > 0.0

    def unknown(t: Array, v: Array, a: Array) -> Array:
        return coulomb(t, v, a) + np.sin(40.0 * t)

    assert diagnose(Rig(), runs(unknown), law="coulomb").power == ()


def test_all_sizes_of_an_effect_grow_together() -> None:
    """Six knots of one curve: the curve grows, not one of its knots."""
    tried = candidates(runs())
    problem = Problem(tried.campaign, "coulomb", "journal", ("stroke_dependence",))
    pages = list(problem.parameters.values())
    sizes = tuple(
        i for i, name in enumerate(problem.names) if ".a_" in name and pages[i].null is not None
    )
    found = strength_of(tried, (), "stroke_dependence")
    assert found is not None
    assert (len(sizes), found.sizes) == (6, sizes)
    twice = found.values(2.0)
    for i, page in enumerate(pages):
        known = 2.0 * found.usual[i] if i in sizes else found.usual[i]
        assert twice[i] == pytest.approx(np.clip(known, page.lower, page.upper)), page.name


def swings(beside_s: float) -> list[Run]:
    """Motions that turn round between two samples, but for one, which is read so long after."""
    found = []
    for k, period in enumerate((4.0, 2.4)):
        t = 0.01 + 0.02 * np.arange(1000)
        if k == 0:
            t[np.searchsorted(t, 10.0)] = 10.0 + beside_s
        v = 0.1 * np.sin(2.0 * np.pi * t / period)
        noise = NOISE_N * np.random.default_rng(k).standard_normal(len(t))
        found.append(Run.from_arrays(t, v, coulomb(t, v, v) + noise, name=f"{k}"))
    return found


def test_one_sample_beside_a_reversal_is_no_evidence_of_a_lag() -> None:
    """A lag of half a millisecond shows in that sample alone: nobody would name it for that."""
    usual, beside = (
        of(power(candidates(swings(after)), (), ["sensor_lag"]), "sensor_lag").found_80
        for after in (0.01, 0.0005)
    )
    assert usual is not None
    assert beside == pytest.approx(usual, rel=0.3)
