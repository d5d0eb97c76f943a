"""One round by hand: what is asked in which order, and what an interrupted one has; all as told."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import pytest
from jbf import Rig
from jbf.diagnosis.ledger import Step
from jbf.diagnosis.one_round import OneRound, one_round
from jbf.diagnosis.policy import DEFAULT
from jbf.errors import Stopped, Unfinished

module = sys.modules["jbf.diagnosis.one_round"]


class Told:
    """In place of all that a round asks."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *, settled: Any = None) -> None:
        self.said: list[Any] = []
        self.ends: BaseException | None = None
        self.fit: Any = SimpleNamespace(
            model=SimpleNamespace(effects=("sensor_offset",), law="coulomb", rig=Rig()),
            rms_n=2.0,
        )
        self.comparison: Any = SimpleNamespace(noise_n=0.5, rms_n=1.5)

        def candidates(campaign: Any, law: str, clock: str, *more: Any) -> Any:
            self.said.append(("candidates", campaign, law, clock, *more[:1]))
            return SimpleNamespace(
                campaign=campaign,
                before=more[2] if len(more) > 2 else None,
                fitted=lambda effects: SimpleNamespace(problem=effects),
                converge=lambda effects: effects,
            )

        def tried(candidates: Any, chosen: Any) -> Any:
            self.said.append(("tried", candidates.campaign, chosen))
            if self.ends is not None:
                raise self.ends
            return SimpleNamespace(trials=("trial",))

        def fitted(rig: Any, runs: Any, effects: Any, *, law: str, clock: str) -> Any:
            self.said.append(("fit", runs, tuple(effects), law, clock))
            return self.fit

        campaign = SimpleNamespace(named="a.csv")
        for name, value in {
            "fit": fitted,
            "Campaign": SimpleNamespace(prepare=lambda rig, runs: campaign),
            "compare_prepared": lambda model, campaign: self.comparison,
            "settled_campaign": lambda campaign, law, clock: "whole",
            "settled_again": lambda problem, solution: settled,
            "Candidates": candidates,
            "try_candidates": tried,
            "power": lambda candidates, chosen: (candidates.campaign, candidates.before, chosen),
            "step": lambda candidates, chosen, noise_n, trials: Step(
                chosen, 9.0, 3.0, noise_n, trials
            ),
        }.items():
            monkeypatch.setattr(module, name, value)

    def round(self, **more: Any) -> OneRound:
        runs: Any = ["run"]
        return one_round(Rig(), runs, **more)


def test_a_model_is_fitted_and_all_others_are_tried_beside_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Its line of the ledger has the error of that very fit."""
    told = Told(monkeypatch)
    found = told.round(effects=["sensor_offset"], law="coulomb", clock="contact")
    assert told.said == [
        ("fit", ["run"], ("sensor_offset",), "coulomb", "contact"),
        ("candidates", "whole", "coulomb", "contact", DEFAULT),
        ("tried", "whole", ("sensor_offset",)),
    ]
    assert found.fit is told.fit
    assert found.comparison is told.comparison
    assert found.step == Step(("sensor_offset",), 1.5, 3.0, 0.5, ("trial",))  # type: ignore[arg-type]
    assert found.power == ("whole", None, ("sensor_offset",))  # type: ignore[comparison-overlap]


def test_by_itself_it_is_the_bare_law_of_a_journal(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch)
    told.round()
    assert told.said[0] == ("fit", ["run"], (), "journal", "journal")


def test_what_a_film_has_not_settled_at_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The candidates begin anew there, from where they were."""
    told = Told(monkeypatch, settled="rest")
    found = told.round()
    assert [said[:2] for said in told.said[1:]] == [
        ("candidates", "whole"),
        ("candidates", "rest"),
        ("tried", "rest"),
    ]
    campaign, before, _ = found.power
    assert campaign == "rest"  # type: ignore[comparison-overlap]
    assert before.campaign == "whole"  # type: ignore[attr-defined]


def test_who_looks_on_is_told_as_it_goes(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch)
    told.round(
        progress=lambda *said: told.said.append(said),
        fitted_as=lambda fit, comparison: told.said.append((fit, comparison)),
    )
    kinds = [said if said[0] != "candidates" else "candidates" for said in told.said]
    assert kinds == [
        ("fitting", 0, 0),
        ("fit", ["run"], (), "journal", "journal"),
        (told.fit, told.comparison),
        "candidates",
        ("tried", "whole", ("sensor_offset",)),
        ("how strong each would have to be", 0, 0),
    ]


def test_who_stops_it_has_the_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch)
    told.ends = KeyboardInterrupt()
    with pytest.raises(Stopped) as stopped:
        told.round()
    assert stopped.value.fit is told.fit


def test_what_takes_too_long_has_the_fit_and_is_called_by_its_file(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = Told(monkeypatch)
    told.ends = Unfinished(steps=7e9)
    with pytest.raises(Unfinished, match=r"^a\.csv: ") as ended:
        told.round()
    assert (ended.value.fit, ended.value.steps) == (told.fit, 7e9)
