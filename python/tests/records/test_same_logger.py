"""Reading errors of other runs of the logger as additional starts of an estimation."""

from dataclasses import replace

import pytest
from jbf.records.motion.same_logger import further_starts
from jbf.records.motion.smoothing import Smoothed, smooth
from read_motions import motion_of, readings_of


@pytest.fixture(scope="module")
def trapezoids() -> Smoothed:
    position, velocity, _ = motion_of("trapezoids", 1200)
    return smooth(readings_of(position, velocity))


def with_errors(motion: Smoothed, **changed: float) -> Smoothed:
    return replace(motion, errors=replace(motion.errors, **changed))


def test_no_starts_are_added_if_the_runs_have_equal_reading_errors(trapezoids: Smoothed) -> None:
    other = with_errors(trapezoids, velocity_variance=3.0 * trapezoids.errors.velocity_variance)
    assert further_starts([trapezoids]) == ()
    assert further_starts([trapezoids, other, other]) == ()


@pytest.mark.parametrize(
    "changed",
    [{"velocity_variance": 1e-2}, {"position_variance": 1e-3}, {"velocity_delay_s": 2e-3}],
)
def test_reading_errors_that_differ_between_runs_become_additional_starts(
    trapezoids: Smoothed, changed: dict[str, float]
) -> None:
    other = with_errors(trapezoids, **changed)
    found = further_starts([trapezoids, other, *[trapezoids] * 3])
    assert set(found) == {trapezoids.errors, other.errors}


def test_poor_additional_start_of_the_reading_errors_does_not_change_the_estimates(
    trapezoids: Smoothed,
) -> None:
    """A start with an exact velocity and a jerk that follows every reading."""
    bad = replace(trapezoids.errors, velocity_variance=1e-12, intensity=1e8)
    assert smooth(trapezoids.readings, [bad]).errors == trapezoids.errors
