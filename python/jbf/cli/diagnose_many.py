"""`jbf diagnose --many FOLDER`: diagnose every campaign in a folder and tabulate the results."""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jbf.cli import level, outputs
from jbf.cli.progress import shown
from jbf.cores import check_jobs, processes
from jbf.errors import InputError
from jbf.records.folder import campaigns_in
from jbf.reporting.json import json_text
from jbf.reporting.paragraphs import columns
from jbf.reporting.words import number

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.diagnosis import Diagnosis, Limits
    from jbf.errors import JbfError


def add(parser: Parser) -> None:
    """Add the options."""
    group = parser.add_argument_group("many rigs")
    group.add_argument(
        "--many",
        metavar="FOLDER",
        help="diagnose each folder in it, which holds rig.toml and CSV files; --out and --report "
        "then name folders, for one file a campaign",
    )
    group.add_argument("--jobs", metavar="N", type=int, help="campaigns at a time; all cores")


def run(arguments: argparse.Namespace, limits: Limits) -> int:
    """Run the command; a campaign that fails is reported, and the others continue."""
    from jbf.diagnosis import diagnose_many

    if arguments.rig is not None or arguments.next_run:
        raise InputError(
            file="jbf diagnose --many",
            problem="takes neither RIG nor RUN nor --next-run",
            mend="each folder in it holds its own rig.toml and runs",
        )
    check_jobs(arguments.jobs)
    campaigns = campaigns_in(arguments.many)
    jobs = processes(arguments.jobs, len(campaigns))
    read = list(outputs.read_by(arguments))
    outputs.check({"--json": arguments.json}, read)
    for option in ("out", "report"):
        if getattr(arguments, option):
            outputs.check_folder(f"--{option}", Path(getattr(arguments, option)))
    for name in campaigns:
        outputs.check({"--json": arguments.json} | _paths(arguments, name), read)
    with shown("diagnosing") as report, ProcessPoolExecutor(jobs) as executor:
        found = diagnose_many(
            campaigns,
            executor=executor,
            progress=report,
            law=arguments.law or "journal",
            clock=arguments.clock,
            limits=limits,
            policy=level.policy(arguments),
        )
    texts: dict[str, str] = {}
    for name, result in found.items():
        texts |= _files(arguments, name, result)
    if arguments.json:
        pages = {name: _page(result) for name, result in found.items()}
        texts[arguments.json] = json_text(pages)
    outputs.write(texts)
    outputs.say("\n".join(_table(found)), {"--json": arguments.json})
    return 0


def _paths(arguments: argparse.Namespace, name: str) -> dict[str, str]:
    """Return the output files of one campaign, by option."""
    found = {}
    if arguments.out:
        found["--out"] = str(Path(arguments.out) / f"{name}.toml")
    if arguments.report:
        found["--report"] = str(Path(arguments.report) / f"{name}.html")
    return found


def _files(
    arguments: argparse.Namespace, name: str, result: Diagnosis | JbfError
) -> dict[str, str]:
    if isinstance(result, Exception):
        return {}
    paths, found = _paths(arguments, name), {}
    if "--out" in paths:
        found[paths["--out"]] = result.model.to_toml()
    if "--report" in paths:
        from jbf.reporting.diagnosis_page import diagnosis_page

        found[paths["--report"]] = diagnosis_page(result, arguments.typed)
    return found


def _page(result: Diagnosis | JbfError) -> dict[str, Any]:
    return {"error": str(result)} if isinstance(result, Exception) else result.to_dict()


def _table(found: dict[str, Diagnosis | JbfError]) -> list[str]:
    done = [r for r in found.values() if not isinstance(r, Exception)]
    units = {r.model.rig.quantities.force for r in done} or {"N"}
    # If the units of the rigs differ, each number carries its own unit.
    head = f" ({units.pop()})" if len(units) == 1 else ""
    rows = [("campaign", "verdict", "effects", f"held out{head}", f"noise{head}")]
    failed = []
    for name, result in found.items():
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
