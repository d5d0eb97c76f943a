"""`jbf diagnose RIG RUN...`: find the effects that a friction law lacks."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jbf.cli import diagnose_many, hold_out, inputs, level, limits, outputs, time_limit
from jbf.cli.arguments import (
    Commands,
    LawOptions,
    Verbosity,
    add_effects_from,
    add_json,
    add_law,
    add_report,
    add_rig,
    add_runs,
    add_verbosity,
    command,
)
from jbf.cli.commands import COMMANDS
from jbf.cli.progress import shown
from jbf.errors import InputError, Stopped, Unfinished
from jbf.models.catalogue import find_law
from jbf.models.vocabulary import AUTO
from jbf.reporting.json import json_text

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.diagnosis import Diagnosis


@dataclass(frozen=True)
class DiagnoseOptions:
    """Arguments of `jbf diagnose`."""

    rig: str | None
    runs: tuple[str, ...]
    law: LawOptions
    hold_out: tuple[str, ...]
    level: level.LevelOptions
    next_run: str | None
    next_duration_s: float
    limits: limits.LimitOptions
    many: str | None
    jobs: int | None
    out: str | None
    json: str | None
    report: str | None
    verbosity: Verbosity
    effects_from: tuple[str, ...]
    time_limit: str | None
    typed: str


def add(commands: Commands) -> None:
    """Add `jbf diagnose` to the parser."""
    parser = command(commands, "diagnose", COMMANDS["diagnose"], DiagnoseOptions, run)
    add_rig(parser, nargs="?")
    add_runs(parser, needed=False)
    parser.add_argument("--out", metavar="MODEL", help="write the completed model (TOML)")
    add_json(parser)
    add_report(parser)
    add_verbosity(parser)
    time_limit.add(parser, "the best model by then is the result, with what was not tested")
    also = (
        f", or {AUTO}: the law that predicts held-out runs best (default: journal for a bearing, "
    )
    add_law(parser, also=f"{also}otherwise {AUTO})")
    add_effects_from(parser)
    hold_out.add(parser)
    level.add(parser)
    _add_next_run(parser)
    diagnose_many.add(parser)


def _add_next_run(parser: Parser) -> None:
    """Add the options for the proposed next run."""
    group = parser.add_argument_group(
        "next experiment", "a run that distinguishes the effects of an ambiguous verdict"
    )
    group.add_argument(
        "--next-run",
        metavar="CSV",
        help="write the motion of that run, if one is proposed",
    )
    group.add_argument(
        "--next-duration-s",
        metavar="X",
        type=float,
        default=60.0,
        help="duration of that run, s (default 60)",
    )
    limits.add(group, otherwise="as recorded", sharpest="as recorded", longest="as recorded")


def run(options: DiagnoseOptions) -> int:
    """Run `jbf diagnose` and return its exit code."""
    limit = time_limit.time_limit(options.time_limit)
    if options.many is not None:
        for name, given in (
            (hold_out.OPTION, options.hold_out),
            ("--full", options.verbosity.full),
            ("--quiet", options.verbosity.quiet),
        ):
            if given:
                raise InputError(
                    file=name, problem="applies to a single rig", remedy="leave out --many"
                )
        return diagnose_many.run(options, options.many)
    if options.rig is not None and not os.path.exists(options.rig):
        raise InputError(file=options.rig, problem="does not exist", remedy="name the rig file")
    if options.rig is not None and options.rig.lower().endswith(".csv"):
        raise InputError(
            file=options.rig,
            problem="is a CSV file where RIG should be",
            remedy=f"name a rig file first, or import it: jbf import {options.rig} --folder FOLDER",
        )
    folder_only = options.rig is not None and os.path.isdir(options.rig)
    if options.rig is None or not (options.runs or folder_only):
        raise InputError(
            file="jbf diagnose",
            problem="RIG and RUN are missing",
            remedy="name the rig file and its runs, or --many FOLDER",
        )
    targets = {"--out": options.out, "--json": options.json, "--report": options.report}
    targets["--next-run"] = options.next_run
    read = outputs.inputs_in(options.rig, options.runs, options.effects_from)
    outputs.check(targets, read)
    law = options.law.law
    if law not in (None, AUTO):
        find_law(law)
    rig, runs = inputs.campaign(options.rig, options.runs, law)
    policy = options.level.policy(rig.quantities)
    limits_of_rig = options.limits.limits(options.next_duration_s, rig.quantities)
    outputs.check(targets, [run.path for run in runs if run.path])
    runs, held_out = hold_out.split(runs, options.hold_out)

    from jbf.diagnosis import diagnose
    from jbf.diagnosis.budget import STAGES

    texts = {}
    try:
        with shown("diagnosing", stages=STAGES, time_limit=limit) as report:
            diagnosis = diagnose(
                rig,
                runs,
                law=inputs.law_of_diagnosis(rig, law),
                clock=options.law.clock,
                limits=limits_of_rig,
                policy=policy,
                progress=report,
                time_limit_s=limit,
            )
            if options.report:
                from jbf.reporting.diagnosis_page import diagnosis_page

                texts[options.report] = diagnosis_page(diagnosis, options.typed)
    except Stopped as stop:
        raise outputs.keep(stop, options.out) from None
    except Unfinished as end:
        unfinished = outputs.keep_unfinished(end, options.out, options.json, options.report)
        raise unfinished from None
    held_out_error = hold_out.error_for_json(diagnosis.model, held_out)
    if options.json:
        texts[options.json] = json_text(diagnosis.to_dict() | held_out_error)
    if options.out:
        texts[options.out] = diagnosis.model.to_toml()
    if options.next_run and diagnosis.experiment:
        texts[options.next_run] = diagnosis.experiment.run.to_csv()
    outputs.write(texts)
    outputs.say(_text(diagnosis, options, hold_out.words(diagnosis.model, held_out_error)), targets)
    return 0


def _text(diagnosis: Diagnosis, options: DiagnoseOptions, held_out: list[str]) -> str:
    """Text that `jbf diagnose` prints: verdict, summary or complete report."""
    from jbf.reporting.diagnosis_summary import MOST_LINES, diagnosis_summary, verdict_line

    if options.verbosity.quiet:
        return verdict_line(diagnosis)
    lines = list(held_out)
    if options.next_run and diagnosis.experiment is None:
        lines += ["", f"No run is proposed: {options.next_run} was not written"]
    if options.verbosity.full:
        return "\n".join([diagnosis.summary(full=True), *lines])
    report = options.report or "add --report FILE.html"
    lines += ["", f"Complete report: add --full; with figures: {report}"]
    return "\n".join([diagnosis_summary(diagnosis, MOST_LINES - len(lines)), *lines])
