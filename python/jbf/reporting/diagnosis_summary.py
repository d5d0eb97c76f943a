"""Diagnosis as a short plain text: at most 30 lines of at most 100 characters."""

from __future__ import annotations

from collections.abc import Sequence

from jbf.diagnosis.result import Diagnosis
from jbf.models.parameter_value import ParameterValue
from jbf.records.counts import count_of
from jbf.records.findings.finding import Finding
from jbf.reporting.advice import advice_on
from jbf.reporting.paragraphs import columns, hanging
from jbf.reporting.tables import LEDGER_HEAD, ledger_rows, parameter_rows
from jbf.reporting.words import conclusion, law_sentence, listed, omitted_words

MOST_LINES, USUAL_LINES = 30, 24
"""Maximum number of lines, and the number at which the list of parameters is truncated."""
WIDEST = 100
"""Maximum length of a line in characters."""
FEWEST_PARAMETERS = 4
MOST_STEPS = 4
MOST_FINDINGS = 3


def verdict_line(diagnosis: Diagnosis) -> str:
    """Verdict of a diagnosis with the effects on which it is based, in one line."""
    names = []
    for effect in diagnosis.effects:
        alternatives = diagnosis.alternatives.get(effect, ())
        names.append(listed([effect, *alternatives], "or") if alternatives else effect)
    return f"Verdict: {diagnosis.verdict}" + (f" ({', '.join(names)})" if names else "")


def diagnosis_summary(diagnosis: Diagnosis, most_lines: int = MOST_LINES) -> str:
    """Summarize verdict, error by step, parameters, data quality and recommended next action.

    Parameters
    ----------
    most_lines
        Maximum number of lines; the last recommendations are omitted first.
    """
    conclusions = f"{conclusion(diagnosis, '')}{law_sentence(diagnosis)}"
    above = [_cut(verdict_line(diagnosis)), *_paragraph("", conclusions, 4), "", *_steps(diagnosis)]
    findings, outlook = _findings(diagnosis), _outlook(diagnosis)
    # In addition to these: two blank lines, the header of the parameters, those not determined.
    used = len(above) + len(findings) + 4
    while outlook and used + FEWEST_PARAMETERS + sum(map(len, outlook)) > most_lines:
        outlook.pop()
    room = min(USUAL_LINES, most_lines) - used - sum(map(len, outlook))
    lines = [*above, "", *_parameters(diagnosis, max(room, FEWEST_PARAMETERS)), *findings]
    return "\n".join([*lines, *([""] if outlook else []), *(x for part in outlook for x in part)])


def _steps(diagnosis: Diagnosis) -> list[str]:
    """Tabulate the errors of the first and the last steps."""
    unit = diagnosis.model.rig.quantities.force
    rows: list[Sequence[str]] = list(ledger_rows(diagnosis))
    if len(rows) > MOST_STEPS:
        skipped = (f"... {len(rows) - MOST_STEPS + 1} more steps", "", "", "", "")
        rows = [rows[0], skipped, *rows[2 - MOST_STEPS :]]
    head = (f"Error by step ({unit})", *LEDGER_HEAD[1:])
    table = columns([head, *((f"  {row[0]}", *row[1:]) for row in rows)], "<>>>>", 0)
    return [_cut(line) for line in table]


def _parameters(diagnosis: Diagnosis, room: int) -> list[str]:
    """Tabulate the best determined parameters in `room` lines, and name undetermined ones."""
    fit, model = diagnosis.fit, diagnosis.model
    free = {name: p for name, p in fit.parameters.items() if not p.held}
    precise = sorted(free, key=lambda name: -_precision(free[name]))[:room]
    # The parameters of the machine first, then those of the law and of the other effects.
    of_machine = [n for n in free if n in precise and n.partition(".")[0] in diagnosis.machine]
    order = [*of_machine, *(name for name in free if name in precise and name not in of_machine)]
    quantities = model.rig.quantities
    rows = parameter_rows(
        model.law, model.effects, {name: free[name] for name in order}, quantities
    )
    head = ("Parameters", "value", "standard error", "", "unit")
    cells = [
        (f"  {name}", value, error, share, unit) for name, value, error, share, unit, _ in rows
    ]
    rows_text = [_cut(line) for line in columns([head, *cells], "<>>><", 0)]
    groups = {
        "less precise": [name for name in free if name not in order],
        "not determined": [name for name, p in fit.parameters.items() if p.held],
    }
    named = [f"{word}: {', '.join(names)}" for word, names in groups.items() if names]
    return rows_text + ([_cut(f"  {'; '.join(named)}")] if named else [])


def _precision(value: ParameterValue) -> float:
    """Ratio of a parameter's value to its standard error; 0 if the error is unknown."""
    return abs(value.value / value.stderr) if value.stderr else 0.0


def _findings(diagnosis: Diagnosis) -> list[str]:
    """Describe the largest data-quality finding of each kind in one line."""
    kinds: dict[str, list[Finding]] = {}
    for finding in diagnosis.findings:
        kinds.setdefault(finding.kind, []).append(finding)
    lines = []
    for kind, findings in list(kinds.items())[:MOST_FINDINGS]:
        largest = max(findings, key=lambda finding: abs(finding.size))
        # A finding common to several runs names them all, separated by commas.
        runs = dict.fromkeys(r for f in (largest, *findings) for r in f.run.split(", "))
        other_runs = f" and {count_of(len(runs) - 1, 'other run')}" if len(runs) > 1 else ""
        lead = f"  {kind.replace('_', ' ')}: "
        place = f" ({next(iter(runs))}{other_runs}; {largest.done})"
        lines.append(_cut(lead + _cut(largest.words, WIDEST - len(lead + place)) + place))
    if len(kinds) > MOST_FINDINGS:
        lines.append(f"  and {count_of(len(kinds) - MOST_FINDINGS, 'other kind')} of findings")
    return ["", "Data quality", *lines] if lines else []


def _outlook(diagnosis: Diagnosis) -> list[list[str]]:
    """Recommend the next action, and name conclusions that the runs do not support."""
    paragraphs = []
    next_experiment = diagnosis.next_experiment or ""
    if next_experiment:
        lead = "Next experiment: " if diagnosis.experiment else "Note: "
        paragraphs.append(_paragraph(lead, next_experiment, 4))
    elif diagnosis.residual_structure:
        # An incomplete search first: it may find the cause of the structure.
        worst = max(diagnosis.residual_structure, key=lambda r: (r.unfinished, r.share))
        advice = advice_on(worst.axis, diagnosis.after.campaign)
        paragraphs.append(_paragraph("Next: ", advice.to_do, 2))
    if diagnosis.unfinished:
        paragraphs.append(_paragraph("Not tested: ", omitted_words(diagnosis), 2))
    if diagnosis.limitations:
        first, *further = diagnosis.limitations
        count = f" (and {len(further)} more)" if further else ""
        paragraphs.append(_paragraph("Not supported by these runs: ", f"{first}{count}", 2))
    if not all(effect in next_experiment for effect in diagnosis.not_detectable):
        names = ", ".join(diagnosis.not_detectable)
        paragraphs.append(_paragraph("Not detectable in these runs: ", names, 1))
    return paragraphs


def _paragraph(lead: str, text: str, line_limit: int) -> list[str]:
    """Wrap a paragraph, and truncate it to a number of lines."""
    lines = hanging(lead, text, 0 if lead else 2)
    return (
        lines
        if len(lines) <= line_limit
        else [*lines[: line_limit - 1], f"{lines[line_limit - 1]} ..."]
    )


def _cut(text: str, width: int = WIDEST) -> str:
    """Truncate a text, between words where possible."""
    if len(text) <= width:
        return text
    shortened = text[: max(width - 4, 0)]
    return f"{shortened[: shortened.rfind(' ')] if ' ' in shortened.strip() else shortened} ..."
