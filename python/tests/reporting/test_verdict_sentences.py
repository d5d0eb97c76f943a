"""Sentences about comparisons and verdicts: effects and numbers that they contain."""

import re
from dataclasses import replace
from typing import Any

import pytest
from by_hand import TRIALS, diagnosis_by_hand
from jbf import Diagnosis, Model, Rig
from jbf.diagnosis import Remainder, Step, Trial
from jbf.diagnosis.which_law import LawTried
from jbf.estimation.noise import Noise
from jbf.models.parameter_value import ParameterValue
from jbf.reporting import words

ADDED, TIED, REJECTED, NO_GAIN = TRIALS
FALL = [2.75, 0.55, 1.1, 0.5]
"""Held-out error of the base law and of the final model (N), ratio of the latter to the noise, and
noise (N)."""


def numbers_in(text: str) -> list[float]:
    """The decimal numbers of a text in their order."""
    return [float(x) for x in re.findall(r"\d+\.\d+", text)]


def test_parameter_value_is_rounded_to_the_second_digit_of_its_error() -> None:
    assert words.measured(0.25996, 0.00071) == ("0.25996", "0.00071")
    assert words.measured(649312.7, 7346.0) == ("649300", "7300")
    assert words.measured(0.0, 0.5) == ("0.00", "0.50")
    assert words.measured(3.0e9, 2.0e6) == ("3.0000e+09", "2.0e+06")
    assert words.measured(1.5, None) == words.measured(1.5, float("nan")) == ("1.5000", "")


def test_numbers_are_printed_with_three_digits_and_percentages_with_two() -> None:
    numbers = [words.number(x) for x in (0.0, 0.28571, 12345.6, 1e-9)]
    assert numbers == ["0", "0.286", "12346", "1.00e-09"]
    assert words.percent(ParameterValue(-2.0, 0.01)) == "0.50 %"
    assert words.percent(ParameterValue(0.0, 0.01)) == words.percent(ParameterValue(1.0)) == ""
    assert [words.times(e, 0.5) for e in (0.25, 0.6474)] == ["0.50 times", "1.29 times"]
    assert words.times(1.0, 0.0) == "above"


def test_list_is_joined_by_commas_and_a_conjunction_before_the_last_item() -> None:
    lists = [words.listed("abcd"[:n], "or") for n in range(5)]
    assert lists == ["", "a", "a or b", "a, b or c", "a, b, c or d"]


def test_film_clock_is_printed_only_for_a_law_with_a_film() -> None:
    coulomb = Model(Rig(), "coulomb", ["sensor_offset", "running_in"])
    assert words.law_words(Model(Rig.thesis())) == "journal (clock journal)"
    assert words.law_words(Model(Rig.thesis()), ", ") == "journal, clock journal"
    assert words.law_words(coulomb) == words.law_words(coulomb, ", ") == "coulomb"
    assert words.law_and_effects(coulomb) == "coulomb + running_in + sensor_offset"


@pytest.mark.parametrize(
    ("verdict", "key", "values"),
    [
        ("adequate", "Nothing is missing", [2.75, 5.5, 0.5]),
        ("missing", "Missing: sensor_offset", FALL),
        ("ambiguous", "sensor_offset or sensor_drift explains the records", FALL),
        ("unexplained", "no effect in the catalogue explains", [3.0, 2.75, 5.5, 0.5]),
    ],
)
def test_verdict_sentence_has_effects_and_their_errors(verdict: str, key: str, values: Any) -> None:
    sentence = words.verdict_sentence(diagnosis_by_hand(verdict))
    assert key in sentence
    assert numbers_in(sentence) == values


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_verdict_sentence_has_held_out_errors_of_first_and_last_step(count: int) -> None:
    steps = tuple(Step(("a",) * i, 1.0, 9.5 - i, 0.5 + 0.1 * i, ()) for i in range(count))
    diagnosis = replace(diagnosis_by_hand("missing"), steps=steps)
    last, noise = 10.5 - count, 0.4 + 0.1 * count
    expected = [9.5, last, last / noise, noise]
    assert numbers_in(words.verdict_sentence(diagnosis)) == pytest.approx(expected, abs=6e-3)


def test_headline_has_the_verdict_with_posterior_weights_but_without_errors() -> None:
    heads = {
        verdict: words.headline_and_rest(diagnosis_by_hand(verdict))[0]
        for verdict in ("adequate", "missing", "ambiguous", "unexplained")
    }
    assert heads["adequate"] == "Nothing is missing."
    assert heads["missing"] == "Missing: sensor_offset."
    assert "sensor_offset or sensor_drift" in heads["ambiguous"]
    assert "62 % and 38 %" in heads["ambiguous"]
    assert "no effect in the catalogue" in heads["unexplained"]
    for verdict, head in heads.items():
        rest = words.headline_and_rest(diagnosis_by_hand(verdict))[1]
        assert numbers_in(head) == []
        assert numbers_in(rest) == numbers_in(words.verdict_sentence(diagnosis_by_hand(verdict)))


def test_unexplained_verdict_names_the_identified_effects_and_the_residual_structure() -> None:
    remains = diagnosis_by_hand("unexplained").residual_structure
    both = replace(diagnosis_by_hand("missing"), verdict="unexplained", residual_structure=remains)
    sentence = words.verdict_sentence(both)
    assert sentence.startswith("Missing: sensor_offset.")
    assert numbers_in(sentence) == [*FALL, 3.0]
    headline, _ = words.headline_and_rest(both)
    assert "sensor_offset" in headline
    assert "no effect in the catalogue" in headline


def test_ambiguous_verdict_lists_alternatives_by_effect_with_known_weights() -> None:
    effects = ("sensor_offset", "running_in", "backlash")
    ties = (("sensor_drift",), (), ("presliding", "time_delay"))
    diagnosis = replace(
        diagnosis_by_hand("ambiguous"),
        effects=effects,
        alternatives=dict(zip(effects, ties, strict=True)),
        weights={"sensor_offset": {"sensor_offset": 0.704, "sensor_drift": 0.296}},
    )
    alternatives = words.verdict_sentence(diagnosis).partition(". With")[0].partition(": ")[2]
    assert alternatives.split("; ") == [
        "sensor_offset or sensor_drift explains the records, with probabilities of 70 % and 30 %",
        "backlash, presliding or time_delay explains the records",
    ]


@pytest.mark.parametrize(
    ("shares", "expected"),
    [
        ((), ""),
        ((0.2,), ": place 0"),
        ((0.2, 0.3), ": place 1 (and 1 more, see there)"),
        ((0.3, 0.2, 0.1), ": place 0 (and 2 more, see there)"),
    ],
)
def test_verdict_names_largest_residual_structure(shares: tuple[float, ...], expected: str) -> None:
    remains = tuple(Remainder("time", f"place {i}", share) for i, share in enumerate(shares))
    diagnosis = replace(diagnosis_by_hand("unexplained"), residual_structure=remains)
    sentence = words.verdict_sentence(diagnosis, ", see there")
    assert f"explains{expected}." in sentence


def with_last_trials(verdict: str, *trials: Trial) -> Diagnosis:
    """A diagnosis whose last step tried the given candidates."""
    diagnosis = diagnosis_by_hand(verdict)
    last = replace(diagnosis.steps[-1], trials=trials)
    return replace(diagnosis, steps=(*diagnosis.steps[:-1], last))


@pytest.mark.parametrize(
    ("verdict", "trials", "named"),
    [
        ("missing", (REJECTED, NO_GAIN), True),
        ("adequate", (REJECTED,), True),
        ("missing", (replace(REJECTED, evidence=1e-3),), True),
        ("missing", (NO_GAIN,), False),
        ("missing", (replace(REJECTED, evidence=0.0),), False),
        ("missing", (REJECTED, ADDED), False),
        ("ambiguous", (REJECTED,), False),
        ("unexplained", (REJECTED,), False),
    ],
)
def test_rejected_gain_is_named_if_nothing_is_added(verdict: str, trials: Any, named: bool) -> None:
    """A gain is named if the last step added nothing and the verdict is missing or adequate."""
    sentence = words.verdict_sentence(with_last_trials(verdict, *trials))
    assert sentence.endswith("not named: inertia.") == named


def test_confounders_of_the_model_are_stated_not_to_be_part_of_the_verdict() -> None:
    for names in (("running_in",), ("running_in", "backlash")):
        diagnosis = replace(diagnosis_by_hand("unexplained"), confounders=names)
        without = words.verdict_sentence(diagnosis_by_hand("unexplained"))
        addition = words.verdict_sentence(diagnosis).removeprefix(without)
        assert " and ".join(names) in addition
        assert "not named" in addition


def test_chosen_law_is_named_with_the_laws_that_predict_as_well() -> None:
    tied = {"coulomb": True, "stribeck": True, "lugre": False, "bristle": True}
    laws = tuple(LawTried(name, 2, 0.5, flag) for name, flag in tied.items())
    diagnosis = diagnosis_by_hand("missing")
    sentence = words.verdict_sentence(replace(diagnosis, laws=laws))
    assert "selected from the data: coulomb" in sentence
    assert "stribeck and bristle too" in sentence
    assert "lugre" not in sentence
    without_ties = words.verdict_sentence(replace(diagnosis, laws=(laws[0], laws[2])))
    assert without_ties.endswith("selected from the data: coulomb.")


def test_verdict_sentence_names_a_simpler_law_unless_laws_were_compared() -> None:
    diagnosis = diagnosis_by_hand("missing")
    simpler = LawTried("stribeck", 4, 0.5432, False)
    sentence = words.verdict_sentence(replace(diagnosis, simpler_law=simpler))
    assert "stribeck" in sentence
    assert numbers_in(sentence) == [*FALL, 0.543, 0.55]
    chosen = replace(diagnosis, simpler_law=simpler, laws=(LawTried("coulomb", 2, 0.5, True),))
    assert "stribeck" not in words.verdict_sentence(chosen)


def test_verdict_states_a_large_share_of_coloured_noise_and_its_correlation_time() -> None:
    diagnosis = diagnosis_by_hand("adequate")
    step_s = diagnosis.after.campaign.prepared[0].step_s
    for share, stated in ((0.1, False), (0.75, True)):
        noise = Noise(memory_s=0.32).with_share(share, step_s)
        changed = replace(diagnosis, fit=replace(diagnosis.fit, noise=noise))
        sentence = words.verdict_sentence(changed)
        assert ("75 %" in sentence) == ("0.32 s" in sentence) == stated
