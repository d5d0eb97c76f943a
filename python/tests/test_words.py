"""Sentences about models, comparisons and verdicts, each case of each to the letter."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest
from by_hand import TRIALS, comparison_by_hand, diagnosis_by_hand
from jbf import Diagnosis, Model, Rig
from jbf.diagnosis import Remainder, Step, Trial
from jbf.diagnosis.which_law import LawTried
from jbf.reporting.words import (
    comparison_sentence,
    headline_and_rest,
    law_and_effects,
    law_words,
    listed,
    step_name,
    times,
    verdict_sentence,
)

COULOMB = Model(Rig(), "coulomb", ["sensor_offset", "wear_in"])
REACHED = "0.550 N, 1.10 times the noise of 0.500 N"
FALLS = f"the held-out error falls from 2.75 N to {REACHED}"
MISSING = f"Missing: sensor_offset. With it, {FALLS}."


def test_items_are_listed_with_a_word_before_the_last() -> None:
    """No word for none and one, no comma for two."""
    assert [listed("abcd"[:n], "or") for n in range(5)] == [
        "", "a", "a or b", "a, b or c", "a, b, c or d"
    ]  # fmt: skip
    assert listed(iter("ab")) == "a and b"


def test_a_law_with_a_film_has_its_clock_and_another_has_none() -> None:
    """In brackets, or after whatever joins them; a bracket that was not opened is not closed."""
    journal = Model(Rig.thesis())
    assert law_words(journal) == "journal (clock journal)"
    assert law_words(journal, ", ") == "journal, clock journal"
    assert law_words(COULOMB) == law_words(COULOMB, ", ") == "coulomb"
    assert law_and_effects(COULOMB) == "coulomb + wear_in + sensor_offset"
    assert law_and_effects(journal) == "journal (clock journal)"


def test_an_error_over_a_noise_that_is_none_is_above_it() -> None:
    """Two decimals of the ratio."""
    assert [times(e, 0.5) for e in (0.0, 0.25, 0.6474)] == [
        "0.00 times", "0.50 times", "1.29 times"
    ]  # fmt: skip
    assert times(0.0, 0.0) == "above"


def test_how_far_a_model_is_from_its_runs() -> None:
    """RMS and noise in the rig's unit, and their ratio."""
    assert comparison_sentence(comparison_by_hand(1.25, (1.0, 1.5))) == (
        "RMS 1.25 N against a noise floor of 0.500 N: 2.50 times the noise"
    )


def test_the_headline_of_each_verdict_and_what_else_there_is() -> None:
    """The first sentence stands alone; of what remains the headline has no numbers."""
    missing = diagnosis_by_hand("missing")
    assert headline_and_rest(missing) == ("Missing: sensor_offset.", f"With it, {FALLS}.")
    adequate = diagnosis_by_hand("adequate")
    assert headline_and_rest(adequate) == ("Nothing is missing.", verdict_sentence(adequate))
    unexplained = diagnosis_by_hand("unexplained")
    remains = "omething remains that no effect in the catalogue explains."
    assert headline_and_rest(unexplained) == (f"S{remains}", verdict_sentence(unexplained))
    both = replace(missing, verdict="unexplained", unexplained=unexplained.unexplained)
    headline, rest = headline_and_rest(both)
    assert headline == f"Missing: sensor_offset; besides, s{remains}"
    assert rest == verdict_sentence(both).removeprefix("Missing: sensor_offset. ")
    assert rest.startswith(f"With it, {FALLS}. Besides, something remains")
    headline, rest = headline_and_rest(diagnosis_by_hand("ambiguous"))
    assert headline == (
        "Something is missing, and these runs cannot tell which: sensor_offset (62 %) or "
        "sensor_drift (38 %)."
    )
    assert rest == f"With sensor_offset, {FALLS}; the alternatives do as well."


def test_ties_are_told_group_by_group_and_an_effect_alone_is_in_none() -> None:
    """Weights where they are known; one effect's alternatives apart from another's."""
    d = replace(
        diagnosis_by_hand("ambiguous"),
        effects=("sensor_offset", "wear_in", "backlash"),
        alternatives={
            "sensor_offset": ("sensor_drift",),
            "wear_in": (),
            "backlash": ("presliding", "time_delay"),
        },
        weights={"sensor_offset": {"sensor_offset": 0.704, "sensor_drift": 0.296}},
    )
    assert verdict_sentence(d).startswith(
        "Something is missing, and these runs cannot tell which: sensor_offset (70 %) or "
        "sensor_drift (30 %); backlash, presliding or time_delay. With sensor_offset, wear_in and "
        "backlash, the held-out"
    )


@pytest.mark.parametrize(
    ("shares", "said"),
    [((), ""), ((0.2,), ": place 0"), ((0.2, 0.3), ": place 1 (and 1 more, see there)"),
     ((0.3, 0.2, 0.1), ": place 0 (and 2 more, see there)")],
)  # fmt: skip
def test_the_largest_of_what_remains_is_told_and_the_others_are_counted(
    shares: tuple[float, ...], said: str
) -> None:
    """Wherever the largest stands in the list."""
    left = tuple(Remainder("time", f"place {i}", share) for i, share in enumerate(shares))
    d = replace(diagnosis_by_hand("unexplained"), unexplained=left)
    assert verdict_sentence(d, ", see there") == (
        f"Something remains that no effect in the catalogue explains{said}. "
        "The held-out error is 2.75 N, 5.50 times the noise of 0.500 N."
    )


def with_last(verdict: str, *trials: Trial) -> Diagnosis:
    """A diagnosis whose last step tried these."""
    d = diagnosis_by_hand(verdict)
    last = replace(d.steps[-1], trials=trials)
    return replace(d, steps=(*d.steps[:-1], last))


ADDED, _, REJECTED, NO_GAIN = TRIALS
DOUBTED = " Fits better, but runs left out do not confirm it, so it is not named: "


@pytest.mark.parametrize(
    ("verdict", "trials", "names"),
    [
        ("missing", (REJECTED, NO_GAIN), "inertia_leak"),
        ("adequate", (REJECTED, replace(REJECTED, effect="wear_in")), "inertia_leak and wear_in"),
        ("missing", (NO_GAIN,), None),
        ("missing", (replace(REJECTED, evidence=0.0),), None),
        ("missing", (replace(REJECTED, evidence=1e-3),), "inertia_leak"),
        ("missing", (REJECTED, ADDED), None),
        ("ambiguous", (REJECTED,), None),
        ("unexplained", (REJECTED,), None),
    ],
)
def test_what_was_not_confirmed_is_told_of_a_verdict_that_it_could_change(
    verdict: str, trials: tuple[Trial, ...], names: str | None
) -> None:
    """Rejected with evidence in a last round that added nothing."""
    said = verdict_sentence(with_last(verdict, *trials))
    if names is None:
        assert DOUBTED not in said
    else:
        assert said.endswith(f"{DOUBTED}{names}.")


def test_laws_that_tie_are_told_and_a_simpler_one_only_where_none_was_chosen() -> None:
    """The first was taken; of the others those that predict alike."""
    d = diagnosis_by_hand("missing")
    asked = {"coulomb": True, "stribeck": True, "lugre": False, "bristle": True}
    tried = [LawTried(name, 2, 0.5, tied) for name, tied in asked.items()]
    simpler = LawTried("stribeck", 4, 0.5432, False)
    chose = " The data chose the law coulomb"
    told = replace(d, laws=tuple(tried), simpler_law=simpler)
    alike = "the simplest of those that predict alike (stribeck and bristle too)"
    assert verdict_sentence(told) == f"{MISSING}{chose}, {alike}."
    alone = replace(d, laws=(tried[0], tried[2]))
    assert verdict_sentence(alone) == f"{MISSING}{chose}."
    assert verdict_sentence(replace(d, simpler_law=simpler)) == (
        f"{MISSING} Another law may be the right one: stribeck, which needs no other friction "
        "beside it, predicts runs left out to within 0.543 N, coulomb with all of this to 0.550 N; "
        "--law auto compares them all."
    )


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_sentences_are_of_the_first_and_of_the_last_step(count: int) -> None:
    """However many there are between them."""
    d = diagnosis_by_hand("missing")
    steps = tuple(Step(("a",) * i, 1.0, 10.0 - i, 0.5 + 0.1 * i, ()) for i in range(count))
    told = replace(d, steps=steps, simpler_law=LawTried("stribeck", 4, 1.0, False))
    last, noise = 11.0 - count, 0.4 + 0.1 * count
    said = verdict_sentence(told)
    assert f"falls from 10.0 N to {last:.{1 if count == 1 else 2}f} N, " in said
    assert f"{last / noise:.2f} times the noise of {noise:.3f} N." in said
    assert f"coulomb with all of this to {last:.{1 if count == 1 else 2}f} N;" in said
    doubted = replace(steps[-1], trials=(replace(REJECTED, effect="wear_in"),))
    said = verdict_sentence(replace(told, steps=(*steps[:-1], doubted)))
    assert f"{DOUBTED}wear_in." in said


def test_each_step_of_a_ledger_is_called_by_what_it_brought() -> None:
    """The bare law, then what came, what went, or neither."""
    effects = [(), ("a",), ("a", "b", "c"), ("b", "c"), ("b", "c"), ("b", "d")]
    steps = [Step(names, 1.0, 1.0, 1.0) for names in effects]
    ledger = cast(Any, SimpleNamespace(steps=steps))
    assert [step_name(ledger, i) for i in range(len(steps))] == [
        "bare law", "+ a", "+ b, + c", "- a", "refitted", "+ d, - c"
    ]  # fmt: skip
    other = cast(Any, SimpleNamespace(steps=steps[2:]))
    assert step_name(other, 0) == "bare law + a, b, c"
