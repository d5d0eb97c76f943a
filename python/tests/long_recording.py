"""A long recording of a slide in closed form: motions separated by rests.

Coulomb and viscous friction, a moved mass and white noise; independent of jbf.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

RATE_HZ = 50
COULOMB_N, VISCOUS_N_S_M, MASS_KG, NOISE_N = 6.0, 40.0, 12.0, 0.2
_FINE = 20


@dataclass(frozen=True)
class Recording:
    """A recording with the begin and end (s) of each motion.

    Attributes
    ----------
    run
        Number of the motion at each sample; in a rest, that of the motion before.
    """

    columns: dict[str, Array]
    motions: list[tuple[float, float]]
    run: Array


def recording(motions: int, moving_s: float, resting_s: float, seed: int = 1) -> Recording:
    """Create motions in both directions, each preceded by a rest, and a final rest."""
    rng = np.random.default_rng(seed)
    speeds, spans, runs = [], [], []
    at_s = 0.0
    for number in range(motions):
        speeds.append(np.zeros(round(resting_s * RATE_HZ) * _FINE))
        at_s += resting_s
        speeds.append(_motion(moving_s, rng))
        spans.append((at_s, at_s + moving_s))
        at_s += moving_s
        runs += [np.full(round((resting_s + moving_s) * RATE_HZ), float(number))]
    speeds.append(np.zeros(round(resting_s * RATE_HZ) * _FINE))
    runs.append(np.full(round(resting_s * RATE_HZ), float(motions - 1)))
    fine = np.concatenate(speeds)
    path = np.concatenate(([0.0], np.cumsum(0.5 * (fine[1:] + fine[:-1])))) / (RATE_HZ * _FINE)
    rate = np.gradient(fine, 1.0 / (RATE_HZ * _FINE))
    v, x, a = fine[::_FINE], path[::_FINE], rate[::_FINE]
    force = COULOMB_N * np.sign(v) + VISCOUS_N_S_M * v + MASS_KG * a
    columns = {
        # The times are quotients of integers, as the clocks of all formats represent them.
        "time_s": np.arange(len(v)) / RATE_HZ,
        "position_m": np.round(x, 6),
        "velocity_m_s": np.where(v == 0.0, 0.0, v + 1e-5 * rng.standard_normal(len(v))),
        "friction_n": force + NOISE_N * rng.standard_normal(len(v)),
        "load_n": np.full(len(v), 80.0),
    }
    return Recording(columns, spans, np.concatenate(runs))


def _motion(duration_s: float, rng: np.random.Generator) -> Array:
    time = np.arange(round(duration_s * RATE_HZ) * _FINE) / (RATE_HZ * _FINE)
    rates = 2.0 * np.pi * rng.uniform(0.1, 0.6, 3)
    sizes, phases = rng.uniform(0.05, 0.15, 3), rng.uniform(0.0, 2.0 * np.pi, 3)
    waves = sizes @ np.sin(rates[:, None] * time + phases[:, None])
    # The speed rises and falls within one second.
    edge = np.clip(np.minimum(time, time[-1] - time), 0.0, 1.0)
    speed: Array = waves * edge**2 * (3.0 - 2.0 * edge)
    return speed
