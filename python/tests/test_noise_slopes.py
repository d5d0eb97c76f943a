"""Slopes of the noise's likelihood against differences, and what a second look makes of noise."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf import Parameter
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.second_look import second_look
from jbf.diagnosis.strength import Strength
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import Noise, _changes, innovation_cost
from jbf.records.findings.finding import Finding
from made_of import record, samples_of

Array = npt.NDArray[np.float64]
module = sys.modules["jbf.diagnosis.second_look"]
STEPS = [0.02, 0.05]


@pytest.mark.parametrize("unit", [1e-3, 1e3])
@pytest.mark.parametrize(("memory_s", "colour"), [(0.05, 0.1), (0.2, 0.5), (0.6, 0.9)])
def test_slopes_are_those_of_differences(unit: float, memory_s: float, colour: float) -> None:
    random = np.random.default_rng(1)
    runs = [unit * random.standard_normal(n).cumsum() for n in (200, 150)]
    masks = [random.random(len(r)) > 0.2 for r in runs]

    def noise(x: Array) -> Noise:
        return Noise(float(np.exp(x[0])), float(x[1]))

    def rows(x: Array) -> Array:
        return np.concatenate(
            [noise(x).innovations(r, s)[m] for r, s, m in zip(runs, STEPS, masks, strict=True)]
        )

    at, h = np.array([np.log(memory_s), colour]), 1e-5
    slope, curvature = _changes(noise(at), runs, STEPS, masks)
    cost = [
        [innovation_cost(noise(at + s * h * way), runs, STEPS, masks) for s in (1.0, -1.0)]
        for way in np.eye(2)
    ]
    assert slope == pytest.approx([(a - b) / (2.0 * h) for a, b in cost], rel=1e-4)
    # Gauss and Newton's curvature: of the innovations' own slopes.
    j = np.stack([(rows(at + h * w) - rows(at - h * w)) / (2.0 * h) for w in np.eye(2)], axis=1)
    e = rows(at)
    assert curvature == pytest.approx(2.0 * len(e) / float(e @ e) * (j.T @ j), rel=1e-4)


# ---- a second look -----------------------------------------------------------------------------

N = 50
SIZES, WEIGHTS = np.full(N, 0.5), np.full(N, 0.8)


def finding(kind: str) -> Finding:
    return Finding(kind, "friction_n", "a", 1.0, "1", "weighed", kind)


def looked(
    monkeypatch: pytest.MonkeyPatch,
    *,
    uneven: bool = True,
    heavy: bool = True,
    keeps: tuple[bool, bool] = (True, True),
    known: tuple[str, ...] = (),
    step_n: float = 0.0,
) -> tuple[Any, list[str]]:
    """A look at noise of these kinds; what was found, and what was asked for."""
    asked: list[str] = []
    prepared = [record(0.02 * np.arange(N), converter_step_n=step_n)]
    steps: Any = SimpleNamespace(kind="steps", size=step_n)
    prepared[0].examined = SimpleNamespace(findings=(steps,) if step_n else ())
    samples = samples_of(prepared)
    given: Any = prepared
    campaign = Campaign(Any, tuple(given), samples, None, tuple(finding(k) for k in known))  # type: ignore[arg-type]

    def sizes(*_: Any) -> Any:
        asked.append("sizes")
        return ([SIZES], [finding("noise_by_run")]) if uneven else ([np.ones(N)], [])

    def robust(solution: Any, before: list[Array], most: float) -> Any:
        asked.append("robust")
        assert before[0][0] == (0.5 if uneven and keeps[0] and "noise_by_run" not in known else 1.0)
        assert most == DEFAULT.heavy_tails
        return ([WEIGHTS], [finding("heavy_tails")]) if heavy else ([np.ones(N)], [])

    def kept(problem: Any, solution: Any, weighed: Any, most: float) -> bool:
        assert most == DEFAULT.no_worse
        return keeps[1] if weighed.weight[0][0] in (0.4, 0.8) else keeps[0]

    monkeypatch.setattr(module, "noise_sizes", sizes)
    monkeypatch.setattr(module, "robust_weights", robust)
    monkeypatch.setattr(module, "_keeps", kept)
    solution: Any = SimpleNamespace(residuals=[np.zeros(N)], rms_n=1.0)
    problem: Any = SimpleNamespace(campaign=campaign)
    return second_look(problem, solution, DEFAULT), asked


@pytest.mark.parametrize(
    ("given", "weight", "level", "kinds"),
    [
        ({}, 0.4, 0.5, ["noise_by_run", "heavy_tails"]),
        ({"heavy": False}, 0.5, 0.5, ["noise_by_run"]),
        ({"uneven": False}, 0.8, 1.0, ["heavy_tails"]),
        # What would give up samples that the model misses is not kept.
        ({"keeps": (False, True)}, 0.8, 1.0, ["heavy_tails"]),
        ({"keeps": (True, False)}, 0.5, 0.5, ["noise_by_run"]),
    ],
)
def test_noise_is_weighed_by_its_size_and_against_its_tails(
    given: dict[str, Any],
    weight: float,
    level: float,
    kinds: list[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    look, asked = looked(monkeypatch, **given)
    assert look.found
    assert look.campaign.samples.weight[0] == pytest.approx(np.full(N, weight))
    assert look.campaign.samples.level[0] == pytest.approx(np.full(N, level))
    assert [f.kind for f in look.campaign.more_findings] == kinds
    assert asked == ["sizes", "robust"]


@pytest.mark.parametrize(
    ("given", "asked"),
    [
        ({"uneven": False, "heavy": False}, ["sizes", "robust"]),
        ({"keeps": (False, False)}, ["sizes", "robust"]),
        # Weights are given once.
        ({"known": ("noise_with_force", "heavy_tails")}, []),
        ({"known": ("noise_by_run", "heavy_tails")}, []),
        # Rounding has no tails to speak of.
        ({"uneven": False, "step_n": DEFAULT.coarse_steps}, ["sizes"]),
        (
            {"uneven": False, "heavy": False, "step_n": 0.99 * DEFAULT.coarse_steps},
            ["sizes", "robust"],
        ),
    ],
)
def test_where_nothing_is_found_the_campaign_stays(
    given: dict[str, Any], asked: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    look, was_asked = looked(monkeypatch, **given)
    assert not look.found
    assert look.campaign.samples.level is None
    assert was_asked == asked


# ---- strengths ---------------------------------------------------------------------------------


def test_all_sizes_of_an_effect_grow_from_their_nulls() -> None:
    pages = {
        "F_c_n": Parameter("F_c_n", lower=0.0, upper=1e4, starts=(4.0,)),
        "one.F_d_n": Parameter("F_d_n", lower=0.0, upper=10.0, null=0.0, starts=(0.5,)),
        "one.factor": Parameter("factor", lower=0.1, upper=50.0, null=1.0, starts=(2.0,)),
        "one.sigma": Parameter("sigma", lower=1.0, upper=1e6, null=np.inf, starts=(1e3,)),
    }
    problem: Any = SimpleNamespace(parameters=pages)
    usual = np.array([4.0, 0.5, 3.0, 1e3])
    one = Strength("one", problem, usual, 1, pages["one.F_d_n"], (1, 2, 3))
    assert one.values(1.0).tolist() == usual.tolist()
    # Twice as far from nothing, from one, and from infinity.
    assert one.values(2.0).tolist() == [4.0, 1.0, 5.0, 500.0]
    assert one.values(0.5).tolist() == [4.0, 0.25, 2.0, 2e3]
    # Within bounds.
    assert one.values(100.0).tolist() == [4.0, 10.0, 50.0, 10.0]
    assert one.values(1e-9).tolist() == pytest.approx([4.0, 5e-10, 1.0, 1e6])
    assert usual.tolist() == [4.0, 0.5, 3.0, 1e3]
