"""What a tuned compensator owes to the encoder, the friction and the step of the loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from jbf import control
from jbf.control.bench import THESIS_BENCH, thesis_model, with_noise
from jbf.control.tuning import friction_level_v

COARSE = replace(THESIS_BENCH, counts_per_rad=652.0)


@pytest.mark.parametrize("bench", [THESIS_BENCH, COARSE])
def test_a_shaft_is_slow_up_to_some_times_what_its_speed_is_known_to(bench: control.Bench) -> None:
    """Slower than that its direction is a guess; much faster, compensation would wait."""
    model = thesis_model()
    task = replace(control.TASKS["velocity sine"], seconds=12.0)
    r = control.run(model, "observed", task, bench=bench)
    error = (r.estimated_velocity_rad_s - r.velocity_rad_s)[r.time_s > task.skip_s]
    ratio = control.tune(model, bench).slow_rad_s / float(np.std(error))
    assert 5.0 < ratio < 30.0


def test_limits_follow_from_the_friction() -> None:
    model = thesis_model()
    settings, level_v = control.tune(model), friction_level_v(model)
    assert settings.level_limit_v == pytest.approx(level_v)
    assert settings.rest_limit_v == pytest.approx(level_v + 0.1 * THESIS_BENCH.limit_v)
    # It surely moves the shaft, were friction twice what the model says.
    assert 2.0 * level_v < settings.moving_v < THESIS_BENCH.limit_v


def test_bandwidth_goes_with_the_step_until_noise_bounds_it() -> None:
    model = thesis_model()
    slow = replace(THESIS_BENCH, dt_s=0.004)
    assert control.tune(model).bandwidth_rad_s == pytest.approx(0.12 / 0.002)
    assert control.tune(model, slow).bandwidth_rad_s == pytest.approx(0.12 / 0.004)
    noisy = control.tune(model, with_noise(THESIS_BENCH, 30.0))
    assert noisy.bandwidth_rad_s < 0.5 * control.tune(model).bandwidth_rad_s
    assert noisy.learning_1_s == pytest.approx(noisy.bandwidth_rad_s / 30.0)


def test_an_encoder_that_is_too_coarse_does_not_soften_the_loop() -> None:
    noisy = control.tune(thesis_model(), with_noise(THESIS_BENCH, 30.0))
    assert noisy.loop_rad_s == pytest.approx(np.sqrt(200.0))
