"""Effects hidden in simulated bearings are named, and only those."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from campaigns import campaign
from golden import golden
from jbf import Diagnosis, Rig, Run, diagnose
from jbf import effects as catalogue
from linear_campaigns import linear_diagnosis, linear_runs
from shared import shared

# Seeds depend on the position in this list.
LAST = ("backlash", "time_delay", "load_dependence")
OF_BEARINGS = [name for name, page in catalogue().items() if "journal" not in page.refused]
EFFECTS = (*(name for name in OF_BEARINGS if name not in LAST), *LAST)


@shared
def _diagnosis(name: str) -> tuple[Diagnosis, float]:
    """The diagnosis of a bearing with one hidden effect, and the noise (N)."""
    loads = {"two_way_0.25": 0.7, "stop_and_go": 0.7, "two_way_2": 1.35}
    options: dict[str, Any] = {}
    if name == "load_dependence":
        options = {"loads": tuple(loads.items())}
    rig, runs, truth = campaign(EFFECTS.index(name) + 30, (name,), **options)
    return diagnose(rig, runs), truth["noise_n"]


@pytest.mark.extended
@pytest.mark.parametrize("name", EFFECTS)
def test_hidden_effect_is_named_and_the_error_falls_to_the_noise(name: str) -> None:
    found, noise_n = _diagnosis(name)
    assert (found.verdict, found.effects) == ("missing", (name,)), found.summary()
    assert found.alternatives == {name: ()}
    first, last = found.steps[0], found.steps[-1]
    assert first.rms_n > last.rms_n
    assert first.holdout_rms_n > last.holdout_rms_n
    assert last.rms_n < 1.03 * noise_n
    # Only one run has rests: the others do not predict its breakaway.
    if name != "dwell_stiction":
        assert last.holdout_rms_n < 1.06 * noise_n


OVERESTIMATED = pytest.mark.xfail(strict=True, reason="noise floor of this campaign is 27 % high")


@pytest.mark.extended
@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=OVERESTIMATED if n == "vogel_viscosity" else ()) for n in EFFECTS],
)
def test_noise_floor_is_the_noise_of_the_simulation(name: str) -> None:
    found, noise_n = _diagnosis(name)
    assert found.steps[-1].noise_n == pytest.approx(noise_n, rel=0.08)


@pytest.mark.extended
def test_diagnosis_of_a_bearing_with_coloured_noise_and_no_effect_is_adequate() -> None:
    rig, runs, _ = campaign(7, coloured=True)
    found = diagnose(rig, runs)
    assert (found.verdict, found.effects, found.unexplained) == ("adequate", (), ())


def test_every_effect_that_the_records_can_show_is_tried() -> None:
    found = golden("bearing_nothing_missing")
    not_shown = {"load_dependence", "vogel_viscosity"}
    assert {trial.effect for trial in found.steps[0].trials} == set(EFFECTS) - not_shown
    assert not_shown <= set(found.not_tried)
    assert "one load" in found.not_tried["load_dependence"]


@pytest.mark.extended
def test_delay_is_named_next_to_a_resonance_of_the_drive() -> None:
    rig, runs, truth = campaign(202, ("drive_compliance", "time_delay"))
    found = diagnose(rig, runs)
    assert found.effects == ("drive_compliance", "time_delay"), found.summary()
    assert found.verdict == "missing"
    assert found.steps[-1].rms_n < 1.05 * truth["noise_n"]


def test_effects_that_require_a_path_or_a_load_are_not_tried_without_one() -> None:
    found = linear_diagnosis("nothing")
    not_shown = {"drive_compliance", "gravity", "cogging", "dry_load_dependence"}
    assert not_shown <= set(found.not_tried)
    assert not not_shown & {trial.effect for trial in found.steps[0].trials}


def test_diagnosis_of_a_single_run_names_the_mass_or_an_alternative() -> None:
    found = diagnose(Rig(), linear_runs("mass")[:1], law="coulomb")
    assert found.verdict in ("missing", "ambiguous")
    alternatives = {other for others in found.alternatives.values() for other in others}
    assert "inertia_leak" in {*found.effects, *alternatives}


# ---- friction that depends on the direction of motion ---------------------------------------


STEP_S, NOISE_N = 0.01, 0.1
LEVEL_N, PEAK_N, PEAK_M_S, SLOPE_N_S_M = 6.0, 3.0, 0.02, 40.0


def _slide(
    dry: float = 0.0, peak: float = 0.0, slope: float = 0.0, offset_n: float = 0.0
) -> list[Run]:
    """A Stribeck curve whose parts are larger by a share in positive motion, with rests."""
    records = []
    for i in range(4):
        random = np.random.default_rng([4120, i])
        t = np.arange(0.0, 24.0, STEP_S)
        v = 0.08 * np.sin((0.5 + 0.2 * i) * t + i) + 0.05 * np.sin(1.7 * t + 2.0 * i)
        phase = np.mod(t, 6.0)
        v = v * np.where(phase < 4.0, np.sin(0.25 * np.pi * phase) ** 2, 0.0)
        sign = np.sign(v)
        x = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * STEP_S)))
        level = LEVEL_N * (1.0 + dry * sign)
        level += PEAK_N * (1.0 + peak * sign) * np.exp(-((v / PEAK_M_S) ** 2))
        force = sign * level + SLOPE_N_S_M * (1.0 + slope * sign) * v + offset_n
        force = force + NOISE_N * random.standard_normal(len(t))
        records.append(Run.from_arrays(t, v, force, position_m=x, name=f"{i}"))
    return records


@pytest.mark.extended
@pytest.mark.parametrize(
    ("change", "effects"),
    [
        ({}, ()),
        ({"dry": 0.1, "peak": 0.1}, ("dry_asymmetry",)),
        ({"peak": 0.35}, ("stribeck_asymmetry",)),
        ({"slope": 0.2}, ("viscous_asymmetry",)),
        ({"dry": 0.1, "peak": 0.1, "slope": 0.1}, ("direction_asymmetry",)),
        # Rests separate an offset from an asymmetry.
        ({"offset_n": 0.6}, ("sensor_offset",)),
    ],
)
def test_part_of_the_friction_that_depends_on_direction_is_named(
    change: dict[str, float], effects: tuple[str, ...]
) -> None:
    found = diagnose(Rig(), _slide(**change), law="stribeck")
    assert found.effects == effects
    assert found.verdict == ("missing" if effects else "adequate")
    assert found.steps[-1].rms_n == pytest.approx(NOISE_N, rel=0.05)
