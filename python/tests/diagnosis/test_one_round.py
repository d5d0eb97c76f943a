"""One round of trials next to given effects, and the result of an interrupted diagnosis."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from jbf import Fit, InputError, Rig, diagnose, fit
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.one_round import OneRound, one_round
from jbf.diagnosis.reached import Reached
from jbf.errors import Stopped
from jbf.estimation.campaign import Campaign
from linear_campaigns import linear_diagnosis, linear_runs
from shared import shared


@shared
def _round(*effects: str) -> OneRound:
    return one_round(Rig(), linear_runs("mass"), effects, law="coulomb")


def test_trials_of_a_round_without_effects_are_those_of_the_first_step_of_a_diagnosis() -> None:
    found, first = _round(), linear_diagnosis("mass").steps[0]
    assert found.step.effects == ()
    assert found.step.holdout_rms_n == pytest.approx(first.holdout_rms_n, rel=1e-6)
    evidence = {trial.effect: trial.evidence for trial in found.step.trials}
    assert evidence == pytest.approx(
        {trial.effect: trial.evidence for trial in first.trials}, abs=1e-6
    )


def test_round_with_an_effect_has_the_result_of_fit_and_does_not_try_the_effect_again() -> None:
    found = _round("inertia_leak")
    alone = fit(Rig(), linear_runs("mass"), ["inertia_leak"], law="coulomb")
    assert found.fit.parameters == alone.parameters
    assert found.step.rms_n == found.comparison.rms_n == pytest.approx(alone.rms_n, rel=1e-6)
    assert found.step.noise_n == found.comparison.noise_n
    # Nothing is missing next to the mass, and the mass is not tried again.
    assert {trial.outcome for trial in found.step.trials} == {"no gain"}
    assert "inertia_leak" not in {trial.effect for trial in found.step.trials}
    assert "inertia_leak" not in {power.effect for power in found.power}
    assert {power.effect for power in found.power} <= {t.effect for t in found.step.trials}


def test_unknown_effect_is_rejected() -> None:
    with pytest.raises(InputError, match="inertia_leek"):
        one_round(Rig(), linear_runs("mass"), ["inertia_leek"], law="coulomb")


# ---- progress and interruption ------------------------------------------------------------------


def _interrupt_at(message: str) -> Callable[[str, int, int], None]:
    def progress(text: str, done: int, total: int) -> None:
        if message in text:
            raise KeyboardInterrupt

    return progress


def test_fit_of_a_round_is_reported_before_the_trials() -> None:
    fits: list[Fit] = []

    def interrupt(text: str, done: int, total: int) -> None:
        if fits:
            raise KeyboardInterrupt

    with pytest.raises(Stopped) as stopped:
        one_round(
            Rig(),
            linear_runs("mass"),
            ["inertia_leak"],
            law="coulomb",
            progress=interrupt,
            fitted_as=lambda fitted, comparison: fits.append(fitted),
        )
    assert stopped.value.fit is fits[0]
    assert stopped.value.fit.model.effects == ("inertia_leak",)


def test_interrupted_diagnosis_returns_the_model_of_the_last_round() -> None:
    """Interrupted when the second round tests the first candidate again."""
    tested: list[str] = []

    def interrupt(text: str, done: int, total: int) -> None:
        assert 0 <= done <= total
        if text in tested and text.startswith("testing"):
            raise KeyboardInterrupt
        tested.append(text)

    with pytest.raises(Stopped) as stopped:
        diagnose(Rig(), linear_runs("offset and drag"), law="coulomb", progress=interrupt)
    assert stopped.value.fit.model.effects == ("sensor_offset",)
    assert stopped.value.fit.parameters["sensor_offset.b_n"].value == pytest.approx(0.5, abs=0.1)


def test_diagnosis_interrupted_before_the_first_fit_raises_keyboard_interrupt() -> None:
    with pytest.raises(KeyboardInterrupt) as stopped:
        diagnose(Rig(), linear_runs("mass"), law="auto", progress=_interrupt_at("law"))
    assert type(stopped.value) is KeyboardInterrupt
    assert Reached().fit() is None


def test_model_reached_so_far_is_completed_even_if_the_work_limit_is_used_up() -> None:
    campaign = Campaign.prepare(Rig(), linear_runs("mass"))
    candidates = Candidates(campaign, "coulomb", "journal")
    candidates.converge(("inertia_leak",))
    campaign.work.renew(0.0)
    reached = Reached(candidates, ("inertia_leak",)).fit()
    alone = fit(Rig(), linear_runs("mass"), ["inertia_leak"], law="coulomb")
    assert reached is not None
    for name, expected in alone.parameters.items():
        found = reached.parameters[name]
        assert found.value == pytest.approx(expected.value, rel=1e-3)
        assert (found.stderr or 0.0) == pytest.approx(expected.stderr or 0.0, rel=1e-2)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [({"law": "no such law"}, "no such law"), ({"limits": 3}, "limits"), ({"progress": 3}, "prog")],
)
def test_wrong_argument_of_a_diagnosis_is_rejected_by_name(
    arguments: dict[str, object], named: str
) -> None:
    with pytest.raises(InputError, match=named):
        diagnose(Rig(), [], **({"law": "coulomb"} | arguments))  # type: ignore[arg-type]


def test_bearing_law_without_a_bearing_is_rejected() -> None:
    with pytest.raises(InputError, match=r"\[bearing\]"):
        diagnose(Rig(), linear_runs("mass"))
