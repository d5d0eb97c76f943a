"""What the error of a reversal's instant makes of a reading that follows late."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import campaign
from jbf import compare, diagnose
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.estimation.reversals import instant_errors_n
from rigsim.campaign import standard
from rigsim.motions import sine

SLOW = (sine("slow", 160.0, 0.02, 0.05),)


def _true(seed: int, effects: tuple[str, ...]) -> tuple[Problem, np.ndarray, float]:
    """A campaign of slow sines, and the values by which its friction was made."""
    rig, runs, truth = campaign(seed, effects, motions=SLOW)
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", effects)
    known = {name.removesuffix("_m_s"): value for name, value in truth["base"].items()}
    for effect, values in truth["effects"].items():
        known |= {f"{effect}.{name}": value for name, value in values.items()}
    named = [name.removesuffix("_m_s").removesuffix("_s") for name in problem.names]
    return problem, np.array([known[name] for name in named]), truth["noise_n"]


def test_the_error_is_as_large_as_said() -> None:
    """The true model misses the samples behind slow reversals by as much as their instants are
    doubtful, and others by the noise."""
    doubtful, others = [], []
    for seed in range(20, 32):
        problem, values, noise_n = _true(seed, ("sensor_lag",))
        (p,), (prediction,) = problem.campaign.prepared, problem.predict(values)
        error_n = instant_errors_n(p, prediction, 0.5 * noise_n)
        miss_n = p.friction_n - prediction
        counted = p.motion.sign_known
        behind = counted & (error_n > 0.0)
        doubtful.append(miss_n[behind] / np.hypot(noise_n, error_n[behind]))
        others.append(miss_n[counted & (error_n == 0.0)] / noise_n)
        assert 0 < behind.sum() < 0.1 * counted.sum()
        # It dies away with the memory of the reading.
        assert np.max(error_n) > 2.0 * noise_n
    assert 0.4 < np.sqrt(np.mean(np.concatenate(doubtful) ** 2)) < 2.0
    assert np.sqrt(np.mean(np.concatenate(others) ** 2)) == pytest.approx(1.0, abs=0.05)


def test_nothing_is_doubtful_where_the_reading_is_at_once() -> None:
    rig, runs, _ = campaign(20, (), motions=SLOW)
    problem = Problem(Campaign.prepare(rig, runs), "journal", "journal", ("sensor_lag",))
    values = problem.starts({})[0]
    every = problem.campaign.samples
    assert problem.samples_at(values) is not every
    values[problem.names.index("sensor_lag.tau_s")] = 0.0
    assert problem.samples_at(values) is every
    bare = Problem(problem.campaign, "journal", "journal", ("coulomb_drag",))
    assert bare.samples_at(bare.starts({})[0]) is every


def test_a_late_reading_is_all_that_a_slow_reversal_shows() -> None:
    """One burst of 2.4 N behind a reversal at 0.01 m/s^2 was structure that nothing explains."""
    rig, runs, truth = campaign(8811, ("sensor_lag",), motions=standard("full").motions)
    found = diagnose(rig, runs)
    assert (found.verdict, found.effects) == ("missing", ("sensor_lag",))
    tau = found.fit.parameters["sensor_lag.tau_s"]
    assert tau.stderr is not None
    assert abs(tau.value - truth["effects"]["sensor_lag"]["tau"]) < 3.5 * tau.stderr
    assert compare(found.model, runs).rms_n < 1.03 * truth["noise_n"]
