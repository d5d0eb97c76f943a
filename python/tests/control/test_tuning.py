"""Settings of the observed compensator: their formulas, their limits, and their file."""

import math
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from jbf import InputError, Model, Rig
from jbf.control import TASKS, THESIS_BENCH, Bench, Settings, run, thesis_model, tune
from jbf.control.bench import FITTED
from jbf.control.tuning import friction_level_v

DRY = Model(Rig(), "coulomb", parameters={"F_c": 5.0, "F_s": 5.0, "F_v": 20.0})
VOLT = replace(THESIS_BENCH, volts_per_n=1.0 / 5.1)
"""A bench on which the friction of `DRY` at 5 mm/s corresponds to one volt."""


def test_friction_level_is_the_friction_at_five_millimetres_per_second() -> None:
    assert friction_level_v(DRY, VOLT) == pytest.approx(1.0, rel=1e-3)
    assert friction_level_v(DRY, replace(VOLT, volts_per_n=1.0)) == pytest.approx(5.1, rel=1e-3)
    stronger = Model(Rig(), "coulomb", parameters={"F_c": 8.0, "F_s": 8.0, "F_v": 20.0})
    assert friction_level_v(stronger, VOLT) == pytest.approx(8.1 / 5.1, rel=1e-3)


@pytest.mark.parametrize("asymmetry", [-0.4, 0.4])
def test_friction_level_is_that_of_the_direction_with_larger_friction(asymmetry: float) -> None:
    values = {n: p.value for n, p in DRY.parameters.items()}
    uneven = Model(Rig(), "coulomb", ["dry_asymmetry"], values | {"dry_asymmetry.a": asymmetry})
    assert friction_level_v(uneven, VOLT) == pytest.approx(7.1 / 5.1, rel=1e-3)


def test_friction_level_of_a_bearing_lies_just_below_its_breakaway_friction() -> None:
    """Breakaway friction is f_m times the load; the film carries up to U / U_tr of it."""
    breakaway = 0.26 * 104.0 * THESIS_BENCH.volts_per_n
    level = friction_level_v(thesis_model(elastic="nothing"))
    assert (1.0 - 0.005 / FITTED["U_tr_m_s"]) * breakaway < level <= breakaway


def test_tuned_settings_match_their_formulas_in_time_step_resolution_and_friction_level() -> None:
    level, settings = friction_level_v(DRY, VOLT), tune(DRY, VOLT)
    count_rad = 1.0 / VOLT.counts_per_rad
    speed_noise = count_rad / math.sqrt(12.0) * 60.0 * math.sqrt(60.0 * 0.002)
    assert settings.bandwidth_rad_s == pytest.approx(0.12 / 0.002)
    assert settings.learning_1_s == pytest.approx(60.0 / 30.0)
    assert settings.level_limit_v == level
    assert settings.rest_limit_v == pytest.approx(level + 0.1 * VOLT.limit_v)
    assert settings.slow_rad_s == pytest.approx(max(5.0 * speed_noise, 2.0 * count_rad * 60.0))
    assert settings.loop_rad_s == pytest.approx(60.0 / 2.0)
    assert settings.breakaway == 1.0
    assert settings.moving_v == pytest.approx(2.5 * level)
    assert settings.patience_s == pytest.approx(50 * 0.002)
    assert tune(DRY, replace(VOLT, dt_s=0.004)).bandwidth_rad_s == pytest.approx(0.12 / 0.004)


def test_bandwidth_limits_encoder_noise_to_one_percent_of_the_friction_level() -> None:
    """The standard deviation of the speed estimate is sigma w sqrt(w dt)."""
    noisy = replace(VOLT, encoder_noise_counts=40.0)
    sigma_rad = math.sqrt(1.0 / 12.0 + 40.0**2) / VOLT.counts_per_rad
    settings, level = tune(DRY, noisy), friction_level_v(DRY, VOLT)
    w = settings.bandwidth_rad_s
    assert w < 60.0
    assert sigma_rad * w * math.sqrt(w * noisy.dt_s) == pytest.approx(0.01 * level)
    assert settings.slow_rad_s == pytest.approx(5.0 * 0.01 * level)
    assert settings.learning_1_s == pytest.approx(w / 30.0)
    # The poles of the position law are at -10 +- 10i.
    assert settings.loop_rad_s == pytest.approx(math.hypot(10.0, 10.0))


def test_voltages_of_the_settings_do_not_exceed_the_voltage_limit_of_the_drive() -> None:
    level = friction_level_v(DRY, VOLT)
    assert tune(DRY, replace(VOLT, limit_v=2.0 * level)).moving_v == 2.0 * level
    assert tune(DRY, replace(VOLT, limit_v=level * (1.0 + 1e-9))).level_limit_v == level


def test_settings_for_a_friction_above_the_voltage_of_the_drive_are_rejected() -> None:
    with pytest.raises(InputError, match="--volts-per-n"):
        tune(DRY, replace(VOLT, limit_v=friction_level_v(DRY, VOLT)))


@pytest.mark.parametrize("bench", [THESIS_BENCH, replace(THESIS_BENCH, counts_per_rad=652.0)])
def test_slow_speed_limit_is_5_to_30_times_the_error_of_the_speed_estimate(bench: Bench) -> None:
    model = thesis_model()
    r = run(model, "observed", replace(TASKS["velocity sine"], seconds=12.0), bench=bench)
    error = (r.estimated_velocity_rad_s - r.velocity_rad_s)[r.time_s > 2.0]
    assert 5.0 < tune(model, bench).slow_rad_s / float(np.std(error)) < 30.0


SETTINGS = Settings(60.0, 2.0, 0.7, 1.7, 0.1, 30.0, 1.0, 1.9, 0.1)


def test_settings_are_saved_to_a_file_with_six_digits_and_loaded(tmp_path: Path) -> None:
    path = tmp_path / "s.toml"
    replace(SETTINGS, level_limit_v=0.123456789).save(path)
    assert Settings.load(path) == replace(SETTINGS, level_limit_v=0.123457)


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("patience_s", "patients", "patients"),
        ("patience_s = 0.1", "", "patience_s: is missing"),
        ("moving_v = 1.9", "moving_v = -1.9", "moving_v"),
        ("moving_v = 1.9", 'moving_v = "much"', "moving_v"),
    ],
)
def test_invalid_settings_file_is_reported_by_file_and_key(
    tmp_path: Path, old: str, new: str, named: str
) -> None:
    path, text = tmp_path / "s.toml", SETTINGS.to_toml()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=rf"s\.toml.*{named}"):
        Settings.load(path)


@pytest.mark.parametrize("name", list(asdict(SETTINGS)))
def test_setting_below_zero_or_not_finite_is_rejected_by_name(name: str) -> None:
    assert getattr(replace(SETTINGS, **{name: 0.0}), name) == 0.0
    for value in (-1e-9, math.inf, math.nan):
        with pytest.raises(InputError, match=f"{name}: {value}"):
            replace(SETTINGS, **{name: value})
