"""A late friction record predicted sharply, against the law shifted in time by hand."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import LAW, Array
from jbf import Model, Rig, Run

TAU_S = 0.033
STEP_S = 0.02
TIME = np.arange(0.0, 12.0, STEP_S)


def late_coulomb() -> Model:
    return Model(
        Rig(),
        law="coulomb",
        effects=["time_delay"],
        parameters={**LAW, "F_s_n": LAW["F_c_n"], "time_delay.tau_s": TAU_S},
    )


def friction(v: Array) -> Array:
    found: Array = LAW["F_c_n"] * np.sign(v) + LAW["F_v_n_s_m"] * v
    return found


def test_reversals_stay_sharp() -> None:
    rate = 1.7
    run = Run.from_arrays(TIME, 0.1 * np.sin(rate * TIME + 0.3))
    late = friction(0.1 * np.sin(rate * (TIME - TAU_S) + 0.3))
    jumps = (np.pi * np.arange(1, 8) - 0.3) / rate + TAU_S
    near = np.min(np.abs(TIME[:, None] - jumps[None, :]), axis=1) < TAU_S / 40.0
    settled = (TIME > 3.0 * TAU_S) & ~near
    error = np.abs(late_coulomb().predict(run) - late)[settled]
    # Half a dozen reversals, and no sample that is neither before nor after.
    assert np.count_nonzero(np.diff(np.sign(late))) >= 6
    assert np.max(error) < 0.02 * LAW["F_c_n"]


@pytest.mark.parametrize("begins", [2.004, 2.0101, 2.0163])
def test_a_start_from_rest_is_where_the_acceleration_says(begins: float) -> None:
    v = 0.02 * np.maximum(TIME - begins, 0.0)
    run = Run.from_arrays(TIME, v)
    late = friction(0.02 * np.maximum(TIME - TAU_S - begins, 0.0))
    error = np.abs(late_coulomb().predict(run) - late)
    assert np.max(error) < 0.02 * LAW["F_c_n"]


def test_without_a_delay_nothing_changes() -> None:
    run = Run.from_arrays(TIME, 0.1 * np.sin(1.7 * TIME + 0.3))
    values = {**LAW, "F_s_n": LAW["F_c_n"]}
    plain = Model(Rig(), law="coulomb", parameters=values).predict(run)
    null = Model(
        Rig(),
        law="coulomb",
        effects=["time_delay"],
        parameters={**values, "time_delay.tau_s": 0.0},
    ).predict(run)
    np.testing.assert_array_equal(plain, null)
