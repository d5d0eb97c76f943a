"""Verdict, confounders, confirmation by held-out runs, and outcomes in the ledger."""

from collections.abc import Callable

import numpy as np
import pytest
from by_hand import Array
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.confirmation import Confirmation
from jbf.diagnosis.ledger import Remainder, Step, Trial, with_final_outcomes
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.residual_structure.constancy import disagreement
from jbf.diagnosis.verdict import (
    best_predicting,
    confounders,
    effects_without_estimate,
    verdict,
)
from jbf.estimation.likelihood import likelihood_gain
from jbf.models.parameter_value import ParameterValue
from linear_campaigns import coulomb_candidates, linear_diagnosis, reversing_runs

OFFSET, DRIFT = "sensor_offset", "sensor_drift"
STRONG = DEFAULT.selection.weak_evidence + 1.0


@pytest.mark.parametrize(
    ("effects", "alternatives", "remains", "expected"),
    [
        (0, 0, False, "adequate"),
        (1, 0, False, "missing"),
        (3, 0, False, "missing"),
        (1, 1, False, "ambiguous"),
        (2, 1, False, "ambiguous"),
        (0, 0, True, "unexplained"),
        (1, 0, True, "unexplained"),
        (1, 1, True, "unexplained"),
    ],
)
def test_verdict_is_determined_by_effects_alternatives_and_residual_structure(
    effects: int, alternatives: int, remains: bool, expected: str
) -> None:
    assert verdict(effects=effects, alternatives=alternatives, remains=remains) == expected


@pytest.mark.parametrize(
    ("evidence", "density", "better", "rms_ratio", "confirmed"),
    [
        # Any evidence: more than half of the gain in the predictive density suffices.
        (DEFAULT.selection.weak_evidence, 0.5, 1.0, 0.5, False),
        (DEFAULT.selection.weak_evidence, 0.51, 0.0, 1.2, True),
        (STRONG, 0.51, 0.0, 1.2, True),
        (STRONG, 0.5, 0.0, 1.0, False),
        # Strong evidence: so does any gain in mean square, or a gain in two of three runs.
        (STRONG, 0.0, 0.0, 1.0 - 1e-9, True),
        (STRONG, 0.0, 0.65, 1.0, False),
        (STRONG, 0.0, DEFAULT.held_out.min_better_share, 1.0, True),
        # The held-out RMS may increase by up to a quarter.
        (STRONG, 0.0, 1.0, DEFAULT.held_out.max_rms_ratio, True),
        (STRONG, 0.0, 1.0, DEFAULT.held_out.max_rms_ratio + 0.01, False),
        (DEFAULT.selection.weak_evidence, 0.9, 1.0, DEFAULT.held_out.max_rms_ratio + 0.01, False),
    ],
)
def test_strong_evidence_needs_less_held_out_gain_than_weak_evidence(
    evidence: float, density: float, better: float, rms_ratio: float, confirmed: bool
) -> None:
    """Share of the gain in predictive density, and share of improved runs."""
    assert Confirmation(1.0, rms_ratio, better, density).confirms(evidence, DEFAULT) == confirmed


def test_strong_evidence_is_confirmed_by_any_held_out_gain() -> None:
    errors_n = ((0.6, 0.5, True), (1.5, 1.6, False), (1.0, 1.0, False), (0.0, 1e-9, False))
    for before_n, after_n, confirmed in errors_n:
        held_out = Confirmation(before_n, after_n, better=0.5, density=0.0)
        assert held_out.confirms(STRONG, DEFAULT) == confirmed


def test_confirmation_has_held_out_errors_with_and_without_the_effect() -> None:
    """An offset of 0.5 N in all runs except the third: four of five runs improve."""
    offsets_n = (0.5, 0.5, 0.0, 0.5, 0.5)
    candidates = _candidates(lambda i, t: offsets_n[i], runs=5)
    found = candidates.confirmation((), OFFSET)
    mean_of_others = [float(np.mean(np.delete(offsets_n, i))) for i in range(5)]
    before = np.sqrt(0.1**2 + np.mean(np.square(offsets_n)))
    after = np.sqrt(0.1**2 + np.mean((np.array(offsets_n) - mean_of_others) ** 2))
    assert found.before_n == pytest.approx(before, rel=0.03)
    assert found.after_n == pytest.approx(after, rel=0.05)
    assert found.better == pytest.approx(0.8)
    assert found.after_n == pytest.approx(candidates.held_out_rms((OFFSET,)))
    assert 0.5 < found.density < 1.0


def _candidates(extra: Callable[[int, Array], Array | float], runs: int = 4) -> Candidates:
    """Coulomb friction in reversing motions, noise of 0.1 N and an additional force."""
    records = reversing_runs(
        lambda i, t, f, random: f + 0.1 * random.standard_normal(len(t)) + extra(i, t),
        runs=runs,
        duration_s=20.0,
    )
    return coulomb_candidates(records)


def test_effect_that_is_equal_in_all_runs_is_not_a_confounder_if_a_tone_remains() -> None:
    candidates = _candidates(lambda i, t: 0.5 + 0.3 * np.sin(2.0 * np.pi * 6.3 * t))
    assert candidates.converge((OFFSET,)).rms > 0.2
    assert confounders(candidates, (OFFSET,)) == ()


def test_effect_whose_parameter_differs_between_runs_is_a_confounder() -> None:
    drifts_n_s = (0.12, -0.03, 0.1, -0.02)
    candidates = _candidates(lambda i, t: 1.0 + drifts_n_s[i] * t)
    assert confounders(candidates, (OFFSET, DRIFT)) == (DRIFT,)


def test_effect_is_named_if_its_gain_exceeds_a_multiple_of_the_disagreement() -> None:
    """The factor is set just below and just above the ratio of this campaign."""
    assert DEFAULT.selection.confounder_ratio == 20.0
    candidates = _candidates(lambda i, t: (0.3 + 0.1 * (-1.0) ** i) * t)
    full, rest = candidates.converge((DRIFT,)), candidates.converge(())
    count = full.samples.count
    gain = count * np.expm1(likelihood_gain(full, rest) / count)
    gain *= candidates.independent_share(full)
    test = disagreement(candidates.fitted((DRIFT,)).problem, full, DRIFT)
    factor = gain / (test.gain - test.degrees)
    for share, doubted in ((0.999, ()), (1.001, (DRIFT,))):
        candidates.policy = DEFAULT.with_values({"selection.confounder_ratio": share * factor})
        assert confounders(candidates, (DRIFT,)) == doubted


def test_large_effect_is_named_although_its_parameter_differs_by_five_per_cent_between_runs() -> (
    None
):
    """The drift explains more than 99 % of the mean square."""
    candidates = _candidates(lambda i, t: (0.3 + 0.015 * (-1.0) ** i) * t)
    explained = (candidates.converge((DRIFT,)).rms / candidates.converge(()).rms) ** 2
    assert explained < 0.01
    assert confounders(candidates, (DRIFT,)) == ()


def test_weak_effect_is_a_confounder_if_the_unexplained_structure_exceeds_its_gain() -> None:
    """The gain of an offset of 0.03 N is below the threshold plus 60."""
    candidates = _candidates(lambda i, t: 0.012)
    remains = (Remainder("time", "", 0.01), Remainder("stroke", "", 0.2))
    assert confounders(candidates, (OFFSET,), remains) == (OFFSET,)
    assert confounders(candidates, (OFFSET,), remains[:1]) == ()
    assert confounders(candidates, (OFFSET,)) == ()
    # A strong effect is not a confounder, regardless of the residual structure.
    assert confounders(_candidates(lambda i, t: 0.08), (OFFSET,), remains) == ()


@pytest.mark.parametrize(
    ("offsets_n", "kept"), [((1.5, -1.5, 1.5, -1.5), ()), ((1.5, 0.5, 1.5, 0.5), (OFFSET,))]
)
def test_confounder_stays_in_the_model_if_held_out_error_falls(
    offsets_n: tuple[float, ...], kept: tuple[str, ...]
) -> None:
    """Alternating offsets: the mean of three predicts the fourth with the wrong sign."""
    assert best_predicting(_candidates(lambda i, t: offsets_n[i]), (OFFSET,), ()) == kept


def test_ledger_reports_effects_that_became_confounders_or_were_replaced() -> None:
    added = [Trial(name, 1.0, 9.0, "added", "leads") for name in ("a", "b", "c")]
    steps = [Step((), 2.0, 2.0, 1.0, (added[0],)), Step(("a",), 1.0, 1.0, 1.0, tuple(added[1:]))]
    ended = with_final_outcomes(steps, ("a", "b"), ("b",))
    assert [step.effects for step in ended] == [(), ("a",)]
    outcomes = {trial.effect: trial.outcome for step in ended for trial in step.trials}
    assert outcomes == {"a": "added", "b": "confounder", "c": "replaced"}


def test_json_of_a_diagnosis_has_the_documented_keys_and_values() -> None:
    found = linear_diagnosis("mass")
    document = found.to_dict()
    assert document["verdict"] == "missing"
    assert document["effects"] == ["inertia"]
    assert document["alternatives"] == {"inertia": []}
    assert document["weights"] == {"inertia": {"inertia": 1.0}}
    assert document["law"] == "coulomb"
    assert document["level"]["candidates"] == len(found.steps[0].trials)
    assert document["policy"]["false_alarm_rate"] == 0.01
    bare, last = document["steps"]
    assert (bare["effects"], last["effects"]) == ([], ["inertia"])
    assert bare["rms"] == found.steps[0].rms
    assert last["held_out_rms"] == found.steps[1].held_out_rms
    assert {t["effect"]: t["outcome"] for t in bare["tried"]}["inertia"] == "added"
    estimate = document["parameters"]["inertia.m_e"]
    assert abs(estimate["value"] - 0.2) < 4.0 * estimate["stderr"]
    assert {"axis", "where", "share"} <= set(document["failures"][0])


VALUE = ParameterValue
"""A value with its standard error."""


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"coulomb_drag.F_d": VALUE(1.0, 0.4)}, True),
        ({"coulomb_drag.F_d": VALUE(1.0, 0.6)}, False),
        ({"coulomb_drag.F_d": VALUE(1.0, held=True)}, False),
        ({"coulomb_drag.F_d": VALUE(1.0)}, False),
        # One of several parameters is sufficient.
        ({"cogging.A": VALUE(1.0, 0.1), "cogging.pitch": VALUE(0.1, held=True)}, True),
        ({"dwell_stiction.a": VALUE(0.1, held=True), "dwell_stiction.s_0": VALUE(3.0, 0.2)}, True),
        # A pitch differs from zero for any amplitude.
        ({"cogging.A": VALUE(1.0, held=True), "cogging.pitch": VALUE(0.1, 0.001)}, False),
        # The null of a stiffness is infinite.
        ({"presliding.sigma": VALUE(2e5, 1e4)}, True),
        ({"presliding.sigma": VALUE(2e5, 3e5)}, False),
    ],
)
def test_effect_is_named_only_if_a_parameter_of_it_is_estimated(
    values: dict[str, ParameterValue], named: bool
) -> None:
    (effect,) = {name.partition(".")[0] for name in values}
    unnamed = effects_without_estimate(values, (effect,), DEFAULT)
    assert unnamed == (() if named else (effect,))


def test_effect_with_strong_evidence_is_a_confounder_if_it_is_much_smaller_than_the_structure() -> (
    None
):
    """The ratio of sizes is set just below and just above that of this campaign."""
    candidates = _candidates(lambda i, t: 0.08)
    rms, rms_without = (candidates.converge(effects).rms for effects in ((OFFSET,), ()))
    size_ratio = float(np.sqrt((1.0 - (rms / rms_without) ** 2) / 0.9))
    for share, doubted in ((0.999, ()), (1.001, (OFFSET,))):
        candidates.policy = DEFAULT.with_values({"selection.min_size_ratio": share * size_ratio})
        assert confounders(candidates, (OFFSET,), [Remainder("time", "", 0.9)]) == doubted
