"""Process of a job: executes one order, and sends progress messages and one result.

A result is JSON data; data of the length of a record are written to files.
"""

from __future__ import annotations

import _thread
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Literal

from jbf.comparison.compare import compare
from jbf.comparison.comparison import Comparison
from jbf.diagnosis import diagnose
from jbf.diagnosis.manual_round import manual_round
from jbf.errors import JbfError, Stopped
from jbf.estimation.fit import Fit, fit
from jbf.models.model import Model
from jbf.models.vocabulary import Clock
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.reporting.diagnosis_page import diagnosis_page
from jbf.workbench.answers import (
    Answer,
    of_diagnosis,
    of_fit,
    of_model,
    of_power,
    of_step,
    write_records,
)

Kind = Literal["round", "fit", "diagnose", "compare"]
STOP = "stop"
"""Message of the server that stops the job of a process."""


@dataclass(frozen=True)
class Settings:
    """Choices of the user for the parameters of a fit, by parameter name.

    Attributes
    ----------
    start, fixed
        Starting values, and values that are held fixed.
    bounds
        Pairs of lower and upper bound.
    """

    start: Mapping[str, float] = field(default_factory=dict)
    fixed: Mapping[str, float] = field(default_factory=dict)
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @classmethod
    def of(cls, content: Mapping[str, Any]) -> Settings:
        """Settings from JSON data; values that are not numbers raise a `ValueError`."""
        numbers = {
            key: {str(name): float(value) for name, value in content.get(key, {}).items()}
            for key in ("start", "fixed")
        }
        bounds = {
            str(name): (float(low), float(high))
            for name, (low, high) in content.get("bounds", {}).items()
        }
        return cls(numbers["start"], numbers["fixed"], bounds)

    def words(self) -> str:
        """Name the parameters with settings, as in `F_c fixed`."""
        groups = {"fixed": self.fixed, "bounded": self.bounds, "started elsewhere": self.start}
        parts = [f"{', '.join(names)} {how}" for how, names in groups.items() if names]
        return "; ".join(parts) or "fitted again"

    def to_dict(self) -> dict[str, Any]:
        """JSON data of the settings."""
        return {
            "start": dict(self.start),
            "fixed": dict(self.fixed),
            "bounds": {name: list(ends) for name, ends in self.bounds.items()},
        }


@dataclass(frozen=True)
class Order:
    """Job for a separate process.

    Attributes
    ----------
    kind
        `round` fits the given effects and tests every other; `fit` only fits them, with `settings`;
        `diagnose` runs all rounds; `compare` compares an unchanged model.
    rig, runs
        The rig, and the runs to use.
    folder
        Folder for the records with the model's prediction, one file per run.
    law, clock, effects
        Base law, definition of its film's time constant, and effects.
    model
        Path of the model file to compare.
    settings
        Starting values, fixed values and bounds of parameters by name, for a `fit`.
    """

    kind: Kind
    rig: Rig
    runs: tuple[Run, ...]
    folder: Path
    law: str = "journal"
    clock: Clock = "journal"
    effects: tuple[str, ...] = ()
    model: Path | None = None
    settings: Settings = Settings()


def main(connection: Connection, order: Order) -> None:
    """Execute a job in this process, and send its messages to the server.

    Progress messages are `("progress", message, done, total)`. The last message is
    `("done", result)`, `("error", words)`, or after `STOP` `("stopped", result)` with the best
    result so far, if any. A round also sends `("part", result)` when the model is fitted and its
    candidates are not yet tested. The process ends if the server has ended.
    """
    with suppress(BrokenPipeError):
        _execute(connection, order)


def _execute(connection: Connection, order: Order) -> None:
    """Execute a job and send its messages; raise `BrokenPipeError` if the server has ended."""

    def progress(message: str, done: int, total: int) -> None:
        connection.send(("progress", message, done, total))

    def part(answer: Answer) -> None:
        connection.send(("part", answer))

    try:
        with _interrupted_by(connection):
            last: tuple[str, Answer | str] = ("done", execute(order, progress, part))
    except Stopped as stop:
        last = ("stopped", best_so_far(stop.fit, order))
    except KeyboardInterrupt:
        last = ("stopped", {})
    except JbfError as error:
        last = ("error", str(error))
    except MemoryError:
        last = ("error", "not enough memory: use fewer or shorter runs")
    connection.send(last)
    connection.close()


@contextmanager
def _interrupted_by(connection: Connection) -> Iterator[None]:
    """Raise `KeyboardInterrupt` once when `STOP` is received.

    Ctrl-C in the terminal is handled by the server, which stops its processes.
    """
    stop_requested = threading.Event()

    def interrupt(*_: object) -> None:
        if stop_requested.is_set():
            stop_requested.clear()
            raise KeyboardInterrupt

    def listen() -> None:
        try:
            if connection.recv() == STOP:
                stop_requested.set()
                _thread.interrupt_main()
        except (EOFError, OSError):  # the server has ended, or the order is completed
            pass

    signal.signal(signal.SIGINT, interrupt)
    threading.Thread(target=listen, daemon=True).start()
    try:
        yield
    finally:
        stop_requested.clear()


def best_so_far(best: Fit, order: Order) -> Answer:
    """Result of a job that was stopped, from its best fit."""
    compared = compare(best.model, order.runs)
    return {**of_model(compared), **of_fit(best), **write_records(compared, order.folder)}


def execute(order: Order, progress: Any = None, part: Any = None) -> Answer:
    """Result of a job; for a round, only the content that `part` has not received."""
    if order.kind == "compare":
        assert order.model is not None
        compared = compare(Model.load(order.model), order.runs)
        return {**of_model(compared), **write_records(compared, order.folder)}
    if order.kind == "fit":
        chosen = order.settings
        fitted = fit(
            order.rig, order.runs, order.effects, law=order.law, clock=order.clock,
            start=chosen.start, fixed=chosen.fixed, bounds=chosen.bounds,
        )  # fmt: skip
        compared = compare(fitted.model, order.runs)
        answer = {**of_model(compared), **of_fit(fitted), **write_records(compared, order.folder)}
        settings = {"settings": chosen.to_dict(), "changes": chosen.words()}
        return {**answer, **settings, "trials": []}
    if order.kind == "round":

        def fitted_as(found: Fit, comparison: Comparison) -> None:
            """Send the fitted model to the page before the candidate effects are tested."""
            if part is not None:
                part(
                    {
                        **of_model(comparison),
                        **of_fit(found),
                        **write_records(comparison, order.folder),
                    }
                )

        outcome = manual_round(
            order.rig,
            order.runs,
            order.effects,
            law=order.law,
            clock=order.clock,
            progress=progress,
            fitted_as=fitted_as,
        )
        return {**of_step(outcome.step), "power": of_power(outcome.power, outcome.fit.model)}
    diagnosis = diagnose(order.rig, order.runs, law=order.law, clock=order.clock, progress=progress)
    return {
        **of_model(diagnosis.after),
        **of_fit(diagnosis.fit),
        **of_step(diagnosis.steps[-1]),
        **write_records(diagnosis.after, order.folder),
        "power": of_power(diagnosis.power, diagnosis.model),
        "diagnosis": of_diagnosis(diagnosis),
        "report": diagnosis_page(diagnosis),
    }
