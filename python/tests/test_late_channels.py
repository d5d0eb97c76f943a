"""What is done about forces that are late: runs are shifted, as one clock has it or each by its own
time, where that beats another model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from jbf import Rig
from jbf.diagnosis import late_channels, recipe
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.late_channels import on_time
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.shifted import Shifted, moved
from jbf.estimation.campaign import Campaign
from jbf.estimation.lateness import Lateness
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from late_runs import DELAY, DIFFER_S, LASTS_S, NOISE_N, campaign, fitted
from made_up import MadeUp, sets, solution


def test_late_runs_are_shifted_to_where_they_belong() -> None:
    problem, solution = fitted(campaign(DIFFER_S), DELAY)
    again = on_time(problem, solution, DEFAULT)
    assert again is not None
    found = again.more_findings
    assert [f.kind for f in found] == ["late_channel"] * 4
    assert [f.run for f in found] == [p.run.name for p in again.prepared]
    # Samples that no reversal comes near tell it to 0.2 ms, one standard error.
    np.testing.assert_allclose([f.size for f in found], DIFFER_S, atol=0.6e-3)
    assert [f.words.split()[5] for f in found] == ["late", "early", "late", "late"]
    # The law alone, without a delay, now fits to the noise, and nothing more is asked for.
    there = fitted(again)
    assert there[1].rms_n == pytest.approx(NOISE_N, rel=0.1)
    before = fitted(problem.campaign)[1].rms_n
    assert before > 5.0 * there[1].rms_n
    assert on_time(*there, DEFAULT) is None


@pytest.mark.parametrize(("share", "believed"), [(0.0, True), (0.3, False)])
def test_what_large_noise_alone_says_is_no_lateness(
    share: float, believed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Runs seem to differ while every sample counts alike, and do not once the noise is weighed."""
    random, drawn = np.random.default_rng(0), []
    for p in campaign((0.0,) * 4).prepared:
        sd = share * np.maximum(np.abs(p.friction_n) - 5.0, 0.0)
        drawn.append(replace(p.run, friction_n=p.friction_n + sd * random.standard_normal(len(sd))))

    def seemingly(problem: object, near: Solution, look: int, *more: object) -> Lateness | None:
        alike = all(set(w.tolist()) <= {0.0, 1.0} for w in near.samples.weight)
        return Lateness(DIFFER_S, 0.0, 3e-3) if alike and look == 0 else None

    monkeypatch.setattr(late_channels, "lateness", seemingly)
    # What is made up here is not in the runs: asked of them, it would not be found.
    monkeypatch.setattr(late_channels, "_differ", lambda found, policy: True)
    there = fitted(Campaign.prepare(Rig(), drawn))
    assert (late_channels._shifted(*there, DEFAULT) is not None) == believed


def test_a_drifting_clock_is_set_right() -> None:
    drift = 1e-3
    problem, solution = fitted(campaign((0.5 * drift * LASTS_S,) * 4, drift), DELAY)
    again = on_time(problem, solution, DEFAULT)
    assert again is not None
    for found in again.more_findings:
        assert (found.kind, found.unit, found.done) == ("drifting_clock", "1", "shifted")
        assert found.size == pytest.approx(drift, rel=0.03)
        assert "slower" in found.words


def test_a_drifting_clock_leaves_no_lateness() -> None:
    drift = 4e-4
    again = on_time(*fitted(campaign((0.5 * drift * LASTS_S,) * 4, drift), DELAY), DEFAULT)
    assert again is not None
    assert fitted(again)[1].rms_n == pytest.approx(NOISE_N, rel=0.1)


@pytest.mark.parametrize(("late_s", "effects"), [(0.0, ()), (25e-3, DELAY)])
def test_runs_that_are_late_alike_stay_as_they_are(late_s: float, effects: tuple[str, ...]) -> None:
    assert on_time(*fitted(campaign((late_s,) * 4), effects), DEFAULT) is None


@pytest.mark.parametrize("own", [True, False])
def test_one_clock_is_believed_where_it_leaves_as_little(own: bool) -> None:
    """Runs that start late by times of their own under a clock that drifts, or on time."""
    drift = 1e-3
    middle = 0.5 * drift * LASTS_S
    truly = np.full(4, middle) + (np.array(DIFFER_S) if own else 0.0)
    again = on_time(*fitted(campaign(truly.tolist(), drift)), DEFAULT)
    assert again is not None
    middles = [float(f.words.split(": ")[1].split()[0]) for f in again.more_findings]
    np.testing.assert_allclose(middles, 1e3 * truly, atol=1.5 if own else 0.2)
    if not own:
        # To the digit: one number says it of all.
        assert np.ptp([f.size for f in again.more_findings]) == np.ptp(middles) == 0.0
    assert fitted(again)[1].rms_n == pytest.approx(NOISE_N, rel=0.1)


def test_one_clock_leaves_a_delay_to_the_instrument() -> None:
    """Runs that are all late by 15 ms, and later by a clock that drifts."""
    drift, delay_s = 5e-4, 15e-3
    late = [0.5 * drift * LASTS_S + delay_s] * 4
    problem, solution = fitted(campaign(late, drift), DELAY)
    again = on_time(problem, solution, DEFAULT)
    assert again is not None
    assert {f.kind for f in again.more_findings} == {"drifting_clock"}
    np.testing.assert_allclose([f.size for f in again.more_findings], drift, rtol=0.05)
    there, delayed = fitted(again, DELAY)
    known = dict(zip(there.names, delayed.values.tolist(), strict=True))
    assert known["time_delay.tau_s"] == pytest.approx(delay_s, rel=0.03)
    assert delayed.rms_n == pytest.approx(NOISE_N, rel=0.1)


@pytest.mark.parametrize(("effects", "more"), [(DELAY, 1.0), (("sensor_lag",), DEFAULT.no_worse)])
def test_one_delay_of_all_runs_must_be_beaten_outright(
    effects: tuple[str, ...], more: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[Solution | None, float]] = []

    def never(
        problem: object, near: object, _: object, richer: Solution | None = None, much: float = 0.0
    ) -> None:
        asked.append((richer, much))

    monkeypatch.setattr(recipe, "on_time", never)
    candidates = MadeUp(list(effects), sets({"": 0.0, effects[0]: 500.0}))
    assert recipe._on_time(cast(Candidates, candidates), effects) is None
    assert [much for _, much in asked] == [0.0, more]
    assert asked[0][0] is None
    assert asked[1][0] is not None
    assert asked[1][0].rms_n == candidates.converge(effects).rms_n


@pytest.mark.parametrize("clocks", [True, False])
def test_a_drift_seen_once_runs_are_on_time_moves_no_middle(
    clocks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A first look tells how late each run is, and not that it grows; a second one tells that, and
    what one clock would have made of the middles: that is known by then."""
    drift = 1e-3
    middle = 0.5 * drift * LASTS_S
    truly = np.full(4, middle) + (0.0 if clocks else np.array(DIFFER_S))

    def in_turn(
        problem: Problem, near: Solution, look: int, chance: float, jumps: bool
    ) -> Lateness | None:
        looks = (Lateness(tuple(truly.tolist()), 0.0, 5e-3), Lateness((middle,) * 4, drift, 0.0))
        return looks[look] if look < len(looks) else None

    monkeypatch.setattr(late_channels, "lateness", in_turn)
    again = on_time(*fitted(campaign(truly.tolist(), drift)), DEFAULT)
    assert again is not None
    middles = [float(f.words.split(": ")[1].split()[0]) for f in again.more_findings]
    np.testing.assert_allclose(middles, 1e3 * truly, atol=0.2)
    assert fitted(again)[1].rms_n == pytest.approx(NOISE_N, rel=0.1)


# ---- compared with another model ---------------------------------------------------------------


def shifted(late_s: Sequence[float]) -> Shifted:
    """As if runs had been shifted to where they are still late by so much."""
    problem, solution = fitted(campaign(late_s))
    return Shifted(problem, solution, np.zeros(4), 0.0)


def test_samples_beside_jumps_decide_nothing_where_the_other_model_leaves_them() -> None:
    """A jump within a sample makes an error of newtons; a model with a delay sets such aside."""
    found = shifted((0.6e-3,) * 4)
    delayed = fitted(found.campaign, DELAY)[1]
    assert found.solution.rms_n > 5.0 * delayed.rms_n
    before, left = late_channels._errors_n(found, delayed, np.inf)
    assert before == pytest.approx(delayed.rms_n)
    assert left < 1.2 * delayed.rms_n
    same = late_channels._errors_n(found, found.solution, np.inf)
    assert same == pytest.approx((found.solution.rms_n,) * 2)


def test_a_few_errors_far_out_decide_nothing() -> None:
    """Noise a tenth larger in one of two, the same outliers in both."""
    random = np.random.default_rng(4)
    small, far = random.standard_normal(20000), np.zeros(20000)
    far[::200] = 30.0
    alike = np.hypot(*(np.std(x) for x in (small, far))), np.hypot(1.1, np.std(far))
    assert alike[1] < 1.03 * alike[0]
    sizes = [late_channels._clipped_rms(k * small + far, 3.5) for k in (1.0, 1.1)]
    assert sizes[1] == pytest.approx(1.1 * sizes[0], rel=0.01)
    whole = late_channels._clipped_rms(small + far, np.inf)
    assert whole == pytest.approx(alike[0], rel=0.02)
    assert late_channels._clipped_rms(np.zeros(0), 3.5) == 0.0


def test_what_runs_that_differ_are_all_late_besides_is_found() -> None:
    late_s = np.array([13e-3, 4e-3, 19e-3, 7e-3])
    problem, solution = fitted(campaign(late_s.tolist()))
    short = late_s - 6e-3
    # All of them 6 ms short of what they are.
    found = Shifted(*fitted(moved(problem, short, 0.0)), short, 0.0)
    whole = late_channels._all_alike(problem, found)
    np.testing.assert_allclose(whole.late_s, late_s, atol=1.2e-3)
    assert whole.solution.rms_n < found.solution.rms_n < solution.rms_n
    # Where nothing is left to find, what was found stays.
    right = Shifted(*fitted(moved(problem, late_s, 0.0)), late_s, 0.0)
    np.testing.assert_allclose(late_channels._all_alike(problem, right).late_s, late_s, atol=1.2e-3)


@pytest.mark.parametrize(("gain", "counts"), [(6.7, False), (7.1, True)])
def test_a_lateness_gains_by_schwarzs_criterion(gain: float, counts: bool) -> None:
    # One run of a thousand samples: log 1000 = 6.91.
    before, after = solution((), 0.0), solution((), gain)
    there = Shifted(cast(Problem, None), after, np.zeros(1), 0.0)
    assert late_channels._gains(before.rms_n, after.rms_n, there) == counts
