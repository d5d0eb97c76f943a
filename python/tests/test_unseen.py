"""What could hide in runs: effects that 80 of 100 such campaigns would not show at their usual
strength."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import coulomb, four_runs
from jbf import Rig, effects
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.power import power
from jbf.diagnosis.unseen import chance_to_name, unseen
from jbf.estimation.campaign import Campaign
from scipy import stats


def hidden(noise_n: float) -> tuple[str, ...]:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=noise_n))
    candidates = Candidates(campaign, "coulomb", "journal")
    return unseen(candidates, (), power(candidates, ()))


def test_an_offset_hides_where_noise_makes_it_cheaper_than_its_price() -> None:
    (usual_n,) = next(p for p in effects()["sensor_offset"].parameters).starts
    samples, candidates = 2004, 12
    price = stats.chi2.isf(0.01 / candidates, 1) + 22.0
    # Two runs go each way, so the law cannot take the offset for its own.
    # The root of its gain is a normal deviate about that of its worth: 80 of 100 exceed the price.
    turns_n = usual_n * np.sqrt(samples) / (np.sqrt(price) + stats.norm.ppf(0.8))
    # Gains are discounted by a long-run variance that is itself estimated: some more is needed.
    assert "sensor_offset" not in hidden(0.6 * turns_n)
    assert "sensor_offset" in hidden(1.15 * turns_n)


@pytest.mark.parametrize("evidence", [0.0, 10.0, 40.0])
def test_the_chance_to_find_what_a_run_would_show(evidence: float) -> None:
    # The gain of one parameter is the square of a normal deviate about the root of its worth.
    price, draws = 32.0, np.random.default_rng(1).standard_normal(200_000)
    shares = [np.mean((draws + s * np.sqrt(evidence)) ** 2 > price) for s in (0.6, 1.0, 1.5)]
    assert chance_to_name(evidence, price) == pytest.approx(np.mean(shares), abs=0.005)
