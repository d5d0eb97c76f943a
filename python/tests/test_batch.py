"""Many parameter sets at once."""

import jbf
import numpy as np
import pytest

RIG = jbf.Rig.thesis()
TABLE = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
DT_S = 0.002
SPEED = 0.127 * np.sin(np.arange(0.0, 6.3, DT_S))


def sets(count: int) -> dict[str, np.ndarray]:
    random = np.random.default_rng(1)
    return {name: value * random.uniform(0.8, 1.2, count) for name, value in TABLE.items()}


def test_one_set_is_a_column_of_many() -> None:
    many = sets(50)
    together = jbf.batch(RIG, SPEED, DT_S, **many)
    assert together.shape == (len(SPEED), 50)
    for i in (0, 17, 49):
        alone = jbf.batch(RIG, SPEED, DT_S, **{name: v[i] for name, v in many.items()})
        assert (alone[:, 0] == together[:, i]).all()


def test_one_motion_a_set() -> None:
    speeds = np.outer(SPEED, np.linspace(0.5, 1.5, 20))
    together = jbf.batch(RIG, speeds, DT_S, **TABLE, load_n=np.full(20, 104.0))
    alone = jbf.batch(RIG, speeds[:, 7], DT_S, **TABLE)
    assert (together[:, 7] == alone[:, 0]).all()


def test_the_model_predicts_the_same() -> None:
    """Runge-Kutta at the same step, a load of 104 N, and the landing on reversals apart."""
    time_s = np.arange(len(SPEED)) * DT_S
    run = jbf.Run.from_arrays(time_s, SPEED)
    force = jbf.Model(RIG, parameters=TABLE).predict(run)
    coefficient = jbf.batch(RIG, SPEED, DT_S, **TABLE, method="rk4")[:, 0]
    moving = np.abs(SPEED) > 1e-3
    assert np.abs(104.0 * coefficient - force)[moving].max() < 1e-3


def test_squares() -> None:
    many = sets(40)
    friction = jbf.batch(RIG, SPEED, DT_S, **many)
    data = friction[:, 3]
    squares = jbf.batch(RIG, SPEED, DT_S, **many, data=data)
    assert squares[3] == 0.0
    assert squares == pytest.approx(((friction - data[:, None]) ** 2).sum(axis=0), rel=1e-12)


def test_single_precision_and_out() -> None:
    many = sets(40)
    out = np.empty((len(SPEED), 40), np.float32)
    single = jbf.batch(RIG, SPEED, DT_S, **many, dtype=np.float32, out=out)
    assert single is out
    assert np.abs(single - jbf.batch(RIG, SPEED, DT_S, **many)).max() < 2e-4


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"f_m": [0.1, 0.2], "K0": [1e5, 2e5, 3e5]}, "f_m"),
        ({"f_m": "much"}, "f_m"),
        ({"K0": -1.0}, "K0"),
        ({"dt_s": 0.0}, "dt_s"),
        ({"dtype": np.int64}, "dtype"),
        ({"method": "leapfrog"}, "leapfrog"),
        ({"clock": "sundial"}, "sundial"),
        ({"velocity_m_s": np.zeros((10, 3))}, "velocity_m_s"),
        ({"velocity_m_s": [0.1, np.nan]}, "velocity_m_s"),
        ({"data": [1.0]}, "data"),
        ({"out": np.empty(3)}, "out"),
    ],
)
def test_wrong_input_is_named(change: dict[str, object], named: str) -> None:
    arguments = {"velocity_m_s": SPEED, "dt_s": DT_S, **TABLE, **change}
    with pytest.raises(jbf.InputError, match=named):
        jbf.batch(RIG, **arguments)
