"""What is found in a record of a force before any physics: what was done to it, no more."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Run
from jbf.records.findings.examine import Examined, examine
from jbf.records.findings.held_samples import held
from scipy.signal import lfilter

Array = npt.NDArray[np.float64]
NOISE_N = 0.3
TIME = 0.02 * np.arange(3000)
RATES = (0.02, 0.3, 3.0)
"""Angular frequencies of slow, usual and fast motions, 1/s."""


def speed(omega: float = 0.3, time: Array = TIME) -> Array:
    """A speed to and fro, m/s."""
    return 0.1 * np.sin(omega * time + 0.4)


def friction(velocity: Array) -> Array:
    """A friction that rises fast at a reversal and falls with speed, N."""
    size = 15.0 + 10.0 * np.exp(-np.abs(velocity) / 0.02) + 40.0 * np.abs(velocity)
    return np.tanh(velocity / 0.002) * size


def white(seed: int, sd: float = NOISE_N) -> Array:
    return sd * np.random.default_rng(seed).standard_normal(len(TIME))


def coloured(seed: int) -> Array:
    """Noise with a memory of twenty samples."""
    kicks = np.random.default_rng(seed).standard_normal(len(TIME))
    return NOISE_N * np.sqrt(1.0 - 0.95**2) * lfilter([1.0], [1.0, -0.95], kicks)


def examined(force: Array, velocity: Array | None = None, time: Array = TIME) -> Examined:
    return examine(Run.from_arrays(time, speed() if velocity is None else velocity, force))


def kinds(found: Examined) -> list[str]:
    return sorted(finding.kind for finding in found.findings)


# ---- nothing to be found -------------------------------------------------------------------------


@pytest.mark.parametrize("omega", RATES)
@pytest.mark.parametrize("sd", [0.0, 1e-3, NOISE_N])
def test_nothing_in_a_clean_record(omega: float, sd: float) -> None:
    v = speed(omega)
    found = examined(friction(v) + white(1, sd), v)
    assert kinds(found) == []
    assert found.usable.all()
    assert found.native is None


@pytest.mark.parametrize("seed", range(5))
def test_nothing_in_coloured_noise(seed: int) -> None:
    assert kinds(examined(friction(speed()) + coloured(seed))) == []
    assert kinds(examined(friction(speed()) + coloured(seed) + white(seed, 0.05))) == []


def test_nothing_in_dry_friction_without_noise() -> None:
    # Equal readings without end, at both ends of the range: that is what such a law says.
    assert "glitches" not in kinds(examined(20.0 * np.sign(speed())))


def test_a_run_without_a_force_is_all_usable() -> None:
    found = examine(Run.from_arrays(TIME, speed()))
    assert found.findings == ()
    assert found.usable.all()


# ---- glitches ------------------------------------------------------------------------------------


@pytest.mark.parametrize("height", [18.0, 40.0, 120.0])
def test_glitches_are_found_where_they_are(height: float) -> None:
    at = np.array([300, 777, 1600, 2500])
    force = friction(speed()) + white(2)
    force[at] += height * NOISE_N * np.array([1.0, -1.0, -1.0, 1.0])
    found = examined(force)
    assert kinds(found) == ["glitches"]
    np.testing.assert_array_equal(np.flatnonzero(~found.usable), at)
    assert found.findings[0].size == pytest.approx(height * NOISE_N, abs=4.0 * NOISE_N)
    assert "6.00 s" in found.findings[0].words


def test_a_peak_of_breakaway_is_no_glitch() -> None:
    v = speed()
    force = friction(v) + white(3, 0.02)
    turns = np.flatnonzero(np.diff(np.sign(v)) != 0)
    assert len(turns) > 3
    force[turns + 1] += 8.0 * np.sign(v[turns + 1])
    assert examined(force, v).usable.all()


# ---- held samples --------------------------------------------------------------------------------


@pytest.mark.parametrize("held", [6, 25, 60])
def test_a_force_that_stands_still_is_held(held: int) -> None:
    force = friction(speed()) + white(4)
    for first in (400, 1900):
        force[first + 1 : first + held] = force[first]
    found = examined(force)
    assert kinds(found) == ["held_samples"]
    off = np.flatnonzero(~found.usable)
    # The reading itself was read; those that repeat it were not.
    np.testing.assert_array_equal(off[: held - 1], np.arange(401, 400 + held))
    assert len(off) == 2 * (held - 1)
    assert found.findings[0].size == pytest.approx(0.02 * (held - 1))


@pytest.mark.parametrize("over_noise", [1.5, 3.5, 6.0])
def test_a_converter_of_few_steps_repeats_itself_and_holds_nothing(over_noise: float) -> None:
    step = over_noise * NOISE_N
    force = step * np.round((friction(speed()) + white(5)) / step)
    assert np.mean(np.diff(force) == 0.0) > 0.2
    assert kinds(examined(force)) == ["steps"]


# ---- gaps ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("share", "stretch"), [(0.003, 5), (0.02, 30), (0.05, 100)])
def test_rows_that_are_missing_are_counted(share: float, stretch: int) -> None:
    keep = np.random.default_rng(6).random(len(TIME)) >= share
    keep[1000 : 1000 + stretch] = False
    keep[[0, -1, 999, 1000 + stretch]] = True
    t = TIME[keep]
    found = examined((friction(speed()) + white(6))[keep], speed()[keep], t)
    assert kinds(found) == ["gaps"]
    assert found.findings[0].size == pytest.approx(0.02 * (stretch + 1))
    assert found.findings[0].words.startswith(f"{np.sum(~keep)} rows")
    assert found.usable.all()


def test_samples_without_a_rate_have_no_gaps() -> None:
    t = np.cumsum(np.random.default_rng(7).exponential(0.02, len(TIME)) + 1e-4)
    assert "gaps" not in kinds(examined(friction(speed(0.3, t)) + white(7), speed(0.3, t), t))


# ---- steps ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("over_noise", [0.7, 1.5, 4.0])
def test_the_step_of_a_converter_is_found(over_noise: float) -> None:
    step = over_noise * NOISE_N
    found = examined(step * np.round((friction(speed()) + white(8)) / step))
    steps = [finding for finding in found.findings if finding.kind == "steps"]
    assert len(steps) == 1
    assert steps[0].size == pytest.approx(step, rel=1e-6)


def test_steps_below_the_noise_are_not_worth_a_word() -> None:
    step = 0.1 * NOISE_N
    assert kinds(examined(step * np.round((friction(speed()) + white(9)) / step))) == []


# ---- saturation ----------------------------------------------------------------------------------


@pytest.mark.parametrize("of_peak", [0.8, 0.87, 0.95])
@pytest.mark.parametrize("step_n", [0.0, 0.1])
def test_a_force_at_the_end_of_its_range_is_set_aside(of_peak: float, step_n: float) -> None:
    whole = friction(speed()) + white(11)
    limit = of_peak * float(np.quantile(np.abs(whole), 0.995))
    force = np.clip(whole, -limit, limit)
    if step_n:
        force = np.round(force / step_n) * step_n
    found = examined(force)
    assert kinds(found) == ["saturation"]
    assert found.findings[0].size == pytest.approx(limit, abs=0.06)
    assert not found.usable[np.abs(whole) > limit + step_n].any()
    # What is left is as it was: no end has cut its noise on one side.
    kept = found.usable & (np.abs(speed()) > 0.01)
    left = (force - friction(speed()))[kept] * np.sign(speed()[kept])
    assert abs(np.mean(left)) < NOISE_N * (0.1 + 3.0 / np.sqrt(len(left)))
    assert np.mean(found.usable) > 0.8 * np.mean(np.abs(whole) < limit - 4.0 * NOISE_N)


def test_plateaus_are_no_saturation() -> None:
    # One level of a coarse converter, and a law that says one number.
    level = 20.0 * np.sign(speed())
    step = 3.0 * NOISE_N
    assert "saturation" not in kinds(examined(step * np.round((level + white(12)) / step)))
    assert "saturation" not in kinds(examined(level))
    fine = 0.05
    assert kinds(examined(fine * np.round((level + white(13)) / fine))) == []


@pytest.mark.parametrize("kind", ["triangle", "stick and slip", "ramp"])
def test_laws_without_noise_have_corners_and_plateaus(kind: str) -> None:
    phase = np.mod(TIME, 5.0) / 5.0
    v = {
        "triangle": 0.1 * (2.0 * np.abs(2.0 * phase - 1.0) - 1.0),
        "stick and slip": np.where(phase < 0.15, np.sin(np.pi * phase / 0.15) ** 2, 0.0),
        "ramp": 0.1 * TIME / TIME[-1],
    }[kind]
    top = np.max(v)
    found = examined(10.0 * np.tanh(v / (0.01 * top)) + 2.0 * v / top, v)
    assert {"glitches", "saturation", "interpolated", "steps"}.isdisjoint(kinds(found))


def test_long_rows_do_not_make_long_rows_likely() -> None:
    """A tenth of a record in long rows, and one short one that is held as well."""
    random = np.random.default_rng(8)
    values = random.standard_normal(1500)
    for first in (100, 400, 700, 1000):
        values[first : first + 40] = values[first]
    values[1300:1305] = values[1300]
    found = held(values)
    assert found[1301:1305].all()
    assert found.sum() == 4 * 39 + 4
