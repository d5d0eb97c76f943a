"""A friction with its sign turned is told of; whatever else pushes is not taken for it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Rig, Run
from jbf.estimation.prepared import Prepared
from jbf.records.findings.finding import Finding

Array = npt.NDArray[np.float64]
TIME = 0.02 * np.arange(3000)
MOTIONS = {"slow": 0.1, "usual": 0.7, "fast": 6.0}


def found(force: Array, speed: Array) -> list[Finding]:
    noise = 0.3 * np.random.default_rng(1).standard_normal(len(TIME))
    measured = speed + 1e-5 * np.random.default_rng(2).standard_normal(len(TIME))
    return list(
        Prepared.of(Rig(), Run.from_arrays(TIME, measured, force + noise)).examined.findings
    )


def motion(name: str) -> tuple[Array, Array, Array]:
    """Speed, its friction, its acceleration."""
    omega = MOTIONS[name]
    v = 0.1 * np.sin(omega * TIME + 0.2)
    friction = np.tanh(v / 1e-3) * (5.0 + 3.0 * np.exp(-np.abs(v) / 0.02)) + 10.0 * v
    return v, friction, 0.1 * omega * np.cos(omega * TIME + 0.2)


@pytest.mark.parametrize("name", list(MOTIONS))
@pytest.mark.parametrize("size", [0.2, 1.0, 5.0])
def test_a_friction_that_pushes_is_told_of(name: str, size: float) -> None:
    v, friction, _ = motion(name)
    assert found(size * friction, v) == []
    (told,) = found(-size * friction, v)
    assert (told.kind, told.channel, told.done) == ("sign", "friction_n", "none")
    assert told.size == pytest.approx(-5.5 * size, rel=0.3)


@pytest.mark.parametrize("name", list(MOTIONS))
def test_weight_mass_and_spring_are_no_sign(name: str) -> None:
    v, friction, a = motion(name)
    path = np.cumsum(v) * 0.02
    for more in (50.0, -50.0, -80.0 * a / np.std(a), 80.0 * a / np.std(a), -400.0 * path):
        assert found(friction + more, v) == []
        assert found(0.02 * friction + more, v) == []


def test_one_direction_tells_no_sign() -> None:
    v = 0.05 + 0.03 * np.sin(0.7 * TIME)
    assert found(-8.0 - 10.0 * v, v) == []


@pytest.mark.parametrize("seed", range(5))
def test_noise_without_friction_is_no_sign(seed: int) -> None:
    v, _, _ = motion("usual")
    walk = 0.05 * np.cumsum(np.random.default_rng(seed).standard_normal(len(TIME)))
    assert found(walk, v) == []
