"""Paired test over independent units: runs, or strokes if there are few runs."""

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.level import Level
from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out import errors_by_run
from scipy import stats

OFFSET = "sensor_offset"


def level(chance: float, min_share: float = 0.0) -> Level:
    """The level of a test, and the minimum relative decrease of the mean square."""
    return Level(chance, 1, chance, min_share=min_share)


def candidates(runs: int, offset_n: float, seconds: float = 6.0) -> Candidates:
    """Coulomb and viscous friction of 3 N and 20 N s/m with noise of 0.3 N."""
    rng = np.random.default_rng([runs, 7])
    time = 0.01 * np.arange(int(100 * seconds))
    recorded = []
    for k in range(runs):
        speed = 0.1 * np.sin((2.0 + 0.2 * k) * time + 0.3)
        force = 3.0 * np.sign(speed) + 20.0 * speed + offset_n + 0.3 * rng.normal(size=len(time))
        recorded.append(Run.from_arrays(time, speed, force, name=f"run{k:02d}"))
    return Candidates(Campaign.prepare(Rig(), recorded), "coulomb", "journal")


def test_p_value_of_a_confirmation_is_that_of_a_one_sided_t_test_over_runs() -> None:
    tried = candidates(8, 0.03)
    found = tried.confirmation((), OFFSET)
    without, with_it = (
        errors_by_run(tried.converge(effects), tried.held_out_parts(effects))
        for effects in ((), (OFFSET,))
    )
    ratios = [np.log(np.mean(without[i] ** 2) / np.mean(with_it[i] ** 2)) for i in without]
    expected = stats.ttest_1samp(ratios, 0.0, alternative="greater").pvalue
    assert found.units == 8
    assert found.chance == pytest.approx(expected, rel=1e-6)


def test_strokes_are_the_independent_units_if_there_are_few_runs() -> None:
    """Three runs of six seconds at 2, 2.2 and 2.4 rad/s have four or five strokes each."""
    found = candidates(3, 0.3).confirmation((), OFFSET)
    assert 12 <= found.units <= 15
    assert found.units_confirm(level(1e-3))


def test_significant_effect_below_the_minimum_size_is_not_confirmed() -> None:
    found = candidates(8, 0.3).confirmation((), OFFSET)
    explained = 1.0 - (found.after_n / found.before_n) ** 2
    assert found.units_confirm(level(1e-3, 0.9 * explained))
    assert not found.units_confirm(level(1e-3, 1.1 * explained))


def test_absent_effect_is_not_confirmed() -> None:
    assert not candidates(12, 0.0).confirmation((), OFFSET).units_confirm(level(1e-3))


def test_effect_is_not_confirmed_by_fewer_than_six_units() -> None:
    """Two runs that contain fewer than two strokes each."""
    found = candidates(2, 1.0, seconds=1.5).confirmation((), OFFSET)
    assert found.units < 6
    assert not found.units_confirm(level(0.5))
