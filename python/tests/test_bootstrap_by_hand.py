"""Records read once more and the errors of answers, in small numbers."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import InputError, Parameter, ParameterValue, Rig, Run, threads
from jbf.estimation.bootstrap import (
    LEAST_REPEATS,
    MOST_REPEATS,
    bootstrap,
    check_repeats,
    innovation_sizes,
    read_again,
    recorded_again,
    with_error,
)
from jbf.estimation.determined import undetermined
from jbf.estimation.fit import fit
from jbf.estimation.noise import WHITE, Noise
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
PAGE = Parameter("b_n", lower=-1e5, upper=1e5, null=0.0, starts=(0.3,))
SCALE = Parameter("F_c_n", lower=0.0, upper=1e5, starts=(1.0,))
ANGLE = Parameter("phase", lower=-np.pi, upper=np.pi, starts=(0.0,), period=2.0 * np.pi)


def test_so_many_repeats_tell_an_error() -> None:
    for count in (LEAST_REPEATS, MOST_REPEATS):
        check_repeats(count)
    for count, said in ((LEAST_REPEATS - 1, "too few"), (MOST_REPEATS + 1, "too many")):
        with pytest.raises(InputError, match=f"draws {count} is {said}"):
            check_repeats(count, "draws")
    assert (LEAST_REPEATS, MOST_REPEATS) == (19, 100_000)


@pytest.mark.parametrize("off", [-3.0, 0.0, 100.0])
def test_an_error_is_half_of_what_holds_the_middle_of_the_answers(off: float) -> None:
    """Of a normal's that is its deviation, wherever they lie; wild ones change nothing."""
    answers = np.linspace(0.0, 1.0, 100_001)
    found = with_error(ParameterValue(5.0, 1e-3), 5.0 + off + answers, PAGE)
    assert found.stderr == pytest.approx(0.5 * (0.84134 - 0.15866), rel=1e-3)
    assert (found.value, found.held, found.note) == (5.0, False, None)
    wild = np.concatenate((5.0 + answers, np.full(1000, 1e6)))
    assert with_error(ParameterValue(5.0, 1e-3), wild, PAGE).stderr == pytest.approx(
        0.345, rel=0.01
    )


def test_no_error_is_smaller_than_the_curvatures_and_none_is_made_of_none() -> None:
    answers = np.linspace(4.9, 5.1, 1001)
    assert with_error(ParameterValue(5.0, 0.5), answers, PAGE).stderr == 0.5
    held = ParameterValue(5.0, None, "held fixed", held=True)
    assert with_error(held, answers, PAGE) is held


def test_an_error_larger_than_its_parameter_leaves_it_held() -> None:
    answers = np.linspace(0.0, 40.0, 1001)
    found = with_error(ParameterValue(5.0, 1.0), answers, SCALE)
    error = 20.0 * (0.84134 - 0.15866)
    assert found.note == undetermined(SCALE, 5.0, error)
    assert (found.stderr, found.held) == (None, True)


def test_an_angle_comes_again_after_a_turn() -> None:
    answers = np.linspace(3.0, 3.2, 1001)
    turned = np.where(np.arange(1001) % 2, answers, answers - 2.0 * np.pi)
    found = with_error(ParameterValue(3.1, 1e-3), turned, ANGLE)
    assert found.stderr == pytest.approx(0.1 * (0.84134 - 0.15866), rel=0.01)
    assert with_error(ParameterValue(3.1, 1e-3), turned, PAGE).stderr == pytest.approx(
        np.pi, rel=0.1
    )


@pytest.mark.parametrize(("count", "own"), [(99, False), (100, True)])
def test_a_run_of_a_hundred_samples_has_a_noise_of_its_own(count: int, own: bool) -> None:
    residuals = [np.full(300, 1.0), np.full(150, 4.0)]
    prepared = [
        record(0.02 * np.arange(len(r)), name=n) for r, n in zip(residuals, "ab", strict=True)
    ]
    masks = [np.ones(300), np.arange(150) < count]
    campaign: Any = SimpleNamespace(samples=samples_of(prepared, masks))
    fitted: Any = SimpleNamespace(residuals=residuals, noise=WHITE)
    usual = np.sqrt((300.0 + 16.0 * count) / (300.0 + count))
    assert innovation_sizes(fitted, campaign) == pytest.approx([1.0, 4.0 if own else usual])


# ---- read once more ----------------------------------------------------------------------------

N = 200
TIME = 0.02 * np.arange(N)
PATH = 0.05 * TIME
KNOWN = np.arange(N) >= 20
"""Where the sign of the force is known; before, the drive rests."""


def prepared(**aside: bool) -> Any:
    off = 0.01 * np.random.default_rng(3).standard_normal(N)
    run = Run.from_arrays(
        TIME,
        0.05 + off,
        np.full(N, 7.0),
        position_m=PATH + 0.2 * off,
        name="a",
    )
    motion = SimpleNamespace(
        velocity_m_s=np.full(N, 0.05),
        angle_rad=PATH,
        resting=~KNOWN,
        sign_known=KNOWN,
        aside={name for name, is_aside in aside.items() if is_aside},
    )
    return SimpleNamespace(
        run=run, motion=motion, friction_n=np.full(N, 7.0), step_s=0.02, rig=Rig()
    )


def test_errors_of_a_motion_come_again_with_other_signs() -> None:
    p = prepared()
    again = read_again(p, np.full(N, 3.0), np.random.default_rng(1))
    off = p.run.velocity_m_s - 0.05
    assert np.abs(again.velocity_m_s - 0.05) == pytest.approx(np.abs(off))
    turned = np.sign(again.velocity_m_s - 0.05) != np.sign(off)
    assert not turned[~KNOWN].any()
    assert 0.3 < turned[KNOWN].mean() < 0.7
    assert again.friction_n is not None
    assert again.friction_n.tolist() == [7.0] * 20 + [3.0] * (N - 20)
    assert again.position_m is not None
    assert again.position_m[:20] == pytest.approx(p.run.position_m[:20])
    moved = again.position_m - PATH
    assert np.abs(moved) == pytest.approx(np.abs(p.run.position_m - PATH), abs=1e-12)
    assert np.any(np.sign(moved[20:]) != np.sign((p.run.position_m - PATH)[20:]))


def test_a_place_on_a_bearing_is_as_far_as_its_surface_went() -> None:
    p = prepared()
    p.rig = Rig.thesis()
    assert p.rig.bearing is not None
    p.motion.angle_rad = PATH / p.rig.bearing.radius_m
    again = read_again(p, np.full(N, 3.0), np.random.default_rng(1))
    assert again.position_m is not None
    off = np.abs(p.run.position_m - PATH)
    assert np.abs(again.position_m - PATH) == pytest.approx(off, abs=1e-12)


def test_a_column_that_is_not_believed_stays_as_it_was() -> None:
    p = prepared(velocity_m_s=True, position_m=True)
    again = read_again(p, np.full(N, 3.0), np.random.default_rng(1))
    assert np.array_equal(again.velocity_m_s, p.run.velocity_m_s)
    assert again.position_m is not None
    assert np.array_equal(again.position_m, p.run.position_m)


def test_an_encoder_is_read_off_lines_that_lie_elsewhere() -> None:
    """Whole steps of 1 mm, off by a part of one that is the same all along."""
    p = prepared()
    step = 1e-3
    p.run = Run.from_arrays(
        TIME, np.full(N, 0.05), np.full(N, 7.0), position_m=step * np.round(PATH / step), name="a"
    )
    again = read_again(p, np.full(N, 3.0), np.random.default_rng(5))
    assert again.position_m is not None
    moving = again.position_m[20:]
    phases = np.mod(moving - moving[0] + 0.5 * step, step) - 0.5 * step
    assert phases == pytest.approx(np.zeros(N - 20), abs=1e-9)
    assert np.max(np.abs(moving - PATH[20:])) <= 0.5 * step + 1e-12
    assert np.mod(moving[0] / step, 1.0) not in (0.0, 1.0)
    assert again.position_m[:20] == pytest.approx(step * np.round(PATH[:20] / step))


def test_noise_of_that_size_and_colour_is_added() -> None:
    p = prepared()
    noise = Noise(0.1, 0.4)
    again = recorded_again(p, np.full(N, 3.0), noise, 0.5, np.random.default_rng(9))
    kicks = np.random.default_rng(9).normal(0.0, 0.5, N)
    wanted = 3.0 + noise.coloured(kicks, 0.02)
    assert again.friction_n is not None
    assert again.friction_n[KNOWN] == pytest.approx(wanted[KNOWN])
    assert np.all(again.friction_n[~KNOWN] == 7.0)


def test_linear_algebra_keeps_to_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a fit, and of its repetitions."""
    asked: list[str] = []
    monkeypatch.setattr(threads, "_enter", lambda: asked.append("in"))
    monkeypatch.setattr(threads, "_leave", lambda: asked.append("out"))
    none: Any = None
    with pytest.raises(InputError):
        bootstrap(none, [], repeats=1)
    assert asked == ["in", "out"]
    with pytest.raises(InputError):
        fit(Rig(), [], law="coulomb")
    assert asked == ["in", "out"] * 2
