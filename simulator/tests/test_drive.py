"""Tests of a journal with a compliant drive: sticking, sliding, and the limit of a stiff drive."""

import numpy as np
import pytest
from rigsim import Base, polyline, simulate_run, sine, stop_and_go
from rigsim.film import Film
from scipy.integrate import trapezoid

BASE = Base()
DRIVE = {"k": 70.0, "c": 0.08, "J": 0.0035}
ARM = BASE.bearing.count * BASE.bearing.radius_m
STOP = stop_and_go("stop", [(0.5, 1), (5.0, -1)], 0.05, 0.5, 1.0, 9.0)


def force(motion, **changes):
    record = simulate_run(BASE, {"drive_compliance": DRIVE | changes}, motion)
    return record.time_s, record.friction


def fixed_step(motion, step, every):
    """Friction by a semi-implicit method in fixed steps, each of which sticks or slides."""
    film, radius = Film.of(BASE), BASE.bearing.radius_m
    eps, phi = film.start()
    k, c, inertia = DRIVE["k"], DRIVE["c"], DRIVE["J"]
    theta = omega = 0.0
    out = []
    for count in range(round(motion.duration_s / step) + 1):
        t = count * step
        piece = next(p for p in motion.pieces if t <= p.t1 + 1e-12)
        command, rate = piece.position(t) / radius, piece.speed(t) / radius
        limit = ARM * BASE.load_n * BASE.f_m * film.asperity_load(eps) / film.load_group
        viscous = ARM * BASE.load_n * film.shear(eps, radius / BASE.U_tr)
        push = inertia * omega + step * (k * (command - theta) + c * rate)
        mass = inertia + c * step + k * step * step
        if abs(push) <= step * limit:
            omega, friction = 0.0, push / step / ARM
        else:
            sign = 1.0 if push > 0.0 else -1.0
            omega = (push - sign * step * limit) / (mass + viscous * step)
            friction = (sign * limit + viscous * omega) / ARM
        if count % every == 0:
            out.append(friction)
        theta += step * omega
        d_eps, d_phi = film.rates(eps, phi, abs(omega) * radius / BASE.U_tr)
        eps, phi = eps + step * d_eps, phi + step * d_phi
    return np.array(out)


def test_event_integration_of_a_drive_agrees_with_fine_fixed_steps():
    _, exact = force(STOP)
    coarse = np.abs(fixed_step(STOP, 2e-4, 100) - exact)
    fine = np.abs(fixed_step(STOP, 5e-5, 400) - exact)
    assert np.sqrt(np.mean(fine**2)) < 0.03
    assert np.sqrt(np.mean(fine**2)) < 0.5 * np.sqrt(np.mean(coarse**2))


@pytest.mark.extended
def test_friction_behind_a_stiff_drive_agrees_with_that_of_a_rigid_drive():
    motion = sine("swing", 4.0, 0.127, 2.0)
    _, stiff = force(motion, k=2e4, c=5.0)
    rigid = simulate_run(BASE, {}, motion)
    moving = np.abs(rigid.velocity) > 0.002
    assert np.max(np.abs(stiff - rigid.friction)[moving]) < 0.02


def test_friction_of_a_drive_at_rest_is_constant_and_below_the_static_limit():
    t, f = force(STOP)
    held = f[(t > 3.5) & (t < 5.0)]
    assert np.ptp(held) < 1e-6
    assert 0.0 < held[0] < BASE.f_m * BASE.load_n


def test_friction_before_breakaway_equals_the_force_of_spring_and_damper():
    motion = polyline("creep", [(0.0, 0.0), (20.0, 0.0), (20.1, 1e-4), (22.0, 1e-4)])
    t, f = force(motion)
    i = int(np.argmin(np.abs(t - 21.0)))
    moved = (0.5 * 0.1 + 0.9) * 1e-4 / BASE.bearing.radius_m
    rate = 1e-4 / BASE.bearing.radius_m
    assert f[i] == pytest.approx((DRIVE["k"] * moved + DRIVE["c"] * rate) / ARM, rel=1e-9)


def test_friction_work_behind_a_compliant_drive_is_close_to_a_rigid_drive():
    """The two values differ by at most the energy stored in the spring plus 20 %."""
    motion = sine("swing", 13.0, 0.127, 1.0)
    record = simulate_run(BASE, {"drive_compliance": DRIVE}, motion, rate_hz=500.0)
    rigid = simulate_run(BASE, {}, motion, rate_hz=500.0)
    loss = trapezoid(record.friction * record.velocity, record.time_s)
    rigid_loss = trapezoid(rigid.friction * rigid.velocity, rigid.time_s)
    stored = 0.5 * (BASE.f_m * BASE.load_n) ** 2 * ARM / DRIVE["k"]
    assert loss > 0.0
    assert abs(loss - rigid_loss) < stored + 0.2 * rigid_loss


def test_presliding_friction_behind_a_drive_settles_at_the_base_friction():
    motion = polyline("run", [(0.0, 0.0), (1.0, 0.03), (20.0, 0.03)])
    both = {"drive_compliance": DRIVE, "presliding": {"sigma": 2000.0}}
    with_both = simulate_run(BASE, both, motion).friction[-1]
    assert with_both == pytest.approx(simulate_run(BASE, {}, motion).friction[-1], rel=1e-4)
