"""Control-loop runs and a compensator's robustness as plain text."""

from __future__ import annotations

from collections.abc import Sequence

from jbf.control.constants import FALLBACK, FROZEN, JUMPED, NOT_FINITE, SATURATED
from jbf.control.robustness import HARM, HELP, Outcome
from jbf.control.run import Result
from jbf.control.task import RECORDED
from jbf.reporting.paragraphs import columns
from jbf.reporting.words import number

_FLAGS = {
    SATURATED: "saturated",
    FROZEN: "encoder frozen",
    JUMPED: "encoder jumped",
    NOT_FINITE: "reference not finite",
    FALLBACK: "control law only",
}


def status_words(result: Result) -> str:
    """Describe the status flags of a control-loop run, each with the share of samples with it."""
    flags = []
    for flag, word in _FLAGS.items():
        share = float(((result.status & flag) > 0).mean())
        if share > 0.0:
            flags.append(f"{word} {100.0 * share:.2g} %")
    return ", ".join(flags) or "ok"


def runs_text(results: Sequence[Result]) -> str:
    """Tabulate RMS and peak error of several compensation schemes on one task."""
    task = results[0].task
    head = f"{task.control} control, {task.wave} {task.low:.3g} to {task.high:.3g} {task.unit}"
    if task.wave != RECORDED:
        head += f" at {task.frequency_rad_s:g} rad/s"
    head += f", {task.seconds:g} s"
    if task.skip_s:
        head += f", without the first {task.skip_s:g} s"
    rows = [("scheme", f"RMS, {task.unit}", "peak", "true RMS", "status")]
    rows += [
        (r.scheme, number(r.rms), number(r.peak), number(r.true_rms), status_words(r))
        for r in results
    ]
    return "\n".join([head, "", *columns(rows, "<>>><")])


def robustness_text(outcomes: Sequence[Outcome]) -> str:
    """Tabulate the errors with compensation relative to those without it, one line per case."""
    names = list(outcomes[0].ratios)
    abbreviated = [
        "".join(word[0] if i == 0 else f" {word}" for i, word in enumerate(n.split()))
        for n in names
    ]
    rows: list[tuple[str, ...]] = [("plant", *abbreviated, "worst", "")]
    rows += [
        (o.name, *(f"{o.ratios[n]:.3f}" for n in names), f"{o.worst:.3f}", o.verdict)
        for o in outcomes
    ]
    counted = {
        word: sum(o.verdict == word for o in outcomes) for word in ("help", "neutral", "harm")
    }
    summary = ", ".join(f"{word} {count}" for word, count in counted.items())
    return "\n".join(
        [
            "Ratio of the true RMS errors with and without compensation (by the base law).",
            f"help: all ratios below {HELP:g}; harm: one above {HARM:g}; p position, v velocity.",
            "",
            *columns(rows, "<" + ">" * (len(names) + 1) + "<"),
            "",
            summary,
        ]
    )
