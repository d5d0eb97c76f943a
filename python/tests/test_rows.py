"""Rows of many samples: made when asked for, in groups of runs, and left out in groups."""

from __future__ import annotations

import numpy as np
import pytest
from by_hand import coulomb, four_runs, one_way
from jbf import Rig, Run, diagnose, fit
from jbf.estimation import left_out, problem, rows
from jbf.estimation.campaign import Campaign
from jbf.estimation.left_out import left_out_by_run
from jbf.estimation.minimum import minimum
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.rows import OnDemand, every_so_many, groups_of, triangular


def test_few_rows_have_the_products_of_all() -> None:
    random = np.random.default_rng(1)
    r, j = random.standard_normal(500), random.standard_normal((500, 4))
    few_r, few_j = triangular(r, j)
    assert len(few_r) == 5
    assert few_r @ few_r == pytest.approx(r @ r)
    np.testing.assert_allclose(few_j.T @ few_j, j.T @ j)
    np.testing.assert_allclose(few_j.T @ few_r, j.T @ r)
    assert triangular(r[:0], j[:0])[1].shape == (0, 4)


def test_groups_hold_so_many_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rows, "GROUP", 100)
    assert groups_of([10, 10, 30, 5], 2) == [[0, 1, 2], [3]]
    assert groups_of([80, 10, 70], 2) == [[0], [1], [2]]
    monkeypatch.setattr(rows, "GROUP", 10_000)
    assert groups_of([80, 10, 70], 2) == [[0, 1, 2]]


def test_arrays_on_demand_are_a_sequence() -> None:
    asked = []

    def make(i: int) -> np.ndarray:
        asked.append(i)
        return np.full(3, float(i))

    some = OnDemand(make, 3)
    assert asked == []
    assert [a[0] for a in some] == [0.0, 1.0, 2.0]
    assert some[-1][0] == 2.0
    assert [a[0] for a in some[1:]] == [1.0, 2.0]
    assert len(some) == 3
    with pytest.raises(IndexError):
        some[3]


@pytest.mark.parametrize("noise", [WHITE, Noise(0.3, 0.2)])
def test_rows_by_groups_are_those_of_all(noise: Noise, monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = Campaign.prepare(Rig(), four_runs(coulomb, noise_n=0.1))
    posed = Problem(campaign, "stribeck", "journal", ())
    values = posed.starts({})[0]
    # Each run counts in a part of its own.
    kept = [np.arange(len(c)) < 100 * (k + 1) for k, c in enumerate(campaign.samples.counted)]
    samples = campaign.samples.within(kept)
    r, j, count = posed.gauss_newton_rows(values, samples, noise)
    monkeypatch.setattr(rows, "GROUP", 1)
    by_r, by_j, by_count = posed.gauss_newton_rows(values, samples, noise)
    assert len(by_r) == 4 * len(r)
    assert count == by_count == samples.count
    np.testing.assert_allclose(by_j.T @ by_j, j.T @ j, rtol=1e-9)
    np.testing.assert_allclose(by_j.T @ by_r, j.T @ r, rtol=1e-9)


def test_an_answer_does_not_depend_on_what_is_held(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = four_runs(lambda t, v, a: coulomb(t, v, a) + 2.0 * a, noise_n=0.1)
    held = diagnose(Rig(), runs, law="coulomb")
    fitted = fit(Rig(), runs, law="coulomb")
    monkeypatch.setattr(problem, "MOST_HELD", 0)
    monkeypatch.setattr(rows, "GROUP", 1)
    made = diagnose(Rig(), runs, law="coulomb")
    assert held.effects == made.effects == ("inertia_leak",)
    assert made.verdict == held.verdict
    for a, b in zip(held.steps, made.steps, strict=True):
        assert b.holdout_rms_n == pytest.approx(a.holdout_rms_n, rel=1e-6)
    again = fit(Rig(), runs, law="coulomb")
    assert again.rms_n == pytest.approx(fitted.rms_n, rel=1e-9)
    for a, b in zip(fitted.residuals, again.residuals, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-5)


def test_many_runs_are_left_out_in_groups(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(left_out, "MOST_FITS", 3)
    levels = [5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 6.0, 5.0]

    def campaign(order: list[int]) -> list[Run]:
        return [
            one_way(
                f"run {k}",
                lambda t, v, a, k=k: levels[k] * np.sign(v),
                rate=1.0 + 0.1 * k,
                noise_n=0.05,
            )
            for k in order
        ]

    found = {}
    for order in (list(range(8)), [3, 6, 0, 7, 2, 5, 1, 4]):
        posed = Problem(Campaign.prepare(Rig(), campaign(order)), "coulomb", "journal", ())
        left = left_out_by_run(posed, minimum(posed, [{}]))
        rms = {k: float(np.sqrt(np.mean(e**2))) for k, e in zip(order, left, strict=True)}
        found[order[0]] = [rms[k] for k in range(8)]
    np.testing.assert_allclose(found[0], found[3], rtol=1e-6)
    # Run 6 is left out with 0 and 3: nobody else knows of its level, and they pay nothing for it.
    assert found[0][6] == pytest.approx(1.0, rel=0.05)
    assert found[0][0] == pytest.approx(0.05, rel=0.1)
    # The others are predicted by a fit that has it.
    assert found[0][1] > 0.15


def test_a_search_finds_its_way_on_some_of_many_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    assert every_so_many([100] * 50, [f"{k:02}" for k in range(50)]) == list(range(50))
    monkeypatch.setattr(rows, "MOST_SEARCHED", 1000)
    some = every_so_many([100] * 50, [f"{49 - k:02}" for k in range(50)])
    assert some == list(range(9, 50, 10))
    # From twice as many runs as they would be apart.
    names = [f"{k}" for k in range(10)]
    assert every_so_many([200] * 10, names) == [0, 4, 8]
    assert every_so_many([250] * 8, names[:8]) == [0, 4]
    assert every_so_many([280] * 7, names[:7]) == list(range(7))
    # A few long runs are all taken.
    assert every_so_many([5000, 5000], ["a", "b"]) == [0, 1]
    monkeypatch.setattr(rows, "MOST_SEARCHED", 8000)
    runs = [
        one_way(f"{k:02}", coulomb, way=(-1.0) ** k, rate=0.5 + 0.1 * k, noise_n=0.1, seed=k)
        for k in range(30)
    ]
    posed = Problem(Campaign.prepare(Rig(), runs), "coulomb", "journal", ())
    assert 1 < len(posed.thinned.campaign.prepared) < 10
    found = minimum(posed, [{}])
    assert found.converged
    monkeypatch.undo()
    whole = minimum(Problem(posed.campaign, "coulomb", "journal", ()), [{}])
    assert found.rms_n == pytest.approx(whole.rms_n, rel=1e-6)
    assert sum(len(r) for r in found.residuals) == sum(len(run) for run in runs)
