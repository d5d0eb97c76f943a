"""Correction of delays and clock drifts: acceptance, size, and cases without a correction."""

from dataclasses import replace

import numpy as np
import pytest
from by_hand import coulomb
from delayed_runs import (
    DELAY,
    DURATION_S,
    NOISE_N,
    ONE_WAY_NOISE_N,
    TAU,
    fitted,
    one_way_acceleration,
    one_way_campaign,
    one_way_speed,
    reversing_campaign,
    value,
)
from jbf import Rig, Run
from jbf.diagnosis.terms import shifts
from jbf.diagnosis.terms.delays import delays, explained_by_delays
from jbf.diagnosis.terms.proposal import is_accepted
from jbf.estimation.campaign import Campaign
from jbf.estimation.delays import drift_step
from jbf.estimation.fit import finish
from jbf.estimation.posterior_motions import aligned, delays_by_run_s
from jbf.estimation.problem import Problem
from jbf.estimation.random_effects import RandomEffects
from jbf.estimation.settings import DEFAULT as SETTINGS
from jbf.estimation.solution import Solution
from jbf.records.findings.finding import Finding
from term_models import model_of

DELAYS_S = (4e-3, -2e-3, 9e-3, 1e-3)
LARGE_DELAYS_S = (24e-3, -6e-3, 31e-3, 9e-3)
EXTENDED = pytest.mark.extended


PRICE_OF_EFFECT = 30.0
"""Typical threshold of an effect in twice the log likelihood."""


def corrected(
    problem: Problem, solution: Solution, before: Solution | None = None
) -> Campaign | None:
    """The campaign with its delays corrected; None if the correction is not accepted.

    Parameters
    ----------
    before
        A fit with more effects, which delays would replace.
    """
    model = model_of(problem, solution, reference=before, price_of_effect=PRICE_OF_EFFECT)
    proposal = delays(model)
    return proposal.campaign if proposal is not None and is_accepted(proposal, model) else None


def unshifted(problem: Problem, solution: Solution) -> shifts.Shifted:
    return shifts.Shifted(problem, solution, np.zeros(len(problem.campaign.prepared)), 0.0)


def sizes(campaign: Campaign | None, kind: str) -> list[float]:
    """Sizes of the findings of a corrected campaign, which must all be of one kind."""
    assert {f.kind for f in campaign.more_findings} == {kind}
    assert [f.run for f in campaign.more_findings] == [p.run.name for p in campaign.prepared]
    assert {f.done for f in campaign.more_findings} == {"shifted"}
    return [f.size for f in campaign.more_findings]


def test_shifted_force_is_compared_at_the_instant_at_which_it_acted() -> None:
    drift = 4e-4
    middles = np.array(DELAYS_S) + 0.5 * drift * DURATION_S
    problem = fitted(reversing_campaign(middles.tolist(), drift))[0]
    again = shifts.moved(problem, middles, drift)
    for p, q, middle in zip(problem.campaign.prepared, again.prepared, middles, strict=True):
        t = p.run.time_s
        acted = t - middle - drift * (t - 10.0)
        kept = (acted >= t[0]) & (acted <= t[-1])
        np.testing.assert_allclose(q.run.time_s, acted[kept], atol=1e-12)
        np.testing.assert_array_equal(q.friction, p.friction[kept])
    assert fitted(again)[1].rms == pytest.approx(NOISE_N, rel=0.1)


@pytest.mark.parametrize(
    ("delays_s", "drift", "possible"),
    [
        ((1.0, 2.0), 0.0, True),
        ((0.0, -2.1), 0.0, False),
        ((0.0, 0.0), -2.1e-3, False),
        ((0.98, 1.97), 2e-3, True),
        ((1.0, 0.0), -2e-3, False),
    ],
)
def test_delay_above_a_tenth_of_a_run_or_drift_above_0_2_percent_is_impossible(
    delays_s: tuple[float, float], drift: float, possible: bool
) -> None:
    """Runs of 10 s and 20 s; at the ends of a run a drift adds half of duration times drift."""
    problem = fitted(one_way_campaign((0.0, 0.0), durations_s=(10.0, 20.0)))[0]
    assert shifts.possible_clocks(problem, np.array(delays_s), drift) == possible


@pytest.mark.parametrize(
    "start_s", [(0.0,) * 4, pytest.param((0.0, 20e-3, 0.0, 30e-3), marks=EXTENDED)]
)
def test_delays_beyond_the_linear_range_are_recovered_from_any_start(
    start_s: tuple[float, ...],
) -> None:
    problem, start = fitted(one_way_campaign(LARGE_DELAYS_S))[0], np.array(start_s)
    found = shifts.fit_delays_by_run(
        shifts.Shifted(*fitted(shifts.moved(problem, start, 0.0)), start, 0.0)
    )
    assert max(LARGE_DELAYS_S) > 3.0 * SETTINGS.delays.linear_s
    np.testing.assert_allclose(found.delays_s, LARGE_DELAYS_S, atol=4e-4)
    assert found.solution.rms == pytest.approx(ONE_WAY_NOISE_N, rel=0.05)


def test_delay_effect_is_replaced_by_run_delays_if_the_runs_differ_in_delay() -> None:
    fit = fitted(one_way_campaign(LARGE_DELAYS_S), DELAY)
    found = shifts.fit_delays_by_run(unshifted(*fit))
    assert found.problem.effects == ()
    np.testing.assert_allclose(found.delays_s, LARGE_DELAYS_S, atol=4e-4)


def test_mass_in_one_run_is_not_corrected_as_a_delay_of_100_ms() -> None:
    """At F_v = 20 N s/m an additional mass of 2 kg is equivalent to a delay of -100 ms."""
    random, runs = np.random.default_rng(0), []
    t = np.arange(0.0, 20.01, 0.02)
    for i in range(4):
        v = one_way_speed(i, t)
        mass = 2.0 * one_way_acceleration(i, t) if i == 0 else 0.0
        force = coulomb(t, v, v) + mass + ONE_WAY_NOISE_N * random.standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, force, name=f"run {i}"))
    problem, solution = fitted(Campaign.prepare(Rig(), runs))
    before = unshifted(problem, solution)
    assert shifts.fit_delays_by_run(before) is before
    assert corrected(problem, solution) is None


@pytest.mark.parametrize("drift", [1.2e-4, pytest.param(1.8e-3, marks=pytest.mark.extended)])
def test_clock_drift_is_estimated_jointly_with_the_law(drift: float) -> None:
    """At the end of the longer run the error is 2.4 ms or 36 ms; a step removes at most 8 ms."""
    durations = (20.0, 10.0)
    problem, solution = fitted(one_way_campaign((0.0, 0.0), drift, durations_s=durations))
    found = shifts.fit_clock_drift(unshifted(problem, solution))
    step = drift_step(found.problem, found.solution)
    assert found.drift == pytest.approx(drift, abs=4.0 * step.variance**0.5)
    np.testing.assert_allclose(found.delays_s, 0.5 * found.drift * np.array(durations), rtol=1e-3)
    assert step.square <= shifts.SETTLED**2
    assert found.solution.rms == pytest.approx(ONE_WAY_NOISE_N, rel=0.05)


def test_delays_that_differ_between_runs_are_corrected_and_reported() -> None:
    problem, solution = fitted(reversing_campaign(DELAYS_S), DELAY)
    again = corrected(problem, solution)
    # One standard error is 0.2 ms.
    np.testing.assert_allclose(sizes(again, "late_channel"), DELAYS_S, atol=0.6e-3)
    there = fitted(again)
    assert there[1].rms == pytest.approx(NOISE_N, rel=0.1)
    assert fitted(problem.campaign)[1].rms > 5.0 * there[1].rms
    assert corrected(*there) is None
    # The same recording is aligned by the delays that the findings state.
    delays_s = delays_by_run_s([p.run.name for p in again.prepared], again.findings)
    np.testing.assert_array_equal(delays_s, sizes(again, "late_channel"))
    for p, q in zip(aligned(problem.campaign, delays_s).prepared, again.prepared, strict=True):
        np.testing.assert_array_equal(p.run.time_s, q.run.time_s)
        np.testing.assert_array_equal(p.friction, q.friction)
    # A further run has none of these delays.
    assert finish(*there).model.force_delay_s == 0.0


def test_clock_drift_common_to_all_runs_is_corrected_and_reported() -> None:
    drift = 1e-3
    delays = (0.5 * drift * DURATION_S,) * 4
    again = corrected(*fitted(reversing_campaign(delays, drift), DELAY))
    found = sizes(again, "drifting_clock")
    np.testing.assert_allclose(found, drift, rtol=0.03)
    assert np.ptp(found) == 0.0
    there = fitted(again)
    assert there[1].rms == pytest.approx(NOISE_N, rel=0.1)
    assert corrected(*there) is None


def test_drift_larger_than_that_of_any_clock_is_not_corrected() -> None:
    drift = 1e-2
    again = corrected(*fitted(reversing_campaign((0.5 * drift * DURATION_S,) * 4, drift)))
    assert again is None or all(f.kind != "drifting_clock" for f in again.more_findings)


def test_common_delay_is_estimated_by_the_model_after_clock_drift_is_corrected() -> None:
    drift, delay_s = 5e-4, 15e-3
    delays = [0.5 * drift * DURATION_S + delay_s] * 4
    again = corrected(*fitted(reversing_campaign(delays, drift), DELAY))
    np.testing.assert_allclose(sizes(again, "drifting_clock"), drift, rtol=0.05)
    there = fitted(again, DELAY)
    assert value(*there, TAU) == pytest.approx(delay_s, rel=0.03)
    assert there[1].rms == pytest.approx(NOISE_N, rel=0.1)


@pytest.mark.parametrize(("delay_s", "effects"), [(0.0, ()), (25e-3, DELAY)])
def test_delay_equal_in_all_runs_is_not_corrected(delay_s: float, effects: tuple[str, ...]) -> None:
    assert corrected(*fitted(reversing_campaign((delay_s,) * 4), effects)) is None


@pytest.mark.parametrize("seed", [0, *(pytest.param(s, marks=EXTENDED) for s in (1, 2))])
def test_common_delay_beyond_the_linear_range_is_not_corrected(seed: int) -> None:
    """Intermediate estimates of a common delay of 30 ms differ between the runs."""
    assert corrected(*fitted(one_way_campaign((30e-3,) * 4, seed=seed))) is None


@pytest.mark.parametrize("delay_s", [8e-3, pytest.param(12e-3, marks=EXTENDED)])
def test_common_delay_is_not_corrected_as_a_clock_drift(delay_s: float) -> None:
    assert corrected(*fitted(reversing_campaign((delay_s,) * 4))) is None
    assert corrected(*fitted(one_way_campaign((delay_s,) * 4))) is None


def test_delay_of_a_single_run_is_not_corrected_outside_the_model() -> None:
    assert corrected(*fitted(reversing_campaign((12e-3,)))) is None


def test_force_that_leads_the_motion_in_all_runs_is_corrected() -> None:
    again = corrected(*fitted(reversing_campaign((-6e-3,) * 4)))
    np.testing.assert_allclose(sizes(again, "late_channel"), -6e-3, atol=0.6e-3)
    # A further run has the delay that all runs have in common.
    assert finish(*fitted(again)).model.force_delay_s == pytest.approx(-6e-3, abs=0.6e-3)


def test_noise_that_grows_with_the_force_is_not_corrected_as_a_delay() -> None:
    random, runs = np.random.default_rng(0), []
    for p in reversing_campaign((0.0,) * 4).prepared:
        sd = 0.3 * np.maximum(np.abs(p.friction) - 5.0, 0.0)
        noise = sd * random.standard_normal(len(sd))
        runs.append(replace(p.run, friction=p.friction + noise))
    assert corrected(*fitted(Campaign.prepare(Rig(), runs))) is None


@pytest.mark.extended
def test_accurate_clocks_are_never_corrected_in_forty_simulated_campaigns() -> None:
    squares = []
    for seed in range(40):
        there = fitted(one_way_campaign((0.0, 0.0), seed=seed, durations_s=(20.0, 10.0)))
        squares.append(drift_step(*there).square)
        assert corrected(*there) is None
    # Wald's statistic is chi-square with one degree of freedom: its mean is 1, its median 0.45.
    assert 0.5 < np.mean(squares) < 1.7
    assert 0.2 < np.median(squares) < 0.9


def test_delays_of_a_second_correction_are_added_to_those_already_reported() -> None:
    """The first correction was estimated with a wrong model and has errors of up to 3 ms."""
    campaign = one_way_campaign(LARGE_DELAYS_S)
    problem = fitted(campaign)[0]
    wrong = np.array(LARGE_DELAYS_S) - np.array((3e-3, -2e-3, 1e-3, 0.0))
    late = zip((p.run.name for p in campaign.prepared), wrong.tolist(), strict=True)
    findings = [Finding("late_channel", "friction_n", *x, "s", "shifted", "") for x in late]
    before = shifts.moved(problem, wrong, 0.0).with_findings(findings)
    again = corrected(*fitted(before))
    np.testing.assert_allclose(sizes(again, "late_channel"), LARGE_DELAYS_S, atol=4e-4)
    assert fitted(again)[1].rms == pytest.approx(ONE_WAY_NOISE_N, rel=0.05)


def test_runs_are_shifted_instead_of_a_delay_effect_only_if_their_delays_differ() -> None:
    for delays_s, expected in (((12e-3,) * 4, False), (DELAYS_S, True)):
        campaign = reversing_campaign(delays_s)
        again = corrected(*fitted(campaign), fitted(campaign, DELAY)[1])
        assert (again is not None) == expected


def test_delays_that_differ_are_not_corrected_if_a_sensor_lag_explains_them_as_well() -> None:
    """The delays of the runs differ from a common delay by a hundredth of a sample."""
    delays_s = 5e-3 + 2e-4 * np.array([1.0, -1.0, 1.0, -1.0])
    campaign = one_way_campaign(delays_s.tolist())
    assert corrected(*fitted(campaign), fitted(campaign, ("sensor_lag",))[1]) is None


@pytest.mark.parametrize("explained", [True, False])
def test_runs_are_not_shifted_if_known_random_effects_explain_the_delays(explained: bool) -> None:
    """The random effects have the shape of a delay, or are offsets, which explain no delays."""
    problem, solution = fitted(one_way_campaign((3e-3, -2e-3, 4e-3, -1e-3)))
    times = [p.run.time_s for p in problem.campaign.prepared]
    offsets = [np.ones_like(t) for t in times]
    shapes = [one_way_acceleration(i, t) for i, t in enumerate(times)] if explained else offsets
    between = RandomEffects(("deviation",), tuple(s[:, None] for s in shapes), ONE_WAY_NOISE_N)
    samples = replace(solution.samples, between=between)
    campaign = replace(problem.campaign, samples=samples)
    there = Problem(campaign, "coulomb", "journal", (), problem.fixed)
    given = there.solution(solution.values, samples, solution.noise)
    assert (corrected(there, given) is None) == explained


def test_instrument_and_jump_effects_are_listed_as_confounded_with_a_delay() -> None:
    found = set(explained_by_delays(("sensor_offset", "time_delay", "sensor_lag", "backlash")))
    assert {"time_delay", "sensor_lag", "sensor_offset", "backlash"} <= found
    assert explained_by_delays(("quadratic_drag", "inertia")) == ()
    assert shifts.without_delay(("sensor_lag", "time_delay", "backlash")) == (
        "sensor_lag",
        "backlash",
    )
