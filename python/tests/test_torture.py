"""A few of the absurd campaigns of `benches/torture`: those that failed once, and are quick."""

from __future__ import annotations

import sys
from pathlib import Path
from runpy import run_path
from typing import Any

import numpy as np
import pytest
from jbf.estimation.likelihood import unexplained

TORTURE = Path(__file__).resolve().parents[2] / "benches" / "torture"

FAILED_ONCE = {
    76: "a film that answers at 1e5 1/s had no end in 120 s",
    700059: "an overflow in a search's quadratic",
    700074: "the same, of a film that has no noise",
    800020: "a force late by more than its run divided by no sample",
    910015: "a law that leaves nothing divided by a noise of zero",
    920034: "derivatives without bound in a run to be proposed",
    920025: "the same, of a run to be proposed",
    940246: "squares of a change far above no noise overflowed",
    940439: "a run of which no sample counts had an RMS of NaN",
    940508: "a direction far above no noise had no long-run variance",
}


@pytest.fixture(scope="module")
def torture() -> dict[str, Any]:
    sys.path.insert(0, str(TORTURE))
    try:
        return run_path(str(TORTURE / "__main__.py"), run_name="torture")
    finally:
        sys.path.remove(str(TORTURE))


@pytest.mark.parametrize("seed", FAILED_ONCE)
def test_an_absurd_campaign_ends_in_a_sane_answer(seed: int, torture: dict[str, Any]) -> None:
    row = torture["tried"](seed, 120.0)
    assert row["said"]
    assert row["wrong"] == []


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
def test_what_a_design_does_not_explain_has_no_scale(scale: float) -> None:
    """Of a design far above no noise at all, whose squares overflow (seed 800001)."""
    random = np.random.default_rng(4)
    design, target = random.normal(size=(50, 3)), random.normal(size=50)
    left = unexplained(design * [1.0, scale, 1.0], target)
    slopes, *_ = np.linalg.lstsq(design, target, rcond=None)
    assert left == pytest.approx(target - design @ slopes, abs=1e-12)
