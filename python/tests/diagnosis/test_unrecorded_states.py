"""Diagnoses of runs that start in a state that depends on the time before the recording."""

import jbf
import numpy as np
import numpy.typing as npt
import pytest

Array = npt.NDArray[np.float64]
STEP_S = 0.005
FINE_S = 2e-4
COULOMB_N, STIFFNESS_N_M, VISCOUS_N_S_M = 20.0, 6e4, 15.0


def bristle_force(position: Array, start_n: float) -> Array:
    """Dahl's friction along a path (Dahl 1968, exponent 1), exact for each increment, N."""
    force, now = np.empty_like(position), start_n
    for i, dx in enumerate(np.diff(position, prepend=position[0]).tolist()):
        limit = COULOMB_N if dx > 0.0 else -COULOMB_N
        now = limit + (now - limit) * float(np.exp(-STIFFNESS_N_M * abs(dx) / COULOMB_N))
        force[i] = now
    return force


def deflected_run(seed: int, start_n: float, late_s: float) -> jbf.Run:
    """Sines of two frequencies, with a force that is recorded late."""
    random = np.random.default_rng(seed)
    fine = np.arange(0.0, 7.0, FINE_S)
    rates, phases = random.uniform(1.5, 4.0, 2), random.uniform(0.0, 6.0, 2)
    sizes_m = random.uniform(0.001, 0.002, 2)
    position = sum(a * np.sin(w * fine + p) for a, w, p in zip(sizes_m, rates, phases, strict=True))
    force = bristle_force(position, start_n) + VISCOUS_N_S_M * np.gradient(position, FINE_S)
    t = np.arange(0.1, 6.9, STEP_S)
    # The history before the first reading is not recorded.
    reading = np.interp(t - late_s, fine, force) + random.normal(0.0, 0.2, len(t))
    path = np.round(np.interp(t, fine, position) + random.normal(0.0, 1.5e-6, len(t)), 6)
    return jbf.Run.from_arrays(t, None, reading, position_m=path, name=f"run_{seed}")


@pytest.mark.parametrize(
    ("law", "effects"),
    [pytest.param("dahl", (), marks=pytest.mark.extended), ("coulomb", ("presliding",))],
)
def test_start_of_a_run_is_excluded_if_the_contact_was_deflected_differently(
    law: str, effects: tuple[str, ...]
) -> None:
    runs = [deflected_run(k, start, 1.5 * STEP_S) for k, start in enumerate((0.0, -18.0, 18.0))]
    found = jbf.diagnose(jbf.Rig(), runs, law=law)
    assert found.effects == effects, found.summary()
    assert found.verdict in ("adequate", "missing"), found.summary()
    assert {"unsettled_start", "late_channel"} <= {f.kind for f in found.findings}
    last = found.steps[-1]
    assert last.held_out_rms < 1.05 * last.noise_rms
    assert found.fit.params["F_c"] == pytest.approx(COULOMB_N, rel=0.01)
    (stiffness,) = (found.fit.params[n] for n in found.fit.params if "sigma" in n)
    assert stiffness == pytest.approx(STIFFNESS_N_M, rel=0.03)


def test_exclusion_of_the_start_does_not_depend_on_a_delay_or_an_effect_of_long_memory() -> None:
    late_s = (0.0, 8.0 * STEP_S)
    punctual, late = (
        [deflected_run(k, start, delay) for k, start in enumerate((0.0, -18.0, 18.0))]
        for delay in late_s
    )
    usual = jbf.fit(jbf.Rig(), punctual, law="dahl").nobs
    assert usual < 3900
    assert jbf.fit(jbf.Rig(), late, law="dahl").nobs == pytest.approx(usual, abs=60)
    with_wear = jbf.fit(jbf.Rig(), punctual, ["running_in"], law="dahl")
    assert with_wear.nobs == pytest.approx(usual, abs=60)


@pytest.mark.parametrize(("law", "effects"), [("dahl", ()), ("coulomb", ("presliding",))])
def test_unknown_initial_deflection_does_not_bias_a_fit(law: str, effects: tuple[str, ...]) -> None:
    runs = [deflected_run(k, start, 0.0) for k, start in enumerate((0.0, -18.0, 18.0))]
    fitted = jbf.fit(jbf.Rig(), runs, effects, law=law).parameters
    stiffness = "presliding.sigma" if effects else "sigma_0"
    true = {"F_c": COULOMB_N, "F_v": VISCOUS_N_S_M, stiffness: STIFFNESS_N_M}
    for name, value in true.items():
        assert abs(fitted[name].value - value) < 4.0 * (fitted[name].stderr or 0.0), fitted[name]


GROWTH_N, GROWTH_S, GROWTH_EXPONENT, DECAY_M = 3.5, 5.0, 0.6, 6e-4


def started_run(seed: int, before_s: float) -> jbf.Run:
    """Moves of constant speed after rests; the contact rested for `before_s` before the run."""
    random = np.random.default_rng(seed)
    rest_s, t = before_s, np.arange(0.0, 40.0, 0.01)
    velocity, force = np.zeros(len(t)), np.full(len(t), 0.0)
    begin = 1.0
    while begin < 38.0:
        rest_s = rest_s + 1.0 if begin == 1.0 else rest_s
        end = begin + random.uniform(0.6, 1.5)
        moving = (t >= begin) & (t < end)
        speed = random.uniform(0.002, 0.01)
        velocity[moving] = speed
        slid_m = speed * (t[moving] - begin)
        age = 1.0 - np.exp(-((rest_s / GROWTH_S) ** GROWTH_EXPONENT))
        force[moving] = 6.0 + 90.0 * speed + GROWTH_N * age * np.exp(-slid_m / DECAY_M)
        rest_s = float(random.choice([0.3, 1.0, 5.0]))
        begin = end + rest_s
    reading = np.where(velocity > 0.0, force, 4.0) + random.normal(0.0, 0.1, len(t))
    return jbf.Run.from_arrays(t, velocity, reading, name=f"run_{seed}")


def test_unknown_rest_before_a_run_does_not_bias_the_growth_of_the_static_friction() -> None:
    runs = [started_run(seed, 60.0) for seed in range(4)]
    fitted = jbf.fit(jbf.Rig(), runs, ["dwell_stiction"], law="coulomb").parameters
    true = {"a": GROWTH_N, "t_0_s": GROWTH_S, "m": GROWTH_EXPONENT, "s_0": DECAY_M}
    for name, value in true.items():
        parameter = fitted[f"dwell_stiction.{name}"]
        assert abs(parameter.value - value) < 4.0 * (parameter.stderr or 0.0), (name, parameter)
