"""Demonstration on shipped data: measurements, a model that lacks an effect, and a diagnosis.

The diagnosis identifies the missing effect, and the completed model has a lower error. The data
come from a simulator that shares no code with the models (`simulator/` in the source tree). The
true effects are in `truth.json`, which is opened only after the diagnosis.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import as_file, files
from pathlib import Path

from jbf.comparison.compare import compare
from jbf.comparison.comparison import Comparison
from jbf.diagnosis import Diagnosis, diagnose
from jbf.records.rig import read_rig
from jbf.records.run import PathLike
from jbf.records.run_files import read_runs
from jbf.reporting.paragraphs import hanging
from jbf.reporting.words import number

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Demo:
    """Results of the demonstration.

    Attributes
    ----------
    folder
        Folder of the data, of `report.html` and of `model.toml`.
    diagnosis
        Diagnosis of the campaign with hidden effects.
    without_effects
        Diagnosis of the same rig without hidden effects.
    before, after
        Comparison of the base law and of the final model with a run that the diagnosis did not use.
    truth
        Parameters of the hidden effects, by effect and symbol.
    """

    folder: Path
    diagnosis: Diagnosis
    without_effects: Diagnosis
    before: Comparison
    after: Comparison
    truth: dict[str, dict[str, float]]

    def text(self, *, full: bool = False, command: str = "jbf") -> str:
        """Return the results as text for a terminal.

        Parameters
        ----------
        full
            True to return the complete report of the diagnosis instead of its summary.
        command
            Shell command that starts jbf, for the suggested next commands.
        """
        plain, step = self.without_effects, self.without_effects.steps[-1]
        true_values = ", ".join(
            f"{effect} {symbol} = {value:.4g}"
            for effect, values in self.truth.items()
            for symbol, value in values.items()
        )
        checks = [
            f"New motion: RMS error {number(self.before.rms)} N with the law alone, "
            f"{number(self.after.rms)} N with the final model, noise "
            f"{number(self.after.noise_rms)} N",
            f"Same rig without hidden effects: {plain.verdict} (held-out RMS "
            f"{number(step.held_out_rms)} N, noise {number(step.noise_rms)} N)",
            f"True values of the hidden effects: {true_values}",
        ]
        data = self.folder / "hidden"
        return "\n".join(
            [
                self.diagnosis.summary(full=full),
                "",
                *(line for check in checks for line in hanging("", check, 0)),
                "",
                f"Report with figures: {self.folder / 'report.html'}; "
                f"model: {self.folder / 'model.toml'}; complete text: --full",
                f"Repeat:  {command} diagnose {data}/rig.toml {data}",
                f"Explore: {command} workbench {self.folder}",
            ]
        )


def run(directory: PathLike = "jbf-demo", progress: Progress | None = None) -> Demo:
    """Copy the shipped data into `directory`, and run the diagnosis.

    Writes `report.html` and `model.toml` there, next to the data.
    """
    folder = Path(directory)
    with as_file(files("jbf") / "data" / "demo") as shipped:
        shutil.copytree(shipped, folder, dirs_exist_ok=True)
    diagnosis = _diagnosed(folder / "hidden", progress)
    diagnosis.model.save(folder / "model.toml")
    diagnosis.report(folder / "report.html")
    unseen = read_runs(folder / "hidden" / "unseen")
    before, after = compare(diagnosis.before.model, unseen), compare(diagnosis.model, unseen)
    without_effects = _diagnosed(folder / "plain", progress)
    truth = json.loads((folder / "hidden" / "truth.json").read_text(encoding="utf-8"))
    return Demo(folder, diagnosis, without_effects, before, after, truth["effects"])


def _diagnosed(folder: Path, progress: Progress | None) -> Diagnosis:
    return diagnose(read_rig(folder / "rig.toml"), read_runs(folder), progress=progress)
