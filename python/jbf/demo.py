"""Demonstration on shipped data: a measurement, a model that misses an effect, and its diagnosis.

It shows the missing effect and the lower error of the completed model. The data come from a
simulator that shares no code with the models (`simulator/` in the source tree). The true effects
are in `truth.json`, which is opened only after the diagnosis.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from importlib.resources import as_file, files
from pathlib import Path

from jbf.comparison.compare import compare
from jbf.diagnosis import Diagnosis, diagnose
from jbf.records.rig import read_rig
from jbf.records.run import PathLike
from jbf.records.run_files import read_runs
from jbf.reporting.words import value_and_error

Say = Callable[[str], None]
Progress = Callable[[str, int, int], None]


def run(
    directory: PathLike = "jbf-demo",
    say: Say = print,
    progress: Progress | None = None,
    jbf: str = "jbf",
) -> Diagnosis:
    """Copy the shipped data into `directory`, diagnose them, and report the results.

    Writes `report.html` and `model.toml` there, next to the data. Returns the diagnosis of the
    campaign with hidden effects. `jbf` is the name under which the command was started.
    """
    out = Path(directory)
    with as_file(files("jbf") / "data" / "demo") as shipped:
        shutil.copytree(shipped, out, dirs_exist_ok=True)

    say("== 1. A rig with something hidden in it ==\n")
    hidden = _diagnosed(out / "hidden", progress)
    say(hidden.summary())
    hidden.model.save(out / "model.toml")
    hidden.report(out / "report.html")
    say("\n== 2. A motion that took no part ==\n")
    say(_compare_on_new_motion(hidden, out / "hidden"))
    say("\n== 3. The same rig with nothing hidden ==\n")
    plain = _diagnosed(out / "plain", progress)
    step = plain.steps[-1]
    say(
        f"{len(plain.before.runs)} runs, every effect tried: {plain.verdict}"
        f" ({', '.join(plain.effects) or 'nothing added'})."
        f" Held-out RMS {step.held_out_rms:.3g} N, noise {step.noise_rms:.3g} N."
    )
    say("\n== What had been hidden ==\n")
    say(_truth(hidden, out / "hidden"))
    hid = f"{out}/hidden"
    say(
        f"\nWritten: {out / 'report.html'} (pictures), {out / 'model.toml'} (the fitted model).\n"
        "The same by hand:\n"
        f"  {jbf} diagnose {hid}/rig.toml {hid} --out model.toml --report report.html\n"
        f"  {jbf} compare model.toml {hid}/unseen\n"
        "\nNext, look and click: a page in your browser, with these data or a CSV of your own:\n"
        f"  {jbf} workbench {out}"
    )
    return hidden


def _diagnosed(folder: Path, progress: Progress | None) -> Diagnosis:
    return diagnose(read_rig(folder / "rig.toml"), read_runs(folder), progress=progress)


def _compare_on_new_motion(diagnosis: Diagnosis, folder: Path) -> str:
    """Compare the bare law and the completed one on a motion of another kind."""
    runs = read_runs(folder / "unseen")
    bare = compare(diagnosis.before.model, runs)
    full = compare(diagnosis.model, runs)
    name = runs[0].name
    return (
        f"{name}: the law alone misses it by {bare.rms:.3g} N RMS, with"
        f" {' and '.join(diagnosis.effects) or 'nothing'} added {full.rms:.3g} N;"
        f" the noise on it is {full.noise_rms:.3g} N."
    )


def _truth(diagnosis: Diagnosis, folder: Path) -> str:
    """List the true effects of the simulator next to the estimates."""
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    lines = []
    for effect, values in truth["effects"].items():
        found = {n: p for n, p in diagnosis.fit.parameters.items() if n.startswith(f"{effect}.")}
        for symbol, value in values.items():
            match = [p for n, p in found.items() if n.split(".")[1].startswith(symbol)]
            if not match:
                lines.append(f"{effect}: {symbol} = {value:.4g}; not found")
                continue
            shown, error = value_and_error(match[0])
            said = f"found {shown} +/- {error}" if error else f"{shown}, {match[0].note}"
            lines.append(f"{effect}: {symbol} = {value:.4g}; {said}")
    return "\n".join(lines)
