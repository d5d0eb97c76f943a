"""How far runs disagree, of a linear model in swings that average out: sums by hand, and words."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Rig
from jbf.diagnosis.constancy import (
    Disagreement,
    _directions,
    _set_aside,
    disagreement,
    find_disagreement,
    own_step,
)
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.noise import WHITE
from jbf.models.catalogue import parameters_of
from made_of import record, samples_of
from scipy import stats

Array = npt.NDArray[np.float64]
N = 400
SWINGS = np.where(np.arange(N) % 2, 1.0, -1.0)
LEVEL = np.ones(N)
RAMP = np.linspace(-1.0, 1.0, N)
FREE = ("F_c_n", "F_v_n_s_m")


def of(
    residuals: list[Array],
    columns: list[Array],
    *,
    log: tuple[bool, bool] = (False, False),
    effects: tuple[str, ...] = (),
    names: tuple[str, ...] = FREE,
    between: BetweenRuns | None = None,
) -> tuple[Any, Any]:
    """Runs whose predictions move along these columns, alike in all of them."""
    prepared = [record(0.02 * np.arange(len(r)), name="abcdef"[i]) for i, r in enumerate(residuals)]
    samples = replace(samples_of(prepared), between=between)
    pages = parameters_of("coulomb", ("sensor_offset", "drive_compliance"))
    problem: Any = SimpleNamespace(
        names=list(names),
        open=list(range(len(columns))),
        effects=effects,
        parameters={name: pages[name] for name in names},
        log=np.array(log),
        law="coulomb",
        campaign=SimpleNamespace(rig=Rig()),
    )
    jacobian = [np.column_stack(columns)[: len(r)] for r in residuals]
    solution: Any = SimpleNamespace(
        residuals=residuals, jacobian=jacobian, noise=WHITE, samples=samples
    )
    return problem, solution


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_levels_that_differ_gain_their_squares_less_what_they_share(
    unit: float, scale: float
) -> None:
    """Of one parameter that moves a level: n a^2 over the mean square in each of three runs, less
    the square of their sum over what they know together."""
    levels = (0.5, -0.25, 0.125)
    residuals = [unit * (SWINGS + a) for a in levels]
    found = disagreement(*of(residuals, [scale * LEVEL]))
    squares = [1.0 + a**2 for a in levels]
    own = [N * a**2 / s for a, s in zip(levels, squares, strict=True)]
    pulls = sum(N * a / s for a, s in zip(levels, squares, strict=True))
    common = pulls**2 / sum(N / s for s in squares)
    assert found.gain == pytest.approx(sum(own) - common)
    assert found.degrees == 2
    assert found.by_run == pytest.approx({"a": own[0], "b": own[1], "c": own[2]})
    assert list(found.by_run) == ["a", "b", "c"]
    turned = disagreement(*of(residuals[::-1], [scale * LEVEL]))
    assert list(turned.by_run) == ["c", "b", "a"]


def test_each_direction_of_each_run_is_a_degree() -> None:
    """Two parameters in four runs, of which all share two; a run's own is by its degrees."""
    residuals = [
        SWINGS + a + b * RAMP for a, b in ((0.5, 0.3), (-0.5, 0.0), (0.2, -0.4), (0.0, 0.1))
    ]
    both = disagreement(*of(residuals, [LEVEL, RAMP]))
    assert both.degrees == 6
    r = residuals[0]
    size = float(np.mean(r**2))
    level, ramp = (float(x @ r) ** 2 / float(x @ x) / size for x in (LEVEL, RAMP))
    assert both.by_run["a"] == pytest.approx(0.5 * (level + ramp), rel=1e-3)
    # What all runs share is no disagreement.
    alike = disagreement(*of([SWINGS + 0.5 + 0.3 * RAMP] * 4, [LEVEL, RAMP]))
    assert alike.gain == pytest.approx(0.0, abs=1e-6)
    assert alike.degrees == 6


def test_one_run_and_runs_of_too_few_samples_disagree_with_nobody() -> None:
    alone = disagreement(*of([SWINGS + 0.5], [LEVEL]))
    assert (alone.gain, alone.degrees) == (0.0, 0)
    assert list(alone.by_run) == ["a"]
    first = disagreement(*of([np.ones(1), SWINGS + 0.5, SWINGS - 0.5], [LEVEL]))
    assert first.degrees == 1
    assert first.gain > 50.0
    assert sorted(first.by_run) == ["b", "c"]
    tiny = disagreement(*of([SWINGS + 0.5, np.ones(1)], [LEVEL]))
    assert (tiny.gain, tiny.degrees) == (0.0, 0)
    assert list(tiny.by_run) == ["a"]


def test_an_effect_is_asked_by_itself() -> None:
    """What the law could explain in each run is taken out."""
    names = ("F_c_n", "sensor_offset.b_n")
    residuals = [SWINGS + a + b * RAMP for a, b in ((0.5, 0.3), (-0.5, 0.3), (0.2, 0.3))]
    problem, solution = of(residuals, [LEVEL, RAMP], names=names, effects=("sensor_offset",))
    found = disagreement(problem, solution, "sensor_offset")
    # Their ramps are one: of levels, in which they differ, nothing is asked.
    assert found.degrees == 2
    assert found.gain == pytest.approx(0.0, abs=0.05)
    assert disagreement(problem, solution).gain > 50.0


def test_of_peak_beside_peak_and_of_what_is_known_to_differ_nothing_is_asked() -> None:
    residuals = [SWINGS + a for a in (0.5, -0.5, 0.2)]
    names = ("drive_compliance.k_n_m_rad", "F_v_n_s_m")
    problem, solution = of(residuals, [LEVEL, RAMP], names=names, effects=("drive_compliance",))
    assert disagreement(problem, solution).gain == pytest.approx(0.0, abs=0.05)
    assert disagreement(problem, solution).degrees == 2
    tiny = tuple(np.full((N, 1), 1e-12) for _ in range(3))
    known = BetweenRuns(("F_c_n",), tiny, 1.0)
    there = disagreement(*of(residuals, [LEVEL, RAMP], between=known))
    assert there.gain == pytest.approx(0.0, abs=0.05)
    other = BetweenRuns(("zero",), tiny, 1.0)
    assert disagreement(*of(residuals, [LEVEL, RAMP], between=other)).gain > 50.0


# ---- words -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("step", "log", "words"),
    [
        (3.4, False, "F_v_n_s_m 3.4 N s/m higher"),
        (-0.5, False, "F_v_n_s_m 0.5 N s/m lower"),
        # Of a logarithm a part: exp(0.1) - 1, and 1 - exp(-0.1).
        (0.1, True, "F_v_n_s_m 10.5 % higher"),
        (-0.1, True, "F_v_n_s_m 9.52 % lower"),
        (2.99, True, "F_v_n_s_m 1.89e+03 % higher"),
        (3.01, True, "F_v_n_s_m many times as large"),
        (-3.01, True, "F_v_n_s_m many times as small"),
    ],
)
def test_what_a_run_asks_for_is_its_own_step(step: float, log: bool, words: str) -> None:
    """Of the parameter that gains it most, by itself."""
    swings = SWINGS - RAMP * float(RAMP @ SWINGS) / float(RAMP @ RAMP)
    ask = [swings, swings + 0.01 + step * RAMP, swings]
    problem, solution = of(ask, [LEVEL, RAMP], log=(False, log))
    said = own_step(problem, solution, "b")
    # The page's own unit stands behind its name.
    assert said.split()[-1] == words.split()[-1]
    assert said.startswith("F_v")
    number = [w for w in words.split() if w[0].isdigit()]
    told = [w for w in said.split() if w[0].isdigit()]
    assert [float(a) for a in told] == pytest.approx([float(a) for a in number], rel=0.02)
    assert ("%" in said) == ("%" in words)
    assert ("many times" in said) == ("many times" in words)


def test_a_column_that_moves_nothing_is_asked_for_nothing() -> None:
    problem, solution = of([SWINGS + 0.5] * 2, [LEVEL, np.zeros(N)])
    assert own_step(problem, solution, "a").startswith("F_c")


def test_runs_that_disagree_are_named_the_worst_first() -> None:
    levels = (1.0, -1.0, 0.02, 0.6, -0.6)
    problem, solution = of([SWINGS + a for a in levels], [LEVEL])
    (found,) = find_disagreement(problem, solution, DEFAULT)
    told = disagreement(problem, solution)
    assert found.axis == "parameters"
    first, second, third = list(told.by_run)[:3]
    assert {first, second} == {"a", "b"}
    assert found.where == (
        f"the runs ask for parameters that differ: run {first} asks for "
        f"{own_step(problem, solution, first)} ({told.by_run[first]:.0f} times as much as by "
        f"chance); check its load, zero and temperature (next: {second}, {third})"
    )
    assert found.share == pytest.approx((told.gain - told.degrees) / (5 * N))
    # Of the others those that ask for much.
    one, there = of([SWINGS + a for a in (1.0, 0.0, 0.01, 0.0)], [LEVEL])
    (alone,) = find_disagreement(one, there, DEFAULT)
    assert "(next:" not in alone.where
    agreed, same = of([SWINGS + a for a in (0.02, 0.0, 0.01)], [LEVEL])
    assert find_disagreement(agreed, same, DEFAULT) == []


@pytest.mark.parametrize(("known", "degrees"), [("zero", 2), ("U_tr_m_s", 0), ("gamma", 0)])
def test_a_warmer_oil_is_known_by_either_of_what_it_moves(known: str, degrees: int) -> None:
    """What runs are known to differ in otherwise says nothing of the oil."""
    residuals = [SWINGS + way * RAMP for way in (1.0, -1.0)]
    between = BetweenRuns((known,), tuple(np.ones((N, 1)) for _ in residuals), 1.0)
    problem, solution = of(residuals, [LEVEL, RAMP], between=between)
    problem.names = ["U_tr_m_s", "gamma"]
    found = disagreement(problem, solution)
    # Of two runs with two parameters each two are shared.
    assert found.degrees == (degrees or 1)
    assert (found.gain > 10.0) == (degrees > 0)


def test_units_of_parameters_are_no_matter() -> None:
    """One in microns beside one in metres."""
    residuals = [SWINGS + way * RAMP + 0.2 * LEVEL for way in (1.0, -1.0)]
    plain = disagreement(*of(residuals, [LEVEL, RAMP]))
    other = disagreement(*of(residuals, [1e6 * LEVEL, 1e-3 * RAMP]))
    assert other.gain == pytest.approx(plain.gain)
    assert other.degrees == plain.degrees


def test_a_run_of_which_nothing_is_left_asks_for_nothing() -> None:
    found = disagreement(*of([SWINGS + RAMP, 0.0 * SWINGS, SWINGS - RAMP], [LEVEL, RAMP]))
    assert np.isfinite(found.gain)
    assert found.by_run["b"] == 0.0
    assert min(found.by_run["a"], found.by_run["c"]) > 10.0


# ---- what decides, and in which directions ----------------------------------------------------


def test_runs_disagree_by_a_ratio_that_matters_and_beyond_chance() -> None:
    ratio, chance = DEFAULT.constancy_ratio, DEFAULT.constancy_chance
    many = 400
    assert not Disagreement(ratio * many - 1.0, many, {}).beyond_chance()
    assert not Disagreement(ratio * many, many, {}).beyond_chance()
    assert Disagreement(ratio * many + 1.0, many, {}).beyond_chance()
    least = float(stats.chi2.isf(chance, 3))
    assert least > ratio * 3
    assert not Disagreement(0.99 * least, 3, {}).beyond_chance()
    assert Disagreement(1.01 * least, 3, {}).beyond_chance()
    assert not Disagreement(1e9, 0, {}).beyond_chance()
    assert Disagreement(1e9, 1, {}).beyond_chance()
    easy = replace(DEFAULT, constancy_chance=0.5, constancy_ratio=1.0)
    assert Disagreement(3.5, 3, {}).beyond_chance(easy)


def test_directions_that_hardly_move_are_none() -> None:
    """Less than a thousandth of the best."""
    basis = np.linalg.qr(np.random.default_rng(1).standard_normal((20, 3)))[0]
    for unit in (1e-9, 1e9):
        assert _directions(unit * basis * [1.0, 1.1e-3, 0.9e-3]).shape == (20, 2)
    found = _directions(basis * [1.0, 2.0, 3.0])
    assert found.T @ found == pytest.approx(np.eye(3), abs=1e-12)
    assert _directions(np.zeros((20, 2))).shape == (20, 0)
    assert _directions(np.zeros((20, 0))).shape == (20, 0)


def test_what_is_set_aside_explains_nothing_and_leaves_nothing_of_itself() -> None:
    j = np.array([[1.0, 3.0], [0.0, 4.0], [0.0, 0.0]])
    r = np.array([5.0, 6.0, 7.0])
    left, rest = _set_aside(r, j, np.array([True, False]))
    assert left == pytest.approx([0.0, 6.0, 7.0])
    assert rest == pytest.approx(np.array([[0.0], [4.0], [0.0]]))
    same, whole = _set_aside(r, j, np.array([False, False]))
    assert same is r
    assert whole is j
