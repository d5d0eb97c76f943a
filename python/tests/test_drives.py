"""Drives, slides and joints from a simulator of their own: what is in them comes back, and is named
alone."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from jbf import Model, Parameter, Rig, Run, diagnose, fit
from jbf.errors import InputError
from jbf.models.catalogue import built_in as catalogue
from rigsim import AXIS_EFFECTS, OF_TEMPERATURE, AxisRun, axis_campaign
from rigsim.warmth import REFERENCE_C

OF_DRIVES = [name for name, page in catalogue().items() if "journal" in page.refused]
COULOMB: dict[str, Any] = {"law": "coulomb"}


COMPANY: dict[str, tuple[str, ...]] = {
    "torque_proportional": ("gravity",),
    "cogging_2": ("cogging",),
    "pitch_ripple_2": ("pitch_ripple",),
}
"""What must be hidden beside an effect for it to show."""
SWING = 8.0
"""So much wider than a slide a joint swings whose weight the drive carries."""


def catalogue_page(name: str) -> Parameter:
    effect, _, short = name.partition(".")
    return next(p for p in catalogue()[effect].parameters if p.name == short)


def hidden_with(name: str) -> tuple[str, ...]:
    return (*COMPANY.get(name, ()), name)


@cache
def drive(seed: int, *effects: str, strength: float = 1.0) -> tuple[list[Run], dict[str, Any]]:
    """Runs of a simulated drive, and the truth. A joint has an angle, a slide a position."""
    swing = SWING if "torque_proportional" in effects else 1.0
    records, truth = axis_campaign(seed, effects, strength=strength, swing=swing)
    joint = "gravity" in effects or seed % 2 == 0
    return joints(records) if joint else slides(records), truth


def joints(records: list[AxisRun]) -> list[Run]:
    return [
        Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.force_n,
            angle_rad=r.path,
            load_n=r.load_n,
            temperature_c=r.temperature_c,
            name=r.name,
        )
        for r in records
    ]


def slides(records: list[AxisRun]) -> list[Run]:
    return [
        Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.force_n,
            position_m=r.path,
            load_n=r.load_n,
            temperature_c=r.temperature_c,
            name=r.name,
        )
        for r in records
    ]


def test_the_simulator_has_a_form_of_its_own_of_each() -> None:
    assert set(OF_DRIVES) <= set(AXIS_EFFECTS)


@pytest.mark.parametrize("name", OF_DRIVES)
def test_the_right_structure_recovers_the_truth(name: str) -> None:
    hidden = hidden_with(name)
    runs, truth = drive(11, *hidden)
    told = {
        f"{effect}.{page.name}": v
        for effect in hidden
        for page in catalogue()[effect].parameters
        for k, v in truth["effects"][effect].items()
        if page.name.startswith(k)
    }
    # The reference of the simulator's own law, so that the law's levels mean the same.
    stated = {f"{name}.T_0_c": REFERENCE_C} if name in OF_TEMPERATURE else {}
    stated |= {n: v for n, v in told.items() if catalogue_page(n).stated}
    true = {n: v for n, v in told.items() if n not in stated}
    # Which of two waves is the first is a matter of where each starts.
    pitches = {n: v for n, v in true.items() if name.endswith("_2") and n.endswith("pitch_m")}
    held = {"F_s_n": 10.0, **stated}
    found = fit(Rig(), runs, hidden, fixed=held, start=pitches, **COULOMB)
    assert found.converged
    assert found.rms_n == pytest.approx(truth["noise_n"], rel=0.03)
    wanted = {**truth["law"], **true}
    for parameter, value in stated.items():
        assert found[parameter].value == value
    periods = {n: catalogue_page(n).period for n in true}
    for parameter, value in wanted.items():
        p = found.parameters[parameter]
        assert p.stderr is not None, parameter
        off, period = p.value - value, periods.get(parameter)
        if period is not None:
            off -= period * np.round(off / period)
        assert abs(off) < 4.5 * p.stderr + 0.01 * abs(value), parameter


# Of a dry level that nothing changes no motion tells an asymmetry from a zero: see test_directions.
@pytest.mark.parametrize("name", [n for n in OF_DRIVES if n != "dry_asymmetry"])
def test_it_is_named_alone(name: str) -> None:
    hidden = hidden_with(name)
    runs, _ = drive(12, *hidden)
    found = diagnose(Rig(), runs, **COULOMB)
    assert (found.verdict, set(found.effects)) == ("missing", set(hidden))
    assert all(not others for others in found.alternatives.values())


@pytest.mark.parametrize("seed", [12, 13, 14])
def test_of_a_drive_that_lacks_nothing_nothing_is_named(seed: int) -> None:
    runs, _ = drive(seed)
    found = diagnose(Rig(), runs, **COULOMB)
    assert (found.verdict, found.effects) == ("adequate", ())


def test_level_and_zero_that_grow_with_the_load_are_found_together() -> None:
    both = {"dry_load_dependence", "zero_load_dependence"}
    runs, _ = drive(15, *sorted(both))
    found = diagnose(Rig(), runs, **COULOMB)
    assert found.verdict == "missing"
    assert set(found.effects) == both


def test_a_zero_that_grows_with_the_load_is_no_scatter_of_the_runs() -> None:
    records, truth = axis_campaign(101008, ("zero_load_dependence",), runs=8)
    found = diagnose(Rig(), joints(records[:6]), **COULOMB)
    assert (found.verdict, found.effects) == ("missing", ("zero_load_dependence",))
    assert not [f for f in found.findings if f.kind == "level_by_run"]
    assert found.steps[-1].rms_n == pytest.approx(truth["noise_n"], rel=0.05)


def test_a_weight_alone_is_not_taken_for_what_a_gear_loses() -> None:
    records, _ = axis_campaign(14, ("gravity",), swing=SWING)
    found = diagnose(Rig(), joints(records), **COULOMB)
    assert (found.verdict, found.effects) == ("missing", ("gravity",))


def test_running_in_is_not_taken_for_warming() -> None:
    records, truth = axis_campaign(16)
    for r in records:
        slid = np.cumsum(np.abs(r.velocity_m_s)) * 0.01
        r.force_n[:] += 0.3 * truth["law"]["F_c_n"] * np.sign(r.velocity_m_s) * np.exp(-slid / 0.8)
    found = diagnose(Rig(), joints(records), **COULOMB)
    assert (found.verdict, found.effects) == ("missing", ("wear_in",))
    assert found.alternatives == {"wear_in": ()}


def test_what_driving_loses_more_than_being_driven_back_is_in_the_weight() -> None:
    """Efficiencies of 1/1.3 and 0.9: the fit finds their product, and the weight times 1.1."""
    records, truth = axis_campaign(17, ("gravity",), swing=SWING)
    hung = truth["effects"]["gravity"]
    for r in records:
        weight = hung["G"] * np.sin(r.path - hung["theta_0"])
        r.force_n[:] += np.where(weight * r.velocity_m_s > 0.0, 0.3, -0.1) * weight
    found = fit(Rig(), joints(records), hidden_with("torque_proportional"), **COULOMB)
    assert found.rms_n == pytest.approx(truth["noise_n"], rel=0.03)
    share, weight_n = found["torque_proportional.mu"], found["gravity.G"]
    for p, value in ((share, 0.2 / 1.1), (weight_n, 1.1 * hung["G"])):
        assert p.stderr is not None
        assert abs(p.value - value) < 4.5 * p.stderr + 0.01 * value
    efficiencies = (1.0 - share.value) / (1.0 + share.value)
    assert efficiencies == pytest.approx(0.9 / 1.3, rel=0.02)


def test_a_share_of_nothing_is_not_determined() -> None:
    runs, _ = drive(12)
    found = fit(Rig(), runs, ["torque_proportional"], **COULOMB)
    share = found["torque_proportional.mu"]
    assert share.held
    assert share.stderr is None


def test_a_pressure_is_a_load_in_bar() -> None:
    runs, truth = drive(13, "dry_load_dependence")
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
    name = "dry_load_dependence"
    by_load, by_pressure = (
        fit(Rig(), some, [name], fixed={"F_s_n": 10.0}, **COULOMB) for some in (runs, pressed)
    )
    assert by_pressure[f"{name}.mu"].value == pytest.approx(by_load[f"{name}.mu"].value, rel=1e-6)
    assert by_load[f"{name}.mu"].value == pytest.approx(truth["effects"][name]["mu"], rel=0.05)


def test_a_bearing_needs_none_of_them() -> None:
    for name in OF_DRIVES:
        with pytest.raises(InputError, match="follows the load and the film"):
            Model(Rig.thesis(), effects=[name])
