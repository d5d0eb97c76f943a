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


DIAGNOSES: list[dict[str, Any]] = [
    {"verdict": "missing", "headline": "Missing: inertia."},
    {"verdict": "ambiguous", "headline": "", "alternatives": {"inertia": ["cogging"]}},
    {"verdict": "unexplained", "headline": "Missing: inertia. The residual has structure."},
]


@pytest.mark.parametrize("diagnosis", DIAGNOSES, ids=[str(d["verdict"]) for d in DIAGNOSES])
def test_effects_that_a_diagnosis_added_are_not_stated_as_missing(
    diagnosis: dict[str, Any],
) -> None:
    content = {"diagnosis": {"effects": ["inertia"], **diagnosis}, "effects": ["inertia"]}
    words = banner_of(node(**content))["words"]
    assert "inertia" in words
    assert "Missing: inertia" not in words


def test_model_of_other_runs_or_trims_has_no_good_verdict() -> None:
    fitted_to = {"run_1": None, "run_2": [0.0, 3.0]}
    assert banner_of(node(used=fitted_to), dict(fitted_to))["kind"] == "good"
    for used in ({"run_1": None}, {"run_1": None, "run_2": [0.0, 2.0]}):
        banner = banner_of(node(used=fitted_to), used)
        assert (banner["kind"], banner["stale"]) == ("warn", True)


def test_banner_states_the_size_of_each_named_effect() -> None:
    sizes = {"inertia": "inertia contributes 3.0 N RMS.", "cogging": "cogging contributes 1 N RMS."}
    content = {"effects": ["inertia", "cogging"], "sizes": sizes}
    assert banner_of(node(**content))["sizes"] == list(sizes.values())
    diagnosis = {"verdict": "missing", "headline": "", "effects": ["cogging"]}
    assert banner_of(node(**content, diagnosis=diagnosis))["sizes"] == [sizes["cogging"]]
