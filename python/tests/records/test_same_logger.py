"""Reading errors of runs of one logger as further starts of one another's estimation."""

from dataclasses import replace

import pytest
from jbf.records.motion.em import evidence
from jbf.records.motion.readings import ReadingErrors
from jbf.records.motion.same_logger import further_starts
from jbf.records.motion.smoothing import Smoothed, smooth
from read_motions import motion_of, readings_of


@pytest.fixture(scope="module")
def trapezoids() -> Smoothed:
    position, velocity, _ = motion_of("trapezoids", 1200)
    return smooth(readings_of(position, velocity))


def with_errors(motion: Smoothed, **changed: float) -> Smoothed:
    return replace(motion, errors=replace(motion.errors, **changed))


def test_runs_with_the_same_errors_need_no_further_starts(trapezoids: Smoothed) -> None:
    other = with_errors(trapezoids, velocity=3.0 * trapezoids.errors.velocity)
    assert further_starts([trapezoids]) == ()
    assert further_starts([trapezoids, other, other]) == ()


@pytest.mark.parametrize(
    "changed", [{"velocity": 1e-2}, {"position": 1e-3}, {"velocity_delay_s": 2e-3}]
)
def test_runs_with_other_errors_are_tried_from_those(
    trapezoids: Smoothed, changed: dict[str, float]
) -> None:
    other = with_errors(trapezoids, **changed)
    found = further_starts([trapezoids, other, trapezoids])
    assert set(found) == {trapezoids.errors, other.errors}


def test_likeliest_of_several_ends_is_taken(trapezoids: Smoothed) -> None:
    """A start without noise of the velocity and with a jerk that follows every reading."""
    readings = trapezoids.readings
    bad: ReadingErrors = replace(trapezoids.errors, velocity=1e-12, intensity=1e8)
    again = smooth(readings, [bad])
    assert again.errors == trapezoids.errors
    from_there = replace(trapezoids.errors, velocity=3.0 * trapezoids.errors.velocity)
    best = smooth(readings, [from_there])
    own = evidence(readings, trapezoids.errors, trapezoids.corners)
    assert evidence(readings, best.errors, best.corners) >= own - 1.0
