"""Drives, slides and joints from a simulator of their own: what is in them comes back, and is named
alone."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from jbf import Model, Rig, Run, diagnose, fit
from jbf.errors import InputError
from jbf.models.catalogue import built_in as catalogue
from rigsim import AXIS_EFFECTS, axis_campaign

OF_DRIVES = [name for name, page in catalogue().items() if "journal" in page.refused]
COULOMB: dict[str, Any] = {"law": "coulomb"}


@cache
def drive(seed: int, *effects: str, strength: float = 1.0) -> tuple[list[Run], dict[str, Any]]:
    """Runs of a simulated drive, and the truth. A joint has an angle, a slide a position."""
    records, truth = axis_campaign(seed, effects, strength=strength)
    joint = "gravity" in effects or seed % 2 == 0
    runs = [
        Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.force_n,
            load_n=r.load_n,
            name=r.name,
            **{"angle_rad" if joint else "position_m": r.path},
        )
        for r in records
    ]
    return runs, truth


def test_the_simulator_has_a_form_of_its_own_of_each() -> None:
    assert set(OF_DRIVES) <= set(AXIS_EFFECTS)


@pytest.mark.parametrize("name", OF_DRIVES)
def test_the_right_structure_recovers_the_truth(name: str) -> None:
    runs, truth = drive(11, name)
    found = fit(Rig(), runs, [name], fixed={"F_s_n": 10.0}, **COULOMB)
    assert found.converged
    assert found.rms_n == pytest.approx(truth["noise_n"], rel=0.03)
    wanted = dict(truth["law"])
    for page in catalogue()[name].parameters:
        (short,) = (k for k in truth["effects"][name] if page.name.startswith(k))
        wanted[f"{name}.{page.name}"] = truth["effects"][name][short]
    for parameter, value in wanted.items():
        p = found.parameters[parameter]
        assert p.stderr is not None, parameter
        off = p.value - value
        if parameter.endswith("theta_0_rad"):
            off -= 2.0 * np.pi * np.round(off / (2.0 * np.pi))
        assert abs(off) < 4.5 * p.stderr + 0.01 * abs(value), parameter


@pytest.mark.parametrize("name", OF_DRIVES)
def test_it_is_named_alone(name: str) -> None:
    runs, _ = drive(12, name)
    found = diagnose(Rig(), runs, **COULOMB)
    assert (found.verdict, found.effects) == ("missing", (name,))


@pytest.mark.parametrize("seed", [12, 14])
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
