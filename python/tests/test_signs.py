"""Which way a difference goes: what is said and kept is record minus model, everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import LAW, Friction, along, coulomb, there_and_back
from jbf import Comparison, Model, Rig, Run, compare

MODEL = Model(Rig(), "coulomb", parameters=LAW)


def compared(friction: Friction) -> tuple[Comparison, list[Run]]:
    runs = there_and_back(friction, noise_n=0.02)
    return compare(MODEL, runs), runs


def pattern(comparison: Comparison, axis: str) -> str:
    (found,) = [f.where for f in comparison.failures if f.axis == axis]
    return found


def test_the_residual_of_a_comparison_is_record_minus_model() -> None:
    comparison, runs = compared(along(1.0))
    for run, predicted, residual in zip(
        runs, comparison.predictions, comparison.residuals, strict=True
    ):
        assert run.friction_n is not None
        np.testing.assert_array_equal(residual, run.friction_n - predicted)
        assert np.mean(residual * np.sign(run.velocity_m_s)) == pytest.approx(1.0, abs=0.01)
        assert np.mean(predicted * np.sign(run.velocity_m_s)) == pytest.approx(
            LAW["F_c_n"] + LAW["F_v_n_s_m"] * np.mean(np.abs(run.velocity_m_s)), abs=1e-3
        )


@pytest.mark.parametrize(("more_n", "side"), [(1.0, "above"), (-1.0, "below")])
def test_more_friction_on_record_is_said_to_be_above_the_model(more_n: float, side: str) -> None:
    where = pattern(compared(along(more_n))[0], "direction")
    assert f"record {side} the model by 1 N in the direction of motion" in where
    forth, back = ("+1 N", "-1 N") if more_n > 0 else ("-1 N", "+1 N")
    assert f"{forth} at v > 0" in where
    assert f"{back} at v < 0" in where


@pytest.mark.parametrize("offset_n", [1.0, -1.0])
def test_an_offset_of_the_record_keeps_its_sign(offset_n: float) -> None:
    comparison, _ = compared(lambda t, v, a: coulomb(t, v, a) + offset_n)
    where = pattern(comparison, "velocity")
    assert f"one sign throughout: record minus model {offset_n:+.0f} N" in where


def test_the_bins_of_a_pattern_hold_record_minus_model() -> None:
    comparison, _ = compared(lambda t, v, a: coulomb(t, v, a) + np.where(v > 0, 0.75, 0.25))
    (direction,) = [f for f in comparison.failures if f.axis == "direction"]
    assert direction.labels == ("v < 0", "v > 0")
    assert direction.means_n == pytest.approx([0.25, 0.75], abs=0.01)
    assert direction.counts.tolist() == [501, 501]


def test_the_share_of_a_pattern_is_that_of_the_mean_square() -> None:
    noise_n = 0.5
    runs = there_and_back(along(1.0), noise_n=noise_n)
    (direction,) = [f for f in compare(MODEL, runs).failures if f.axis == "direction"]
    assert direction.share == pytest.approx(1.0 / (1.0 + noise_n**2), abs=0.03)
