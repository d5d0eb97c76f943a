"""One round of trials in addition to given effects, and results of an interrupted diagnosis."""

from typing import Any

import pytest
from jbf import Fit, InputError, Rig, diagnose, fit
from jbf.diagnosis.fit_state import Reached
from jbf.diagnosis.manual_round import ManualRound, manual_round
from jbf.errors import Stopped
from linear_campaigns import coulomb_candidates, linear_diagnosis, linear_runs
from shared import shared


@shared
def _round(*effects: str) -> ManualRound:
    return manual_round(Rig(), linear_runs("mass"), effects, law="coulomb")


def test_manual_round_without_effects_has_the_trials_of_the_first_diagnosis_step() -> None:
    step, first = _round().step, linear_diagnosis("mass").steps[0]
    assert step.effects == ()
    assert step.held_out_rms == pytest.approx(first.held_out_rms, rel=1e-6)
    evidence = [{trial.effect: trial.evidence for trial in s.trials} for s in (step, first)]
    assert evidence[0] == pytest.approx(evidence[1], abs=1e-6)


def test_manual_round_with_an_effect_fits_it_and_does_not_try_it_again() -> None:
    found = _round("inertia")
    alone = fit(Rig(), linear_runs("mass"), ["inertia"], law="coulomb")
    assert found.fit.parameters == alone.parameters
    assert found.step.rms == found.comparison.rms == pytest.approx(alone.rms, rel=1e-6)
    assert found.step.noise_rms == found.comparison.noise_rms
    # No effect is missing in addition to the mass, which is not tried again.
    assert {trial.outcome for trial in found.step.trials} == {"no gain"}
    tried = {trial.effect for trial in found.step.trials}
    assert {power.effect for power in found.power} <= tried - {"inertia"} == tried


def test_unknown_effect_of_a_round_is_rejected_by_name() -> None:
    with pytest.raises(InputError, match="inertia_leek"):
        manual_round(Rig(), linear_runs("mass"), ["inertia_leek"], law="coulomb")


def test_fit_of_an_interrupted_round_is_reported_before_its_trials() -> None:
    fits: list[Fit] = []

    def interrupt(text: str, done: int, total: int) -> None:
        if fits:
            raise KeyboardInterrupt

    options: Any = {"progress": interrupt, "fitted_as": lambda fitted, _: fits.append(fitted)}
    with pytest.raises(Stopped) as stopped:
        manual_round(Rig(), linear_runs("mass"), ["inertia"], law="coulomb", **options)
    assert stopped.value.fit is fits[0]
    assert stopped.value.fit.model.effects == ("inertia",)


def test_interrupted_diagnosis_returns_the_model_of_the_last_round() -> None:
    """The interrupt occurs when the second round tests the first candidate again."""
    tested: list[str] = []

    def interrupt(text: str, done: int, total: int) -> None:
        assert 0 <= done <= total
        if text in tested and text.startswith("testing"):
            raise KeyboardInterrupt
        tested.append(text)

    with pytest.raises(Stopped) as stopped:
        diagnose(Rig(), linear_runs("offset and drag"), law="coulomb", progress=interrupt)
    assert stopped.value.fit.model.effects == ("sensor_offset",)
    assert stopped.value.fit.parameters["sensor_offset.b"].value == pytest.approx(0.5, abs=0.1)


def test_diagnosis_interrupted_before_the_first_fit_raises_keyboard_interrupt() -> None:
    def interrupt(text: str, done: int, total: int) -> None:
        if "law" in text:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        diagnose(Rig(), linear_runs("mass"), law="auto", progress=interrupt)
    assert type(stopped.value) is KeyboardInterrupt
    assert Reached().fit() is None


def test_interrupted_diagnosis_has_standard_errors_after_the_work_limit() -> None:
    candidates = coulomb_candidates(linear_runs("mass"))
    candidates.converge(("inertia",))
    candidates.campaign.work.renew(0.0)
    reached = Reached(candidates, ("inertia",)).fit()
    alone = fit(Rig(), linear_runs("mass"), ["inertia"], law="coulomb")
    assert reached is not None
    for name, expected in alone.parameters.items():
        found = reached.parameters[name]
        assert found.value == pytest.approx(expected.value, rel=1e-3)
        assert (found.stderr or 0.0) == pytest.approx(expected.stderr or 0.0, rel=1e-2)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [({"law": "no such law"}, "no such law"), ({"limits": 3}, "limits"), ({"progress": 3}, "prog")],
)
def test_invalid_argument_of_diagnose_is_reported(arguments: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError, match=named):
        diagnose(Rig(), [], **({"law": "coulomb"} | arguments))


def test_diagnosis_with_a_bearing_law_is_rejected_for_a_rig_without_bearing() -> None:
    with pytest.raises(InputError, match=r"\[bearing\]"):
        diagnose(Rig(), linear_runs("mass"), law="journal")
