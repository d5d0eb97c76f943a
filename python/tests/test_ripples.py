"""Ripple whose phase is each run's own: found over the way, told, and no effect."""

from __future__ import annotations

import numpy as np
import pytest
from jbf import Diagnosis, Rig, Run, diagnose
from jbf.records.drive import Drive

STEP_S = 0.01
NOISE_N = 0.2
LEAD_M = 0.005
SCREW = Rig(drive=Drive("linear", "force", pitch_m=LEAD_M))


def set_points(
    size_n: float, *, of_friction: bool = False, hum_n: float = 0.0, seed: int = 4140
) -> list[Run]:
    """A screw driven at six speeds either way, each logged by itself and without a place."""
    found = []
    speeds = [s * v for v in (0.006, 0.010, 0.017, 0.028, 0.041, 0.06) for s in (1.0, -1.0)]
    for i, top in enumerate(speeds):
        rng = np.random.default_rng([seed, i])
        t = np.arange(0.0, 12.0, STEP_S)
        v = top * (1.0 + 0.05 * np.sin(0.7 * t + i))
        way = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * STEP_S)))
        wave = np.sin(2.0 * np.pi * way / LEAD_M - rng.uniform(0.0, 2.0 * np.pi))
        force = np.sign(v) * (6.0 + size_n * wave * of_friction) + 40.0 * v
        force = force + size_n * wave * (not of_friction)
        force = force + hum_n * np.sin(2.0 * np.pi * 6.3 * t + i)
        force = force + NOISE_N * rng.standard_normal(len(t))
        found.append(Run.from_arrays(t, v, force, name=f"{i}"))
    return found


def of_the_way(found: Diagnosis) -> list[str]:
    return [r.where for r in found.unexplained if r.axis == "way"]


@pytest.mark.parametrize("of_friction", [False, True])
def test_a_ripple_of_each_run_is_told_with_its_pitch(of_friction: bool) -> None:
    found = diagnose(SCREW, set_points(0.15, of_friction=of_friction), law="coulomb")
    assert (found.verdict, found.effects) == ("unexplained", ())
    (said,) = of_the_way(found)
    # To a line's width: one over the periods of the longest way, 144.
    pitch = float(said.split("every ")[1].split(" m")[0])
    assert pitch == pytest.approx(LEAD_M, rel=5e-3)
    assert "(1 times a turn)" in said
    assert "in each run at a phase of its own" in said


def test_noise_has_none() -> None:
    found = diagnose(SCREW, set_points(0.0), law="coulomb")
    assert (found.verdict, found.effects, of_the_way(found)) == ("adequate", (), [])


def test_a_hum_is_none() -> None:
    found = diagnose(SCREW, set_points(0.0, hum_n=0.15), law="coulomb")
    assert found.verdict == "unexplained"
    assert "frequency" in [r.axis for r in found.unexplained]
    assert of_the_way(found) == []
