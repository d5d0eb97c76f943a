"""Reports as plain text, 80 to 100 columns: a fit, a comparison, a diagnosis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from jbf.comparison.comparison import Comparison, Failure
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.result import Diagnosis
from jbf.estimation.fit import Fit
from jbf.estimation.noise import Noise
from jbf.models.model import Model
from jbf.models.parameter_value import ParameterValue
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.tables import (
    LEAST_CORRELATION,
    correlation_pairs,
    ledger_rows,
    parameter_rows,
    run_rows,
    trial_rows,
)
from jbf.reporting.words import (
    BARE,
    comparison_sentence,
    law_words,
    number,
    times,
    verdict_sentence,
)

MOST_CORRELATIONS = 10


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
        lines += hanging(
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


def _where(patterns: Iterable[Failure | Remainder]) -> list[str]:
    """One hanging paragraph for each axis: share of the mean square, axis, words."""
    patterns = list(patterns)
    widest = max((len(p.axis) for p in patterns), default=0)
    lines = []
    for p in patterns:
        lines += hanging(f"{p.axis:<{widest}}  {100 * p.share:3.0f} %  ", p.where, 4)
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
            lines += hanging(f"{line:<{lead}}", row[4], 0)
    if diagnosis.not_tried:
        lines += ["", "Not tried: these runs cannot show"]
        for name, reason in diagnosis.not_tried.items():
            lines += hanging(f"    {name}: ", reason, 0)
    if diagnosis.unseen:
        lines += ["", "Could be there at a usual strength and hide in these runs"]
        lines += hanging("    ", ", ".join(diagnosis.unseen), 0)
    return lines


def diagnosis_report(diagnosis: Diagnosis) -> str:
    """The story on a page: verdict, measurement, miss, candidates, error falling, parameters."""
    campaign, bare = diagnosis.before.campaign, diagnosis.steps[0]
    samples = diagnosis.before.samples.count
    model = diagnosis.model
    duration = sum(p.run.duration_s for p in campaign.prepared)
    lines = [f"Verdict: {diagnosis.verdict}", *hanging("", verdict_sentence(diagnosis))]
    if diagnosis.next_experiment:
        lines += hanging("Next experiment: ", diagnosis.next_experiment)
    lines += [
        "",
        "Measurement",
        f"    {len(campaign.prepared)} runs of {duration:.0f} s in all, {samples} samples "
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
