"""The paths of films that a motion keeps change no answer."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from jbf import _core

BEARING: dict[str, Any] = {
    "radius_m": 0.0127,
    "length_m": 0.01905,
    "clearance_m": 5.08e-5,
    "mass_kg": 2.27,
    "count": 4,
    "viscosity_pa_s": 0.002,
}
VALUES = np.array([0.26, 0.06, 7.5e5, 33.0])


def motion(load_n: float = 104.0) -> _core.Motion:
    t = np.arange(0.0, 12.0, 0.02)
    v = 0.127 * np.sin(t)
    return _core.Motion(t, v, 0.127 * np.cos(t), -np.cos(t) * 10.0, np.full(len(t), load_n))


def chain(effects: tuple[str, ...] = (), **changed: Any) -> _core.Chain:
    bearing: Any = BEARING | {k: v for k, v in changed.items() if k in BEARING}
    return _core.Chain(
        law="journal",
        bearing=bearing,
        load_n=changed.get("load_n", 104.0),
        clock=changed.get("clock", "journal"),
        effects=list(effects),
        max_step_s=changed.get("max_step_s", 0.02),
    )


CHANGES: dict[str, tuple[dict[str, Any], list[float]]] = {
    "as it was": ({}, [1.0, 1.0, 1.0, 1.0]),
    "transition speed": ({}, [1.0, 1.1, 1.0, 1.0]),
    "stiffness": ({}, [1.0, 1.0, 1.1, 1.0]),
    "behind the film": ({}, [1.1, 1.0, 1.0, 0.9]),
    "length": ({"length_m": 0.015}, [1.0] * 4),
    "oil": ({"viscosity_pa_s": 0.003}, [1.0] * 4),
    "clock": ({"clock": "thesis"}, [1.0] * 4),
    "step": ({"max_step_s": 0.004}, [1.0] * 4),
}


def test_what_is_kept_is_never_taken_for_another() -> None:
    """One motion under each of them, there and back, beside a motion that has kept nothing."""
    used = motion()
    for _, (name, (changed, scale)) in itertools.product(range(2), CHANGES.items()):
        values = VALUES * scale
        found = chain(**changed).predict(values, [used])[0]
        fresh = chain(**changed).predict(values, [motion()])[0]
        assert found.tobytes() == fresh.tobytes(), name
    answers = {
        chain(**changed).predict(VALUES * scale, [used])[0].tobytes()
        for changed, scale in CHANGES.values()
    }
    assert len(answers) == len(CHANGES)


@pytest.mark.parametrize("effects", [(), ("coulomb_drag", "sensor_lag"), ("film_memory",)])
def test_slopes_are_those_of_predictions(effects: tuple[str, ...]) -> None:
    one, used = chain(effects), motion()
    values = np.concatenate([VALUES, [1.0, 0.05][: len(one.parameter_names) - 4]])
    # Predicted first: a path without slopes must not be taken for one with them.
    value = one.predict(values, [used])[0]
    [(again, slopes)] = one.jacobian(values, [used], list(range(len(values))))
    assert again.tobytes() == value.tobytes()
    for k, column in enumerate(slopes.T):
        step = 1e-5 * values[k]
        sides = [values + sign * step * (np.arange(len(values)) == k) for sign in (1.0, -1.0)]
        above, below = (one.predict(side, [motion()])[0] for side in sides)
        expected = (above - below) / (2.0 * step)
        assert np.max(np.abs(column)) > 0.0
        assert np.max(np.abs(column - expected)) < 1e-4 * np.max(np.abs(expected))
    [(_, other)] = one.jacobian(values * 1.01, [used], list(range(len(values))))
    assert not np.array_equal(other, slopes)


@pytest.mark.parametrize("speed_m_s", [0.0, 8.7e-18, -8.7e-18, 1e-300, -1e-300, 1e-13, -1e-13])
def test_a_reversal_at_a_sample_moves_no_reading(speed_m_s: float) -> None:
    """The speed of a sample at which the motion turns round is zero but for rounding: readings are
    those of a chain that goes along no path, and of one whose speed there is small and known."""
    t = np.arange(0.0, 12.0, 0.02)
    at = 157

    def turning(speed_m_s: float) -> _core.Motion:
        v = 0.127 * np.sin(t - t[at])
        v[at] = speed_m_s
        return _core.Motion(t, v, 0.127 * np.cos(t), np.cos(t - t[at]), np.full(len(t), 104.0))

    found = chain().predict(VALUES, [turning(speed_m_s)])[0]
    # Null of an effect that remembers: each step is made.
    stepped = chain(("wear_in",)).predict(np.append(VALUES, [0.0, 1.0]), [turning(speed_m_s)])[0]
    assert found == pytest.approx(stepped, abs=1e-9)
    known = chain().predict(VALUES, [turning(1e-9)])[0]
    assert np.abs(found - known)[at + 1 :].max() < 1e-3
