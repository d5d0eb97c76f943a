"""Force that is late by more than a sample: a lag of the sensor, or a delay of the channel."""

import numpy as np
import pytest
from jbf import Drive, Rig, Run, diagnose
from known_motions import quantised
from scipy.signal import lfilter

FINE_S, EVERY = 0.0005, 8
INERTIA_KG_M2, COULOMB_N_M, VISCOUS_N_M_S, WEIGHT_N_M = 0.15, 1.1, 0.25, 2.0
NOISE_N_M = 0.05


def _moved_by_hand(seed: int, late: str, late_s: float) -> Run:
    """A joint moved by a hand with tremor, with a torque sensor and an encoder of 13 bits.

    The torque is filtered with the time constant `late_s` or delayed by it, as `late` states.
    """
    random = np.random.default_rng([5312, seed])
    time_s = np.arange(0.0, 8.0, FINE_S)
    x, v, a = np.zeros((3, len(time_s)))
    slow = [(1.4 / w, w) for w in random.uniform(0.6, 3.0, 4)]
    tremor = [(min(0.5 / 6.0, 3.0 / w), w) for w in 2.0 * np.pi * random.uniform(4.0, 9.0, 6)]
    for amplitude, omega in (*slow, *tremor):
        phase = random.uniform(0.0, 2.0 * np.pi)
        x += amplitude / omega * np.sin(omega * time_s + phase)
        v += amplitude * np.cos(omega * time_s + phase)
        a -= amplitude * omega * np.sin(omega * time_s + phase)
    torque = COULOMB_N_M * np.sign(v) + VISCOUS_N_M_S * v + INERTIA_KG_M2 * a
    torque += WEIGHT_N_M * np.sin(x)
    if late == "lag":
        share = -np.expm1(-FINE_S / late_s)
        torque = lfilter([share], [1.0, share - 1.0], torque)
    else:
        steps = round(late_s / FINE_S)
        torque = np.concatenate([np.full(steps, torque[0]), torque[:-steps]])
    kept = slice(round(1.0 / FINE_S), None, EVERY)
    torque = torque[kept] + NOISE_N_M * random.standard_normal(len(torque[kept]))
    angle = quantised(x[kept], 2.0 * np.pi / 2**13)
    return Run.from_arrays(time_s[kept], None, torque, angle_rad=angle, name=f"hand {seed}")


@pytest.mark.parametrize(("late", "late_s"), [("lag", 0.01), ("lag", 0.03), ("delay", 0.01)])
def test_lag_of_the_sensor_is_named_and_a_delay_of_the_channel_is_corrected(
    late: str, late_s: float
) -> None:
    runs = [_moved_by_hand(seed, late, late_s) for seed in range(2)]
    found = diagnose(Rig(drive=Drive("rotary", "torque")), runs, law="coulomb")
    assert found.effects == (("sensor_lag",) if late == "lag" else ()), found.summary()
    values = found.fit.params
    assert values["inertia.m_e"] == pytest.approx(INERTIA_KG_M2, rel=0.02)
    assert values["F_c"] == pytest.approx(COULOMB_N_M, rel=0.02)
    if late == "lag":
        assert values["sensor_lag.tau_s"] == pytest.approx(late_s, rel=0.1)
    else:
        assert found.model.force_delay_s == pytest.approx(late_s, rel=0.1)
