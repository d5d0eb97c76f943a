"""Friction that depends on the direction, part by part: the dry level, the Stribeck peak, the
viscous slope, all of it. What no motion tells apart is tied openly."""

from __future__ import annotations

import numpy as np
import pytest
from jbf import Diagnosis, Rig, Run, diagnose

STEP_S = 0.01
NOISE_N = 0.1
LEVEL_N, PEAK_N, PEAK_M_S, SLOPE_N_S_M = 6.0, 3.0, 0.02, 40.0


def runs(dry: float = 0.0, peak: float = 0.0, slope: float = 0.0, *, rests: bool) -> list[Run]:
    """A slide with a Stribeck curve, each part larger in positive motion by a share of its own."""
    found = []
    for i in range(4):
        rng = np.random.default_rng([4120, i])
        t = np.arange(0.0, 24.0, STEP_S)
        v = 0.08 * np.sin((0.5 + 0.2 * i) * t + i) + 0.05 * np.sin(1.7 * t + 2.0 * i)
        if rests:
            v = v * np.where(np.mod(t, 6.0) < 4.0, np.sin(0.25 * np.pi * np.mod(t, 6.0)) ** 2, 0.0)
        way = np.sign(v)
        x = np.concatenate(([0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * STEP_S)))
        level = LEVEL_N * (1.0 + dry * way)
        level += PEAK_N * (1.0 + peak * way) * np.exp(-((v / PEAK_M_S) ** 2))
        force = way * level + SLOPE_N_S_M * (1.0 + slope * way) * v
        force = force + NOISE_N * rng.standard_normal(len(t))
        found.append(Run.from_arrays(t, v, force, position_m=x, name=f"{i}"))
    return found


def named(some: list[Run]) -> Diagnosis:
    return diagnose(Rig(), some, law="stribeck")


@pytest.mark.parametrize(
    ("shares", "effect"),
    [
        ({"dry": 0.1, "peak": 0.1}, "dry_asymmetry"),
        ({"peak": 0.35}, "stribeck_asymmetry"),
        ({"slope": 0.2}, "viscous_asymmetry"),
        ({"dry": 0.1, "peak": 0.1, "slope": 0.1}, "direction_asymmetry"),
    ],
)
def test_each_part_is_found_alone(shares: dict[str, float], effect: str) -> None:
    found = named(runs(rests=True, **shares))
    assert (found.verdict, found.effects) == ("missing", (effect,))
    assert found.steps[-1].rms_n == pytest.approx(NOISE_N, rel=0.05)


def test_a_symmetric_slide_has_none() -> None:
    found = named(runs(rests=True))
    assert (found.verdict, found.effects) == ("adequate", ())


def test_a_zero_that_is_off_is_no_asymmetry_where_the_drive_rests() -> None:
    some = [
        Run.from_arrays(
            r.time_s, r.velocity_m_s, r.friction_n + 0.6, position_m=r.position_m, name=r.name
        )
        for r in runs(rests=True)
    ]
    found = named(some)
    assert (found.verdict, found.effects) == ("missing", ("sensor_offset",))


def test_without_a_rest_or_a_peak_a_zero_and_a_dry_asymmetry_tie() -> None:
    some = []
    for r in runs(rests=False):
        v = np.asarray(r.velocity_m_s)
        rng = np.random.default_rng([4121, int(r.name)])
        force = np.sign(v) * LEVEL_N + SLOPE_N_S_M * v + 0.6 + NOISE_N * rng.standard_normal(len(v))
        some.append(Run.from_arrays(r.time_s, v, force, position_m=r.position_m, name=r.name))
    found = diagnose(Rig(), some, law="coulomb")
    assert found.verdict == "ambiguous"
    assert found.effects == ("sensor_offset",)
    assert found.alternatives == {"sensor_offset": ("dry_asymmetry",)}
