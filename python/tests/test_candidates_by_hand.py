"""Candidates beside a law that is linear: what is kept of fits, what is told, and prices."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array, coulomb, four_runs
from jbf import Rig
from jbf.diagnosis.candidates import Candidates, Fitted, many_peaks
from jbf.diagnosis.evidence import evidence, price_of
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.strength import RunsAtHand, strength_of
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import effective_share, likelihood_gain, share_of_gain

OFFSET_N = 0.05


def heavier(t: Array, v: Array, a: Array) -> Array:
    return coulomb(t, v, a) + OFFSET_N


@pytest.fixture(scope="module")
def candidates() -> Candidates:
    campaign = Campaign.prepare(Rig(), four_runs(heavier, noise_n=0.1))
    return Candidates(campaign, "coulomb", "journal")


def test_what_followed_from_another_solution_is_void() -> None:
    one: Any = SimpleNamespace(values=np.array([1.0, 2.0]))
    other: Any = SimpleNamespace(values=np.array([3.0, 4.0]))
    problem: Any = SimpleNamespace(names=["a", "b"])
    part: Any = object()
    fitted = Fitted(problem, solution=one, left_out=[part], halves={2: []})
    fitted.improve(one)
    assert (fitted.left_out, fitted.halves) == ([part], {2: []})
    fitted.improve(other)
    assert fitted.found() is other
    assert (fitted.left_out, fitted.halves) == ([], {})
    assert fitted.named_values() == {"a": 3.0, "b": 4.0}
    assert (fitted.state, fitted.least, fitted.promised) == ("posed", np.inf, np.inf)
    assert not fitted.peaks_searched


def test_effects_with_many_peaks_are_known() -> None:
    assert many_peaks(("sensor_offset", "drive_compliance"))
    assert not many_peaks(("sensor_offset",))
    assert not many_peaks(())


def test_effects_are_tried_or_it_is_said_why_not(candidates: Candidates) -> None:
    names, reasons = candidates.names, candidates.not_tried
    assert {"sensor_offset", "inertia_leak"} <= set(names)
    assert not set(names) & set(reasons)
    assert "position_ripple" in reasons
    assert all(reasons.values())
    # What does not go with the law is neither.
    assert "coulomb_drag" not in {*names, *reasons}


def test_fits_are_kept_by_the_set_of_their_effects(candidates: Candidates) -> None:
    both = ("sensor_offset", "inertia_leak")
    assert candidates.fitted(both) is candidates.fitted(both[::-1])
    assert candidates.values_of(("sensor_lag", "inertia_leak")) is None
    base = candidates.converge(())
    assert candidates.converge(()) is base
    assert candidates.fitted(()).state == "converged"
    named = candidates.values_of(())
    assert named is not None
    assert named == candidates.fitted(()).named_values()
    look = candidates.look(("sensor_offset",), base)
    assert look.state == "looked"
    assert candidates.values_of(("sensor_offset",)) is None
    assert set(candidates.one_more(())) == {"sensor_offset"}
    assert candidates.one_more(("inertia_leak",)) == {}
    rich = candidates.converge(("sensor_offset",), base)
    place = candidates.fitted(("sensor_offset",)).problem.names.index("sensor_offset.b_n")
    assert rich.values[place] == pytest.approx(OFFSET_N, abs=0.02)
    assert candidates.one_more(())["sensor_offset"].found() is rich
    # A look once it has converged changes nothing.
    assert candidates.look(("sensor_offset",), base).state == "converged"
    assert candidates.rank(("sensor_offset",)) is rich
    assert candidates.idle(rich) == ()


def test_evidence_is_the_gain_that_counts_less_its_price(candidates: Candidates) -> None:
    base, rich = candidates.converge(()), candidates.converge(("sensor_offset",))
    gain = likelihood_gain(rich, base)
    assert gain > 0.0
    price = candidates.level.price(1, candidates.campaign.samples.count)
    assert price_of(candidates, 1) == price
    assert evidence(candidates, rich, base) == pytest.approx(
        gain * share_of_gain(rich, base) - price
    )
    assert evidence(candidates, rich, base, anywhere=True) == pytest.approx(
        gain * effective_share(rich) - price
    )
    # The other way round nothing is gained, and nothing is cheaper.
    assert evidence(candidates, base, rich) == pytest.approx(-gain - price_of(candidates, -1))


def test_scores_of_what_moves_jumps_say_nothing(candidates: Candidates) -> None:
    base = candidates.converge(())
    for name, known in (("sensor_offset", True), ("time_delay", False), ("sensor_lag", False)):
        score = candidates.score_test((name,), base)
        assert np.isfinite(score) == known
        assert candidates.score_test((name,), base) == score


def test_what_must_show_is_a_share_of_the_price(candidates: Candidates) -> None:
    """A sum of squares that is less by so much in twice the log likelihood."""
    base, samples = candidates.converge(()), candidates.campaign.samples
    shows = DEFAULT.least_score * candidates.level.price(1, samples.count)
    square = samples.square(base.residuals)
    least = candidates._least_square(base)
    assert samples.count * np.log(square / least) == pytest.approx(shows)
    assert candidates._least_square(None) == np.inf


def test_how_far_it_is_is_told() -> None:
    told: list[tuple[str, int, int]] = []
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    some = Candidates(campaign, "coulomb", "journal", progress=lambda *said: told.append(said))
    base = some.converge(())
    sets = [("sensor_offset",), ("inertia_leak",), ("sensor_drift",)]
    some.score_all(sets, base)
    assert told == [(f"testing {name}", i, 3) for i, (name,) in enumerate(sets)]
    told.clear()
    some.look_all(sets, base)
    assert {said.split()[0] for said, *_ in told} == {"looking"}
    assert [(i, n) for _, i, n in told] == [(0, 3), (1, 3), (2, 3)]
    # Those that take longest first.
    for doing, work in (("looking at", some.look_all), ("trying", some.rank_all)):
        told.clear()
        work([("sensor_offset",), ("sensor_offset", "inertia_leak")], base)
        assert [said for said, *_ in told] == [
            f"{doing} sensor_offset, inertia_leak",
            f"{doing} sensor_offset",
        ]
    # Once it was calibrated directions are let go of, and the level is that of these.
    some.calibrate(())
    assert all(f.directions is None for f in some._fitted.values())
    assert some.level.candidates == len(some.names)
    assert some.level.blocks > 0
    assert some.left_out_rms(()) == pytest.approx(0.1, rel=0.1)


# ---- strengths ---------------------------------------------------------------------------------


def test_what_an_effect_changes_is_in_units_of_the_noise() -> None:
    """A zero of 0.02 N in noise of 0.1 N: apart from what the law makes up for, of each sample a
    fifth at most."""
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    candidates = Candidates(campaign, "coulomb", "journal")
    hand = RunsAtHand(candidates, ())
    model = strength_of(candidates, (), "sensor_offset")
    assert model is not None
    assert (model.name, model.page.name) == ("sensor_offset", "b_n")
    usual = float(model.values(1.0)[model.which])
    for times in (0.1, 3.0):
        for change in hand.change(model, times):
            assert change == pytest.approx(np.full(len(change), times * usual))
    assert hand.shares(model, 1.0) is None
    assert hand.noise.white
    shown = hand.shown([np.full(len(f), 0.02) for f in hand.now])[:, 0]
    samples = candidates.campaign.samples
    v = samples.flat([p.motion.velocity_m_s for p in candidates.campaign.prepared])
    x = np.column_stack([np.sign(v), v])
    ones = np.full(len(v), 0.02)
    left = ones - x @ np.linalg.lstsq(x, ones, rcond=None)[0]
    noise = candidates.converge(())
    size = np.sqrt(np.mean(samples.flat(noise.residuals) ** 2) / effective_share(noise))
    assert shown == pytest.approx(left / size, rel=0.02, abs=1e-3)
    assert hand.friction_n == pytest.approx(samples.rms(hand.now))
    # Of no change nothing is forgiven; of a level that is far above the noise next to nothing.
    assert hand.not_forgiven([np.zeros(len(f)) for f in hand.now]) == 1.0
    assert 0.02 <= hand.not_forgiven([np.full(len(f), 0.5) for f in hand.now]) <= 1.0
    # In white noise a gain counts in full, or nearly.
    counts = hand.counts(shown)
    assert len(counts) == 12
    assert all(0.3 < c <= 1.0 for c in counts)
    assert max(counts) == 1.0


def test_a_policy_is_that_of_its_candidates(candidates: Candidates) -> None:
    dear = replace(DEFAULT, imperfection=100.0)
    some = Candidates(candidates.campaign, "coulomb", "journal", dear)
    assert price_of(some, 1) == pytest.approx(some.level.white + 100.0)
