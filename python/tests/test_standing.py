"""Which effects keep their names: what the runs agree on, and what stands in for something else."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from by_hand import Array, coulomb
from jbf import Rig, Run, diagnose
from jbf.diagnosis import recipe, standing
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.constancy import Disagreement, disagreement
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.rounds import Selected, step
from jbf.diagnosis.standing import best_predicting, confounders
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE
from made_up import MadeUp, sets

NOISE_N = 0.1
LAG, OFFSET, DRIFT = "sensor_lag", "sensor_offset", "sensor_drift"
Extra = Callable[[int, Array], Array | float]


def candidates(extra: Extra) -> Candidates:
    """Coulomb's law under turning motions, and what the cell adds, by run and time."""
    t = np.arange(0.0, 20.0, 0.02)
    runs = []
    for i in range(4):
        rate = 1.0 + 0.17 * i
        v = 0.12 * np.sin(rate * t) + 0.05 * np.sin(0.618 * rate * t + i)
        noise = NOISE_N * np.random.default_rng(i).standard_normal(len(t))
        runs.append(Run.from_arrays(t, v, coulomb(t, v, v) + noise + extra(i, t), name=f"run {i}"))
    return Candidates(Campaign.prepare(Rig(), runs), "coulomb", "journal")


def tone(t: Array) -> Array:
    found: Array = 0.3 * np.sin(2.0 * np.pi * 6.3 * t)
    return found


# ---- confounders -------------------------------------------------------------------------------


def test_an_effect_whose_parameter_differs_by_run_is_a_confounder() -> None:
    zeros = (1.5, -0.5, 1.2, -0.2)
    assert confounders(candidates(lambda i, t: zeros[i]), (OFFSET,)) == (OFFSET,)


def test_a_true_effect_beside_a_tone_keeps_its_name() -> None:
    beside = candidates(lambda i, t: 0.5 + tone(t))
    # Its own parameter is the same in all runs, whatever else is there.
    problem, found = beside.fitted((OFFSET,)).problem, beside.converge((OFFSET,))
    assert found.values[problem.names.index("sensor_offset.b_n")] == pytest.approx(0.5, abs=0.02)
    assert found.rms_n > 2.0 * NOISE_N
    assert confounders(beside, (OFFSET,)) == ()


def test_only_the_one_that_differs_is_doubted() -> None:
    # The zero is one, the drift each run's own.
    drifts = (0.12, -0.03, 0.1, -0.02)
    beside = candidates(lambda i, t: 1.0 + drifts[i] * t)
    assert confounders(beside, (OFFSET, DRIFT)) == (DRIFT,)


@pytest.mark.parametrize(("size", "doubted"), [(0.02, False), (0.5, True)])
def test_chance_takes_no_name(size: float, doubted: bool) -> None:
    way = (1.0, -1.0, 1.0, -1.0)
    found = confounders(candidates(lambda i, t: 0.4 + size * way[i]), (OFFSET,))
    assert found == ((OFFSET,) if doubted else ())


def test_a_disagreement_is_what_zeros_of_their_own_would_gain() -> None:
    # Each run's mean off the common one: sums of squares over their variance (Nyblom 1989).
    zeros = np.array([0.55, 0.45, 0.53, 0.47])
    every = candidates(lambda i, t: float(zeros[i]))
    problem, found = every.fitted((OFFSET,)).problem, every.converge((OFFSET,))
    own = disagreement(problem, replace(found, noise=WHITE), OFFSET)
    assert own.degrees == 3
    wanted = 1000.0 * np.sum((zeros - zeros.mean()) ** 2) / NOISE_N**2
    assert own.gain == pytest.approx(wanted, rel=0.2)


@pytest.mark.parametrize(
    ("gain", "own", "stays"),
    [
        # 20 times what it is worth to the runs beyond chance: 5 of 25 are.
        (401.0, Disagreement(25.0 + 20.0, 25, {}), True),
        (1001.0, Disagreement(100.0, 4, {}), False),
        (1921.0, Disagreement(100.0, 4, {}), True),
        (1919.0, Disagreement(100.0, 4, {}), False),
    ],
)
def test_a_name_costs_twenty_times_the_disagreement(
    gain: float, own: Disagreement, stays: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    made_up = MadeUp([OFFSET], sets({"": 0.0, OFFSET: gain}))
    monkeypatch.setattr(standing, "disagreement", lambda problem, whole, name: own)
    assert confounders(cast(Candidates, made_up), (OFFSET,)) == (() if stays else (OFFSET,))


@pytest.mark.parametrize(
    ("gain", "share", "stays"),
    [(80.0, 0.4, False), (80.0, 0.05, True), (100.0, 0.4, True), (88.0, 0.4, False)],
)
def test_weak_evidence_makes_no_name_beside_more_than_it_explains(
    gain: float, share: float, stays: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # 29 of it is the price; a gain of 80 in a thousand samples is 7.7 % of the mean square.
    agreed = Disagreement(0.0, 4, {})
    monkeypatch.setattr(standing, "disagreement", lambda problem, whole, name: agreed)
    made_up = cast(Candidates, MadeUp([OFFSET], sets({"": 0.0, OFFSET: gain})))
    remains = (Remainder("time", "", 0.01), Remainder("stroke", "", share))
    assert confounders(made_up, (OFFSET,), remains) == (() if stays else (OFFSET,))
    assert confounders(made_up, (OFFSET,)) == ()


def test_of_smooth_residuals_a_gain_is_worth_less(monkeypatch: pytest.MonkeyPatch) -> None:
    own = Disagreement(100.0, 4, {})
    monkeypatch.setattr(standing, "disagreement", lambda problem, whole, name: own)
    gains = sets({"": 0.0, OFFSET: 2500.0})
    rough, smooth = (MadeUp([OFFSET], dict(gains), smooth=k) for k in (1, 3))
    assert confounders(cast(Candidates, rough), (OFFSET,)) == ()
    # Three in a row have one sign: a sample is worth six tenths of one.
    assert confounders(cast(Candidates, smooth), (OFFSET,)) == (OFFSET,)


@pytest.mark.parametrize(("spread", "named"), [(0.0, (OFFSET,)), (1.0, ())])
def test_a_diagnosis_takes_the_name_of_a_confounder(
    spread: float, named: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    # A recording that is not asked what it did, and a tone so that structure remains.
    monkeypatch.setattr(recipe, "_weighed", lambda candidates, selected: None)
    monkeypatch.setattr(
        recipe,
        "select",
        lambda c, n, s=None, follow="promising": Selected((OFFSET,), [step(c, (OFFSET,), n, ())]),
    )
    zeros = 2.0 + spread * np.array([1.0, -1.0, 0.8, -0.8])
    made = candidates(lambda i, t: zeros[i] + tone(t))
    runs = [p.run for p in made.campaign.prepared]
    found = diagnose(Rig(), runs, law="coulomb")
    assert found.verdict == "unexplained"
    assert "frequency" in [r.axis for r in found.unexplained]
    assert found.effects == named
    # It stays in the model, where it says what is common to the runs.
    assert found.confounders == (() if named else (OFFSET,))
    assert found.fit.model.effects == (OFFSET,)


# ---- which predicts best -----------------------------------------------------------------------


def left_out(errors: dict[tuple[str, ...], float]) -> Any:
    asked: list[Sequence[str]] = []

    def rms(names: Sequence[str]) -> float:
        asked.append(names)
        return errors[tuple(names)]

    return SimpleNamespace(left_out_rms=rms, asked=asked)


@pytest.mark.parametrize(
    ("whole_n", "less_n", "kept"),
    [(0.50, 0.51, (LAG, OFFSET)), (0.51, 0.50, (LAG,)), (0.50, 0.50, (LAG,))],
)
def test_a_confounder_stays_where_it_helps_to_predict(
    whole_n: float, less_n: float, kept: tuple[str, ...]
) -> None:
    errors = left_out({(LAG, OFFSET): whole_n, (LAG,): less_n})
    assert best_predicting(errors, (LAG, OFFSET), (LAG,)) == kept


def test_where_all_keep_their_names_nothing_is_left_out() -> None:
    errors = left_out({})
    assert best_predicting(errors, (LAG, OFFSET), (LAG, OFFSET)) == (LAG, OFFSET)
    assert errors.asked == []


def test_a_zero_of_each_run_predicts_no_other() -> None:
    # Means of three say of the fourth the contrary; a zero that is mostly common says something.
    for zeros, kept in (((1.5, -1.5, 1.5, -1.5), ()), ((1.5, 0.5, 1.5, 0.5), (OFFSET,))):
        made = candidates(lambda i, t, zeros=zeros: zeros[i])
        assert best_predicting(made, (OFFSET,), ()) == kept
