"""Numbers gone wild are put back where nothing changes: by a made-up model of a few parameters."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Parameter
from jbf.estimation.determined import NEVER_MOVED, NO_EFFECT
from jbf.estimation.put_back import PutBack, put_back
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
N = 50
NOISE_N = 0.5
RESIDUAL = NOISE_N * np.where(np.arange(N) % 2, 1.0, -1.0)
PAGES = {
    "F_c_n": Parameter("F_c_n", lower=0.0, upper=1e4, starts=(4.0,)),
    "v_s_m_s": Parameter("v_s_m_s", lower=1e-7, upper=1e3, starts=(0.01,), log=True),
    "one.F_d_n": Parameter("F_d_n", lower=0.0, upper=1e4, null=0.0, starts=(0.5,)),
    "one.tau_s": Parameter("tau_s", lower=1e-3, upper=1e3, starts=(2.0,), log=True),
    "two.sigma": Parameter("sigma", lower=1.0, upper=1e12, null=math.inf, starts=(3e3,), log=True),
}
NAMES = tuple(PAGES)


def found(
    values: dict[str, float],
    moved: dict[str, bool],
    *,
    walls: dict[str, tuple[float, float]] | None = None,
    start: dict[str, float] | None = None,
    jump_n: float = 1.0,
    left: Array = RESIDUAL,
) -> PutBack:
    """Of a model that predicts the same while each parameter is within its walls, and differs by
    `jump_n` everywhere beyond."""
    whole = np.array([values.get(name, 1.0) for name in NAMES])
    inside = walls or {}

    def residuals(there: Array) -> list[Array]:
        out = [
            name
            for name, value in zip(NAMES, there.tolist(), strict=True)
            if not inside.get(name, (-math.inf, math.inf))[0]
            <= value
            <= inside.get(name, (-math.inf, math.inf))[1]
        ]
        return [left + jump_n * bool(out)]

    prepared = [record(0.02 * np.arange(N), friction=np.full(N, 1e3))]
    problem: Any = SimpleNamespace(
        open=list(range(len(NAMES))),
        names=NAMES,
        parameters=PAGES,
        effects=("one", "two"),
        fixed={},
        residuals=residuals,
        campaign=SimpleNamespace(prepared=prepared),
    )
    solution: Any = SimpleNamespace(values=whole, residuals=[left], samples=samples_of(prepared))
    spread: Any = SimpleNamespace(
        moved=np.array([moved.get(name, True) for name in NAMES]), error=lambda k: 0.1
    )
    return put_back(problem, solution, spread, start or {})


def value(result: PutBack, name: str) -> float:
    return float(result.values[NAMES.index(name)])


def test_what_the_runs_depend_on_stays() -> None:
    kept = found({"F_c_n": 77.0, "v_s_m_s": 1e-6}, {})
    assert kept.notes == {}
    assert value(kept, "F_c_n") == 77.0
    assert value(kept, "v_s_m_s") == 1e-6
    assert kept.residuals[0] is RESIDUAL


@pytest.mark.parametrize(
    ("name", "start", "home"),
    [
        ("F_c_n", {}, 4.0),
        ("F_c_n", {"F_c_n": 6.0}, 6.0),
        ("v_s_m_s", {}, 0.01),
        # An effect goes to where it is none, unless the user had it start elsewhere.
        ("one.F_d_n", {}, 0.0),
        ("one.F_d_n", {"one.F_d_n": 0.25}, 0.25),
        ("two.sigma", {}, math.inf),
    ],
)
def test_what_never_moved_goes_home(name: str, start: dict[str, float], home: float) -> None:
    back = found({name: 900.0}, {name: False}, start=start)
    assert value(back, name) == home
    assert back.notes == {name: NEVER_MOVED}
    others = [other for other in NAMES if other != name]
    assert [value(back, other) for other in others] == [1.0] * len(others)


@pytest.mark.parametrize(
    ("name", "wild", "wall", "there"),
    [
        # From 900 to 4 half of the way is 452, a quarter 676, an eighth 788.
        ("F_c_n", 900.0, 400.0, 452.0),
        ("F_c_n", 900.0, 500.0, 676.0),
        ("F_c_n", 900.0, 700.0, 788.0),
        ("F_c_n", 900.0, 800.0, 900.0),
        # From 100 to 0.01 in the logarithm: by 4, of which half, a quarter, an eighth.
        ("v_s_m_s", 100.0, 0.5, 1.0),
        ("v_s_m_s", 100.0, 5.0, 10.0),
        ("v_s_m_s", 100.0, 20.0, 10.0**1.5),
    ],
)
def test_where_home_predicts_otherwise_part_of_the_way_is_gone(
    name: str, wild: float, wall: float, there: float
) -> None:
    back = found({name: wild}, {name: False}, walls={name: (wall, math.inf)})
    assert value(back, name) == pytest.approx(there)
    home = PAGES[name].starts[0]
    assert back.notes == {name: f"flat here: these runs tell only that it is not {home:.3g}"}


def test_the_whole_way_home_ends_there_to_the_bit() -> None:
    """0.7 and what 0.1 is less than that are not 0.1."""
    assert 0.7 + (0.1 - 0.7) != 0.1
    back = found({"F_c_n": 0.7}, {"F_c_n": False}, start={"F_c_n": 0.1})
    assert value(back, "F_c_n") == 0.1


def test_there_is_no_half_of_the_way_to_infinity() -> None:
    back = found({"two.sigma": 900.0}, {"two.sigma": False}, walls={"two.sigma": (0.0, 1e6)})
    assert value(back, "two.sigma") == 900.0
    assert back.notes == {"two.sigma": "flat here: these runs tell only that it is not inf"}


@pytest.mark.parametrize(("share", "same"), [(0.9, True), (1.1, False)])
def test_the_same_is_within_a_ten_thousandth_of_the_residual(share: float, same: bool) -> None:
    """And a thousand-millionth of a friction of 1 kN, which is a micro-newton."""
    least = float(np.hypot(1e-4 * NOISE_N, 1e-9 * 1e3))
    back = found(
        {"F_c_n": 900.0}, {"F_c_n": False}, walls={"F_c_n": (899.0, 901.0)}, jump_n=share * least
    )
    assert (value(back, "F_c_n") == 4.0) == same


@pytest.mark.parametrize(("share", "same"), [(0.99, True), (1.01, False)])
def test_where_nothing_is_left_the_friction_says_what_is_the_same(share: float, same: bool) -> None:
    """A micro-newton of 1 kN."""
    back = found(
        {"F_c_n": 900.0},
        {"F_c_n": False},
        walls={"F_c_n": (899.0, 901.0)},
        jump_n=share * 1e-6,
        left=np.zeros(N),
    )
    assert (value(back, "F_c_n") == 4.0) == same


def test_the_residuals_are_those_at_the_values() -> None:
    back = found({"F_c_n": 900.0}, {"F_c_n": False}, walls={"F_c_n": (899.0, 901.0)}, jump_n=1e-6)
    assert back.residuals[0] == pytest.approx(RESIDUAL + 1e-6, abs=1e-12)


def test_an_effect_that_ended_at_its_null_goes_there() -> None:
    """With all of its parameters: one that has no null goes where it starts."""
    back = found({"one.F_d_n": 1e-9, "one.tau_s": 333.0}, {})
    assert (value(back, "one.F_d_n"), value(back, "one.tau_s")) == (0.0, 2.0)
    assert back.notes == {"one.F_d_n": NO_EFFECT, "one.tau_s": NO_EFFECT}
    begun = found({"one.F_d_n": 1e-9, "one.tau_s": 333.0}, {}, start={"one.tau_s": 7.0})
    assert value(begun, "one.tau_s") == 7.0
    # Where that predicts otherwise it stays as it is, and nothing is said.
    kept = found({"one.F_d_n": 1e-9, "one.tau_s": 333.0}, {}, walls={"one.tau_s": (300.0, 400.0)})
    assert (value(kept, "one.F_d_n"), value(kept, "one.tau_s")) == (1e-9, 333.0)
    assert kept.notes == {}
    # What has been noted is not looked at again.
    both = found(
        {"one.F_d_n": 1e-9, "one.tau_s": 333.0}, {"one.tau_s": False}, start={"one.tau_s": 7.0}
    )
    assert both.notes["one.tau_s"] == NO_EFFECT
    gone = found({"two.sigma": 1e12}, {})
    assert value(gone, "two.sigma") == math.inf
