"""Which effect is added, exchanged or taken out: the rules on made-up likelihoods."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.selection import Round, reconsider, try_candidates, weights
from made_up import BARE_N, MadeUp, N, price, sets

FOUR = ["sensor_offset", "sensor_drift", "sensor_lag", "inertia_leak"]
PRICE = price(1, 4)
"""Of one parameter in a thousand samples, the best of four candidates."""


def made(gains: dict[str, float], **more: Any) -> MadeUp:
    return MadeUp(more.pop("names", FOUR), sets({"": 0.0} | gains), **more)


def tried(candidates: MadeUp, *present: str) -> Round:
    return try_candidates(cast(Candidates, candidates), present)


def outcomes(found: Round) -> dict[str, str]:
    return {t.effect: t.outcome for t in found.trials}


# ---- a round ----------------------------------------------------------------------------------


def test_the_leader_is_added_and_those_close_behind_tie() -> None:
    found = tried(
        made({"sensor_offset": 200, "sensor_drift": 193, "sensor_lag": 190, "inertia_leak": 9})
    )
    assert found.leader == "sensor_offset"
    assert [t.effect for t in found.trials] == FOUR
    assert outcomes(found) == dict(zip(FOUR, ("added", "ties", "rejected", "no gain"), strict=True))
    evidence = [t.evidence for t in found.trials]
    assert evidence == pytest.approx([g - PRICE for g in (200, 193, 190, 9)], abs=1e-6)
    assert found.trials[1].reason == "fits as well as sensor_offset"
    assert found.trials[2].reason == "sensor_offset leads by 10 in evidence"


def test_nothing_is_added_where_nothing_gains_more_than_chance() -> None:
    found = tried(made(dict.fromkeys(FOUR, 0.99 * PRICE)))
    assert found.leader is None
    assert set(outcomes(found).values()) == {"no gain"}
    assert tried(made({**dict.fromkeys(FOUR, 0.0), "sensor_lag": 1.01 * PRICE})).leader == (
        "sensor_lag"
    )


def test_a_fit_that_is_much_better_is_not_called_chance() -> None:
    """2 N down to 1.8 N in a hundred samples at a time: a gain of 200 is worth but a few."""
    for gain, words in (
        (2.0 * N * np.log(2.0 / 1.8), "fits better, but"),
        (50.0, "no more than chance"),
    ):
        (trial,) = tried(made({"sensor_lag": gain}, names=["sensor_lag"], smooth=100)).trials
        assert trial.outcome == "no gain"
        assert trial.evidence < 0.0
        assert words in trial.reason


def test_the_price_rises_with_candidates_and_parameters() -> None:
    gains = {"sensor_lag": 100.0}
    few, many = made(gains), made(gains, names=[*FOUR, "wear_in", "backlash", "time_delay"])
    gap = tried(few).trials[0].evidence - tried(many).trials[0].evidence
    assert gap == pytest.approx(price(1, 7) - price(1, 4))
    # One in a hundred, shared among seven: exceeded by a chi-square 14 times in 10,000.
    assert price(1, 7) == pytest.approx(32.17, abs=0.01)
    assert tried(few).trials[0].evidence == pytest.approx(100.0 - PRICE)


def test_an_effect_that_is_there_is_not_tried_again() -> None:
    found = tried(made({"sensor_lag": 300, "sensor_lag sensor_drift": 400}), "sensor_lag")
    assert found.leader == "sensor_drift"
    assert found.trials[0].evidence == pytest.approx(100.0 - PRICE)
    assert "sensor_lag" not in outcomes(found)


def test_a_smooth_error_counts_for_less() -> None:
    # Signs that change every three samples: correlations 1/3, -1/3, so 1/(1 + 2/3) of a sample.
    evidence = tried(made({"sensor_lag": 100.0}, smooth=3)).trials[0].evidence
    assert evidence == pytest.approx(0.6 * 100.0 - PRICE, rel=0.01)


def test_an_effect_at_its_null_has_no_evidence() -> None:
    # What its fit gains, the search gains: the bare law had not come as far.
    made_up = made({"sensor_lag": 300, "sensor_drift": 100}, nulls=sets({"sensor_lag": 0.0}))
    found = tried(made_up)
    assert found.leader == "sensor_drift"
    lag = next(t for t in found.trials if t.effect == "sensor_lag")
    assert lag.outcome == "no gain"
    assert lag.evidence == pytest.approx(-PRICE)


def test_an_effect_that_another_leaves_at_its_null_is_taken_out() -> None:
    both = sets({"sensor_lag inertia_leak": 0.0})
    gains = {"sensor_lag": 300.0, "inertia_leak": 500.0, "sensor_lag inertia_leak": 600.0}
    kept = reconsider(cast(Candidates, made(gains)), ("sensor_lag", "inertia_leak"))
    assert kept == ("sensor_lag", "inertia_leak")
    left = reconsider(cast(Candidates, made(gains, nulls=both)), ("sensor_lag", "inertia_leak"))
    assert left == ("inertia_leak",)


def test_what_comes_in_anothers_place_may_make_a_third_needless() -> None:
    # A law with a bend and a ringing drive stood in for one loss in the cell.
    names = ["sensor_offset", "inertia_leak", "sensor_hysteresis"]
    gains = {
        "sensor_offset": 200.0,
        "inertia_leak": 100.0,
        "sensor_offset inertia_leak": 400.0,
        "sensor_hysteresis": 900.0,
        "sensor_offset sensor_hysteresis": 901.0,
        # A search that is caught in a valley.
        "inertia_leak sensor_hysteresis": 300.0,
    }
    made_up = made(gains, names=names)
    found = reconsider(cast(Candidates, made_up), ("sensor_offset", "inertia_leak"))
    assert found == ("sensor_hysteresis",)


# ---- runs left out ----------------------------------------------------------------------------


def held_out(gain: float, share: float) -> Round:
    """A candidate that gains a share of its gain in mean square on runs left out."""
    gained = BARE_N**2 * (1.0 - float(np.exp(-gain / N)))
    left_out = {
        frozenset[str](): 3.0,
        frozenset(["sensor_lag"]): float(np.sqrt(9.0 - share * gained)),
    }
    return tried(made({"sensor_lag": gain}, left_out=left_out))


@pytest.mark.parametrize(
    ("gain", "share", "outcome"),
    [
        (PRICE + 59.0, 0.51, "added"),
        (PRICE + 59.0, 0.49, "rejected"),
        (PRICE + 61.0, 0.01, "added"),
        (PRICE + 61.0, -0.01, "rejected"),
    ],
)
def test_runs_left_out_have_a_veto(gain: float, share: float, outcome: str) -> None:
    found = held_out(gain, share)
    assert outcomes(found)["sensor_lag"] == outcome
    assert (found.leader == "sensor_lag") == (outcome == "added")
    words = "largest evidence" if outcome == "added" else "predicts left-out runs no better"
    assert words in found.trials[0].reason
    lacking = f"{share:.0%} of the gain in their log density"
    assert (lacking in found.trials[0].reason) == (outcome == "rejected")
    assert found.unconfirmed == (set() if outcome == "added" else {"sensor_lag"})


@pytest.mark.parametrize(("left_n", "outcome"), [(3.7, "added"), (3.8, "rejected")])
def test_runs_that_are_mostly_better_are_no_excuse_for_one_far_worse(
    left_n: float, outcome: str
) -> None:
    left_out = {frozenset[str](): 3.0, frozenset(["sensor_lag"]): left_n}
    found = tried(made({"sensor_lag": PRICE + 200.0}, left_out=left_out, better=2.0 / 3.0))
    assert outcomes(found)["sensor_lag"] == outcome


def test_after_a_veto_the_next_one_leads() -> None:
    found = tried(
        made(
            {"sensor_offset": 300, "sensor_drift": 200},
            left_out={frozenset(["sensor_offset"]): 2.5},
        )
    )
    assert found.leader == "sensor_drift"
    assert list(outcomes(found).values())[:2] == ["rejected", "added"]


# ---- what is fitted ---------------------------------------------------------------------------


def fitted(candidates: MadeUp, what: str) -> set[str]:
    return {next(iter(s)) for asked, s in candidates.asked if asked == what and len(s) == 1}


def test_an_effect_whose_score_promises_nothing_is_not_fitted() -> None:
    scores = {frozenset(["sensor_lag"]): 0.29 * PRICE}
    scores |= {frozenset(["sensor_drift"]): 0.31 * PRICE}
    candidates = made({"sensor_lag": 500.0, "sensor_drift": 40.0}, scores=scores)
    found = tried(candidates)
    assert "sensor_lag" not in fitted(candidates, "rank")
    assert "sensor_drift" in fitted(candidates, "rank")
    assert outcomes(found)["sensor_lag"] == "no gain"
    # It has gained nothing, and pays for no parameter.
    last = next(t for t in found.trials if t.effect == "sensor_lag")
    assert last.evidence == pytest.approx(-PRICE)


def test_a_score_of_a_smooth_error_counts_for_less() -> None:
    scores = {frozenset(["sensor_lag"]): 0.49 * PRICE}
    scores |= {frozenset(["sensor_drift"]): 0.51 * PRICE}
    candidates = made({"sensor_lag": 500.0, "sensor_drift": 500.0}, scores=scores, smooth=3)
    tried(candidates)
    assert {"sensor_lag", "sensor_drift"} & fitted(candidates, "rank") == {"sensor_drift"}


def test_only_candidates_that_could_lead_converge() -> None:
    # The leader's share is 0.6 * (300 - price), less 60.
    line = 0.6 * (300.0 - PRICE) - 60.0 + PRICE
    ranked = sets({"sensor_offset": 300.0, "sensor_drift": line + 1.0, "sensor_lag": line - 1.0})
    candidates = made({"sensor_offset": 300.0}, ranked=ranked)
    tried(candidates)
    assert {"sensor_offset", "sensor_drift"} <= fitted(candidates, "converge")
    assert "sensor_lag" not in fitted(candidates, "converge")


def test_what_promises_far_less_than_the_leader_has_is_not_followed() -> None:
    line = 0.6 * (300.0 - PRICE) - 60.0
    promised = sets({"sensor_drift": 0.5 * line + 1.0, "sensor_lag": 0.5 * line - 1.0})
    candidates = made({"sensor_offset": 300.0}, promised=promised)
    found = tried(candidates)
    assert found.leader == "sensor_offset"
    assert "sensor_drift" in fitted(candidates, "rank")
    assert "sensor_lag" not in fitted(candidates, "rank")
    (left,) = (t for t in found.trials if t.effect == "sensor_lag")
    assert left.outcome == "rejected"
    assert left.reason == f"could have {line - 2.0:.0f} in evidence at most: not followed"


def test_what_was_left_behind_is_followed_where_the_leader_fails() -> None:
    # The leader predicts runs left out worse: the next has what it was left behind for.
    gains = {"sensor_offset": 300.0, "sensor_lag": 80.0 + PRICE}
    candidates = made(
        gains,
        promised=sets({"sensor_lag": 10.0}),
        left_out=sets({"sensor_offset": 9.0}),
    )
    found = tried(candidates)
    assert found.leader == "sensor_lag"
    assert "sensor_lag" in fitted(candidates, "rank")


def test_a_rival_that_promises_far_less_does_not_replace() -> None:
    gains = {"sensor_lag": 1000.0, "sensor_drift": 1000.0}
    for promised, asked in ((300.0, False), (490.0, True)):
        candidates = made(gains, promised=sets({"sensor_drift": promised}))
        weights(cast(Candidates, candidates), ("sensor_lag",))
        assert ("sensor_drift" in fitted(candidates, "rank")) == asked


def test_a_candidate_converges_where_its_next_step_promises_enough() -> None:
    # Each lacks 10; a step that takes s of the square promises 1000 log(1 / (1 - s)).
    ranked = dict.fromkeys(sets({"sensor_drift": 0.0, "sensor_lag": 0.0}), PRICE - 10.0)
    slopes = {frozenset(["sensor_drift"]): 0.003, frozenset(["sensor_lag"]): 0.001}
    candidates = made({}, ranked=ranked, slopes=slopes)
    tried(candidates)
    assert fitted(candidates, "converge") & {"sensor_drift", "sensor_lag"} == {"sensor_drift"}


def test_an_effect_of_many_peaks_gets_a_second_look_where_it_could_lead() -> None:
    names = ["sensor_offset", "drive_compliance"]
    for share, leader in ((0.55, "drive_compliance"), (0.45, "sensor_offset")):
        ring = price(1, 2) + share * 200.0
        candidates = made(
            {"sensor_offset": price(1, 2) + 200.0, "drive_compliance": ring},
            names=names,
            peaks=sets({"drive_compliance": 900.0}),
        )
        assert tried(candidates).leader == leader


# ---- second thoughts --------------------------------------------------------------------------


def thought_over(candidates: MadeUp, *present: str) -> tuple[str, ...]:
    return reconsider(cast(Candidates, candidates), present)


STAND_IN = {"sensor_lag": 200.0, "sensor_lag sensor_offset": 240.0}


def test_an_effect_that_is_no_longer_needed_goes() -> None:
    whole = "sensor_lag sensor_offset sensor_drift"
    pair = "sensor_offset sensor_drift"
    present = ("sensor_lag", "sensor_offset", "sensor_drift")
    gone = made({**STAND_IN, pair: 400.0, whole: 400.0 + PRICE - 1.0})
    assert thought_over(gone, *present) == ("sensor_offset", "sensor_drift")
    kept = made({**STAND_IN, pair: 400.0, whole: 400.0 + PRICE + 1.0})
    assert thought_over(kept, *present) == present


def test_a_simpler_model_is_fitted_from_the_richer_one_too() -> None:
    whole = "sensor_lag sensor_offset sensor_drift"
    pair = "sensor_offset sensor_drift"
    caught = {**STAND_IN, pair: 300.0, whole: 400.0}
    present = ("sensor_lag", "sensor_offset", "sensor_drift")
    assert thought_over(made(caught), *present) == present
    for more in ({"from_richer": sets({pair: 399.0})}, {"peaks": sets({pair: 399.0})}):
        assert thought_over(made(caught, **more), *present) == ("sensor_offset", "sensor_drift")


@pytest.mark.parametrize(("better", "last"), [(9.0, "sensor_drift"), (7.0, "sensor_lag")])
def test_an_effect_that_another_replaces_better_is_exchanged(better: float, last: str) -> None:
    gains = {
        "sensor_offset": 100.0,
        "sensor_lag": 200.0,
        "sensor_lag sensor_offset": 300.0,
        "sensor_drift sensor_offset": 300.0 + better,
    }
    assert thought_over(made(gains), "sensor_lag", "sensor_offset") == (last, "sensor_offset")


def test_what_left_out_runs_spoke_against_does_not_come_in_by_exchange() -> None:
    gains = {
        "sensor_offset": 100.0,
        "sensor_lag": 200.0,
        "sensor_lag sensor_offset": 300.0,
        "sensor_drift sensor_offset": 400.0,
        "inertia_leak sensor_offset": 320.0,
    }
    candidates, present = cast(Candidates, made(gains)), ("sensor_lag", "sensor_offset")
    assert reconsider(candidates, present) == ("sensor_drift", "sensor_offset")
    against = frozenset({"sensor_drift"})
    assert reconsider(candidates, present, against) == ("inertia_leak", "sensor_offset")


def test_a_single_effect_is_not_questioned() -> None:
    candidates = made({"sensor_lag": 40.0, "sensor_drift": 400.0})
    assert thought_over(candidates, "sensor_lag") == ("sensor_lag",)


def test_at_last_candidates_are_fitted_whatever_their_scores() -> None:
    """A strong effect whose score at its null is that of no effect."""
    gains = sets({"": 0.0, "sensor_lag": 300.0})
    candidates = MadeUp(FOUR, gains, scores={frozenset(["sensor_lag"]): 0.0})
    assert try_candidates(cast(Candidates, candidates), (), "shown").leader is None
    assert try_candidates(cast(Candidates, candidates), (), "all").leader == "sensor_lag"


# ---- whose gain it is -------------------------------------------------------------------------


def test_a_round_begins_again_where_the_model_without_found_its_way() -> None:
    gains = sets({"": 0.0, "sensor_lag": 300.0})
    valley = MadeUp(FOUR, dict(gains), from_richer={frozenset[str](): 295.0})
    found = try_candidates(cast(Candidates, valley), ())
    # Fitted from where the model with the lag ended, the law alone is as good.
    assert found.leader is None
    assert [s for what, s in valley.asked if what == "refit"] == [frozenset[str]()]
    little = MadeUp(FOUR, dict(gains), from_richer={frozenset[str](): 55.0})
    assert try_candidates(cast(Candidates, little), ()).leader == "sensor_lag"
