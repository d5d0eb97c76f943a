"""Proposed next runs: motions, separation of models, and the optimum over all candidates."""

from dataclasses import replace
from functools import cache

import jbf
import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from campaigns import campaign as simulated
from golden import golden
from jbf import Limits, Rig, effects
from jbf.diagnosis import Experiment, Policy
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.experiment_design.excitations import (
    MOST_SAMPLES,
    Excitation,
    excitations,
    run_from_motion,
)
from jbf.diagnosis.experiment_design.next_run import (
    Rival,
    filled_limits,
    motions,
    propose,
    propose_detection_run,
    undetectable_effects,
)
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.power import power
from jbf.diagnosis.power.distinction import detection_probability
from jbf.diagnosis.power.strength import strength_of
from jbf.estimation.campaign import Campaign
from linear_campaigns import coulomb_candidates, coulomb_run
from rigsim.motions import Motion, polyline, sine, sweep
from scipy import stats

LIMITS = Limits(duration_s=10.0)
PAIR = (("sensor_offset",), ("inertia",))
OTHER = (("sensor_drift",), ("quadratic_drag",))
ANY_EVIDENCE = DEFAULT.with_values({"experiments.min_evidence": 1e-6})


def friction(t: Array, v: Array, a: Array) -> Array:
    """Coulomb friction with a share of each of four effects."""
    law = 5.0 * np.sign(v) + 20.0 * v
    effects: Array = 0.3 + 3.0 * a + 0.03 * t + 60.0 * v * np.abs(v)
    return law + effects


def four_effects(policy: Policy = ANY_EVIDENCE) -> Candidates:
    return coulomb_candidates(four_runs(friction, noise_rms=0.1), policy)


def no_effect(noise_rms: float = 0.1) -> Candidates:
    return coulomb_candidates(four_runs(coulomb, noise_rms=noise_rms))


def rival(candidates: Candidates, effects: tuple[str, ...] = ()) -> Rival:
    candidates.converge(effects)
    return Rival(candidates.fitted(effects))


@cache
def proposed(pairs: int) -> Experiment:
    experiment = propose(four_effects(), (PAIR, OTHER)[:pairs], LIMITS)
    assert isinstance(experiment, Experiment)
    return experiment


def residual_square_after_fit(
    rival: Rival, recorded: tuple[Array, Array], truth: Array, step_s: float
) -> float:
    """Residual sum of squares of a fit to old and new runs, relative to the noise variance."""
    noise = rival.solution.noise
    x, gap = noise.innovations(recorded[1], step_s), noise.innovations(truth - recorded[0], step_s)
    _, j = rival.solution.stacked()
    explained = x.T @ gap
    step = np.linalg.pinv(x.T @ x + j.T @ j) @ explained
    return float(gap @ gap - explained @ step) / rival.noise_rms**2


@pytest.mark.parametrize("pairs", [pytest.param(1, marks=pytest.mark.extended), 2])
def test_proposed_run_maximises_the_smallest_separation_between_rivals(pairs: int) -> None:
    """Each model of a pair may be the true one; models of different pairs are not compared."""
    tried, groups = four_effects(), (PAIR, OTHER)[:pairs]
    limits, step_s = filled_limits(tried, LIMITS)
    rivals = {effects: rival(tried, effects) for group in groups for effects in group}
    least = []
    for excitation, run, motion in motions(tried, limits, step_s):
        at = {effects: rival.predict(motion) for effects, rival in rivals.items()}
        separations = [
            residual_square_after_fit(rivals[fitted], at[fitted], at[truth][0], step_s)
            for group in groups
            for fitted, truth in (group, group[::-1])
        ]
        least.append((min(separations), excitation.words, run))
    evidence, words, run = max(least, key=lambda x: x[0])
    found = proposed(pairs)
    assert found.evidence == pytest.approx(evidence, rel=1e-4)
    assert words in found.words
    assert found.run.velocity == pytest.approx(run.velocity)


@pytest.mark.parametrize("travel_m", [None, 0.05])
def test_proposed_run_stays_within_the_given_or_the_recorded_travel(travel_m: float | None) -> None:
    tried = four_effects()
    limit_m = travel_m or tried.campaign.travel
    assert limit_m is not None
    limits = replace(LIMITS, travel=travel_m)
    proposals = propose(tried, [PAIR], limits), propose_detection_run(tried, (), PAIR[1], limits)
    for found in proposals:
        assert isinstance(found, Experiment)
        assert found.run.position_m is not None or found.run.angle_rad is not None
        moved_m = np.cumsum(found.run.velocity) * found.run.duration_s / (len(found.run) - 1)
        assert 0.0 < np.ptp(moved_m) < 1.01 * limit_m
        assert f"travel of {limit_m:.3g} m" in found.words


def test_separation_of_a_proposed_run_is_the_root_mean_square_difference() -> None:
    found, tried = proposed(1), four_effects()
    assert found.separation_sigma == pytest.approx(np.sqrt(found.evidence / len(found.run)))
    noise_rms = max(rival(tried, effects).noise_rms for effects in PAIR)
    assert found.separation_n == pytest.approx(found.separation_sigma * noise_rms)


def test_run_with_a_separation_below_the_policy_limit_is_not_proposed() -> None:
    evidence = proposed(1).evidence
    enough, too_little = (
        propose(
            four_effects(DEFAULT.with_values({"experiments.min_evidence": part * evidence})),
            [PAIR],
            LIMITS,
        )
        for part in (0.999, 1.001)
    )
    assert isinstance(enough, Experiment)
    assert isinstance(too_little, str)
    assert "sensor_offset and inertia" in too_little


def test_no_run_is_proposed_for_models_with_the_same_predictions() -> None:
    """Load-proportional friction is zero without a transmitted load."""
    found = propose(four_effects(), [[("torque_proportional",), ()]], LIMITS)
    assert isinstance(found, str)
    assert "torque_proportional" in found


def test_proposal_names_only_effects_that_differ_between_the_rivals() -> None:
    groups = [[("sensor_offset", "inertia"), ("sensor_offset",)]]
    found = propose(four_effects(), groups, LIMITS)
    assert isinstance(found, Experiment)
    assert "inertia and no further effect" in found.words
    assert "sensor_offset" not in found.words


ONE_WAY = (
    sine("one_way_0.25", 50.3, 0.0595, 0.25, bias=0.0728),
    sine("one_way_1", 25.2, 0.0595, 1.0, bias=0.0728),
)
"""Unidirectional runs, in which a drag and a sensor offset are equivalent."""


def motion_of(run: jbf.Run) -> Motion:
    """Motion of a proposed run for the simulator, through every fifth sample."""
    knots = zip(run.time_s[::5].tolist(), run.velocity[::5].tolist(), strict=True)
    return polyline("next", list(knots))


def test_diagnosis_with_a_tie_proposes_a_run_that_reverses() -> None:
    result = golden("bearing_one_direction")
    experiment = result.experiment
    assert experiment is not None
    assert result.next_experiment == experiment.words
    assert experiment.evidence > 100.0
    v = experiment.run.velocity
    assert np.min(v) < -0.5 * np.max(v) < 0.0


@pytest.mark.extended
def test_diagnosis_without_a_tie_proposes_no_run_to_separate_effects() -> None:
    assert golden("bearing_coulomb_drag").experiment is None


@pytest.mark.extended
def test_tie_is_resolved_by_recording_the_proposed_run() -> None:
    experiment = golden("bearing_one_direction").experiment
    assert experiment is not None
    rig, runs, _ = simulated(65, ("coulomb_drag",), motions=(*ONE_WAY, motion_of(experiment.run)))
    result = jbf.diagnose(rig, runs)
    assert (result.verdict, result.effects) == ("missing", ("coulomb_drag",))


@pytest.mark.extended
def test_inertia_that_slow_sweeps_do_not_show_is_named_with_the_proposed_run() -> None:
    sweeps = (sweep("sweep", 0.13, 60.0), sine("slow", 140.0, 0.127, 0.045))
    rig, runs, _ = simulated(67, ("inertia",), motions=sweeps)
    first = jbf.diagnose(rig, runs)
    assert first.verdict == "adequate"
    assert "inertia" in first.not_detectable
    assert "coulomb_drag" not in first.not_detectable
    assert first.experiment is not None
    assert "inertia" in first.experiment.words
    motions = (*sweeps, motion_of(first.experiment.run))
    rig, runs, _ = simulated(67, ("inertia",), motions=motions)
    assert "inertia" in jbf.diagnose(rig, runs).effects


@cache
def hidden(noise_rms: float) -> tuple[str, ...]:
    """Effects that these runs cannot show at their usual strength."""
    tried = no_effect(noise_rms)
    return undetectable_effects(tried, (), power(tried, ()))


def test_offset_is_reported_as_hidden_if_noise_exceeds_its_detection_level() -> None:
    """The root of the gain is normal about that of its expectation: 80 % exceed the threshold."""
    (usual_n,) = effects()["sensor_offset"].parameters[0].starts
    samples, tried = 2004, 12
    price = stats.chi2.isf(DEFAULT.false_alarm_rate / tried, 1) + DEFAULT.artefact_margin
    # Two runs in each direction prevent the law from explaining the offset.
    limit_n = usual_n * np.sqrt(samples) / (np.sqrt(price) + stats.norm.ppf(0.8))
    # Gains are discounted by a long-run variance that is itself estimated.
    assert "sensor_offset" not in hidden(0.6 * limit_n)
    assert "sensor_offset" in hidden(1.15 * limit_n)


def test_effect_that_changes_no_prediction_is_not_reported_as_hidden() -> None:
    """Load-proportional friction is zero in any motion without a transmitted load."""
    tried = no_effect()
    powers = power(tried, ())
    assert "torque_proportional" in {p.effect for p in powers if p.hidden}
    found = undetectable_effects(tried, (), powers)
    assert "torque_proportional" not in found
    assert {"presliding", "dwell_stiction"} <= set(found)
    assert undetectable_effects(tried, (), []) == ()


@pytest.mark.parametrize("evidence", [0.0, 10.0, 40.0, 200.0])
def test_probability_to_name_an_effect_is_the_mean_over_three_strengths(evidence: float) -> None:
    """The gain of one parameter is noncentral chi-square with one degree of freedom."""
    assert DEFAULT.experiments.strengths == (0.6, 1.0, 1.5)
    expected = np.mean(
        [stats.ncx2.sf(32.0, 1, s**2 * evidence + 1e-12) for s in DEFAULT.experiments.strengths]
    )
    squares = np.array(DEFAULT.experiments.strengths) ** 2
    found = np.mean(detection_probability(32.0, 1, squares * evidence))
    assert found == pytest.approx(float(expected), abs=1e-6)


def test_proposed_run_has_the_largest_expected_number_of_detected_effects() -> None:
    names = ("inertia", "presliding", "sensor_nonlinearity")
    tried = no_effect()
    limits, step_s = filled_limits(tried, LIMITS)
    base = rival(tried)
    models = [m for name in names if (m := strength_of(tried, (), name)) is not None]
    prices = [tried.price(len(m.problem.open) - base.solution.free) for m in models]
    ranks = []
    for excitation, run, motion in motions(tried, limits, step_s):
        changed = [m.problem.chain.predict(m.values(1.0), [motion])[0] for m in models]
        shown = [residual_square_after_fit(base, base.predict(motion), f, step_s) for f in changed]
        found = sum(
            np.mean(detection_probability(p, 1, np.array(DEFAULT.experiments.strengths) ** 2 * e))
            for e, p in zip(shown, prices, strict=True)
        )
        total = float(np.sum(np.log1p(shown)))
        ranks.append((round(found, 2), total, excitation.words, shown, run))
    _, _, words, shown, run = max(ranks, key=lambda x: x[:2])
    proposed = propose_detection_run(tried, (), names, LIMITS)
    assert isinstance(proposed, Experiment)
    assert words in proposed.words
    clear = [e for e in shown if e > 2.0 * DEFAULT.experiments.min_evidence]
    assert proposed.evidence == pytest.approx(stats.gmean(clear), rel=1e-3)
    assert proposed.separation_sigma == pytest.approx(np.sqrt(proposed.evidence / len(run)))
    assert proposed.separation_n == pytest.approx(base.noise_rms * proposed.separation_sigma)


def test_proposal_names_only_effects_that_its_run_can_detect() -> None:
    """Load-proportional friction is zero in any motion without a transmitted load."""
    found = propose_detection_run(no_effect(), (), ("inertia", "torque_proportional"), LIMITS)
    assert isinstance(found, Experiment)
    assert found.words.endswith("would show inertia")


@pytest.mark.parametrize(
    ("effect", "limits"),
    [("torque_proportional", LIMITS), ("inertia", Limits(1e-3, 1e-4, 10.0))],
)
def test_no_run_is_proposed_if_no_motion_can_show_the_effect(effect: str, limits: Limits) -> None:
    found = propose_detection_run(no_effect(), (), (effect,), limits)
    assert isinstance(found, str)
    assert effect in found


STEP_S = 0.02


@pytest.mark.parametrize("linear", [False, True])
def test_planned_motion_has_the_path_of_its_velocity(linear: bool) -> None:
    """At 0.1 m/s^2 the path after 2 s is 0.2 m; the angle of a shaft is path over radius."""
    rig = Rig() if linear else Rig.thesis()
    t = STEP_S * np.arange(101.0)
    run = run_from_motion(rig, Excitation("up", 0.1 * t, None), STEP_S, linear=linear)
    assert run.time_s == pytest.approx(t)
    assert run.velocity == pytest.approx(0.1 * t)
    radius_m = 1.0 if rig.bearing is None else rig.bearing.radius_m
    path = run.position_m if linear else run.angle_rad
    assert path == pytest.approx(0.05 * t**2 / radius_m)
    assert (run.angle_rad if linear else run.position_m) is None
    assert (run.friction, run.temperature_c) == (None, None)


def test_planned_motion_has_the_given_conditions_or_the_load_of_the_rig() -> None:
    rig, v = Rig.thesis(), np.zeros(20)
    assert rig.load is not None
    usual = run_from_motion(rig, Excitation("rest", v, None), STEP_S, linear=False)
    given = run_from_motion(rig, Excitation("rest", v, 55.0, 31.0), STEP_S, linear=False)
    assert np.unique(usual.load_n) == pytest.approx([rig.load.normal_n])
    assert np.unique(given.load_n) == pytest.approx([55.0])
    assert np.unique(given.temperature_c) == pytest.approx([31.0])
    assert run_from_motion(Rig(), Excitation("rest", v, None), STEP_S, linear=True).load_n is None


def candidates_of(*steps_s: float, position: bool = False) -> Candidates:
    """Candidates for slides at up to 0.1 m/s and 0.2 m/s^2, sampled at these steps."""
    records = []
    for k, step_s in enumerate(steps_s):
        t = step_s * np.arange(int(20.0 / step_s))
        path = {"position_m": 0.05 * (1.0 - np.cos(2.0 * t))} if position else {}
        records.append(coulomb_run(t, 0.1 * np.sin(2.0 * t), seed=k, **path))
    return coulomb_candidates(records)


def test_planned_run_has_the_median_step_of_the_runs_and_up_to_6000_samples() -> None:
    tried = candidates_of(0.01, 0.02, 0.05)
    limits, step_s = filled_limits(tried, None)
    assert step_s == pytest.approx(0.02)
    assert limits.velocity == pytest.approx(0.1, rel=1e-3)
    assert limits.duration_s == 60.0
    assert MOST_SAMPLES == 6000
    long, coarser_s = filled_limits(tried, Limits(duration_s=240.0))
    assert (long.duration_s, coarser_s) == (240.0, 0.04)


@pytest.mark.parametrize("position", [False, True])
def test_every_motion_within_the_limits_is_a_candidate_for_the_next_run(position: bool) -> None:
    """The run has a position if the recorded runs have one, otherwise an angle."""
    limits = Limits(0.1, 0.2, 20.0)
    found = list(motions(candidates_of(STEP_S, position=position), limits, STEP_S))
    expected = list(excitations(limits, STEP_S, "m/s"))
    assert [excitation.words for excitation, *_ in found] == [x.words for x in expected]
    for (_, run, _), x in zip(found, expected, strict=True):
        assert run.velocity == pytest.approx(x.velocity)
        assert (run.position_m is not None) == position


@pytest.fixture(scope="module")
def law() -> Rival:
    return rival(no_effect())


def test_noise_and_information_of_a_fitted_model_are_those_of_a_regression(law: Rival) -> None:
    r, j = law.solution.stacked()
    assert law.noise_rms == pytest.approx(0.1, rel=0.05)
    assert law.noise_rms**2 * (len(r) - j.shape[1]) == pytest.approx(float(r @ r))
    assert law.root_information.T @ law.root_information == pytest.approx(j.T @ j)


def test_predicted_friction_and_slopes_in_a_motion_are_those_of_the_law(law: Rival) -> None:
    """The search variable of dry friction is its logarithm, that of viscous friction its value."""
    t = STEP_S * np.arange(200.0)
    v = 0.1 + 0.05 * np.sin(t)
    friction, slopes = law.predict(Campaign.prepare(Rig(), [coulomb_run(t, v, seed=0)]).motions[0])
    known = dict(zip(law.problem.names, law.solution.values.tolist(), strict=True))
    assert friction == pytest.approx(known["F_c"] + known["F_v"] * v, rel=1e-3)
    column = {law.problem.names[i]: slopes[:, k] for k, i in enumerate(law.problem.open)}
    assert column["F_c"] == pytest.approx(np.full(200, known["F_c"]), rel=1e-3)
    assert column["F_v"] == pytest.approx(v, rel=1e-3)


@pytest.mark.parametrize("direction", ["dry", "viscous", "new"])
def test_separation_is_the_residual_after_a_fit_to_all_runs(law: Rival, direction: str) -> None:
    """Minimum of |gap - X s|^2 + |K s|^2 over a common step s, by the normal equations."""
    t = STEP_S * np.arange(400.0)
    v = 0.1 + 0.05 * np.sin(t)
    own = law.predict(Campaign.prepare(Rig(), [coulomb_run(t, v, seed=0)]).motions[0])
    gap = {"dry": 0.3 + 0.0 * t, "viscous": 3.0 * v, "new": 0.3 * np.sin(7.0 * t)}[direction]
    information = own[1].T @ own[1] + law.root_information.T @ law.root_information
    explained = own[1].T @ gap
    left = float(gap @ gap - explained @ np.linalg.pinv(information) @ explained)
    separation = law.separation(own, own[0] + gap, STEP_S)
    assert separation == pytest.approx(left / law.noise_rms**2, rel=1e-6)
    # The old runs constrain the step: part of the gap remains even along the slopes of the law.
    # law.
    assert 0.1 * float(gap @ gap) < left < float(gap @ gap)
    assert law.separation(own, own[0], STEP_S) == pytest.approx(0.0, abs=1e-9)
