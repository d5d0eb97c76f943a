"""Banner of a model: its number, kind and sentence."""

from typing import Any

import pytest

pytest.importorskip("starlette", reason="the workbench's server is an extra")

from jbf.workbench.banner import banner_of

NEGLIGIBLE = {"effect": "inertia", "outcome": "no gain"}


def node(**content: Any) -> dict[str, Any]:
    """A model whose errors are at the noise, and whose candidates have no gain."""
    base = {"law": "journal", "effects": [], "rms": 1.0, "noise_rms": 1.0, "held_out_rms": 1.1}
    return {**base, "trials": [NEGLIGIBLE], **content}


def test_model_at_the_noise_is_complete_if_its_candidates_were_tested() -> None:
    assert banner_of(node())["kind"] == "good"


@pytest.mark.parametrize("content", [{"trials": []}, {"trials": None}, {"held_out_rms": None}])
def test_model_without_tested_candidates_or_held_out_error_is_not_complete(
    content: dict[str, Any],
) -> None:
    assert banner_of(node(**content))["kind"] == "warn"
    assert banner_of(node(**content))["words"] != banner_of(node())["words"]


def test_banner_reports_which_error_its_number_is() -> None:
    held_out, of_fit = banner_of(node()), banner_of(node(held_out_rms=None))
    assert (held_out["times_noise"], held_out["error"]) == (1.1, "held-out")
    assert (of_fit["times_noise"], of_fit["error"]) == (1.0, "fit")
