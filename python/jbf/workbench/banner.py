"""Banner of the page: the state of a model in one sentence and one number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

AT_NOISE = 1.15
"""Ratio of the error to the noise up to which a model is shown as complete.

The estimate of the noise floor is uncertain by a few percent. The ratio decides only how the banner
of a manual fit looks; the verdict of a diagnosis does not depend on it.
"""
_KINDS = {"adequate": "good", "missing": "good", "ambiguous": "warn", "unexplained": "bad"}


def banner_of(node: Mapping[str, Any]) -> dict[str, Any]:
    """Number, kind and sentence of a model for the banner.

    The number is the held-out error, or else the error of the fit, as a multiple of the noise. The
    kind is `good`, `warn` or `bad`.
    """
    name = node.get("name") or " + ".join([node["law"], *node["effects"]])
    error = node.get("held_out_rms") or node["rms"]
    ratio = error / node["noise_rms"] if node["noise_rms"] > 0.0 else None
    diagnosis = node.get("diagnosis")
    if diagnosis is not None:
        kind = _KINDS[diagnosis["verdict"]]
        return {"times_noise": ratio, "kind": kind, "words": diagnosis["headline"]}
    if ratio is None:
        return {"times_noise": None, "kind": "warn", "words": "The noise of the runs is unknown."}
    if ratio > AT_NOISE:
        words = f"Something is missing in {name}."
        return {"times_noise": ratio, "kind": "bad" if ratio > 2.0 else "warn", "words": words}
    better = next((t for t in node.get("trials") or () if t["outcome"] == "added"), None)
    if better is not None:
        words = f"Nearly complete; {better['effect']} still reduces the held-out error."
        return {"times_noise": ratio, "kind": "warn", "words": words}
    words = f"Nothing is missing: {name} explains the runs down to the noise."
    return {"times_noise": ratio, "kind": "good", "words": words}
