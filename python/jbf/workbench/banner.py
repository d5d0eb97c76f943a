"""Banner of the page: the state of a model in one sentence and one number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jbf.reporting.words import listed

AT_NOISE = 1.15
"""Ratio of the error to the noise up to which a model is shown as complete.

The estimate of the noise floor is uncertain by a few percent. The ratio decides only how the banner
of a manual fit looks; the verdict of a diagnosis does not depend on it.
"""
MOST_SIZES = 3
"""Maximum number of effects whose size the banner states."""
# `missing` is good: effects were found and are in the model.
_KINDS = {"adequate": "good", "missing": "good", "ambiguous": "warn", "unexplained": "bad"}


def banner_of(node: Mapping[str, Any], used: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Number, kind and sentences of a model for the banner.

    The number is the held-out error, or the error of the fit if that is unknown (`error` is
    `held-out` or `fit`), as a multiple of the noise. The kind is `good`, `warn` or `bad`. The
    sentences are `words` and, for the size of each named effect, `sizes`.

    Parameters
    ----------
    node
        Data of the model.
    used
        Runs and trims that a fit would use now (`Bench.used`). A model of other runs or trims is
        `stale`: its verdict is that of its own runs, and it is never `good`.
    """
    name = node.get("name") or " + ".join([node["law"], *node["effects"]])
    held_out = node.get("held_out_rms")
    error = node["rms"] if held_out is None else held_out
    ratio = error / node["noise_rms"] if node["noise_rms"] > 0.0 else None
    judged = _judged(node, name, ratio)
    stale = used is not None and "used" in node and node["used"] != used
    if stale:
        words = f"The selected runs or their trims have changed since {name} was fitted."
        judged = {"kind": "warn", "words": words}
    sizes = node.get("sizes", {})
    named = [e for e in (node.get("diagnosis") or node)["effects"] if e in sizes]
    return {
        "times_noise": ratio,
        "error": "fit" if held_out is None else "held-out",
        "stale": stale,
        "sizes": [] if stale else [sizes[e] for e in named[:MOST_SIZES]],
        **judged,
    }


def _judged(node: Mapping[str, Any], name: str, ratio: float | None) -> dict[str, str]:
    """Kind and sentence of a model, given the ratio of its error to the noise."""
    diagnosis, trials = node.get("diagnosis"), node.get("trials") or ()
    if diagnosis is not None:
        return {"kind": _KINDS[diagnosis["verdict"]], "words": _of_diagnosis(diagnosis)}
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


def _of_diagnosis(diagnosis: Mapping[str, Any]) -> str:
    """Verdict on the model of a diagnosis, which contains the effects that the diagnosis added."""
    effects, headline = diagnosis["effects"], str(diagnosis["headline"])
    if not effects:
        return headline
    included = f"Found and included: {listed(effects)}."
    if diagnosis["verdict"] == "missing":
        return f"{included} Nothing else is missing."
    if diagnosis["verdict"] == "ambiguous":
        alternatives = diagnosis["alternatives"].items()
        ties = [[e, *others] for e, others in alternatives if others and e in effects]
        words = "; ".join(listed(tie) for tie in ties)
        return f"{included} These runs cannot distinguish {words}."
    return f"{included} {headline.removeprefix(f'Missing: {listed(effects)}. ')}"
