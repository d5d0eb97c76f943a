"""Effects of simulated slides and joints: recovered by a fit and named by a diagnosis."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from golden import axis_run
from jbf import Model, Parameter, Rig, Run, diagnose, fit
from jbf.errors import InputError
from jbf.models.catalogue import built_in as catalogue
from rigsim import AXIS_EFFECTS, OF_TEMPERATURE, AxisRun, axis_campaign
from rigsim.warmth import REFERENCE_C

OF_DRIVES = [name for name, page in catalogue().items() if "journal" in page.refused]
REQUIRED: dict[str, tuple[str, ...]] = {
    "torque_proportional": ("gravity",),
    "cogging_2": ("cogging",),
    "pitch_ripple_2": ("pitch_ripple",),
}
"""Effects without which another effect has no influence."""
SWING = 8.0
"""Factor between the motion of a joint that carries a weight and that of a slide."""
FAST_FITS = (
    "gravity",
    "torque_proportional",
    "viscous_asymmetry",
    "zero_load_dependence",
    "viscous_temperature_dependence",
)


def _page(name: str) -> Parameter:
    effect, _, short = name.partition(".")
    return next(p for p in catalogue()[effect].parameters if p.name == short)


def _with_required(name: str) -> tuple[str, ...]:
    return (*REQUIRED.get(name, ()), name)


def _runs(records: list[AxisRun], path: str) -> list[Run]:
    return [axis_run(record, path) for record in records]


@cache
def _drive(seed: int, *effects: str) -> tuple[list[Run], dict[str, Any]]:
    """Runs of a simulated drive and its truth; a joint has an angle, a slide a position."""
    swing = SWING if "torque_proportional" in effects else 1.0
    records, truth = axis_campaign(seed, effects, swing=swing)
    joint = "gravity" in effects or seed % 2 == 0
    return _runs(records, "angle_rad" if joint else "position_m"), truth


def test_every_effect_of_drives_has_a_simulation() -> None:
    assert set(OF_DRIVES) <= set(AXIS_EFFECTS)


@pytest.mark.parametrize(
    "name",
    [n if n in FAST_FITS else pytest.param(n, marks=pytest.mark.extended) for n in OF_DRIVES],
)
def test_fit_with_the_true_effects_recovers_the_parameters(name: str) -> None:
    hidden = _with_required(name)
    runs, truth = _drive(11, *hidden)
    drawn = {
        f"{effect}.{page.name}": value
        for effect in hidden
        for page in catalogue()[effect].parameters
        for key, value in truth["effects"][effect].items()
        if page.name.startswith(key)
    }
    stated = {f"{name}.T_0_c": REFERENCE_C} if name in OF_TEMPERATURE else {}
    stated |= {n: v for n, v in drawn.items() if _page(n).stated}
    true = {n: v for n, v in drawn.items() if n not in stated}
    # Two waves may be exchanged unless they start at their own pitch.
    start = {n: v for n, v in true.items() if name.endswith("_2") and n.endswith("pitch_m")}
    fixed = {"F_s_n": 10.0, **stated}
    found = fit(Rig(), runs, hidden, law="coulomb", fixed=fixed, start=start)
    assert found.converged
    assert found.rms_n == pytest.approx(truth["noise_n"], rel=0.03)
    for parameter, value in stated.items():
        assert found[parameter].value == value
    periods = {n: _page(n).period for n in true}
    for parameter, value in {**truth["law"], **true}.items():
        estimate = found.parameters[parameter]
        assert estimate.stderr is not None, parameter
        error, period = estimate.value - value, periods.get(parameter)
        if period is not None:
            error -= period * np.round(error / period)
        assert abs(error) < 4.5 * estimate.stderr + 0.01 * abs(value), parameter


# No motion separates an asymmetry of a constant dry level from an offset.
@pytest.mark.extended
@pytest.mark.parametrize("name", [n for n in OF_DRIVES if n != "dry_asymmetry"])
def test_hidden_effect_of_a_drive_is_named_without_alternatives(name: str) -> None:
    hidden = _with_required(name)
    found = diagnose(Rig(), _drive(12, *hidden)[0], law="coulomb")
    assert (found.verdict, set(found.effects)) == ("missing", set(hidden))
    assert not any(found.alternatives.values())


@pytest.mark.extended
def test_running_in_of_a_drive_is_named_without_alternatives() -> None:
    records, truth = axis_campaign(16)
    law = truth["law"]
    assert isinstance(law, dict)
    for r in records:
        slid_m = np.cumsum(np.abs(r.velocity_m_s)) * 0.01
        r.force_n[:] += 0.3 * law["F_c_n"] * np.sign(r.velocity_m_s) * np.exp(-slid_m / 0.8)
    found = diagnose(Rig(), _runs(records, "angle_rad"), law="coulomb")
    assert (found.verdict, found.effects) == ("missing", ("wear_in",))
    assert found.alternatives == {"wear_in": ()}


def test_gear_losses_are_fitted_as_their_efficiency_ratio_and_a_scaled_weight() -> None:
    """Losses of 0.3 when driving and 0.1 when driven: the weight appears 1.1 times as large."""
    records, truth = axis_campaign(17, ("gravity",), swing=SWING)
    effects = truth["effects"]
    assert isinstance(effects, dict)
    gravity = effects["gravity"]
    for r in records:
        weight = gravity["G"] * np.sin(r.path - gravity["theta_0"])
        r.force_n[:] += np.where(weight * r.velocity_m_s > 0.0, 0.3, -0.1) * weight
    runs = _runs(records, "angle_rad")
    found = fit(Rig(), runs, _with_required("torque_proportional"), law="coulomb")
    assert found.rms_n == pytest.approx(truth["noise_n"], rel=0.03)
    share, weight_n = found["torque_proportional.mu"], found["gravity.G"]
    for estimate, value in ((share, 0.2 / 1.1), (weight_n, 1.1 * gravity["G"])):
        assert estimate.stderr is not None
        assert abs(estimate.value - value) < 4.5 * estimate.stderr + 0.01 * value
    ratio = (1.0 - share.value) / (1.0 + share.value)
    assert ratio == pytest.approx(0.9 / 1.3, rel=0.02)


def test_torque_proportional_friction_is_held_if_no_torque_is_transmitted() -> None:
    found = fit(Rig(), _drive(12)[0], ["torque_proportional"], law="coulomb")
    assert found["torque_proportional.mu"].held
    assert found["torque_proportional.mu"].stderr is None


def test_recorded_pressure_is_equivalent_to_a_load() -> None:
    name = "dry_load_dependence"
    runs, truth = _drive(13, name)
    pressed = [
        Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.friction_n,
            position_m=r.position_m,
            extra={"pressure_pa": 1e5 * np.asarray(r.load_n)},
            name=r.name,
        )
        for r in runs
    ]
    by_load, by_pressure = (
        fit(Rig(), some, [name], law="coulomb", fixed={"F_s_n": 10.0}) for some in (runs, pressed)
    )
    assert by_pressure[f"{name}.mu"].value == pytest.approx(by_load[f"{name}.mu"].value, rel=1e-6)
    assert by_load[f"{name}.mu"].value == pytest.approx(truth["effects"][name]["mu"], rel=0.05)


@pytest.mark.parametrize("name", OF_DRIVES)
def test_effect_of_drives_is_rejected_for_a_bearing(name: str) -> None:
    with pytest.raises(InputError, match="follows the load and the film"):
        Model(Rig.thesis(), effects=[name])
