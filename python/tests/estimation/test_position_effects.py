"""Friction and forces that depend on the position along the stroke."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from by_hand import Array
from jbf import Rig, Run, diagnose, fit
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem

STEP_S = 0.01
NOISE_N = 0.15
STROKE = "stroke_dependence"
Level = Callable[[Array], Array]


def slide(dry: Level, force: Level = np.zeros_like, count: int = 4) -> list[Run]:
    """Runs over 0.4 m, with a dry level and a force that are functions of the position (m)."""
    found = []
    for i in range(count):
        random = np.random.default_rng([4130, i])
        t = np.arange(0.0, 30.0, STEP_S)
        rate = 0.5 + 0.15 * i
        x = 0.2 + 0.16 * np.sin(rate * t) + 0.04 * np.sin(3.1 * rate * t + i)
        v = 0.16 * rate * np.cos(rate * t) + 0.124 * rate * np.cos(3.1 * rate * t + i)
        friction = np.sign(v) * dry(x) + 30.0 * v + force(x)
        noise = NOISE_N * random.standard_normal(len(t))
        found.append(Run.from_arrays(t, v, friction + noise, position_m=x, name=f"{i}"))
    return found


def test_fitted_stroke_dependence_predicts_the_friction_level_over_the_position() -> None:
    def level(x: Array) -> Array:
        found: Array = 6.0 + 1.2 * np.cos(np.pi * x / 0.4) + 0.5 * np.sin(2.0 * x / 0.4)
        return found

    model = fit(Rig(), slide(level, count=2), [STROKE], law="coulomb").model
    x = np.linspace(0.02, 0.38, 50)
    v = np.full(50, x[1] - x[0])
    run = Run.from_arrays(np.arange(50.0), v, position_m=x)
    np.testing.assert_allclose(model.predict(run), level(x) + 30.0 * v, atol=0.06)


def test_ends_of_the_stroke_are_taken_from_the_runs_and_not_fitted() -> None:
    runs = slide(lambda x: 6.0 + 2.0 * x, count=2)
    places = np.concatenate([np.asarray(r.position_m) for r in runs])
    found = fit(Rig(), runs, [STROKE], law="coulomb")
    # A tenth of the path is added at either end.
    wanted = {"x_0_m": 0.5 * (places.min() + places.max()), "h_m": 0.6 * np.ptp(places)}
    for name, value in wanted.items():
        p = found[f"{STROKE}.{name}"]
        assert (p.held, p.stderr) == (True, None)
        assert p.value == pytest.approx(value, abs=2e-3)
    assert found[f"{STROKE}.a_1"].stderr is not None
    campaign = Campaign.prepare(Rig(), runs)
    # Only the six coefficients are fitted; given ends are used.
    given = Problem(campaign, "coulomb", "journal", (STROKE,), {f"{STROKE}.x_0_m": 0.25})
    assert len(given.open) - len(Problem(campaign, "coulomb", "journal", ()).open) == 6
    assert given.fixed[f"{STROKE}.x_0_m"] == 0.25


@pytest.mark.extended
def test_tight_spot_is_diagnosed_as_stroke_dependence() -> None:
    """A bump and a slope, which are not among the waves of the effect."""
    runs = slide(lambda x: 6.0 + 1.5 * np.exp(-(((x - 0.3) / 0.08) ** 2)) - 2.0 * (x - 0.2))
    found = diagnose(Rig(), runs, law="coulomb")
    assert (found.verdict, found.effects) == ("missing", (STROKE,))
    assert found.steps[-1].rms_n == pytest.approx(NOISE_N, rel=0.05)
    assert found.steps[-1].holdout_rms_n == pytest.approx(NOISE_N, rel=0.05)
