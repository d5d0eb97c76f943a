"""Diagnoses of the twelve reference campaigns against the truth of their simulations."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from by_hand import assert_recovered
from golden import EXTENDED, GOLDEN, Golden, golden, golden_campaign
from rigsim import axis_campaign


def names(condition: Callable[[Golden], bool]) -> list[Any]:
    """Campaigns whose expected result satisfies a condition, as parameters of a test."""
    return [
        pytest.param(name, marks=pytest.mark.extended) if name in EXTENDED else name
        for name, expected in GOLDEN.items()
        if condition(expected)
    ]


ALL = names(lambda expected: True)
EXPLAINED = names(lambda expected: expected.verdict != "unexplained")
MISSING = names(lambda expected: expected.verdict == "missing")


@pytest.mark.parametrize("name", ALL)
def test_verdict_effects_and_findings_agree_with_the_simulation(name: str) -> None:
    expected, found = GOLDEN[name], golden(name)
    assert found.verdict == expected.verdict, found.summary()
    if expected.verdict == "ambiguous":
        (effect,) = found.effects
        candidates = {effect, *found.alternatives[effect]}
        assert candidates == {*expected.effects, *expected.alternatives}
    else:
        assert set(found.effects) == expected.effects
        assert not any(found.alternatives.values())
    assert bool(found.residual_structure) == (expected.verdict == "unexplained")
    assert expected.findings <= {finding.kind for finding in found.findings}


@pytest.mark.parametrize("name", EXPLAINED)
def test_rms_error_of_the_final_model_is_the_noise_if_nothing_is_unexplained(name: str) -> None:
    noise_rms, last = golden_campaign(name)[2], golden(name).steps[-1]
    assert last.noise_rms == pytest.approx(noise_rms, rel=0.1)
    assert last.rms == pytest.approx(noise_rms, rel=0.06)
    assert last.held_out_rms < 1.1 * noise_rms


@pytest.mark.parametrize("name", EXPLAINED)
def test_effects_and_rms_error_of_the_last_step_are_those_of_the_final_fit(name: str) -> None:
    found = golden(name)
    assert set(found.steps[-1].effects) == set(found.model.effects)
    assert found.steps[-1].rms == pytest.approx(found.fit.rms, rel=1e-6)
    assert found.after.rms == pytest.approx(found.fit.rms, rel=0.02)
    if found.effects:
        assert found.before.rms > found.after.rms


@pytest.mark.parametrize("name", MISSING)
def test_each_effect_added_to_a_golden_diagnosis_reduces_both_errors(name: str) -> None:
    steps = golden(name).steps
    assert steps[0].effects == ()
    assert len(steps) == 1 + len(GOLDEN[name].effects)
    for before, after in pairwise(steps):
        assert after.rms < before.rms
        assert after.held_out_rms < before.held_out_rms


@pytest.mark.parametrize("name", ALL)
def test_weights_of_an_effect_and_its_alternatives_sum_to_one(name: str) -> None:
    found = golden(name)
    assert set(found.weights) == set(found.effects)
    for effect, weights in found.weights.items():
        assert sum(weights.values()) == pytest.approx(1.0)
        assert tuple(weights)[1:] == found.alternatives[effect]
        alternatives = [weights[other] for other in found.alternatives[effect]]
        assert alternatives == sorted(alternatives, reverse=True)


@pytest.mark.parametrize("name", ALL)
def test_outcomes_of_trials_agree_with_the_sign_and_order_of_their_evidence(name: str) -> None:
    """No effect without evidence is added or tied; the added one has the largest evidence."""
    for step in golden(name).steps:
        evidence = [trial.evidence for trial in step.trials]
        assert evidence == sorted(evidence, reverse=True)
        for trial in step.trials:
            assert trial.effect not in step.effects
            if trial.outcome in ("added", "ties", "replaced"):
                assert trial.evidence > 0.0
            if trial.outcome == "no gain":
                assert trial.evidence <= 0.0


def test_frequency_of_a_tone_that_no_effect_explains_is_reported() -> None:
    tones = [r for r in golden("bearing_hum").residual_structure if r.axis == "frequency"]
    assert 0.0 < max(r.share for r in tones) <= 1.0
    assert "Hz" in tones[0].where


@pytest.mark.parametrize(
    ("name", "seed", "swing", "parameters"),
    [
        ("joint_gravity", 14, 8.0, ("gravity.G",)),
        pytest.param(
            "slide_load_dependence",
            15,
            1.0,
            ("dry_load_dependence.mu", "zero_load_dependence.k"),
            marks=pytest.mark.extended,
        ),
    ],
)
def test_effect_parameters_of_a_joint_and_a_slide_are_recovered(
    name: str, seed: int, swing: float, parameters: tuple[str, ...]
) -> None:
    effects = tuple(parameter.split(".")[0] for parameter in parameters)
    hidden: Any = axis_campaign(seed, effects, swing=swing)[1]["effects"]
    for parameter in parameters:
        effect, key = parameter.split(".")
        assert_recovered(golden(name).fit[parameter], hidden[effect][key], errors=4.5, share=0.01)
