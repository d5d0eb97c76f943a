"""The friction of many parameter sets or motions in one call equals that of separate calls."""

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


def test_batch_column_of_each_parameter_set_equals_its_separate_batch() -> None:
    sets = parameter_sets(50)
    batch = jbf.batch(RIG, SPEED, DT_S, **sets)
    assert batch.shape == (len(SPEED), 50)
    for i in (0, 17, 49):
        separate = jbf.batch(RIG, SPEED, DT_S, **{name: v[i] for name, v in sets.items()})
        assert np.array_equal(separate[:, 0], batch[:, i])


def test_batch_column_of_each_motion_equals_its_separate_batch() -> None:
    speeds = np.outer(SPEED, np.linspace(0.5, 1.5, 20))
    batch = jbf.batch(RIG, speeds, DT_S, **LAW, load_n=np.full(20, 104.0))
    assert np.array_equal(batch[:, 7], jbf.batch(RIG, speeds[:, 7], DT_S, **LAW)[:, 0])


def test_batch_agrees_with_the_prediction_of_the_model_while_sliding() -> None:
    """The force is the friction coefficient times the load of 104 N; both use Runge-Kutta."""
    run = jbf.Run.from_arrays(np.arange(len(SPEED)) * DT_S, SPEED)
    force = jbf.Model(RIG, parameters=LAW).predict(run)
    coefficient = jbf.batch(RIG, SPEED, DT_S, **LAW, method="rk4")[:, 0]
    assert np.max(np.abs(104.0 * coefficient - force)[np.abs(SPEED) > 1e-3]) < 1e-3


def test_batch_with_data_returns_the_sums_of_squared_differences() -> None:
    sets = parameter_sets(40)
    friction = jbf.batch(RIG, SPEED, DT_S, **sets)
    data = friction[:, 3]
    squares = jbf.batch(RIG, SPEED, DT_S, **sets, data=data)
    assert squares[3] == 0.0
    assert squares == pytest.approx(((friction - data[:, None]) ** 2).sum(axis=0), rel=1e-12)


def test_single_precision_batch_is_written_into_the_given_out_array() -> None:
    sets, out = parameter_sets(40), np.empty((len(SPEED), 40), np.float32)
    single = jbf.batch(RIG, SPEED, DT_S, **sets, dtype=np.float32, out=out)
    assert single is out
    assert np.max(np.abs(single - jbf.batch(RIG, SPEED, DT_S, **sets))) < 2e-4


def test_batch_is_refused_if_the_numbers_of_motions_and_parameter_sets_differ() -> None:
    with pytest.raises(jbf.InputError, match="velocity_m_s"):
        jbf.batch(RIG, np.zeros((10, 3)), DT_S, **parameter_sets(4))
