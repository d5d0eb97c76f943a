"""Runs with nothing to fit are refused in a line; a rest alone does not divide by zero."""

from __future__ import annotations

import warnings

import jbf
import numpy as np
import pytest


def test_a_force_of_nothing_but_zeros_is_refused() -> None:
    t = 0.01 * np.arange(200)
    runs = [
        jbf.Run.from_arrays(t, np.sin(k + 3.0 * t), np.zeros(200), name=f"run{k}") for k in (1, 2)
    ]
    with pytest.raises(jbf.InputError, match=r"run1, column friction_n: zero in every sample"):
        jbf.fit(jbf.Rig(), runs, law="stribeck")
    shown = jbf.Run.from_arrays(t, runs[0].velocity_m_s, np.sign(runs[0].velocity_m_s), name="run3")
    assert jbf.fit(jbf.Rig(), [shown, *runs], law="coulomb").parameters


def test_a_run_at_rest_is_refused_without_a_warning() -> None:
    t = 0.01 * np.arange(300)
    still = np.zeros(300)
    run = jbf.Run.from_arrays(t, still, np.ones(300), position_m=still, name="rest")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(jbf.InputError, match=r"rest"):
            jbf.fit(jbf.Rig(), [run], law="stribeck")


def test_a_speed_of_whose_sign_nothing_is_known_is_refused() -> None:
    random = np.random.default_rng(1)
    t, v = 5e-4 * np.arange(900), random.choice([-5.0, -1.5, 0.0, 1.5, 5.0], 900)
    run = jbf.Run.from_arrays(t, v, np.sign(v) + 0.2 * v, name="jumps")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(jbf.InputError, match=r"jumps, column velocity_m_s: of no sample"):
            jbf.fit(jbf.Rig(), [run], law="stribeck")
