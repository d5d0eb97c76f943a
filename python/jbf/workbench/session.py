"""Session of the workbench: rig and runs, models, and the running job."""

from __future__ import annotations

import json
import tempfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any

from jbf.errors import InputError
from jbf.models.catalogue import find_effect, find_law
from jbf.models.chain import check_rig, default_law
from jbf.models.model import Model
from jbf.models.number_format import number as written
from jbf.models.vocabulary import AUTO
from jbf.records.counts import count_of
from jbf.workbench.answers import TYPICAL
from jbf.workbench.bench import Bench
from jbf.workbench.choices import effects_for, first_law, laws_for, units_of_rig
from jbf.workbench.equivalent_commands import commands, python
from jbf.workbench.files import Folder
from jbf.workbench.jobs import Ending, Jobs
from jbf.workbench.models import Models
from jbf.workbench.reading import Readings
from jbf.workbench.session_content import Content, Key, content_of, key_of, read_content
from jbf.workbench.source_cache import SourceCache
from jbf.workbench.work import Kind, Order, Settings


class Session:
    """State of the workbench for one folder.

    Attributes
    ----------
    version
        Counter of changes; clients reload the state when it increases.
    lock
        Lock held while the rig, the runs or the models change.
    kept
        Trims and models of the rigs that were open before, by the files of rig and runs.
    """

    def __init__(self, folder: Folder) -> None:
        self.folder = folder
        self.version = 1
        self.lock = threading.RLock()
        self.jobs = Jobs(self.changed)
        self.readings = Readings(self.changed)
        self.sources = SourceCache()
        self.message: dict[str, str] = {}
        self.bench: Bench | None = None
        self.models = Models()
        self.law = "journal"
        self.kept: dict[Key, Content] = {}
        self._kept = tempfile.TemporaryDirectory(prefix="jbf-workbench-")
        self._places = 0
        self._owed = False
        self._loaded: dict[int, Model] = {}

    def changed(self) -> None:
        """Register a change of the session, so that pages reload the state.

        A comparison that was postponed during another job is started.
        """
        self.version += 1
        if self._owed and self.jobs.job is None:
            self._owed = False
            with self.lock:
                current = self.models.current
                if current is not None and self.records(current) is None:
                    self._compare(current)

    def say(self, kind: str, words: str) -> None:
        """Set the message that pages show; `kind` is `done` or `error`."""
        self.message = {"kind": kind, "words": words}
        self.changed()

    def on_bench(self) -> Bench:
        """Rig and runs that are open.

        Raises
        ------
        InputError
            No rig is open.
        """
        if self.bench is None:
            raise InputError(problem="no runs are open", remedy="open a rig and its runs")
        return self.bench

    def open(self, rig_name: str, run_names: Sequence[str]) -> None:
        """Open a rig and runs in place of the present ones.

        The models of the present rig are kept; they return when it is opened again.

        Raises
        ------
        InputError
            A file is wrong, the reading was cancelled, or a fit is running; the present rig and
            runs are kept.
        """
        key = key_of(rig_name, run_names)
        with self.lock:
            content = self.content() if key == self._key() else self.kept.get(key)
        with self.readings.begin(f"opening {rig_name}") as reading:
            if content is None:
                bench = Bench.read(self.folder, rig_name, run_names, reading.progress)
                self.put(bench, Models())
            else:
                place = PurePosixPath(rig_name)
                self.put(*read_content(self.folder, content, place, reading.progress))
                self.show(self.models.current)
        words = f"{rig_name} is open, with {count_of(len(run_names), 'run')}"
        if self.models.nodes:
            words += f" and {count_of(len(self.models.nodes), 'model')}"
        if models := sum(len(kept["models"]) for kept in self.kept.values()):
            words += f"; {count_of(models, 'model')} of other rigs kept: open the rig to continue"
        self.say("done", words)

    def content(self) -> Content:
        """Rig, runs, trims and models that are open, as JSON data.

        Raises
        ------
        InputError
            No rig is open.
        """
        with self.lock:
            return content_of(self.on_bench(), self.models, self.law)

    def put(self, bench: Bench, models: Models, law: str | None = None) -> None:
        """Replace the rig, the runs and the models of the session; the present ones are kept."""
        with self.lock:
            if self.jobs.job is not None:
                raise InputError(problem="a fit is running", remedy="wait for it, or cancel it")
            if (key := self._key()) is not None:
                self.kept[key] = self.content()
            self.kept.pop(key_of(bench.rig_name, bench.run_names), None)
            self.bench, self.models = bench, models
            self._loaded = {}
            self.law = law or first_law(bench.rig)
        bench.examine_runs(self.changed)

    def _key(self) -> Key | None:
        """Key of the open rig and its runs."""
        return None if self.bench is None else key_of(self.bench.rig_name, self.bench.run_names)

    def kept_campaigns(self) -> list[dict[str, Any]]:
        """Rigs with their runs that were open before, and the number of their models."""
        with self.lock:
            return [
                {"rig": kept["rig"], "runs": kept["runs"], "models": len(kept["models"])}
                for kept in self.kept.values()
            ]

    def choose_law(self, law: str) -> None:
        """Choose the base law of models without a parent and of diagnoses."""
        if law != AUTO:
            find_law(law)
            check_rig(self.on_bench().rig, law)
        self.law = law
        self.changed()

    def begin(
        self,
        kind: Kind,
        effects: Sequence[str],
        parent: int | None,
        settings: Settings | None = None,
    ) -> None:
        """Start a fit with tests of candidates (`round`), a `fit` with settings, or a diagnosis.

        A fit has the law of its parent; without a parent, and in a diagnosis, the chosen law.

        Raises
        ------
        InputError
            No rig is open, a fit is running, or the law cannot be used with the rig.
        """
        with self.lock:
            bench = self.on_bench()
            is_new = parent is None or kind == "diagnose"
            law = self.law if is_new else str(self.models.node(parent)["law"])
            for name in effects:
                find_effect(name)
            if kind != "diagnose" and law == AUTO:
                law = default_law(bench.rig)
            place = self._new_place()
            order = Order(
                kind, bench.rig, bench.used_runs(), place, law, effects=tuple(effects),
                settings=settings or Settings(),
            )  # fmt: skip
            words = _words(kind, law, effects)
            origin = {"asked_law": law, "records": place.name, "used": bench.used()}

            numbers: list[int] = []

            def part(answer: Any) -> None:
                numbers.append(self._add_model(answer, parent, "", origin))

            def on_end(ending: Ending, answer: Any) -> None:
                if numbers:
                    self._add_ranking(ending, answer, numbers[0])
                else:
                    self._finish(ending, answer, parent, words, origin)

            self.message = {}
            self.jobs.start(words, order, on_end, part)
        self.changed()

    def show(self, number: int | None) -> None:
        """Display a model, or only the records if None.

        The model is compared with the runs if that has not been done, for example after a session
        was loaded.
        """
        with self.lock:
            self.models.choose(number)
            self._compare_if_needed(number)
        self.changed()

    def undo(self) -> None:
        """Display the parent of the current model."""
        with self.lock:
            self._compare_if_needed(self.models.undo())
        self.changed()

    def redo(self) -> None:
        """Display the model that was undone last."""
        with self.lock:
            self._compare_if_needed(self.models.redo())
        self.changed()

    def _compare_if_needed(self, number: int | None) -> None:
        """Start the comparison of a model without records; postpone it if another job runs."""
        if number is not None and self.records(number) is None:
            self._owed = self.jobs.job is not None
            if not self._owed:
                self._compare(number)

    def _compare(self, number: int) -> None:
        """Start the comparison of a model of the tree with the runs."""
        node, bench = self.models.node(number), self.on_bench()
        place = self._new_place()
        file = place.with_suffix(".toml")
        file.write_text(node["model"], encoding="utf-8")
        order = Order("compare", bench.rig, bench.used_runs(), place, model=file)

        def on_end(ending: Ending, answer: Any) -> None:
            if ending == "done":
                node.update(records=place.name, record_names=answer["record_names"])
            elif ending == "error":
                self.say("error", str(answer))

        self.jobs.start(f"comparing {node['words']}", order, on_end)

    def _new_place(self) -> Path:
        """Path of a new temporary folder for the records of a model."""
        self._places += 1
        return Path(self._kept.name) / str(self._places)

    def _add_model(
        self, answer: Any, parent: int | None, how: str, origin: Mapping[str, Any]
    ) -> int:
        """Add the model of a finished job to the tree, and return its number.

        `how` is the prefix of the model's label, `origin` the requested law, the name of its
        records and the fitted runs.
        """
        named = " + ".join([answer["law"], *answer["effects"]])
        changes = f", {answer['changes']}" if "changes" in answer else ""
        with self.lock:
            return self.models.add(parent, f"{how}{named}{changes}", {**answer, **origin})

    def _add_ranking(self, ending: Ending, answer: Any, number: int) -> None:
        """Add the ranking of candidates to a model that is already in the tree."""
        node = self.models.node(number)
        unit = self.on_bench().rig.quantities.force
        if ending == "done":
            with self.lock:
                node.update(answer)
            noise = f"noise {written(node['noise_rms'])} {unit}"
            self.say("done", f"{node['words']}: RMS {written(node['rms'])} {unit}; {noise}")
        elif ending == "stopped":
            with self.lock:
                node["trials"] = []
            self.say("done", f"{node['words']}: kept; the test of further candidates was cancelled")
        else:
            with self.lock:
                node["trials"] = []
            self.say("error", f"{node['words']}: {answer}")

    def _finish(
        self, ending: Ending, answer: Any, parent: int | None, words: str,
        origin: Mapping[str, Any],
    ) -> None:  # fmt: skip
        """Handle the end of a job: add its model, or report its error."""
        if ending == "done":
            how = "diagnosed: " if "diagnosis" in answer else ""
            self._add_model(answer, parent, how, origin)
            self.say("done", f"{words}: done")
        elif ending == "stopped" and answer:
            self._add_model({**answer, "trials": []}, parent, "stopped at: ", origin)
            self.say("done", f"{words}: cancelled; the best model so far is kept, unfinished")
        elif ending == "stopped":
            self.say("done", f"{words}: cancelled before a model was found")
        else:
            self.say("error", f"{words}: {answer}")

    def records(self, number: int) -> dict[str, Path] | None:
        """File with prediction and record of each run; None if the model has not been compared."""
        node = self.models.node(number)
        place = Path(self._kept.name) / str(node.get("records", ""))
        if not node.get("records") or not place.is_dir():
            return None
        names = node["record_names"]
        return {name: place / f"{index}.npy" for index, name in enumerate(names)}

    def typical_values(self, number: int) -> dict[str, float] | None:
        """Parameters of further effects at typical strength; None if `records` returns None."""
        records = self.records(number)
        if records is None:
            return None
        place = next(iter(records.values())).parent
        values: dict[str, float] = json.loads((place / TYPICAL).read_text(encoding="utf-8"))
        return values

    def model(self, number: int) -> Model:
        """Load the model with this number in the tree of models."""
        text = str(self.models.node(number)["model"])
        if number not in self._loaded:
            file = Path(self._kept.name) / f"model-{number}.toml"
            file.write_text(text, encoding="utf-8")
            self._loaded[number] = Model.load(file)
        return self._loaded[number]

    def to_dict(self) -> dict[str, Any]:
        """Complete state of the session for the page."""
        with self.lock:
            job, bench = self.readings.job or self.jobs.job, self.bench
            state: dict[str, Any] = {
                "version": self.version,
                "folder": str(self.folder.root),
                "rig": None if bench is None else bench.rig_name,
                "units": None if bench is None else units_of_rig(bench.rig),
                "runs": [] if bench is None else bench.to_list(),
                "law": self.law,
                "laws": laws_for(None if bench is None else bench.rig),
                "fit_law": self._fit_law(),
                "effects": effects_for(
                    self._law_of_next_fit(), None if bench is None else bench.rig
                ),
                "job": None if job is None else job.to_dict(),
                "message": self.message,
                **self.models.to_dict(None if bench is None else bench.used()),
            }
            if bench is not None:
                node = None if self.models.current is None else self.models.node()
                steps = bench.steps()
                state["command"], state["python"] = commands(node, steps), python(node, steps)
            return state

    def _fit_law(self) -> str:
        """Law of a fit without a parent: the chosen one, or that of `jbf fit` for `auto`."""
        if self.law == AUTO and self.bench is not None:
            return default_law(self.bench.rig)
        return self.law

    def _law_of_next_fit(self) -> str:
        """Law of the displayed model; without a model, that of the first fit."""
        node = self.models.nodes.get(self.models.current or 0)
        return self._fit_law() if node is None else str(node["law"])

    def cancel(self) -> bool:
        """Cancel the running reading, otherwise the running job; return False if there is none."""
        return self.readings.cancel() or self.jobs.cancel()

    def close(self) -> None:
        """Stop the running reading and job, and delete the temporary files."""
        self.readings.cancel()
        self.jobs.cancel(at_once=True)
        self._kept.cleanup()


def _words(kind: Kind, law: str, effects: Sequence[str]) -> str:
    if kind == "diagnose":
        return "diagnosis, law selected from the data" if law == AUTO else f"diagnosis of {law}"
    return " + ".join([law, *effects])
