"""Friction and forces that depend on the place: along the stroke, and in more than one wave."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from jbf import Model, Rig, Run, diagnose, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.estimation.stroke import stroke
from jbf.models.catalogue import may_come, may_go

STEP_S = 0.01
NOISE_N = 0.15
STROKE = "stroke_dependence"


def slide(dry, push=lambda x: 0.0 * x, seed: int = 4130) -> list[Run]:  # type: ignore[no-untyped-def]
    """Runs of a slide over 0.4 m, its dry level and a push functions of the place, m."""
    found = []
    for i in range(4):
        rng = np.random.default_rng([seed, i])
        t = np.arange(0.0, 30.0, STEP_S)
        rate = 0.5 + 0.15 * i
        x = 0.2 + 0.16 * np.sin(rate * t) + 0.04 * np.sin(3.1 * rate * t + i)
        v = 0.16 * rate * np.cos(rate * t) + 0.124 * rate * np.cos(3.1 * rate * t + i)
        force = np.sign(v) * dry(x) + 30.0 * v + push(x)
        force = force + NOISE_N * rng.standard_normal(len(t))
        found.append(Run.from_arrays(t, v, force, position_m=x, name=f"{i}"))
    return found


def test_a_tight_spot_is_friction_along_the_stroke() -> None:
    """Not one of the waves that the effect is made of: a bump, and a slope."""
    some = slide(lambda x: 6.0 + 1.5 * np.exp(-(((x - 0.3) / 0.08) ** 2)) - 2.0 * (x - 0.2))
    found = diagnose(Rig(), some, law="coulomb")
    assert (found.verdict, found.effects) == ("missing", (STROKE,))
    assert found.steps[-1].rms_n == pytest.approx(NOISE_N, rel=0.05)
    assert found.steps[-1].holdout_rms_n == pytest.approx(NOISE_N, rel=0.05)


def test_level_over_the_place_comes_back() -> None:
    def level(x):  # type: ignore[no-untyped-def]
        return 6.0 + 1.2 * np.cos(np.pi * (x / 0.4)) + 0.5 * np.sin(2.0 * x / 0.4)

    model = fit(Rig(), slide(level), [STROKE], law="coulomb").model
    x = np.linspace(0.02, 0.38, 50)
    v = np.full(50, x[1] - x[0])
    run = Run.from_arrays(np.arange(50.0), v, position_m=x)
    np.testing.assert_allclose(model.predict(run), level(x) + 30.0 * v, atol=0.05)


def test_the_ends_are_those_of_the_runs_and_no_fit_moves_them(tmp_path: Path) -> None:
    some = slide(lambda x: 6.0 + 2.0 * x)
    low, high = stroke(Campaign.prepare(Rig(), some))
    places = np.concatenate([r.position_m for r in some])
    tenth = 0.1 * np.ptp(places)
    assert low == pytest.approx(places.min() - tenth, abs=2e-3)
    assert high == pytest.approx(places.max() + tenth, abs=2e-3)
    found = fit(Rig(), some, [STROKE], law="coulomb")
    for name, value in (("x_0_m", 0.5 * (low + high)), ("h_m", 0.5 * (high - low))):
        p = found[f"{STROKE}.{name}"]
        assert p.held
        assert p.stderr is None
        assert p.value == pytest.approx(value)
        assert "runs" in str(p.note)
    assert found[f"{STROKE}.a_1"].stderr is not None
    found.model.save(tmp_path / "m.toml")
    read = Model.load(tmp_path / "m.toml")
    assert read.parameters == found.model.parameters


def test_ends_that_are_given_are_kept() -> None:
    held = {f"{STROKE}.x_0": 0.25, f"{STROKE}.h": 0.3}
    found = fit(Rig(), slide(lambda x: 6.0 + 2.0 * x), [STROKE], law="coulomb", fixed=held)
    assert found[f"{STROKE}.x_0"].value == 0.25
    assert found[f"{STROKE}.h"].value == 0.3


def test_only_what_is_fitted_has_a_price() -> None:
    campaign = Campaign.prepare(Rig(), slide(lambda x: 6.0 + 0.0 * x))
    bare, with_it = (Problem(campaign, "coulomb", "journal", e) for e in ((), (STROKE,)))
    assert len(with_it.open) - len(bare.open) == 6


def wave(x, pitch_m: float, phase: float):  # type: ignore[no-untyped-def]
    return np.sin(2.0 * np.pi * x / pitch_m - phase)


def test_a_harmonic_of_the_cogging_is_found_beside_it() -> None:
    some = slide(
        lambda x: 6.0 + 0.0 * x, lambda x: 0.8 * wave(x, 0.02, 1.0) + 0.3 * wave(x, 0.01, 0.2)
    )
    found = diagnose(Rig(), some, law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("cogging", "cogging_2"))
    parameters = found.fit.parameters
    pitches = sorted(parameters[f"{e}.pitch_m"].value for e in found.effects)
    assert pitches == pytest.approx([0.01, 0.02], rel=1e-3)


def test_one_wave_alone_has_no_second() -> None:
    some = slide(lambda x: 6.0 + 0.0 * x, lambda x: 0.8 * wave(x, 0.02, 1.0))
    found = diagnose(Rig(), some, law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("cogging",))
    assert found.alternatives == {"cogging": ()}


def test_a_pitch_comes_again_on_the_way() -> None:
    campaign = Campaign.prepare(Rig(), slide(lambda x: 6.0 + 0.0 * x))
    page = Problem(campaign, "coulomb", "journal", ("cogging",)).parameters["cogging.pitch_m"]
    span = float(np.ptp(np.concatenate([p.run.position_m for p in campaign.prepared])))
    assert page.upper == pytest.approx(span / 4.0, rel=0.02)


def test_a_further_effect_comes_after_the_first_and_goes_before_it() -> None:
    assert not may_come("cogging_2", ("gravity",))
    assert may_come("cogging_2", ("cogging",))
    assert may_come("cogging", ())
    assert not may_go("cogging", ("cogging", "cogging_2"))
    assert may_go("cogging", ("cogging", "pitch_ripple"))
    assert may_go("cogging_2", ("cogging", "cogging_2"))
