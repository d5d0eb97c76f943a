"""`jbf diagnose --many FOLDER`: diagnose every campaign in a folder and tabulate the results."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jbf.cli import outputs, time_limit
from jbf.cli.progress import shown
from jbf.cores import check_jobs, processes
from jbf.errors import InputError
from jbf.records.folder import campaigns_in
from jbf.reporting.json import json_text
from jbf.reporting.paragraphs import columns
from jbf.reporting.words import number

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.cli.diagnose import DiagnoseOptions
    from jbf.diagnosis import Diagnosis
    from jbf.errors import JbfError


def add(parser: Parser) -> None:
    """Add the options `--many` and `--jobs`."""
    group = parser.add_argument_group("many rigs")
    group.add_argument(
        "--many",
        metavar="FOLDER",
        help="diagnose every subfolder with a rig.toml and CSV files; --out and --report then name "
        "folders with one file per campaign",
    )
    group.add_argument(
        "--jobs", metavar="N", type=int, help="number of parallel processes (default: all cores)"
    )


def run(options: DiagnoseOptions, folder: str) -> int:
    """Run `jbf diagnose --many`; a failed campaign is reported, and the others continue."""
    from jbf.diagnosis import diagnose_many

    if options.rig is not None or options.next_run:
        raise InputError(
            file="jbf diagnose --many",
            problem="excludes RIG, RUN and --next-run",
            remedy="each subfolder contains its own rig.toml and runs",
        )
    check_jobs(options.jobs)
    limit = time_limit.time_limit(options.time_limit)
    campaigns = campaigns_in(folder)
    jobs = processes(options.jobs, len(campaigns))
    inside = [str(path) for path in Path(folder).iterdir()]
    read = list(outputs.inputs_in(folder, inside, options.effects_from))
    outputs.check({"--json": options.json}, read)
    for option, path in (("--out", options.out), ("--report", options.report)):
        if path:
            outputs.check_folder(option, Path(path))
    for name in campaigns:
        outputs.check({"--json": options.json} | _paths(options, name), read)
    with shown("diagnosing") as report, ProcessPoolExecutor(jobs) as executor:
        results = diagnose_many(
            campaigns,
            executor=executor,
            progress=report,
            law=options.law.law,
            clock=options.law.clock,
            limits=options.limits.limits(options.next_duration_s),
            policy=options.level.policy(),
            # The limit of each campaign begins with its diagnosis.
            time_limit_s=None if limit is None else limit.seconds,
        )
    texts: dict[str, str] = {}
    for name, result in results.items():
        texts |= _files(options, name, result)
    if options.json:
        pages = {name: _page(result) for name, result in results.items()}
        texts[options.json] = json_text(pages)
    outputs.write(texts)
    outputs.say("\n".join(_table(results)), {"--json": options.json})
    return 0


def _paths(options: DiagnoseOptions, name: str) -> dict[str, str]:
    """Output files of one campaign, by option."""
    paths = {}
    if options.out:
        paths["--out"] = str(Path(options.out) / f"{name}.toml")
    if options.report:
        paths["--report"] = str(Path(options.report) / f"{name}.html")
    return paths


def _files(options: DiagnoseOptions, name: str, result: Diagnosis | JbfError) -> dict[str, str]:
    """Texts of the output files of one campaign, by path."""
    if isinstance(result, Exception):
        return {}
    paths, texts = _paths(options, name), {}
    if "--out" in paths:
        texts[paths["--out"]] = result.model.to_toml()
    if "--report" in paths:
        from jbf.reporting.diagnosis_page import diagnosis_page

        texts[paths["--report"]] = diagnosis_page(result, options.typed)
    return texts


def _page(result: Diagnosis | JbfError) -> dict[str, Any]:
    """JSON object of one campaign: its diagnosis or its error."""
    return {"error": str(result)} if isinstance(result, Exception) else result.to_dict()


def _table(results: dict[str, Diagnosis | JbfError]) -> list[str]:
    """Lines of the table of all campaigns with their verdicts."""
    done = [r for r in results.values() if not isinstance(r, Exception)]
    units = {r.model.rig.quantities.force for r in done} or {"N"}
    # If the units of the rigs differ, each number carries its own unit.
    head = f" ({units.pop()})" if len(units) == 1 else ""
    rows = [("campaign", "verdict", "effects", f"held-out RMS{head}", f"noise{head}")]
    failed = []
    for name, result in results.items():
        if isinstance(result, Exception):
            rows.append((name, "failed", "-", "-", "-"))
            failed.append(f"{name}: {result}")
            continue
        last = result.steps[-1]
        effects = ", ".join(result.effects) or "-"
        unit = "" if head else f" {result.model.rig.quantities.force}"
        held_out, noise = (f"{number(x)}{unit}" for x in (last.held_out_rms, last.noise_rms))
        row = (name, result.verdict, effects, held_out, noise)
        rows.append(row)
    return [*columns(rows, "<<<>>", 0), *([""] if failed else []), *failed]
