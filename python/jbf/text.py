"""Reports as plain text, 80 to 100 columns: a fit, a comparison, a diagnosis, the catalogue."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from jbf.catalogue import Effect, Parameter, built_in
from jbf.tables import (
    LEAST_CORRELATION,
    correlation_pairs,
    ledger_rows,
    parameter_rows,
    run_rows,
    trial_rows,
)
from jbf.words import BARE, comparison_sentence, law_words, number, times, verdict_sentence

if TYPE_CHECKING:
    from jbf.comparison import Comparison, Failure
    from jbf.diagnosis.result import Diagnosis, Remainder
    from jbf.fitting import Fit
    from jbf.model import Model
    from jbf.model_file import ParameterValue
    from jbf.noise import Noise

WIDTH = 92
MOST_CORRELATIONS = 10
_TOGETHER = re.compile(r"v (<|>|<=|>=|=) \S+( m/s)?|\d (N|m|s|deg)\b")
"""What a line break would tear: `v < 0`, `0.25 N`."""


def columns(rows: Sequence[Sequence[str]], align: str, indent: int = 2) -> list[str]:
    """Rows of cells as aligned lines; `align` holds `<` or `>` for each column."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(align))]
    return [
        (
            " " * indent
            + "  ".join(
                f"{cell:{side}{width}}"
                for cell, side, width in zip(row, align, widths, strict=True)
            )
        ).rstrip()
        for row in rows
    ]


def _hanging(lead: str, text: str, indent: int = 2) -> list[str]:
    """A paragraph whose further lines start below the text, not below its lead."""
    head = " " * indent + lead
    kept = _TOGETHER.sub(lambda found: found[0].replace(" ", "\0"), text)
    wrapped = textwrap.wrap(kept, WIDTH, initial_indent=head, subsequent_indent=" " * len(head))
    return [line.replace("\0", " ") for line in wrapped] or [head.rstrip()]


# ---- parameters and fits --------------------------------------------------------------------


def _parameter_lines(model: Model, parameters: Mapping[str, ParameterValue]) -> list[str]:
    rows = [
        (
            name,
            value,
            f"+/- {error}" if error else "",
            f"({share})" if share else "",
            unit,
            f"({note})" if note else "",
        )
        for name, value, error, share, unit, note in parameter_rows(model, parameters)
    ]
    return columns(rows, "<>>><<", 4)


def noise_words(noise: Noise) -> str:
    """`white`, or how much of the noise is coloured and for how long."""
    if noise.colour <= 0.0:
        return "white"
    return f"coloured, share {number(noise.colour, 2)}, memory {number(noise.memory_s, 2)} s"


def fit_report(fit: Fit) -> str:
    """Statistics, parameters with errors, and the strongest correlations."""
    model = fit.model
    facts = [
        ("law", law_words(model)),
        ("effects", ", ".join(model.effects) or "none"),
        ("runs", str(len(fit.residuals))),
        ("samples", str(fit.samples)),
        ("RMS of the residual", f"{number(fit.rms_n)} N"),
        ("noise in the residual", noise_words(fit.noise)),
        ("search", "converged" if fit.converged else f"not converged: {fit.message}"),
    ]
    lines = ["[[Fit]]", *columns([(k, f"= {v}") for k, v in facts], "<<", 4)]
    lines += ["[[Parameters]]", *_parameter_lines(model, fit.parameters)]
    if fit.doubtful:
        names = ", ".join(fit.doubtful)
        lines += _hanging(
            "note: ",
            f"of {names} the likelihood is no parabola within these errors, so they may be far "
            "too small. `jbf fit --bootstrap 40` (jbf.bootstrap) finds theirs.",
            4,
        )
    pairs = correlation_pairs(fit)
    if pairs:
        lines.append(f"[[Correlations]] (those above {LEAST_CORRELATION})")
        shown = [(f"C({a}, {b})", f"= {c:+.3f}") for a, b, c in pairs[:MOST_CORRELATIONS]]
        lines += columns(shown, "<<", 4)
        if len(pairs) > MOST_CORRELATIONS:
            lines.append(f"    and {len(pairs) - MOST_CORRELATIONS} weaker ones")
    return "\n".join(lines)


# ---- a comparison ---------------------------------------------------------------------------


def _where(patterns: Iterable[Failure | Remainder]) -> list[str]:
    """One hanging paragraph for each axis: share of the mean square, axis, words."""
    patterns = list(patterns)
    widest = max((len(p.axis) for p in patterns), default=0)
    lines = []
    for p in patterns:
        lines += _hanging(f"{p.axis:<{widest}}  {100 * p.share:3.0f} %  ", p.where, 4)
    return lines


def _run_lines(comparison: Comparison) -> list[str]:
    rows = [("run", "samples", "RMS (N)", "RMS / noise")]
    return columns([*rows, *run_rows(comparison)], "<>>>", 4)


def comparison_report(comparison: Comparison) -> str:
    """How far, where it fails, and each run."""
    lines = [comparison_sentence(comparison)]
    if comparison.failures:
        lines += ["", "Where it fails (share of the mean square)", *_where(comparison.failures)]
    else:
        lines[0] += "; no pattern along any axis"
    return "\n".join([*lines, "", "Runs", *_run_lines(comparison)])


# ---- a diagnosis ----------------------------------------------------------------------------


def _trial_lines(diagnosis: Diagnosis) -> list[str]:
    lines: list[str] = []
    for step in diagnosis.steps:
        if not step.trials:
            continue
        lines += ["", f"Candidates tried beside the {' + '.join([BARE, *step.effects])}"]
        rows = trial_rows(diagnosis, step)
        head, *table = columns(
            [("effect", "RMS (N)", "evidence", "outcome"), *(row[:4] for row in rows)], "<>><", 4
        )
        lead = max(map(len, [head, *table])) + 2
        lines.append(f"{head:<{lead}}why")
        for line, row in zip(table, rows, strict=True):
            lines += _hanging(f"{line:<{lead}}", row[4], 0)
    if diagnosis.not_tried:
        lines += ["", "Not tried: these runs cannot show"]
        for name, reason in diagnosis.not_tried.items():
            lines += _hanging(f"    {name}: ", reason, 0)
    if diagnosis.unseen:
        lines += ["", "Could be there at a usual strength and hide in these runs"]
        lines += _hanging("    ", ", ".join(diagnosis.unseen), 0)
    return lines


def diagnosis_report(diagnosis: Diagnosis) -> str:
    """The story on a page: verdict, measurement, miss, candidates, error falling, parameters."""
    campaign, bare = diagnosis.before.campaign, diagnosis.steps[0]
    model = diagnosis.model
    duration = sum(p.run.duration_s for p in campaign.prepared)
    lines = [f"Verdict: {diagnosis.verdict}", *_hanging("", verdict_sentence(diagnosis))]
    if diagnosis.next_experiment:
        lines += _hanging("Next experiment: ", diagnosis.next_experiment)
    lines += [
        "",
        "Measurement",
        f"    {len(campaign.prepared)} runs of {duration:.0f} s in all, {campaign.samples} samples "
        f"where the sign of the motion is known",
        f"    noise floor {number(bare.noise_n)} N, estimated from the records alone",
        "",
        f"The {BARE} ({law_words(model, ', ')})",
        f"    misses by {number(bare.rms_n)} N RMS, {times(bare.rms_n, bare.noise_n)} the noise"
        + ("; where it fails (share of the mean square):" if diagnosis.failures else ""),
    ]
    lines += _where(diagnosis.failures) or ["    and shows no pattern along any axis"]
    lines += _trial_lines(diagnosis)
    lines += ["", "The error falling (N)"]
    head = ("step", "fit", "held out", "noise", "held out / noise")
    lines += columns([head, *ledger_rows(diagnosis)], "<>>>>", 4)
    lines += ["", "What remains"]
    lines += _where(diagnosis.unexplained) or ["    nothing that stands above the noise"]
    lines += ["", "Parameters of the final model"]
    lines += _parameter_lines(model, diagnosis.fit.parameters)
    return "\n".join(lines)


# ---- the catalogue --------------------------------------------------------------------------


NEEDS = {
    "angle": "the column angle_rad in every run",
    "path": "the column angle_rad, or position_m on a linear axis, in every run",
    "loads": "runs under several loads",
}


def refused_words(effect: Effect) -> str:
    """The laws that an effect does not go with, and why."""
    reasons = dict.fromkeys(effect.refused.values())
    return "; ".join(
        f"{', '.join(law for law, r in effect.refused.items() if r == reason)} ({reason})"
        for reason in reasons
    )


def effects_page(pages: Iterable[Effect], law: str | None = None) -> str:
    """One line an effect, in the order of the signal chain, headed by stage.

    With a law, those that do not go with it follow, each with the reason.
    """
    pages = list(pages)
    if law is not None:
        refused = {e.name: e.refused[law] for e in pages if law in e.refused}
        there = effects_page(e for e in pages if e.name not in refused)
        widest = max(map(len, refused), default=0)
        reasons = [x for n, r in refused.items() for x in _hanging(f"{n:<{widest}}  ", r)]
        head = ["", f"[not with {law}: the law ...]"] if reasons else []
        return "\n".join([there, *head, *reasons])
    widest = max((len(e.name) for e in pages), default=0)
    lines: list[str] = []
    stage = None
    for effect in pages:
        own = "" if effect.name in built_in() else "your own, "
        if own + effect.stage != stage:
            stage = own + effect.stage
            lines += ([""] if lines else []) + [f"[{stage}]"]
        lines += _hanging(f"{effect.name:<{widest}}  ", effect.summary)
    return "\n".join(lines)


def effect_page(effect: Effect) -> str:
    """Everything the catalogue holds of one effect."""
    lines = [f"{effect.name}: {effect.summary}", ""]
    facts = [
        ("stage", effect.stage),
        ("equation", effect.equation),
        ("source", effect.source),
        ("limits", effect.limits),
    ]
    for need, words in NEEDS.items():
        if need in effect.needs:
            facts.append(("needs", words))
    if effect.columns:
        facts.append(("columns", ", ".join(effect.columns)))
    if effect.refused:
        facts.append(("not with", refused_words(effect)))
    for name, words in facts:
        lines += _hanging(f"{name:<10}", words)
    head = ("parameter", "unit", "from", "to", "vanishes at", "meaning")
    rows = columns([head, *map(_parameter_row, effect.parameters)], "<<>>><")
    return "\n".join([*lines, "", *rows])


def _parameter_row(p: Parameter) -> tuple[str, str, str, str, str, str]:
    null = "" if p.null is None else f"{p.null:g}"
    return p.name, p.unit, f"{p.lower:g}", f"{p.upper:g}", null, p.meaning
