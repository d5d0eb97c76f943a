"""Deviations of runs worked by hand: their spread along a column, their words, and judges."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Rig
from jbf.diagnosis.deviations import (
    EVALUATIONS,
    _clearest,
    _columns,
    _predicts_worse,
    _spread,
    _words,
    deviation,
)
from jbf.diagnosis.policy import DEFAULT
from jbf.estimation.noise import WHITE
from jbf.estimation.random_effect import spread_between
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.diagnosis.deviations"]
N = 400


def quiet(seed: int) -> Array:
    """Noise of unit size that knows nothing of a level or of a slope."""
    t = np.linspace(-1.0, 1.0, N)
    e = np.random.default_rng(seed).standard_normal(N)
    basis = np.linalg.qr(np.column_stack([np.ones(N), t, t**2]))[0]
    left: Array = e - basis @ (basis.T @ e)
    left /= np.sqrt(np.mean(left**2))
    return left


def runs(residuals: list[Array], lasts_s: float = 8.0) -> tuple[Any, Any, Any]:
    """A law of two parameters, one of them the oil's, whose friction is 1 N to 3 N."""
    prepared = [
        record(2.0 + np.linspace(0.0, lasts_s, len(r)), name="abcdef"[i])
        for i, r in enumerate(residuals)
    ]
    jacobian = [
        np.stack([np.full(len(r), 0.5), np.linspace(0, 1, len(r)) ** 2], 1) for r in residuals
    ]
    friction = [np.linspace(1.0, 3.0, len(r)) for r in residuals]
    problem: Any = SimpleNamespace(
        campaign=SimpleNamespace(prepared=prepared, rig=Rig()),
        names=("f_m", "K0", "gamma"),
        open=(0, 2),
        predict=lambda values: friction,
    )
    samples = samples_of(prepared)
    solution: Any = SimpleNamespace(
        residuals=residuals, jacobian=jacobian, noise=WHITE, values=None, samples=samples
    )
    return problem, solution, samples


def test_what_may_deviate_is_a_zero_its_drift_the_oil_and_the_gain() -> None:
    problem, solution, _ = runs([quiet(1), quiet(2)])
    found = {name: (unit, column) for name, unit, column in _columns(problem, solution)}
    assert {name: unit for name, (unit, _) in found.items()} == {
        "zero": "N",
        "drift": "N/s",
        "gamma": "1",
        "gain": "1",
    }
    for i in range(2):
        assert np.all(found["zero"][1][i] == 1.0)
        # About the middle of the run.
        assert found["drift"][1][i] == pytest.approx(np.linspace(-4.0, 4.0, N))
        assert found["gamma"][1][i] == pytest.approx(np.linspace(0.0, 1.0, N) ** 2)
        assert found["gain"][1][i] == pytest.approx(np.linspace(1.0, 3.0, N))


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_the_spread_of_zeros_is_theirs_beyond_their_errors(unit: float) -> None:
    """Levels that each run knows to sigma over the root of its samples."""
    levels = np.array([0.5, -0.5, 1.0, -1.0])
    problem, solution, samples = runs([unit * (quiet(i) + x) for i, x in enumerate(levels)])
    column = [np.ones(N)] * 4
    found = _spread(samples, solution, column, unit)
    assert found is not None
    wanted = spread_between(unit * levels, np.full(4, N / unit**2))
    assert found == pytest.approx(wanted, rel=1e-6)
    # Half as large a column is twice as large a deviation.
    half = _spread(samples, solution, [0.5 * c for c in column], unit)
    assert half is not None
    assert half[0] == pytest.approx(2.0 * found[0])
    assert half[1:] == pytest.approx(found[1:])
    assert problem.names


def test_a_run_that_does_not_know_it_is_left_out_and_three_must_know() -> None:
    levels = [0.5, -0.5, 1.0, 9.0]
    _, solution, samples = runs([quiet(i) + x for i, x in enumerate(levels)])
    column = [np.ones(N)] * 3 + [np.zeros(N)]
    found = _spread(samples, solution, column, 1.0)
    assert found is not None
    assert found == pytest.approx(spread_between(np.array(levels[:3]), np.full(3, float(N))))
    assert _spread(samples, solution, [np.ones(N)] * 2 + [np.zeros(N)] * 2, 1.0) is None
    assert _spread(samples, solution, column, 0.0) is None


def test_the_clearest_is_the_one_that_chance_makes_least_of() -> None:
    """Zeros of their own beside drifts that are less clear."""
    t = np.linspace(-4.0, 4.0, N)
    levels, drifts = (1.8, -2.4, 0.6, 0.0), (0.1, 0.1, 0.1, -0.3)
    residuals = [quiet(i) + x + d * t for i, (x, d) in enumerate(zip(levels, drifts, strict=True))]
    problem, solution, samples = runs(residuals)
    found = _clearest(problem, solution, samples, 1e-4)
    assert found is not None
    between, finding = found
    assert between.names == ("zero",)
    assert (finding.kind, finding.channel, finding.run) == (
        "level_by_run",
        "friction_n",
        "a, b, c, d",
    )
    assert (finding.unit, finding.done) == ("N", "a spread of the runs")
    assert finding.size == pytest.approx(np.std(levels, ddof=1), rel=0.05)
    for direction in between.directions:
        assert direction.shape == (N, 1)
        assert np.all(direction == finding.size)
    # Once it is known the next is asked for, and both are allowed for.
    again = _clearest(problem, solution, replace(samples, between=between), 1e-2)
    assert again is not None
    assert again[0].names == ("zero", "drift")
    assert again[0].directions[0].shape == (N, 2)
    assert again[0].directions[0][:, 0] == pytest.approx(np.full(N, finding.size))
    assert again[1].kind == "drift_by_run"


def test_what_is_within_chance_keeps_no_other_from_being_looked_at() -> None:
    """Zeros that agree and drifts that do not; a run that does not know comes first."""
    t = np.linspace(-4.0, 4.0, N)
    residuals = [quiet(i) + d * t for i, d in enumerate((0.3, -0.3, 0.2, -0.2))]
    problem, solution, samples = runs(residuals)
    found = _clearest(problem, solution, samples, 1e-4)
    assert found is not None
    assert found[0].names == ("drift",)
    levels = [9.0, 0.5, -0.5, 1.0]
    _, solution, samples = runs([quiet(i) + x for i, x in enumerate(levels)])
    column = [np.zeros(N)] + [np.ones(N)] * 3
    told = _spread(samples, solution, column, 1.0)
    assert told == pytest.approx(spread_between(np.array(levels[1:]), np.full(3, float(N))))


def test_of_two_runs_or_within_chance_nothing_is_told() -> None:
    problem, solution, samples = runs([quiet(i) + x for i, x in enumerate((0.6, -0.8))])
    assert _clearest(problem, solution, samples, 1.0) is None
    problem, solution, samples = runs([quiet(i) for i in range(4)])
    assert _clearest(problem, solution, samples, 1.0) is None
    problem, solution, samples = runs([quiet(i) + x for i, x in enumerate((0.6, -0.8, 0.2, 0.0))])
    assert _clearest(problem, solution, samples, 0.0) is None


@pytest.mark.parametrize(
    ("ratios", "most", "worse"),
    [
        # The mean of the logarithms, less its own error, against that of the ratio.
        ((1.1, 1.1, 1.1), 1.09, True),
        ((1.1, 1.1, 1.1), 1.11, False),
        ((0.9, 0.9, 0.9), 1.03, False),
        # exp(0.1) and exp(0.3): 0.2 give or take 0.1.
        ((float(np.exp(0.1)), float(np.exp(0.3))), float(np.exp(0.09)), True),
        ((float(np.exp(0.1)), float(np.exp(0.3))), float(np.exp(0.11)), False),
    ],
)
def test_runs_left_out_are_predicted_worse_beyond_their_scatter(
    ratios: tuple[float, ...], most: float, worse: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each run alike, whatever its size; one of which nothing counts says nothing."""
    sizes = [1e-3, 1.0, 50.0][: len(ratios)]
    before = [np.full(10, s) for s in sizes] + [np.zeros(0)]
    after = [np.full(10, -s * r) for s, r in zip(sizes, ratios, strict=True)] + [np.zeros(0)]
    errors: dict[str, list[Array]] = {"before": before, "after": after}
    monkeypatch.setattr(module, "left_out_by_run", lambda problem, name: errors[name])
    asked: Any = _predicts_worse
    assert asked(None, "after", "before", most) == worse


@pytest.mark.parametrize(
    ("name", "unit", "kind", "words"),
    [
        ("zero", "N", "level_by_run", "the zero differs by run by 0.12 N (1 s.d.)"),
        (
            "drift",
            "N/s",
            "drift_by_run",
            "the zero drifts, by another 0.12 N/s (1 s.d.) in each run",
        ),
        ("gain", "1", "gain_by_run", "the gain differs by run by 12 % (1 s.d.)"),
        (
            "U_tr_m_s",
            "1",
            "oil_by_run",
            "the transition speed differs by run by 12 % (1 s.d.): the oil's warmth?",
        ),
        (
            "gamma",
            "1",
            "oil_by_run",
            "the viscous friction differs by run by 12 % (1 s.d.): the oil's warmth?",
        ),
    ],
)
def test_deviations_have_their_words(name: str, unit: str, kind: str, words: str) -> None:
    assert _words(name, 0.123, unit) == (kind, words)


# ---- what it must gain -------------------------------------------------------------------------


def gained(
    monkeypatch: pytest.MonkeyPatch, *, least: float = 0.0, worse: bool = False, there: bool = True
) -> Any:
    """A deviation that leaves a cost of 60 of 100, of which half counts, less a volume of 5 of
    what runs could deviate by, beside 2 of what they could before."""
    counted = [np.arange(N) < 300] * 3
    prepared = [record(0.02 * np.arange(N), name=name) for name in "abc"]
    samples = samples_of(prepared)
    monkeypatch.setattr(type(samples), "cost", lambda self, residuals, noise: 100.0)
    between: Any = SimpleNamespace(names=("zero",))
    campaign_problem: Any = SimpleNamespace(
        solution=lambda values, allowed, noise: SimpleNamespace(
            cost=60.0, samples=allowed, values=values, noise=noise
        )
    )
    near: Any = Near(samples_of(prepared, counted))

    def clearest(problem: Any, solution: Any, some: Any, chance: float) -> Any:
        assert (solution, chance) == (near, DEFAULT.deviation_chance)
        # The samples of the campaign, by what the solution counts.
        assert [int(c.sum()) for c in some.counted] == [300] * 3
        return (between, "finding") if there else None

    def search(problem: Any, allowed: Any, values: Any, noise: Any, evaluations: int) -> Any:
        assert (allowed.between, values, noise, evaluations) == (between, "v", WHITE, EVALUATIONS)
        return SimpleNamespace(values="there")

    def predicts_worse(problem: Any, after: Any, before: Any, most: float) -> bool:
        assert (after.values, before.values, most) == ("there", "v", DEFAULT.no_worse)
        assert before.samples.between is None
        return worse

    for name, part in {
        "_clearest": clearest,
        "search": search,
        "noise_at": lambda problem, allowed, values: f"noise {values}",
        "_share": lambda after, before: 0.5,
        "_volume": lambda some, solution: 2.0 if some.between is None else 5.0,
        "_predicts_worse": predicts_worse,
    }.items():
        monkeypatch.setattr(module, name, part)
    return deviation(campaign_problem, near, samples, DEFAULT, least)


@dataclass(frozen=True)
class Near:
    """A solution of which nothing else is asked."""

    samples: Any
    residuals: Any = ()
    noise: Any = WHITE
    values: Any = "v"


def test_a_deviation_gains_what_counts_less_its_volume(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of 40, less 3; the samples that come back are all of the campaign's."""
    found = gained(monkeypatch)
    assert found.gain == pytest.approx(17.0)
    assert found.finding == "finding"
    assert found.samples.between.names == ("zero",)
    assert [int(c.sum()) for c in found.samples.counted] == [N] * 3


@pytest.mark.parametrize(("least", "there"), [(16.9, True), (17.0, False), (17.1, False)])
def test_it_must_gain_more_than_is_asked(
    least: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert (gained(monkeypatch, least=least) is not None) == there


def test_a_deviation_that_predicts_worse_or_is_not_there_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert gained(monkeypatch, worse=True) is None
    assert gained(monkeypatch, there=False) is None
