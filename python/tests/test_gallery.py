"""Cards of failures: how large a pattern is, what made it, what is said to be done about it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import comparison_by_hand, diagnosis_by_hand
from jbf import Diagnosis
from jbf.comparison.patterns import Failure
from jbf.diagnosis import Remainder
from jbf.errors import InputError
from jbf.reporting import gallery
from jbf.reporting.advice import advice_on
from jbf.reporting.gallery import Card, _sentence, _shares, _size, failure_cards, remainder_cards


@pytest.fixture
def pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures as what they would be called."""
    monkeypatch.setattr(gallery, "svg", lambda axes, alt: (alt, axes[0]))


def pattern(means: list[float], counts: list[int]) -> Failure:
    """A pattern along the direction of motion."""
    known = comparison_by_hand(1.0, (1.0, 1.0)).failures[0]
    return replace(known, means_n=np.array(means), counts=np.array(counts))


@pytest.mark.parametrize(
    ("means", "counts", "size"),
    [
        ([3.0, 4.0], [1, 1], np.sqrt(12.5)),
        ([3.0, -1.0], [3, 1], np.sqrt(7.0)),
        ([2.0, 9.0], [5, 0], 2.0),
        ([2.0, 9.0], [0, 0], 0.0),
        ([2.0, 0.0], [1, 0], 2.0),
    ],
)
def test_the_size_of_a_pattern_is_the_mean_square_root_of_its_samples(
    means: list[float], counts: list[int], size: float
) -> None:
    """Each bin weighs as many samples as it has."""
    assert _size(pattern(means, counts)) == pytest.approx(size)


def test_each_effect_has_its_share_of_a_pattern_the_largest_first() -> None:
    """Less than eight percent is no cause; more than all of it is made all of it."""
    before = comparison_by_hand(2.5, (2.0, 3.0))
    (failure,) = before.failures

    def shares(**times: float) -> dict[str, float]:
        made = {name: [x * r for r in before.residuals] for name, x in times.items()}
        return _shares(before, failure, made)

    assert shares(small=0.2, large=0.5) == pytest.approx({"large": 0.5, "small": 0.2})
    assert list(shares(small=0.2, large=0.5, middle=0.3)) == ["large", "middle", "small"]
    assert shares(seen=0.081, unseen=0.079, against=-0.5) == pytest.approx({"seen": 0.081})
    assert shares(one=0.9, other=0.6) == pytest.approx({"one": 0.6, "other": 0.4})
    assert shares(one=2.0) == pytest.approx({"one": 1.0})


def failed(
    monkeypatch: pytest.MonkeyPatch,
    shares: dict[str, float],
    *,
    now: list[float],
    fails: bool = False,
) -> Card:
    """The card of a pattern of 2 N that fell to `now`."""
    monkeypatch.setattr(gallery, "_shares", lambda *_: shares)
    monkeypatch.setattr(gallery, "means_along", lambda *_: pattern(now, [1, 1]))
    d = diagnosis_by_hand("missing")
    first = replace(d.failures[0], means_n=np.array([2.0, -2.0]), counts=np.array([1, 1]))
    after = replace(d.after, failures=(first,) if fails else ())
    (card,) = failure_cards(replace(d, failures=(first,), after=after))
    return card


ADVICE = advice_on("direction")


@pytest.mark.usefixtures("pictures")
@pytest.mark.parametrize(
    ("shares", "cause"),
    [
        ({}, f"No effect that was added. Usually {ADVICE.causes}."),
        ({"a": 0.6}, "a (60 % of it)."),
        ({"a": 0.4, "b": 0.3}, "a (40 % of it) and b (30 % of it)."),
        ({"a": 0.4, "b": 0.1},
         f"In part a (40 % of it) and b (10 % of it). The rest is usually {ADVICE.causes}."),
    ],
)  # fmt: skip
def test_effects_that_make_most_of_a_pattern_are_its_cause(
    shares: dict[str, float], cause: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From six tenths on; less is a part of it, and nothing is the usual causes'."""
    assert failed(monkeypatch, shares, now=[0.5, 0.5]).cause == cause


@pytest.mark.usefixtures("pictures")
def test_what_is_to_be_done_depends_on_what_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pattern that stays, one that went, one that did not fall and yet is none."""
    to_do = f"{ADVICE.to_do[0].upper()}{ADVICE.to_do[1:]}."
    fell = "the means fall from 2.0 to 0.50 N"
    gone = failed(monkeypatch, {}, now=[0.5, 0.5])
    assert gone.to_do == (
        f"Nothing more: with the final model {fell}, and no pattern is left along it."
    )
    stays = failed(monkeypatch, {}, now=[0.5, 0.5], fails=True)
    assert stays.to_do == f"With the final model {fell}, and a pattern stays. {to_do}"
    assert failed(monkeypatch, {}, now=[2.0, -2.0]).to_do == to_do
    assert (gone.title, gone.share) == ("Along direction", "60 % of the mean square")
    assert gone.looks == "Record above the model."
    picture: Any = gone.picture
    assert picture[0] == "Residual along direction, before and after"


def test_a_diagnosis_without_failures_has_no_cards(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor is asked what the effects made; where that cannot be told no effect is a cause."""

    def refused(*_: object) -> None:
        raise InputError(problem="cannot", mend="do not")

    monkeypatch.setattr(gallery, "made_of", refused)
    monkeypatch.setattr(gallery, "svg", lambda *_: "")
    assert failure_cards(diagnosis_by_hand("adequate")) == []
    (card,) = failure_cards(diagnosis_by_hand("missing"))
    assert card.cause.startswith("No effect that was added. Usually ")


def drawn(monkeypatch: pytest.MonkeyPatch, *left: Remainder, runs: int = 2) -> list[Card]:
    """Cards of what remains, their pictures as the name of what drew them."""

    def drawing(name: str) -> Callable[..., Any]:
        def draw(*given: Any, ax: Any = None, **_: Any) -> Any:
            (ax or given[0]).set_xlabel(name)
            return ax or given[0]

        return draw

    for name in ("residual_in_time", "spectrum", "draw_means"):
        monkeypatch.setattr(gallery, name, drawing(name))
    d = diagnosis_by_hand("unexplained")
    after = replace(d.after, runs=d.after.runs[:runs])
    found: Diagnosis = replace(d, after=after, unexplained=left)
    return remainder_cards(found)


@pytest.mark.usefixtures("pictures")
@pytest.mark.parametrize(
    ("axis", "where", "kind", "title", "drawing"),
    [
        ("frequency", "a 3.00 Hz tone", "frequency", "In the spectrum", "spectrum"),
        ("time", "2 bursts", "bursts", "In bursts", "residual_in_time"),
        ("time", "it grows", "time", "Along time", "draw_means"),
        ("run", "run a is high", "run", "Along run", "draw_means"),
        ("run", "time_delay predicts runs left out no better", "unconfirmed",
         "An effect that runs left out do not confirm", "draw_means"),
        ("velocity", "2 bursts", "velocity", "Along velocity", "draw_means"),
        ("speed range", "slow", "speed range", "Along speed range", "draw_means"),
        ("regime", "film", "regime", "Along regime", "draw_means"),
        ("angle", "once a turn", "angle", "Along angle", "draw_means"),
        ("direction", "forth", "direction", "Along direction", "draw_means"),
        ("force", "large", "force", "Along force", "draw_means"),
        ("way", "a wave", "way", "Over the way", "residual_in_time"),
        ("period", "again", "period", "Again with each period", "residual_in_time"),
        ("stroke", "each", "stroke", "From stroke to stroke", "residual_in_time"),
        ("effects", "more", "effects", "More effects", "residual_in_time"),
        ("parameters", "apart", "parameters", "Runs that disagree on parameters",
         "residual_in_time"),
    ],
)  # fmt: skip
def test_what_remains_has_its_picture_its_title_and_its_advice(
    axis: str, where: str, kind: str, title: str, drawing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By its kind: bursts are told from what grows, and an effect that is doubted from a run."""
    (card,) = drawn(monkeypatch, Remainder(axis, where, 0.126))
    picture: Any = card.picture
    assert (card.title, picture[1].get_xlabel()) == (title, drawing)
    assert picture[0] == f"What remains along {axis}"
    assert picture[1].get_title(loc="left") == ""
    assert card.share == "13 % of the mean square"
    advice = advice_on(kind)
    assert card.cause == f"None in the catalogue. Usually {advice.causes}."
    assert card.to_do == _sentence(advice.to_do)
    assert card.looks == _sentence(where)


@pytest.mark.usefixtures("pictures")
def test_of_one_run_what_differs_by_run_is_seen_in_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """And only that: a speed is seen along the speed."""
    left = (Remainder("run", "high", 0.1), Remainder("velocity", "high", 0.1))
    pictures: list[Any] = [card.picture for card in drawn(monkeypatch, *left, runs=1)]
    assert [p[1].get_xlabel() for p in pictures] == ["residual_in_time", "draw_means"]


@pytest.mark.parametrize(
    ("words", "said"),
    [("a b_c", "A b_c."), ("b_c d", "b_c d."), ("é", "É."), ("done.", "Done."), ("", ".")],
)
def test_a_sentence_ends_once(words: str, said: str) -> None:
    """A capital unless the first word is an effect's name."""
    assert _sentence(words) == said
