"""Which weights a second look gives: what is asked, what is kept, and what was given before."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.second_look import EVALUATIONS, _keeps, second_look
from made_of import record, samples_of

module = sys.modules["jbf.diagnosis.second_look"]
SIZES, ROBUST, ONES = [0.5, 0.25], [1.0, 0.75], [1.0, 1.0]
POLICY = replace(DEFAULT, coarse_steps=2.0)


@dataclass(frozen=True)
class Weighed:
    """Samples, and the weights that they were given."""

    weights: Any = None
    between: str = "between"

    def weighed(self, sizes: Any, robust: Any, between: Any) -> Weighed:
        return Weighed([[x.tolist() for x in part] for part in (sizes, robust)], between)


@dataclass(frozen=True)
class Runs:
    """A campaign of one run of two samples."""

    more_findings: Any = ()
    step_n: float = 0.0
    samples: Weighed = field(default_factory=Weighed)

    def with_findings(self, found: list[str]) -> Runs:
        return replace(self, more_findings=(*self.more_findings, *found))


def looked(
    monkeypatch: pytest.MonkeyPatch,
    *,
    uneven: bool = False,
    heavy: bool = False,
    kept: tuple[bool, ...] = (True, True),
    known: tuple[str, ...] = (),
    step_n: float = 0.0,
) -> tuple[Any, list[Any]]:
    """A second look at a residual of 2 N, and what was asked for it."""
    asked: list[Any] = []

    def sizes(problem: Any, solution: Any, policy: Any) -> Any:
        asked.append("sizes")
        return [np.array(SIZES)], ["uneven"] * uneven

    def robust(solution: Any, sizes: Any, heavy_tails: float) -> Any:
        asked.append(("robust", [x.tolist() for x in sizes], heavy_tails))
        return [np.array(ROBUST)], ["heavy"] * heavy

    def keeps(problem: Any, solution: Any, samples: Any, most: float) -> bool:
        assert samples.between is None
        asked.append(("keeps", samples.weights, most))
        return kept[sum(1 for a in asked if a[0] == "keeps") - 1]

    monkeypatch.setattr(module, "noise_sizes", sizes)
    monkeypatch.setattr(module, "robust_weights", robust)
    monkeypatch.setattr(module, "_keeps", keeps)
    before: Any = Runs(tuple(SimpleNamespace(kind=kind) for kind in known), step_n)
    problem: Any = SimpleNamespace(campaign=before)
    solution: Any = SimpleNamespace(residuals=[np.zeros(2)], rms_n=2.0)
    found = second_look(problem, solution, POLICY)
    if not found.found:
        assert found.campaign is before
    return found, asked


def test_even_noise_has_no_weights(monkeypatch: pytest.MonkeyPatch) -> None:
    found, asked = looked(monkeypatch)
    assert not found.found
    assert asked == ["sizes", ("robust", [ONES], POLICY.heavy_tails)]


def test_weights_by_size_and_by_tails_are_given_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tails are those of what was weighed by its size; runs differ as they are known to."""
    found, asked = looked(monkeypatch, uneven=True, heavy=True)
    assert found.found
    assert found.campaign.samples == Weighed([[SIZES], [ROBUST]])
    assert found.campaign.more_findings == ("uneven", "heavy")
    assert asked == [
        "sizes",
        ("keeps", [[SIZES], [ONES]], POLICY.no_worse),
        ("robust", [SIZES], POLICY.heavy_tails),
        ("keeps", [[SIZES], [ROBUST]], POLICY.no_worse),
    ]


@pytest.mark.parametrize(
    ("kept", "weights", "findings"),
    [
        ((True, False), [[SIZES], [ONES]], ("uneven",)),
        ((False, True), [[ONES], [ROBUST]], ("heavy",)),
    ],
)
def test_weights_that_predict_worse_are_not_given(
    kept: tuple[bool, bool], weights: Any, findings: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, _ = looked(monkeypatch, uneven=True, heavy=True, kept=kept)
    assert (found.campaign.samples.weights, found.campaign.more_findings) == (weights, findings)
    assert not looked(monkeypatch, uneven=True, heavy=True, kept=(False, False))[0].found


@pytest.mark.parametrize(
    ("kind", "sizes", "tails"),
    [
        ("noise_with_force", False, True),
        ("noise_by_run", False, True),
        ("heavy_tails", True, False),
        ("steps", True, True),
    ],
)
def test_weights_are_given_once(
    kind: str, sizes: bool, tails: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, asked = looked(monkeypatch, known=(kind,))
    assert ("sizes" in asked) == sizes
    assert (("robust", [ONES], POLICY.heavy_tails) in asked) == tails


@pytest.mark.parametrize(("step_n", "tails"), [(3.99, True), (4.0, False), (4.01, False)])
def test_steps_of_twice_the_residual_are_its_tails(
    step_n: float, tails: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, asked = looked(monkeypatch, step_n=step_n)
    assert (len(asked) == 2) == tails


@pytest.mark.parametrize(("after", "kept"), [(2.0, True), (2.5, True), (2.51, False)])
def test_weights_are_kept_where_a_fit_with_them_predicts_as_well(
    after: float, kept: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A few steps on, at the samples that counted and all alike; a quarter more may be left."""
    n = 100
    prepared = [record(0.02 * np.arange(n))]
    half = samples_of(prepared, [np.arange(n) < 50])
    asked: list[Any] = []

    def search(problem: Any, samples: Any, values: Any, noise: Any, evaluations: int) -> Any:
        asked.append((int(samples.counted[0].sum()), values, noise, evaluations))
        return SimpleNamespace(values="there")

    monkeypatch.setattr(module, "search", search)
    wild = np.where(np.arange(n) < 50, 1.0, 1e3)
    left = {"there": [after * wild]}
    problem: Any = SimpleNamespace(residuals=left.__getitem__)
    solution: Any = SimpleNamespace(
        samples=half, residuals=[2.0 * wild], values="here", noise="noise"
    )
    assert _keeps(problem, solution, samples_of(prepared), 1.25) == kept
    assert EVALUATIONS == 8
    assert asked == [(50, "here", "noise", 8)]
