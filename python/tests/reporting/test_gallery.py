"""Cards of failures and residual structure: their causes, sizes and advice."""

import re
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from by_hand import LAW, coulomb, diagnosis_by_hand, there_and_back
from golden import golden
from jbf import Diagnosis, Model, ParameterValue, Rig, compare
from jbf.comparison.bins import Axis
from jbf.comparison.parts import added_by
from jbf.diagnosis import Remainder
from jbf.estimation.campaign import Campaign
from jbf.reporting.advice import ADVICE, CHANNELS, NONE, advice_on
from jbf.reporting.gallery import failure_cards, remainder_cards


def percentages(cause: str) -> dict[str, float]:
    """Effects that are named as a cause, with their share of the pattern in percent."""
    return {name: float(x) for name, x in re.findall(r"(\w+) \((\d+) % of it\)", cause)}


def diagnosis_of(offset_n: float, drift_n_s: float, found_offset_n: float) -> Diagnosis:
    """Diagnosis of a record with a sensor offset and a drift.

    The final model has the drift and an offset of `found_offset_n`. The parameters of the law are
    held, so that the part of an effect is all of the force that it adds.
    """
    runs = there_and_back(lambda t, v, a: coulomb(t, v, a) + offset_n + drift_n_s * t)
    fixed: dict[str, ParameterValue | float] = {
        n: ParameterValue(x, None, held=True) for n, x in {**LAW, "F_s": 5.0}.items()
    }
    values = {"sensor_offset.b": found_offset_n, "sensor_drift.d": drift_n_s}
    before = compare(Model(Rig(), "coulomb", (), fixed), runs)
    final = Model(Rig(), "coulomb", ["sensor_offset", "sensor_drift"], {**fixed, **values})
    diagnosis, failures = diagnosis_by_hand("missing"), before.failures
    return replace(diagnosis, before=before, after=compare(final, runs), failures=failures)


def test_shares_of_effects_are_projections_of_their_force_on_the_pattern() -> None:
    """Both effects cause the pattern over time: their shares follow from the bin means."""
    diagnosis = diagnosis_of(2.0, 0.5, 2.0)
    i = next(i for i, f in enumerate(diagnosis.failures) if f.axis == "time")
    failure, card = diagnosis.failures[i], failure_cards(diagnosis)[i]
    shares = percentages(card.cause)
    assert sum(shares.values()) == pytest.approx(100.0, abs=1.0)
    offset = np.concatenate(added_by(diagnosis.after, ["sensor_offset"]))
    assert offset == pytest.approx(np.full(len(offset), 2.0))
    weight = failure.counts
    expected = np.sum(weight * 2.0 * failure.means_n) / np.sum(weight * failure.means_n**2)
    assert shares["sensor_offset"] == pytest.approx(100.0 * expected, abs=1.0)
    names = [name for name, _ in sorted(shares.items(), key=lambda item: -item[1])]
    assert list(shares) == names
    assert "usually" not in card.cause.lower()
    size = np.sqrt(np.average(failure.means_n**2, weights=weight))
    assert f"from {size:.2g} to" in card.to_do


def test_effect_that_causes_part_of_a_pattern_is_named_with_the_usual_causes() -> None:
    """An offset of 1 N causes half of a pattern of 2 N, and the pattern remains."""
    diagnosis = diagnosis_of(2.0, 0.0, 1.0)
    i = next(i for i, f in enumerate(diagnosis.failures) if f.axis == "direction")
    card = failure_cards(diagnosis)[i]
    assert percentages(card.cause) == {"sensor_offset": 50.0}
    assert advice_on("direction").causes in card.cause
    assert re.search(r"from 2\.0 to 1\.00? N", card.to_do)
    assert "remains" in card.to_do


def test_adequate_diagnosis_has_no_failure_cards() -> None:
    assert failure_cards(diagnosis_by_hand("adequate")) == []


def test_card_of_a_pattern_that_no_effect_causes_lists_the_usual_causes() -> None:
    cards = failure_cards(diagnosis_by_hand("unexplained"))
    assert percentages(cards[0].cause) == {}
    assert advice_on("direction").causes in cards[0].cause


@pytest.mark.extended
def test_simulated_pattern_is_attributed_to_the_hidden_effect_that_removes_it() -> None:
    diagnosis = golden("bearing_coulomb_drag")
    cards = failure_cards(diagnosis)
    assert [card.title for card in cards] == [f"Along {f.axis}" for f in diagnosis.failures]
    assert percentages(cards[0].cause)["coulomb_drag"] > 80.0
    first = diagnosis.failures[0]
    size = np.sqrt(np.average(first.means_n**2, weights=first.counts))
    reduction = re.search(r"from ([\d.]+) to ([\d.]+) N, without", cards[0].to_do)
    assert reduction is not None
    assert float(reduction[1]) == pytest.approx(size, rel=0.05)
    assert float(reduction[2]) < 0.3 * size
    assert cards[0].share == f"{100 * first.share:.0f} % of the mean square"


@pytest.mark.parametrize(
    ("axis", "where", "kind", "label"),
    [
        ("frequency", "a 3.00 Hz tone", "frequency", "Frequency (Hz)"),
        ("time", "2 bursts", "bursts", "Time (s)"),
        ("time", "it grows", "time", "Time in the run (s)"),
        ("run", "run a is high", "run", "Run"),
        ("run", "time_delay does not improve the held-out prediction", "unconfirmed", "Run"),
        ("direction", "forward", "direction", "Direction of motion"),
        ("force", "large", "force", "Force of the model (N)"),
        ("momentum", "2 disturbances", "momentum", "Time (s)"),
        ("motion", "too large", "motion", "Time (s)"),
        ("stroke", "each", "stroke", "Time (s)"),
        ("parameters", "disagree", "parameters", "Time (s)"),
    ],
)
def test_card_of_a_residual_structure_has_its_plot_share_and_advice(
    axis: str, where: str, kind: str, label: str
) -> None:
    remains = (Remainder(axis, where, 0.126),)
    (card,) = remainder_cards(replace(diagnosis_by_hand("unexplained"), residual_structure=remains))
    assert f">{label}</text>" in str(card.picture)
    assert card.share == "13 % of the mean square"
    assert card.looks.lower() == f"{where}.".lower()
    assert advice_on(kind).causes in card.cause
    assert card.to_do.lower() == f"{advice_on(kind).to_do}.".lower()


def test_every_axis_and_kind_of_residual_structure_has_advice_text() -> None:
    kinds = {"frequency", "bursts", "way", "period", "stroke", "parameters", "effects", "search"}
    kinds |= {"unconfirmed", "momentum", "motion"}
    assert set(ADVICE) == {*get_args(Axis), *kinds}
    assert advice_on("nothing known") is NONE


@pytest.mark.parametrize("kind", list(ADVICE))
@pytest.mark.parametrize("complete", [True, False])
def test_advice_recommends_no_channel_that_all_runs_contain(kind: str, complete: bool) -> None:
    """Without a channel in one of the runs, it is still recommended."""
    first, *others = there_and_back(coulomb) * 2
    columns = {f"oil_{quantity}_c": np.zeros(len(first)) for quantity in CHANNELS.values()}
    runs = [replace(first, extra=columns), *others]
    if complete:
        runs = [replace(run, extra=columns) for run in runs]
    advice = advice_on(kind, Campaign.prepare(Rig(), runs))
    steps = ADVICE[kind].to_do.split("; ")
    kept = [step for step in steps if not (complete and step in CHANNELS)]
    assert advice.to_do.split("; ") == kept
    assert advice.causes == ADVICE[kind].causes


def test_every_step_that_recommends_a_channel_is_part_of_an_advice() -> None:
    assert set(CHANNELS) <= {
        step for advice in ADVICE.values() for step in advice.to_do.split("; ")
    }


def test_card_of_a_drift_does_not_recommend_a_recorded_temperature() -> None:
    found = diagnosis_by_hand("unexplained")
    prepared = found.after.campaign.prepared
    runs = [replace(p.run, temperature_c=20.0 + 0.0 * p.run.time_s) for p in prepared]
    after = replace(found.after, campaign=Campaign.prepare(Rig(), runs))
    remains = (Remainder("time", "it grows", 0.2),)
    cards = [
        remainder_cards(replace(found, after=compared, residual_structure=remains))[0]
        for compared in (found.after, after)
    ]
    assert ["temperature" in card.to_do for card in cards] == [True, False]
