"""Tests of the base law against Table 4.2 of Cohn (1998) and the steady force balance."""

import math

import numpy as np
import pytest
from rigsim import Base, polyline, simulate_run, sine
from rigsim.film import Film
from scipy.optimize import brentq

BASE = Base()  # Table 4.2


def hold(speed: float, seconds: float = 60.0):
    """Motion at a constant speed (m/s), long enough for the film to settle."""
    return polyline("hold", [(0.0, speed), (seconds, speed)])


def balance(base: Base, speed: float) -> float:
    """Steady friction coefficient from (3.5) and (3.6) of Cohn (1998), by bisection."""
    film, ub = Film.of(base), speed / base.U_tr

    def excess(eps: float) -> float:
        d = 1.0 - eps * eps
        j11, j12 = 0.5 * math.pi / d**1.5, -2.0 * eps / d**2
        along = film.asperity_load(eps) - 0.5 * j12 * eps * ub
        return along**2 + (0.5 * j11 * eps * ub) ** 2 - film.load_group**2

    eps = brentq(excess, 1e-6, 1.0 - 1e-6, xtol=1e-15)
    return base.f_m * film.asperity_load(eps) / film.load_group + film.shear(eps, ub)


@pytest.mark.parametrize(
    ("load", "u_tr", "eps_tr"),
    [(104.0, 0.06, 0.97235), (83.5, 0.05, 0.97183), (104.0, 0.05, 0.97475)],
)
def test_transition_eccentricity_agrees_with_the_published_table(load, u_tr, eps_tr):
    assert Base(load_n=load, U_tr=u_tr).transition_eccentricity() == pytest.approx(eps_tr, abs=6e-6)


def test_transition_eccentricity_agrees_with_the_reference_to_eight_digits():
    assert BASE.transition_eccentricity() == pytest.approx(0.97235049, abs=5e-9)


@pytest.mark.parametrize(
    ("speed", "f"), [(0.001, 0.21635118), (0.02, 0.05782938), (0.127, 0.00860)]
)
def test_steady_friction_agrees_with_reference_values(speed, f):
    record = simulate_run(BASE, {}, hold(speed))
    digits = 5e-6 if speed > 0.1 else 1e-7
    assert record.friction[-1] / BASE.load_n == pytest.approx(f, abs=digits)


@pytest.mark.parametrize("speed", [0.003, 0.05, 0.2])
def test_steady_friction_satisfies_the_force_balance(speed):
    record = simulate_run(BASE, {}, hold(speed))
    assert record.friction[-1] / BASE.load_n == pytest.approx(balance(BASE, speed), rel=1e-7)


def test_friction_changes_sign_with_the_direction_of_motion():
    forward = simulate_run(BASE, {}, sine("forward", 10.0, 0.127, 1.0))
    backward = simulate_run(BASE, {}, sine("backward", 10.0, -0.127, 1.0))
    np.testing.assert_allclose(forward.friction, -backward.friction, atol=1e-9)


def test_friction_of_the_backward_half_period_mirrors_that_of_the_forward_one():
    motion = sine("bi", 4.0 * math.pi, 0.127, 2.0)
    record = simulate_run(BASE, {}, motion, rate_hz=100 / math.pi)
    half = 50
    tail = record.friction[-2 * half :]
    np.testing.assert_allclose(tail[1:half], -tail[half + 1 :][: half - 1], atol=1e-4)


def test_friction_is_zero_at_rest_before_the_first_motion():
    record = simulate_run(BASE, {}, polyline("rest", [(0.0, 0.0), (2.0, 0.0), (3.0, 0.05)]))
    assert np.all(record.friction[record.time_s <= 2.0] == 0.0)
    assert record.friction[-1] > 0.0
