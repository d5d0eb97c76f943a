"""What a diagnosis asks of its candidates on its way, and what holds while it works; as told."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from jbf import InputError, Rig, threads
from jbf.diagnosis.one_round import one_round
from jbf.diagnosis.plan import plan
from jbf.diagnosis.planned import planned_power
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.recipe import _deviate_rather, _on_time, _seen_again, _without_bias, diagnose

module = sys.modules["jbf.diagnosis.recipe"]
ANY: Any = None


def candidates() -> Any:
    """Candidates whose problem and solution say which model they are of."""
    return SimpleNamespace(
        policy=DEFAULT,
        fitted=lambda effects: SimpleNamespace(problem=("problem", effects)),
        converge=lambda effects: ("solution", effects),
    )


# ---- runs that are late ------------------------------------------------------------------------


def asked_of(
    monkeypatch: pytest.MonkeyPatch,
    present: tuple[str, ...],
    bought: tuple[str, ...],
    answers: list[str | None],
) -> tuple[Any, list[Any]]:
    """What is shifted, and what was asked for it."""
    asked: list[Any] = []

    def on_time(problem: Any, solution: Any, policy: Any, *more: Any) -> Any:
        assert policy is DEFAULT
        asked.append((problem[1], solution[1], *more))
        return answers[len(asked) - 1]

    monkeypatch.setattr(module, "on_time", on_time)
    monkeypatch.setattr(module, "bought_by_lateness", lambda effects: bought)
    return _on_time(candidates(), present), asked


def test_runs_that_are_late_beside_the_model_are_shifted(monkeypatch: pytest.MonkeyPatch) -> None:
    one = ("one",)
    assert asked_of(monkeypatch, one, one, ["shifted"]) == ("shifted", [(one, one)])
    # Where no effect may have bought it nothing more is asked.
    assert asked_of(monkeypatch, one, (), [None]) == (None, [(one, one)])


@pytest.mark.parametrize(
    ("bought", "more"),
    [
        # A delay of all is simpler than one of each: it must be beaten.
        (("time_delay",), 1.0),
        (("sensor_lag",), DEFAULT.no_worse),
        (("time_delay", "sensor_lag"), DEFAULT.no_worse),
    ],
)
@pytest.mark.parametrize("answer", [None, "shifted"])
def test_what_effects_make_of_late_runs_the_lateness_may_say_alone(
    bought: tuple[str, ...], more: float, answer: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside the model without them, which may leave no more than the one with them."""
    present = ("drag", *bought)
    found, asked = asked_of(monkeypatch, present, bought, [None, answer])
    assert found == answer
    assert asked == [
        (present, present),
        (("drag",), ("drag",), ("solution", present), more),
    ]


@pytest.mark.parametrize(("differ_n", "rather"), [(0.99, True), (1.0, False), (1.01, False)])
def test_runs_deviate_where_that_leaves_less_than_a_lateness_of_each(
    differ_n: float, rather: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside the deviations what they say of each run is no error."""
    left_n = {"differ": differ_n, "shifted": 1.0}

    def campaign(name: str, between: object) -> Any:
        return SimpleNamespace(name=name, samples=SimpleNamespace(between=between))

    def anew(campaign: Any, law: str, clock: str, policy: Any, *more: Any) -> Any:
        assert (law, clock, policy) == ("journal", "thesis", DEFAULT)
        samples = SimpleNamespace(
            without_deviations=lambda residuals, noise: residuals - 1.0, rms=lambda e: e
        )
        known = SimpleNamespace(residuals=left_n[campaign.name] + 1.0, noise=None, samples=samples)
        return SimpleNamespace(converge=lambda effects: known if effects == ("one",) else None)

    monkeypatch.setattr(module, "Candidates", anew)
    here: Any = SimpleNamespace(
        campaign=campaign("here", None), law="journal", clock="thesis", policy=DEFAULT
    )
    differ, shifted = campaign("differ", "some"), campaign("shifted", None)
    selected: Any = SimpleNamespace(present=("one",), again=differ)
    assert _deviate_rather(here, selected, shifted) == rather
    # What is looked at again for another reason has no say.
    for other in (None, campaign("settled", None)):
        selected.again = other
        assert not _deviate_rather(here, selected, shifted)


@pytest.mark.parametrize(
    ("late", "rather", "bias", "wanted"),
    [
        ("late", False, "bias", "late"),
        ("late", True, "bias", "differ"),
        (None, True, "bias", "bias"),
        (None, True, None, "differ"),
    ],
)
def test_lateness_comes_first_but_for_runs_that_deviate_rather(
    late: str | None, rather: bool, bias: str | None, wanted: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_on_time", lambda candidates, present: late)
    monkeypatch.setattr(module, "_deviate_rather", lambda candidates, selected, again: rather)
    monkeypatch.setattr(module, "_without_bias", lambda candidates, present: bias)
    found: Any = _seen_again(ANY, SimpleNamespace(present=(), again="differ"))  # type: ignore[arg-type]
    assert found == wanted


def test_a_bias_is_asked_for_beside_the_effects_present(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def without_bias(*told: Any) -> str:
        asked.append(told)
        return "corrected"

    monkeypatch.setattr(module, "without_bias", without_bias)
    found: Any = _without_bias(candidates(), ("one",))
    assert found == "corrected"
    assert asked == [(("problem", ("one",)), ("solution", ("one",)), DEFAULT)]


# ---- while it works ----------------------------------------------------------------------------

LONG: dict[str, Callable[[], object]] = {
    "diagnose": lambda: diagnose(Rig(), [], law="no such law"),
    "one_round": lambda: one_round(Rig(), [], law="no such law"),
    "plan": lambda: plan(ANY, limits=ANY, minutes=1.0, noise_n=1.0),
    "planned_power": lambda: planned_power(ANY, [], noise_n=1.0),
}


@pytest.mark.parametrize("name", LONG)
def test_linear_algebra_has_one_thread_while_it_works(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And as many as before once it has ended, in whatever way."""
    said: list[str] = []
    monkeypatch.setattr(threads, "_enter", lambda: said.append("one"))
    monkeypatch.setattr(threads, "_leave", lambda: said.append("all"))
    with pytest.raises(InputError):
        LONG[name]()
    assert (said[0], said[-1]) == ("one", "all")
    assert said.count("one") == said.count("all")


def test_options_of_a_diagnosis_go_by_name() -> None:
    by_place: Any = diagnose
    with pytest.raises(TypeError, match="positional"):
        by_place(Rig(), [], "coulomb")
    with pytest.raises(InputError, match="no such law"):
        by_place(runs=[], rig=Rig(), law="no such law")
