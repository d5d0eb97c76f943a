"""Predictions of the journal-bearing law against reference values; steady friction; refusals."""

import warnings
from pathlib import Path

import jbf
import numpy as np
import pytest
import rigsim
from jbf import Model, Rig, Run
from jbf.models.catalogue import effects
from rigsim.warmth import REFERENCE_C

TABLE_4_2 = {"f_m": 0.26, "U_tr": 0.06, "K0": 7.5e5, "gamma": 33.0}

# Time (s) and friction coefficient for U = 0.127 sin(t), thesis clock, order 8 at rtol 1e-13.
REFERENCE = [
    (0.0628318530717959, 0.00184398115947),
    (0.125663706143592, 0.005914401230398),
    (0.188495559215388, 0.01111386120857),
    (0.251327412287183, 0.016243532861),
]


def sine_run(duration_s: float = 12.0, load_n: float | None = 104.0) -> Run:
    """A noise-free reversing sine with a small sampling interval."""
    t = np.arange(0.0, duration_s, 0.002)
    angle = 0.127 * (1.0 - np.cos(t)) / 0.0127
    load = None if load_n is None else np.full(len(t), load_n)
    return Run.from_arrays(t, 0.127 * np.sin(t), angle_rad=angle, load_n=load)


def test_journal_prediction_agrees_with_an_integration_of_order_eight() -> None:
    run = sine_run()
    force = Model(Rig.thesis(), parameters=TABLE_4_2, clock="thesis").predict(run)
    for time, f in REFERENCE:
        assert np.interp(time, run.time_s, force) / 104.0 == pytest.approx(f, abs=2e-5)


def test_prediction_uses_the_recorded_load_and_otherwise_that_of_the_rig() -> None:
    heavy, light = (Model(Rig.thesis(table), parameters=TABLE_4_2) for table in ("4.2", "4.3"))
    expected = heavy.predict(sine_run())
    np.testing.assert_allclose(light.predict(sine_run()), expected, rtol=1e-9, atol=1e-9)
    light_force = light.predict(sine_run(load_n=None))
    np.testing.assert_array_equal(light_force, light.predict(sine_run(load_n=83.5)))
    assert not np.allclose(light_force, expected, rtol=1e-2)


def test_steady_friction_of_a_bearing_agrees_with_reference_values_and_is_odd() -> None:
    speeds = [0.001, 0.02, 0.127, -0.02]
    f = Model(Rig.thesis(), parameters=TABLE_4_2).steady_friction(speeds) / 104.0
    np.testing.assert_allclose(f[:2], [0.21635118264163442, 0.05782937675212433], rtol=1e-9)
    assert f[2] == pytest.approx(0.0086, abs=1e-4)
    assert f[3] == -f[1]


def test_model_predicts_the_same_bits_after_saving_and_loading(tmp_path: Path) -> None:
    values = TABLE_4_2 | {"presliding.sigma": 1234.5678901234567, "sensor_lag.tau": 0.1 + 0.2}
    model = Model(Rig.thesis(), effects=["sensor_lag", "presliding"], parameters=values)
    model.save(tmp_path / "m.toml")
    again = Model.load(tmp_path / "m.toml")
    assert again == model
    np.testing.assert_array_equal(model.predict(sine_run()), again.predict(sine_run()))


def test_effects_of_a_model_are_sorted_in_the_order_of_the_signal_chain() -> None:
    model = Model(Rig.thesis(), effects=["sensor_lag", "coulomb_drag", "drive_compliance"])
    assert model.effects == ("drive_compliance", "coulomb_drag", "sensor_lag")


STAGES = ("drive", "lubricant", "film", "contact", "other friction", "instrument")


def test_catalogue_effects_are_in_chain_order_and_cover_every_stage() -> None:
    stages = [STAGES.index(effect.stage) for effect in effects().values()]
    assert stages == sorted(stages)
    assert set(stages) == set(range(len(STAGES)))


def test_catalogue_effects_are_documented_and_have_starting_values_within_bounds() -> None:
    for effect in effects().values():
        assert all((effect.equation, effect.source, effect.limits, effect.parameters)), effect.name
        for p in effect.parameters:
            assert p.lower < p.upper
            assert all(p.lower <= s <= p.upper for s in p.starts)


def test_prediction_warns_and_stays_finite_if_the_film_responds_too_fast() -> None:
    run = sine_run(duration_s=1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Model(Rig.thesis("4.2"), parameters=TABLE_4_2).predict(run)
    # The transition speed is a thousand times the maximum recorded speed.
    fast = Model(Rig.thesis("4.2"), parameters={**TABLE_4_2, "U_tr": 100.0})
    with pytest.warns(jbf.FilmWarning, match="U_tr_m_s, K0 and the load"):
        assert np.all(np.isfinite(fast.predict(run)))


def simulated(
    effects: dict[str, dict[str, float]], motion: rigsim.Motion, celsius: float | None
) -> tuple[Run, np.ndarray]:
    """A run without noise and its friction (N), from the independent simulator."""
    warmth = None if celsius is None else rigsim.Warmth(celsius, rise_k=20.0, tau_s=4.0)
    load_n = 83.5 if "load_dependence" in effects else None
    record = rigsim.simulate_run(
        rigsim.Base(), effects, motion, rate_hz=200.0, warmth=warmth, load_n=load_n
    )
    run = Run.from_arrays(
        record.time_s,
        record.velocity,
        angle_rad=record.angle_rad,
        load_n=record.load_n,
        temperature_c=record.temperature_c,
    )
    return run, record.clean_friction_n


SINE = rigsim.sine("sine", 8.0, 0.127, 1.0)
STOPS = rigsim.stop_and_go("stops", [(0.5, 1), (5.0, -1)], 0.05, 0.5, 1.0, 9.0)
EVENTS = ("drive_compliance", "backlash")
"""Effects with jumps of the force, at which jbf and the simulator differ within one sample."""


@pytest.mark.parametrize("effect", [None, *rigsim.CATALOGUE])
def test_prediction_with_each_effect_agrees_with_the_simulator(effect: str | None) -> None:
    values = {name: getattr(rigsim.Base(), name) for name in TABLE_4_2}
    hidden: dict[str, dict[str, float]] = {}
    if effect is not None:
        hidden = {effect: rigsim.draw(effect, np.random.default_rng(5))}
        values |= {f"{effect}.{name}": value for name, value in hidden[effect].items()}
    celsius = 18.0 if effect == "vogel_viscosity" else None
    if celsius is not None:
        values["vogel_viscosity.T_0"] = REFERENCE_C
    motion = STOPS if effect == "dwell_stiction" else SINE
    run, friction = simulated(hidden, motion, celsius)
    model = Model(Rig.thesis("4.2"), effects=list(hidden), parameters=values)
    _, bare = simulated({}, motion, None)
    change = np.sqrt(np.mean((friction - bare) ** 2))
    error = np.sqrt(np.mean((model.predict(run) - friction) ** 2))
    assert error < 1e-5 + (0.1 if effect in EVENTS else 0.003) * change
    assert effect is None or change > 0.02


MEMORYLESS_EFFECTS = (
    "gravity", "cogging", "position_ripple", "stroke_dependence", "dry_asymmetry", "quadratic_drag",
)  # fmt: skip


@pytest.mark.parametrize("effect", MEMORYLESS_EFFECTS)
def test_prediction_of_a_memoryless_effect_is_independent_of_earlier_samples(effect: str) -> None:
    t = np.arange(0.0, 4.0, 0.01)
    angle, speed = 0.4 * np.sin(2.0 * t), 0.8 * np.cos(2.0 * t)
    values = {f"{effect}.{p.name}": p.starts[0] for p in jbf.effects()[effect].parameters}
    model = Model(Rig(), "coulomb", [effect], {"F_c": 5.0, "F_v": 8.0} | values)
    path = {"position_m": angle} if effect == "stroke_dependence" else {"angle_rad": angle}
    # The smoothed speed at the ends of a run differs by about 1e-6.
    whole = model.predict(Run.from_arrays(t, speed, **path))
    for first in (1, 57, 200):
        part = Run.from_arrays(t[first:], speed[first:], **{k: v[first:] for k, v in path.items()})
        np.testing.assert_allclose(model.predict(part), whole[first:], rtol=1e-4)
