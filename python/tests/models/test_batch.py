"""Many parameter sets or motions at once give the same friction as each alone."""

from __future__ import annotations

import jbf
import numpy as np
import pytest

RIG = jbf.Rig.thesis()
LAW = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
DT_S = 0.002
SPEED = 0.127 * np.sin(np.arange(0.0, 6.3, DT_S))


def parameter_sets(count: int) -> dict[str, np.ndarray]:
    """Parameters within 20 % of `LAW`."""
    random = np.random.default_rng(1)
    return {name: value * random.uniform(0.8, 1.2, count) for name, value in LAW.items()}


def test_each_parameter_set_has_its_own_column() -> None:
    sets = parameter_sets(50)
    together = jbf.batch(RIG, SPEED, DT_S, **sets)
    assert together.shape == (len(SPEED), 50)
    for i in (0, 17, 49):
        alone = jbf.batch(RIG, SPEED, DT_S, **{name: v[i] for name, v in sets.items()})
        assert np.array_equal(alone[:, 0], together[:, i])


def test_each_motion_has_its_own_column() -> None:
    speeds = np.outer(SPEED, np.linspace(0.5, 1.5, 20))
    together = jbf.batch(RIG, speeds, DT_S, **LAW, load_n=np.full(20, 104.0))
    alone = jbf.batch(RIG, speeds[:, 7], DT_S, **LAW)
    assert np.array_equal(together[:, 7], alone[:, 0])


def test_batch_agrees_with_the_prediction_of_the_model_while_sliding() -> None:
    """Friction coefficient times the load of 104 N; both integrate by Runge-Kutta."""
    run = jbf.Run.from_arrays(np.arange(len(SPEED)) * DT_S, SPEED)
    force = jbf.Model(RIG, parameters=LAW).predict(run)
    coefficient = jbf.batch(RIG, SPEED, DT_S, **LAW, method="rk4")[:, 0]
    sliding = np.abs(SPEED) > 1e-3
    assert np.max(np.abs(104.0 * coefficient - force)[sliding]) < 1e-3


def test_sum_of_squares_is_that_of_the_differences_from_the_data() -> None:
    sets = parameter_sets(40)
    friction = jbf.batch(RIG, SPEED, DT_S, **sets)
    data = friction[:, 3]
    squares = jbf.batch(RIG, SPEED, DT_S, **sets, data=data)
    assert squares[3] == 0.0
    assert squares == pytest.approx(((friction - data[:, None]) ** 2).sum(axis=0), rel=1e-12)


def test_single_precision_is_written_into_a_given_array() -> None:
    sets = parameter_sets(40)
    out = np.empty((len(SPEED), 40), np.float32)
    single = jbf.batch(RIG, SPEED, DT_S, **sets, dtype=np.float32, out=out)
    assert single is out
    assert np.max(np.abs(single - jbf.batch(RIG, SPEED, DT_S, **sets))) < 2e-4


def test_motions_that_do_not_match_the_parameter_sets_are_refused() -> None:
    with pytest.raises(jbf.InputError, match="velocity_m_s"):
        jbf.batch(RIG, np.zeros((10, 3)), DT_S, **parameter_sets(4))
