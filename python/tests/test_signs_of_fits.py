"""The residual of a fit goes the way of a comparison's: record minus model."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import LAW, along, there_and_back
from jbf import Rig, compare, fit


def test_the_residual_of_a_fit_is_record_minus_model() -> None:
    runs = there_and_back(along(1.0), noise_n=0.05)
    # Held at less than the record has: what is left over has the direction of motion.
    fitted = fit(Rig(), runs, law="coulomb", fixed={"F_c": LAW["F_c_n"], "F_v": LAW["F_v_n_s_m"]})
    for run, residual, other in zip(
        runs, fitted.residuals, compare(fitted.model, runs).residuals, strict=True
    ):
        assert run.friction_n is not None
        np.testing.assert_allclose(residual, run.friction_n - fitted.model.predict(run), atol=1e-9)
        np.testing.assert_allclose(residual, other, atol=1e-9)
        assert np.mean(residual * np.sign(run.velocity_m_s)) == pytest.approx(1.0, abs=0.01)
