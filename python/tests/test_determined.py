"""The one rule of what runs determined, as a table: pages, values and errors made up."""

from __future__ import annotations

import math

import pytest
from jbf import Parameter
from jbf.estimation.determined import (
    NEVER_MOVED,
    NOT_SEPARATE,
    at_null,
    idle_effects,
    undetermined,
)

SCALE = Parameter("v_s_m_s", lower=1e-7, upper=1e3, starts=(0.01,), log=True)
PLAIN = Parameter("F_v_n_s_m", lower=0.0, upper=1e7, starts=(10.0,))
SIGNED = Parameter("b_n", lower=-1e5, upper=1e5, null=0.0, starts=(0.3,))
DRAG = Parameter("F_d_n", lower=0.0, upper=1e4, null=0.0, starts=(0.5,))
STIFF = Parameter("sigma_1_m", lower=1.0, upper=1e12, null=math.inf, starts=(3e3,), log=True)
FACTOR = Parameter("factor", lower=1e-3, upper=1e3, null=1.0, starts=(0.5,), log=True)
SHARE = Parameter("share", lower=0.0, upper=1.0, null=1.0, starts=(0.5,))

LARGER = "its error, {}, is larger than itself: these runs {}"
TABLE = [
    # What has an error smaller than itself is determined, however small it is beside its bounds.
    (PLAIN, 9.9, 0.1, {}, None),
    (PLAIN, 0.003, 0.001, {}, None),
    (PLAIN, 3.0, 3.0, {}, None),
    (SCALE, 0.02, 0.019, {}, None),
    # A signed one may be nought, give or take.
    (SIGNED, 0.0, 0.1, {}, None),
    (SIGNED, -0.01, 0.1, {}, None),
    # Bounds.
    (PLAIN, 0.0, 3.0, {}, "at its lower bound 0: the runs ask for less"),
    (PLAIN, 1e-9, 3.0, {}, "at its lower bound 0: the runs ask for less"),
    (PLAIN, 1e7, 3.0, {}, "at its upper bound 1e+07: the runs ask for more"),
    (SCALE, 1e-7, 1e-9, {}, "at its lower bound 1e-07: the runs ask for less"),
    (SCALE, 1e3, math.nan, {}, "at its upper bound 1000: the runs ask for more"),
    (SIGNED, 1e5, 1.0, {}, "at its upper bound 100000: the runs ask for more"),
    # With no error, and with none that is known.
    (PLAIN, 0.0, 0.0, {}, "at its lower bound 0: the runs ask for less"),
    (PLAIN, 0.0, math.nan, {}, "at its lower bound 0: the runs ask for less"),
    # Within a millionth of the error, or of the width in the logarithm, which is 23.
    (PLAIN, 1e-6 * 2.0**20, 2.0**20, {}, "at its lower bound 0: the runs ask for less"),
    (
        PLAIN,
        1.1e-6 * 2.0**20,
        2.0**20,
        {},
        LARGER.format("1e+06", "tell only that it is below 2.1e+06"),
    ),
    (SCALE, 1e-7 * math.exp(2.2e-5), 1e-12, {}, "at its lower bound 1e-07: the runs ask for less"),
    (SCALE, 1e-7 * math.exp(2.4e-5), 1e-12, {}, None),
    # A scale that is less than its error.
    (PLAIN, 3.0, 4.0, {}, LARGER.format("4", "tell only that it is below 11")),
    (PLAIN, 3e6, 4e6, {}, LARGER.format("4e+06", "do not tell its size")),
    (PLAIN, 2e6, 3.9e6, {}, LARGER.format("3.9e+06", "tell only that it is below 9.8e+06")),
    (PLAIN, 2e6, 4e6, {}, LARGER.format("4e+06", "do not tell its size")),
    (SCALE, 1e-4, 28.0, {}, LARGER.format("28", "do not tell its size")),
    (SCALE, 1.0, math.inf, {}, LARGER.format("inf", "do not tell its size")),
    # Nothing moves, or not alone.
    (PLAIN, 9.9, math.nan, {"moved": False}, NEVER_MOVED),
    (SCALE, 1e-7, math.nan, {"moved": False}, NEVER_MOVED),
    (PLAIN, 9.9, 0.1, {"separate": False}, NOT_SEPARATE),
    (SIGNED, 0.3, 1e6, {"separate": False}, NOT_SEPARATE),
    (PLAIN, 0.0, 0.1, {"separate": False}, "at its lower bound 0: the runs ask for less"),
]


@pytest.mark.parametrize(("page", "value", "error", "seen", "said"), TABLE)
def test_the_rule(
    page: Parameter, value: float, error: float, seen: dict[str, bool], said: str | None
) -> None:
    assert undetermined(page, value, error, **seen) == said


@pytest.mark.parametrize(
    ("page", "value", "error", "fixed", "there"),
    [
        (DRAG, 0.0, 0.1, False, True),
        (DRAG, 1e-9, 0.1, False, True),
        (DRAG, 0.01, 0.1, False, False),
        (STIFF, 1e12, math.nan, False, True),
        (STIFF, math.inf, math.nan, False, True),
        (STIFF, 1e11, math.nan, False, False),
        (STIFF, 1.0, math.nan, False, False),
        # A null that is a bound stops it, whichever.
        (SHARE, 1.0, 0.1, False, True),
        (SHARE, 1.0 - 1e-9, 0.1, False, True),
        (SHARE, 0.5, 0.1, False, False),
        (SHARE, 0.0, 0.1, False, False),
        # Nothing stops a fit at a null between the bounds; a user may hold it there.
        (SIGNED, 0.0, 0.1, False, False),
        (SIGNED, 0.0, math.nan, True, True),
        (FACTOR, 1.0, 0.1, False, False),
        (PLAIN, 0.0, 0.1, True, False),
        (DRAG, 1e-9, math.nan, True, False),
    ],
)
def test_at_its_null(page: Parameter, value: float, error: float, fixed: bool, there: bool) -> None:
    assert at_null(page, value, error, fixed=fixed) is there


def test_an_effect_is_idle_where_all_its_nulls_are_reached() -> None:
    pages = {
        "F_v_n_s_m": PLAIN,
        "one.F_d_n": DRAG,
        "one.v_s_m_s": SCALE,
        "two.F_d_n": DRAG,
        "two.b_n": SIGNED,
        "three.sigma_1_m": STIFF,
        "four.v_s_m_s": SCALE,
    }
    effects = ("one", "two", "three", "four")
    values = [0.0, 0.0, 5.0, 0.0, 0.0, 1e12, 1e-7]
    assert idle_effects(effects, pages, values) == ("one", "three")
    assert idle_effects(effects, pages, values, fixed=("two.b_n",)) == ("one", "two", "three")
    values[1] = 1e-9
    assert idle_effects(effects, pages, values) == ("three",)
    assert idle_effects(effects, pages, values, {"one.F_d_n": 0.1}) == ("one", "three")
