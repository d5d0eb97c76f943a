"""Lateness of channels: words, ratios and limits of it, put together by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf.diagnosis.late_channels import (
    _clipped_rms,
    _finding,
    _gains,
    beside_its_motion,
    bought_by_lateness,
    without_delay,
)
from made_of import record, samples_of


def test_errors_count_no_more_than_at_so_many_deviations() -> None:
    """A median of 0.6745 is one deviation: 3 of 20 are cut to 2."""
    errors = np.concatenate((np.full(17, 0.6745), np.full(3, -50.0)))
    for unit in (1e-3, 1.0, 1e3):
        found = _clipped_rms(unit * errors, 2.0)
        assert found == pytest.approx(unit * np.sqrt((17 * 0.6745**2 + 3 * 4.0) / 20.0))
        whole = _clipped_rms(unit * errors, np.inf)
        assert whole == pytest.approx(unit * np.sqrt((17 * 0.6745**2 + 3 * 2500.0) / 20.0))
    assert _clipped_rms(np.zeros(0), 2.0) == 0.0
    assert _clipped_rms(np.zeros(0), np.inf) == 0.0


@pytest.mark.parametrize("independent", [True, False])
def test_a_lateness_of_each_run_gains_what_schwarz_asks(independent: bool) -> None:
    """Three runs of 200 samples: 2 n log(ratio) above 3 log(n); of samples that remember ten,
    fewer of them."""
    noise = np.random.default_rng(1).standard_normal((3, 200))
    residuals = [r if independent else np.repeat(r[:20], 10) for r in noise]
    prepared = [record(0.02 * np.arange(200), name="abc"[i]) for i in range(3)]
    samples = samples_of(prepared)
    shifted: Any = SimpleNamespace(solution=SimpleNamespace(residuals=residuals, samples=samples))
    ratio = np.exp(3.0 * np.log(600.0) / (2.0 * 600.0))
    for unit in (1e-3, 1e3):
        # At independent samples the limit is there, give or take what chance makes of the share.
        assert _gains(1.03 * ratio * unit, unit, shifted) == independent
        assert not _gains(0.995 * ratio * unit, unit, shifted)
        assert not _gains(unit, unit, shifted)
        assert _gains(2.0 * unit, unit, shifted)


@pytest.mark.parametrize(
    ("late_s", "drift", "beside"),
    [
        ((5.0, 10.0), 0.0, True),
        ((-5.0, -10.0), 0.0, True),
        ((5.1, 0.0), 0.0, False),
        ((0.0, -10.1), 0.0, False),
        ((0.0, 0.0), 1.0, True),
        ((0.0, 0.0), -1.01, False),
        ((2.4, 4.9), 0.5, True),
        ((2.6, 0.0), -0.5, False),
    ],
)
def test_no_run_is_late_by_more_than_half_of_itself(
    late_s: tuple[float, float], drift: float, beside: bool
) -> None:
    """Runs of 10 s and 20 s; at its ends one is late by half its length times the drift more."""
    prepared = [record(np.linspace(0.0, lasts, 11)) for lasts in (10.0, 20.0)]
    problem: Any = SimpleNamespace(campaign=SimpleNamespace(prepared=prepared))
    assert beside_its_motion(problem, np.array(late_s), drift) == beside


@pytest.mark.parametrize(
    ("late_s", "drift", "kind", "size", "unit", "words"),
    [
        (4.2e-3, 0.0, "late_channel", 4.2e-3, "s", "the force is 4.2 ms late against the motion"),
        (-9e-3, 0.0, "late_channel", -9e-3, "s", "the force is 9 ms early against the motion"),
        (
            12e-3,
            3e-4,
            "drifting_clock",
            3e-4,
            "1",
            "the force's clock runs slower than the motion's by 300 parts in a million: +12 ms in "
            "the middle of the run",
        ),
        (
            -1.5e-3,
            -2e-5,
            "drifting_clock",
            -2e-5,
            "1",
            "the force's clock runs faster than the motion's by 20 parts in a million: -1.5 ms in "
            "the middle of the run",
        ),
    ],
)
def test_what_was_late_is_told_with_its_size(
    late_s: float, drift: float, kind: str, size: float, unit: str, words: str
) -> None:
    found = _finding("a", late_s, drift)
    assert (found.kind, found.channel, found.run) == (kind, "friction_n", "a")
    assert (found.size, found.unit, found.done, found.words) == (size, unit, "shifted", words)


def test_effects_that_lateness_may_have_bought() -> None:
    """The instrument's own, and what moves jumps; a drag or a mass is neither."""
    bought = bought_by_lateness(("sensor_offset", "time_delay", "sensor_lag", "backlash"))
    assert {"time_delay", "sensor_lag", "sensor_offset"} <= set(bought)
    assert bought_by_lateness(("quadratic_drag", "inertia_leak")) == ()
    assert bought_by_lateness(()) == ()
    assert without_delay(("sensor_lag", "time_delay", "backlash")) == ("sensor_lag", "backlash")
