"""Evidence for an effect and its alternatives, against least squares."""

from dataclasses import replace

import numpy as np
import pytest
from by_hand import Array, assert_recovered, coulomb, four_runs
from jbf import Diagnosis, Rig, Run, diagnose
from jbf.diagnosis import Trial
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.evidence import evidence, evidence_on_common_samples, full_gain
from jbf.diagnosis.level import score_test
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.review import needed, reconsider, weights
from jbf.estimation.campaign import Campaign
from jbf.estimation.generalised_least_squares import with_motion_errors
from jbf.estimation.likelihood import effective_share, likelihood_gain, share_of_gain
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Problem
from linear_campaigns import (
    CANDIDATES,
    Textbook,
    coulomb_candidates,
    coulomb_run,
    fit_from_truth,
    linear_diagnosis,
    linear_runs,
    threshold,
)
from point_to_point import point_to_point


def trial(diagnosis: Diagnosis, effect: str, step: int = 0) -> Trial:
    """The trial of an effect in one step of the ledger."""
    return next(t for t in diagnosis.steps[step].trials if t.effect == effect)


def test_evidence_is_twice_the_log_likelihood_gain_minus_the_threshold() -> None:
    found, book = linear_diagnosis("weak mass"), Textbook(linear_runs("weak mass"))
    assert len(found.steps[0].trials) == CANDIDATES
    assert 35.0 < book.gain() < 80.0
    expected = book.gain() - threshold(1, book.samples)
    assert trial(found, "inertia").evidence == pytest.approx(expected, abs=0.5)
    assert (found.verdict, found.effects) == ("missing", ("inertia",))


def test_evidence_of_an_effect_without_gain_is_minus_its_threshold() -> None:
    found, samples = linear_diagnosis("nothing"), Textbook(linear_runs("nothing")).samples
    thresholds = {round(threshold(k, samples), 2) for k in range(4)}
    for each in found.steps[0].trials:
        assert each.outcome == "no gain"
        assert each.evidence < -5.0
        if each.rms == found.steps[0].rms:
            assert round(-each.evidence, 2) in thresholds, each.effect
    assert (found.verdict, found.effects) == ("adequate", ())


@pytest.mark.parametrize("hidden", ["nothing", "weak mass"])
def test_fit_error_and_held_out_error_of_a_step_are_those_of_least_squares(hidden: str) -> None:
    found, book = linear_diagnosis(hidden), Textbook(linear_runs(hidden))
    for step, columns in zip(found.steps, (2, 3), strict=False):
        # jbf smooths the recorded speed, which changes both errors by the same factor.
        assert step.rms == pytest.approx(book.rms(columns), rel=1e-3)
        excess = step.held_out_rms / step.rms - 1.0
        expected = book.held_out_rms(columns) / book.rms(columns) - 1.0
        assert excess == pytest.approx(expected, rel=0.05)
        assert excess > 5e-4


def test_two_simulated_effects_are_added_in_successive_steps() -> None:
    found = linear_diagnosis("offset and drag")
    assert found.effects == ("sensor_offset", "quadratic_drag")
    assert [step.effects for step in found.steps] == [(), found.effects[:1], found.effects]
    assert found.steps[-1].rms == pytest.approx(0.1, rel=0.05)
    for name, true in (("sensor_offset.b", 0.5), ("quadratic_drag.c", 150.0)):
        assert_recovered(found.fit.parameters[name], true)


@pytest.mark.parametrize(
    "hidden", ["nothing", "offset and drag", pytest.param("lag", marks=pytest.mark.extended)]
)
def test_fits_that_are_not_continued_do_not_change_the_diagnosis(hidden: str) -> None:
    """With larger limits of the gain, every candidate with a sufficient score is ranked."""
    found = linear_diagnosis(hidden)
    larger = {"search.linear_gain_factor": 1e9, "search.step_gain_factor": 1e9}
    policy = DEFAULT.with_values({**larger, "search.group_size": 100})
    complete = diagnose(Rig(), linear_runs(hidden), law="coulomb", policy=policy)
    assert (complete.verdict, complete.effects) == (found.verdict, found.effects)
    skipped, skipped_in_complete = (
        [t.effect for step in d.steps for t in step.trials if t.reason.startswith("skipped")]
        for d in (found, complete)
    )
    assert skipped_in_complete == []
    assert bool(skipped) == (hidden != "nothing")
    for name, value in found.fit.parameters.items():
        other = complete.fit.parameters[name]
        assert value.value == pytest.approx(other.value, abs=0.1 * (value.stderr or 1e-9))


def test_effect_is_exchanged_only_if_held_out_runs_are_predicted_as_well() -> None:
    """A Stribeck excess that imitates a drag is exchanged for the drag."""
    runs, wrong = linear_runs("offset and drag"), ("sensor_offset", "stribeck_excess")
    assert reconsider(coulomb_candidates(runs), wrong) == ("sensor_offset", "quadratic_drag")
    policy = DEFAULT.with_values({"held_out.no_worse_ratio": 0.5})
    assert reconsider(coulomb_candidates(runs, policy), wrong) == wrong


def test_effect_in_one_run_only_is_reported_as_residual_structure() -> None:
    found, runs = linear_diagnosis("mass in one run"), linear_runs("mass in one run")
    book = Textbook(runs)
    assert book.rms(3) < 0.99 * book.rms(2)
    assert book.held_out_rms(3) > book.held_out_rms(2)
    assert trial(found, "inertia").outcome in ("no gain", "rejected")
    assert (found.verdict, found.effects) == ("unexplained", ())
    assert any(
        remainder.where.endswith(f"in {runs[0].name}") for remainder in found.residual_structure
    )
    assert any("inertia" in r.where for r in found.residual_structure if r.axis == "run")


def test_effect_is_named_even_if_an_unexplained_tone_remains() -> None:
    found = linear_diagnosis("offset and tone")
    assert (found.verdict, found.effects) == ("unexplained", ("sensor_offset",))
    assert found.confounders == ()
    assert found.model.effects == ("sensor_offset",)
    assert any(r.axis == "frequency" and "3.00 Hz" in r.where for r in found.residual_structure)


def test_ratio_of_weights_of_tied_effects_is_their_likelihood_ratio() -> None:
    found = linear_diagnosis("lag")
    first, second = found.steps[0].trials[:2]
    assert {first.effect, second.effect} == {"sensor_lag", "time_delay"}
    assert (first.outcome, second.outcome) == ("added", "ties")
    assert found.verdict == "ambiguous"
    assert found.alternatives == {first.effect: (second.effect,)}
    of_effect = found.weights[first.effect]
    odds = np.exp(0.5 * (first.evidence - second.evidence))
    assert of_effect[first.effect] / of_effect[second.effect] == pytest.approx(odds, rel=1e-6)
    assert sum(of_effect.values()) == pytest.approx(1.0)
    assert found.next_experiment


def test_effects_with_the_same_derivative_have_equal_weights() -> None:
    """Without reversals an offset and a direction-dependent dry friction are equivalent."""
    found = linear_diagnosis("offset and drag")
    assert found.verdict == "ambiguous"
    assert found.alternatives == {"sensor_offset": ("dry_asymmetry",), "quadratic_drag": ()}
    assert found.weights["sensor_offset"]["dry_asymmetry"] == pytest.approx(0.5, abs=1e-3)


def test_effect_that_does_not_fit_has_negligible_weight_next_to_one_that_does() -> None:
    """A mass, which is absent, compared with an offset, which is present."""
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 0.03, noise_rms=0.1)
    candidates = coulomb_candidates(runs)
    of_mass = weights(candidates, ("inertia",))["inertia"]
    assert of_mass["inertia"] < 1e-6
    assert of_mass["sensor_offset"] == pytest.approx(of_mass["dry_asymmetry"], rel=1e-3)
    assert "inertia" not in weights(candidates, ("sensor_offset",))["sensor_offset"]


def _offset_runs(offset_n: float) -> list[Run]:
    return four_runs(lambda t, v, a: coulomb(t, v, a) + offset_n, noise_rms=0.1)


def test_evidence_is_likelihood_gain_times_independent_share_minus_threshold() -> None:
    """A mass in one run only: the variance of its score is far above that in white noise."""
    candidates = coulomb_candidates(linear_runs("mass in one run"))
    simple, rich = candidates.converge(()), candidates.converge(("inertia",))
    gain, price = likelihood_gain(rich, simple), candidates.price(1)
    found = evidence(candidates, rich, simple)
    anywhere = evidence(candidates, rich, simple, count_local_gain=True)
    assert found == pytest.approx(gain * share_of_gain(rich, simple, effective_share(rich)) - price)
    assert anywhere == pytest.approx(gain * effective_share(rich) - price)
    assert found < 0.0 < anywhere <= gain - price
    assert evidence(candidates, simple, rich) == pytest.approx(-gain - candidates.price(-1))


def test_residual_of_a_missing_candidate_does_not_reduce_the_share_of_independent_samples() -> None:
    """White noise, and a drift of the sensor or a wave that no candidate describes."""

    def drift(t: Array) -> Array:
        return 0.5 * t

    def wave(t: Array) -> Array:
        return np.asarray(np.sin(2.0 * np.pi * t / 4.0))

    for slow, least, most in ((drift, 0.9, 1.0), (wave, 0.0, 0.1)):
        runs = four_runs(lambda t, v, a, f=slow: coulomb(t, v, a) + f(t), noise_rms=0.02)
        candidates = coulomb_candidates(runs)
        base = candidates.converge(())
        assert candidates.independent_share(base) < 0.1
        candidates.score_all((), candidates.names, base)
        candidates.calibrate(())
        assert least <= candidates.independent_share(base) <= most


@pytest.mark.parametrize(("offset_n", "needs"), [(0.0, False), (0.2, True)])
def test_effect_without_evidence_is_needed_if_held_out_runs_are_predicted_worse_without_it(
    offset_n: float, needs: bool
) -> None:
    """A slow wave that no effect describes correlates the residual; four strokes are too few."""
    t = np.arange(0.0, 20.0, 0.02)
    v = 0.1 * np.sin(2.0 * np.pi * t / 20.0 + 0.3)
    runs = []
    for i in range(2):
        wave = 0.5 * np.sin(2.0 * np.pi * t / 4.7 + 2.1 * i)
        noise = 0.05 * np.random.default_rng(i).standard_normal(len(t))
        force = coulomb(t, v, v) + offset_n + wave + noise
        runs.append(Run.from_arrays(t, v, force, name=f"{i}"))
    candidates = coulomb_candidates(runs)
    current, simpler = ("sensor_offset",), candidates.converge(())
    assert evidence(candidates, candidates.converge(current), simpler) < -10.0
    assert needed(candidates, current, "sensor_offset", simpler) == needs


def test_gain_from_samples_that_an_effect_excludes_is_not_its_evidence() -> None:
    """The simpler model has a dry friction 2 % off; the richer model excludes three samples."""
    t = np.arange(0.0, 20.0, 0.02)
    runs = [coulomb_run(t, 0.1 * np.sin((1.0 + 0.2 * i) * t + 0.4), seed=i) for i in range(2)]
    candidates = coulomb_candidates(runs)
    problem, right = candidates.fitted(()).problem, candidates.converge(())
    fewer = right.samples.within([(t < 10.0) | (t > 10.05), np.ones(len(t), dtype=bool)])
    wrong = right.values * np.where(np.array(problem.names) == "F_c", 1.02, 1.0)
    simple = problem.solution(wrong, right.samples, WHITE)
    rich = replace(
        candidates.converge(("time_delay",)),
        values=np.append(right.values, 1e-4),
        residuals=right.residuals,
        noise=WHITE,
        samples=fewer,
    )
    assert evidence(candidates, rich, simple) > 60.0
    assert evidence_on_common_samples(candidates, rich, simple) < 0.0
    # The gain counts if both models use the same samples.
    same = replace(rich, samples=simple.samples)
    assert (
        evidence_on_common_samples(candidates, same, simple)
        == evidence(candidates, same, simple)
        > 60.0
    )


@pytest.mark.parametrize(("step_n", "counts"), [(0.0, True), (0.6, False)])
def test_gain_below_the_quantisation_error_is_not_evidence(step_n: float, counts: bool) -> None:
    """An offset of 0.03 N in noise of 0.1 N, with exact readings and with steps of 0.6 N."""
    runs = []
    for run in _offset_runs(0.03):
        force = np.asarray(run.friction)
        read = step_n * np.round(force / step_n) if step_n else force
        runs.append(replace(run, friction=read))
    candidates = coulomb_candidates(runs)
    assert (candidates.campaign.step_n > 0.0) == (step_n > 0.0)
    simple, rich = candidates.converge(()), candidates.converge(("sensor_offset",))
    found = evidence(candidates, rich, simple)
    if counts:
        assert found > 0.0
    else:
        assert likelihood_gain(rich, simple) > 0.0
        assert found == pytest.approx(-candidates.price(1))


def test_fit_far_from_its_minimum_is_improved_from_a_richer_model() -> None:
    candidates = coulomb_candidates(linear_runs("mass"))
    best = candidates.converge(("inertia",))
    rich = candidates.converge(("inertia", "sensor_offset"))
    fitted = candidates.fitted(("inertia",))
    values = np.where(np.array(fitted.problem.names) == "inertia.m_e", 0.0, best.values)
    fitted.improve(fitted.problem.solution(values, best.samples, best.noise))
    assert fitted.current_solution().cost > best.cost + 50.0
    found = candidates.refit_from(("inertia",), rich.effects)
    assert found.cost == pytest.approx(best.cost, abs=0.5)
    assert candidates.converge(("inertia",)) is found


def test_score_test_predicts_likelihood_gain_and_value_of_a_linear_effect() -> None:
    campaign = Campaign.prepare(Rig(), _offset_runs(0.03))
    bare, near = fit_from_truth(campaign)
    near = replace(near, noise=WHITE)
    problem, fitted = fit_from_truth(campaign, "sensor_offset")
    null = dict(zip(bare.names, near.values.tolist(), strict=True)) | {"sensor_offset.b": 0.0}
    start = np.array([null[name] for name in problem.names])
    gain, directions, stepped = score_test(problem, [start], near, ("sensor_offset",))
    real_gain = likelihood_gain(fitted, near)
    assert real_gain > 50.0
    assert gain == pytest.approx(real_gain, rel=0.1)
    place = problem.names.index("sensor_offset.b")
    assert stepped[place] == pytest.approx(fitted.values[place], rel=0.1)
    assert (directions.basis[:, 0] @ directions.innovations) ** 2 == pytest.approx(gain, rel=0.1)
    # Both halves of the samples contribute to the gain.
    first = [np.arange(len(c)) < len(c) // 2 for c in near.samples.counted]
    halves = [
        score_test(problem, [start], replace(near, samples=half), ("sensor_offset",))[0]
        for half in (near.samples.within(first), near.samples.within([~f for f in first]))
    ]
    assert sum(halves) == pytest.approx(gain, rel=0.35)


@pytest.mark.parametrize(("effect", "share", "counts"), [
    ("sensor_lag", 0.8, False), ("sensor_lag", 1.5, True), ("quadratic_drag", 0.8, True),
])  # fmt: skip
def test_gain_up_to_the_share_of_motion_errors_is_no_evidence_for_a_filter(
    effect: str, share: float, counts: bool
) -> None:
    """The gain is a multiple of the mean share of the errors times the number of samples."""
    runs = point_to_point([6], duration_s=8.0)
    coarse = [(r.time_s, r.friction, np.round(np.asarray(r.position_m), 5)) for r in runs]
    read = [Run.from_arrays(time_s, None, force, position_m=x) for time_s, force, x in coarse]
    campaign = Campaign.prepare(Rig(), read)
    problem = Problem(campaign, "coulomb", "journal", ("inertia",))
    shifted, solution = with_motion_errors(problem, minimum(problem, [{}]))
    motion = solution.samples.motion
    assert motion is not None
    samples = replace(shifted.campaign.samples, motion=motion)
    candidates = Candidates(replace(shifted.campaign, samples=samples), "coulomb", "journal")
    simple = candidates.converge(("inertia",))
    gain = share * motion.mean_share(samples.weight) * samples.count
    model = candidates.fitted(("inertia", effect)).problem
    present = candidates.fitted(("inertia",)).named_values()
    values = np.array([present.get(name, 0.01) for name in model.names])
    rich = replace(
        model.solution(values, simple.samples, simple.noise),
        residuals=[r * np.exp(-0.5 * gain / samples.count) for r in simple.residuals],
    )
    assert likelihood_gain(rich, simple) == pytest.approx(gain)
    assert (full_gain(candidates, rich, simple) > 0.0) == counts
