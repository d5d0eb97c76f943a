"""Diagnosis as a short plain text: at most 30 lines of at most 100 characters."""

from __future__ import annotations

from collections.abc import Sequence

from jbf.diagnosis.result import Diagnosis
from jbf.models.catalogue import find_law
from jbf.models.parameter_value import ParameterValue
from jbf.records.counts import count_of
from jbf.records.findings.finding import Finding
from jbf.reporting.advice import advice_on
from jbf.reporting.paragraphs import WIDTH, columns, hanging
from jbf.reporting.tables import LEDGER_HEAD, ledger_rows, parameter_rows
from jbf.reporting.words import conclusion, drive_sentences, law_sentence, listed, omitted_words

MOST_LINES, USUAL_LINES = 30, 24
"""Maximum number of lines, and the number at which the list of parameters is truncated."""
WIDEST = 100
"""Maximum length of a line in characters."""
FEWEST_PARAMETERS = 4
MOST_STEPS = 4
MOST_FINDINGS = 3
MOST_SENTENCES = 6
"""Maximum number of lines of the conclusions below the verdict."""
MOST_OUTLOOK = 4
"""Maximum number of lines of a recommendation."""
UNCORRECTED = "none"
"""Action of a finding that remains in the data."""


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
        Maximum number of lines. Kinds of findings are omitted first, then the last
        recommendations.
    """
    sentences = conclusion(diagnosis, ""), drive_sentences(diagnosis), law_sentence(diagnosis)
    conclusions = _paragraph("", "".join(sentences).strip(), MOST_SENTENCES)
    above = [_cut(verdict_line(diagnosis)), *conclusions, "", *_steps(diagnosis)]
    kinds, outlook = MOST_FINDINGS, _outlook(diagnosis)
    # In addition to these: two blank lines, the header of the parameters, those not determined.
    used = len(above) + 4

    def excess() -> int:
        below = len(_findings(diagnosis, kinds)) + sum(map(len, outlook))
        return used + FEWEST_PARAMETERS + below - most_lines

    while kinds > 1 and excess() > 0:
        kinds -= 1
    while outlook and excess() > 0:
        outlook.pop()
    findings = _findings(diagnosis, kinds)
    room = min(USUAL_LINES, most_lines) - used - len(findings) - sum(map(len, outlook))
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


def _findings(diagnosis: Diagnosis, most: int) -> list[str]:
    """Describe the most important finding of each kind in at most two lines.

    Findings that were not corrected come first, then those of a larger size.
    """
    kinds: dict[str, list[Finding]] = {}
    for finding in sorted(diagnosis.findings, key=_rank):
        kinds.setdefault(finding.kind, []).append(finding)
    lines: list[str] = []
    for kind, findings in list(kinds.items())[:most]:
        first = min(findings, key=lambda finding: (_rank(finding), -abs(finding.size)))
        # A finding common to several runs names them all, separated by commas.
        runs = dict.fromkeys(r for f in (first, *findings) for r in f.run.split(", "))
        other_runs = f" and {count_of(len(runs) - 1, 'other run')}" if len(runs) > 1 else ""
        done = "not corrected" if first.done == UNCORRECTED else first.done
        lead, place = f"{kind.replace('_', ' ')}: ", f" ({next(iter(runs))}{other_runs}; {done})"
        lines += _with_end(lead, first.words, place, 2)
    if len(kinds) > most:
        lines.append(f"  and {count_of(len(kinds) - most, 'other kind')} of findings")
    return ["", "Data quality", *lines] if lines else []


def _rank(finding: Finding) -> int:
    """Rank of a finding: a force of wrong sign, others that were not corrected, corrected ones."""
    if finding.done != UNCORRECTED:
        return 2
    return 0 if finding.kind == "sign" else 1


def _outlook(diagnosis: Diagnosis) -> list[list[str]]:
    """Recommend the next action, and name conclusions that the runs do not support."""
    next_experiment = diagnosis.next_experiment or ""
    paragraphs = [
        _paragraph("Next: ", action, MOST_OUTLOOK) for action in _actions_on_records(diagnosis)
    ]
    if next_experiment:
        lead = "Next experiment: " if diagnosis.experiment else "Note: "
        paragraphs.append(_paragraph(lead, next_experiment, MOST_OUTLOOK))
    elif diagnosis.residual_structure and not paragraphs:
        # An incomplete search first: it may find the cause of the structure.
        worst = max(diagnosis.residual_structure, key=lambda r: (r.unfinished, r.share))
        advice = advice_on(worst.axis, diagnosis.after.campaign)
        paragraphs.append(_paragraph("Next: ", advice.to_do, MOST_OUTLOOK))
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


def _actions_on_records(diagnosis: Diagnosis) -> list[str]:
    """Action that precedes any new experiment: correct the sign of the force, or change the law.

    At most one action is recommended.
    """
    for finding in diagnosis.findings:
        if _rank(finding) == 0:
            return [finding.words]
    rival, law = diagnosis.simpler_law, find_law(diagnosis.model.law)
    selected = bool(diagnosis.laws)
    if rival is None or selected or not diagnosis.residual_structure:
        return []
    if law.has_memory and rival.held_out_rms < diagnosis.steps[-1].held_out_rms:
        return ["the law itself may be wrong: jbf diagnose FOLDER --law auto"]
    return []


def _paragraph(lead: str, text: str, line_limit: int) -> list[str]:
    """Wrap a paragraph, and truncate it to a number of lines."""
    lines = hanging(lead, text, 0 if lead else 2)
    return (
        lines
        if len(lines) <= line_limit
        else [*lines[: line_limit - 1], f"{lines[line_limit - 1]} ..."]
    )


def _with_end(lead: str, words: str, end: str, line_limit: int) -> list[str]:
    """Wrap an item of a list; if it is too long, truncate its words but keep its end."""
    width = line_limit * WIDTH
    lines = hanging(lead, words + end)
    while len(lines) > line_limit and width > 0:
        width -= 4
        lines = hanging(lead, _cut(words, width) + end)
    return lines[:line_limit]


def _cut(text: str, width: int = WIDEST) -> str:
    """Truncate a text, between words where possible."""
    if len(text) <= width:
        return text
    shortened = text[: max(width - 4, 0)]
    return f"{shortened[: shortened.rfind(' ')] if ' ' in shortened.strip() else shortened} ..."
