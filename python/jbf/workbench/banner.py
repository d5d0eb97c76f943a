"""Banner of the page: the state of a model in one sentence and one number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

AT_NOISE = 1.15
"""Ratio of the error to the noise up to which a model is shown as complete.

The estimate of the noise floor is uncertain by a few percent. The ratio decides only how the banner
of a manual fit looks; the verdict of a diagnosis does not depend on it.
"""
# `missing` is good: effects were found and are in the model.
_KINDS = {"adequate": "good", "missing": "good", "ambiguous": "warn", "unexplained": "bad"}


def banner_of(node: Mapping[str, Any]) -> dict[str, Any]:
    """Number, kind and sentence of a model for the banner.

    The number is the held-out error, or the error of the fit if that is unknown (`error` is
    `held-out` or `fit`), as a multiple of the noise. The kind is `good`, `warn` or `bad`.
    """
    name = node.get("name") or " + ".join([node["law"], *node["effects"]])
    held_out = node.get("held_out_rms")
    error = node["rms"] if held_out is None else held_out
    ratio = error / node["noise_rms"] if node["noise_rms"] > 0.0 else None
    number = {"times_noise": ratio, "error": "fit" if held_out is None else "held-out"}
    return {**number, **_judged(node, name, ratio)}


def _judged(node: Mapping[str, Any], name: str, ratio: float | None) -> dict[str, str]:
    """Kind and sentence of a model, given the ratio of its error to the noise."""
    diagnosis, trials = node.get("diagnosis"), node.get("trials") or ()
    if diagnosis is not None:
        return {"kind": _KINDS[diagnosis["verdict"]], "words": diagnosis["headline"]}
    if ratio is None:
        return {"kind": "warn", "words": "The noise of the runs is unknown."}
    if ratio > AT_NOISE:
        words = f"Something is missing in {name}."
        return {"kind": "bad" if ratio > 2.0 else "warn", "words": words}
    better = next((t for t in trials if t["outcome"] == "added"), None)
    if better is not None:
        words = f"Nearly complete; {better['effect']} still reduces the held-out error."
        return {"kind": "warn", "words": words}
    if not trials:
        words = f"The error of {name} is at the noise; further effects have not been tested."
        return {"kind": "warn", "words": words}
    if node.get("held_out_rms") is None:
        words = f"The error of {name} is at the noise; its held-out error is unknown."
        return {"kind": "warn", "words": words}
    words = f"Nothing is missing: {name} explains the runs down to the noise."
    return {"kind": "good", "words": words}
