"""Effects that the runs cannot detect at their usual strength, and a run that can."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from by_hand import coulomb, four_runs
from jbf import Limits, Rig, effects
from jbf.diagnosis import Experiment
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import price_of
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.power import power
from jbf.diagnosis.separation import Rival, filled_limits, motions
from jbf.diagnosis.strength import strength_of
from jbf.diagnosis.unseen import STRENGTHS, chance_to_name, propose_to_see, unseen
from jbf.estimation.campaign import Campaign
from scipy import stats

Array = npt.NDArray[np.float64]
LIMITS = Limits(duration_s=10.0)
HIDDEN = ("inertia_leak", "presliding", "sensor_nonlinearity")


def candidates(noise_n: float = 0.1) -> Candidates:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=noise_n))
    return Candidates(campaign, "coulomb", "journal")


@cache
def hidden(noise_n: float) -> tuple[str, ...]:
    tried = candidates(noise_n)
    return unseen(tried, (), power(tried, ()))


def test_offset_is_hidden_if_the_noise_exceeds_the_level_at_which_it_is_detectable() -> None:
    """The root of its gain is normal about that of its expectation: 80 % exceed the price."""
    (usual_n,) = next(p for p in effects()["sensor_offset"].parameters).starts
    samples, tried = 2004, 12
    price = stats.chi2.isf(DEFAULT.false_alarms / tried, 1) + DEFAULT.imperfection
    # There are two runs in each direction, so that the law cannot explain the offset.
    limit_n = usual_n * np.sqrt(samples) / (np.sqrt(price) + stats.norm.ppf(0.8))
    # Gains are discounted by a long-run variance that is itself estimated.
    assert "sensor_offset" not in hidden(0.6 * limit_n)
    assert "sensor_offset" in hidden(1.15 * limit_n)


def test_effect_that_changes_no_prediction_is_not_reported_as_hidden() -> None:
    """Without a transmitted load the friction in proportion to it is zero in any motion."""
    tried = candidates()
    powers = power(tried, ())
    assert "torque_proportional" in {p.effect for p in powers if p.hidden}
    found = unseen(tried, (), powers)
    assert "torque_proportional" not in found
    assert {"presliding", "dwell_stiction"} <= set(found)
    assert unseen(tried, (), []) == ()


@pytest.mark.parametrize("evidence", [0.0, 10.0, 40.0, 200.0])
def test_probability_to_be_named_is_the_mean_over_three_strengths(evidence: float) -> None:
    """The gain of one parameter is noncentral chi-square with one degree of freedom."""
    assert STRENGTHS == (0.6, 1.0, 1.5)
    expected = np.mean([stats.ncx2.sf(32.0, 1, s**2 * evidence + 1e-12) for s in STRENGTHS])
    assert chance_to_name(evidence, 32.0) == pytest.approx(float(expected), abs=1e-6)


def test_proposed_run_has_the_largest_expected_number_of_effects_found() -> None:
    """By the residual of a regression on the law's slopes in old and new runs."""
    tried = candidates()
    limits, step_s = filled_limits(tried, LIMITS)
    tried.converge(())
    base = Rival(tried.fitted(()))
    _, j = base.solution.stacked()
    strengths = [strength_of(tried, (), name) for name in HIDDEN]
    ranks = []
    for excitation, run, motion in motions(tried, limits, step_s):
        friction, slopes = base.at(motion)
        shown = []
        for model in strengths:
            assert model is not None
            gap = model.problem.chain.predict(model.values(1.0), [motion])[0] - friction
            explained = slopes.T @ gap
            step = np.linalg.pinv(slopes.T @ slopes + j.T @ j) @ explained
            shown.append(max(float(gap @ gap - explained @ step), 0.0) / base.noise_n**2)
        prices = [price_of(tried, len(m.problem.open) - base.solution.free) for m in strengths if m]
        found = sum(chance_to_name(e, p) for e, p in zip(shown, prices, strict=True))
        ranks.append(
            (round(found, 2), float(np.sum(np.log1p(shown))), excitation.words, shown, run)
        )
    _, _, words, shown, run = max(ranks, key=lambda x: x[:2])
    proposed = propose_to_see(tried, (), HIDDEN, LIMITS)
    assert isinstance(proposed, Experiment)
    assert words in proposed.words
    clear = [e for e in shown if e > 2.0 * DEFAULT.least_separation]
    assert proposed.evidence == pytest.approx(stats.gmean(clear), rel=1e-3)
    assert proposed.separation_sigma == pytest.approx(np.sqrt(proposed.evidence / len(run)))
    assert proposed.separation_n == pytest.approx(base.noise_n * proposed.separation_sigma)


def test_proposal_names_only_effects_that_its_run_can_detect() -> None:
    """Friction in proportion to a transmitted load is zero in any motion."""
    found = propose_to_see(candidates(), (), ("inertia_leak", "torque_proportional"), LIMITS)
    assert isinstance(found, Experiment)
    assert found.words.endswith("would show inertia_leak")


def test_no_run_is_proposed_if_no_motion_can_show_the_effect() -> None:
    found = propose_to_see(candidates(), (), ("torque_proportional",), LIMITS)
    assert isinstance(found, str)
    assert "torque_proportional" in found
    slow = propose_to_see(candidates(), (), ("inertia_leak",), Limits(1e-3, 1e-4, 10.0))
    assert isinstance(slow, str)
