"""The order in which a diagnosis does things, each of which is told what to say: what is asked,
what ends it, and what becomes of the answers."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from jbf import InputError, Rig
from jbf.diagnosis.experiment import Experiment
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.recipe import _lost, _rivals, diagnose
from jbf.errors import Stopped, Unfinished
from made_of import record, samples_of

module = sys.modules["jbf.diagnosis.recipe"]
LAWS = (SimpleNamespace(law="lugre"), SimpleNamespace(law="dahl"))


@dataclass
class Script:
    """What each part of a diagnosis says, the first time, the second, ...; the last one stays."""

    selected: Sequence[Any] = (("one",),)
    on_time: Sequence[Any] = (None,)
    unbiased: Sequence[Any] = (None,)
    weighed: Sequence[Any] = (None,)
    remains: Sequence[Any] = ((),)
    refused: tuple[str, ...] = ()
    lost: bool = False
    doubted: tuple[str, ...] = ()
    weights: dict[str, dict[str, float]] = field(default_factory=dict)
    kept: tuple[str, ...] | None = None
    hidden: tuple[str, ...] = ()
    said: list[Any] = field(default_factory=list)

    def say(self, what: str, answers: Sequence[Any], *told: Any) -> Any:
        """The next answer; what was asked is noted."""
        asked = sum(1 for name, *_ in self.said if name == what)
        self.said.append((what, *told))
        return answers[min(asked, len(answers) - 1)]

    def of(self, what: str) -> list[Any]:
        """How often something was asked, and with what."""
        return [told for name, *told in self.said if name == what]


class Made:
    """Candidates that know nothing."""

    def __init__(self, campaign: Any, law: str, clock: str, *more: Any) -> None:
        self.campaign, self.law, self.more = campaign, law, more
        self.before = more[2] if len(more) > 2 else None
        self.policy, self.reached, self.level = DEFAULT, None, "level"
        self.not_tried = {"far": "no column"}

    def fitted(self, effects: tuple[str, ...]) -> Any:
        return SimpleNamespace(problem=("problem", effects, self.law))

    def converge(self, effects: tuple[str, ...]) -> Any:
        return ("solution", effects)


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A diagnosis by a script; everything that it calls is a part of that."""

    def play(script: Script, law: str = "coulomb") -> Any:
        def selected(candidates: Made, noise_n: float, start: Any = None, follow: str = "") -> Any:
            present = script.say("select", script.selected, candidates.campaign, start, follow)
            if isinstance(present, BaseException):
                raise present
            if not isinstance(present, tuple):
                return present
            steps = [SimpleNamespace(effects=present)]
            return SimpleNamespace(present=present, steps=steps, refused=script.refused, again=None)

        doubted, nothing = script.doubted, cast(Any, None)
        to_see = Experiment("record a rest", nothing, 1.0, 2.0, 3.0)
        parts: dict[str, Any] = {
            "Campaign": SimpleNamespace(prepare=lambda rig, runs: "recorded"),
            "Candidates": Made,
            "check_rig": lambda rig, law: script.say("rig", (None,), law),
            "settled_campaign": lambda campaign, law, clock: "settled",
            "which_law": lambda *_: script.say("law", ((LAWS, {"law journal": "too fast"}),)),
            "_without_bias": lambda c, present: script.say("unbiased", script.unbiased, present),
            "_on_time": lambda c, present: script.say("on_time", script.on_time, present),
            "_weighed": lambda c, present: script.say("weighed", script.weighed, present),
            "_remainder": lambda c, present: script.say("remains", script.remains, present),
            "_lost": lambda *told: script.say("lost", (script.lost,), *told[2:]),
            "_before": lambda c: SimpleNamespace(noise_n=0.5, failures=("failure", c.campaign)),
            "select": selected,
            "confounders": lambda c, present, remains: script.say("doubt", (doubted,), remains),
            "as_it_ended": lambda steps, present, doubted: steps,
            "weights": lambda c, named: script.say("weights", (script.weights,), named),
            "best_predicting": lambda c, present, named: script.kept or named,
            "step": lambda c, kept, noise_n, trials: SimpleNamespace(effects=kept, noise_n=noise_n),
            "finish": lambda problem, solution: SimpleNamespace(
                model="model", of=solution, law=problem[2]
            ),
            "verdict": lambda **told: script.say(
                "verdict", ("adequate" if not told["effects"] else "missing",), told
            ),
            "power": lambda c, present: script.say("power", (("strong",),), present),
            "unseen": lambda c, present, strengths: script.hidden,
            "simpler_law": lambda c, kept, clock: script.say("simpler", ("other",), kept),
            "propose": lambda c, rivals, limits: script.say(
                "propose", ("none parts them",), rivals
            ),
            "propose_to_see": lambda c, present, hidden, limits: script.say(
                "see", (to_see,), hidden
            ),
            "compare_prepared": lambda model, campaign: ("after", campaign),
            "Diagnosis": lambda **told: SimpleNamespace(**told),
        }
        for name, part in parts.items():
            monkeypatch.setattr(module, name, part)
        return diagnose(Rig(), [], law=law)

    return play


class Found(str):
    """A campaign of a name, with what was found in it."""

    findings = ("finding",)
    named = "here"


@pytest.fixture(autouse=True)
def _named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Campaigns are known by their names."""
    made = Made.__init__

    def init(self: Made, campaign: Any, *more: Any) -> None:
        made(self, Found(campaign), *more)

    monkeypatch.setattr(Made, "__init__", init)


# ---- the plain way -----------------------------------------------------------------------------


def test_where_nothing_is_found_the_law_is_adequate(played: Any) -> None:
    script = Script(selected=[()])
    found = played(script)
    assert found.verdict == "adequate"
    assert (found.effects, found.unexplained, found.confounders) == ((), (), ())
    assert (found.next_experiment, found.experiment) == (None, None)
    assert found.failures == ("failure", "settled")
    assert found.after == ("after", "settled")
    assert found.level == "level"
    assert found.not_tried == {"far": "no column"}
    assert found.findings == ("finding",)
    assert (found.power, found.unseen, found.laws) == (("strong",), (), ())
    # One effect more is no reason to ask for another law, nor is none.
    assert found.simpler_law is None
    assert played(Script(selected=[("one",)])).simpler_law is None
    assert found.elapsed_s >= 0.0
    assert [told[0]["remains"] for told in script.of("verdict")] == [False]
    assert script.of("rig") == [["coulomb"]]
    assert script.of("law") == []
    assert len(script.of("select")) == 1
    assert not script.of("doubt")


def test_what_could_be_there_unseen_is_to_be_recorded(played: Any) -> None:
    script = Script(selected=[()], hidden=("backlash",))
    found = played(script)
    assert found.next_experiment == "record a rest"
    assert found.experiment.words == "record a rest"
    assert script.of("see") == [[("backlash",)]]
    assert not script.of("propose")
    # Of a model that lacks something that is no matter.
    named = Script(selected=[("one",)], hidden=("backlash",))
    assert played(named).next_experiment is None
    assert not named.of("see")


def test_rivals_ask_for_a_run_that_parts_them(played: Any) -> None:
    weights = {"one": {"one": 0.6, "two": 0.4}, "three": {"three": 1.0}}
    script = Script(selected=[("one", "three")], weights=weights)
    found = played(script)
    assert found.alternatives == {"one": ("two",), "three": ()}
    assert found.weights == weights
    (told,) = script.of("verdict")
    assert told == [{"effects": 2, "alternatives": 1, "remains": False}]
    assert script.of("propose") == [[[[("one", "three"), ("three", "two")]]]]
    assert found.next_experiment == "none parts them"
    assert found.experiment is None
    # Of two effects another law is asked for, which may say both.
    assert found.simpler_law == "other"
    assert script.of("simpler") == [[("one", "three")]]


def test_a_law_of_its_own_choice_is_told_with_those_refused(played: Any) -> None:
    script = Script(selected=[("one", "two")])
    found = played(script, law="auto")
    assert [t.law for t in found.laws] == ["lugre", "dahl"]
    # The first of them is taken.
    assert found.fit.law == "lugre"
    assert found.not_tried == {"far": "no column", "law journal": "too fast"}
    # Other laws have been asked already.
    assert found.simpler_law is None
    assert script.of("rig") == []


# ---- once more ---------------------------------------------------------------------------------


@pytest.mark.parametrize("what", ["on_time", "unbiased", "weighed"])
def test_what_the_recording_did_is_mended_and_all_begins_again(played: Any, what: str) -> None:
    """From the effects alone that are found on the mended runs."""
    answers = [None, "mended", None] if what == "unbiased" else ["mended", None]
    script = Script(selected=[("one",), ("two",)], **{what: answers})  # type: ignore[arg-type]
    found = played(script)
    assert found.effects == ("two",)
    assert script.of("select") == [["settled", None, ""], ["mended", None, ""]]
    assert found.after == ("after", "mended")
    assert found.failures == ("failure", "mended")
    assert bool(script.of("lost")) == (what == "weighed")


def test_a_bias_that_the_law_shows_is_taken_off_first(played: Any) -> None:
    script = Script(unbiased=["even", None])
    played(script)
    assert script.of("select")[0][0] == "even"
    assert script.of("unbiased")[0] == [()]


def test_weights_that_led_astray_are_given_back(played: Any) -> None:
    script = Script(selected=[("one",), ("two",)], weighed=["weighed"], lost=True)
    found = played(script)
    assert found.effects == ("one",)
    assert found.after == ("after", "settled")
    assert script.of("lost") == [[("one",), ("two",)]]
    # And nothing more is asked for.
    assert len(script.of("weighed")) == 1


def test_what_runs_differ_in_begins_from_the_effects_there_were(played: Any) -> None:
    again = SimpleNamespace(present=("one",), steps=[], refused=(), again="allowed")
    script = Script(selected=[again, ("two",)])
    assert played(script).effects == ("two",)
    assert script.of("select") == [["settled", None, ""], ["allowed", again, ""]]


def test_before_anything_is_left_unexplained_every_candidate_is_fitted(played: Any) -> None:
    script = Script(selected=[("one",), ("two",)], remains=[("left",)])
    found = played(script)
    first, second, third = script.of("select")
    assert (first[1:], second[2], third[2]) == ([None, ""], "all", "all")
    assert second[1].present == ("one",)
    assert found.effects == ("two",)
    assert found.unexplained == ("left",)
    # What remains asks for another law, and no strength is told.
    assert found.simpler_law == "other"
    assert found.power == ()
    assert script.of("doubt") == [[("left",)]]
    # Where that finds nothing more it is the end.
    same = Script(selected=[("one",)], remains=[("left",)])
    played(same)
    assert len(same.of("select")) == 2


def test_there_are_only_so_many_looks(played: Any) -> None:
    script = Script(on_time=["mended"])
    played(script)
    assert len(script.of("select")) == 1 + DEFAULT.most_looks


# ---- what becomes of it ------------------------------------------------------------------------


def test_a_confounder_loses_its_name_and_what_it_left(played: Any) -> None:
    """Of what some runs asked for nothing remains once it is gone: it is out of the model, too."""
    script = Script(selected=[("one", "two")], remains=[("left",), ("left",), ()], doubted=("two",))
    found = played(script)
    assert found.effects == ("one",)
    assert found.unexplained == ()
    assert found.confounders == ()
    assert script.of("power") == [[("one",)]]
    stays = Script(
        selected=[("one", "two")],
        remains=[("left",)],
        doubted=("two",),
        kept=("one", "two"),
    )
    other = played(stays)
    assert other.effects == ("one",)
    assert other.unexplained == ("left",)
    assert other.confounders == ("two",)


def test_what_was_refused_remains(played: Any) -> None:
    found = played(Script(selected=[("one",)], refused=("refused",)))
    assert found.unexplained == ("refused",)
    both = played(Script(selected=[("one",)], refused=("refused",), remains=[("left",)]))
    assert both.unexplained == ("left", "refused")


def test_a_model_that_predicts_better_has_its_line(played: Any) -> None:
    found = played(Script(selected=[("one", "two")], kept=("one",)))
    assert [s.effects for s in found.steps] == [("one", "two"), ("one",)]
    assert found.steps[-1].noise_n == 0.5
    assert found.fit.of == ("solution", ("one",))
    plain = played(Script(selected=[("one", "two")]))
    assert [s.effects for s in plain.steps] == [("one", "two")]
    # The last line is the model's already, whatever the first one was.
    steps = [SimpleNamespace(effects=()), SimpleNamespace(effects=("one",))]
    grown = SimpleNamespace(present=("one",), steps=steps, refused=(), again=None)
    assert [s.effects for s in played(Script(selected=[grown])).steps] == [(), ("one",)]


def test_who_is_interrupted_has_what_there_is(played: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    fitted: Any = SimpleNamespace(name="fit")
    for there, raised in ((fitted, Stopped), (None, KeyboardInterrupt)):
        monkeypatch.setattr(module.Reached, "fit", lambda self, there=there: there)
        with pytest.raises(raised):
            played(Script(selected=[KeyboardInterrupt()]))
    with pytest.raises(Unfinished):
        played(Script(selected=[Unfinished(steps=3.0)]))


def test_what_is_no_limit_is_refused(played: Any) -> None:
    played(Script())
    with pytest.raises(InputError, match="limits"):
        diagnose(Rig(), [], law="coulomb", limits=3)  # type: ignore[arg-type]


# ---- in between --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("times", "present", "lost"),
    [
        (DEFAULT.no_worse + 0.001, ("two", "one"), True),
        (DEFAULT.no_worse - 0.001, ("one", "two"), False),
        # Other effects are no way astray.
        (9.0, ("one",), False),
    ],
)
def test_weights_are_lost_where_the_same_effects_fit_worse(
    times: float, present: tuple[str, ...], lost: bool
) -> None:
    """At the samples that count in both."""
    n = 100
    prepared = [record(0.02 * np.arange(n))]
    half = samples_of(prepared, [np.arange(n) < 50])

    def of(size: float, samples: Any) -> Any:
        wild = np.where(np.arange(n) < 50, size, 99.0 / size)
        found = SimpleNamespace(samples=samples, residuals=[wild])
        return SimpleNamespace(converge=lambda effects: found, policy=DEFAULT)

    last, now = of(1.0, samples_of(prepared)), of(times, half)
    assert _lost(last, now, ("one", "two"), present) == lost


def test_rivals_stand_in_the_place_of_one() -> None:
    assert _rivals(("one", "two"), "one", ("three", "four")) == [
        ("one", "two"),
        ("two", "three"),
        ("two", "four"),
    ]
