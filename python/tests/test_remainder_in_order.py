"""What remains, put together of what each test tells: which of it is said, and in which order."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import pytest
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.remainder import find_remainder

module = sys.modules["jbf.diagnosis.remainder"]
TESTS = ("tones", "ripples", "replicates", "bursts", "disagreement", "stroke_levels")


def told(
    monkeypatch: pytest.MonkeyPatch, *, rms_n: float = 2.0, steps_n: float = 0.0, **shares: float
) -> list[str]:
    """The names of what remains of a residual, where these tests tell these shares."""

    def found(name: str) -> Any:
        return lambda *asked: [Remainder("time", name, shares[name])] if name in shares else []

    for name in TESTS:
        monkeypatch.setattr(module, f"find_{name}", found(name))
    monkeypatch.setattr(module, "find_patterns", found("patterns"))
    samples = SimpleNamespace(
        innovations=lambda residuals, noise: "white",
        plain_innovations=lambda residuals, noise: "plain",
        without_deviations=lambda residuals, noise: "left",
    )
    solution: Any = SimpleNamespace(samples=samples, residuals=None, noise=None, rms_n=rms_n)

    def steps(asked_n: float) -> float:
        assert asked_n == rms_n
        return steps_n

    problem: Any = SimpleNamespace(campaign=SimpleNamespace(prepared=(), steps_rms_n=steps))
    return [r.where for r in find_remainder(problem, solution, DEFAULT)]


def test_what_each_test_tells_comes_with_the_largest_share_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shares = {name: 0.1 * (i + 1) for i, name in enumerate(("patterns", *TESTS))}
    assert told(monkeypatch, **shares) == [*TESTS[::-1], "patterns"]
    assert told(monkeypatch) == []
    # Of two that are as large the one that is asked first.
    assert told(monkeypatch, tones=0.3, bursts=0.3) == ["tones", "bursts"]


@pytest.mark.parametrize(
    ("share", "rms_n", "said"),
    [(0.25, 2.0, False), (0.26, 2.0, True), (0.25, 2.1, True), (0.01, 4.0, False)],
)
def test_what_is_within_a_converters_steps_is_not_said(
    share: float, rms_n: float, said: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A quarter of the mean square of 2 N is 1 N."""
    left = told(monkeypatch, rms_n=rms_n, steps_n=1.0, tones=share, bursts=0.81)
    assert left == ["bursts"] + ["tones"] * said
