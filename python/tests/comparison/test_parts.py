"""Attribution of the force to effects, as far as other parameters cannot replace it."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import LAW, coulomb, four_runs, there_and_back
from jbf import Comparison, Model, ParameterValue, Rig, Run, compare
from jbf.comparison.parts import (
    added_by,
    explained_residual,
    non_friction_effects,
    without,
)

Array = npt.NDArray[np.float64]
OFFSET = {"sensor_offset.b": 2.0}
DRIFT = {"sensor_drift.d": 0.5}
HELD_STATIC = {"F_s": ParameterValue(5.0, None, held=True)}


def model_of(effects: list[str], **values: ParameterValue | float) -> Model:
    """Coulomb's law with effects; breakaway force held at the Coulomb force."""
    return Model(Rig(), "coulomb", effects, {**LAW, **HELD_STATIC, **values})


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    """Coulomb and viscous friction with a sensor offset of 2 N and a sensor drift of 0.5 N/s."""
    return there_and_back(lambda t, v, a: coulomb(t, v, a) + 2.0 + 0.5 * t)


@pytest.fixture(scope="module")
def full(runs: list[Run]) -> Comparison:
    """The true model."""
    return compare(model_of(["sensor_offset", "sensor_drift"], **OFFSET, **DRIFT), runs)


def test_removal_of_an_effect_preserves_law_parameters_and_held_flags() -> None:
    held = {"F_c": ParameterValue(4.0, 0.25), "F_v": ParameterValue(9.0, None, held=True)}
    values = {"sensor_offset.b": 0.5, "sensor_drift.d": 0.01}
    model = Model(Rig(), "coulomb", ["sensor_offset", "sensor_drift"], {**held, **values})
    reduced = without(model, ["sensor_offset"])
    assert tuple(reduced.effects) == ("sensor_drift",)
    assert reduced.law == "coulomb"
    others = {n: p for n, p in model.parameters.items() if n != "sensor_offset.b"}
    assert dict(reduced.parameters) == others
    assert tuple(without(model, model.effects).effects) == ()


def test_force_of_an_offset_is_constant_and_force_of_a_drift_is_linear(full: Comparison) -> None:
    """The rate of 0.5 N/s does not depend on the instant to which the drift is relative."""
    names = (["sensor_drift"], ["sensor_offset"], full.model.effects)
    drift, offset, both = (added_by(full, effects) for effects in names)
    for i, p in enumerate(full.campaign.prepared):
        assert np.gradient(drift[i], p.run.time_s) == pytest.approx(np.full(501, 0.5))
        assert offset[i] == pytest.approx(np.full(501, 2.0))
        assert both[i] == pytest.approx(offset[i] + drift[i])


def test_effect_that_the_model_lacks_adds_no_force(full: Comparison) -> None:
    assert [a.tolist() for a in added_by(full, ["sensor_lag"])] == [[0.0] * 501] * 2
    assert added_by(full, ["sensor_offset", "sensor_lag"])[0] == pytest.approx(np.full(501, 2.0))


def test_inertia_adds_mass_times_acceleration(runs: list[Run]) -> None:
    heavy = compare(model_of(["inertia"], **{"inertia.m_e": 3.0}), runs)
    for added, p in zip(added_by(heavy, ["inertia"]), heavy.campaign.prepared, strict=True):
        mass_force = 3.0 * p.motion.acceleration
        assert added[5:-5] == pytest.approx(mass_force[5:-5], abs=1e-3)


def test_sensor_offset_and_drift_are_not_friction(full: Comparison) -> None:
    assert non_friction_effects(full) == ("sensor_offset", "sensor_drift")


def test_isolated_friction_excludes_offset_inertia_and_drift_but_not_lag() -> None:
    effects = ["sensor_offset", "inertia", "sensor_lag", "sensor_drift"]
    found = compare(Model(Rig(), "coulomb", effects), there_and_back(coulomb))
    assert set(non_friction_effects(found)) == {"sensor_offset", "inertia", "sensor_drift"}


def residual_of_least_squares(
    added: list[Array], columns: list[Array], counted: list[npt.NDArray[np.bool_]]
) -> list[Array]:
    """Residual of a least-squares fit of `columns` to `added` on the counted samples."""
    target = np.concatenate([a[c] for a, c in zip(added, counted, strict=True)])
    matrix = np.concatenate([w[c] for w, c in zip(columns, counted, strict=True)])
    coefficients = np.linalg.lstsq(matrix, target, rcond=None)[0]
    return [a - w @ coefficients for a, w in zip(added, columns, strict=True)]


@pytest.mark.parametrize("free", [("F_c", "F_v"), ("F_c",), ("F_v",)])
def test_explained_residual_excludes_the_part_that_free_parameters_reproduce(
    full: Comparison, runs: list[Run], free: tuple[str, ...]
) -> None:
    """The derivatives are sign(v) and v; held parameters and uncounted samples are excluded."""
    held = {n: ParameterValue(x, None, held=n not in free) for n, x in LAW.items()}
    before = compare(model_of([], **held), runs)
    masks = [np.arange(501) < 400, np.arange(501) >= 250]
    before = replace(before, samples=before.samples.within(masks))
    velocities = [p.motion.velocity for p in before.campaign.prepared]
    derivatives = {"F_c": [np.sign(v) for v in velocities], "F_v": velocities}
    columns = [np.column_stack(pair) for pair in zip(*(derivatives[n] for n in free), strict=True)]
    found = explained_residual(before, full)
    assert list(found) == ["sensor_offset", "sensor_drift"]
    for name, parts in found.items():
        expected = residual_of_least_squares(added_by(full, [name]), columns, masks)
        for part, reference in zip(parts, expected, strict=True):
            assert part == pytest.approx(reference, abs=5e-3)


def test_effects_of_both_compared_models_explain_no_part_of_the_residual(full: Comparison) -> None:
    without_effects = compare(model_of([]), [p.run for p in full.campaign.prepared])
    assert explained_residual(full, without_effects) == explained_residual(full, full) == {}


def test_force_attributed_to_an_effect_is_unchanged_by_a_parameter_without_influence() -> None:
    """With a warm-up of size zero the force does not depend on the time constant."""
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 0.5, noise_rms=0.01)
    idle = {"F_s": 6.0, **LAW, "warm_up.a": 0.0, "warm_up.tau_s": 30.0}
    before = Model(Rig(), "coulomb", ["warm_up"], idle)
    with_offset = {**idle, "sensor_offset.b": 0.5}
    after = Model(Rig(), "coulomb", ["warm_up", "sensor_offset"], with_offset)
    (parts,) = explained_residual(compare(before, runs), compare(after, runs)).values()
    for part in parts:
        assert np.mean(part) == pytest.approx(0.5, rel=0.05)
